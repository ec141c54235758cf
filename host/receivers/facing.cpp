// SPDX-License-Identifier: MIT
#include "receivers/facing.hpp"

#include "api/variants.hpp"
#include "kernels/receivers/block_bounds.h"

namespace gnomon {
namespace {

// Of a picture, under a direction: what a CPU has a kernel of its own for.
bool is_picture_directional(const cl::Session& session, const LightFrame& light_frame, cl_uint opens,
                            const PointsLayout& layout, const cl::Buffer* blocks) {
    return session.lanes() > 1 && opens == FACING_BOUNDS && blocks != nullptr && light_frame.perspective == 0 &&
           layout.point_stride == 1 && layout.has_receivers == 1 && layout.picture_width != 0;
}

// What `opens` has no use for may be any buffer. `answers`: where points look their receivers up; null: receivers are
// asked point by point. `blocks`: to be written; null: they are not. `unsure`: to ask by floats first, with room for
// those who have to be asked again; null: all are asked at once.
void launch(cl::Session& session, const LightFrame& light_frame, cl_uint opens, const TriangleInputs& triangles,
            const PointInputs& points, const cl::Buffer* answers, cl_mem visibility, const cl::Buffer& frame_bounds,
            const cl::Buffer* blocks, const cl::Buffer* undecided, const cl::Buffer& counters) {
    PointsLayout layout = points.layout;
    if (points.face_light) layout.has_receivers = 0;
    const auto launch_one = [&](Task task, cl::Range range) {
        session.launch(
            variant(session, task, light_frame.perspective == 0), range, layout, light_frame, opens,
            cl_uint(points.footprints != nullptr), cl_uint(blocks != nullptr), triangles.first_float, triangles.count,
            points.positions, points.footprints != nullptr ? points.footprints : points.positions, points.receivers,
            triangles.vertices, answers != nullptr ? answers->get() : points.receivers, visibility, frame_bounds,
            blocks != nullptr ? *blocks : frame_bounds, undecided != nullptr ? *undecided : frame_bounds, counters,
            cl::LocalBytes{frame_count_of(light_frame) * sizeof(PointBounds)});
    };
    const Task looked_up = points.footprints != nullptr ? Task::decide_facing_footprints
                           : is_picture_directional(session, light_frame, opens, layout, blocks)
                               ? Task::decide_facing_picture
                               : Task::decide_facing_cached;
    // A frame's margins hang on the world bounds of what an item takes together, so that their last bits (never an
    // answer) hang on the number of items: of the device's on a GPU, whatever the size of work-groups; of cores and of
    // that size on a CPU. (Groups of 12 points for each item took 31 us in place of 37 on an H200.)
    launch_one(answers != nullptr     ? looked_up
               : undecided != nullptr ? Task::decide_facing_filtered
                                      : Task::decide_facing_each,
               cl::Range::items(layout.count / session.lanes() + 1));
    if (answers == nullptr && undecided != nullptr)
        launch_one(Task::decide_facing_exactly, cl::Range::groups(session.compute_units() * 4));
}

}  // namespace

bool Facing::can_cache(const PointInputs& points) {
    const bool has_doubts = points.layout.is_lifted == 0 && points.footprints == nullptr;
    return points.layout.has_receivers != 0 && !points.face_light && !has_doubts;
}

const cl::Buffer& Facing::empty_facing_cache(cl::Session& session, const TriangleInputs& triangles) {
    const std::size_t bytes = (triangles.count / session.lanes() + 1) * sizeof(cl_uint);
    answers_.reserve(session, bytes);
    session.fill(answers_, 0, bytes);
    return answers_;
}

const cl::Buffer* Facing::make_answers(cl::Session& session, const LightFrame& light_frame,
                                       const TriangleInputs& triangles, const PointInputs& points,
                                       const cl::Buffer& counters) {
    if (!can_cache(points)) return nullptr;
    if (session.is_cpu()) return &empty_facing_cache(session, triangles);
    // All triangles are read in order, points' receivers from anywhere: with as many points as triangles both ways take
    // the same time.
    if (points.layout.count / 2 < triangles.count) return nullptr;
    const std::size_t bytes = triangles.count + 1;
    answers_.reserve(session, bytes);
    session.launch(variant(session, Task::decide_facing_triangles, light_frame.perspective == 0),
                   cl::Range::items(bytes), points.layout, light_frame, triangles.first_float, triangles.count,
                   triangles.vertices, answers_, counters);
    return &answers_;
}

void Facing::run(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                 const PointInputs& points, cl_mem visibility, const cl::Buffer& counters) {
    const std::size_t bytes = frame_count_of(light_frame) * sizeof(PointBounds);
    frame_bounds_.reserve(session, bytes);
    const bool asks_floats = !session.is_cpu() && can_cache(points) && points.footprints == nullptr;
    undecided_.reserve(session, asks_floats ? (1 + UNDECIDED_CAPACITY) * sizeof(cl_uint) : 0);
    session.fill({{frame_bounds_, 0, bytes},
                  {counters, 0, sizeof(FrameCounters)},
                  {undecided_, 0, asks_floats ? sizeof(cl_uint) : 0}});
    const cl::Buffer* answers = make_answers(session, light_frame, triangles, points, counters);
    has_blocks_ = session.lanes() > 1 && points.footprints == nullptr;
    if (has_blocks_) blocks_.reserve(session, (points.layout.count / session.lanes() + 1) * sizeof(BlockBounds));
    launch(session, light_frame, triangles.count != 0 ? FACING_BOUNDS : FACING_DECIDES, triangles, points, answers,
           visibility, frame_bounds_, blocks(), asks_floats ? &undecided_ : nullptr, counters);
}

FrameCounters run_facing(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles,
                         const PointInputs& points, const Light& light, cl_mem visibility, cl::Buffer& counters) {
    if (points.layout.count == 0) return {};
    {
        cl::StageTimer timer(session, statistics, "facing");
        counters.reserve(session, sizeof(FrameCounters));
        session.fill(counters, 0, sizeof(FrameCounters));
        // No bounds are taken of points that are not opened.
        launch(session, make_light_frame(light, {1, 0}), FACING_DECIDES, triangles, points, nullptr, visibility,
               counters, nullptr, nullptr, counters);
    }
    return session.read_value<FrameCounters>(counters);
}

}  // namespace gnomon
