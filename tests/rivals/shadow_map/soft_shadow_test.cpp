// SPDX-License-Identifier: MIT
// Percentage-closer soft shadows beside the exact shadow of an area light.
//
// The scene has a penumbra that can be worked out by hand: a caster at height h whose edge is the line x = 0, a floor
// at height 0 and a square light of side s at height H above that line. A floor point at x sees the share
//   clamp(1/2 + x / w, 0, 1) of the light,  w = s h / (H - h),
// by similar triangles: the line from the point over the edge meets the light at -x (H - h) / h. A sun of tangent s
// across has w = s h.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scene/scene.hpp"
#include "support/area_light.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

constexpr int samples = 12;     // of the light, along a side
constexpr float half_span = 1;  // of the points along x
constexpr int columns = 1000, rows = 8;

struct CasterEdge {
    gnomon::Triangles triangles;
    gnomon::Points points;  ///< on the floor, row by row along x

    CasterEdge(const gnomon::Device& device, float height)
        : triangles(gnomon::Triangles::upload(device, floor_and_caster(height))),
          points(gnomon::Points::upload(device, places(), std::vector<std::uint32_t>(columns * rows, 0))) {}

    static Floats floor_and_caster(float height) {
        Floats triangles;
        add(triangles, {-40, 0, -40}, {40, 0, -40}, {0, 0, 80});
        add(triangles, {0, height, -3}, {0, height, 3}, {-3, height, 3});
        add(triangles, {0, height, -3}, {-3, height, 3}, {-3, height, -3});
        return triangles;
    }
    static Floats places() {
        Floats points;
        for (int i = 0; i < columns * rows; ++i) add(points, {x_of(i), 0, 0.05f * float(i / columns) - 0.2f});
        return points;
    }
    static float x_of(int i) { return half_span * (2 * (float(i % columns) + 0.5f) / columns - 1); }
};

struct AreaLight {
    const char* name;
    gnomon::Light middle;
    std::vector<gnomon::Light> parts;
    float size;    ///< setting light-size
    float height;  ///< infinite: the size is a tangent

    double penumbra_width(float caster) const {
        return std::isinf(height) ? size * caster : size * caster / (height - caster);
    }
};

std::vector<AreaLight> area_lights() {
    return {{"point light", gnomon::Light::point({0, 4, 0}), square_light({0, 4, 0}, 0.5f, samples), 0.5f, 4},
            {"sun", gnomon::Light::directional({0, -1, 0}), square_sun(0.25f, samples), 0.25f, INFINITY}};
}

std::vector<double> shadow_map_visibility(const gnomon::Device& device, const CasterEdge& edge, const AreaLight& light,
                                          const char* technique) {
    const auto made = gnomon::make_technique(technique, device);
    made->set("size", "1024");
    made->set("bias", "adaptive");
    made->set("light-size", std::to_string(light.size));
    const gnomon::Visibility visibility(device, edge.points.count());
    made->run(edge.triangles, edge.points, light.middle, visibility);
    const std::vector<float> lit = visibility.read();
    return {lit.begin(), lit.end()};
}

double mean_error(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(a[i] - b[i]);
    return sum / double(a.size());
}

/// Of a linear ramp from 0 to 1 the integral of 1 - |2 v - 1| is half its width; of a hard edge it is 0.
double measured_width(const std::vector<double>& visibility) {
    double sum = 0;
    for (const double v : visibility) sum += 1 - std::fabs(2 * v - 1);
    return 2 * sum / double(visibility.size()) * 2 * half_span;
}

constexpr float heights[] = {0.5f, 1, 2, 3};  // the last one is nearer to the lamp than half-way

// The truth itself: n columns of lights make n steps of 1/n, each half a step or less from the ramp.
TEST(SoftShadow, SamplesOfTheLightFollowTheRamp) {
    const gnomon::Device device;
    for (const AreaLight& light : area_lights())
        for (const float height : heights) {
            const CasterEdge edge(device, height);
            const auto truth = area_visibility(device, edge.triangles, edge.points, light.parts);
            for (std::size_t i = 0; i < truth.size(); ++i) {
                const double x = CasterEdge::x_of(int(i));
                const double ramp = std::clamp(0.5 + x / light.penumbra_width(height), 0.0, 1.0);
                ASSERT_NEAR(truth[i], ramp, 0.5 / samples + 1e-4)
                    << light.name << ", caster at " << height << ", x " << x;
            }
        }
}

