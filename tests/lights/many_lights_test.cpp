// SPDX-License-Identifier: MIT
// Many lights at once. Bits are compared with the oracle, light by light, for tables in which rays of neighbouring
// lights pass exactly through edges and vertices; sums with integers of the tests' own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "support/device.hpp"
#include "support/light_scenes.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;
using gnomon::Lights;

constexpr gnomon::LightsWanted EVERYTHING{true, true, true, true, true},
    WITH_COSINES{true, true, true, true, true, true};

gnomon::LightsOnHost run(const gnomon::Device& device, const LightScene& scene, const Lights& lights,
                         const std::string& way, gnomon::RunOptions options = {},
                         const std::string& bundle_lights = "32", const gnomon::LightsWanted& wanted = EVERYTHING) {
    if (scene.eye) options.facing = gnomon::Facing::eye(*scene.eye);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("many-lights", way);
    technique->set("bundle-lights", bundle_lights);
    return gnomon::run_light_table_to_host(*technique, gnomon::Triangles::upload(device, scene.triangles),
                                           upload_points(device, scene), lights, wanted, options);
}

bool is_lit(const gnomon::LightsOnHost& answers, std::size_t lights, std::size_t point, std::size_t light) {
    return (answers.bits.at(point * ((lights + 31) / 32) + light / 32) >> (light % 32) & 1u) != 0;
}

/// Lights around the scene's own: itself, twice, others an ulp and a degree beside it, and scaled by powers of two.
Lights table_around(const LightScene& scene, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    std::vector<float> weights;
    for (std::size_t i = 0; i < count; ++i) {
        gnomon::Light light{scene.light};
        Float3 d{light.xyzw[0], light.xyzw[1], light.xyzw[2]};
        const float size = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
        if (i % 4 == 1) d = nudged(random, d);
        if (i % 4 >= 2)
            for (float& c : d) c += size * (i % 4 == 2 ? 0.02f : 0.7f) * (float(random.below(201)) / 100 - 1);
        const float scale = i % 5 == 4 ? 0x1p-20f : 1.0f;
        for (int c = 0; c < 3; ++c) light.xyzw[c] = d[c] * scale;
        lights.push_back(light);
        weights.push_back(i % 7 == 3 ? 0.0f : float(random.below(1000)) / 64 - 3);
    }
    return Lights(lights, weights);
}

/// The oracle's bits, light by light.
std::vector<std::vector<float>> truth_of_each(LightScene scene, const Lights& lights) {
    std::vector<std::vector<float>> truth;
    for (const gnomon::Light& light : lights.lights()) {
        scene.light = light.xyzw;
        truth.push_back(truth_of(scene));
    }
    return truth;
}

/// Compares all outputs with the truth; returns the number of lit pairs.
std::size_t expect_outputs(const gnomon::LightsOnHost& answers, const std::vector<std::vector<float>>& truth,
                           const Lights& lights, const std::string& what) {
    SCOPED_TRACE(what);
    std::size_t lit_pairs = 0;
    const std::size_t m = lights.count();
    for (std::size_t p = 0; p < answers.counts.size(); ++p) {
        std::uint32_t count = 0, first = gnomon::no_light, last = gnomon::no_light;
        std::int64_t whole = 0;
        for (std::size_t l = 0; l < m; ++l) {
            const bool lit = truth[l][p] != 0;
            EXPECT_EQ(is_lit(answers, m, p, l), lit) << "point " << p << ", light " << l;
            if (!lit) continue;
            ++count;
            whole += lights.whole_weights()[l];
            if (first == gnomon::no_light) first = std::uint32_t(l);
            last = std::uint32_t(l);
        }
        EXPECT_EQ(answers.counts[p], count);
        EXPECT_EQ(answers.first_lit[p], first);
        EXPECT_EQ(answers.last_lit[p], last);
        EXPECT_EQ(answers.sums[p], std::ldexp(double(whole), lights.exponent()));
        lit_pairs += count;
        if (testing::Test::HasFailure()) return lit_pairs;
    }
    return lit_pairs;
}

TEST(ManyLights, EveryBitEqualsTheOracleOneByOneAndByBeamsOfBlocksAndOfPoints) {
    const gnomon::Device device = device_with();
    const bool is_cpu = gnomon::session_of(device).is_cpu();
    std::size_t pairs = 0, lit = 0, by_beams = 0, undecided = 0, seed = 0;
    for (LightScene scene : light_scenes()) {
        if (++seed % 3 != 0) continue;
        scene.points.resize(std::min<std::size_t>(scene.points.size(), 3 * 75));
        const std::size_t counts[] = {1, 31, 32, 33, 70};
        const Lights lights = table_around(scene, counts[seed % 5], seed);
        const auto truth = truth_of_each(scene, lights);
        const auto one = run(device, scene, lights, "one-by-one");
        lit += expect_outputs(one, truth, lights, scene.name + ", one by one");
        pairs += lights.count() * scene.points.size() / 3;
        const auto either = run(device, scene, lights, "auto", {}, seed % 2 == 0 ? "32" : "5");
        expect_outputs(either, truth, lights, scene.name + ", by what takes less time");
        const bool are_beams = either.statistics.count("bundles") != 0;
        by_beams += are_beams;
        const std::pair<const char*, const char*> stage_of_way[] = {
            {"beams", "beam_trace"},
            {"point-beams", "point_beam_trace"},
            {"rays", !is_cpu ? "point_beam_trace" : "ray_packets"}};
        for (const auto& [way, stage] : stage_of_way) {
            if (!are_beams) continue;
            const auto beams = run(device, scene, lights, way, {}, seed % 2 == 0 ? "32" : "5");
            expect_outputs(beams, truth, lights, scene.name + ", by " + way);
            EXPECT_TRUE(
                std::ranges::any_of(beams.statistics.stages, [&](const auto& s) { return s.name.starts_with(stage); }));
            undecided += beams.statistics.count("queued_pairs");
        }
        if (HasFailure()) return;
    }
    std::cout << pairs << " pairs, " << lit << " lit; " << by_beams << " scenes by beams, " << undecided
              << " entries queued\n";
    EXPECT_GT(lit, pairs / 20);
    EXPECT_LT(lit, pairs - pairs / 20);
    EXPECT_GT(by_beams, 20u);
    EXPECT_GT(undecided, 1000u);  // ties reach the exact predicate
}

