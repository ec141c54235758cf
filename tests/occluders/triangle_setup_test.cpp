// SPDX-License-Identifier: MIT
// Stage triangle_setup. Every certain result of its records is compared with the exact predicate, and each margin with
// the true value that it must bound. Three kinds of projection: a directional light, a point light (six faces), a
// camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <iostream>
#include <map>

#include "support/camera_scenes.hpp"
#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;
using gnomon::TriangleRecord;

/// A record at a grid position, computed as the kernels do (fma is exact on both sides).
struct Evaluated {
    float edge[3];
    float plane;

    Evaluated(const TriangleRecord& r, float x, float y) {
        for (int i = 0; i < 3; ++i) edge[i] = std::fma(r.edge_x[i], x, std::fma(r.edge_y[i], y, r.edge_0[i]));
        plane = std::fma(r.plane_x, x, std::fma(r.plane_y, y, r.plane_0));
    }
    float inside() const { return std::min({edge[0], edge[1], edge[2]}); }
};

struct Claims {
    bool inside, outside, nearer, behind, above, below;
    bool is_open() const {
        const bool dismissed = outside || nearer || above;
        return !dismissed && !(inside && (behind || below));
    }
};

Claims claims_of(const TriangleRecord& r, const Evaluated& e, float z) {
    const float height = e.plane - z;  // as trace.cl
    return {e.inside() > r.margin_edge, e.inside() < -r.margin_edge, height<-r.margin_plane, height> r.margin_plane,
            z > r.z_high, z < r.z_low};
}

/// How much of the margins is used at most, over all pairs.
struct Tally {
    std::uint64_t pairs = 0, open = 0, missing = 0, inside = 0, behind = 0;
    long double edge_ratio = 0, plane_ratio = 0;
    std::string edge_where, plane_where;

    void print(const char* what) const {
        std::cout << what << ": " << pairs << " pairs, " << 100.0 * double(open) / double(pairs) << " % open, "
                  << missing << " more without a record; largest error / margin: edges " << double(edge_ratio) << " ("
                  << edge_where << "), planes " << double(plane_ratio) << " (" << plane_where << ")\n";
    }
};

long double ratio_of(long double error, float margin) {
    if (std::isinf(margin) || error == 0) return 0;
    return std::fabs(error) / margin;  // infinite if the margin is 0
}

/// Sign of the triangle's orientation as seen from the light, which is its orientation in the grid.
float orientation_in_grid(const reference::Triangle& t, const std::array<float, 4>& light,
                          const gnomon::Projection& projection) {
    reference::Effort effort;
    const reference::Float3 xyz{light[0], light[1], light[2]};
    const int sign =
        light[3] == 0 ? reference::side_of_direction(xyz, t, effort) : reference::side_of_point(xyz, t, effort);
    return float(sign) * projection.handedness;
}

/// Checks the margins for one pair: the record's values at the point's computed grid position against the real values
/// at its real grid position.
void measure(const TriangleRecord& r, const Evaluated& evaluated, float z, const reference::GridTriangle& real,
             float orientation, const reference::GridPosition& point, const std::string& name, Tally& tally) {
    const long double x = point.x / point.w, y = point.y / point.w;
    for (int i = 0; i < 3; ++i) {
        const long double ratio = ratio_of(orientation * real.edge(i, x, y) - evaluated.edge[i], r.margin_edge);
        if (ratio > tally.edge_ratio) tally.edge_ratio = ratio, tally.edge_where = name;
    }
    // The plane's margin is for the comparison with the point's height, so both errors count. The point's error is
    // relative in perspective; it counts only if the heights are near enough to each other.
    long double error = real.height(x, y) - static_cast<long double>(evaluated.plane);
    const bool is_comparable = std::fabs(z) <= 2 * (std::fabs(evaluated.plane) + r.margin_plane);
    if (is_comparable) error -= point.z - static_cast<long double>(z);
    const long double ratio = ratio_of(error, r.margin_plane);
    if (!(ratio <= tally.plane_ratio)) tally.plane_ratio = ratio, tally.plane_where = name;
}

