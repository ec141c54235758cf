// SPDX-License-Identifier: MIT
#include "bvh/wide_bvh.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace gnomon {
WideBvh::WideBvh(const Device& device, const Triangles& given) : device_(device), triangles_(given) {
    if (const ImplicitRaster* raster = Internals::raster(given)) {
        build_over(*raster);
        return;
    }
    const TriangleInputs triangles = triangle_inputs(given);
    cl::Session& session = session_of(device_);
    const TriangleCurve curve(session, triangles);
    largest_coordinate_ = curve.largest_coordinate();
    if (!(largest_coordinate_ <= BVH_MAX_COORDINATE)) return;
    if (!build(triangles, curve, false)) build(triangles, curve, true);
}

// Returns false if the tree is too high for the kernels' stacks, or its leaves are too small. A balanced tree is
// neither: it has at most 24 levels for 2^28 triangles, and full leaves.
bool WideBvh::build(const TriangleInputs& triangles, const TriangleCurve& curve, bool is_balanced) {
    cl::Session& session = session_of(device_);
    const std::uint32_t width = bvh_width(session);
    if (curve.count() == 0) {
        // One node of absent children.
        constexpr float infinite = std::numeric_limits<float>::infinity();
        std::vector<float> node(BVH_NODE_ROWS * width, 0.0f);
        std::fill_n(node.begin(), 3 * width, infinite);
        std::fill_n(node.begin() + 3 * width, 3 * width, -infinite);
        session.upload(nodes_, node);
        leaves_.reserve(session, 0);
        ids_.reserve(session, 0);
        return true;
    }
    const BinaryTree binary(session, triangles, curve, width, is_balanced);
    if (!is_balanced && !binary.has_costs()) return false;
    WideBvhParams params{};
    params.triangles = triangles;
    params.node_capacity = curve.count() / 64 + 64;
    params.leaf_capacity = most_leaves(curve.count());
    const std::uint32_t max_levels = (MAX_STACK_ENTRIES - 2) / (width - 1);
    cl::Buffer leaf_roots(session, params.leaf_capacity * sizeof(cl_uint));
    for (;;) {
        const Made made = make_nodes(params, curve, binary, leaf_roots);
        if (!is_balanced && made.levels > max_levels) return false;
        if (made.nodes <= params.node_capacity) {
            leaf_count_ = made.leaves;
            make_leaves(params, made.leaves, curve, binary, leaf_roots);
            return true;
        }
        params.node_capacity = std::max(params.node_capacity, made.nodes) * 2;
    }
}

// Makes the nodes level by level, until a level has no nodes or the buffer has no room for them.
WideBvh::Made WideBvh::make_nodes(WideBvhParams params, const TriangleCurve& curve, const BinaryTree& binary,
                                  const cl::Buffer& leaf_roots) {
    cl::Session& session = session_of(device_);
    const TriangleInputs triangles = triangle_inputs(triangles_);
    nodes_.reserve(session, params.node_capacity * std::size_t(BVH_NODE_ROWS * bvh_width(session)) * sizeof(float));
    cl::Buffer node_roots(session, params.node_capacity * sizeof(cl_uint));
    cl::Buffer counters(session, sizeof(WideBvhCounters));
    const std::uint32_t root = binary.root();
    session.write(node_roots.get(), &root, sizeof(root));
    WideBvhCounters counted{.nodes = 1, .leaves = 0};
    session.write(counters.get(), &counted, sizeof(counted));
    Made made{1, 0, 0};
    levels_ = {0, 1};
    while (params.first < made.nodes && made.nodes <= params.node_capacity) {
        params.count = made.nodes - params.first;
        session.launch("bvh/wide_bvh.cl", "bvh_nodes", cl::Range::items(params.count), params, triangles.vertices,
                       curve.numbers(), binary.nodes(), binary.costs(), binary.cost_slots(), nodes_, node_roots,
                       leaf_roots, counters);
        counted = session.read_value<WideBvhCounters>(counters);
        params.first = made.nodes;
        made = {counted.nodes, counted.leaves, made.levels + 1};
        if (made.nodes != params.first) levels_.push_back(made.nodes);
    }
    return made;
}

void WideBvh::make_leaves(WideBvhParams params, std::uint32_t leaves, const TriangleCurve& curve,
                          const BinaryTree& binary, const cl::Buffer& leaf_roots) {
    cl::Session& session = session_of(device_);
    const TriangleInputs triangles = triangle_inputs(triangles_);
    const std::size_t slots = std::size_t(leaves) * bvh_width(session);
    leaves_.reserve(session, slots * BVH_LEAF_ROWS * sizeof(float));
    ids_.reserve(session, slots * sizeof(cl_uint));
    params.count = leaves;
    session.launch(triangles.kernel("bvh/wide_bvh.cl", "bvh_leaves"), cl::Range::items(leaves), params,
                   triangles.vertices, curve.numbers(), binary.nodes(), leaf_roots, leaves_, ids_);
}

}  // namespace gnomon
