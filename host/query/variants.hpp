// SPDX-License-Identifier: MIT
// The table of tasks for which the device and the light decide which kernel is right, and why (the table is in
// variants.cpp).
#pragma once

#include "query/inputs.hpp"

namespace gnomon {

/// The task of a kernel of a light's stages. Several kernels, or programs of one kernel, can do one task.
enum class Task {
    cull_clusters,
    decide_facing_cached,
    decide_facing_each,
    decide_facing_exactly,
    decide_facing_filtered,
    decide_facing_footprints,
    decide_facing_picture,
    decide_facing_triangles,
    make_receiver_depths,
    make_triangle_bounds,
    make_triangle_tiles,
    make_camera_tiles,
    trace,
    trace_prepared,
    trace_prepared_cached_facing,
    trace_prepared_plane_side,
    trace_queue_overflow,
};

/// The kernel for this task on this device. `is_directional`: every projection and light frame of the launch is
/// parallel.
/// `has_cut_outs`: of the launch's triangles.
cl::Kernel variant(const cl::Session& session, Task task, bool is_directional, bool has_cut_outs = false);

/// All points on a receiver have the same facing, and none may shadow itself.
bool share_facing(const PointInputs& points);

/// How facing is decided. `has_cache`: receivers' facing is cached. `filters`: a float filter runs first.
/// `opens_points`: points that are not backfacing become open.
Task facing_task(const cl::Session& session, const PointInputs& points, bool is_directional, bool has_cache,
                 bool filters, bool opens_points);

/// How a prepared light is traced for these points. A point that Task::trace_prepared_plane_side leaves as a fallback
/// point may still be decided by Task::trace_prepared.
Task prepared_trace_task(const cl::Session& session, const PointInputs& points, bool is_directional);

}  // namespace gnomon