void expect_claims_hold(const Claims& claims, const ExactPair& exact, std::uint32_t triangle, std::uint32_t point) {
    const auto hold = [&](bool claim, bool truth, const char* what) {
        EXPECT_TRUE(!claim || truth) << "triangle " << triangle << ", point " << point << ": not " << what;
    };
    hold(claims.inside, exact.covers, "inside");
    hold(claims.outside, !exact.covers, "outside");
    hold(claims.nearer, exact.nearer, "nearer");
    hold(claims.behind, exact.behind, "behind");
    hold(claims.above && exact.covers, exact.nearer, "above the triangle");
    hold(claims.below && exact.covers, exact.behind, "below the triangle");
}

/// Every triangle against every point of one frame.
void attack_frame(const FrameOutput& out, const LightScene& scene, Tally& tally) {
    std::map<std::uint32_t, const SetUpTriangle*> records;
    for (const SetUpTriangle& t : out.triangles) records[t.id] = &t;
    const reference::GridMap map = real_map(out.projection);
    for (std::uint32_t id = 0; id < scene.triangles.size() / 9; ++id) {
        const reference::Triangle triangle = reference::triangle_at(scene.triangles, id);
        if (!reference::is_finite(triangle)) {
            EXPECT_FALSE(records.contains(id));
            continue;
        }
        const SetUpTriangle* set_up = records.contains(id) ? records[id] : nullptr;
        const reference::GridTriangle real(map, triangle);
        const float orientation = orientation_in_grid(triangle, scene.light, out.projection);
        for (const ListedPoint& point : out.points) {
            const reference::Float3 p = reference::point_at(scene.points, point.id);
            const ExactPair exact = exact_pair(triangle, p, scene.light);
            const std::uint32_t bin_x = point.bin % out.frame.bins_x, bin_y = point.bin / out.frame.bins_x;
            if (set_up == nullptr || !set_up->bins.contains(bin_x, bin_y)) {
                ++tally.missing;
                EXPECT_FALSE(exact.blocks) << "triangle " << id << " has no record where it blocks point " << point.id;
                continue;
            }
            const Evaluated evaluated(set_up->record, point.x, point.y);
            const Claims claims = claims_of(set_up->record, evaluated, point.z);
            expect_claims_hold(claims, exact, id, point.id);
            ++tally.pairs;
            tally.open += claims.is_open();
            tally.inside += claims.inside;
            tally.behind += claims.inside && (claims.behind || claims.below);
            if (out.projection.indistinct == 0)
                measure(set_up->record, evaluated, point.z, real, orientation, map(p), scene.name, tally);
        }
    }
}

Tally attack(const std::vector<LightScene>& scenes, const char* what, const StageSettings& settings = {}) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const LightScene& scene : scenes) {
        SCOPED_TRACE(scene.name);
        for (const FrameOutput& out : run_light_stages(device, scene, settings)) attack_frame(out, scene, tally);
        if (testing::Test::HasFailure()) break;
    }
    tally.print(what);
    EXPECT_LE(tally.edge_ratio, 1);
    EXPECT_LE(tally.plane_ratio, 1);
    return tally;
}

// Not vacuous: about half of the points are built behind a triangle, many of them exactly on a ray through an edge or
// a vertex, and the records give thousands of certain shadows.
TEST(TriangleSetup, EqualsReferenceInScenesOfTies) {
    const Tally tally = attack(light_scenes(), "ties");
    EXPECT_GT(tally.behind, 1000u);
    EXPECT_LT(tally.open, tally.pairs / 2);
}

TEST(TriangleSetup, EqualsReferenceUnderHugeTriangles) {
    const Tally tally = attack(huge_triangle_scenes(), "huge triangles");
    EXPECT_GT(tally.behind, 1000u);
}

// Not vacuous: every second triangle has a vertex in the plane W = 0 of a face, or an ulp beside it.
TEST(TriangleSetup, EqualsReferenceAroundAPointLight) {
    const Tally tally = attack(point_light_plane_scenes(), "around a point light");
    EXPECT_GT(tally.behind, 1000u);
}

