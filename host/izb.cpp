// SPDX-License-Identifier: MIT
#include "izb.hpp"

#include <algorithm>

namespace gnomon {

void Izb::run(cl::Session& session, const LightFrame& frame, const TriangleInputs& triangles, const PointInputs& points,
              const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility, const cl::Buffer& counters) {
    const cl_uint bin_count = frame.bins_x * frame.bins_y;
    const std::size_t bin_bytes = bin_count * sizeof(cl_uint);
    // Each bin's list is padded to a multiple of the lanes, and no more bins than points can need padding.
    const std::size_t padding = (session.lanes() - 1) * std::min<std::size_t>(bin_count, points.layout.count);
    const std::size_t slots = (points.layout.count + padding + 15) / 16 * 16;
    for (cl::Buffer* buffer : {&x_, &y_, &z_, &order_}) buffer->reserve(session, slots * sizeof(cl_uint));
    block_bin_.reserve(session, slots / session.lanes() * sizeof(cl_uint));
    cursors_.reserve(session, bin_bytes);
    farthest_.reserve(session, bin_bytes);
    offsets_.reserve(session, bin_bytes + sizeof(cl_uint));

    session.fill(cursors_, 0, bin_bytes);
    session.fill(farthest_, 0xFFFFFFFFu, bin_bytes);
    const cl_uint has_map = map != nullptr;
    session.launch("izb.cl", "izb_count", cl::Range::items(points.layout.count), frame, points.layout, projection,
                   has_map, triangles.first_float, triangles.count, points.positions, points.receivers,
                   triangles.vertices, map != nullptr ? *map : cursors_, visibility, cursors_, farthest_, counters);
    scan_.run(session, bin_count, session.lanes(), cursors_, offsets_);
    session.fill(cursors_, 0, bin_bytes);
    if (session.lanes() > 1) session.fill(order_, GN_NO_ID, slots * sizeof(cl_uint));
    session.launch("izb.cl", "izb_scatter", cl::Range::items(points.layout.count), frame, points.layout, projection,
                   points.positions, visibility, offsets_, cursors_, x_, y_, z_, order_, block_bin_);
}

}  // namespace gnomon
