// SPDX-License-Identifier: MIT
#include "trace.hpp"

#include <algorithm>

namespace gnomon {

void Trace::run(cl::Session& session, const LightFrame& frame, const PointInputs& points, const Izb& izb,
                const Bins& bins, const TriangleSetup& setup, cl_mem visibility, const cl::Buffer& counters) {
    if (capacity_ == 0) {
        const std::uint32_t wanted = std::max(std::min(first_capacity_, points.layout.count), 1u);
        queue_.reserve(session, std::size_t(wanted) * 2 * sizeof(cl_uint));
        capacity_ = wanted;
    }
    const cl_uint bin_count = frame.bins_x * frame.bins_y;
    session.launch("trace.cl", "trace", cl::Range::items(points.layout.count / session.lanes() + 1), bin_count,
                   capacity_, points.layout.has_receivers, points.receivers, izb.x(), izb.y(), izb.z(), izb.order(),
                   izb.block_bin(), izb.offsets(), bins.offsets(), bins.references(), setup.records(), setup.bounds(),
                   visibility, queue_, counters);
}

bool Trace::fitted(cl::Session& session, const FrameCounters& counted) {
    if (counted.uncertain <= capacity_) return true;
    capacity_ = 0;
    const std::size_t wanted =
        std::min<std::size_t>(counted.uncertain + std::size_t(counted.uncertain) / 4, 0xFFFFFFFEu);
    queue_.reserve(session, wanted * 2 * sizeof(cl_uint));
    capacity_ = static_cast<std::uint32_t>(wanted);
    return false;
}

}  // namespace gnomon
