// SPDX-License-Identifier: MIT
// What sweeps decide is what the oracle says, on rasters and for lights that tie, and they decide nearly all pairs.
// Beams, which decide the rest, take no part here.
#include "horizons/sweeps.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/decided_lights.hpp"
#include "support/device.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;

/// Each vertex of triangles that lies on a share of them, with the triangle as its receiver.
void add_vertices(LightScene& scene, std::size_t one_in, bool has_receivers) {
    for (std::size_t t = one_in / 2; t < scene.triangles.size() / 9; t += one_in) {
        add(scene.points, vertex(scene.triangles, 3 * t + t / one_in % 3));
        if (has_receivers) scene.receivers.push_back(std::uint32_t(t));
    }
}

/// Lights from grazing to steep, a third of them along the raster's lines and diagonals or with slopes of whole
/// numbers, where rays meet vertices and run within edges; some from below, and along the axis.
gnomon::Lights lights_over(int axis, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    while (lights.size() < count) {
        Float3 d{};
        if (lights.size() % 3 == 0) {
            for (float& c : d) c = float(int(random.below(9)) - 4);
            d[axis] = float(int(random.below(7)) - 1) / 2;
        } else {
            const float azimuth = random.between(0, 2 * std::numbers::pi_v<float>);
            d[(axis + 1) % 3] = std::cos(azimuth);
            d[(axis + 2) % 3] = std::sin(azimuth);
            d[axis] = lights.size() % 3 == 1 ? random.between(-0.05f, 1.5f) : random.between(0, 0.4f);
        }
        if (d != Float3{}) lights.push_back(gnomon::Light::directional({-d[0], -d[1], -d[2]}));
    }
    return gnomon::Lights(lights);
}

/// Compares what sweeps decide with the oracle.
Decided expect_decisions(const gnomon::Device& device, const LightScene& scene, const gnomon::Lights& lights) {
    SCOPED_TRACE(scene.name);
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::BuiltRaster raster(device, triangles);
    EXPECT_TRUE(raster.is_raster());
    if (!raster.is_raster()) return {};
    const gnomon::Points points = gnomon::Internals::seen_from(upload_points(device, scene), scene.eye);
    const gnomon::LightsOutputs outputs;
    const gnomon::LightsOptions options;
    const gnomon::LightsRun run{device, triangles, points, lights, outputs, options};
    const gnomon::SortedPoints sorted(run);
    const gnomon::WideBvh tree(device, triangles);
    const gnomon::BvhRun through_tree{run, sorted, tree};
    const auto bundles = gnomon::make_plain_bundles(*gnomon::make_light_bundles(lights.lights(), 32));
    gnomon::Statistics statistics;
    gnomon::LightMasks masks(through_tree, bundles, statistics, gnomon::LightMasks::Before::sweeps);
    const gnomon::RasterPoints at = points_on(raster, run, sorted);
    gnomon::Sweeps sweeps(run, raster, at, statistics);
    sweeps.sweep(bundles);
    masks.reserve(points.count());
    masks.face({0, points.count()});
    sweeps.decide(sorted.part(0, points.count()), masks.for_horizons());
    return expect_truth(scene, run, sorted, bundles, masks);
}

/// All of its triangles have the other diagonal.
Floats with_other_diagonals(const Terrain& terrain) {
    Floats mirrored = terrain.triangles();
    const float far = 2 * terrain.corner[0] + terrain.spacing * float(terrain.columns);
    for (std::size_t i = 0; i < mirrored.size(); i += 3) mirrored[i] = far - mirrored[i];
    return turned_over(mirrored);
}

/// Ground with walls and towers a cell wide, pits, flat parts, and a height that repeats.
Terrain town_on_raster(std::uint64_t seed) {
    Terrain terrain;
    terrain.columns = 61, terrain.rows = 47;
    terrain.height = [seed](std::size_t i, std::size_t j) {
        Random random(seed + i / 5 * 100 + j / 4);
        const auto kind = random.below(6);
        return kind < 3 ? 0.0f : kind == 3 ? 9.0f : kind == 4 ? -4.0f : float(i % 5) * 0.5f;
    };
    return terrain;
}

Terrain steep_terrain(std::uint64_t seed) {
    Terrain terrain = rough_terrain(seed, 0);
    terrain.columns = 90, terrain.rows = 33;
    terrain.spacing = 2;
    terrain.height = [seed](std::size_t i, std::size_t j) {
        Random random(seed + 1000 * i + j);
        return 25 * std::sin(float(i) * 0.11f) * std::cos(float(j) * 0.13f) + random.between(0, 0.5f);
    };
    return terrain;
}

