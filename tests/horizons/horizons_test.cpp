// SPDX-License-Identifier: MIT
// What horizons decide is what the oracle says, on fields and for points and lights that tie; and they decide most
// pairs. Beams, which decide the rest, take no part here.
#include <gtest/gtest.h>

#include "horizons/horizons.hpp"
#include "support/decided_lights.hpp"
#include "support/device.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;

/// Points at vertices, in faces, above and below the ground and beside it.
void add_points(LightScene& scene, std::size_t count, bool has_receivers, std::uint64_t seed) {
    Random random(seed);
    const std::size_t triangles = scene.triangles.size() / 9;
    for (std::size_t i = 0; i < count; ++i) {
        const auto t = std::uint32_t(random.below(triangles));
        const float* v = scene.triangles.data() + 9 * t;
        const std::uint64_t kind = random.below(8);
        float a = float(random.below(9)) / 8, b = float(random.below(9)) / 8;
        if (kind < 3) a = float(kind == 1), b = float(kind == 2);
        if (kind == 3) b = 0;
        if (a + b > 1) a = 1 - a, b = 1 - b;
        for (int c = 0; c < 3; ++c) {
            float coordinate = v[c] + a * (v[3 + c] - v[c]) + b * (v[6 + c] - v[c]);
            if (kind == 6) coordinate += random.between(-3, 3);
            if (kind == 7) coordinate = random.below(2) == 0 ? std::nextafter(coordinate, 1e9f) : coordinate;
            scene.points.push_back(coordinate);
        }
        // Some receivers are not under their points.
        if (has_receivers) scene.receivers.push_back(i % 11 == 5 ? std::uint32_t(random.below(triangles)) : t);
    }
}

/// Sectors of lights along the axis: azimuths a hair apart, slopes from grazing to steep, many along the lattice, some
/// upside down, some along the axis.
gnomon::Lights lights_of_sectors(int axis, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    while (lights.size() < count) {
        Float3 d{};
        if (lights.size() % 3 == 0) {
            for (float& c : d) c = float(int(random.below(9)) - 4);
            d[axis] = float(int(random.below(7)) - 1) / 2;
        } else {
            const float azimuth = float(random.below(5)) * 1.3f + random.between(-0.03f, 0.03f);
            d[(axis + 1) % 3] = std::cos(azimuth);
            d[(axis + 2) % 3] = std::sin(azimuth);
            d[axis] = lights.size() % 3 == 1 ? random.between(-0.1f, 1.5f) : float(random.below(17)) / 8;
        }
        if (d != Float3{}) lights.push_back(gnomon::Light::directional({-d[0], -d[1], -d[2]}));
    }
    return gnomon::Lights(lights);
}

/// Compares what horizons decide with the oracle.
Decided expect_decisions(const gnomon::Device& device, const LightScene& scene, const gnomon::Lights& lights) {
    SCOPED_TRACE(scene.name);
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::BuiltHeightField field(device, triangles);
    EXPECT_TRUE(field.is_field());
    if (!field.is_field()) return {};
    const gnomon::Points points = gnomon::Internals::seen_from(upload_points(device, scene), scene.eye);
    const gnomon::LightsOutputs outputs;
    const gnomon::LightsOptions options;
    const gnomon::LightsRun run{device, triangles, points, lights, outputs, options};
    const gnomon::SortedPoints sorted(run);
    const gnomon::WideBvh tree(device, triangles);
    const gnomon::BvhRun through_tree{run, sorted, tree};
    const auto bundles = gnomon::make_sector_bundles(lights.lights(), 32, field.field().axis);
    gnomon::Statistics statistics;
    gnomon::LightMasks masks(through_tree, *bundles, statistics, gnomon::LightMasks::Before::horizons);
    gnomon::Horizons horizons(run, sorted, field, *bundles, statistics);
    masks.reserve(points.count());
    const gnomon::PointPart part{0, points.count()};
    masks.face(part);
    horizons.decide(sorted.part(0, points.count()), masks.for_horizons());
    return expect_truth(scene, run, sorted, *bundles, masks);
}

