// SPDX-License-Identifier: MIT
#include "query/variants.hpp"

namespace gnomon {
namespace {

enum DeviceFamily { any_device, cpu, gpu };

struct Variant {
    Task task;
    DeviceFamily family;
    cl::Kernel kernel;
    /// On a GPU: of its own, for directional lights. Without perspective it keeps fewer registers, so that more
    /// work-items run at once. On a CPU one program for both compiles sooner.
    bool has_directional_program = false;
};
constexpr bool specialised = true;

// For each task the first matching row is taken.
// One row per line:
// clang-format off
constexpr Variant variants[] = {
    // Facing reads all points. A cache of receivers' facing saves the predicate for points that share a receiver.
    {Task::decide_facing_cached, cpu, {"receivers/facing_cpu.cl", "facing_cached"}},
    {Task::decide_facing_cached, gpu, {"receivers/facing_gpu.cl", "facing_cached"}, specialised},
    // Where points may shadow themselves, each needs the predicate.
    {Task::decide_facing_each, cpu, {"receivers/facing_cpu.cl", "facing"}},
    {Task::decide_facing_each, gpu, {"receivers/facing_gpu.cl", "facing"}, specialised},
    // A GPU filters by floats first, and calls the predicate for undecided points only.
    {Task::decide_facing_filtered, gpu, {"receivers/facing_gpu.cl", "facing_filter"}, specialised},
    {Task::decide_facing_exactly, gpu, {"receivers/facing_gpu.cl", "facing_exact_fallback"}, specialised},
    {Task::decide_facing_footprints, cpu, {"receivers/facing_cpu.cl", "facing_cached_footprints"}},
    {Task::decide_facing_footprints, gpu, {"receivers/facing_gpu.cl", "facing_cached_footprints"}, specialised},
    // Sponza's two million points: 7.5 ms of one core, 10.5 with conditions for all kinds of points.
    {Task::decide_facing_picture, cpu, {"receivers/facing_picture.cl", "facing_picture_directional"}},
    {Task::decide_facing_triangles, gpu, {"receivers/facing_gpu.cl", "facing_triangles"}, specialised},
    {Task::make_receiver_depths, any_device, {"receivers/receiver_depth_pyramid.cl", "receiver_depth_pyramid"}, specialised},
    {Task::cull_clusters, any_device, {"occluders/clusters.cl", "cull_clusters"}, specialised},
    {Task::make_triangle_bounds, any_device, {"occluders/triangle_bounds.cl", "triangle_bounds"}, specialised},
    {Task::make_triangle_tiles, any_device, {"occluders/triangle_tiles.cl", "triangle_tiles"}, specialised},
    // A camera's records are made from its rays, not from a projection: their margins are a tenth, so that few pixels
    // need the triangle itself.
    {Task::make_camera_tiles, cpu, {"occluders/triangle_tiles.cl", "triangle_tiles"}},
    {Task::make_camera_tiles, gpu, {"occluders/triangle_tiles.cl", "triangle_tiles", {.eye_records = true}}},
    // One text for all: a CPU walks lists by blocks of points, a GPU by single points (GN_LANES).
    {Task::trace, any_device, {"trace/trace.cl", "trace"}},
    // A separate program: few frames need it, and a GPU's compiler takes a second or two for it.
    {Task::trace_queue_overflow, any_device, {"trace/trace.cl", "trace_queue_overflow", {.queue_overflow = true}}},
    {Task::trace_prepared, any_device, {"prepared/prepared_trace.cl", "prepared_trace"}},
    // Measured: the facing cache takes 11 to 17 % off a CPU's run.
    {Task::trace_prepared_cached_facing, cpu, {"prepared/prepared_trace.cl", "prepared_trace_cached_facing", {.cached_facing = true}}},
    // Measured on an H200: without the predicate, and by planes, a run takes 20 % less.
    {Task::trace_prepared_plane_side, gpu, {"prepared/prepared_trace.cl", "prepared_trace_plane_side", {.plane_side = true}}},
};
// clang-format on

}  // namespace

cl::Kernel variant(const cl::Session& session, Task task, bool is_directional, bool has_cut_outs) {
    for (const Variant& row : variants) {
        if (row.task != task || (row.family != any_device && (row.family == cpu) != session.is_cpu())) continue;
        cl::Kernel kernel = row.kernel;
        kernel.flags.directional_only = row.has_directional_program && !session.is_cpu() && is_directional;
        kernel.flags.cut_outs = has_cut_outs;
        return kernel;
    }
    throw Error("no kernel is made for this task on this device");
}

bool share_facing(const PointInputs& points) {
    return points.layout.has_receivers != 0 && !points.face_light &&
           (points.layout.is_lifted != 0 || points.footprints != nullptr);
}

Task facing_task(const cl::Session& session, const PointInputs& points, bool is_directional, bool has_cache,
                 bool filters, bool opens_points) {
    if (!has_cache) return filters ? Task::decide_facing_filtered : Task::decide_facing_each;
    if (points.footprints != nullptr) return Task::decide_facing_footprints;
    const bool is_picture = points.layout.point_stride == 1 && points.layout.picture_width != 0;
    return session.is_cpu() && is_directional && is_picture && opens_points ? Task::decide_facing_picture
                                                                            : Task::decide_facing_cached;
}

Task prepared_trace_task(const cl::Session& session, const PointInputs& points, bool is_directional) {
    const bool in_rows = points.layout.point_stride == 1;
    if (session.is_cpu() && is_directional && in_rows && share_facing(points))
        return Task::trace_prepared_cached_facing;
    if (!session.is_cpu() && points.layout.is_lifted != 0) return Task::trace_prepared_plane_side;
    return Task::trace_prepared;
}

}  // namespace gnomon
