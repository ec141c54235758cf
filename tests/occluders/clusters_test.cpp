// SPDX-License-Identifier: MIT
// Stage clusters. Boxes are compared with the vertices, to the bit; dropped clusters are checked by the exact
// predicate, for every triangle of a dropped cluster and every open point. In most scenes here a cluster is one
// triangle, repeated, so that its box is as tight as a box can be and a bound that is an ulp short would show.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <iostream>
#include <limits>

#include "kernels/occluders/clusters.h"
#include "support/camera_scenes.hpp"
#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;
using gnomon::cl::Session;

constexpr std::uint32_t cluster_size = CLUSTER_TRIANGLES;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// ---- Boxes ----------------------------------------------------------------------------------------------------------

struct Box {
    Float3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    std::uint32_t not_finite = 0;
};

/// The boxes as the device stores them (kernels/occluders/clusters.h: lane by lane, coordinate by coordinate).
std::vector<Box> boxes_on_device(Session& session, const gnomon::Clusters& clusters) {
    const std::uint32_t lanes = session.lanes();
    const auto words = downloaded<std::uint32_t>(session, clusters.boxes().get(), clusters.boxes().bytes() / 4);
    std::vector<Box> boxes(clusters.count());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const auto word = [&](std::size_t k) { return words.at((i / lanes * 7 + k) * lanes + i % lanes); };
        for (std::size_t c = 0; c < 3; ++c) {
            boxes[i].low[c] = std::bit_cast<float>(word(c));
            boxes[i].high[c] = std::bit_cast<float>(word(3 + c));
        }
        boxes[i].not_finite = word(6);
    }
    return boxes;
}

Box box_of(std::span<const float> triangles) {
    Box box;
    for (std::size_t t = 0; t < triangles.size(); t += 9) {
        const auto mine = triangles.subspan(t, 9);
        if (!std::ranges::all_of(mine, [](float x) { return std::isfinite(x); })) {
            ++box.not_finite;
            continue;
        }
        for (std::size_t i = 0; i < 9; ++i) {
            box.low[i % 3] = std::min(box.low[i % 3], mine[i]);
            box.high[i % 3] = std::max(box.high[i % 3], mine[i]);
        }
    }
    return box;
}

/// Floats of all sizes, few of them not finite.
Floats wild_triangles(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < 9 * count; ++i) {
        const float x = random.between(-1, 1);
        const std::uint32_t kind = random.below(600);
        triangles.push_back(kind == 0    ? nan
                            : kind == 1  ? -nan
                            : kind == 2  ? infinity
                            : kind == 3  ? -infinity
                            : kind < 100 ? x * 1e-42f
                            : kind < 200 ? x * 3e38f
                                         : x);
    }
    return triangles;
}

TEST(Clusters, BoxesAreThoseOfTheFiniteVerticesToTheBit) {
    const gnomon::Device device = device_with();
    std::uint64_t not_finite = 0, clean = 0;
    for (const std::size_t count : {1u, 5u, 63u, 64u, 65u, 129u, 1023u, 1024u, 1025u, 5000u})
        for (const std::size_t first_float : {0u, 5u}) {
            SCOPED_TRACE(std::to_string(count) + " triangles from float " + std::to_string(first_float) + " on");
            Floats floats(first_float, 1e30f);
            append(floats, wild_triangles(count, count));
            const gnomon::cl::Buffer buffer = uploaded(session_of(device), floats);
            auto triangles = gnomon::Triangles::wrap(device, buffer.get(), count, first_float);
            triangles.keep_clusters(device);
            const std::vector<Box> boxes = boxes_on_device(session_of(device), *triangle_inputs(triangles).clusters);
            ASSERT_EQ(boxes.size(), (count + cluster_size - 1) / cluster_size);
            const gnomon::OrderedTriangles ordered = ordered_triangles(triangle_inputs(triangles));
            const auto vertices =
                downloaded<float>(session_of(device), ordered.vertices, ordered.first_float + 9 * count);
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                const std::size_t first = i * cluster_size, size = std::min<std::size_t>(cluster_size, count - first);
                const Box wanted = box_of(std::span(vertices).subspan(ordered.first_float + 9 * first, 9 * size));
                for (int c = 0; c < 3; ++c) {
                    EXPECT_EQ(key_of_float(boxes[i].low[c]), key_of_float(wanted.low[c])) << i;
                    EXPECT_EQ(key_of_float(boxes[i].high[c]), key_of_float(wanted.high[c])) << i;
                }
                EXPECT_EQ(boxes[i].not_finite, wanted.not_finite) << i;
                not_finite += wanted.not_finite;
                clean += wanted.not_finite == 0;
            }
        }
    EXPECT_GT(not_finite, 100u);
    EXPECT_GT(clean, 10u);  // the two ways to make a box both ran
}

