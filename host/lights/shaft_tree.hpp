// SPDX-License-Identifier: MIT
// Stage shaft_tree: the tree over the triangles through which shafts find their occluders (kernels/lights/shaft.h).
#pragma once

#include "api/inputs.hpp"
#include "kernels/lights/shaft.h"

namespace gnomon {

class BuiltShaftTree {
public:
    /// Of at least one triangle.
    BuiltShaftTree(const Device& device, const Triangles& triangles);

    const Triangles& triangles() const { return triangles_; }

    const ShaftTree& layout() const { return layout_; }
    const cl::Buffer& leaves() const { return leaves_; }
    const cl::Buffer& nodes() const { return nodes_; }
    const cl::Buffer& ids() const { return ids_; }
    /// The largest magnitude of a coordinate.
    float largest_coordinate() const { return largest_coordinate_; }

private:
    void build(const TriangleInputs& triangles, const cl::Buffer& numbers);
    void sort(const TriangleInputs& triangles, cl::Buffer& numbers);

    Device device_;
    Triangles triangles_;  ///< its clusters, if it has some, live as long as the tree
    std::uint32_t width_;
    ShaftTree layout_{};
    cl::Buffer leaves_, nodes_, ids_;
    float largest_coordinate_ = 0;
};

/// The number of a block's points, and of a node's children, on this device.
inline std::uint32_t shaft_width(const cl::Session& session) {
    return session.is_cpu() ? SHAFT_WIDTH_ON_CPU : SHAFT_WIDTH_ON_GPU;
}

}  // namespace gnomon
