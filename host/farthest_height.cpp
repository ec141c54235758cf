// SPDX-License-Identifier: MIT
#include "farthest_height.hpp"

namespace gnomon {

void FarthestHeight::run(cl::Session& session, const LightFrame& frame, const PointInputs& points,
                         const cl::Buffer& projection, cl_mem visibility) {
    std::size_t cells = 0;
    for (cl_uint w = frame.bins_x, h = frame.bins_y;; w = (w + 1) / 2, h = (h + 1) / 2) {
        cells += std::size_t(w) * h;
        if (w == 1 && h == 1) break;
    }
    pyramid_.reserve(session, cells * sizeof(cl_uint));
    session.fill(pyramid_, 0xFFFFFFFFu, cells * sizeof(cl_uint));
    session.launch("farthest_height.cl", "farthest_height", cl::Range::items(points.layout.count), frame, points.layout,
                   projection, points.positions, visibility, pyramid_);
    cl_uint first = 0;
    for (cl_uint w = frame.bins_x, h = frame.bins_y; w > 1 || h > 1; w = (w + 1) / 2, h = (h + 1) / 2) {
        session.launch("farthest_height.cl", "farthest_height_reduce",
                       cl::Range::items(std::size_t((w + 1) / 2) * ((h + 1) / 2)), w, h, first, pyramid_);
        first += w * h;
    }
}

}  // namespace gnomon