/// A lake, ground that ends along a line, and single triangles that lack.
Floats with_holes(const Floats& sheet, const Terrain& terrain, std::uint64_t seed) {
    Floats kept;
    Random random(seed);
    for (std::size_t t = 0; t < sheet.size() / 9; ++t) {
        const std::size_t square = t / 2, i = square % terrain.columns, j = square / terrain.columns;
        const bool is_lake = i > 10 && i < 16 && j > 5 && j < 9;
        const bool is_beyond = i + j > terrain.columns * 5 / 4 && i + 1 != terrain.columns && j + 1 != terrain.rows;
        if (is_lake || is_beyond || random.below(9000) == 0) continue;
        kept.insert(kept.end(), sheet.begin() + std::ptrdiff_t(9 * t), sheet.begin() + std::ptrdiff_t(9 * t + 9));
    }
    return kept;
}

TEST(Sweeps, DecideNothingOtherThanTheOracle) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        Decided all;
        std::uint64_t seed = 1;
        for (const Terrain& terrain : {lattice_terrain(8), rough_terrain(9, 0), town_on_raster(3), steep_terrain(4)})
            for (int axis = 0; axis < 3; ++axis)
                for (const bool has_other_diagonals : {false, true}) {
                    LightScene scene{.name = "sheet " + std::to_string(seed)};
                    const bool is_over = ++seed % 2 == 0;
                    const Floats sheet = has_other_diagonals ? with_other_diagonals(terrain) : terrain.triangles();
                    scene.triangles = turned_up(is_over ? turned_over(sheet) : sheet, axis);
                    add_vertices(scene, 3 + scene.triangles.size() / 9 / 300, seed % 3 != 0);
                    all += expect_decisions(device, scene, lights_over(axis, 64, seed));
                    if (HasFailure()) return;
                }
        std::cout << all << "\n";
        EXPECT_GT(all.lit, all.pairs / 4);
        EXPECT_GT(all.dark, all.pairs / 6);
    }
}

// Rays go through holes, and the ground on their other side blocks them or not.
TEST(Sweeps, AreRightAroundHoles) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        Decided all;
        std::uint64_t seed = 20;
        for (Terrain terrain : {rough_terrain(9, 0), town_on_raster(3), steep_terrain(4)})
            for (const bool has_other_diagonals : {false, true}) {
                terrain.columns = 150, terrain.rows = 90;
                LightScene scene{.name = "holes " + std::to_string(++seed)};
                const Floats sheet = has_other_diagonals ? with_other_diagonals(terrain) : terrain.triangles();
                scene.triangles = with_holes(sheet, terrain, seed);
                add_vertices(scene, 3 + scene.triangles.size() / 9 / 600, seed % 3 != 0);
                all += expect_decisions(device, scene, lights_over(1, 64, seed));
                if (HasFailure()) return;
            }
        std::cout << all << "\n";
        EXPECT_GT(all.lit, all.pairs / 4);
        EXPECT_GT(all.dark, all.pairs / 10);
    }
}

// A strip that reaches beyond the first or the last row has ground of the row that shadows others.
TEST(Sweeps, MeetTheGroundOfBorders) {
    Terrain terrain = town_on_raster(6);
    terrain.height = [](std::size_t i, std::size_t j) {
        const bool is_border = i < 1 || j < 1 || i > 60 || j > 46;
        return is_border ? float((i + j) % 17) * 0.5f : float((i * 7 + j * 5) % 3) * 0.25f;
    };
    Decided all;
    for (const bool gpu_kernels : {false, true})
        for (const bool has_other_diagonals : {false, true}) {
            LightScene scene{.name = has_other_diagonals ? "falling diagonals" : "rising diagonals"};
            scene.triangles = has_other_diagonals ? with_other_diagonals(terrain) : terrain.triangles();
            for (std::size_t i = 0; i < scene.triangles.size(); i += 9) {
                const Float3 at = vertex(scene.triangles, i / 3);
                if (at[0] <= 1 || at[0] >= 60 || at[2] <= 1 || at[2] >= 46) add(scene.points, at);
            }
            std::vector<gnomon::Light> lights;
            Random random(8);
            for (int i = 0; i < 64; ++i) {
                // Nearly along the borders.
                const float azimuth = std::numbers::pi_v<float> / 2 * float(i % 4) + random.between(-0.15f, 0.15f);
                const float height = random.between(0.1f, 0.8f);
                lights.push_back(gnomon::Light::directional({std::cos(azimuth), -height, std::sin(azimuth)}));
            }
            all += expect_decisions(device_of(gpu_kernels), scene, gnomon::Lights(lights));
        }
    std::cout << all << "\n";
    EXPECT_GT(all.dark, all.pairs / 12);
}

