// SPDX-License-Identifier: MIT
#include "triangle_setup.hpp"

#include <algorithm>

namespace gnomon {

void TriangleSetup::reserve(cl::Session& session, std::uint32_t capacity) {
    capacity = std::max(capacity, 1u);
    if (capacity <= capacity_) return;
    capacity_ = 0;  // stays so if one of these throws
    records_.reserve(session, std::size_t(capacity) * sizeof(TriangleRecord));
    ids_.reserve(session, std::size_t(capacity) * sizeof(cl_uint));
    record_bins_.reserve(session, std::size_t(capacity) * 4 * sizeof(cl_uint));
    large_.reserve(session, std::size_t(capacity) * sizeof(cl_uint));
    map_small_.reserve(session, std::size_t(capacity) * sizeof(cl_uint));
    capacity_ = capacity;
}

void TriangleSetup::run(cl::Session& session, const cl::Buffer& projection, const TriangleInputs& triangles,
                        const cl::Buffer* pyramid, const cl::Buffer& counters) {
    reserve(session, std::min(triangles.count, first_capacity_));
    const cl_uint has_pyramid = pyramid != nullptr;
    session.launch("triangle_setup.cl", "triangle_setup", cl::Range::items(triangles.count), projection,
                   triangles.count, triangles.first_float, capacity_, has_pyramid, triangles.vertices,
                   pyramid ? *pyramid : ids_, records_, ids_, record_bins_, large_, map_small_, counters);
}

bool TriangleSetup::fitted(cl::Session& session, const FrameCounters& counted) {
    if (counted.survivors <= capacity_) return true;
    reserve(session, counted.survivors);
    return false;
}

}  // namespace gnomon