/// Boxes on a floor, with points on their faces and the faces' normals; receivers.
struct FacedScene : LightScene {
    std::vector<float> normals;
};
FacedScene boxes_on_floor(std::size_t points, std::uint64_t seed, std::size_t boxes = 6, std::uint32_t extent = 3) {
    FacedScene scene;
    scene.name = "boxes on a floor";
    scene.triangles = lattice_blocks(boxes, extent, seed);
    Random random(seed);
    const std::size_t triangles = scene.triangles.size() / 9;
    for (std::size_t i = 0; i < points; ++i) {
        const std::uint32_t t = std::uint32_t(random.below(triangles));
        const float* v = scene.triangles.data() + 9 * t;
        const float a = float(random.below(9)) / 16, b = float(random.below(8)) / 16;
        Float3 e{}, f{};
        for (int c = 0; c < 3; ++c) {
            e[c] = v[3 + c] - v[c];
            f[c] = v[6 + c] - v[c];
            scene.points.push_back(v[c] + a * e[c] + b * f[c]);
        }
        for (int c = 0; c < 3; ++c)
            scene.normals.push_back(e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3]);
        scene.receivers.push_back(t);
    }
    return scene;
}

Lights lights_all_around(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    while (lights.size() < count) {
        // Many lie in planes of the faces.
        const Float3 d{float(random.below(9)) - 4, float(random.below(9)) - 4, float(random.below(9)) - 4};
        if (d != Float3{0, 0, 0}) lights.push_back(gnomon::Light::directional(d));
    }
    return Lights(lights);
}

/// A run's side of the surfaces: 1 this eye's, 2 the winding's, else none.
gnomon::RunOptions options_of_side(LightScene& scene, int side, const Float3& eye) {
    gnomon::RunOptions options;
    scene.eye.reset();
    if (side == 1) scene.eye = eye;
    if (side == 2) options.facing = gnomon::Facing::winding();
    return options;
}

TEST(ManyLights, SidesAreThoseOfOneLight) {
    const gnomon::Device device = device_with();
    FacedScene scene = boxes_on_floor(700, 3);
    const Lights lights = lights_all_around(90, 5);
    const gnomon::Points normals = gnomon::Points::upload(device, scene.normals);
    for (int side = 0; side < 4; ++side) {
        SCOPED_TRACE("side " + std::to_string(side));
        gnomon::RunOptions options = options_of_side(scene, side, {20.5f, 31, -7});
        if (side == 3) options.facing = gnomon::Facing::normals(normals.positions());
        const auto one = run(device, scene, lights, "one-by-one", options);
        const auto beams = run(device, scene, lights, "beams", options);
        EXPECT_EQ(one.bits, beams.bits);
        EXPECT_EQ(one.sums, beams.sums);
        EXPECT_EQ(one.bits, run(device, scene, lights, "point-beams", options).bits);
        std::size_t lit = 0;
        for (const std::uint32_t count : one.counts) lit += count;
        EXPECT_GT(lit, 2000u);
        if (side > 1) continue;
        const auto truth = truth_of_each(scene, lights);
        expect_outputs(beams, truth, lights, "by beams");
    }
}

// A sliver's normal is wrong by far more than the lights are apart, so a cone's lights must not be decided by it.
TEST(ManyLights, SidesOfSliversAreThoseOfOneLight) {
    const gnomon::Device device = device_with();
    Random random(11);
    const auto coordinate = [&] { return float(random.below(1 << 20)) / (1 << 19) - 1; };
    LightScene scene{.name = "slivers"};
    const Float3 middle{0.3f, 1, -0.2f};
    for (std::uint32_t t = 0; t < 600; ++t) {
        const Float3 a{coordinate(), coordinate(), coordinate()}, u{coordinate(), coordinate(), coordinate()};
        for (int c = 0; c < 3; ++c) scene.triangles.push_back(a[c]);
        for (int c = 0; c < 3; ++c) scene.triangles.push_back(a[c] + u[c]);
        for (int c = 0; c < 3; ++c) scene.triangles.push_back(a[c] + 0.6f * u[c] + 1e-4f * middle[c]);
        for (int c = 0; c < 3; ++c) scene.points.push_back(a[c] + 0.5f * u[c]);
        scene.receivers.push_back(t);
    }
    std::vector<gnomon::Light> directions;
    for (int l = 0; l < 32; ++l)
        directions.push_back(gnomon::Light::directional(
            {middle[0] + 1e-4f * coordinate(), middle[1], middle[2] + 1e-4f * coordinate()}));
    const Lights lights(directions);
    for (const bool has_eye : {false, true}) {
        scene.eye.reset();
        if (has_eye) scene.eye = Float3{5, 4, 3};
        const auto one = run(device, scene, lights, "one-by-one",
                             {.facing = has_eye ? gnomon::Facing::none() : gnomon::Facing::winding()});
        EXPECT_EQ(one.bits, run(device, scene, lights, "beams",
                                {.facing = has_eye ? gnomon::Facing::none() : gnomon::Facing::winding()})
                                .bits);
        std::size_t partly = 0;
        for (const std::uint32_t count : one.counts) partly += count != 0 && count != 32;
        EXPECT_GT(partly, 20u);
    }
}

