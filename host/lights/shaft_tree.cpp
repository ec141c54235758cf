// SPDX-License-Identifier: MIT
#include "lights/shaft_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/occluders/clusters.h"
#include "lists/morton.hpp"
#include "lists/sort.hpp"

namespace gnomon {
namespace {

std::uint32_t divided_up(std::uint32_t count, std::uint32_t by) { return count / by + (count % by != 0); }

ShaftTree layout_of(std::uint32_t triangles, std::uint32_t width) {
    ShaftTree tree{};
    tree.triangle_count = triangles;
    tree.leaf_count = divided_up(triangles, width);
    std::uint32_t nodes_of_level[MOST_SHAFT_LEVELS] = {}, nodes = tree.leaf_count;
    do {
        nodes = divided_up(nodes, width);
        nodes_of_level[tree.level_count++] = nodes;
    } while (nodes > 1);
    std::uint32_t first = 0;
    for (std::uint32_t level = tree.level_count; level-- > 0; first += nodes_of_level[level])
        tree.first_node[level] = first;
    return tree;
}

}  // namespace

BuiltShaftTree::BuiltShaftTree(const Device& device, const Triangles& given)
    : device_(device),
      triangles_(given),
      width_(shaft_width(session_of(device))),
      layout_(layout_of(static_cast<std::uint32_t>(given.count()), width_)) {
    const TriangleInputs triangles = triangle_inputs(given);
    cl::Session& session = session_of(device_);
    const std::size_t slots = std::size_t(layout_.leaf_count) * width_;
    const std::size_t nodes = layout_.first_node[0] + divided_up(layout_.leaf_count, width_);
    leaves_.reserve(session, slots * SHAFT_LEAF_ROWS * sizeof(float));
    nodes_.reserve(session, nodes * SHAFT_NODE_ROWS * width_ * sizeof(float));
    ids_.reserve(session, slots * sizeof(cl_uint));
    std::vector<cl_uint> identity(triangles.count);
    std::iota(identity.begin(), identity.end(), 0u);
    cl::Buffer numbers(session, triangles.count * sizeof(cl_uint));
    session.write(numbers.get(), identity.data(), identity.size() * sizeof(cl_uint));
    build(triangles, numbers);
    sort(triangles, numbers);
    build(triangles, numbers);
}

void BuiltShaftTree::build(const TriangleInputs& triangles, const cl::Buffer& numbers) {
    cl::Session& session = session_of(device_);
    const TrianglesLayout& layout = triangles;
    session.launch(triangles.kernel("lights/shaft_tree.cl", "shaft_leaves"),
                   cl::Range::items(std::size_t(layout_.leaf_count) * width_), layout_, layout, triangles.vertices,
                   numbers, leaves_, ids_);
    std::uint32_t boxes = layout_.leaf_count;
    for (std::uint32_t level = 0; level < layout_.level_count; ++level) {
        session.launch("lights/shaft_tree.cl", "shaft_boxes", cl::Range::items(boxes + width_), layout_, level, leaves_,
                       nodes_);
        boxes = divided_up(boxes, width_);
    }
}

// Orders the triangles along a curve through the box around all of them: the root of the tree so far.
void BuiltShaftTree::sort(const TriangleInputs& triangles, cl::Buffer& numbers) {
    cl::Session& session = session_of(device_);
    const auto root = session.read_values<float>(nodes_.get(), SHAFT_NODE_ROWS * width_);
    std::array<double, 3> low{}, high{};
    for (std::size_t c = 0; c < 3; ++c) {
        low[c] = *std::min_element(&root[c * width_], &root[c * width_] + width_);
        high[c] = *std::max_element(&root[(3 + c) * width_], &root[(3 + c) * width_] + width_);
        if (low[c] > high[c]) return;  // no finite triangle
        largest_coordinate_ = std::max(largest_coordinate_, float(std::max(std::abs(low[c]), std::abs(high[c]))));
    }
    const MortonGrid grid = morton_grid(low, high, MORTON_BITS);
    cl::Buffer codes(session, triangles.count * sizeof(cl_uint));
    session.launch("occluders/clusters.cl", "cluster_codes", cl::Range::items(triangles.count), grid,
                   ClusterParams{.triangles = triangles, .cluster_count = 0, .has_pyramid = 0}, triangles.vertices,
                   codes, numbers);
    Sort().run(session, triangles.count, codes, numbers);
}

}  // namespace gnomon
