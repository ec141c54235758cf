// SPDX-License-Identifier: MIT
// Stage clusters: the clusters of a kept mesh, and their cull for a projection (kernels/occluders/clusters.h).
#pragma once

#include "kernels/occluders/clusters.h"
#include "lists/morton.hpp"
#include "query/inputs.hpp"

namespace gnomon {

/// Clusters of a mesh, kept by Triangles::keep_clusters(). Their order is the order of the caller's buffer; where
/// neighbours in the buffer are not neighbours in space, it is an order along a space-filling curve.
class Clusters {
public:
    Clusters(const Device& device, const TriangleInputs& triangles);

    cl_uint count() const { return count_; }
    const cl::Buffer& boxes() const { return boxes_; }
    bool is_reordered() const { return numbers_.get() != nullptr; }
    /// Where reordered: a copy of the vertices in the clusters' order, and the number of the triangle at each position.
    const cl::Buffer& vertices() const { return vertices_; }
    const cl::Buffer& numbers() const { return numbers_; }

private:
    void reorder(const TriangleInputs& triangles, const MortonGrid& grid, double area);

    Device device_;  ///< lives as long as the boxes
    cl_uint count_;
    cl::Buffer boxes_, vertices_, numbers_;
};

/// The box around all finite triangles, and their number; no value if there is none.
struct TriangleBox : CoordinateBounds {
    std::uint32_t finite;
};
std::optional<TriangleBox> box_of_triangles(cl::Session& session, const TriangleInputs& triangles);

/// The triangles in the order of the clusters; `numbers` is null if a triangle's position is its number.
struct OrderedTriangles : TriangleInputs {
    const cl::Buffer* numbers;
};
OrderedTriangles ordered_triangles(const TriangleInputs& triangles);

class ClusterCull {
public:
    /// Lists the clusters that survive the cull, for triangle_setup; counts in `counters` these clusters and the
    /// triangles of all other clusters. Null if no clusters are kept. `pyramid` (receiver_depth_pyramid) may be null:
    /// then the depth drops no cluster.
    const cl::Buffer* run(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                          const cl::Buffer* pyramid, const cl::Buffer& counters);

private:
    cl::Buffer listed_;
};

}  // namespace gnomon