TEST(Horizons, DecideNothingOtherThanTheOracle) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        Decided all;
        std::uint64_t seed = 1;
        const Floats sheets[] = {lattice_terrain(8).triangles(), rough_terrain(9, 0).triangles(),
                                 rough_terrain(10, 0.2f).triangles(),
                                 without_triangle(rough_terrain(11, 0).triangles(), 200)};
        for (const Floats& sheet : sheets)
            for (int axis = 0; axis < 3; ++axis)
                for (const bool has_receivers : {false, true}) {
                    LightScene scene{.name = "sheet " + std::to_string(seed)};
                    const bool is_over = ++seed % 2 == 0;
                    scene.triangles = turned_up(is_over ? turned_over(sheet) : sheet, axis);
                    add_points(scene, 150, has_receivers, seed);
                    all += expect_decisions(device, scene, lights_of_sectors(axis, 70, seed));
                    if (HasFailure()) return;
                }
        std::cout << all << '\n';
        EXPECT_GT(all.lit, all.pairs / 4);
        EXPECT_GT(all.dark, all.pairs / 30);
    }
}

/// Lights of one azimuth, the way (x, z) along the ground, with slopes up to `steepest`.
gnomon::Lights sector_along(float x, float z, float steepest) {
    std::vector<gnomon::Light> lights;
    for (int i = 1; i <= 32; ++i)
        lights.push_back(gnomon::Light::directional({-x, -steepest * float(i) / 32, -z - 1e-3f * float(i % 5)}));
    return gnomon::Lights(lights);
}

// The ground rises once, to a plain, and rays leave the field below it. Where the one triangle that a ray meets is its
// point's receiver, which is not under the point, the light is lit.
TEST(Horizons, TakeNoReceiverForABlockingTriangle) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.height = [&](std::size_t i, std::size_t) { return i >= 20 ? 6.0f : 0.0f; };
    LightScene scene{.name = "rise"};
    scene.triangles = terrain.triangles();
    for (std::size_t row = 4; row < 14; ++row)
        for (std::size_t column = 4; column < 16; ++column)
            for (const std::size_t half : {0, 1}) {
                add(scene.points, vertex(scene.triangles, 3 * (2 * (row * terrain.columns + column))));
                scene.receivers.push_back(std::uint32_t(2 * (row * terrain.columns + 19) + half));
            }
    expect_decisions(device, scene, sector_along(1, 0, 0.3f));
    scene.receivers.clear();
    EXPECT_GT(expect_decisions(device, scene, sector_along(1, 0, 0.3f)).dark, 1000u);
}

// A wall up to a high plain has a hole, through which rays go on below the plain. The hole lies near a border, so the
// field's rectangle begins behind it.
TEST(Horizons, FindNothingDarkThroughAHole) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.columns = 24, terrain.rows = 40;
    terrain.height = [](std::size_t, std::size_t j) { return j >= 7 ? 5.0f : 0.0f; };
    LightScene scene{.name = "hole"};
    scene.triangles = terrain.triangles();
    for (std::size_t column = 8; column < 16; ++column)
        for (std::size_t row = 1; row < 6; ++row)
            add(scene.points, vertex(scene.triangles, 3 * (2 * (row * terrain.columns + column))));
    for (int k = 0; k < 8; ++k) scene.triangles = without_triangle(scene.triangles, 2 * (6 * terrain.columns + 10));
    const Decided decided = expect_decisions(device, scene, sector_along(0, 1, 0.5f));
    EXPECT_GT(decided.pairs, 1000u);
}

// Long triangles lie under points far from all others. A receiver that lies above its point does not block it.
TEST(Horizons, TakeNoLongReceiverForGroundAhead) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.height = [](std::size_t i, std::size_t) { return i == 12 ? 0.5f : 0.0f; };
    LightScene scene{.name = "long triangles"};
    scene.triangles = terrain.triangles();
    const std::size_t first = scene.triangles.size() / 9;
    for (std::size_t j = 0; j < terrain.rows; ++j)
        add(scene.triangles, {-20, 0, 0}, {0, 0, float(j + 1)}, {0, 0, float(j)});
    add(scene.triangles, {-20, 0, 0}, {-20, 0, float(terrain.rows)}, {0, 0, float(terrain.rows)});
    for (std::size_t j = 0; j < 4; ++j)
        for (const float share : {0.25f, 0.375f, 0.5f}) {
            add(scene.points, {20 * (share - 1), -1, (float(j) + 0.5f) * share});
            scene.receivers.push_back(std::uint32_t(first + j));
        }
    EXPECT_EQ(expect_decisions(device, scene, sector_along(1, 0.05f, 0.6f)).pairs, 12u * 32);
}

