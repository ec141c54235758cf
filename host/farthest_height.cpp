// SPDX-License-Identifier: MIT
#include "farthest_height.hpp"

#include <vector>

namespace gnomon {

void FarthestHeight::run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
                         const PointInputs& points, const cl::Buffer& projections, cl_mem visibility) {
    struct Level {
        cl_uint width, height, first;
    };
    std::vector<Level> levels;
    cl_uint cells = 0;
    for (cl_uint w = light_frame.bins_x, h = light_frame.bins_y;; w = (w + 1) / 2, h = (h + 1) / 2) {
        levels.push_back({w, h, cells});
        cells += frame_count * w * h;
        if (w == 1 && h == 1) break;
    }
    const std::size_t bin_bytes = std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y * sizeof(cl_uint);
    pyramid_.reserve(session, cells * sizeof(cl_uint));
    doubtful_.reserve(session, bin_bytes);
    session.fill(pyramid_, 0xFFFFFFFFu, bin_bytes);
    session.fill(doubtful_, 0xFFFFFFFFu, bin_bytes);
    session.launch("farthest_height.cl", "farthest_height", cl::Range::items(points.layout.count / session.lanes() + 1),
                   light_frame, first_frame, frame_count, points.layout, projections, points.positions, visibility,
                   pyramid_, doubtful_);
    for (std::size_t from = 0; from + 1 < levels.size(); from += PYRAMID_LEVELS) {
        const auto [width, height, first] = levels[from];
        const auto squares = [](std::size_t last_cell) { return (last_cell >> PYRAMID_LEVELS) + 1; };
        session.launch("farthest_height.cl", "farthest_height_reduce",
                       cl::Range::groups(frame_count * squares(width - 1) * squares(height - 1)), frame_count, width,
                       height, first, pyramid_);
    }
}

void FarthestHeight::run_open_heights(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                                      const cl::Buffer& projections, const cl::Buffer* map) {
    const std::size_t bins = std::size_t(frame_count) * light_frame.bins_x * light_frame.bins_y;
    open_heights_.reserve(session, bins * sizeof(cl_uint));
    const cl_uint has_map = map != nullptr;
    session.launch("farthest_height.cl", "open_heights", cl::Range::items(bins), frame_count, projections, has_map,
                   map != nullptr ? *map : pyramid_, pyramid_, doubtful_, open_heights_);
}

}  // namespace gnomon
