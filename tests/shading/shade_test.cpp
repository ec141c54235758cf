// SPDX-License-Identifier: MIT
// Pictures: lights on interpolated normals, exposure and the tone curve.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shading/surface.hpp"
#include "support/floor_view.hpp"
#include "support/srgb.hpp"

namespace {

using namespace gnomon;
using support::Floats;

/// A sphere of flat triangles with the sphere's normals, `segments` around and half as many from pole to pole.
struct Sphere {
    Floats triangles;
    std::vector<std::uint32_t> normals;
    Materials materials{{}, {{0.9f, 0.9f, 0.9f}}};

    explicit Sphere(int segments) {
        const auto at = [&](int i, int j) {
            const double a = 2 * std::numbers::pi * i / segments, b = 2 * std::numbers::pi * j / segments;
            return Float3{float(std::sin(b) * std::cos(a)), float(std::cos(b)), float(std::sin(b) * std::sin(a))};
        };
        const auto add = [&](const Float3& p) {
            triangles.insert(triangles.end(), p.begin(), p.end());
            normals.push_back(pack_normal(p));
        };
        for (int i = 0; i < segments; ++i)
            for (int j = 0; j < segments / 2; ++j) {
                for (const Float3& p : {at(i, j), at(i + 1, j), at(i + 1, j + 1)}) add(p);
                for (const Float3& p : {at(i, j), at(i + 1, j + 1), at(i, j + 1)}) add(p);
            }
        materials.triangle_material.resize(triangles.size() / 9);
    }
};

/// The largest step of light between neighbours in a sphere's middle rows, for lights from the side at several angles.
double largest_step(const Sphere& sphere, bool is_smooth) {
    constexpr std::uint32_t side = 256;
    const Device device;
    const Triangles triangles = Triangles::upload(device, sphere.triangles);
    const View view = look(device, triangles, Camera::look_at({0, 0.4f, 4}, {0, 0, 0}, {0, 1, 0}, 30), side, side);
    SurfaceDetail detail;
    if (is_smooth) detail.corner_normals = sphere.normals;
    const Surfaces surfaces(device, triangles, view, sphere.materials, detail);
    const auto technique = make_technique("frustum-traced", device);
    const Visibility visibility(device, view.points.count());
    double largest = 0;
    for (double degrees = 0; degrees < 15; degrees += 1.25) {
        const double angle = degrees * std::numbers::pi / 180;
        const Light light = Light::directional({-float(std::cos(angle)), -0.1f, float(std::sin(angle))});
        technique->run(triangles, view.points, light, visibility);
        const Picture picture = shade(surfaces, {&visibility, 1}, {&light, 1});
        for (std::uint32_t y = side / 3; y < 2 * side / 3; ++y)
            for (std::uint32_t x = side / 4; x < 3 * side / 4; ++x) {
                const std::size_t i = 4 * (std::size_t(y) * side + x);
                largest = std::max(largest, std::abs(support::linear_of_srgb(picture.rgba[i]) -
                                                     support::linear_of_srgb(picture.rgba[i + 4])));
            }
    }
    return largest;
}

/// The triangles are 15 degrees apart: by their own normals the light changes by up to .17 from one to the next.
TEST(Shade, ASphereShowsNoTriangles) {
    const Sphere sphere(24);
    const double flat = largest_step(sphere, false), smooth = largest_step(sphere, true);
    std::printf("largest step: flat %.3f, smooth %.3f\n", flat, smooth);
    EXPECT_GT(flat, 0.12);
    EXPECT_LT(smooth, 0.035);
}

/// The square from (-1, -1, 0) to (1, 1, 0), seen and lit from the front.
struct Lit {
    Device device;
    Triangles triangles = Triangles::upload(device, {{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0}});
    View view;
    Visibility visibility;
    Light light = Light::directional({0, 0, -1});

