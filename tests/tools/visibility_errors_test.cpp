// SPDX-License-Identifier: MIT
// The error figures, on masks whose errors can be counted by hand.
#include "measure/visibility_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <gnomon.hpp>

namespace gnomon::measure {
namespace {

constexpr std::uint32_t width = 70, height = 40;  // cut tiles on both sides

std::vector<float> all(float value) { return std::vector<float>(width * height, value); }

std::vector<float> checkered() {
    std::vector<float> mask(width * height);
    for (std::uint32_t i = 0; i < mask.size(); ++i) mask[i] = float((i % width + i / width) % 2);
    return mask;
}

TEST(VisibilityErrors, NoneAgainstItself) {
    const VisibilityErrors errors = visibility_errors(checkered(), checkered(), width, height);
    EXPECT_EQ(errors.points, width * height);
    EXPECT_EQ(errors.wrong(), 0u);
    EXPECT_EQ(errors.mean_absolute, 0.0);
    EXPECT_EQ(errors.worst_tile, 0.0);
    EXPECT_DOUBLE_EQ(errors.ssim, 1.0);
}

TEST(VisibilityErrors, CountsBothKindsApart) {
    std::vector<float> truth = all(1), mask = truth;
    for (int i : {3, 5, 700}) truth[i] = 0;  // lit, but should not be
    mask[10] = 0;                            // in shadow, but should not be
    mask[11] = 0.75f;                        // off, but on the right side
    const VisibilityErrors errors = visibility_errors(mask, truth, width, height);
    EXPECT_EQ(errors.wrongly_lit, 3u);
    EXPECT_EQ(errors.wrongly_shadowed, 1u);
    EXPECT_DOUBLE_EQ(errors.mean_absolute, 4.25 / (width * height));
    EXPECT_LT(errors.ssim, 1.0);
}

TEST(VisibilityErrors, HalfIsWrong) {
    EXPECT_EQ(visibility_errors(all(0.5f), all(1), width, height).wrongly_shadowed, width * height);
    EXPECT_EQ(visibility_errors(all(0.5f), all(0), width, height).wrongly_lit, width * height);
    EXPECT_EQ(visibility_errors(all(0.51f), all(1), width, height).wrong(), 0u);
}

// A penumbra is where the truth is strictly between 0 and 1.
TEST(VisibilityErrors, PenumbraeAreMeasuredApart) {
    const std::vector<float> truth{0, 1, 0.5f, 0.25f}, guess{1, 1, 0.25f, 0.25f};
    const VisibilityErrors errors = visibility_errors(guess, truth, 2, 2);
    EXPECT_EQ(errors.penumbra_points, 2u);
    EXPECT_EQ(errors.penumbra_mean_absolute, 0.125);
    EXPECT_EQ(errors.mean_absolute, 1.25 / 4);
    const VisibilityErrors none = visibility_errors(std::vector<float>{1, 1}, std::vector<float>{0, 1}, 2, 1);
    EXPECT_EQ(none.penumbra_points, 0u);
    EXPECT_EQ(none.penumbra_mean_absolute, 0);
}

TEST(VisibilityErrors, FindsTheWorstTile) {
    const std::vector<float> truth = all(1);
    std::vector<float> mask = truth;
    // The last tile is 6 x 8 pixels: 24 wrong ones are half of it. More wrong pixels elsewhere are a smaller share.
    for (std::uint32_t i = 0; i < 24; ++i) mask[(32 + i / 6) * width + 64 + i % 6] = 0;
    for (std::uint32_t i = 0; i < 100; ++i) mask[(i / 10) * width + i % 10] = 0;
    const VisibilityErrors errors = visibility_errors(mask, truth, width, height);
    EXPECT_EQ(errors.worst_tile_x, 64u);
    EXPECT_EQ(errors.worst_tile_y, 32u);
    EXPECT_DOUBLE_EQ(errors.worst_tile, 0.5);
}

TEST(VisibilityErrors, InvertedStructureIsTheOppositeOfSimilar) {
    std::vector<float> inverted = checkered();
    for (float& v : inverted) v = 1 - v;
    EXPECT_LT(visibility_errors(inverted, checkered(), width, height).ssim, -0.9);
}

TEST(VisibilityErrors, NoNumberIsWrong) {
    const VisibilityErrors errors = visibility_errors(all(NAN), all(1), width, height);
    EXPECT_EQ(errors.wrongly_shadowed, width * height);
    EXPECT_EQ(errors.mean_absolute, 1.0);
}

TEST(VisibilityErrors, RefusesSizesThatDoNotFit) {
    EXPECT_THROW(visibility_errors(all(1), all(1), width, height + 1), InvalidArgument);
}

TEST(DifferencePicture, SaysWhichWayItIsWrong) {
    const std::vector<std::uint8_t> rgb =
        difference_picture(std::vector<float>{1, 0, 1, 0}, std::vector<float>{0, 1, 1, 0});
    ASSERT_EQ(rgb.size(), 12u);
    EXPECT_GT(rgb[0], rgb[2]);  // too bright: orange, more red than blue
    EXPECT_LT(rgb[3], rgb[5]);  // too dark: blue
    EXPECT_EQ(rgb[6], rgb[8]);  // right: grey
    EXPECT_GT(rgb[6], rgb[9]);  // and lit is brighter than shadow
}

}  // namespace
}  // namespace gnomon::measure
