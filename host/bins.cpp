// SPDX-License-Identifier: MIT
#include "bins.hpp"

#include <algorithm>

namespace gnomon {
void Bins::pass(cl::Session& session, const cl::Buffer& projection, const TriangleSetup& setup,
                const cl::Buffer* farthest, const cl::Buffer& counters, std::uint32_t fill) {
    const cl_uint has_heights = farthest != nullptr;
    const cl::Buffer& heights = farthest != nullptr ? *farthest : cursors_;
    session.launch("bins.cl", "bins_small", cl::Range::items(setup.capacity()), projection, setup.capacity(),
                   has_heights, fill, capacity_, setup.records(), setup.record_bins(), heights, offsets_, cursors_,
                   references_, counters);
    session.launch("bins.cl", "bins_large", session.small_groups(), projection, setup.capacity(), has_heights, fill,
                   capacity_, setup.records(), setup.record_bins(), setup.large(), heights, offsets_, cursors_,
                   references_, counters);
    session.launch("bins.cl", "bins_huge", session.few_groups(), projection, setup.capacity(), has_heights, fill,
                   capacity_, setup.records(), setup.record_bins(), setup.large(), heights, offsets_, cursors_,
                   references_, counters);
}

void Bins::run(cl::Session& session, const cl::Buffer& projection, std::uint32_t bin_count, const TriangleSetup& setup,
               const cl::Buffer* farthest, const cl::Buffer& counters) {
    const std::size_t cursor_bytes = bin_count * sizeof(cl_uint);
    cursors_.reserve(session, cursor_bytes);
    offsets_.reserve(session, cursor_bytes + sizeof(cl_uint));
    if (capacity_ == 0) {
        references_.reserve(session, std::size_t(first_capacity_) * sizeof(cl_uint));
        capacity_ = first_capacity_;
    }
    session.fill(cursors_, 0, cursor_bytes);
    pass(session, projection, setup, farthest, counters, 0);
    scan_.run(session, bin_count, 1, cursors_, offsets_);
    session.launch("bins.cl", "bins_total", cl::Range::items(1), bin_count, offsets_, counters);
    session.fill(cursors_, 0, cursor_bytes);
    pass(session, projection, setup, farthest, counters, 1);
}

void Bins::grow(cl::Session& session, std::uint64_t wanted) {
    capacity_ = 0;  // stays so if the next line throws
    wanted = std::min<std::uint64_t>(wanted, 0xFFFFFFFEu);
    references_.reserve(session, wanted * sizeof(cl_uint));
    capacity_ = static_cast<std::uint32_t>(wanted);
}

bool Bins::fitted(cl::Session& session, const FrameCounters& counted, bool records_fitted) {
    if (counted.references == 0xFFFFFFFFu)
        throw OutOfDeviceMemory("listing more than 2^32 (triangle, bin) pairs", CL_MEM_OBJECT_ALLOCATION_FAILURE,
                                "set a smaller map-size");
    const std::uint64_t likely = records_fitted ? 0 : 2 * std::uint64_t(counted.survivors);
    const std::uint64_t needed = std::max<std::uint64_t>(counted.references, likely);
    if (needed <= capacity_) return true;
    // A quarter more than asked, so that a slowly changing scene does not grow every frame.
    grow(session, needed + needed / 4);
    return false;
}

}  // namespace gnomon
