// SPDX-License-Identifier: MIT
// gnomon::explain(): its occluders are exactly the triangles that the exact predicate of the reference finds, its signs
// are those of the contract, and it agrees with the visibility of a run, for points of every stage and every level of
// arithmetic.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "reference/predicates.hpp"
#include "support/rerun.hpp"
#include "support/tie_points.hpp"
#include "trace/frustum_tracer.hpp"

namespace {

using namespace support;

reference::Triangle triangle_of(const Floats& triangles, std::size_t id) {
    return {vertex(triangles, 3 * id), vertex(triangles, 3 * id + 1), vertex(triangles, 3 * id + 2)};
}

/// The contract of docs/numerics.md, 1, in signs.
bool blocks_by_signs(const gnomon::TriangleSigns& t) {
    return t.light_side != 0 && t.point_side == -t.light_side &&
           std::all_of(t.edges.begin(), t.edges.end(), [&](int edge) { return edge * t.light_side >= 0; });
}

void expect_occluders(const gnomon::Explanation& e, const Floats& triangles, const Light& light) {
    reference::Effort effort;
    const reference::Ray ray = reference::Ray::to_light(e.position, light);
    std::set<std::uint32_t> expected, found;
    for (std::uint32_t id = 0; id < triangles.size() / 9; ++id)
        if (id != e.receiver && reference::blocks(ray, triangle_of(triangles, id), effort)) expected.insert(id);
    double distance = 0;
    for (const gnomon::TriangleSigns& t : e.occluders) {
        found.insert(t.triangle);
        EXPECT_TRUE(t.blocks && blocks_by_signs(t)) << "triangle " << t.triangle;
        EXPECT_GE(t.distance, distance) << "triangle " << t.triangle << " is not in order";
        distance = t.distance;
        const auto first = triangles.begin() + 9 * std::ptrdiff_t(t.triangle);
        EXPECT_TRUE(std::equal(t.vertices.begin(), t.vertices.end(), first));
    }
    for (const gnomon::TriangleSigns& t : e.near_misses) {
        EXPECT_FALSE(t.blocks || blocks_by_signs(t)) << "triangle " << t.triangle;
        EXPECT_NE(t.arithmetic, "float");
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), e.occluders.size()) << "a triangle is listed twice";
}

struct Scene {
    Floats triangles, points;
    std::vector<std::uint32_t> receivers;
    Light light{};
    gnomon::Float3 eye{};
};

/// Up to four points of each provenance. `seen`: how many of each were explained.
void expect_explained(const gnomon::Device& device, const Scene& scene, std::map<std::string, int>& seen) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::Points points = gnomon::Points::upload(device, scene.points, scene.receivers);
    const auto facing = gnomon::Facing::eye(scene.eye);
    const gnomon::Points seen_points = gnomon::Internals::seen_from(points, scene.eye);
    const gnomon::Light light{scene.light};
    const gnomon::Visibility visibility(device, points.count());
    const auto provenance = gnomon::FrustumTracer(device).run_watched(triangles, seen_points, light, visibility);
    gnomon::make_technique("frustum-traced", device)->run(triangles, points, light, visibility, {.facing = facing});
    const std::vector<float> visible = visibility.read();
    std::map<std::uint32_t, int> explained;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        if (++explained[2 * provenance[i] + (visible[i] == 1.0f)] > 4) continue;
        const gnomon::Explanation e = gnomon::explain(device, triangles, points, i, light, facing);
        SCOPED_TRACE(gnomon_test::rerun_command(scene.triangles, e.position, e.receiver, scene.light, scene.eye));
        EXPECT_EQ(e.visibility, visible[i]);
        EXPECT_TRUE(e.is_consistent());
        EXPECT_EQ(e.receiver, scene.receivers[i]);
        EXPECT_EQ(e.is_backfacing, e.stage == "facing" && e.arithmetic != "none");
        EXPECT_EQ(e.is_backfacing, provenance[i] == PROVENANCE_FACES_AWAY);
        if (provenance[i] != PROVENANCE_ABSENT) expect_occluders(e, scene.triangles, scene.light);
        ++seen[e.stage + " " + e.arithmetic + (e.is_lit() ? " lit" : " shadowed")];
    }
}

TEST(Explain, AgreesWithARunAndWithTheReference) {
    const gnomon::Device device;
    std::map<std::string, int> seen;
    for (const auto& [name, light] : lights_of_every_kind()) {
        SCOPED_TRACE(name);
        Scene scene{lattice_blocks(3, 6, 1), lattice_points(5000, 6, 3), {}, moved(light, 3, {3.5, 3.5, 3.5}), {}};
        scene.points[0] = std::numeric_limits<float>::quiet_NaN();
        for (std::uint32_t i = 0; i < 5000; ++i)
            scene.receivers.push_back(i % std::uint32_t(scene.triangles.size() / 9));
        scene.eye = {20, 30, 40};
        expect_explained(device, scene, seen);
        scene = {on_grid(soup(300, 0.4f, 2)), {}, std::vector<std::uint32_t>(300, gnomon::no_receiver), light, {}};
        scene.points = edge_middles(scene.triangles);
        expect_explained(device, scene, seen);
        scene.triangles = soup(300, 0.4f, 2);
        scene.light = light;
        scene.points = points_behind(scene.triangles, light, 5000, 3, 7);
        scene.receivers.assign(5000, gnomon::no_receiver);
        expect_explained(device, scene, seen);
    }
    // Not vacuous: every stage and level decided some.
    for (const char* const what :
         {"facing none lit", "facing float shadowed", "conservative_map filter shadowed", "trace filter lit",
          "trace filter shadowed", "exact_trace float shadowed", "exact_trace double lit",
          "exact_trace double shadowed", "exact_trace integers lit", "exact_trace integers shadowed"})
        EXPECT_GT(seen[what], 0) << what << " never happened";
}

TEST(Explain, ListsMoreOccludersThanFitAtFirstAndRefusesAPointThatIsNotThere) {
    const gnomon::Device device;
    Floats roofs;
    for (int i = 0; i < 200; ++i) {
        const float y = float(1 + i);
        add(roofs, {-9, y, -9}, {9, y, -9}, {0, y, 9});
    }
    const auto triangles = gnomon::Triangles::upload(device, roofs);
    const auto points = gnomon::Points::upload(device, std::vector<float>{0, 0, 0});
    const auto light = gnomon::Light::directional({0, -1, 0});
    const gnomon::Explanation e = gnomon::explain(device, triangles, points, 0, light);
    ASSERT_EQ(e.occluders.size(), 200u);
    EXPECT_EQ(e.occluders.front().triangle, 0u);
    EXPECT_EQ(e.occluders.back().distance, 200);
    EXPECT_FALSE(e.is_lit());
    EXPECT_THROW(gnomon::explain(device, triangles, points, 1, light), gnomon::InvalidArgument);
    const auto none = gnomon::Triangles::upload(device, {});
    EXPECT_TRUE(gnomon::explain(device, none, points, 0, light).is_lit());
}

}  // namespace