TEST(ManyLights, NoDeviceSettingChangesABitExhaustive) {
    FacedScene scene = boxes_on_floor(500, 4);
    const Lights lights = table_around({"", {}, {}, along(-0.3f, -1, 0.2f)}, 100, 9);
    const auto usual = run(device_with(), scene, lights, "one-by-one");
    for (int kind = 0; kind < 4; ++kind) {
        gnomon::DeviceOptions options;
        if (kind == 0) options.gpu_kernels = true;
        if (kind == 1) options.hide_fp64 = true;
        if (kind == 2) options.work_group_size = 3;
        if (kind == 3) options.memory_limit_bytes = 12 << 20;
        const gnomon::Device device({}, options);
        for (const char* way : {"beams", "point-beams", "rays"})
            for (const char* bundle_lights : {"1", "16", "32"}) {
                const auto got = run(device, scene, lights, way, {}, bundle_lights);
                EXPECT_EQ(got.bits, usual.bits) << "kind " << kind << ", " << way << ", bundles of " << bundle_lights;
                EXPECT_EQ(got.sums, usual.sums);
            }
    }
}

TEST(ManyLights, OrderOfLightsChangesNoSum) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(300, 6);
    Random random(8);
    std::vector<gnomon::Light> lights;
    std::vector<float> weights;
    std::mt19937 engine(3);
    for (int i = 0; i < 257; ++i) {
        lights.push_back(lights_all_around(1, 100 + i).lights()[0]);
        weights.push_back(std::ldexp(float(random.below(1 << 24)) - 0x1p23f, -int(random.below(40))));
    }
    const auto usual = run(device, scene, Lights(lights, weights), "beams");
    std::vector<std::size_t> order(lights.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), engine);
    std::vector<gnomon::Light> shuffled;
    std::vector<float> shuffled_weights;
    for (const std::size_t i : order) {
        shuffled.push_back(lights[i]);
        shuffled_weights.push_back(weights[i]);
    }
    EXPECT_EQ(run(device, scene, Lights(shuffled, shuffled_weights), "beams").sums, usual.sums);
    EXPECT_EQ(run(device, scene, Lights(shuffled, shuffled_weights), "one-by-one").sums, usual.sums);
    EXPECT_GT(*std::ranges::max_element(usual.sums), 0);
}

// A wall of height 3 over a floor, 4 to the side of a point: light i comes from the elevation with slope i / 40, and
// the wall's edge blocks too, so the slopes up to 3/4 are blocked exactly.
TEST(ManyLights, HoursBehindAWall) {
    LightScene scene{"wall", {4, -1, -1e4f, 4, -1, 1e4f, 4, 3, 0, 4, -1, 1e4f, 4, 3, -1e4f, 4, 3, 1e4f}, {0, 0, 0}, {}};
    std::vector<gnomon::Light> lights;
    for (int i = 1; i <= 80; ++i) lights.push_back(gnomon::Light::directional({-40, float(-i), 0}));
    const auto answers = run(device_with(), scene, Lights(lights), "beams");
    EXPECT_EQ(answers.counts[0], 50u);
    EXPECT_EQ(answers.first_lit[0], 30u);  // slope 31 / 40
    EXPECT_EQ(answers.last_lit[0], 79u);
}

// In the middle between two endless walls, an upward point sees sin(a) of the sky by cosine weight, where a is the
// angle between the vertical and the edge of a wall: here tan(a) = 1/2.
TEST(ManyLights, SkyOfACanyonHasItsClosedForm) {
    LightScene scene{"canyon", {}, {0, 0, 0}, {}};
    for (const float x : {-1.0f, 1.0f})
        append(scene.triangles, {x, -1, -1e4f, x, -1, 1e4f, x, 2, 1e4f, x, -1, -1e4f, x, 2, 1e4f, x, 2, -1e4f});
    const Lights sky = gnomon::sky_patches({0, 1, 0}, {0, 0, -1}, 16);
    const auto answers = run(device_with(), scene, sky, "beams");
    EXPECT_NEAR(answers.sums[0], std::sin(std::atan(1 / 2.0)), 2e-3);
    double all = 0;
    for (const float weight : sky.weights()) all += weight;
    EXPECT_NEAR(all, 1, 1e-5);
    EXPECT_EQ(gnomon::sky_patches({0, 1, 0}, {0, 0, -1}).count(), 145u);
    EXPECT_EQ(gnomon::sky_patches({0, 1, 0}, {0, 0, -1}, 2).count(), 577u);
}

TEST(ManyLights, CosinesFollowTheirStatedArithmetic) {
    const gnomon::Device device = device_with();
    FacedScene scene = boxes_on_floor(200, 7);
    for (std::size_t i = 0; i < scene.normals.size(); i += 3) {
        const double length = std::hypot(scene.normals[i], scene.normals[i + 1], scene.normals[i + 2]);
        for (int c = 0; c < 3; ++c) scene.normals[i + c] = float(scene.normals[i + c] / length);
    }
    const gnomon::Points normals = gnomon::Points::upload(device, scene.normals);
    const gnomon::RunOptions options{.facing = gnomon::Facing::normals(normals.positions())};
    const Lights lights = table_around({"", {}, {}, along(-0.3f, -1, 0.2f)}, 60, 9);
    const auto beams = run(device, scene, lights, "beams", options, "32", WITH_COSINES);
    EXPECT_EQ(run(device, scene, lights, "one-by-one", options, "32", WITH_COSINES).sums, beams.sums);
    for (std::size_t p = 0; p < scene.receivers.size(); ++p) {
        const float* n = scene.normals.data() + 3 * p;
        std::int64_t whole = 0;
        for (std::size_t l = 0; l < lights.count(); ++l) {
            if (!is_lit(beams, lights.count(), p, l)) continue;
            const auto& d = lights.lights()[l].xyzw;
            const double largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
            double unit[3] = {d[0] / largest, d[1] / largest, d[2] / largest};
            const double length = std::sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
            volatile float x = n[0] * float(unit[0] / length), y = n[1] * float(unit[1] / length);
            volatile float z = n[2] * float(unit[2] / length), xy = x + y, cosine = xy + z;
            volatile float term = std::clamp(float(cosine), 0.0f, 1.0f) * lights.weights()[l];
            whole += std::int64_t(std::nearbyint(std::ldexp(double(term), -lights.exponent())));
        }
        ASSERT_EQ(beams.sums[p], std::ldexp(double(whole), lights.exponent())) << "point " << p;
    }
}

