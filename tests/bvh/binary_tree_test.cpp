// SPDX-License-Identifier: MIT
// Stage binary_tree: the curve has each finite triangle once; the tree has each triangle of the curve as one leaf, in
// boxes that its children's boxes fill, with costs as their definition says; and each cluster joins the neighbour
// that its contract names.
#include "bvh/binary_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "support/device.hpp"
#include "support/tree_scenes.hpp"

namespace {

using namespace support;
using gnomon::BinaryNode;

struct Box {
    Float3 low, high;
    bool operator==(const Box&) const = default;
};

Box box_of_triangle(const Floats& triangles, std::uint32_t id) {
    Box box{vertex(triangles, 3 * std::size_t(id)), vertex(triangles, 3 * std::size_t(id))};
    for (std::size_t corner = 1; corner < 3; ++corner)
        for (std::size_t c = 0; c < 3; ++c) {
            const float x = triangles[9 * std::size_t(id) + 3 * corner + c];
            box.low[c] = std::min(box.low[c], x);
            box.high[c] = std::max(box.high[c], x);
        }
    return box;
}

Box around(const Box& a, const Box& b) {
    Box box;
    for (std::size_t c = 0; c < 3; ++c) {
        box.low[c] = std::min(a.low[c], b.low[c]);
        box.high[c] = std::max(a.high[c], b.high[c]);
    }
    return box;
}

float half_area(const Box& box) {
    const float x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
    return x * y + y * z + z * x;
}

/// A tree that was read, walked from its root.
struct ReadTree {
    std::vector<BinaryNode> nodes;
    std::vector<std::uint32_t> cost_slots, numbers;  ///< numbers: of the triangles along the curve
    std::vector<float> costs;
    const Floats& triangles;
    std::uint32_t width;
    bool has_costs;
    std::vector<std::uint32_t> times_met{};  ///< of each triangle along the curve
    std::size_t nodes_met = 0;
};

struct Below {
    Box box;
    std::size_t triangles, height;
};

/// The cost of a child for each room from 1 on, by its definition (kernels/bvh/tree_costs.clh).
std::vector<float> costs_of(const ReadTree& tree, std::uint32_t child, const Below& below) {
    if (below.triangles <= tree.width) return std::vector<float>(tree.width, half_area(below.box));
    const auto first = tree.costs.begin() + (tree.cost_slots.at(child) - TREE_FIRST_SLOT(tree.width)) * tree.width;
    return {first, first + tree.width};
}

void expect_least_costs(const std::vector<float>& found, const std::vector<float>& left,
                        const std::vector<float>& right, float area) {
    const auto of_both = [&](std::size_t room) {
        float least = std::numeric_limits<float>::infinity();
        for (std::size_t k = 1; k < room; ++k) least = std::min(least, left[k - 1] + right[room - k - 1]);
        return least;
    };
    const float alone = area + of_both(found.size());
    for (std::size_t room = 1; room <= found.size(); ++room)
        EXPECT_FLOAT_EQ(found[room - 1], std::min(alone, of_both(room))) << "room " << room;
}

Below expect_subtree(ReadTree& tree, std::uint32_t child) {
    if ((child & TREE_TRIANGLE) != 0) {
        const std::uint32_t along = child & ~TREE_TRIANGLE;
        ++tree.times_met.at(along);
        return {box_of_triangle(tree.triangles, tree.numbers.at(along)), 1, 0};
    }
    if (++tree.nodes_met >= tree.nodes.size()) {
        ADD_FAILURE() << "node " << child << " is met again";
        return {};
    }
    const BinaryNode& node = tree.nodes.at(child);
    const Below left = expect_subtree(tree, node.left), right = expect_subtree(tree, node.right);
    const Below all{around(left.box, right.box), left.triangles + right.triangles,
                    1 + std::max(left.height, right.height)};
    const Box stored{{node.low[0], node.low[1], node.low[2]}, {node.high[0], node.high[1], node.high[2]}};
    EXPECT_TRUE(stored == all.box) << "node " << child;
    if (all.triangles <= tree.width)
        EXPECT_EQ(tree.cost_slots.at(child), all.triangles) << "node " << child;
    else if (tree.has_costs)
        expect_least_costs(costs_of(tree, child, all), costs_of(tree, node.left, left),
                           costs_of(tree, node.right, right), half_area(all.box));
    return all;
}

void expect_tree(const gnomon::Device& device, const TreeScene& scene, std::uint32_t width, bool is_balanced) {
    gnomon::cl::Session& session = session_of(device);
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::TriangleInputs inputs = triangle_inputs(triangles);
    const gnomon::TriangleCurve curve(session, inputs);
    std::vector<std::uint32_t> numbers = downloaded<std::uint32_t>(session, curve.numbers().get(), curve.count());
    ASSERT_EQ(curve.count(), finite_triangles(scene.triangles).size());
    if (numbers.empty()) return;
    const gnomon::BinaryTree tree(session, inputs, curve, width, is_balanced);
    ReadTree read{downloaded<BinaryNode>(session, tree.nodes().get(), curve.count()),
                  downloaded<std::uint32_t>(session, tree.cost_slots().get(), curve.count()),
                  numbers,
                  downloaded<float>(session, tree.costs().get(), tree.costs().bytes() / sizeof(float)),
                  scene.triangles,
                  width,
                  tree.has_costs()};
    EXPECT_TRUE(tree.has_costs() || !is_balanced);
    std::ranges::sort(numbers);
    EXPECT_EQ(numbers, finite_triangles(scene.triangles));
    read.times_met.assign(curve.count(), 0);
    const Below all = expect_subtree(read, tree.root());
    EXPECT_EQ(all.triangles, curve.count());
    EXPECT_EQ(read.times_met, std::vector<std::uint32_t>(curve.count(), 1));
    EXPECT_EQ(read.nodes_met, curve.count() - 1);
    if (is_balanced) {
        EXPECT_EQ(all.height, std::size_t(std::bit_width(curve.count() - 1)));
    }
}

TEST(BinaryTree, HoldsEachFiniteTriangleOnceInFilledBoxes) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        for (const TreeScene& scene : tree_scenes())
            for (const bool is_balanced : {false, true}) {
                SCOPED_TRACE(scene.name + (gpu_kernels ? ", kernels for GPUs" : "") +
                             (is_balanced ? ", balanced" : ""));
                expect_tree(device, scene, gpu_kernels ? 32 : 16, is_balanced);
                if (HasFailure()) return;
            }
    }
}