// ---- Bounds ---------------------------------------------------------------------------------------------------------

// The bounds that clusters.cl computes from a box before it reads the pyramid.
const char* const bounds_kernel = R"(
#include "occluders/clusters.cl"
__kernel void bounds_of_boxes(__constant const Projection* projection, uint blocks,
                              __global const ClusterBoxes* boxes, __global float* bounds) {
    GN_FOR_EACH(block, blocks) {
        Projected v[8];
        ClusterBoxes taken = boxes[block];
        project_corners(&taken, projection, v);
        HullSides sides = sides_of_hulls(v, 8, projection);
        Rectangles r;
        LaneInt inside = covered_rectangles(v, 8, projection, &r) & ~sides.behind;
        LaneFloat z_low, z_high;
        height_intervals(v, 8, sides.straddles, projection, &z_low, &z_high);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            __global float* mine = bounds + 8 * (block * GN_LANES + lane);
            mine[0] = LANE_OF_INT(sides.out_of_range, lane) ? 1.0f : 0.0f;
            mine[1] = LANE_OF_INT(inside, lane) ? 1.0f : 0.0f;
            mine[2] = LANE_OF_FLOAT(r.x0, lane);
            mine[3] = LANE_OF_FLOAT(r.y0, lane);
            mine[4] = LANE_OF_FLOAT(r.x1, lane);
            mine[5] = LANE_OF_FLOAT(r.y1, lane);
            mine[6] = LANE_OF_FLOAT(z_low, lane);
            mine[7] = LANE_OF_FLOAT(z_high, lane);
        }
    }
}
)";

/// Clusters of boxes of all sizes around `center`, each with its corners among its vertices: 64 triangles of three
/// corners or positions in the box.
Floats triangles_in_boxes(std::size_t boxes, const Float3& center, float reach, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < boxes; ++i) {
        const float size = reach * std::exp2(random.between(-18, 1));
        Float3 low = random_vector(random, -reach, reach), high;
        for (int c = 0; c < 3; ++c) {
            // Some sides lie in the planes of the light or eye, where W is 0.
            low[c] = random.below(8) == 0 ? center[c] : center[c] + low[c];
            high[c] = random.below(8) == 0 ? low[c] : low[c] + random.between(0, size);
        }
        for (std::uint32_t v = 0; v < 3 * cluster_size; ++v) {
            Float3 p;
            for (int c = 0; c < 3; ++c)
                p[c] = v < 8 ? ((v >> c & 1) != 0 ? high[c] : low[c])
                             : std::min(low[c] + random.between(0, 1) * (high[c] - low[c]), high[c]);
            add(triangles, p);
        }
    }
    return triangles;
}

struct BoundsTally {
    std::uint64_t vertices = 0, bounded = 0;
};

