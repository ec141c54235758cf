// SPDX-License-Identifier: MIT
// Technique shadow-map and its presets as a whole: beside exact truth, by what bias does to a flat floor, by the errors
// that settings are refused with.
#include <gtest/gtest.h>

#include <gnomon.hpp>
#include "support/floor_view.hpp"

namespace {

using namespace support;
using gnomon::Light;

/// A floor (triangle 0) with points on it, and slabs above.
LightScene floor_and_slabs(std::size_t slabs) {
    LightScene scene{"floor and slabs"};
    add(scene.triangles, {-40, 0, -40}, {40, 0, -40}, {0, 0, 80});
    Random random(12);
    for (std::size_t i = 0; i < slabs; ++i) {
        const float x = random.between(-1, 0.6f), z = random.between(-1, 0.6f), y = random.between(0.2f, 1);
        const float w = random.between(0.1f, 0.4f), d = random.between(0.1f, 0.4f);
        add(scene.triangles, {x, y, z}, {x + w, y, z}, {x + w, y, z + d});
        add(scene.triangles, {x + w, y, z + d}, {x, y, z + d}, {x, y, z});
    }
    for (int i = 0; i < 20000; ++i) add(scene.points, {random.between(-1, 1), 0, random.between(-1, 1)});
    scene.receivers.assign(scene.points.size() / 3, 0);
    return scene;
}

std::vector<float> visibility_of(const gnomon::Device& device, const LightScene& scene, const Light& light,
                                 const std::string& technique, const Settings& settings = {}) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    gnomon::Points points = upload_points(device, scene);
    points.set_camera(gnomon::Camera::look_at({0, 2, 3}, {0, 0, 0}, {0, 1, 0}, 60), 400, 200);
    return answer(device, *technique_with(device, settings, technique), triangles, points, light).visibility;
}

const Light sun = Light::directional({-0.3f, -1, -0.2f}), point_light = Light::point({0.3f, 3, 0.2f});

// The share of wrong points is that of texels on shadow edges: it falls as the texels' side.
TEST(ShadowMap, ErrorFallsWithResolutionTowardsTheTruth) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(12);
    for (const Light& light : {sun, point_light}) {
        const auto truth = visibility_of(device, scene, light, "frustum-traced");
        const auto error = [&](const char* size) {
            return mean_error(truth, visibility_of(device, scene, light, "shadow-map", {{"size", size}}));
        };
        const double coarse = error("64"), middle = error("256"), fine = error("1024");
        EXPECT_GT(coarse, 0.01);
        EXPECT_LT(middle, coarse / 2.5);
        EXPECT_LT(fine, middle / 2.5);
        EXPECT_LT(fine, 0.004);
    }
}

// Under grazing light a floor without casters is lit: by slope-scaled bias and by adaptive bias; without either it
// shadows itself.
TEST(ShadowMap, FlatFloorUnderGrazingLight) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(0);
    const Light grazing = Light::directional({1, -0.05f, 0.3f});
    const auto lit = [&](const Settings& settings) {
        double sum = 0;
        for (const float value : visibility_of(device, scene, grazing, "shadow-map", settings)) sum += value;
        return sum / double(scene.receivers.size());
    };
    EXPECT_EQ(lit({}), 1);
    EXPECT_EQ(lit({{"bias", "adaptive"}}), 1);
    EXPECT_EQ(lit({{"bias", "adaptive"}, {"lookup", "pcf"}, {"taps", "5"}}), 1);
    EXPECT_LT(lit({{"slope-bias", "0"}, {"constant-bias", "0"}}), 0.9);
}

// The epsilon of adaptive bias is K times the scene's diagonal (Dou et al. 2014): a slab nearer to the floor than this
// casts no shadow, one farther away casts all of it, whatever depths the receivers have.
TEST(ShadowMap, AdaptiveBiasHasAnEpsilonOfTheScenesDiagonal) {
    const gnomon::Device device;
    const double k = 0.01, flat_diagonal = std::sqrt(80.0 * 80 + 120 * 120);
    const auto lit_below = [&](double height, const Light& light) {
        LightScene scene{"floor and slab"};
        add(scene.triangles, {-40, 0, -40}, {40, 0, -40}, {0, 0, 80});
        const float y = static_cast<float>(height);
        add(scene.triangles, {-4, y, -4}, {4, y, -4}, {0, y, 8});
        Random random(12);
        for (int i = 0; i < 500; ++i) add(scene.points, {random.between(-1, 1), 0, random.between(-1, 1)});
        scene.receivers.assign(scene.points.size() / 3, 0);
        double sum = 0;
        for (const float value : visibility_of(device, scene, light, "adaptive-bias", {{"constant-bias", "0.01"}}))
            sum += value;
        return sum / double(scene.receivers.size());
    };
    // Depth is measured along the light: straight down, and along the axis of the cube's face.
    for (const Light& light : {Light::directional({0, -1, 0}), Light::point({0, 30, 0})}) {
        EXPECT_EQ(lit_below(0.95 * k * flat_diagonal, light), 1);
        EXPECT_EQ(lit_below(1.05 * k * flat_diagonal, light), 0);
    }
}