// The penumbra of pcss is as wide as the light's, and grows with the caster's height as it does.
TEST(SoftShadow, PcssIsNearerToTheAreaLightThanAHardMap) {
    const gnomon::Device device;
    for (const AreaLight& light : area_lights())
        for (const float height : heights) {
            SCOPED_TRACE(std::string(light.name) + ", caster at " + std::to_string(height));
            const CasterEdge edge(device, height);
            const auto truth = area_visibility(device, edge.triangles, edge.points, light.parts);
            const auto soft = shadow_map_visibility(device, edge, light, "pcss");
            const auto hard = shadow_map_visibility(device, edge, light, "shadow-map");
            const double by_hand = light.penumbra_width(height);
            EXPECT_LT(mean_error(truth, soft), 0.25 * mean_error(truth, hard)) << measured_width(soft);
            EXPECT_NEAR(measured_width(soft), by_hand, 0.1 * by_hand);
            EXPECT_EQ(measured_width(hard), 0);
        }
}

// A grid common to all points gives 7 steps, each up to half a step wrong; a pattern of each point's own has 49.
TEST(SoftShadow, PcssHasNoBands) {
    const gnomon::Device device;
    for (const AreaLight& light : area_lights())
        for (const float height : heights) {
            const CasterEdge edge(device, height);
            const auto soft = shadow_map_visibility(device, edge, light, "pcss");
            double largest = 0;
            for (std::size_t i = 0; i < soft.size(); ++i) {
                const double x = CasterEdge::x_of(int(i)), width = light.penumbra_width(height);
                largest = std::max(largest, std::fabs(soft[i] - std::clamp(0.5 + x / width, 0.0, 1.0)));
            }
            EXPECT_LT(largest, 0.045) << light.name << ", caster at " << height;
        }
}

// Beyond the penumbra, by two texels or more, points are dark or lit as they are in truth. A lamp's size counts across
// the ray to it.
TEST(SoftShadow, PcssIsExactInUmbraAndFullLight) {
    const gnomon::Device device;
    for (const AreaLight& light : area_lights())
        for (const float height : heights) {
            const CasterEdge edge(device, height);
            const auto soft = shadow_map_visibility(device, edge, light, "pcss");
            int beyond = 0, off = 0;
            for (std::size_t i = 0; i < soft.size(); ++i) {
                const double x = CasterEdge::x_of(int(i));
                const double half_width = light.penumbra_width(height) / 2 * std::hypot(1, x / light.height);
                if (std::fabs(x) < half_width + 4 * half_span / 1024) continue;
                ++beyond;
                off += std::fabs(soft[i] - (x > 0 ? 1 : 0)) > 1.0 / 256;
            }
            EXPECT_GT(beyond, 1000);
            EXPECT_LE(off, beyond / 1000) << light.name << ", caster at " << height;
        }
}

// The atrium at noon under a sun of 2.86 degrees, 256 exact ones: casters at many depths, walls steep to the light.
TEST(SoftShadow, PcssIsNearerToTheSunInSponzaThanAHardMap) {
    const gnomon::Device device;
    const auto scene = gnomon::scene::load(GNOMON_SCENES "/sponza.glb");
    const auto triangles = gnomon::scene::upload(device, scene);
    const auto camera = gnomon::Camera::look_at({-1000, 150, -40}, {200, 200, -30}, {0, 1, 0}, 60);
    const gnomon::View view = gnomon::look(device, triangles, camera, 160, 90);
    const gnomon::Light middle = gnomon::Light::directional({0.12f, -1, 0.06f});
    const auto truth = area_visibility(device, triangles, view.points, tilted_square_sun({0.12, -1, 0.06}, 0.05, 16));
    const auto visibility_of = [&](const char* name) {
        const auto technique = gnomon::make_technique(name, device);
        if (name == std::string("pcss")) technique->set("light-size", "0.05");
        const gnomon::Visibility visibility(device, view.points.count());
        technique->run(triangles, view.points, middle, visibility);
        const std::vector<float> lit = visibility.read();
        return std::vector<double>(lit.begin(), lit.end());
    };
    const auto soft = visibility_of("pcss"), hard = visibility_of("frustum-traced");
    EXPECT_LT(mean_error(truth, soft), 0.7 * mean_error(truth, hard));
    std::vector<double> penumbra[3];
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (truth[i] > 0.5 / 256 && truth[i] < 1 - 0.5 / 256)
            for (const auto& [k, from] : {std::pair{0, &truth}, {1, &soft}, {2, &hard}})
                penumbra[k].push_back((*from)[i]);
    ASSERT_GT(penumbra[0].size(), 1000u);
    EXPECT_LT(mean_error(penumbra[0], penumbra[1]), 0.3 * mean_error(penumbra[0], penumbra[2]));
}

}  // namespace
