// SPDX-License-Identifier: MIT
#include "receivers/receiver_depth_pyramid.hpp"

#include <vector>

#include "api/variants.hpp"

namespace gnomon {

namespace {

struct Level {
    cl_uint width, height, first;
};

// The levels of a pyramid over the bins, and (one more) the place past the last.
std::vector<Level> pyramid_levels(const LightFrame& light_frame, cl_uint frame_count) {
    std::vector<Level> levels{{light_frame.bins_x, light_frame.bins_y, 0}};
    for (;;) {
        const auto [w, h, first] = levels.back();
        levels.push_back({(w + 1) / 2, (h + 1) / 2, first + frame_count * w * h});
        if (w == 1 && h == 1) return levels;
    }
}

void reduce(cl::Session& session, const std::vector<Level>& levels, cl_uint frame_count, const cl::Buffer& pyramid) {
    for (std::size_t from = 0; from + 2 < levels.size(); from += PYRAMID_LEVELS) {
        const auto [width, height, first] = levels[from];
        const auto squares = [](std::size_t last_cell) { return (last_cell >> PYRAMID_LEVELS) + 1; };
        session.launch("receivers/receiver_depth_pyramid.cl", "receiver_depth_pyramid_reduce",
                       cl::Range::groups(frame_count * squares(width - 1) * squares(height - 1)), frame_count, width,
                       height, first, pyramid);
    }
}

}  // namespace

void ReceiverDepthPyramid::run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame,
                               cl_uint frame_count, const PointInputs& points, const cl::Buffer& projections,
                               const cl::Buffer* blocks, cl_mem visibility) {
    const std::vector<Level> levels = pyramid_levels(light_frame, frame_count);
    const std::size_t bin_bytes = std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y * sizeof(cl_uint);
    pyramid_.reserve(session, levels.back().first * sizeof(cl_uint));
    self_shadow_depths_.reserve(session, bin_bytes);
    session.fill({{pyramid_, 0xFFFFFFFFu, bin_bytes}, {self_shadow_depths_, 0xFFFFFFFFu, bin_bytes}});
    session.launch(variant(session, Task::make_receiver_depths, light_frame.perspective == 0),
                   cl::Range::items(points.layout.count / session.lanes() + 1), light_frame, first_frame, frame_count,
                   points.layout, projections, cl_uint(points.footprints != nullptr), cl_uint(blocks != nullptr),
                   points.positions, points.footprints != nullptr ? points.footprints : points.positions,
                   blocks != nullptr ? *blocks : projections, visibility, pyramid_, self_shadow_depths_);
    reduce(session, levels, frame_count, pyramid_);
}

void ReceiverDepthPyramid::fill_for_points_anywhere(cl::Session& session, const LightFrame& light_frame,
                                                    cl_uint frame_count) {
    constexpr cl_uint key_of_minus_infinity = 0x007FFFFFu;
    const std::size_t bytes = pyramid_levels(light_frame, frame_count).back().first * sizeof(cl_uint);
    const std::size_t bin_bytes = std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y * sizeof(cl_uint);
    pyramid_.reserve(session, bytes);
    self_shadow_depths_.reserve(session, bin_bytes);
    session.fill({{pyramid_, key_of_minus_infinity, bytes}, {self_shadow_depths_, 0xFFFFFFFFu, bin_bytes}});
}

void ReceiverDepthPyramid::run_depth_after_map(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                                               const cl::Buffer& projections, const cl::Buffer* map) {
    knows_map_ = map != nullptr;
    if (!knows_map_) return;
    const std::size_t bins = std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y;
    const std::vector<Level> levels = pyramid_levels(light_frame, frame_count);
    depth_after_map_.reserve(session, levels.back().first * sizeof(cl_uint));
    session.launch("receivers/receiver_depth_pyramid.cl", "depth_after_map", cl::Range::items(bins), frame_count,
                   projections, *map, pyramid_, self_shadow_depths_, depth_after_map_);
    reduce(session, levels, frame_count, depth_after_map_);
}

}  // namespace gnomon
