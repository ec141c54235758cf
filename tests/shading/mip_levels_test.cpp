// SPDX-License-Identifier: MIT
// Levels of colour textures: the kernels' against means over the texture itself, and against those of the host.
#include <gtest/gtest.h>

#include <cmath>

#include "shading/surface.hpp"
#include "support/srgb.hpp"

namespace {

using namespace gnomon;

struct Image {
    std::uint32_t width, height;
    std::vector<std::uint8_t> rgba;

    Image(std::uint32_t w, std::uint32_t h) : width(w), height(h), rgba(std::size_t(4) * w * h) {
        std::uint32_t state = 7 * w + h;
        for (std::uint8_t& value : rgba) value = std::uint8_t((state = state * 1664525u + 1013904223u) >> 24);
        for (std::size_t i = 3; i < rgba.size(); i += 8) rgba[i] = 0;  // every second texel is clear
    }
};

std::vector<std::uint8_t> levels_by_kernels(const Image& image, bool weighs_alpha, const DeviceOptions& options) {
    const Device device({}, options);
    const ColorTexture texture{image.width, image.height, image.rgba};
    const SurfaceTextures::OnDevice made(device, {{0, weighs_alpha}}, {&texture, 1}, 0);
    return session_of(device).read_values<std::uint8_t>(made.texels.get(), made.bytes);
}

constexpr std::pair<std::uint32_t, std::uint32_t> sizes[] = {{64, 64}, {16, 4}, {63, 17}, {1, 5},
                                                             {6, 1},   {1, 1},  {30, 50}};

TEST(MipLevels, AreTheSameBytesByKernelsAndByTheHost) {
    for (const bool gpu_kernels : {false, true})
        for (const bool weighs : {false, true})
            for (const auto& [width, height] : sizes) {
                const Image image(width, height);
                std::vector<std::uint8_t> host(level_bytes(width, height));
                write_levels({width, height, image.rgba}, weighs, 0, host.data());
                EXPECT_EQ(levels_by_kernels(image, weighs, {.gpu_kernels = gpu_kernels}), host)
                    << width << " x " << height << ", weighs " << weighs << ", for GPUs " << gpu_kernels;
            }
}

/// The last level is one texel: the mean of all, in linear light times weight.
TEST(MipLevels, TheLastIsTheMeanOfAll) {
    for (const bool weighs : {false, true})
        for (const auto& [width, height] : sizes) {
            const Image image(width, height);
            double sums[3] = {}, weights = 0;
            for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
                const double weight = weighs ? std::max<int>(image.rgba[i + 3], 1) : 255;
                for (std::size_t c = 0; c < 3; ++c) sums[c] += weight * support::linear_of_srgb(image.rgba[i + c]);
                weights += weight;
            }
            const auto levels = levels_by_kernels(image, weighs, {});
            const std::uint8_t* const last = &levels[levels.size() - 4];
            for (std::size_t c = 0; c < 3; ++c) {
                const double mean = sums[c] / weights;
                EXPECT_LE(support::linear_of_srgb(std::max(last[c] - 0.51, 0.0)), mean) << width << " x " << height;
                EXPECT_GE(support::linear_of_srgb(last[c] + 0.51), mean) << width << " x " << height;
            }
            EXPECT_NEAR(last[3], weights / (double(width) * height), 0.51);
        }
}

}  // namespace
