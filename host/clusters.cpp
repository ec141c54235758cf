// SPDX-License-Identifier: MIT
#include "clusters.hpp"

#include "../kernels/clusters.h"

namespace gnomon {

namespace {

std::size_t round_up(std::size_t count, std::size_t multiple) { return (count + multiple - 1) / multiple * multiple; }

}  // namespace

Clusters::Clusters(const Device& device, const TriangleInputs& triangles)
    : device_(device), count_(round_up(triangles.count, CLUSTER_TRIANGLES) / CLUSTER_TRIANGLES) {
    cl::Session& session = device_.session();
    boxes_.reserve(session, round_up(count_, session.lanes()) * CLUSTER_BOX_BYTES);
    if (count_ == 0) return;
    session.launch("clusters.cl", "make_clusters", cl::Range::items(round_up(count_, session.lanes())), triangles.count,
                   triangles.first_float, count_, triangles.vertices, boxes_);
}

const cl::Buffer* ClusterCull::run(cl::Session& session, const cl::Buffer& projection, const TriangleInputs& triangles,
                                   const cl::Buffer* pyramid, const cl::Buffer& counters) {
    if (triangles.clusters == nullptr) return nullptr;
    const Clusters& clusters = *triangles.clusters;
    listed_.reserve(session, clusters.count() * sizeof(cl_uint));
    const cl_uint has_pyramid = pyramid != nullptr;
    session.launch("clusters.cl", "cull_clusters", cl::Range::items(clusters.count() / session.lanes() + 1), projection,
                   triangles.count, clusters.count(), has_pyramid, clusters.boxes(), pyramid ? *pyramid : listed_,
                   listed_, counters);
    return &listed_;
}

void Triangles::keep_clusters(const Device& device) {
    clusters_ = std::make_shared<const Clusters>(device, triangle_inputs(*this));
}

}  // namespace gnomon