TEST(ShadowMap, AdaptiveBiasNeedsLessThanSlopeScaledBias) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(12);
    const auto truth = visibility_of(device, scene, sun, "frustum-traced");
    const Settings common{{"size", "256"}, {"lookup", "pcf"}, {"taps", "5"}};
    Settings scaled = common, adaptive = common;
    scaled.insert(scaled.end(), {{"slope-bias", "3"}, {"slope-limit", "1"}});
    adaptive.emplace_back("bias", "adaptive");
    EXPECT_LE(mean_error(truth, visibility_of(device, scene, sun, "shadow-map", adaptive)),
              mean_error(truth, visibility_of(device, scene, sun, "shadow-map", scaled)));
}

// Every technique of the family: near the truth, within [0, 1], the same bits for every group size.
TEST(ShadowMap, EveryPreset) {
    const gnomon::Device devices[] = {device_with(3), device_with(64)};
    const LightScene scene = floor_and_slabs(12);
    for (const Light& light : {sun, point_light}) {
        const auto truth = visibility_of(devices[1], scene, light, "frustum-traced");
        for (const auto& technique : gnomon::techniques()) {
            bool is_map = false;
            for (const auto& setting : technique.settings) is_map = is_map || setting.name == "store";
            if (!is_map) continue;
            const Settings settings{{"size", "512"}};
            const auto lit = visibility_of(devices[1], scene, light, technique.name, settings);
            for (const float value : lit) ASSERT_TRUE(value >= 0 && value <= 1) << technique.name << ": " << value;
            EXPECT_LT(mean_error(truth, lit), 0.06) << technique.name;
            EXPECT_EQ(lit, visibility_of(devices[0], scene, light, technique.name, settings)) << technique.name;
        }
    }
}

/// gnomon's own buffers in a run of technique shadow-map.
std::uint64_t memory_of(const gnomon::Device& device, const LightScene& scene, const Settings& settings) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const auto technique = technique_with(device, settings, "shadow-map");
    return answer(device, *technique, triangles, upload_points(device, scene), sun).statistics.device_memory_bytes;
}

// Of four numbers a texel, stored and filtered: 64 bits of memory, or 128; and almost the same shadow.
TEST(ShadowMap, MomentsOf64BitsTake64Bits) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(12);
    constexpr std::uint64_t texels = 256 * 256;
    for (const auto& [prefilter, maps] : {std::pair{"none", 1}, {"gaussian", 2}}) {
        Settings narrow{{"store", "moments"}, {"size", "256"}, {"prefilter", prefilter}, {"bits", "64"}}, wide = narrow;
        wide.back().second = "128";
        EXPECT_EQ(memory_of(device, scene, wide) - memory_of(device, scene, narrow), maps * texels * 8) << prefilter;
        const auto narrow_lit = visibility_of(device, scene, sun, "shadow-map", narrow),
                   wide_lit = visibility_of(device, scene, sun, "shadow-map", wide);
        EXPECT_LT(mean_error(narrow_lit, wide_lit), 0.02) << prefilter;
    }
}

// A box of one texel is the bilinear lookup itself.
TEST(ShadowMap, SummedAreasOfOneTexelChangeNothing) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(12);
    for (const auto& [store, bits] :
         {std::pair{"variance", "128"}, {"layered", "128"}, {"convolution", "128"}, {"moments", "64"}}) {
        const Settings plain{{"store", store}, {"size", "256"}, {"bits", bits}};
        Settings summed = plain;
        summed.insert(summed.end(), {{"prefilter", "summed-area"}, {"filter-width", "1"}});
        EXPECT_LT(mean_error(visibility_of(device, scene, sun, "shadow-map", plain),
                             visibility_of(device, scene, sun, "shadow-map", summed)),
                  1e-4)
            << store << ", " << bits;
    }
}

