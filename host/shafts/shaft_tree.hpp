// SPDX-License-Identifier: MIT
// Stage shaft_tree: the tree over the triangles through which shafts find their occluders (kernels/shafts/shaft.h).
#pragma once

#include <algorithm>

#include "kernels/shafts/shaft.h"
#include "shafts/binary_tree.hpp"

namespace gnomon {

class BuiltShaftTree {
public:
    /// Of at least one triangle.
    BuiltShaftTree(const Device& device, const Triangles& triangles);

    const Triangles& triangles() const { return triangles_; }

    const cl::Buffer& leaves() const { return leaves_; }
    const cl::Buffer& nodes() const { return nodes_; }
    const cl::Buffer& ids() const { return ids_; }
    /// The first node of each level, from the root down, and the number of all nodes.
    const std::vector<std::uint32_t>& levels() const { return levels_; }
    std::uint32_t leaf_count() const { return leaf_count_; }
    /// The largest magnitude of a coordinate. There is no tree if it exceeds SHAFT_LARGEST_COORDINATE.
    float largest_coordinate() const { return largest_coordinate_; }

private:
    struct Made {
        std::uint32_t nodes, leaves, levels;
    };
    bool build(const TriangleInputs& triangles, const TriangleCurve& curve, bool is_balanced);
    Made make_nodes(ShaftTreeParams params, const TriangleCurve& curve, const BinaryTree& binary,
                    const cl::Buffer& leaf_roots);
    void make_leaves(ShaftTreeParams params, std::uint32_t leaves, const TriangleCurve& curve, const BinaryTree& binary,
                     const cl::Buffer& leaf_roots);

    Device device_;
    Triangles triangles_;  ///< its clusters, if it has some, live as long as the tree
    cl::Buffer leaves_, nodes_, ids_;
    std::vector<std::uint32_t> levels_{0, 1};
    std::uint32_t leaf_count_ = 0;
    float largest_coordinate_ = 0;
};

/// The number of a block's points, and of a node's children, on this device.
inline std::uint32_t shaft_width(const cl::Session& session) {
    return session.is_cpu() ? SHAFT_WIDTH_ON_CPU : SHAFT_WIDTH_ON_GPU;
}
/// For SHAFT_FOR_EACH over `tasks` of unlike length: work-items on a CPU, groups on a GPU.
inline cl::Range shaft_range(const cl::Session& session, std::size_t tasks) {
    constexpr std::size_t most_groups = 65536;
    return session.is_cpu() ? session.uneven_items(tasks, 1)
                            : cl::Range::groups_of(shaft_width(session), std::min(tasks, most_groups));
}

}  // namespace gnomon