// Products of three floats underflow here; a margin made of relative errors alone would be 0.
TEST(TriangleSetup, EqualsReferenceWhereProductsUnderflow) { attack(underflow_scenes(), "underflow"); }

TEST(TriangleSetup, EqualsReferenceInTheOraclesOwnScenes) { attack(reference_scenes(), "oracle's scenes"); }

// ---- Camera ---------------------------------------------------------------------------------------------------------

gnomon::FrameCounters set_up(gnomon::cl::Session& session, gnomon::TriangleSetup& setup,
                             const gnomon::CameraTables& tables, const gnomon::Triangles& triangles) {
    const gnomon::cl::Buffer on_device = uploaded(session, std::vector<gnomon::Projection>{tables.projection});
    const gnomon::CameraSamples samples{tables.picture, 1, 0.5f};
    gnomon::ProjectionInput projected(on_device);
    projected.camera = &samples;
    gnomon::cl::Buffer counters(session, sizeof(gnomon::FrameCounters));
    gnomon::FrameCounters counted{};
    do {
        session.fill(counters, 0, sizeof(counted));
        setup.run_bounds(session, projected, gnomon::triangle_inputs(triangles), nullptr, nullptr, counters);
        setup.run_tiles(session, projected, gnomon::triangle_inputs(triangles), nullptr, nullptr, counters);
        session.read(counters.get(), &counted, sizeof(counted));
    } while (!setup.fitted(session, counted));
    return counted;
}

using Wide3 = std::array<long double, 3>;

/// The direction of a pixel's ray: an exact sum of four float vectors, rounded to long double.
Wide3 direction_of(const gnomon::CameraTables& tables, std::uint32_t x, std::uint32_t y) {
    const float* column = tables.rays.data() + RAY_FLOATS * std::size_t(x);
    const float* row = tables.rays.data() + RAY_FLOATS * (std::size_t(tables.projection.width) + y);
    Wide3 sum{};
    for (int k = 0; k < 3; ++k) sum[k] = (static_cast<long double>(column[k]) + row[k]) + (column[k + 3] + row[k + 3]);
    return sum;
}

/// Checks the margins of a camera's record for one exact ray. The record's edges are divided by their margin, which is
/// computed here from its definition (kernels/occluders/eye_records.clh).
void measure_eye(const TriangleRecord& r, const Evaluated& evaluated, const gnomon::CameraTables& tables,
                 const Wide3& ray, const reference::Triangle& t, float orientation, long double height,
                 const std::string& name, Tally& tally) {
    constexpr long double bound = 7.5e-7L;  // EYE_EDGE_BOUND
    const gnomon::Projection& p = tables.projection;
    for (int i = 0; i < 3; ++i) {
        if (r.edge_x[i] == 0 && r.edge_y[i] == 0 && r.edge_0[i] == 0) continue;  // undecided
        long double u[3], v[3], margin = 0, edge = 0;
        for (int k = 0; k < 3; ++k) {
            u[k] = static_cast<long double>(t[i][k]) - p.center[k];
            v[k] = static_cast<long double>(t[(i + 1) % 3][k]) - t[i][k];
        }
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            const long double largest = std::fabs(tables.picture.corner[k]) +
                                        (p.bins_x << p.bin_log2) * std::fabs(tables.picture.step_x[k]) +
                                        (p.bins_y << p.bin_log2) * std::fabs(tables.picture.step_y[k]);
            margin += bound * largest * (std::fabs(u[l] * v[m]) + std::fabs(u[m] * v[l]));
            edge += ray[k] * (u[l] * v[m] - u[m] * v[l]);
        }
        const long double ratio = std::fabs(orientation * edge - evaluated.edge[i] * margin) / margin;
        if (ratio > tally.edge_ratio) tally.edge_ratio = ratio, tally.edge_where = name;
    }
    const long double ratio = ratio_of(height - static_cast<long double>(evaluated.plane), r.margin_plane);
    if (!(ratio <= tally.plane_ratio)) tally.plane_ratio = ratio, tally.plane_where = name;
}