// A line of points at one distance from a straight edge, across the border of two slices at camera depth 21, which has
// an overlap of 0.1 x 20 before it. Texels of both lie along the edge, so each slice gives one visibility; blended, the
// first turns into the second from depth 19 to 21, at an even rate.
TEST(ShadowMap, SlicesBlendEvenlyWithinTheOverlap) {
    const gnomon::Device device;
    const auto depth_of = [](int i) { return 15 + 0.0123f * float(i); };
    constexpr int count = 700;
    Floats vertices, floor_points;
    add(vertices, {-90, 0, -90}, {90, 0, -90}, {0, 0, 180});
    add(vertices, {-30, 1, -90}, {0, 1, -90}, {0, 1, 90});
    add(vertices, {-30, 1, -90}, {0, 1, 90}, {-30, 1, 90});
    for (int i = 0; i < count; ++i) add(floor_points, {0.6f, 0, depth_of(i)});
    const auto triangles = gnomon::Triangles::upload(device, vertices);
    auto points = gnomon::Points::upload(device, floor_points, std::vector<std::uint32_t>(count, 0));
    points.set_camera(gnomon::Camera::look_at({0, 2, 0}, {0, 2, 1}, {0, 1, 0}, 60), 200, 100);
    const auto lit_along = [&](Settings settings) {
        settings.insert(settings.end(), {{"size", "128"},
                                         {"fit", "frustum"},
                                         {"cascades", "2"},
                                         {"depth-range", "planes"},
                                         {"near", "1"},
                                         {"far", "41"},
                                         {"lambda", "0"},
                                         {"overlap", "0.1"}});
        const auto technique = technique_with(device, settings, "shadow-map");
        return answer(device, *technique, triangles, points, Light::directional({0, -1, 0})).visibility;
    };
    for (const Settings& settings : {Settings{{"lookup", "bilinear"}, {"taps", "5"}},
                                     Settings{{"store", "variance"}, {"prefilter", "gaussian"}}}) {
        Settings blended = settings;
        blended.emplace_back("blend", "on");
        const auto off = lit_along(settings), on = lit_along(blended);
        const double first = off[0], second = off[count - 1];
        ASSERT_GT(std::fabs(second - first), 0.05) << "a border that nobody sees";
        for (int i = 0; i < count; ++i) {
            const double depth = depth_of(i), share = std::clamp((depth - 19) / 2, 0.0, 1.0);
            if (std::fabs(depth - 21) < 1e-3) continue;
            ASSERT_NEAR(off[std::size_t(i)], depth < 21 ? first : second, 2e-3) << depth;
            ASSERT_NEAR(on[std::size_t(i)], first + share * (second - first), 3e-3) << depth;
        }
    }
}

TEST(ShadowMap, NothingToDo) {
    const gnomon::Device device;
    LightScene scene = floor_and_slabs(1);
    for (const float value : visibility_of(device, {"", {}, scene.points, {}, scene.receivers}, sun, "shadow-map"))
        ASSERT_EQ(value, 1);
    EXPECT_TRUE(visibility_of(device, {"", scene.triangles}, sun, "vsm").empty());
    // Light from below: every point faces away.
    for (const float value : visibility_of(device, scene, Light::directional({0, 1, 0}), "msm128")) ASSERT_EQ(value, 0);
}

TEST(ShadowMap, BadSettingsAreRefusedInOneSentence) {
    const gnomon::Device device;
    const LightScene scene = floor_and_slabs(1);
    const auto expect_refused = [&](const Settings& settings, const std::string& part) {
        try {
            visibility_of(device, scene, sun, "shadow-map", settings);
            ADD_FAILURE() << "accepted; expected: " << part;
        } catch (const gnomon::InvalidArgument& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    expect_refused({{"size", "1"}}, "size is a whole number from 16 to 16384, not \"1\"");
    expect_refused({{"size", "100000"}}, "size is a whole number from 16 to 16384");
    expect_refused({{"exponent", "nan"}}, "exponent is a number from 0.1 to 80, not \"nan\"");
    expect_refused({{"blend", "2"}}, "blend is off or on, not \"2\"");
    expect_refused({{"store", "colour"}}, "store is depth, variance, layered");
    expect_refused({{"sharpness", "1"}}, "shadow-map has no setting \"sharpness\": it has size, store");
    expect_refused({{"prefilter", "gaussian"}}, "depths must not be filtered before they are compared");
    expect_refused({{"store", "variance"}, {"lookup", "pcf"}}, "lookup=pcf compares depths");
    expect_refused({{"store", "evsm4"}, {"bias", "adaptive"}}, "bias=adaptive compares depths");
    expect_refused({{"store", "evsm2"}, {"exponent", "60"}}, "overflow beyond exponent=42");
    expect_refused({{"store", "variance"}, {"prefilter", "gaussian"}, {"filter-width", "4"}}, "filter-width is odd");
    expect_refused({{"store", "exponential"}, {"prefilter", "summed-area"}}, "would lose its precision");
}

}  // namespace
