// SPDX-License-Identifier: MIT
#include "techniques/izb.hpp"

#include <algorithm>

namespace gnomon {

void Izb::run(cl::Session& session, const LightFrame& light_frame, cl_uint frame, const PointInputs& points,
              const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility, const cl::Buffer& counters) {
    const cl_uint bin_count = light_frame.bins_x * light_frame.bins_y;
    const std::size_t bin_bytes = bin_count * sizeof(cl_uint);
    // Each bin's list is padded to a multiple of the lanes, and no more bins than points can need padding.
    const std::size_t padding = (session.lanes() - 1) * std::min<std::size_t>(bin_count, points.layout.count);
    const std::size_t slots = (points.layout.count + padding + 15) / 16 * 16;
    for (cl::Buffer* buffer : {&x_, &y_, &z_, &order_}) buffer->reserve(session, slots * sizeof(cl_uint));
    cursors_.reserve(session, bin_bytes);
    offsets_.reserve(session, bin_bytes + sizeof(cl_uint));

    session.fill(cursors_, 0, bin_bytes);
    const cl_uint has_map = map != nullptr;
    const auto blocks = cl::Range::items(points.layout.count / session.lanes() + 1);
    session.launch("techniques/izb.cl", "izb_count", blocks, light_frame, frame, points.layout, projection, has_map,
                   points.positions, map != nullptr ? *map : cursors_, visibility, cursors_, counters);
    scan_.run(session, bin_count, session.lanes(), cursors_, offsets_);
    session.fill(cursors_, 0, bin_bytes);
    if (session.lanes() > 1) session.fill(order_, GN_NO_ID, slots * sizeof(cl_uint));
    session.launch("techniques/izb.cl", "izb_scatter", blocks, light_frame, frame, points.layout, projection,
                   points.positions, visibility, offsets_, cursors_, x_, y_, z_, order_, counters);
}

}  // namespace gnomon