// ---- Neighbours -----------------------------------------------------------------------------------------------------

/// Half the area of the box around two boxes, exact for small whole coordinates.
std::int64_t joined_area(const Box& a, const Box& b) {
    const Box box = around(a, b);
    std::int64_t size[3];
    for (std::size_t c = 0; c < 3; ++c) size[c] = std::int64_t(box.high[c]) - std::int64_t(box.low[c]);
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

/// The neighbour within reach with the least joined area; of equal ones the one whose index differs in the lowest bits.
std::uint32_t nearest_of(const std::vector<Box>& boxes, std::uint32_t i) {
    std::uint32_t chosen = i;
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::uint32_t other = i - std::min(i, TREE_REACH); other < boxes.size() && other <= i + TREE_REACH; ++other) {
        if (other == i) continue;
        const std::int64_t area = joined_area(boxes[i], boxes[other]);
        if (area > least || (area == least && (other ^ i) >= (chosen ^ i))) continue;
        least = area;
        chosen = other;
    }
    return chosen;
}

/// One box in three is that of a cluster a few places before it.
std::vector<Box> whole_boxes(std::uint32_t count, std::uint32_t extent, std::uint64_t seed) {
    Random random(seed);
    std::vector<Box> boxes(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            boxes[i].low[c] = float(random.below(extent));
            boxes[i].high[c] = boxes[i].low[c] + float(random.below(5));
        }
        if (random.below(3) == 0) boxes[i] = boxes[i - random.below(std::min(i, 5u) + 1)];
    }
    return boxes;
}

/// Rows of clusters (binary_tree.h). What stands before the first cluster and after the last is garbage.
std::vector<float> rows_of(const std::vector<Box>& boxes) {
    const std::size_t stride = boxes.size() + 2 * TREE_REACH;
    std::vector<float> rows(stride * TREE_ROWS, -1e9f);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            rows[c * stride + TREE_REACH + i] = boxes[i].low[c];
            rows[(3 + c) * stride + TREE_REACH + i] = boxes[i].high[c];
        }
    return rows;
}

TEST(BinaryTree, ClustersChooseTheNeighbourOfTheSmallestBox) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        gnomon::cl::Session& session = session_of(device);
        std::size_t ties = 0;
        for (const std::uint32_t count : {1u, 2u, 15u, 33u, 500u})
            for (const std::uint32_t extent : {1000u, 4u}) {
                SCOPED_TRACE(std::to_string(count) + " clusters within " + std::to_string(extent));
                const std::vector<Box> boxes = whole_boxes(count, extent, count + extent);
                gnomon::BinaryTreeParams params{};
                params.count = count;
                params.stride = count + 2 * TREE_REACH;
                const auto clusters = uploaded(session, rows_of(boxes));
                const gnomon::cl::Buffer nearest(session, (count + 1) * sizeof(std::uint32_t));
                put_canaries(session, nearest);
                session.launch("bvh/binary_tree.cl", "tree_nearest", gnomon::cl::Range::items(count), params, clusters,
                               nearest);
                const auto seen = downloaded<std::uint32_t>(session, nearest.get(), count);
                for (std::uint32_t i = 0; i < count; ++i) {
                    ASSERT_EQ(seen[i], nearest_of(boxes, i)) << "cluster " << i;
                    ties += seen[i] != i && boxes[seen[i]] == boxes[i];
                }
                expect_canaries(session, nearest, count * sizeof(std::uint32_t), "nearest");
            }
        EXPECT_GT(ties, 20u);  // boxes that are the same
    }
}

}  // namespace