/// A plain with a cleft: in place of 6 cells, walls go down to a sliver, (tip, left, right), 2^-18 wide at its end.
/// Appends the sliver last.
Floats plain_with_cleft(Float3 tip) {
    Terrain terrain;
    terrain.rows = 24;
    terrain.height = [](std::size_t, std::size_t) { return 32.0f; };
    Floats made;
    const Floats plain = terrain.triangles();
    for (std::size_t t = 0; t < plain.size() / 9; ++t) {
        const float x = plain[9 * t] - tip[0], z = plain[9 * t + 2] - tip[2];  // of the cell's first corner
        if (!(x >= -1 && x < 1 && z >= -1 && z < 2)) made.insert(made.end(), &plain[9 * t], &plain[9 * t] + 9);
    }
    const Float3 left{tip[0] - 0x1p-19f, tip[1], tip[2] + 1}, right{tip[0] + 0x1p-19f, tip[1], tip[2] + 1};
    const auto rim = [&](float x, float z) { return Float3{tip[0] + x, 32, tip[2] + z}; };
    for (const float side : {-1.0f, 1.0f}) {
        const Float3 end = side < 0 ? left : right;
        const Float3 walls[][3] = {{tip, rim(0, -1), rim(side, -1)},  {tip, rim(side, -1), rim(side, 0)},
                                   {tip, rim(side, 0), rim(side, 1)}, {tip, rim(side, 1), end},
                                   {end, rim(side, 1), rim(side, 2)}, {end, rim(side, 2), rim(0, 2)}};
        for (const auto& w : walls) side < 0 ? add(made, w[0], w[1], w[2]) : add(made, w[0], w[2], w[1]);
    }
    add(made, left, rim(0, 2), right);
    add(made, tip, left, right);
    return made;
}

// A point lies beyond the tip of its receiver, a sliver, in whose plane and within the rounding of whose edges it is;
// it is under the walls beside. Rays that pass the sliver on either side stay under the ground and meet nothing, though
// they are above the sliver's end and below the ground ahead.
TEST(Horizons, FindNothingDarkFromBeyondAReceiver) {
    const gnomon::Device device = device_with();
    LightScene scene{.name = "cleft"};
    scene.triangles = plain_with_cleft({12, 0, 6});
    scene.points = {12, 0, 5.5f};
    scene.receivers = {std::uint32_t(scene.triangles.size() / 9 - 1)};
    std::vector<gnomon::Light> lights;
    for (const float x : {-0.01f, 0.01f}) lights.push_back(gnomon::Light::directional({x, -0.05f, -1}));
    EXPECT_EQ(expect_decisions(device, scene, gnomon::Lights(lights)).dark, 0u);
}

// Of a terrain's own vertices, which is what horizons are for, few pairs stay open.
TEST(Horizons, DecideMostPairsOfVertices) {
    const gnomon::Device device = device_with();
    LightScene scene{.name = "vertices"};
    Terrain terrain = rough_terrain(12, 0);
    terrain.columns = 200, terrain.rows = 180;
    scene.triangles = terrain.triangles();
    for (std::size_t t = 31; t < scene.triangles.size() / 9; t += 997) {
        add(scene.points, vertex(scene.triangles, 3 * t));
        scene.receivers.push_back(std::uint32_t(t));
    }
    Random random(3);
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < 96; ++i) {
        const float azimuth = 0.7f * float(i / 32) + random.between(-0.016f, 0.016f), height = random.between(0.02f, 1);
        lights.push_back(gnomon::Light::directional({-std::cos(azimuth), -height, -std::sin(azimuth)}));
    }
    const Decided decided = expect_decisions(device, scene, gnomon::Lights(lights));
    std::cout << decided << '\n';
    EXPECT_GT(decided.lit + decided.dark, decided.pairs * 3 / 4);
    EXPECT_GT(decided.dark, decided.pairs / 20);
}

}  // namespace
