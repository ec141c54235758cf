// SPDX-License-Identifier: MIT
// Smooth pictures: the mean of the pictures of a pixel's samples, where the share of each colour is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "shading/surface.hpp"
#include "support/device.hpp"
#include "support/srgb.hpp"

namespace {

using namespace gnomon;
using Floats = std::vector<float>;

/// A rectangle at z = 0 from (-1, -1) to (right, 1), and a camera before it whose picture shows -1 to 1.
struct Rectangle {
    Device device;
    Triangles triangles;
    View view;
    Materials materials{{0, 0}, {{0.8f, 0.8f, 0.8f}}};
    Floats coordinates{0, 1, 1, 1, 1, 0, 0, 1, 1, 0, 0, 0};

    explicit Rectangle(float right = 1, std::uint32_t side = 1, const DeviceOptions& options = {})
        : device({}, options),
          triangles(
              Triangles::upload(device, {{-1, -1, 0, right, -1, 0, right, 1, 0, -1, -1, 0, right, 1, 0, -1, 1, 0}})),
          view(look(device, triangles, Camera::look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90), side, side)) {}

    std::vector<std::uint8_t> smooth(std::uint32_t samples, std::span<const Visibility> visibilities = {},
                                     std::span<const Light> lights = {}) const {
        const Appearance appearance = Appearance::upload(device, materials);
        SampleViews views(device, triangles, view, samples);
        PictureMean mean(device, view.points.count(), samples);
        for (std::size_t i = 0; i < views.count(); ++i)
            mean.add(appearance.surfaces(triangles, views.at(i)), visibilities, lights);
        return mean.read();
    }
};

/// Every column of 1/32 pixel has one of the 32 samples: a rectangle that ends between columns has as many of them as
/// it covers. Its ambient light is .25 of .8, and the rest of the pixel shows the sky.
TEST(PictureMean, AnEdgePixelHasTheSharesOfItsSamples) {
    // The sky's blue is above .8: Khronos' curve (shade.cl) takes a little of all channels, and of their saturation.
    const double blue = 1 - 0.04 / (0.86 - 0.6), own = 1 / (1 + 0.15 * (0.86 - blue));
    std::array<double, 3> sky{0.46, 0.62, 0.86};
    for (double& channel : sky) channel = channel * blue / 0.86 * own + blue * (1 - own);
    for (const bool gpu_kernels : {false, true})
        for (const int columns : {0, 3, 8, 31, 32}) {
            const Rectangle scene(-1 + 2 * float(columns) / 32, 1, {.gpu_kernels = gpu_kernels});
            const std::vector<std::uint8_t> rgba = scene.smooth(32);
            const double share = columns / 32.0;
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(support::linear_of_srgb(rgba[k]), share * 0.2 + (1 - share) * sky[k], 0.004)
                    << columns << " " << k;
            EXPECT_EQ(rgba[3], 255);
        }
}

/// The mean of one picture is that picture, and so is that of the same picture four times.
TEST(PictureMean, OfEqualPicturesIsThePicture) {
    const Rectangle scene(0.3f, 24);
    const Appearance appearance = Appearance::upload(scene.device, scene.materials);
    const Light light = Light::directional({0.5f, -0.25f, -1});
    const Visibility visibility(scene.device, scene.view.points.count());
    make_technique("frustum-traced", scene.device)->run(scene.triangles, scene.view.points, light, visibility);
    const Surfaces surfaces = appearance.surfaces(scene.triangles, scene.view);
    const Picture once = shade(surfaces, {&visibility, 1}, {&light, 1}, {.exposure_ev = std::nullopt});
    for (const std::uint32_t pictures : {1u, 4u}) {
        PictureMean mean(scene.device, surfaces.count(), pictures);
        std::optional<double> exposure;
        for (std::uint32_t i = 0; i < pictures; ++i)
            exposure = mean.add(surfaces, {&visibility, 1}, {&light, 1}, {.exposure_ev = exposure});
        EXPECT_EQ(*exposure, once.exposure_ev);
        EXPECT_EQ(mean.read(), once.rgba) << pictures;
    }
}