/// Points on a rough terrain with their receivers, and sectors of suns, some below the horizon.
LightScene points_on_terrain(std::size_t count, float jitter = 0.1f) {
    LightScene scene{.name = "terrain"};
    scene.triangles = rough_terrain(21, jitter).triangles();
    Random random(5);
    for (std::size_t i = 0; i < count; ++i) {
        const auto t = std::uint32_t(random.below(scene.triangles.size() / 9));
        add(scene.points, vertex(scene.triangles, 3 * t + random.below(3)));
        scene.receivers.push_back(t);
    }
    return scene;
}
Lights suns_of_sectors(std::size_t count) {
    Random random(6);
    std::vector<gnomon::Light> lights;
    for (std::size_t i = 0; i < count; ++i) {
        const float azimuth = float(i % 5) * 1.1f + random.between(-0.05f, 0.05f);
        lights.push_back(
            gnomon::Light::directional({-std::cos(azimuth), -random.between(-0.1f, 0.8f), -std::sin(azimuth)}));
    }
    return Lights(lights);
}

/// Calls use(options, bundle) for the sides that a run of the scene may have: none, an eye's, and the winding's.
template <typename Use>
void for_each_side(LightScene& scene, const Use& use) {
    for (int side = 0; side < 3; ++side) {
        SCOPED_TRACE("side " + std::to_string(side));
        use(options_of_side(scene, side, {3, 300, -7}), side == 0 ? "32" : "7");
    }
}

TEST(ManyLights, HorizonsChangeNoBitWhateverTheSideAndTheDeviceExhaustive) {
    LightScene scene = points_on_terrain(700);
    const Lights lights = suns_of_sectors(150);
    for (int kind = 0; kind < 5; ++kind) {
        gnomon::DeviceOptions device_options;
        if (kind == 1) device_options.gpu_kernels = true;
        if (kind == 2) device_options.hide_fp64 = true;
        if (kind == 3) device_options.work_group_size = 3;
        if (kind == 4) device_options.memory_limit_bytes = 5 << 20;
        const gnomon::Device device({}, device_options);
        SCOPED_TRACE("device " + std::to_string(kind));
        for_each_side(scene, [&](const gnomon::RunOptions& options, const char* bundle) {
            const auto one = run(device, scene, lights, "one-by-one", options);
            const auto horizons = run(device, scene, lights, "horizons", options, bundle);
            EXPECT_EQ(one.bits, horizons.bits);
            EXPECT_EQ(one.sums, horizons.sums);
            EXPECT_TRUE(std::ranges::any_of(horizons.statistics.stages,
                                            [](const auto& stage) { return stage.name == "horizons"; }));
        });
    }
}

// `auto` measures horizons beside the other ways where the triangles are a height field, and takes them for this one.
TEST(ManyLights, AutoTakesHorizonsForTheVerticesOfATerrain) {
    const gnomon::Device device = device_with();
    const LightScene scene = points_on_terrain(1500);
    const auto either = run(device, scene, suns_of_sectors(900), "auto");
    EXPECT_EQ(either.bits, run(device, scene, suns_of_sectors(900), "horizons").bits);
    EXPECT_TRUE(
        std::ranges::any_of(either.statistics.stages, [](const auto& stage) { return stage.name == "horizons"; }));
}

TEST(ManyLights, SweepsChangeNoBitWhateverTheSideAndTheDevice) {
    LightScene scene = points_on_terrain(700, 0);
    for (std::size_t i = 0; i < scene.points.size(); i += 33) scene.points[i] += 0.25f;  // at no vertex
    const Lights lights = suns_of_sectors(150);
    for (int kind = 0; kind < 4; ++kind) {
        gnomon::DeviceOptions device_options;
        if (kind == 1) device_options.gpu_kernels = true;
        if (kind == 2) device_options.work_group_size = 3;
        if (kind == 3) device_options.memory_limit_bytes = 5 << 20;
        const gnomon::Device device({}, device_options);
        SCOPED_TRACE("device " + std::to_string(kind));
        for_each_side(scene, [&](const gnomon::RunOptions& options, const char* bundle) {
            const auto rays = run(device, scene, lights, "rays", options);
            const auto sweeps = run(device, scene, lights, "sweeps", options, bundle);
            EXPECT_EQ(rays.bits, sweeps.bits);
            EXPECT_EQ(rays.sums, sweeps.sums);
            EXPECT_EQ(rays.counts, sweeps.counts);
            EXPECT_TRUE(std::ranges::any_of(sweeps.statistics.stages,
                                            [](const auto& stage) { return stage.name == "sweeps"; }));
        });
    }
}

// Without memory for a raster's copies, or for sweeps, `auto` takes beams, which take the least.
TEST(ManyLights, AutoDecidesARastersVerticesInLittleMemory) {
    const LightScene scene = points_on_terrain(1500, 0);
    const Lights suns = suns_of_sectors(4400);  // their answers take more memory than making the BVH
    std::size_t failed = 0, done = 0;
    for (std::uint64_t kib = 1200; done < 4; kib = kib * 8 / 7) {
        gnomon::DeviceOptions device_options;
        device_options.memory_limit_bytes = kib << 10;
        const gnomon::Device device({}, device_options);
        std::vector<std::uint32_t> bits;
        try {
            bits = run(device, scene, suns, "beams").bits;
        } catch (const gnomon::OutOfDeviceMemory&) {
            ++failed;
            continue;
        }
        EXPECT_EQ(run(gnomon::Device({}, device_options), scene, suns, "auto").bits, bits);
        ++done;
    }
    EXPECT_GT(failed, 0u);
}

TEST(ManyLights, AutoTakesSweepsForTheVerticesOfARaster) {
    const gnomon::Device device = device_with();
    const LightScene scene = points_on_terrain(1500, 0);
    double done = 0;
    gnomon::RunOptions options;
    options.progress = [&](double part) {
        EXPECT_GT(part, done);
        done = part;
        return true;
    };
    const auto either = run(device, scene, suns_of_sectors(900), "auto", options);
    EXPECT_EQ(done, 1);
    EXPECT_EQ(either.bits, run(device, scene, suns_of_sectors(900), "rays").bits);
    EXPECT_TRUE(
        std::ranges::any_of(either.statistics.stages, [](const auto& stage) { return stage.name == "sweeps"; }));
}

