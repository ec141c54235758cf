// SPDX-License-Identifier: MIT
// Stage binary_tree: a binary tree over the finite triangles of a scene (kernels/bvh/binary_tree.h).
#pragma once

#include "kernels/bvh/binary_tree.h"
#include "lists/morton.hpp"
#include "query/inputs.hpp"

namespace gnomon {

/// The finite triangles of a scene along a Morton curve.
class TriangleCurve {
public:
    TriangleCurve(cl::Session& session, const TriangleInputs& triangles);

    std::uint32_t count() const { return count_; }
    const cl::Buffer& numbers() const { return numbers_; }
    /// The largest magnitude of a coordinate; 0 if there is no finite triangle.
    float largest_coordinate() const { return largest_coordinate_; }

private:
    cl::Buffer numbers_;
    std::uint32_t count_ = 0;
    float largest_coordinate_ = 0;
};

/// More leaves than these would take too much memory: 576 bytes each on a CPU, however few triangles they have.
std::uint32_t most_leaves(std::uint32_t triangles);

class BinaryTree {
public:
    /// Builds the tree over at least one triangle, and the costs of wide nodes of `width` children. `is_balanced`:
    /// neighbours along the curve are joined whatever their boxes are, which fills the leaves.
    BinaryTree(cl::Session& session, const TriangleInputs& triangles, const TriangleCurve& curve, std::uint32_t width,
               bool is_balanced);

    /// A node, or TREE_TRIANGLE.
    std::uint32_t root() const { return root_; }
    const cl::Buffer& nodes() const { return nodes_; }
    const cl::Buffer& cost_slots() const { return cost_slots_; }
    const cl::Buffer& costs() const { return costs_; }
    /// False: there would be more leaves than most_leaves().
    bool has_costs() const { return has_costs_; }

private:
    cl::Buffer nodes_, cost_slots_, costs_;
    std::uint32_t root_ = 0;
    bool has_costs_ = false;
};

}  // namespace gnomon