/// Every record against every pixel centre of its bins; triangles without a record against every pixel.
void attack_view(gnomon::cl::Session& session, const gnomon::Device& device, const CameraScene& scene, Tally& tally) {
    const gnomon::CameraTables tables = gnomon::camera_tables(scene.camera(), scene.width, scene.height);
    gnomon::TriangleSetup setup;
    const gnomon::FrameCounters counted =
        set_up(session, setup, tables, gnomon::Triangles::upload(device, scene.triangles));
    const auto records = downloaded<TriangleRecord>(session, setup.records().get(), counted.slots);
    const auto bounds = downloaded<gnomon::TriangleBounds>(session, setup.bounds().get(), counted.slots);
    std::map<std::uint32_t, std::size_t> slots;
    for (std::size_t i = 0; i < bounds.size(); ++i)
        if (!is_dropped(bounds[i])) slots[bounds[i].id] = i;

    const gnomon::Camera camera = scene.camera();
    const auto wide = [](const std::array<double, 3>& v) { return reference::Wide3{v[0], v[1], v[2]}; };
    const auto step = static_cast<long double>(std::tan(camera.fov_y_radians / 2) / (scene.height / 2.0));
    const reference::GridMap map = reference::GridMap::camera(scene.eye, wide(camera.right), wide(camera.up),
                                                              wide(camera.forward), step, scene.width, scene.height);
    for (std::uint32_t y = 0; y < scene.height; ++y)
        for (std::uint32_t x = 0; x < scene.width; ++x) {
            const reference::ExactRay ray = exact_ray(tables, x, y);
            const float pixel_x = float(x) + 0.5f, pixel_y = float(y) + 0.5f;
            for (std::uint32_t id = 0; id < scene.triangles.size() / 9; ++id) {
                const reference::Triangle triangle = reference::triangle_at(scene.triangles, id);
                const bool meets = ray.meets(triangle);
                const auto slot = slots.find(id);
                if (slot == slots.end() || !bins_of(bounds[slot->second], tables.projection)
                                                .contains(x >> CAMERA_TILE_LOG2, y >> CAMERA_TILE_LOG2)) {
                    ++tally.missing;
                    EXPECT_FALSE(meets) << "triangle " << id << " has no record at pixel " << x << ", " << y;
                    continue;
                }
                const TriangleRecord& r = records[slot->second];
                const Evaluated evaluated(r, pixel_x, pixel_y);
                ++tally.pairs;
                tally.inside += evaluated.inside() > r.margin_edge;
                tally.open += std::fabs(evaluated.inside()) <= r.margin_edge;
                EXPECT_FALSE(evaluated.inside() > r.margin_edge && !meets) << id << " at " << x << ", " << y;
                EXPECT_FALSE(evaluated.inside() < -r.margin_edge && meets) << id << " at " << x << ", " << y;
                const reference::GridTriangle real(map, triangle);
                const float orientation =
                    orientation_in_grid(triangle, {scene.eye[0], scene.eye[1], scene.eye[2], 1}, tables.projection) *
                    tables.projection.handedness;
                const long double z = real.height(pixel_x, pixel_y);
                measure_eye(r, evaluated, tables, direction_of(tables, x, y), triangle, orientation, z, scene.name,
                            tally);
                if (!meets) continue;
                EXPECT_TRUE(r.z_low <= z && z <= r.z_high) << id << " at " << x << ", " << y;
            }
        }
}

// Not vacuous: the views hold thousands of certain hits, and the lattice wall's vertices lie on pixel centres.
TEST(TriangleSetup, EqualsReferenceForCameras) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const CameraScene& scene : camera_scenes()) {
        SCOPED_TRACE(scene.name);
        attack_view(session_of(device), device, scene, tally);
        if (testing::Test::HasFailure()) break;
    }
    tally.print("cameras");
    EXPECT_LE(tally.edge_ratio, 1);
    EXPECT_LE(tally.plane_ratio, 1);
    EXPECT_GT(tally.inside, 5000u);
}