// Most drivers build or load a kernel at its first launch, which is no part of a method's time
// (lie_kernels_built_at_launch makes it long). Beams take a fraction of the time of packets to lights on the sun's
// disk.
TEST(ManyLights, FirstLaunchesDoNotMisleadTheChoice) {
    const gnomon::Device device = device_with();
    if (!gnomon::session_of(device).is_cpu()) GTEST_SKIP() << "a GPU takes beams unmeasured";
    const FacedScene scene = boxes_on_floor(20000, 13);
    auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    triangles.keep_clusters(device);
    const gnomon::Points points = upload_points(device, scene);
    const Lights lights = gnomon::sun_disk({-0.3f, -1, -0.2f}, 0.53, 1024);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const auto stages = [&] {
        const auto answers = gnomon::run_light_table_to_host(*technique, triangles, points, lights, {.bits = true}, {});
        std::string names;
        for (const auto& stage : answers.statistics.stages) names += stage.name + '\n';
        return names;
    };
    EXPECT_NE(stages().find("ray_packets"), std::string::npos) << "both methods are measured in the first run";
    const std::string of_second = stages();  // takes the choice of the first
    EXPECT_NE(of_second.find("beam_trace"), std::string::npos);
    EXPECT_EQ(of_second.find("ray_packets"), std::string::npos);
}

// On a CPU `auto` measures beams and packets.
TEST(ManyLights, AWayOnceMeasuredServesTheNextRunsOfTheSameLights) {
    const gnomon::Device device = device_with();
    if (!gnomon::session_of(device).is_cpu()) GTEST_SKIP() << "a GPU measures larger runs";
    auto triangles = gnomon::Triangles::upload(device, boxes_on_floor(1, 13).triangles);
    const gnomon::Camera camera = gnomon::Camera::look_at({20.5f, 31, -7}, {0, 0, 0}, {0, 1, 0}, 60);
    const gnomon::View view = gnomon::look(device, triangles, camera, 256, 64);
    const Lights lights = lights_all_around(70, 6), others = lights_all_around(70, 7);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const auto bits =
        gnomon::run_light_table_to_host(*technique, triangles, view.points, lights, {.bits = true}, {}).bits;
    const auto measures = [&](const Lights& of) {
        const auto answers =
            gnomon::run_light_table_to_host(*technique, triangles, view.points, of, {.bits = true}, {});
        EXPECT_EQ(answers.bits == bits, &of == &lights);
        std::size_t ways = 0;
        for (const auto& stage : answers.statistics.stages)
            ways += stage.name.starts_with("beam_trace") || stage.name.starts_with("ray_packets");
        return ways == 2;
    };
    EXPECT_TRUE(measures(lights));  // without kept clusters each run makes the tree anew
    EXPECT_TRUE(measures(lights));
    triangles.keep_clusters(device);
    EXPECT_TRUE(measures(lights));
    for (int run = 0; run < 7; ++run) EXPECT_FALSE(measures(lights)) << run;
    EXPECT_TRUE(measures(lights));
    EXPECT_TRUE(measures(others));
    EXPECT_FALSE(measures(others));
    EXPECT_TRUE(measures(lights));
    technique->set("bundle-lights", "16");
    EXPECT_TRUE(measures(lights));
}

// The points of a picture go by squares of its pixels, or in rows where its sides are no multiples of 4.
TEST(ManyLights, PicturesAreThoseOfOneLight) {
    const FacedScene scene = boxes_on_floor(1, 13);
    const gnomon::Camera camera = gnomon::Camera::look_at({20.5f, 31, -7}, {0, 0, 0}, {0, 1, 0}, 60);
    const Lights lights = lights_all_around(70, 6);
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device({}, {.gpu_kernels = gpu_kernels});
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        for (const auto& [width, height] : {std::pair{20u, 12u}, {18u, 12u}}) {
            const gnomon::View view = gnomon::look(device, triangles, camera, width, height);
            std::vector<decltype(gnomon::LightsOnHost::bits)> bits;
            for (const char* way : {"one-by-one", "beams", "point-beams", "rays"}) {
                const auto technique = gnomon::make_technique("frustum-traced", device);
                technique->set("many-lights", way);
                bits.push_back(
                    gnomon::run_light_table_to_host(*technique, triangles, view.points, lights, {.bits = true}).bits);
                EXPECT_EQ(bits.front(), bits.back()) << way << ", " << width << " pixels wide";
            }
            EXPECT_NE(std::ranges::count(bits.front(), 0u), std::ptrdiff_t(bits.front().size()));
        }
    }
}

TEST(ManyLights, MeansAreSharesOfTheLights) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(300, 11);
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::Points points = upload_points(device, scene);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const Lights sun = gnomon::sun_disk({-0.3f, -1, 0.2f}, 30, 37);
    const gnomon::Visibility mean(device, 300);
    gnomon::run_mean(*technique, triangles, points, sun, mean);
    const auto counted = run(device, scene, sun, "one-by-one");
    std::size_t partly = 0;
    const std::vector<float> means = mean.read();
    for (std::size_t p = 0; p < means.size(); ++p) {
        EXPECT_EQ(means[p], float(counted.counts[p] / 37.0)) << "point " << p;
        partly += means[p] > 0 && means[p] < 1;
    }
    EXPECT_GT(partly, 20u);
    const gnomon::Visibility small(device, 299);
    EXPECT_THROW(gnomon::run_mean(*technique, triangles, points, sun, small), gnomon::InvalidArgument);
}

