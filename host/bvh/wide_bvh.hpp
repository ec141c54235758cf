// SPDX-License-Identifier: MIT
// Stage wide_bvh: the BVH over the triangles, in which beams and packets find their occluders (kernels/bvh/wide_bvh.h).
// A binary tree by parallel locally ordered clustering (Meister and Bittner 2018) is collapsed to wide nodes.
#pragma once

#include <algorithm>

#include "bvh/binary_tree.hpp"
#include "kernels/bvh/wide_bvh.h"

namespace gnomon {

/// The most work-groups of a launch that walks a BVH on a GPU.
inline constexpr std::size_t most_bvh_groups = 65536;

class WideBvh {
public:
    /// Builds the BVH over at least one triangle.
    WideBvh(const Device& device, const Triangles& triangles);

    const Triangles& triangles() const { return triangles_; }

    const cl::Buffer& leaves() const { return leaves_; }
    const cl::Buffer& nodes() const { return nodes_; }
    const cl::Buffer& ids() const { return ids_; }
    /// The first node of each level, from the root down, and the number of all nodes.
    const std::vector<std::uint32_t>& levels() const { return levels_; }
    std::uint32_t leaf_count() const { return leaf_count_; }
    /// The most work-groups that may walk the tree: over an implicit raster each has a slot among the leaves.
    std::size_t max_groups() const { return max_groups_; }
    /// The largest magnitude of a coordinate. Above BVH_MAX_COORDINATE there is no BVH.
    float largest_coordinate() const { return largest_coordinate_; }

private:
    struct Made {
        std::uint32_t nodes, leaves, levels;
    };
    void build_over(const ImplicitRaster& raster);  ///< raster_bvh.cpp
    bool build(const TriangleInputs& triangles, const TriangleCurve& curve, bool is_balanced);
    Made make_nodes(WideBvhParams params, const TriangleCurve& curve, const BinaryTree& binary,
                    const cl::Buffer& leaf_roots);
    void make_leaves(WideBvhParams params, std::uint32_t leaves, const TriangleCurve& curve, const BinaryTree& binary,
                     const cl::Buffer& leaf_roots);

    Device device_;
    Triangles triangles_;  ///< its clusters, if it has some, live as long as the tree
    cl::Buffer leaves_, nodes_, ids_;
    std::vector<std::uint32_t> levels_{0, 1};
    std::uint32_t leaf_count_ = 0;
    std::size_t max_groups_ = most_bvh_groups;
    float largest_coordinate_ = 0;
};

/// The number of points in a block, and of children in a node, on this device.
inline std::uint32_t bvh_width(const cl::Session& session) {
    return session.is_cpu() ? BVH_WIDTH_ON_CPU : BVH_WIDTH_ON_GPU;
}
/// The range of a kernel that runs BEAM_FOR_EACH over `tasks`, whose lengths differ: work-items on a CPU, groups on a
/// GPU.
inline cl::Range bvh_range(const cl::Session& session, std::size_t tasks, std::size_t max_groups = most_bvh_groups) {
    return session.is_cpu() ? cl::Range::shares(tasks)
                            : cl::Range::groups_of(bvh_width(session), std::min(tasks, max_groups));
}

}  // namespace gnomon