// ---- The other laws -------------------------------------------------------------------------------------------------

/// Scenes for laws that compare runs: a directional light over soup, and a point light inside it.
std::vector<LightScene> comparison_scenes() {
    const Floats triangles = soup(300, 0.3f, 51);
    return {tie_scene("sun", triangles, along(0.3f, -1, 0.2f), 400, 2, 52),
            tie_scene("point light", triangles, at(0.05f, -0.1f, 0.2f), 400, 2, 53)};
}

bool same(const SetUpTriangle& a, const SetUpTriangle& b) {
    return std::memcmp(&a.record, &b.record, sizeof(a.record)) == 0 &&
           std::memcmp(&a.bins, &b.bins, sizeof(a.bins)) == 0;
}

void expect_same_records(const FrameOutput& a, const FrameOutput& b,
                         const std::function<std::uint32_t(std::uint32_t)>& a_from_b) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    std::map<std::uint32_t, const SetUpTriangle*> of_a;
    for (const SetUpTriangle& t : a.triangles) of_a[t.id] = &t;
    for (const SetUpTriangle& t : b.triangles) {
        ASSERT_TRUE(of_a.contains(a_from_b(t.id)));
        EXPECT_TRUE(same(*of_a[a_from_b(t.id)], t)) << "triangle " << t.id;
    }
}

// Not vacuous: each scene has records in every frame, and the shuffle moves all but a few triangles.
TEST(TriangleSetup, OrderFree) {
    const gnomon::Device device = device_with();
    for (const LightScene& scene : comparison_scenes()) {
        SCOPED_TRACE(scene.name);
        const auto order = shuffled_order(scene.triangles.size() / 9, 54);
        LightScene shuffled = scene;
        for (std::size_t i = 0; i < shuffled.triangles.size(); ++i)
            shuffled.triangles[i] = scene.triangles[9 * order[i / 9] + i % 9];
        const auto plain = run_light_stages(device, scene), mixed = run_light_stages(device, shuffled);
        ASSERT_EQ(plain.size(), mixed.size());
        for (std::size_t f = 0; f < plain.size(); ++f) {
            EXPECT_FALSE(plain[f].triangles.empty());
            expect_same_records(plain[f], mixed[f], [&](std::uint32_t id) { return order[id]; });
        }
    }
    // The vertices in another order: other floats, the same truths.
    std::vector<LightScene> reversed = comparison_scenes();
    for (LightScene& scene : reversed) scene.triangles = reversed_winding(scene.triangles);
    attack(reversed, "reversed");
}

TEST(TriangleSetup, ShapeFree) {
    for (const LightScene& scene : comparison_scenes()) {
        const auto expected = run_light_stages(device_with(), scene);
        for (const std::uint32_t size : FEW_WORK_GROUP_SIZES) {
            SCOPED_TRACE(scene.name + ", work-groups of " + std::to_string(size));
            const auto found = run_light_stages(device_with(size), scene);
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t f = 0; f < found.size(); ++f)
                expect_same_records(expected[f], found[f], [](std::uint32_t id) { return id; });
        }
    }
}