TEST(ManyLights, EmptyAndLargeTables) {
    const gnomon::Device device = device_with();
    FacedScene scene = boxes_on_floor(40, 2);
    const auto none = run(device, scene, Lights(std::vector<gnomon::Light>{}), "beams");
    EXPECT_EQ(none.counts, std::vector<std::uint32_t>(40, 0));
    EXPECT_EQ(none.first_lit, std::vector<std::uint32_t>(40, gnomon::no_light));
    const LightScene without_points{"no points", scene.triangles, {}, {}};
    EXPECT_TRUE(run(device, without_points, lights_all_around(3, 1), "beams").counts.empty());
    const LightScene without_triangles{"no triangles", {}, {0, 0, 0, 1, 1, 1}, {}};
    EXPECT_EQ(run(device, without_triangles, lights_all_around(33, 1), "beams").counts,
              std::vector<std::uint32_t>(2, 33));
    scene.triangles[4] = std::numeric_limits<float>::quiet_NaN();
    scene.points[0] = std::numeric_limits<float>::infinity();
    const Lights many = lights_all_around(100'000, 1);
    const auto beams = run(device, scene, many, "beams");
    EXPECT_EQ(beams.counts[0], many.count());  // absent points are lit
    LightScene one = scene;
    for (const std::size_t l : {0u, 31u, 32u, 50'000u, 99'999u}) {
        one.light = many.lights()[l].xyzw;
        const auto truth = truth_of(one);
        for (std::size_t p = 0; p < truth.size(); ++p) EXPECT_EQ(is_lit(beams, many.count(), p, l), truth[p] != 0);
    }
}

TEST(ManyLights, RefusesWhatHasNoMeaning) {
    const gnomon::Device device = device_with();
    const gnomon::Light sun = gnomon::Light::directional({0, -1, 0});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto message_of = [](const auto& act) -> std::string {
        try {
            act();
        } catch (const gnomon::Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    EXPECT_EQ(message_of([&] { Lights({sun, sun}, {1, nan}); }), "the weight of light 1 is not a finite number");
    EXPECT_NE(message_of([&] { Lights({sun, gnomon::Light{{nan, 0, 0, 0}}}); }).find("light 1: "), std::string::npos);
    EXPECT_EQ(message_of([&] { Lights({sun, sun}, {1}); }), "there are 1 weights for 2 lights");
    const FacedScene scene = boxes_on_floor(40, 2);
    EXPECT_EQ(message_of([&] { run(device, scene, Lights({sun}), "auto", {}, "32", WITH_COSINES); }),
              "cosines need points that face by normals");
    const gnomon::Light lamp = gnomon::Light::point({1, 2, 3});
    const gnomon::Light loses_bits = gnomon::Light::directional({0x1p-149f, -0x1p100f, 0});
    const gnomon::Light far_lamp = gnomon::Light::point({1, 0x1p20f, 3});
    constexpr const char *one_kind = "lights that are all directional", *directional = "directional lights",
                         *in_range = "coordinates up to 2^19", *field = "a height field", *raster = "a raster";
    const std::tuple<Lights, const char*, const char*> refused[] = {
        {Lights({sun, lamp}), "beams", one_kind},  {Lights({sun, loses_bits}), "rays", one_kind},
        {Lights({lamp}), "horizons", directional}, {Lights({far_lamp}), "point-beams", in_range},
        {Lights({sun}), "horizons", field},        {Lights({lamp}), "sweeps", directional},
        {Lights({sun}), "sweeps", raster},
    };
    for (const auto& [lights, way, what] : refused) {
        const std::string message = message_of([&] { run(device, scene, lights, way); });
        EXPECT_TRUE(message.starts_with(std::string("many-lights=") + way + " needs " + what)) << message;
        EXPECT_TRUE(message.ends_with(": use many-lights=auto")) << message;
        EXPECT_FALSE(run(device, scene, lights, "auto").counts.empty());
    }
    gnomon::RunOptions options;
    options.progress = [](double) { return false; };
    EXPECT_THROW(run(device, scene, Lights({sun}), "beams", options), gnomon::Cancelled);
    EXPECT_THROW(run(device, scene, Lights({sun}), "one-by-one", options), gnomon::Cancelled);
    double done = 0;
    options.progress = [&](double part) {
        EXPECT_GE(part, done);
        done = part;
        return true;
    };
    run(device, scene, lights_all_around(40, 1), "one-by-one", options);
    EXPECT_EQ(done, 1);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Visibility small(device, 3);
    EXPECT_THROW(technique->run_light_table(gnomon::Triangles::upload(device, scene.triangles),
                                            upload_points(device, scene), Lights({sun}), {.counts = small.buffer()}),
                 gnomon::InvalidArgument);
}

/// Far from each other and in tight groups, before faces, in their planes, at points, and twice.
Lights lamps_among(const FacedScene& scene, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    while (lights.size() < count) {
        const std::size_t p = 3 * random.below(scene.points.size() / 3);
        const float height = float(random.below(5)) / 8;  // 0: at the point, in the plane of its face
        const float off = lights.size() % 3 == 0 ? 0.25f : 0;
        Float3 at{};
        for (int c = 0; c < 3; ++c)
            at[c] = scene.points[p + c] + height * scene.normals[p + c] + off * scene.normals[p + (c + 1) % 3];
        lights.push_back(gnomon::Light::point(at));
        for (int i = 0; lights.size() % 8 == 0 && i < 5; ++i) {
            if (i != 0) at = nudged(random, at);
            lights.push_back(gnomon::Light::point(at));
        }
    }
    lights.resize(count);
    return Lights(lights);
}

// Many boxes, so that the tree has nodes below and beside the lamps that stand among them, and points on all
// sides of these.
TEST(ManyLights, PointLightsGiveTheBitsOfOneLight) {
    FacedScene scene = boxes_on_floor(1000, 21, 250, 12);
    const Lights spread[] = {lamps_among(scene, 45, 5), lamps_among(scene, 45, 7), lamps_among(scene, 45, 8)};
    for (std::size_t i = 0; i < scene.points.size(); ++i)  // some points are farther off their planes than lamps
        if (i / 3 % 3 == 0) scene.points[i] += 0.25f * scene.normals[i];
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device({}, {.gpu_kernels = gpu_kernels});
        const gnomon::Points normals = gnomon::Points::upload(device, scene.normals);
        std::size_t queued = 0;
        for (int side = 0; side < 4; ++side) {
            scene.eye.reset();
            gnomon::RunOptions options;
            if (side == 1) scene.eye = Float3{20.5f, 31, -7};
            if (side == 2) options.facing = gnomon::Facing::winding();
            if (side == 3) options.facing = gnomon::Facing::normals(normals.positions());
            const Lights lights =
                side == 1 ? gnomon::area_light({5, 14, 5}, {2, 0, 0}, {0, 0.5f, 2}, 40) : spread[side / 2 + side % 2];
            const auto one = run(device, scene, lights, "one-by-one", options);
            for (const char* way : {"beams", "point-beams", "rays"}) {
                SCOPED_TRACE("gpu " + std::to_string(gpu_kernels) + ", side " + std::to_string(side) + ", " + way);
                const auto got = run(device, scene, lights, way, options, side % 2 == 0 ? "32" : "7");
                EXPECT_EQ(got.bits, one.bits);
                queued += got.statistics.count("queued_pairs");
            }
            std::size_t lit = 0;
            for (const std::uint32_t count : one.counts) lit += count;
            EXPECT_GT(lit, lights.count() * 15);
            EXPECT_LT(lit, lights.count() * 900);
        }
        EXPECT_GT(queued, 1000u);  // lamps in planes of faces reach the exact predicate
    }
}

// Lamps above a slope and points below it, by less than the float filter can tell, so that it may turn triangles
// wrongly.
TEST(ManyLights, LampsAndPointsBesideAPlane) {
    LightScene scene{"slope", {}, {}, {}};
    const auto on_slope = [](float x, float z, float height) { return Float3{x, 0.37f * x - 0.21f * z + height, z}; };
    for (int x = -8; x < 8; ++x)
        for (int z = -8; z < 8; ++z) {
            const auto at = [&](int i, int k) { return on_slope(float(x + i), float(z + k), 0); };
            if ((x + z) % 5 == 0) continue;  // a hole
            add(scene.triangles, at(0, 0), at(0, 1), at(1, 1));
            add(scene.triangles, at(0, 0), at(1, 1), at(1, 0));
        }
    Random random(4);
    const auto place = [&](float height) {
        const float x = random.between(-7, 7);
        return on_slope(x, random.between(-7, 7), height);
    };
    for (int i = 0; i < 150; ++i)
        add(scene.points, place(i % 5 == 0 ? -2.0f : std::ldexp(i % 2 == 0 ? 1.0f : -1.0f, -22)));
    std::vector<gnomon::Light> lamps;
    for (int i = 0; i < 40; ++i)
        lamps.push_back(gnomon::Light::point(place(std::ldexp(i % 3 == 0 ? -1.0f : 1.0f, -21 - i % 4))));
    const Lights lights(lamps);
    const auto truth = truth_of_each(scene, lights);
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device({}, {.gpu_kernels = gpu_kernels});
        for (const char* way : {"one-by-one", "beams", "point-beams", "rays"})
            expect_outputs(run(device, scene, lights, way), truth, lights, way);
    }
}

// The tree of no finite triangle has one node, without children.
TEST(ManyLights, NoFiniteTriangleBlocksNothing) {
    LightScene scene{"none finite", Floats(9 * 40, std::numeric_limits<float>::quiet_NaN()), {}, {}};
    Random random(5);
    for (int i = 0; i < 40; ++i)
        add(scene.points, {random.between(-2, 2), random.between(-2, 2), random.between(-2, 2)});
    std::vector<gnomon::Light> lamps, suns;
    for (int i = 0; i < 5; ++i) {
        lamps.push_back(gnomon::Light::point({random.between(-2, 2), random.between(-2, 2), 1}));
        suns.push_back(gnomon::Light::directional({random.between(-1, 1), 1, random.between(-1, 1)}));
    }
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device({}, {.gpu_kernels = gpu_kernels});
        for (const Lights& lights : {Lights(lamps), Lights(suns)})
            for (const char* way : {"beams", "point-beams", "rays"})
                expect_outputs(run(device, scene, lights, way), truth_of_each(scene, lights), lights, way);
    }
}