    explicit Lit(std::uint32_t side = 1, double distance = 1)
        : view(look(device, triangles, Camera::look_at({0, 0, float(distance)}, {0, 0, 0}, {0, 1, 0}, 90), side, side)),
          visibility(device, view.points.count()) {
        make_technique("frustum-traced", device)->run(triangles, view.points, light, visibility);
    }
    Picture shaded(const Float3& color, std::size_t lights, const ShadeOptions& options = {}) const {
        const Surfaces surfaces(device, triangles, view, {{0, 0}, {color}});
        return shade(surfaces, std::vector<Visibility>(lights, visibility), std::vector<Light>(lights, light), options);
    }
    double brightness(const Float3& color, std::size_t lights, const ShadeOptions& options = {}) const {
        return support::linear_of_srgb(shaded(color, lights, options).rgba[0]);
    }
};

/// White under n lights: .25 ambient + .75 n. From .8 on Khronos' curve has 1 - .04 / (x - .6).
TEST(Shade, BrightLightFollowsTheToneCurve) {
    const Lit lit;
    const double half_a_byte = 0.005;
    EXPECT_NEAR(lit.brightness({0.8f, 0.8f, 0.8f}, 0), 0.2, half_a_byte);
    EXPECT_NEAR(lit.brightness({0.8f, 0.8f, 0.8f}, 1), 0.8, half_a_byte);
    EXPECT_NEAR(lit.brightness({1, 1, 1}, 1), 0.9, half_a_byte);
    EXPECT_NEAR(lit.brightness({1, 1, 1}, 3), 1 - 0.04 / 1.9, half_a_byte);
    EXPECT_NEAR(lit.brightness({1, 1, 1}, 1, {.exposure_ev = -1}), 0.5, half_a_byte);
    EXPECT_NEAR(lit.brightness({1, 1, 1}, 1, {.exposure_ev = 1}), 1 - 0.04 / 1.4, half_a_byte);
    // Red at 5 times its light is nearly white: 1 - .04 / 4.4 and a share 1 / (1 + .15 (5 - .99)) of its own colour.
    const std::vector<std::uint8_t> red = lit.shaded({1, 0, 0}, 1, {.exposure_ev = std::log2(5)}).rgba;
    EXPECT_NEAR(support::linear_of_srgb(red[0]), 1 - 0.04 / 4.4, half_a_byte);
    EXPECT_NEAR(support::linear_of_srgb(red[1]), (1 - 0.04 / 4.4) * (1 - 1 / (1 + 0.15 * (5 - (1 - 0.04 / 4.4)))),
                half_a_byte);
}

TEST(Shade, MeteredLightIsBelowTheCurve) {
    const Lit lit;
    const Picture metered = lit.shaded({0.1f, 0.1f, 0.1f}, 1, {.exposure_ev = std::nullopt});
    EXPECT_NEAR(metered.exposure_ev, 3, 1e-5);  // .1 to .8
    EXPECT_NEAR(support::linear_of_srgb(metered.rgba[0]), 0.8, 0.005);
    const Picture black = lit.shaded({0, 0, 0}, 1, {.exposure_ev = std::nullopt});
    EXPECT_EQ(black.exposure_ev, 0);
    const Lit sky(1, -3);  // the eye looks away from behind: nothing of the square is in the middle
    EXPECT_TRUE(std::isfinite(sky.shaded({1, 1, 1}, 1, {.exposure_ev = std::nullopt}).exposure_ev));
}

/// Ambient light is .25 here. Of the sky it is half of that and .45 of blueish white: .8, .97, 1.26.
TEST(Shade, TheSkysLightTakesThePlaceOfAmbientLight) {
    const Lit lit;
    const std::vector<float> none{0}, half{0.5f}, two{0, 0};
    EXPECT_NEAR(lit.brightness({1, 1, 1}, 0, {.sky_shares = none}), 0.125, 0.003);
    const std::vector<std::uint8_t> rgba = lit.shaded({1, 1, 1}, 0, {.sky_shares = half}).rgba;
    EXPECT_NEAR(support::linear_of_srgb(rgba[0]), 0.125 + 0.5 * 0.45 * 0.8, 0.003);
    EXPECT_NEAR(support::linear_of_srgb(rgba[2]), 0.125 + 0.5 * 0.45 * 1.26, 0.003);
    EXPECT_THROW(lit.shaded({1, 1, 1}, 0, {.sky_shares = two}), InvalidArgument);
    EXPECT_THROW(lit.shaded({1, 1, 1}, 0, {.exposure_ev = NAN}), InvalidArgument);
}

/// The light of a white surface here, by the formula: ambient, and each light that reaches the point.
double light_at(const ViewOnHost& seen, std::size_t pixel, std::span<const Light> lights,
                std::span<const std::vector<float>> visibilities) {
    const float *n = &seen.normal[3 * pixel], *p = &seen.position[3 * pixel];
    double light = 0.25 * (1 + 0.35 * n[1] + 0.15 * n[0]);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        double l[3], square = 0, cosine = 0;
        for (int c = 0; c < 3; ++c) l[c] = lights[i].xyzw[c] - (lights[i].is_directional() ? 0 : double(p[c]));
        for (const double c : l) square += c * c;
        for (int c = 0; c < 3; ++c) cosine += n[c] * l[c] / std::sqrt(square);
        light += 0.75 * visibilities[i][pixel] * std::max(cosine, 0.0);
    }
    return light;
}