/// One pixel shows a texture of 16 x 16 texels, all different: each sample has the texel that it lies in.
TEST(PictureMean, TexturesAreTakenAtTheSamples) {
    Rectangle scene;
    scene.materials.base_color = {{1, 1, 1}};
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (const int value : {16 * x + 8, 16 * y + 8, 0, 255}) rgba.push_back(std::uint8_t(value));
    const ColorTexture texture{16, 16, rgba};
    const ColorTextureUse use{.texture = 0, .minification = TextureMinification::nearest};
    const SurfaceDetail detail{scene.coordinates, {}, {}, {&use, 1}, {&texture, 1}};
    const Appearance appearance = Appearance::upload(scene.device, scene.materials, detail);
    // Each of 32 samples lies in the middle of 1/32 pixel, so that none lies on the edge of a texel.
    SampleViews views(scene.device, scene.triangles, scene.view, 32);
    ASSERT_EQ(views.count(), 32u);
    for (std::size_t i = 0; i < views.count(); ++i) {
        const SampleOffset offset = sample_pattern(32)[i];
        const std::vector<float> albedo = appearance.surfaces(scene.triangles, views.at(i)).read().albedo;
        const auto texel = [](int units) { return (units + 32) / 4; };
        EXPECT_NEAR(albedo[0], support::linear_of_srgb(16 * texel(offset.x) + 8), 1e-5) << i;
        EXPECT_NEAR(albedo[1], support::linear_of_srgb(16 * texel(offset.y) + 8), 1e-5) << i;
    }
}

/// A sample stands for a square of 1/4 pixel's side with 16 samples: textures keep what a whole pixel would blur.
TEST(PictureMean, TexturesAreFilteredOverASamplesShare) {
    Rectangle scene;
    scene.materials.base_color = {{1, 1, 1}};
    std::vector<std::uint8_t> rgba;
    for (int i = 0; i < 16; ++i) {
        const std::uint8_t value = i % 4 < 2 ? 255 : 0;  // the left half white
        rgba.insert(rgba.end(), {value, value, value, 255});
    }
    const ColorTexture texture{4, 4, rgba};
    const ColorTextureUse use{.texture = 0, .wrap_u = TextureWrap::clamp, .wrap_v = TextureWrap::clamp};
    const SurfaceDetail detail{scene.coordinates, {}, {}, {&use, 1}, {&texture, 1}};
    const Appearance appearance = Appearance::upload(scene.device, scene.materials, detail);
    EXPECT_NEAR(appearance.surfaces(scene.triangles, scene.view).read().albedo[0], 0.5, 0.01);
    SampleViews views(scene.device, scene.triangles, scene.view, 16);
    for (std::size_t i = 0; i < views.count(); ++i) {
        const int x = sample_pattern(16)[i].x;
        if (std::abs(x) < 16) continue;  // within a texel of the edge both are blended
        EXPECT_NEAR(appearance.surfaces(scene.triangles, views.at(i)).read().albedo[0], x < 0 ? 1 : 0, 0.02) << x;
    }
}

TEST(PictureMean, RefusesWhatDoesNotFitTogether) {
    const Rectangle scene, larger(1, 2);
    const Appearance appearance = Appearance::upload(scene.device, scene.materials);
    EXPECT_THROW(PictureMean(scene.device, 1, 0), InvalidArgument);
    PictureMean mean(scene.device, 1, 1);
    EXPECT_THROW(mean.read(), InvalidArgument);
    EXPECT_THROW(mean.add(Surfaces(larger.device, larger.triangles, larger.view, larger.materials), {}, {}),
                 InvalidArgument);
    const Surfaces surfaces = appearance.surfaces(scene.triangles, scene.view);
    mean.add(surfaces, {}, {});
    EXPECT_THROW(mean.add(surfaces, {}, {}), InvalidArgument);
    EXPECT_THROW(SampleViews(scene.device, scene.triangles, scene.view, 3), InvalidArgument);
}

}  // namespace