/// Each vertex at its real position, with a point's error: in the rectangle, not above z_high, and no cluster is
/// dropped that has a vertex in the grid.
void expect_bounds_hold(const gnomon::Projection& p, const reference::GridMap& map, const Floats& triangles,
                        const std::vector<float>& bounds, BoundsTally& tally) {
    for (std::size_t i = 0; i < triangles.size() / 3; ++i) {
        const float* b = &bounds[8 * (i / (3 * cluster_size))];
        const bool is_wild = b[0] != 0, is_inside = b[1] != 0;
        const reference::GridPosition at = map({triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
        if (is_wild || at.w <= 0) continue;
        const long double x = at.x / at.w, y = at.y / at.w, error = p.point_error;
        if (x < 0 || y < 0 || x >= p.width || y >= p.height) continue;
        ++tally.vertices;
        tally.bounded += b[7] < infinity;
        ASSERT_TRUE(is_inside) << "vertex " << i << " is at " << double(x) << ", " << double(y);
        ASSERT_LE(b[2], std::max(x - error, 0.0L)) << "vertex " << i;
        ASSERT_LE(b[3], std::max(y - error, 0.0L)) << "vertex " << i;
        ASSERT_GE(b[4], std::min(x + error, static_cast<long double>(p.width))) << "vertex " << i;
        ASSERT_GE(b[5], std::min(y + error, static_cast<long double>(p.height))) << "vertex " << i;
        const long double z_error = p.height_error * (p.perspective != 0 ? at.z : 1.0L);
        ASSERT_GE(b[7], at.z + z_error) << "vertex " << i;
    }
}

void attack_bounds(const gnomon::Device& device, const gnomon::Projection& projection, const reference::GridMap& map,
                   float reach, std::uint64_t seed, BoundsTally& tally) {
    Session& session = session_of(device);
    session.add_source("clusters_test.cl", bounds_kernel);
    const Float3 center{projection.center[0], projection.center[1], projection.center[2]};
    const Floats floats = triangles_in_boxes(320, center, reach, seed);
    auto triangles = gnomon::Triangles::upload(device, floats);
    triangles.keep_clusters(device);
    const gnomon::cl::Buffer projected = uploaded(session, std::vector{projection}),
                             bounds(session, 320 * 8 * sizeof(float));
    const cl_uint blocks = triangle_inputs(triangles).clusters->count() / session.lanes();
    session.launch("clusters_test.cl", "bounds_of_boxes", gnomon::cl::Range::items(blocks), projected, blocks,
                   triangle_inputs(triangles).clusters->boxes(), bounds);
    expect_bounds_hold(projection, map, floats, downloaded<float>(session, bounds.get(), 320 * 8), tally);
}

TEST(Clusters, BoundsHoldForEveryVertexInTheBox) {
    const gnomon::Device device = device_with();
    Session& session = session_of(device);
    BoundsTally tally;
    std::uint64_t seed = 80;
    for (const LightScene& scene : light_scenes()) {
        if (++seed % 3 != 0) continue;
        SCOPED_TRACE(scene.name);
        const UploadedScene inputs(device, scene);
        gnomon::LightFrameFit fit;
        const gnomon::LightFrame first = gnomon::make_light_frame(inputs.light, {64, 0});
        fit.run(session, first, inputs.facing.frame_bounds());
        for (const gnomon::Projection& projection :
             downloaded<gnomon::Projection>(session, fit.projections().get(), gnomon::frame_count_of(first))) {
            if (projection.active_points == 0 || projection.indistinct != 0) continue;
            float reach = 0;  // as far as the points are
            for (std::size_t i = 0; i < scene.points.size(); ++i)
                reach = std::max(reach, std::fabs(scene.points[i] - projection.center[i % 3]));
            attack_bounds(device, projection, real_map(projection), reach, seed, tally);
            if (HasFatalFailure()) return;
        }
    }
    for (const CameraScene& scene : camera_scenes()) {
        SCOPED_TRACE(scene.name);
        const gnomon::Projection projection =
            gnomon::camera_tables(scene.camera(), scene.width, scene.height).projection;
        for (const float reach : {1.0f, 1e-6f, 1e6f})
            attack_bounds(device, projection, real_map(projection), reach, ++seed, tally);
        if (HasFatalFailure()) return;
    }
    std::cout << tally.vertices << " vertices in the grid, of " << tally.bounded << " the height is bounded\n";
    EXPECT_GT(tally.bounded, 100000u);
}

// ---- Dropped clusters -----------------------------------------------------------------------------------------------

struct Tally {
    std::uint64_t clusters = 0, outside = 0, too_far = 0, pairs = 0;
};

/// Each triangle `times` times, one after the other.
Floats repeated(const Floats& triangles, std::size_t times) {
    Floats many;
    for (std::size_t t = 0; t < triangles.size(); t += 9)
        for (std::size_t i = 0; i < times; ++i)
            many.insert(many.end(), triangles.begin() + std::ptrdiff_t(t), triangles.begin() + std::ptrdiff_t(t) + 9);
    return many;
}

std::vector<std::uint32_t> listed_clusters(Session& session, const cl_mem listed,
                                           const gnomon::FrameCounters& counted) {
    auto list = downloaded<std::uint32_t>(session, listed, counted.clusters_listed);
    std::ranges::sort(list);
    EXPECT_TRUE(std::ranges::adjacent_find(list) == list.end()) << "a cluster is listed twice";
    return list;
}

/// A scene with repeated triangles: one of each triangle's copies is tested.
void expect_dropped_block_nothing(const LightScene& scene, const std::vector<std::uint32_t>& listed,
                                  const std::vector<float>& open, Tally& tally) {
    const std::size_t count = scene.triangles.size() / 9 / cluster_size;
    for (std::uint32_t cluster = 0; cluster < count; ++cluster) {
        if (std::ranges::binary_search(listed, cluster)) continue;
        const reference::Triangle triangle = reference::triangle_at(scene.triangles, cluster * cluster_size);
        if (!reference::is_finite(triangle)) continue;
        for (std::uint32_t p = 0; p < open.size(); ++p) {
            if (open[p] == 0) continue;
            ++tally.pairs;
            ASSERT_FALSE(exact_pair(triangle, reference::point_at(scene.points, p), scene.light).blocks)
                << "triangle " << cluster << " was dropped and blocks point " << p;
        }
    }
}

/// The face of a point light's cube that a point belongs to (kernels/receivers/light_frame.h), or 0 for a direction.
std::uint32_t face_of(const Light& light, const Float3& p) {
    if (light[3] == 0) return 0;
    std::uint32_t axis = 0;
    const auto along = [&](std::uint32_t c) { return p[c] - light[c]; };
    for (std::uint32_t c = 1; c < 3; ++c)
        if (std::fabs(along(c)) > std::fabs(along(axis))) axis = c;
    return 2 * axis + (along(axis) < 0);
}

void attack(const gnomon::Device& device, LightScene scene, Tally& tally) {
    SCOPED_TRACE(scene.name);
    scene.triangles = repeated(scene.triangles, cluster_size);
    for (std::uint32_t& receiver : scene.receivers)
        if (receiver != gnomon::no_receiver) receiver *= cluster_size;
    Session& session = session_of(device);
    UploadedScene inputs(device, scene);
    inputs.triangles.keep_clusters(device);
    LightStages stages;
    gnomon::ClusterCull cull;
    const gnomon::FrameGrid grid{64, 0};  // a bin per texel: few points each, and so many that are empty
    const gnomon::LightFrame first = gnomon::make_light_frame(inputs.light, grid);
    stages.light_frame.run(session, first, inputs.facing.frame_bounds());
    const std::uint32_t frames = gnomon::frame_count_of(first);
    const auto projections = downloaded<gnomon::Projection>(session, stages.light_frame.projections().get(), frames);
    const auto visibility = downloaded<float>(session, inputs.visibility.get(), scene.points.size() / 3);
    for (std::uint32_t face = 0; face < frames; ++face) {
        if (projections[face].active_points == 0) continue;
        const gnomon::cl::Buffer projection = uploaded(session, std::vector{projections[face]});
        stages.receiver_depth_pyramid.run(session, first, face, 1, inputs.point_inputs(), projection,
                                          inputs.facing.blocks(), inputs.visibility.get());
        session.fill(inputs.counters, 0, sizeof(gnomon::FrameCounters));
        const gnomon::cl::Buffer* listed = cull.run(session, projection, inputs.triangle_inputs(),
                                                    &stages.receiver_depth_pyramid.pyramid(), inputs.counters);
        ASSERT_NE(listed, nullptr);
        gnomon::FrameCounters counted;
        session.read(inputs.counters.get(), &counted, sizeof(counted));
        std::vector<float> open(visibility.size());
        for (std::uint32_t p = 0; p < open.size(); ++p)
            open[p] = is_open(visibility[p]) && face_of(scene.light, reference::point_at(scene.points, p)) == face;
        expect_dropped_block_nothing(scene, listed_clusters(session, listed->get(), counted), open, tally);
        tally.clusters += scene.triangles.size() / 9 / cluster_size;
        tally.outside += counted.clusters_outside;
        tally.too_far += counted.clusters_too_far;
        EXPECT_EQ(counted.outside + counted.not_finite + counted.clusters_listed * cluster_size,
                  scene.triangles.size() / 9);
    }
}

Tally attack(const std::vector<LightScene>& scenes, const char* what) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const LightScene& scene : scenes) {
        attack(device, scene, tally);
        if (testing::Test::HasFailure()) break;
    }
    std::cout << what << ": " << tally.clusters << " clusters, " << tally.outside << " outside, " << tally.too_far
              << " too far, " << tally.pairs << " pairs of a point and a dropped triangle\n";
    return tally;
}

