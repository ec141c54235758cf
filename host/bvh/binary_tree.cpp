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

constexpr const char* file = "bvh/binary_tree.cl";

}  // namespace

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
                            .width = width};
    const std::size_t words = params.count * sizeof(cl_uint);
    nodes_.reserve(session, params.count * sizeof(BinaryNode));
    ranks_.reserve(session, words);
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
        session.launch(file, "tree_join", each, params, clusters, nearest, slots, joined, nodes_, ranks_);
        std::uint32_t left = 0;
        session.read(slots.get(), &left, sizeof(left), params.count * sizeof(cl_uint));
        params.is_forced = is_balanced || params.count - left < params.count / slow_round ? 1u : 0u;
        params.count = left;
        std::swap(clusters, joined);
    }
    const std::size_t row = std::size_t(params.stride) * TREE_BOX_ROWS + TREE_REACH;
    session.read(clusters.get(), &root_, sizeof(root_), row * sizeof(cl_uint));
}

}  // namespace gnomon
