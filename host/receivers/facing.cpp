// SPDX-License-Identifier: MIT
#include "receivers/facing.hpp"

#include "kernels/receivers/block_bounds.h"
#include "query/variants.hpp"

namespace gnomon {
namespace {

struct FacingBuffers {
    cl_mem visibility;
    const cl::Buffer& frame_bounds;
    const cl::Buffer& counters;
    const cl::Buffer* cache = nullptr;      ///< null: every point classifies its receiver
    const cl::Buffer* blocks = nullptr;     ///< null: not written
    const cl::Buffer* undecided = nullptr;  ///< null: there is no float filter
};

FacingParams facing_params(const LightFrame& light_frame, const TriangleInputs& triangles, const PointInputs& points,
                           bool opens_points, bool has_blocks) {
    return {.triangles = triangles,
            .light_frame = light_frame,
            .layout = points.layout,
            .has_receivers = points.layout.has_receivers != 0 && !points.face_light,
            .has_footprints = points.footprints != nullptr,
            .has_blocks = has_blocks,
            .opens_points = opens_points};
}

void launch(cl::Session& session, Task task, cl::Range range, const FacingParams& params,
            const TriangleInputs& triangles, const PointInputs& points, const FacingBuffers& buffers) {
    const auto or_any = [&](const cl::Buffer* buffer) -> const cl::Buffer& {  // for arguments that are not used
        return buffer != nullptr ? *buffer : buffers.frame_bounds;
    };
    session.launch(variant(session, task, params.light_frame.perspective == 0), range, params, points.positions,
                   points.footprints != nullptr ? points.footprints : points.positions, points.receivers,
                   triangles.vertices, or_any(buffers.cache), buffers.visibility, or_any(buffers.blocks),
                   or_any(buffers.undecided), buffers.frame_bounds, buffers.counters,
                   cl::LocalBytes{frame_count_of(params.light_frame) * sizeof(PointBounds)});
}

void face_points(cl::Session& session, const FacingParams& params, const TriangleInputs& triangles,
                 const PointInputs& points, const FacingBuffers& buffers) {
    const Task task = facing_task(session, points, params.light_frame.perspective == 0, buffers.cache != nullptr,
                                  buffers.undecided != nullptr, params.opens_points != 0);
    // On a GPU the margins of frames depend on how points are grouped per work-item, in last bits that change no
    // answer. The number of items is the device's, whatever the size of work-groups.
    launch(session, task, session.block_shares(params.layout.count), params, triangles, points, buffers);
    if (task == Task::decide_facing_filtered)
        launch(session, Task::decide_facing_exactly, cl::Range::groups(session.compute_units() * 4), params, triangles,
               points, buffers);
}

}  // namespace

cl::Fill FacingStage::empty_cache(cl::Session& session, const TriangleInputs& triangles) {
    const std::size_t bytes = (triangles.count / session.lanes() + 1) * sizeof(cl_uint);
    cache_.reserve(session, bytes);
    return {cache_, 0, bytes};
}

const cl::Buffer* FacingStage::make_cache(cl::Session& session, const FacingParams& params,
                                          const TriangleInputs& triangles, const PointInputs& points,
                                          const cl::Buffer& counters) {
    if (!share_facing(points)) return nullptr;
    if (session.is_cpu()) return &cache_;
    // The kernel reads all triangles in order, but points' receivers from anywhere: with as many points as triangles
    // both ways take the same time.
    if (points.layout.count / 2 < triangles.count) return nullptr;
    const std::size_t bytes = triangles.count + 1;
    cache_.reserve(session, bytes);
    session.launch(variant(session, Task::decide_facing_triangles, params.light_frame.perspective == 0),
                   cl::Range::items(bytes), params, triangles.vertices, cache_, counters);
    return &cache_;
}

void FacingStage::run(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                      const PointInputs& points, cl_mem visibility, const cl::Buffer& counters, bool opens_points) {
    opens_points = opens_points && triangles.count != 0;
    const std::size_t bytes = frame_count_of(light_frame) * sizeof(PointBounds);
    frame_bounds_.reserve(session, bytes);
    const bool filters = !session.is_cpu() && share_facing(points) && points.footprints == nullptr;
    undecided_.reserve(session, filters ? (1 + UNDECIDED_CAPACITY) * sizeof(cl_uint) : 0);
    const bool caches = session.is_cpu() && share_facing(points);
    session.fill({{frame_bounds_, 0, bytes},
                  {counters, 0, sizeof(FrameCounters)},
                  {undecided_, 0, filters ? sizeof(cl_uint) : 0},
                  caches ? empty_cache(session, triangles) : cl::Fill{frame_bounds_, 0, 0}});
    has_blocks_ = opens_points && session.lanes() > 1 && points.footprints == nullptr;
    const FacingParams params = facing_params(light_frame, triangles, points, opens_points, has_blocks_);
    const cl::Buffer* cache = make_cache(session, params, triangles, points, counters);
    if (has_blocks_) blocks_.reserve(session, (points.layout.count / session.lanes() + 1) * sizeof(BlockBounds));
    face_points(session, params, triangles, points,
                {visibility, frame_bounds_, counters, cache, blocks(), filters ? &undecided_ : nullptr});
}

FrameCounters FacingStage::run_alone(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles,
                                     const PointInputs& points, const Light& light, cl_mem visibility,
                                     cl::Buffer& counters) {
    if (points.layout.count == 0) return {};
    cl::StageTimer timer(session, statistics, "facing");
    counters.reserve(session, sizeof(FrameCounters));
    run(session, make_light_frame(light, {1, 0}), triangles, points, visibility, counters, false);
    timer.next(nullptr);
    return session.read_value<FrameCounters>(counters);
}

}  // namespace gnomon
