// SPDX-License-Identifier: MIT
// Sub-pixel shadow map by its promises: never wrongly in shadow; the truth itself where one triangle casts, however
// large the texels; more texels and neighbours only help.
#include <gtest/gtest.h>

#include "support/floor_view.hpp"

namespace {

using namespace support;

class SubPixelShadowMap : public FloorView {
protected:
    Errors errors(const Floats& scene, const gnomon::Light& light, const Settings& settings) {
        return FloorView::errors(scene, light, "sub-pixel", settings);
    }
};

TEST_F(SubPixelShadowMap, OneCasterIsTheTruthHoweverLargeTheTexels) {
    for (const gnomon::Light& light : lights())
        for (const char* size : {"16", "100", "512"})
            for (const char* neighbours : {"on", "off"}) {
                SCOPED_TRACE(std::string(size) + ", neighbours " + neighbours + ", w " + std::to_string(light.xyzw[3]));
                const Errors found =
                    errors(over_a_floor(one_triangle), light, {{"map-size", size}, {"neighbours", neighbours}});
                EXPECT_EQ(found.wrongly_lit, 0u);
                EXPECT_EQ(found.wrongly_shadowed, 0u);
                EXPECT_GT(found.in_shadow, 100u) << "a scene without shadow proves nothing";
                EXPECT_GT(found.lit, 100u);
            }
}

TEST_F(SubPixelShadowMap, NothingIsWronglyInShadow) {
    for (const Floats& casters : {icosphere(2, 0.8f), soup(200, 0.5f, 5), slivers(50, 0.02f, 3)})
        for (const gnomon::Light& light : lights())
            for (const char* size : {"16", "256"}) {
                const Errors found = errors(over_a_floor(casters), light, {{"map-size", size}});
                EXPECT_EQ(found.wrongly_shadowed, 0u);
                EXPECT_GT(found.in_shadow, found.wrongly_lit) << "some of the shadow must be found";
                EXPECT_GT(found.lit, 100u);
            }
}

TEST_F(SubPixelShadowMap, TexelsAndNeighboursOnlyHelp) {
    const Floats scene = over_a_floor(icosphere(3, 0.8f));
    for (const gnomon::Light& light : lights()) {
        const std::size_t coarse = errors(scene, light, {{"map-size", "32"}}).wrongly_lit;
        const std::size_t fine = errors(scene, light, {{"map-size", "512"}}).wrongly_lit;
        const std::size_t alone = errors(scene, light, {{"map-size", "32"}, {"neighbours", "off"}}).wrongly_lit;
        EXPECT_LT(fine, coarse);
        EXPECT_LT(coarse, alone);
    }
}

TEST_F(SubPixelShadowMap, CountsWhatItSays) {
    const std::vector<float> mask =
        run(over_a_floor(one_triangle), lights().front(), "sub-pixel", {{"map-size", "64"}});
    EXPECT_EQ(statistics_.count("points_in_shadow"), std::uint64_t(std::count(mask.begin(), mask.end(), 0.0f)));
    EXPECT_EQ(statistics_.count("texels"), 64u * 64u);
    EXPECT_GT(statistics_.count("texels_with_triangle"), 64u * 64u / 2);
    EXPECT_LE(statistics_.count("texels_with_triangle"), 64u * 64u);
}

// Triangles that cover a grid of 4096 x 4096 are in more tiles than there is room for at first.
TEST_F(SubPixelShadowMap, ListsThatAreTooShortGrow) {
    const Errors found = errors(over_a_floor({-9, 2, -9, -9, 2, 9, 9, 2, 9}), lights().front(), {{"map-size", "4096"}});
    EXPECT_EQ(found.wrongly_lit + found.wrongly_shadowed, 0u);
    EXPECT_GT(found.in_shadow, 100u);
    EXPECT_GT(statistics_.count("lists_grown"), 0u);
}

/// Steep sides around a tip each: where the tip is, all of them come equally near to the light.
Floats umbrellas(std::size_t count) {
    Random random(11);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const Float3 tip = {random.between(-2, 2), random.between(0, 1), random.between(-2, 2)};
        const auto rim = [&](int k) {
            const float angle = float(k % 12) * 0.5236f;
            return Float3{tip[0] + 0.3f * std::cos(angle), tip[1] - 0.5f, tip[2] + 0.3f * std::sin(angle)};
        };
        for (int k = 0; k < 12; ++k) add(triangles, tip, rim(k), rim(k + 1));
    }
    return triangles;
}

// Which of several triangles at one height is kept must not depend on the order of work.
TEST_F(SubPixelShadowMap, SameBitsForEveryWorkGroupSize) {
    const Floats scene = over_a_floor(umbrellas(400));
    const Settings settings{{"map-size", "64"}, {"neighbours", "off"}};
    const std::vector<float> expected = run(scene, lights().front(), "sub-pixel", settings);
    for (const std::uint32_t size : FEW_WORK_GROUP_SIZES) {
        device_ = device_with(size);
        for (int again = 0; again < 5; ++again)
            EXPECT_EQ(run(scene, lights().front(), "sub-pixel", settings), expected) << size;
    }
}

// Points given by hand, without receivers or an eye; absent points and a broken triangle among them.
TEST_F(SubPixelShadowMap, TakesPointsAndTrianglesAsTheyAre) {
    const float nan = std::nanf("");
    Floats scene = one_triangle;
    add(scene, {0, nan, 0}, {1, 2, 0}, {0, 2, 1});
    const auto triangles = gnomon::Triangles::upload(device_, scene);
    const auto points = gnomon::Points::upload(device_, Floats{0, -1, 0, 5, -1, 0, nan, 0, 0, 0, 2, 0});
    const gnomon::Visibility visibility(device_, points.count());
    const auto technique = gnomon::make_technique("sub-pixel", device_);
    technique->run(triangles, points, gnomon::Light::directional({0, -1, 0}), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{0, 1, 1, 1}));
    // What a triangle does not do to its own points.
    const auto owned = gnomon::Points::upload(device_, Floats{0, -1, 0, 0, -1, 0}, std::vector<std::uint32_t>{0, 1});
    technique->run(triangles, owned, gnomon::Light::directional({0, -1, 0}), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 0, 1, 1}));
    technique->run(gnomon::Triangles::upload(device_, {}), points, lights().back(), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 1, 1, 1}));
}

TEST_F(SubPixelShadowMap, RefusesBadSettings) {
    const auto technique = gnomon::make_technique("sub-pixel", device_);
    for (const auto& [key, value] :
         Settings{{"map-size", "8"}, {"map-size", "100000"}, {"map-size", "many"}, {"neighbours", "2"}, {"bias", "1"}})
        EXPECT_THROW(technique->set(key, value), gnomon::InvalidArgument) << key << " " << value;
}

}  // namespace
