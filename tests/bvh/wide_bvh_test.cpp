// SPDX-License-Identifier: MIT
// The tree of beams holds each finite triangle once, in boxes that contain it, and is low enough for the kernels'
// stacks, whatever the triangles are like.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "bvh/wide_bvh.hpp"
#include "support/device.hpp"
#include "support/tree_scenes.hpp"

namespace {

using namespace support;

struct Box {
    Float3 low, high;
    double half_area() const {
        const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x * y + y * z + z * x;
    }
    bool contains(const float* vertex) const {
        for (std::size_t c = 0; c < 3; ++c)
            if (!(low[c] <= vertex[c] && vertex[c] <= high[c])) return false;
        return true;
    }
};

/// The tree as the kernels read it.
class ReadTree {
public:
    ReadTree(const gnomon::Device& device, const gnomon::WideBvh& tree, const Floats& triangles)
        : width_(gnomon::bvh_width(gnomon::session_of(device))), triangles_(triangles) {
        gnomon::cl::Session& session = gnomon::session_of(device);
        nodes_ = session.read_values<float>(tree.nodes().get(), tree.nodes().bytes() / sizeof(float));
        ids_ = session.read_values<std::uint32_t>(tree.ids().get(), tree.ids().bytes() / sizeof(std::uint32_t));
        leaves_ = session.read_values<float>(tree.leaves().get(), tree.leaves().bytes() / sizeof(float));
        walk_node(0, {}, 1);
    }

    std::multiset<std::uint32_t> found;
    std::size_t levels = 0, leaves = 0;
    double areas = 0;  ///< half the sum of all nodes' and leaves' areas, but for the root's

private:
    void walk_node(std::uint32_t node, std::vector<Box> around, std::size_t level) {
        levels = std::max(levels, level);
        ASSERT_LT(level, 64u);
        for (std::uint32_t k = 0; k < width_; ++k) {
            const float* at = &nodes_.at((std::size_t(node) * BVH_NODE_ROWS) * width_ + k);
            const Box box{{at[0], at[width_], at[2 * width_]}, {at[3 * width_], at[4 * width_], at[5 * width_]}};
            if (!(box.low[0] <= box.high[0])) continue;  // absent
            std::uint32_t code = 0;
            std::memcpy(&code, &at[6 * width_], sizeof(code));
            around.push_back(box);
            areas += box.half_area();
            if ((code & BVH_LEAF) != 0)
                read_leaf(code & ~BVH_LEAF, around);
            else
                walk_node(code, around, level + 1);
            around.pop_back();
            if (testing::Test::HasFailure()) return;
        }
    }

    void read_leaf(std::uint32_t leaf, const std::vector<Box>& around) {
        ++leaves;
        for (std::uint32_t k = 0; k < width_; ++k) {
            const float* row = &leaves_.at((std::size_t(leaf) * BVH_LEAF_ROWS) * width_ + k);
            if (std::isnan(row[0])) continue;  // absent
            const std::uint32_t id = ids_.at(std::size_t(leaf) * width_ + k);
            found.insert(id);
            for (std::uint32_t corner = 0; corner < 3; ++corner) {
                const float vertex[3] = {row[3 * corner * width_], row[(3 * corner + 1) * width_],
                                         row[(3 * corner + 2) * width_]};
                EXPECT_EQ(std::memcmp(vertex, &triangles_.at(9 * std::size_t(id) + 3 * corner), sizeof(vertex)), 0);
                for (const Box& box : around) EXPECT_TRUE(box.contains(vertex)) << "triangle " << id;
            }
        }
    }

    std::uint32_t width_;
    const Floats& triangles_;
    std::vector<float> nodes_, leaves_;
    std::vector<std::uint32_t> ids_;
};

TEST(WideBvh, HoldsEachFiniteTriangleOnceAndIsLow) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        const std::uint32_t width = gnomon::bvh_width(gnomon::session_of(device));
        for (const TreeScene& one : tree_scenes()) {
            SCOPED_TRACE(one.name + (gpu_kernels ? ", kernels for GPUs" : ""));
            const gnomon::WideBvh tree(device, gnomon::Triangles::upload(device, one.triangles));
            const ReadTree read(device, tree, one.triangles);
            if (HasFailure()) return;
            const auto finite = finite_triangles(one.triangles);
            EXPECT_EQ(read.found, (std::multiset<std::uint32_t>(finite.begin(), finite.end())));
            EXPECT_LE(read.levels * (width - 1) + 2, MAX_STACK_ENTRIES);
            EXPECT_LE(read.leaves, finite.size() / 4 + 64);
        }
    }
}

/// The cost of the whole binary tree, without the root's area.
double least_areas(const gnomon::Device& device, const Floats& vertices) {
    gnomon::cl::Session& session = gnomon::session_of(device);
    const auto triangles = gnomon::Triangles::upload(device, vertices);
    const gnomon::TriangleInputs inputs = gnomon::triangle_inputs(triangles);
    const gnomon::TriangleCurve curve(session, inputs);
    const std::uint32_t width = gnomon::bvh_width(session);
    const gnomon::BinaryTree tree(session, inputs, curve, width, false);
    const auto node = downloaded<gnomon::BinaryNode>(session, tree.nodes().get(), curve.count()).at(tree.root());
    const auto slot = downloaded<std::uint32_t>(session, tree.cost_slots().get(), curve.count()).at(tree.root());
    const auto costs = downloaded<float>(session, tree.costs().get(), tree.costs().bytes() / sizeof(float));
    const Box box{{node.low[0], node.low[1], node.low[2]}, {node.high[0], node.high[1], node.high[2]}};
    return double(costs.at((slot - TREE_FIRST_SLOT(width)) * width)) - box.half_area();
}

TEST(WideBvh, IsTheCutOfLeastAreas) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        for (const std::uint32_t count : {40u, 700u, 20'000u}) {
            const Floats triangles = strewn_triangles(count, 3, 7);
            const ReadTree read(device, gnomon::WideBvh(device, gnomon::Triangles::upload(device, triangles)),
                                triangles);
            const double least = least_areas(device, triangles);
            EXPECT_NEAR(read.areas, least, 1e-4 * least) << count << " triangles";
        }
    }
}

TEST(WideBvh, IsNotMadeForCoordinatesOutOfTheFiltersRange) {
    const gnomon::Device device = device_with();
    Floats triangles = strewn_triangles(20, 3, 7);
    triangles[5] = 0x1p20f;
    const gnomon::WideBvh tree(device, gnomon::Triangles::upload(device, triangles));
    EXPECT_EQ(tree.largest_coordinate(), 0x1p20f);
    EXPECT_EQ(tree.nodes().get(), nullptr);
}

}  // namespace