// Points beside vertices, and on receivers that do not have their vertex as a corner, are none of a raster's.
TEST(Sweeps, LeaveOtherPointsOpen) {
    const gnomon::Device device = device_with();
    LightScene scene{.name = "others"};
    scene.triangles = rough_terrain(5, 0).triangles();
    for (std::size_t t = 300; t < 600; t += 7) {
        Float3 at = vertex(scene.triangles, 3 * t);
        if (t % 2 == 0) at[t % 3] = std::nextafter(at[t % 3], 1e9f);
        add(scene.points, at);
        scene.receivers.push_back(t % 2 == 0 ? std::uint32_t(t) : std::uint32_t(t + 90));
    }
    const Decided decided = expect_decisions(device, scene, lights_over(1, 32, 5));
    EXPECT_EQ(decided.lit, 0u);
}

// Of a terrain's own vertices few pairs stay open.
TEST(Sweeps, DecideNearlyAllPairsOfVertices) {
    const gnomon::Device device = device_with();
    LightScene scene{.name = "vertices"};
    Terrain terrain = steep_terrain(12);
    terrain.columns = 200, terrain.rows = 180;
    scene.triangles = terrain.triangles();
    add_vertices(scene, 997, true);
    scene.eye = Float3{170, 1000, 180};  // lights below the ground around a point are none of its
    Random random(3);
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < 64; ++i) {
        const float azimuth = random.between(0, 6.3f);
        lights.push_back(gnomon::Light::directional({std::cos(azimuth), -random.between(0.05f, 1), std::sin(azimuth)}));
    }
    const Decided decided = expect_decisions(device, scene, gnomon::Lights(lights));
    std::cout << decided << "\n";
    EXPECT_GT(decided.lit + decided.dark, decided.pairs * 97 / 100);
    EXPECT_GT(decided.dark, decided.pairs / 20);
}

TEST(Raster, IsFoundWhateverItsAxisWindingAndDiagonal) {
    const gnomon::Device device = device_with();
    for (const Terrain& terrain : {lattice_terrain(1), rough_terrain(2, 0)})
        for (const int axis : {0, 1, 2})
            for (const bool has_other_diagonals : {false, true}) {
                const Floats sheet = has_other_diagonals ? with_other_diagonals(terrain) : terrain.triangles();
                const auto triangles = gnomon::Triangles::upload(device, turned_up(sheet, axis));
                const gnomon::BuiltRaster found(device, triangles);
                ASSERT_TRUE(found.is_raster());
                EXPECT_EQ(found.params().axis, unsigned(axis));
                EXPECT_EQ(found.vertex_count(), (terrain.columns + 1) * (terrain.rows + 1));
            }
}

TEST(Raster, IsNotFoundInOtherTriangles) {
    const gnomon::Device device = device_with();
    const auto is_raster = [&](const Floats& triangles) {
        return gnomon::BuiltRaster(device, gnomon::Triangles::upload(device, triangles)).is_raster();
    };
    const Floats sheet = lattice_terrain(3).triangles();
    ASSERT_TRUE(is_raster(sheet));
    Floats mixed = sheet, moved = sheet, torn = sheet, doubled = sheet, odd = sheet;
    // One square gets the other diagonal.
    std::copy_n(sheet.begin() + 15, 3, mixed.begin() + 6);
    std::copy_n(sheet.begin() + 3, 3, mixed.begin() + 9);
    moved[9 * 100] += 0.25f;
    torn[9 * 101 + 1] += 1;
    std::copy_n(sheet.begin(), 9, doubled.begin() + 9 * 200);
    odd[9 * 50 + 4] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(is_raster(mixed));
    EXPECT_FALSE(is_raster(moved));
    EXPECT_FALSE(is_raster(torn));
    EXPECT_FALSE(is_raster(doubled));
    EXPECT_FALSE(is_raster(odd));
    EXPECT_TRUE(is_raster(without_triangle(sheet, 7)));
    EXPECT_FALSE(is_raster(rough_terrain(4, 0.2f).triangles()));
    EXPECT_FALSE(is_raster(lattice_blocks(5, 3, 1)));
    EXPECT_FALSE(is_raster({}));
}

}  // namespace