TEST(Clusters, NoneIsDroppedWronglyInScenesOfTies) {
    const Tally tally = attack(light_scenes(), "ties");
    EXPECT_GT(tally.outside, 500u);
    EXPECT_GT(tally.too_far, 500u);
}

TEST(Clusters, NoneIsDroppedWronglyAroundAPointLight) {
    const Tally tally = attack(point_light_plane_scenes(), "around a point light");
    EXPECT_GT(tally.outside, 100u);
}

TEST(Clusters, NoneIsDroppedWronglyAmongHugeTriangles) { attack(huge_triangle_scenes(), "huge triangles"); }

TEST(Clusters, NoneIsDroppedWronglyWhereProductsUnderflow) { attack(underflow_scenes(), "underflow"); }

TEST(Clusters, NoneIsDroppedWronglyInTheOraclesOwnScenes) {
    const Tally tally = attack(reference_scenes(), "oracle's scenes");
    EXPECT_GT(tally.outside + tally.too_far, 100u);
}

/// Random single triangles, and points within two ulps of where one of them ends: seen from the light just inside or
/// just beside its box, and just nearer or just farther than its lowest or highest vertex.
std::vector<LightScene> scenes_of_box_corners() {
    std::vector<LightScene> scenes;
    Random random(51);
    for (int i = 0; i < 400; ++i) {
        const float size = std::exp2(random.between(-20, i % 3 == 0 ? 6 : -3)),
                    far = random.below(2) == 0 ? 0 : random.between(-1e4f, 1e4f);
        Floats triangles;
        for (int t = 0; t < 12; ++t) {
            // Far enough from each other that the points at one triangle are not those below the next.
            const Float3 center = {float(t % 4) - 1.5f, 0, float(t / 4) - 1};
            for (int k = 0; k < 3; ++k) {
                Float3 v = random_vector(random, -size, size);
                for (int c = 0; c < 3; ++c) v[c] += center[c] + far;
                add(triangles, v);
            }
        }
        Light light;
        if (random.below(2) == 0)
            light = random.below(3) == 0 ? along(0, -1, 0) : along(random.between(-1, 1), -1, random.between(-1, 1));
        else
            light = at(far + random.between(-3, 3), far + random.between(-3, 3), far + random.between(-3, 3));
        Floats points;
        // Away from the light the triangle is nearer than the point, towards it farther.
        const float side = i % 2 == 0 ? 1.0f : -1.0f;
        for (int p = 0; p < 120; ++p) {
            // The vertex itself, or a corner of the box, moved along the ray by a small step and then by ulps.
            const std::uint32_t t = random.below(12);
            Float3 corner = vertex(triangles, 3 * t + random.below(3));
            for (int c = 0; c < 3 && random.below(2) == 0; ++c)
                corner[c] = vertex(triangles, 3 * t + random.below(3))[c];
            const float away = random.below(3) == 0 ? 0.0f : side * std::exp2(random.between(-24, -1));
            for (int c = 0; c < 3; ++c) corner[c] -= away * (light[3] == 0 ? light[c] : light[c] - corner[c]);
            add(points, nudged(random, nudged(random, corner)));
        }
        scenes.push_back({"box corners " + std::to_string(i), triangles, points, light});
    }
    return scenes;
}

