// SPDX-License-Identifier: MIT
#include "occluders/clusters.hpp"

#include <algorithm>

#include "kernels/exact/cut_outs.h"
#include "lists/morton.hpp"
#include "lists/sort.hpp"
#include "query/variants.hpp"

namespace gnomon {

namespace {

std::size_t round_up(std::size_t count, std::size_t multiple) { return (count + multiple - 1) / multiple * multiple; }

// Half the surface area; 0 if the box is empty.
double area_of(const CoordinateBounds& box) {
    const glm::dvec3 size = box.size();
    return box.is_empty() ? 0 : size.x * size.y + size.y * size.z + size.z * size.x;
}

// An order of the clusters' own takes 40 bytes per triangle. It is worth that where clusters are scattered: where a
// line that meets the scene meets this many boxes on average, and the order along a curve leaves at most this share of
// them: foliage of 1.3 million triangles, made in disorder, 1148 -> 3.8; lost_empire, 106 -> 17.6, gains no time.
constexpr double boxes_worth_order = 256, max_area_worth_order = 0.25;

// The box around all boxes, and the sum of the areas of the boxes.
struct Spread {
    CoordinateBounds whole{};
    double area = 0;
    // The average number of boxes on a line, over all lines that meet the whole: the boxes' share of its area.
    double boxes_met() const { return area_of(whole) > 0 ? area / area_of(whole) : 0; }
};

Spread spread_of(cl::Session& session, const cl::Buffer& boxes, cl_uint count) {
    const std::size_t lanes = session.lanes(), words = CLUSTER_BOX_BYTES / sizeof(float);
    const auto kept = session.read_values<float>(boxes.get(), round_up(count, lanes) * words);
    Spread spread;
    for (std::size_t i = 0; i < count; ++i) {
        const auto corner = [&](std::size_t row) {
            const float* at = &kept[(i / lanes * words + row) * lanes + i % lanes];
            return glm::dvec3(at[0], at[lanes], at[2 * lanes]);
        };
        const CoordinateBounds box{corner(0), corner(3)};
        spread.whole.add(box);
        spread.area += area_of(box);
    }
    return spread;
}

ClusterParams params_of(const TriangleInputs& triangles, cl_uint cluster_count, bool has_pyramid = false) {
    return {.triangles = triangles, .cluster_count = cluster_count, .has_pyramid = has_pyramid};
}

TriangleInputs in_order(TriangleInputs triangles, const cl::Buffer& vertices) {
    triangles.first_float = 0;
    triangles.vertices = vertices.get();
    return triangles;
}

void make_boxes(cl::Session& session, const TriangleInputs& triangles, cl_uint count, const cl::Buffer& boxes) {
    session.launch("occluders/clusters.cl", "make_clusters", cl::Range::items(round_up(count, session.lanes())),
                   params_of(triangles, count), triangles.vertices, boxes);
}

}  // namespace

Clusters::Clusters(const Device& device, const TriangleInputs& triangles)
    : device_(device), count_(round_up(triangles.count, CLUSTER_TRIANGLES) / CLUSTER_TRIANGLES) {
    cl::Session& session = session_of(device_);
    boxes_.reserve(session, round_up(count_, session.lanes()) * CLUSTER_BOX_BYTES);
    if (count_ == 0) return;
    make_boxes(session, triangles, count_, boxes_);
    const Spread spread = spread_of(session, boxes_, count_);
    if (spread.boxes_met() < boxes_worth_order) return;
    try {
        reorder(triangles, morton_grid(spread.whole, MORTON_BITS), spread.area);
    } catch (const OutOfDeviceMemory&) {
        // The order of the caller's buffer takes no memory and gives the same result.
    }
}

void Clusters::reorder(const TriangleInputs& triangles, const MortonGrid& grid, double area) {
    cl::Session& session = session_of(device_);
    const std::size_t word_bytes = triangles.count * sizeof(cl_uint);
    cl::Buffer codes(session, word_bytes), numbers(session, word_bytes);
    session.launch("occluders/clusters.cl", "cluster_codes", cl::Range::items(triangles.count), grid,
                   params_of(triangles, count_), triangles.vertices, codes, numbers);
    Sort().run(session, triangles.count, codes, numbers);
    const std::size_t class_bytes = triangles.has_cut_outs ? CUT_OUT_CLASS_WORDS(triangles.count) * sizeof(cl_uint) : 0;
    cl::Buffer vertices(session, 9 * word_bytes + class_bytes), boxes(session, boxes_.bytes());
    session.launch(triangles.kernel("occluders/clusters.cl", "cluster_gather"), cl::Range::items(triangles.count),
                   params_of(triangles, count_), triangles.vertices, numbers, vertices);
    make_boxes(session, in_order(triangles, vertices), count_, boxes);
    if (spread_of(session, boxes, count_).area > area * max_area_worth_order) return;
    boxes_ = std::move(boxes);
    vertices_ = std::move(vertices);
    numbers_ = std::move(numbers);
}

OrderedTriangles ordered_triangles(const TriangleInputs& triangles) {
    if (triangles.clusters == nullptr || !triangles.clusters->is_reordered()) return {triangles, nullptr};
    return {in_order(triangles, triangles.clusters->vertices()), &triangles.clusters->numbers()};
}

const cl::Buffer* ClusterCull::run(cl::Session& session, const ProjectionInput& projection,
                                   const TriangleInputs& triangles, const cl::Buffer* pyramid,
                                   const cl::Buffer& counters) {
    if (triangles.clusters == nullptr) return nullptr;
    const Clusters& clusters = *triangles.clusters;
    listed_.reserve(session, clusters.count() * sizeof(cl_uint));
    session.launch(variant(session, Task::cull_clusters, projection.is_directional), session.blocks(clusters.count()),
                   params_of(triangles, clusters.count(), pyramid != nullptr), projection.buffer, clusters.boxes(),
                   pyramid ? *pyramid : listed_, listed_, counters);
    return &listed_;
}

void Triangles::keep_clusters(const Device& device) {
    clusters_ = std::make_shared<const Clusters>(device, triangle_inputs(*this));
}

std::optional<TriangleBox> box_of_triangles(cl::Session& session, const TriangleInputs& triangles) {
    const TrianglesLayout& layout = triangles;
    const cl::Buffer bounds(session, TRIANGLE_BOX_WORDS * sizeof(cl_uint));
    const cl_uint none[TRIANGLE_BOX_WORDS] = {GN_NO_ID, GN_NO_ID, GN_NO_ID, 0, 0, 0, 0};
    session.write(bounds.get(), none, sizeof(none));
    session.launch("occluders/clusters.cl", "triangle_box", cl::Range::items(layout.count), layout, triangles.vertices,
                   bounds);
    const auto found = session.read_values<cl_uint>(bounds.get(), TRIANGLE_BOX_WORDS);
    const auto box = bounds_of_keys(found);
    if (!box) return {};
    return TriangleBox{*box, found[6]};
}

}  // namespace gnomon
