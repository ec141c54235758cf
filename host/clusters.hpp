// SPDX-License-Identifier: MIT
// Stage clusters: which clusters of a kept mesh can matter to a projection (kernels/clusters.h).
#pragma once

#include "inputs.hpp"

namespace gnomon {

/// Boxes around the clusters of a mesh, kept by Triangles::keep_clusters().
class Clusters {
public:
    Clusters(const Device& device, const TriangleInputs& triangles);

    cl_uint count() const { return count_; }
    const cl::Buffer& boxes() const { return boxes_; }

private:
    Device device_;  ///< lives as long as the boxes
    cl_uint count_;
    cl::Buffer boxes_;
};

class ClusterCull {
public:
    /// Lists the clusters that can matter, for triangle_setup, and counts them and the triangles of all others in
    /// `counters`; null if no clusters are kept. `pyramid` (farthest_height) may be null: then nothing is dropped for
    /// being too far.
    const cl::Buffer* run(cl::Session& session, const cl::Buffer& projection, const TriangleInputs& triangles,
                          const cl::Buffer* pyramid, const cl::Buffer& counters);

private:
    cl::Buffer listed_;
};

}  // namespace gnomon