TEST(Clusters, NoneIsDroppedWronglyByAHair) {
    const Tally tally = attack(scenes_of_box_corners(), "box corners");
    EXPECT_GT(tally.outside, 100u);
    EXPECT_GT(tally.too_far, 200u);
}

// ---- The whole ------------------------------------------------------------------------------------------------------

Answer answer(const gnomon::Device& device, gnomon::Technique& technique, const gnomon::Triangles& triangles,
              const LightScene& scene) {
    return support::answer(device, technique, triangles, upload_points(device, scene), gnomon::Light{scene.light},
                           facing_of(scene.eye));
}

/// Hundreds of different triangles per scene, in disorder and sorted along x (so that clusters lie apart).
std::vector<LightScene> scenes_of_many_triangles() {
    std::vector<LightScene> scenes;
    for (const auto& [name, light] : lights_of_every_kind()) {
        Floats triangles = soup(1500, 0.05f, 61);
        for (std::size_t i = 0; i < triangles.size(); i += 997) triangles[i] = i % 2 == 0 ? nan : infinity;
        append(triangles, soup(4, 1e8f, 62));
        append(triangles, placed(soup(50, 0.3f, 63), 1e-40, {0, 0, 0}));
        LightScene scene{"many, " + name, triangles, random_points(800, -0.5f, 0.5f, 64), light};
        scenes.push_back(scene);
        std::vector<std::array<float, 9>> rows(triangles.size() / 9);
        std::memcpy(rows.data(), triangles.data(), triangles.size() * sizeof(float));
        std::ranges::stable_sort(rows, {}, [](const auto& row) { return std::isnan(row[0]) ? 0 : row[0]; });
        std::memcpy(scene.triangles.data(), rows.data(), triangles.size() * sizeof(float));
        scene.name = "sorted, " + name;
        scenes.push_back(std::move(scene));
    }
    return scenes;
}