/// Khronos' curve from .8 on.
std::array<double, 3> curved(std::array<double, 3> light) {
    const double peak = std::ranges::max(light);
    if (peak <= 0.8) return light;
    const double mapped = 1 - 0.04 / (peak - 0.6), share = 1 / (1 + 0.15 * (peak - mapped));
    for (double& c : light) c = c * mapped / peak * share + mapped * (1 - share);
    return light;
}

/// Pictures of whole blocks of 4 x 4 pixels, and others, whose last block is not full.
TEST(Shade, EachPixelHasItsOwnMaterialNormalAndLights) {
    const Device device;
    const Triangles triangles = Triangles::upload(device, support::over_a_floor(support::one_triangle));
    const Materials materials{{0, 1, 2}, {{0.5f, 0.1f, 0.1f}, {0.1f, 0.5f, 0.1f}, {0.2f, 0.2f, 0.5f}}};
    const std::vector<Light> lights{support::lights()[0], support::lights()[2]};
    const auto technique = make_technique("frustum-traced", device);
    for (const auto& [width, height] : {std::pair(48u, 40u), std::pair(47u, 33u), std::pair(3u, 5u)}) {
        const Camera camera = Camera::look_at({0, 2, 4}, {0, 0.5f, 0}, {0, 1, 0}, 90);
        const View view = look(device, triangles, camera, width, height);
        const ViewOnHost seen = view.read(device, triangles);
        std::vector<Visibility> visibilities;
        std::vector<std::vector<float>> masks;
        for (const Light& light : lights) {
            visibilities.emplace_back(device, view.points.count());
            technique->run(triangles, view.points, light, visibilities.back());
            masks.push_back(visibilities.back().read());
        }
        const std::vector<std::uint8_t> rgba = shade(device, triangles, view, visibilities, materials, lights);
        for (std::size_t i = 0; i < seen.receiver.size(); ++i) {
            const bool is_sky = seen.receiver[i] == no_receiver;
            const Float3 color = is_sky ? Float3{0.46f, 0.62f, 0.86f} : materials.base_color[seen.receiver[i]];
            const double light = is_sky ? 1 : light_at(seen, i, lights, masks);
            const auto shown = curved({color[0] * light, color[1] * light, color[2] * light});
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(support::linear_of_srgb(rgba[4 * i + c]), shown[c], 0.005) << width << ", " << i;
            ASSERT_EQ(rgba[4 * i + 3], 255);
        }
    }
}

}  // namespace
