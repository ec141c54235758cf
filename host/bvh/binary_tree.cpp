// SPDX-License-Identifier: MIT
#include "bvh/binary_tree.hpp"

#include "lists/scan.hpp"
#include "lists/sort.hpp"
#include "occluders/clusters.hpp"

namespace gnomon {
namespace {

// A round that joins less than this share of its clusters is followed by a forced round. Nested boxes, each a little
// larger than the one in it, would else take a round each.
constexpr std::uint32_t slow_round = 16;

// The least mean number of triangles of the largest small nodes, which become leaves.
constexpr std::uint32_t fewest_triangles_of_leaf = 4;

constexpr const char* file = "bvh/binary_tree.cl";

}  // namespace

std::uint32_t most_leaves(std::uint32_t triangles) { return triangles / fewest_triangles_of_leaf + 64; }

TriangleCurve::TriangleCurve(cl::Session& session, const TriangleInputs& triangles) {
    const TrianglesLayout& layout = triangles;
    const auto box = box_of_triangles(session, triangles);
    if (!box) return;
    count_ = box->finite;
    largest_coordinate_ = box->largest();
    cl::Buffer codes(session, layout.count * sizeof(cl_uint));
    numbers_.reserve(session, layout.count * sizeof(cl_uint));
    session.launch(
        "occluders/clusters.cl", "cluster_codes", cl::Range::items(layout.count), morton_grid(*box, MORTON_BITS),
        ClusterParams{.triangles = layout, .cluster_count = 0, .has_pyramid = 0}, triangles.vertices, codes, numbers_);
    Sort().run(session, layout.count, codes, numbers_);
}

BinaryTree::BinaryTree(cl::Session& session, const TriangleInputs& triangles, const TriangleCurve& curve,
                       std::uint32_t width, bool is_balanced) {
    BinaryTreeParams params{.triangles = triangles,
                            .count = curve.count(),
                            .stride = curve.count() + 2 * TREE_REACH,
                            .is_forced = is_balanced ? 1u : 0u,
                            .slot_capacity = most_leaves(curve.count())};
    const std::size_t words = params.count * sizeof(cl_uint);
    nodes_.reserve(session, params.count * sizeof(BinaryNode));
    cost_slots_.reserve(session, words);
    costs_.reserve(session, params.slot_capacity * width * sizeof(cl_float));
    cl::Buffer used_slots(session, sizeof(cl_uint));
    session.fill(used_slots.get(), 0, sizeof(cl_uint));
    cl::Buffer clusters(session, std::size_t(params.stride) * TREE_ROWS * sizeof(float));
    cl::Buffer joined(session, clusters.bytes()), nearest(session, words), kept(session, words);
    cl::Buffer slots(session, words + sizeof(cl_uint));
    session.launch(file, "tree_leaves", cl::Range::items(params.count), params, triangles.vertices, curve.numbers(),
                   clusters);
    Scan scan;
    while (params.count > 1) {
        const cl::Range each = cl::Range::items(params.count);
        session.launch(file, "tree_nearest", each, params, clusters, nearest);
        session.launch(file, "tree_kept", each, params, nearest, kept);
        scan.run(session, params.count, kept, slots);
        session.launch(file, "tree_join", each, params, clusters, nearest, slots, joined, nodes_, cost_slots_, costs_,
                       used_slots);
        std::uint32_t left = 0;
        session.read(slots.get(), &left, sizeof(left), params.count * sizeof(cl_uint));
        params.is_forced = is_balanced || params.count - left < params.count / slow_round ? 1u : 0u;
        params.count = left;
        std::swap(clusters, joined);
    }
    const std::size_t row = std::size_t(params.stride) * TREE_BOX_ROWS + TREE_REACH;
    session.read(clusters.get(), &root_, sizeof(root_), row * sizeof(cl_uint));
    has_costs_ = session.read_value<cl_uint>(used_slots) < params.slot_capacity;
}

}  // namespace gnomon
