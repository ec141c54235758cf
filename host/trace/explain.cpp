// SPDX-License-Identifier: MIT
// gnomon::explain(): exact signs by kernels/trace/explain.cl, and provenance in words.
#include <algorithm>

#include "kernels/trace/explain.h"
#include "query/vectors.hpp"
#include "trace/frustum_tracer.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "trace/explain.cl";
constexpr const char* level_names[] = {"float", "double", "integers"};

// In the order of kernels/trace/provenance.h.
constexpr struct {
    const char *stage, *arithmetic;
} decided_by[PROVENANCE_COUNT] = {
    {"none", "none"},             // open: must not appear
    {"none", "none"},             // open, and its own receiver may shadow it
    {"trace", "filter"},          // lit
    {"exact_trace", "float"},     // the levels of the exact predicate
    {"exact_trace", "double"},    //
    {"exact_trace", "integers"},  //
    {"trace", "filter"},          // in shadow
    {"conservative_map", "filter"},
    {"trace_queue_overflow", "exact"},
    {"facing", ""},      // backfacing
    {"facing", "none"},  // lit: no triangles, or at the light itself
    {"facing", "none"},  // absent
};

/// Distance along the shadow ray from the point to the triangle's plane. Rounded: it orders the report, no decision.
double distance_along_ray(const ExplainedTriangle& t, const Float3& point, const Light& light) {
    Double3 u, v, to_plane, ray;
    for (std::size_t i = 0; i < 3; ++i) {
        u[i] = double(t.vertices[3 + i]) - t.vertices[i];
        v[i] = double(t.vertices[6 + i]) - t.vertices[i];
        to_plane[i] = double(t.vertices[i]) - point[i];
        ray[i] = double(light.xyzw[i]) - (light.is_directional() ? 0.0 : double(point[i]));
    }
    if (!normalize(ray)) return 0;
    const Double3 normal = cross(u, v);
    return dot(normal, to_plane) / dot(normal, ray);
}

TriangleSigns signs_of(const ExplainedTriangle& t, const Float3& point, const Light& light) {
    TriangleSigns signs;
    signs.triangle = t.triangle;
    std::copy(std::begin(t.vertices), std::end(t.vertices), signs.vertices.begin());
    signs.blocks = t.meets == EXPLAINED_BLOCKS;
    signs.is_clear = t.meets == EXPLAINED_CLEAR;
    signs.point_side = t.point_side;
    signs.light_side = t.light_side;
    std::copy(std::begin(t.edges), std::end(t.edges), signs.edges.begin());
    signs.arithmetic = level_names[t.level];
    if (t.meets != EXPLAINED_MISSED) signs.distance = distance_along_ray(t, point, light);
    return signs;
}

/// The report without the result of a run: visibility and stage are empty, arithmetic is that of facing.
Explanation explain_signs(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                          const Light& light) {
    cl::Session& session = session_of(device);
    const TriangleInputs scene = triangle_inputs(triangles);
    const PointInputs inputs = point_inputs(points);
    ExplainParams params{};
    params.triangles = scene;
    std::copy(light.xyzw.begin(), light.xyzw.end(), params.light);
    params.points = inputs.layout;
    params.index = static_cast<cl_uint>(index);
    params.capacity = 64;
    cl::Buffer on_device(session, sizeof(ExplainedPoint)), list;
    ExplainedPoint found{};
    std::vector<ExplainedTriangle> listed;
    do {
        params.capacity = std::max(params.capacity, found.count);
        listed.resize(params.capacity);
        list.reserve(session, listed.size() * sizeof(ExplainedTriangle));
        session.launch(scene.kernel(file, "explain_point"), cl::Range::items(1), params, inputs.positions,
                       inputs.receivers, scene.vertices, on_device);
        session.launch(scene.kernel(file, "explain_triangles"), cl::Range::items(scene.count), params, scene.vertices,
                       on_device, list);
        found = session.read_value<ExplainedPoint>(on_device);
    } while (found.count > params.capacity);
    session.read(list.get(), listed.data(), found.count * sizeof(ExplainedTriangle));
    listed.resize(found.count);

    Explanation explanation;
    std::copy(std::begin(found.position), std::end(found.position), explanation.position.begin());
    explanation.receiver = found.receiver;
    if (found.receiver != no_receiver)
        explanation.on_receiver = signs_of(found.on_receiver, explanation.position, light);
    explanation.is_backfacing = found.is_backfacing != 0;
    explanation.eye_side = found.eye_side;
    explanation.arithmetic = level_names[found.facing_level];
    for (const ExplainedTriangle& t : listed)
        (t.meets == EXPLAINED_BLOCKS  ? explanation.occluders
         : t.meets == EXPLAINED_CLEAR ? explanation.clear_hits
                                      : explanation.near_misses)
            .push_back(signs_of(t, explanation.position, light));
    const auto nearer = [](const TriangleSigns& a, const TriangleSigns& b) {
        return std::pair(a.distance, a.triangle) < std::pair(b.distance, b.triangle);
    };
    for (auto* signs : {&explanation.occluders, &explanation.clear_hits, &explanation.near_misses})
        std::sort(signs->begin(), signs->end(), nearer);
    return explanation;
}

}  // namespace

Explanation explain(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                    const Light& light, const Facing& facing) {
    if (index >= points.count())
        throw InvalidArgument("there is no point " + std::to_string(index) + " to explain: there are " +
                              std::to_string(points.count()));
    const Points seen = seen_from_eye(device, points, facing);
    const Visibility visibility(device, points.count());
    const std::uint32_t provenance = FrustumTracer(device).run_watched(triangles, seen, light, visibility)[index];
    Explanation explanation = explain_signs(device, triangles, seen, index, light);
    explanation.visibility = visibility.read()[index];
    explanation.stage = decided_by[provenance].stage;
    // The level of facing is the level of the receiver's determinants, which are known.
    if (provenance != PROVENANCE_FACES_AWAY) explanation.arithmetic = decided_by[provenance].arithmetic;
    return explanation;
}

}  // namespace gnomon