// n . (S - P) is about -1e34, and its terms overflow to infinity before they cancel.
TEST(ManyLights, LargeNormalsDoNotDecideTheSideOfALamp) {
    const gnomon::Device device = device_with();
    const LightScene scene{"far", {50, 50, 50, 51, 50, 50, 50, 51, 50}, {0, 0, 0}, {}};
    const gnomon::Points normals = gnomon::Points::upload(device, Floats{0, -1e38f, 1e38f});
    const Lights lamp({gnomon::Light::point({0, 4.0001f, 4})});
    for (const char* way : {"one-by-one", "beams", "point-beams", "rays"})
        EXPECT_EQ(run(device, scene, lamp, way, {.facing = gnomon::Facing::normals(normals.positions())}).counts[0], 0u)
            << way;
}

// A lamp among its points, and a triangle whose box touches, but for rounding, the plane through the lamp that a
// packet's heights begin at: a coordinate and a height are both 0.
TEST(ManyLights, ATriangleBesideALampAmongItsPoints) {
    const gnomon::Device device = device_with();
    const float r = 8e-6f * 2.5f;
    LightScene scene{"beside a lamp", {0.4f, r, r, 0.4f, 1, r, 0.4f, 0.4f, 1}, {1, 1, 0.5f}, {}};
    for (int i = 0; i < 15; ++i) add(scene.points, {i % 2 == 0 ? -1.0f : 1.0f, i % 4 < 2 ? -1.0f : 1.0f, -2.5f});
    const Lights lamp({gnomon::Light::point({0, 0, 0})});
    const auto truth = truth_of_each(scene, lamp);
    EXPECT_EQ(truth[0][0], 0);
    for (const char* way : {"one-by-one", "beams", "point-beams", "rays"})
        expect_outputs(run(device, scene, lamp, way), truth, lamp, way);
}

