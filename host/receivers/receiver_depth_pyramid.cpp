// SPDX-License-Identifier: MIT
#include "receivers/receiver_depth_pyramid.hpp"

#include <vector>

#include "kernels/receivers/receiver_depth_pyramid.h"
#include "query/variants.hpp"

namespace gnomon {

namespace {

// The levels of a pyramid over the bins; the last element only has the index past the last level.
std::vector<PyramidLevel> pyramid_levels(const LightFrame& light_frame, cl_uint frame_count) {
    std::vector<PyramidLevel> levels{{frame_count, light_frame.bins_x, light_frame.bins_y, 0}};
    for (;;) {
        const PyramidLevel below = levels.back();
        levels.push_back({frame_count, (below.width + 1) / 2, (below.height + 1) / 2,
                          below.first + frame_count * below.width * below.height});
        if (below.width == 1 && below.height == 1) return levels;
    }
}

// On a CPU the kernel that makes the bins makes the levels above them, too.
void reduce(cl::Session& session, const std::vector<PyramidLevel>& levels, const cl::Buffer& pyramid) {
    if (session.is_cpu()) return;
    for (std::size_t from = 0; from + 2 < levels.size(); from += PYRAMID_LEVELS) {
        const auto squares = [](std::size_t last_cell) { return (last_cell >> PYRAMID_LEVELS) + 1; };
        const PyramidLevel& level = levels[from];
        session.launch("receivers/receiver_depth_pyramid.cl", "receiver_depth_pyramid_reduce",
                       cl::Range::groups(level.frame_count * squares(level.width - 1) * squares(level.height - 1)),
                       level, pyramid);
    }
}

std::size_t bin_count(const LightFrame& light_frame, cl_uint frame_count) {
    return std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y;
}

constexpr cl_uint key_of_minus_infinity = 0x007FFFFFu, key_of_no_point = 0xFFFFFFFFu;

}  // namespace

void ReceiverDepthPyramid::fill(cl::Session& session, std::size_t bins, std::size_t cells, std::size_t filled_cells,
                                cl_uint key) {
    pyramid_.reserve(session, cells * sizeof(cl_uint));
    self_shadow_depths_.reserve(session, bins * sizeof(cl_uint));
    session.fill({{pyramid_, key, filled_cells * sizeof(cl_uint)},
                  {self_shadow_depths_, key_of_no_point, bins * sizeof(cl_uint)}});
}

void ReceiverDepthPyramid::run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame,
                               cl_uint frame_count, const PointInputs& points, const cl::Buffer& projections,
                               const cl::Buffer* blocks, cl_mem visibility) {
    const std::vector<PyramidLevel> levels = pyramid_levels(light_frame, frame_count);
    const std::size_t bins = bin_count(light_frame, frame_count);
    fill(session, bins, levels.back().first, bins, key_of_no_point);
    const ReceiverDepthParams params{.light_frame = light_frame,
                                     .layout = points.layout,
                                     .first_frame = first_frame,
                                     .frame_count = frame_count,
                                     .has_footprints = points.footprints != nullptr,
                                     .has_blocks = blocks != nullptr};
    session.launch(variant(session, Task::make_receiver_depths, light_frame.perspective == 0),
                   session.block_shares(points.layout.count), params, projections, points.positions,
                   points.footprints != nullptr ? points.footprints : points.positions,
                   blocks != nullptr ? *blocks : projections, visibility, pyramid_, self_shadow_depths_);
    reduce(session, levels, pyramid_);
}

void ReceiverDepthPyramid::fill_for_points_anywhere(cl::Session& session, const LightFrame& light_frame,
                                                    cl_uint frame_count) {
    const std::size_t cells = pyramid_levels(light_frame, frame_count).back().first;
    fill(session, bin_count(light_frame, frame_count), cells, cells, key_of_minus_infinity);
}

void ReceiverDepthPyramid::run_depth_after_map(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                                               const cl::Buffer& projections, const cl::Buffer* map) {
    has_map_ = map != nullptr;
    if (!has_map_) return;
    const std::vector<PyramidLevel> levels = pyramid_levels(light_frame, frame_count);
    depth_after_map_.reserve(session, levels.back().first * sizeof(cl_uint));
    session.launch("receivers/receiver_depth_pyramid.cl", "depth_after_map",
                   cl::Range::shares(bin_count(light_frame, frame_count)), frame_count, projections, *map, pyramid_,
                   self_shadow_depths_, depth_after_map_);
    reduce(session, levels, depth_after_map_);
}

}  // namespace gnomon