// Not vacuous: one triangle of each kind is above the points, so a wrong verdict would show in a counter.
TEST(TriangleSetup, SurvivesDegenerates) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Floats triangles;
    add(triangles, {-1, 1, -1}, {1, 1, -1}, {0, 1, nan});                         // not finite
    add(triangles, {-1, 1, -1}, {1, inf, -1}, {0, 1, 1});                         // not finite
    add(triangles, {-1, 1, -1}, {-inf, 1, -1}, {0, 1, 1});                        // not finite
    add(triangles, {0, 1, 0}, {0, 1, 0}, {0, 1, 0});                              // a point
    add(triangles, {-1, 1, -1}, {0, 1, 0}, {1, 1, 1});                            // a line
    add(triangles, {0, 1, -0.5f}, {0, 2, -0.5f}, {0, 1, 0.5f});                   // edge-on to the light
    add(triangles, {-3e38f, 1, -3e38f}, {3e38f, 1, -3e38f}, {0, 1, 3e38f});       // as large as floats go
    add(triangles, {-1e-45f, 1, -1e-45f}, {1e-45f, 1, -1e-45f}, {0, 1, 1e-45f});  // as small
    add(triangles, {-1, 1e-45f, -1}, {1, 1e-45f, -1}, {0, 1e-45f, 1});            // a denormal above the points
    LightScene scene{"degenerates", triangles, placed(random_points(2000, -0.5f, 0.5f, 55), 1, {0, -0.5, 0}),
                     along(0, -1, 0)};
    Tally tally;
    const gnomon::Device device = device_with();
    // The verdicts of the first pass: a second pass has fewer points to cover.
    const UploadedScene inputs(device, scene);
    LightStages stages;
    FrameOutput first{};
    first.frame = light_frames(inputs.light, StageSettings{}.grid)[0];
    run_stages_once(session_of(device), stages, inputs, {}, first);
    EXPECT_EQ(first.counters.not_finite, 3u);
    EXPECT_EQ(first.counters.edge_on, 3u);
    EXPECT_EQ(first.counters.survivors, 6u);  // including the edge-on triangles
    for (const FrameOutput& out : run_light_stages(device, scene)) attack_frame(out, scene, tally);
    // The light in the plane of a triangle, at a vertex, at a point; and every point at one position.
    scene.light = at(0, 1, 0);
    for (const FrameOutput& out : run_light_stages(device, scene)) attack_frame(out, scene, tally);
    scene.light = along(1, 0, 0);
    for (const FrameOutput& out : run_light_stages(device, scene)) attack_frame(out, scene, tally);
    scene.light = {scene.points[0], scene.points[1], scene.points[2], 1};
    for (const FrameOutput& out : run_light_stages(device, scene)) attack_frame(out, scene, tally);
    for (std::size_t i = 3; i < scene.points.size(); ++i) scene.points[i] = scene.points[i % 3];
    scene.light = along(0.1f, -1, 0);
    for (const FrameOutput& out : run_light_stages(device, scene)) attack_frame(out, scene, tally);
    EXPECT_GT(tally.pairs, 500u);
}

// Not vacuous: the second run's list ends well inside the first one's, and canaries stand between.
TEST(TriangleSetup, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const CameraScene scene = camera_scenes().front();
    const gnomon::CameraTables tables = gnomon::camera_tables(scene.camera(), scene.width, scene.height);
    gnomon::TriangleSetup setup;
    const gnomon::FrameCounters all =
        set_up(session, setup, tables, gnomon::Triangles::upload(device, scene.triangles));
    for (const gnomon::cl::Buffer* buffer : {&setup.records(), &setup.bounds(), &setup.tiles().buffer()})
        put_canaries(session, *buffer);
    const gnomon::FrameCounters few =
        set_up(session, setup, tables, gnomon::Triangles::upload(device, std::span(scene.triangles).first(9 * 50)));
    ASSERT_LT(few.survivors, all.survivors);
    ASSERT_GT(few.survivors, 0u);
    ASSERT_LT(few.slots, setup.capacity());
    expect_canaries(session, setup.records(), few.slots * sizeof(TriangleRecord), "records");
    expect_canaries(session, setup.bounds(), few.slots * sizeof(gnomon::TriangleBounds), "bounds");
    expect_canaries(session, setup.tiles().buffer(), few.tiles * 2 * sizeof(cl_uint), "tiles");
}

TEST(TriangleSetup, Grows) {
    for (const LightScene& scene : comparison_scenes()) {
        const gnomon::Device device = device_with();
        StageSettings settings;
        const auto expected = run_light_stages(device, scene, settings);
        settings.first_capacity = 1;
        const auto found = run_light_stages(device, scene, settings);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t f = 0; f < found.size(); ++f) EXPECT_EQ(found[f].visibility, expected[f].visibility);
    }
}

}  // namespace