TEST(ManyLights, AreaLightsOfManySamplesAreDecidedTogether) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(120, 2);
    const Lights lamp = gnomon::area_light({2, 9, 1}, {3, 0, 0}, {0, 0, 2}, 40);
    const auto answers = run(device, scene, lamp, "auto");
    expect_outputs(answers, truth_of_each(scene, lamp), lamp, "an area light");
    EXPECT_EQ(answers.statistics.count("bundles"), 2u);
}

/// Whether each light reaches each point, a light after the other.
std::vector<std::vector<float>> one_by_one(gnomon::Technique& technique, const gnomon::Triangles& triangles,
                                           const gnomon::Points& points, const Lights& lights,
                                           const gnomon::RunOptions& options) {
    const gnomon::Visibility visibility(technique.device(), points.count());
    std::vector<std::vector<float>> all;
    for (const gnomon::Light& light : lights.lights()) {
        technique.run(triangles, points, light, visibility, options);
        all.push_back(visibility.read());
    }
    return all;
}

// By every facing, one light alone, each light, and a table by every way have the same bits. Not vacuous: each facing
// but none() darkens pairs.
TEST(ManyLights, EveryFacingOfOneLightIsThatOfATable) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(300, 17);
    std::vector<float> corners;
    for (std::size_t i = 0; i < 300; ++i) add(corners, vertex(scene.triangles, 5 * i % (scene.triangles.size() / 3)));
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::Points on_faces = upload_points(device, scene), at_corners = gnomon::Points::upload(device, corners),
                         normals = gnomon::Points::upload(device, scene.normals);
    const auto fans = gnomon::VertexFans::find(device, scene.triangles, corners);
    const Float3 eye{20.5f, 31, -7};
    const auto camera = gnomon::Camera::look_at(eye, {3, 0, 3}, {0, 1, 0}, 60);
    const gnomon::Points seen = gnomon::look(device, triangles, camera, 20, 15).points;
    using gnomon::Facing;
    const struct {
        const char* name;
        const gnomon::Points& points;
        Facing facing;
    } cases[] = {{"automatic, of a view", seen, Facing::automatic()},
                 {"none, of a view", seen, Facing::none()},
                 {"eye", on_faces, Facing::eye(eye)},
                 {"normals on the host", on_faces, Facing::normals(scene.normals)},
                 {"normals on the device", on_faces, Facing::normals(normals.positions())},
                 {"winding", on_faces, Facing::winding()},
                 {"fans", at_corners, Facing::fans(fans)},
                 {"fans of a height field", at_corners, Facing::fans(fans, Float3{0, 1, 0})}};
    const Lights lights = lights_all_around(37, 18);
    for (const auto& [name, points, facing] : cases) {
        SCOPED_TRACE(name);
        const auto technique = gnomon::make_technique("frustum-traced", device);
        const auto truth = one_by_one(*technique, triangles, points, lights, {.facing = facing});
        const auto faceless = one_by_one(*technique, triangles, points, lights, {.facing = Facing::none()});
        EXPECT_EQ(truth == faceless, std::string(name).starts_with("none"));
        std::vector<gnomon::Visibility> each;
        for (std::size_t l = 0; l < lights.count(); ++l) each.emplace_back(device, points.count());
        technique->run_each_light(triangles, points, lights.lights(), each, {.facing = facing});
        for (std::size_t l = 0; l < lights.count(); ++l) ASSERT_EQ(each[l].read(), truth[l]) << "light " << l;
        for (const char* way : {"one-by-one", "beams", "point-beams", "rays", "auto"}) {
            technique->set("many-lights", way);
            const auto answers =
                gnomon::run_light_table_to_host(*technique, triangles, points, lights, EVERYTHING, {.facing = facing});
            expect_outputs(answers, truth, lights, way);
        }
    }
}

// A progress function that returns false ends every kind of run, and the technique stays usable.
TEST(ManyLights, ProgressEndsEveryKindOfRun) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(100, 19);
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::Points points = upload_points(device, scene);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const Lights lights = lights_all_around(3, 20);
    std::vector<gnomon::Visibility> each;
    for (std::size_t l = 0; l < lights.count(); ++l) each.emplace_back(device, points.count());
    std::vector<double> done;
    const gnomon::RunOptions going_on{.progress = [&](double part) {
        done.push_back(part);
        return true;
    }};
    technique->run(triangles, points, lights.lights()[0], each[0], going_on);
    EXPECT_EQ(done, std::vector<double>{1});
    done.clear();
    technique->run_each_light(triangles, points, lights.lights(), each, going_on);
    EXPECT_EQ(done, (std::vector<double>{1 / 3.0, 2 / 3.0, 1}));
    int calls = 0;
    const gnomon::RunOptions stopping{.progress = [&](double) {
        ++calls;
        return false;
    }};
    const auto make = [&] { return gnomon::make_technique("frustum-traced", device); };
    EXPECT_THROW(technique->run(triangles, points, lights.lights()[0], each[0], stopping), gnomon::Cancelled);
    EXPECT_THROW(technique->run_each_light(triangles, points, lights.lights(), each, stopping), gnomon::Cancelled);
    EXPECT_THROW(gnomon::run_mean(*technique, triangles, points, lights, each[0], stopping), gnomon::Cancelled);
    EXPECT_THROW(
        gnomon::run_in_parts(make, device, {scene.triangles}, points, {}, lights.lights()[0], each[0], stopping),
        gnomon::Cancelled);
    EXPECT_EQ(calls, 4) << "each run ends at the first report";
    technique->run(triangles, points, lights.lights()[0], each[0]);
}

TEST(ManyLights, OtherTechniquesGoOneByOne) {
    const gnomon::Device device = device_with();
    const FacedScene scene = boxes_on_floor(120, 2);
    const auto technique = gnomon::make_technique("izb", device);
    const Lights suns = gnomon::sun_disk({-0.3f, -1, 0.2f}, 20, 33);
    const auto answers = gnomon::run_light_table_to_host(*technique, gnomon::Triangles::upload(device, scene.triangles),
                                                         upload_points(device, scene), suns, EVERYTHING);
    EXPECT_EQ(answers.counts.size(), 120u);
    EXPECT_GT(*std::ranges::max_element(answers.counts), 20u);
}

}  // namespace