TEST(Clusters, VisibilityIsTheSameBitsWithAndWithout) {
    std::uint64_t dropped = 0;
    for (const std::uint32_t work_group_size : {0u, 3u, 64u}) {
        const gnomon::Device device = device_with(work_group_size);
        const auto technique = gnomon::make_technique("frustum-traced", device);
        for (const LightScene& scene : scenes_of_many_triangles()) {
            SCOPED_TRACE(scene.name + ", work-groups of " + std::to_string(work_group_size));
            auto triangles = gnomon::Triangles::upload(device, scene.triangles);
            const Answer wanted = answer(device, *technique, triangles, scene);
            triangles.keep_clusters(device);
            const Answer got = answer(device, *technique, triangles, scene);
            ASSERT_EQ(got.visibility, wanted.visibility);
            const auto count = [](const Answer& a, const char* name) { return a.statistics.count(name); };
            dropped += count(got, "clusters_outside") + count(got, "clusters_too_far");
            EXPECT_EQ(count(got, "clusters"), (scene.triangles.size() / 9 + cluster_size - 1) / cluster_size);
            EXPECT_EQ(count(wanted, "clusters"), 0u);
            EXPECT_EQ(count(got, "triangles_not_finite"), count(wanted, "triangles_not_finite"));
            EXPECT_EQ(count(got, "triangles_not_finite") + count(got, "triangles_outside") +
                          count(got, "triangles_edge_on") + count(got, "triangles_kept"),
                      count(got, "frames") * triangles.count());
        }
    }
    EXPECT_GT(dropped, 100u);
}

TEST(Clusters, ACameraSeesTheSameBitsWithAndWithout) {
    const gnomon::Device device = device_with();
    std::uint64_t dropped = 0;
    for (const CameraScene& scene : camera_scenes())
        for (const bool is_repeated : {false, true}) {
            SCOPED_TRACE(scene.name);
            auto triangles = gnomon::Triangles::upload(
                device, is_repeated ? repeated(scene.triangles, cluster_size / 8) : scene.triangles);
            const gnomon::View wanted = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
            triangles.keep_clusters(device);
            const gnomon::View got = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
            dropped += got.statistics.count("clusters_outside");
            const gnomon::ViewOnHost a = got.read(device, triangles), b = wanted.read(device, triangles);
            ASSERT_EQ(a.receiver, b.receiver);
            ASSERT_EQ(a.position, b.position);
        }
    EXPECT_GT(dropped, 20u);
}

// ---- An order of their own ------------------------------------------------------------------------------------------

constexpr std::size_t strewn_count = 30000;

/// Small triangles in disorder, so that each cluster is spread over the whole scene; some triangles are not finite.
Floats strewn_triangles() {
    Floats triangles = soup(strewn_count, 0.02f, 81);
    for (std::size_t i = 0; i < triangles.size(); i += 6997) triangles[i] = i % 2 == 0 ? nan : infinity;
    return triangles;
}

