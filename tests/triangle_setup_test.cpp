// SPDX-License-Identifier: MIT
// Stage triangle_setup. Its records claim to be certain; each claim is held against the exact predicate, and each
// margin against the true value it must bound. Three kinds of projection: a direction, a position (six faces), a
// camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>

#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;
using gnomon::TriangleRecord;

/// A record at a place, computed as the kernels do (fma is exact on both sides).
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

/// Sign of the triangle's orientation as the light sees it, as it is in the grid.
float orientation_in_grid(const reference::Triangle& t, const std::array<float, 4>& light,
                          const gnomon::Projection& projection) {
    reference::Effort effort;
    const reference::Float3 xyz{light[0], light[1], light[2]};
    const int sign =
        light[3] == 0 ? reference::side_of_direction(xyz, t, effort) : reference::side_of_point(xyz, t, effort);
    return float(sign) * projection.handedness;
}

/// Checks the margins for one pair: the record's values at the point's computed place against the real ones at its real
/// place.
void measure(const TriangleRecord& r, const Evaluated& evaluated, float z, const reference::GridTriangle& real,
             float orientation, const reference::GridPosition& point, const std::string& name, Tally& tally) {
    const long double x = point.x / point.w, y = point.y / point.w;
    for (int i = 0; i < 3; ++i) {
        const long double ratio = ratio_of(orientation * real.edge(i, x, y) - evaluated.edge[i], r.margin_edge);
        if (ratio > tally.edge_ratio) tally.edge_ratio = ratio, tally.edge_where = name;
    }
    // The plane's margin is for the comparison with the point's height, so both errors count; the point's, which is
    // relative in perspective, only where the heights are near enough to each other to matter.
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
// a vertex, and the records claim thousands of certain shadows.
TEST(triangle_setup, equals_reference_in_scenes_of_ties) {
    const Tally tally = attack(light_scenes(), "ties");
    EXPECT_GT(tally.behind, 1000u);
    EXPECT_LT(tally.open, tally.pairs / 2);
}

TEST(triangle_setup, equals_reference_under_huge_triangles) {
    const Tally tally = attack(huge_triangle_scenes(), "huge triangles");
    EXPECT_GT(tally.behind, 1000u);
}

// Products of three floats underflow here; a margin made of relative errors alone would be 0.
TEST(triangle_setup, equals_reference_where_products_underflow) { attack(underflow_scenes(), "underflow"); }

TEST(triangle_setup, equals_reference_in_the_oracles_own_scenes) { attack(reference_scenes(), "oracle's scenes"); }

}  // namespace
