// SPDX-License-Identifier: MIT
// Builds the tree of bvh.hpp: binned surface-area heuristic, deterministic. Where it splits never changes an answer.
#include "bvh.hpp"

#include <algorithm>
#include <numeric>

namespace reference {
namespace {

constexpr std::uint32_t LEAF_TRIANGLES = 4;
constexpr int BINS = 16;

struct Box {
    Float3 low{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
               std::numeric_limits<float>::infinity()};
    Float3 high{-low[0], -low[1], -low[2]};

    void add(const Float3& p) {
        for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    }
    void add(const Box& box) {
        for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], box.low[i]), high[i] = std::max(high[i], box.high[i]);
    }
    double half_area() const {
        const double x = double(high[0]) - low[0], y = double(high[1]) - low[1], z = double(high[2]) - low[2];
        return x * y + y * z + z * x;
    }
    double doubled_centre(int axis) const { return double(low[axis]) + double(high[axis]); }
};

}  // namespace

struct Bvh::Builder {
    std::vector<Node>& nodes;
    const std::vector<Box>& boxes;
    std::vector<std::uint32_t>& order;  ///< indices of boxes, permuted so that every leaf is a range

    void build(std::uint32_t index, std::uint32_t first, std::uint32_t last, std::uint32_t depth) {
        Box box;
        for (std::uint32_t i = first; i < last; ++i) box.add(boxes[order[i]]);
        nodes[index] = {box.low, box.high, first, last - first};
        if (last - first <= LEAF_TRIANGLES) return;
        const std::uint32_t middle = split(first, last, depth);
        const auto left = static_cast<std::uint32_t>(nodes.size());
        nodes.resize(nodes.size() + 2);
        nodes[index].first = left;
        nodes[index].count = 0;
        build(left, first, middle, depth + 1);
        build(left + 1, middle, last, depth + 1);
    }

    /// Permutes the range and returns where its right half begins; both halves are not empty.
    std::uint32_t split(std::uint32_t first, std::uint32_t last, std::uint32_t depth) {
        int axis = 0;
        double low = 0, width = 0;
        for (int i = 0; i < 3; ++i) {
            double least = std::numeric_limits<double>::infinity(), most = -least;
            for (std::uint32_t k = first; k < last; ++k) {
                const double centre = boxes[order[k]].doubled_centre(i);
                least = std::min(least, centre), most = std::max(most, centre);
            }
            if (most - least > width) axis = i, low = least, width = most - least;
        }
        const std::uint32_t median = first + (last - first) / 2;
        if (width == 0) return median;
        if (depth < MAX_SURFACE_DEPTH) {
            const auto bin_of = [&](std::uint32_t box) {
                return std::min(BINS - 1, static_cast<int>((boxes[box].doubled_centre(axis) - low) / width * BINS));
            };
            const int best = best_bin(first, last, bin_of);
            const auto middle = std::partition(order.begin() + first, order.begin() + last,
                                               [&](std::uint32_t box) { return bin_of(box) < best; });
            const auto begin_right = static_cast<std::uint32_t>(middle - order.begin());
            if (begin_right > first && begin_right < last) return begin_right;
        }
        std::nth_element(order.begin() + first, order.begin() + median, order.begin() + last,
                         [&](std::uint32_t a, std::uint32_t b) {
                             return boxes[a].doubled_centre(axis) < boxes[b].doubled_centre(axis);
                         });
        return median;
    }

    template <typename BinOf>
    int best_bin(std::uint32_t first, std::uint32_t last, BinOf bin_of) const {
        std::array<Box, BINS> bin{};
        std::array<std::uint32_t, BINS> count{};
        for (std::uint32_t k = first; k < last; ++k) {
            const int i = bin_of(order[k]);
            bin[i].add(boxes[order[k]]);
            ++count[i];
        }
        std::array<double, BINS> right_cost{};
        Box box;
        std::uint32_t sum = 0;
        for (int i = BINS - 1; i > 0; --i) {
            box.add(bin[i]);
            sum += count[i];
            right_cost[i] = sum == 0 ? 0 : sum * box.half_area();
        }
        box = {};
        sum = 0;
        int best = 1;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 1; i < BINS; ++i) {
            box.add(bin[i - 1]);
            sum += count[i - 1];
            if (sum == 0 || sum == last - first) continue;
            const double cost = sum * box.half_area() + right_cost[i];
            if (cost < least) least = cost, best = i;
        }
        return best;
    }
};

Bvh::Bvh(std::span<const float> triangles, const Masks* masks) : masks_(masks) {
    std::vector<Box> boxes;
    std::vector<Triangle> finite;
    std::vector<std::uint32_t> finite_ids;
    for (std::size_t id = 0; id < triangles.size() / 9; ++id) {
        const Triangle triangle = triangle_at(triangles, id);
        if (!is_finite(triangle)) continue;
        Box box;
        for (const Float3& vertex : triangle) box.add(vertex);
        boxes.push_back(box);
        finite.push_back(triangle);
        finite_ids.push_back(static_cast<std::uint32_t>(id));
    }
    if (finite.empty()) return;
    std::vector<std::uint32_t> order(finite.size());
    std::iota(order.begin(), order.end(), 0u);
    nodes_.resize(1);
    Builder{nodes_, boxes, order}.build(0, 0, static_cast<std::uint32_t>(finite.size()), 0);
    for (const std::uint32_t i : order) {
        triangles_.push_back(finite[i]);
        ids_.push_back(finite_ids[i]);
    }
}

}  // namespace reference