TEST(Clusters, StrewnTrianglesArePutInOrder) {
    const Floats strewn = strewn_triangles();
    std::vector<std::uint32_t> order;
    for (const std::uint32_t work_group_size : {0u, 1u, 3u, 64u})
        for (const std::size_t first_float : {0u, 5u}) {
            SCOPED_TRACE("work-groups of " + std::to_string(work_group_size) + ", float " +
                         std::to_string(first_float));
            const gnomon::Device device = device_with(work_group_size);
            Session& session = session_of(device);
            Floats floats(first_float, 0.0f);
            append(floats, strewn);
            const gnomon::cl::Buffer buffer = uploaded(session, floats);
            auto triangles = gnomon::Triangles::wrap(device, buffer.get(), strewn.size() / 9, first_float);
            triangles.keep_clusters(device);
            const gnomon::Clusters& clusters = *triangle_inputs(triangles).clusters;
            ASSERT_TRUE(clusters.is_reordered());
            const auto numbers = downloaded<std::uint32_t>(session, clusters.numbers().get(), triangles.count());
            if (order.empty()) order = numbers;
            ASSERT_EQ(numbers, order);
            const auto vertices = downloaded<float>(session, clusters.vertices().get(), strewn.size());
            for (std::size_t i = 0; i < strewn.size(); ++i)
                ASSERT_EQ(std::bit_cast<std::uint32_t>(vertices[i]),
                          std::bit_cast<std::uint32_t>(strewn[9 * std::size_t(numbers[i / 9]) + i % 9]));
            const std::vector<Box> boxes = boxes_on_device(session, clusters);
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                const std::size_t first = i * cluster_size,
                                  size = std::min<std::size_t>(cluster_size, triangles.count() - first);
                const Box wanted = box_of(std::span(vertices).subspan(9 * first, 9 * size));
                EXPECT_EQ(boxes[i].low, wanted.low) << i;
                EXPECT_EQ(boxes[i].high, wanted.high) << i;
                EXPECT_EQ(boxes[i].not_finite, wanted.not_finite) << i;
            }
        }
    std::ranges::sort(order);
    for (std::uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);  // each once
}

TEST(Clusters, NeighboursStayWhereTheyAre) {
    const gnomon::Device device = device_with();
    // The same triangles in the clusters' order: no gain. Then huge triangles: no order brings them together.
    auto strewn = gnomon::Triangles::upload(device, strewn_triangles());
    strewn.keep_clusters(device);
    ASSERT_TRUE(triangle_inputs(strewn).clusters->is_reordered());
    for (const Floats& floats :
         {downloaded<float>(session_of(device), triangle_inputs(strewn).clusters->vertices().get(), strewn_count * 9),
          soup(strewn_count, 2.0f, 82), repeated(soup(400, 0.5f, 83), cluster_size)}) {
        auto triangles = gnomon::Triangles::upload(device, floats);
        triangles.keep_clusters(device);
        EXPECT_FALSE(triangle_inputs(triangles).clusters->is_reordered());
    }
}

/// Points a small step behind their own triangles, as seen from the light: the receiver blocks unless the stage knows
/// that it is the receiver, so that a wrong id shows.
LightScene strewn_scene(const std::string& name, const Light& light) {
    LightScene scene{name, strewn_triangles(), {}, light};
    for (std::uint32_t t = 0; t < scene.triangles.size() / 9; t += 11) {
        Float3 point{};
        for (std::size_t i = 0; i < 9; ++i) point[i % 3] += scene.triangles[9 * t + i] / 3;
        float size = 0;
        Float3 towards;
        for (int c = 0; c < 3; ++c) {
            towards[c] = light[3] == 0 ? light[c] : light[c] - point[c];
            size = std::max(size, std::fabs(towards[c]));
        }
        for (int c = 0; c < 3; ++c) point[c] -= towards[c] / size * 1e-4f;
        add(scene.points, point);
        scene.receivers.push_back(t);
    }
    return scene;
}

TEST(Clusters, AnOrderOfTheirOwnChangesNoBit) {
    std::uint64_t dropped = 0, lit = 0;
    const gnomon::Device device = device_with();
    for (const auto& [name, light] : lights_of_every_kind()) {
        const LightScene scene = strewn_scene(name, light);
        auto triangles = gnomon::Triangles::upload(device, scene.triangles), kept = triangles;
        kept.keep_clusters(device);
        ASSERT_TRUE(triangle_inputs(kept).clusters->is_reordered());
        for (const char* const technique_name : {"frustum-traced", "izb", "sub-pixel", "conservative-map"}) {
            SCOPED_TRACE(name + ", " + technique_name);
            const auto technique = gnomon::make_technique(technique_name, device);
            const Answer wanted = answer(device, *technique, triangles, scene);
            const Answer got = answer(device, *technique, kept, scene);
            ASSERT_EQ(got.visibility, wanted.visibility);
            if (technique_name != std::string("frustum-traced")) continue;
            lit += std::ranges::count(got.visibility, 1.0f);
            dropped += got.statistics.count("clusters_outside") + got.statistics.count("clusters_too_far");
            EXPECT_EQ(got.statistics.count("triangles_not_finite"), wanted.statistics.count("triangles_not_finite"));
            technique->prepare(kept, gnomon::Light{scene.light});
            EXPECT_EQ(answer(device, *technique, kept, scene).visibility, wanted.visibility);
        }
    }
    EXPECT_GT(dropped, 100u);
    EXPECT_GT(lit, 1000u);
}

TEST(Clusters, ACameraSeesTheSameTrianglesInAnOrderOfTheirOwn) {
    const gnomon::Device device = device_with();
    auto triangles = gnomon::Triangles::upload(device, strewn_triangles());
    const auto camera = gnomon::Camera::look_at({0.2f, 0.1f, 0.5f}, {0, 0, 0}, {0, 1, 0}, 60);
    const auto light = gnomon::Light::directional({0.3f, -1, 0.2f});
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Visibility mean(device, 96 * 64);
    const auto seen = [&] {
        const gnomon::View view = gnomon::look(device, triangles, camera, 96, 64);
        run_samples(*technique, triangles, view, light, 16, mean);
        const gnomon::ViewOnHost host = view.read(device, triangles);
        EXPECT_GT(std::ranges::count_if(host.receiver, [](auto r) { return r != gnomon::no_receiver; }), 500);
        return std::tuple{host.receiver, host.position, mean.read()};
    };
    const auto wanted = seen();
    triangles.keep_clusters(device);
    ASSERT_TRUE(triangle_inputs(triangles).clusters->is_reordered());
    EXPECT_TRUE(seen() == wanted);
}

/// A device with room for the boxes, but not for a sorted copy: the clusters keep the buffer's order.
TEST(Clusters, WithoutRoomTheyStayInTheOrderOfTheBuffer) {
    const Floats strewn = strewn_triangles();
    gnomon::DeviceOptions options;
    options.memory_limit_bytes = strewn.size() * sizeof(float) + (1u << 14);
    const gnomon::Device device({}, options);
    auto triangles = gnomon::Triangles::upload(device, strewn);
    triangles.keep_clusters(device);
    EXPECT_FALSE(triangle_inputs(triangles).clusters->is_reordered());
    EXPECT_EQ(boxes_on_device(session_of(device), *triangle_inputs(triangles).clusters).size(),
              (strewn_count + cluster_size - 1) / cluster_size);
}

TEST(Clusters, NothingInNothingOut) {
    const gnomon::Device device = device_with();
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const LightScene some{"", {}, random_points(5000, -1, 1, 71), along(0, -1, 0)};
    auto none = gnomon::Triangles::upload(device, {});
    none.keep_clusters(device);
    EXPECT_EQ(answer(device, *technique, none, some).visibility, std::vector<float>(5000, 1));
    auto broken = gnomon::Triangles::upload(device, Floats(9 * 100, nan));
    broken.keep_clusters(device);
    const Answer lit = answer(device, *technique, broken, some);
    EXPECT_EQ(lit.visibility, std::vector<float>(5000, 1));
    EXPECT_EQ(lit.statistics.count("triangles_not_finite"), 100u);
    EXPECT_EQ(lit.statistics.count("clusters_outside") + lit.statistics.count("clusters_too_far"), 0u);
    auto triangles = gnomon::Triangles::upload(device, soup(300, 0.1f, 72));
    triangles.keep_clusters(device);
    EXPECT_TRUE(answer(device, *technique, triangles, {"", {}, {}, along(0, -1, 0)}).visibility.empty());
}

}  // namespace
