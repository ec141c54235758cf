// SPDX-License-Identifier: MIT
// What snapping to a world lattice does to a mesh: triangles that it changes, and corners that touch triangles which
// they do not belong to (numerics.md, 13 and 14).
#include <gnomon.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "query/vectors.hpp"

namespace gnomon {
namespace {

using Vector = Double3;

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(double k, const Vector& a) { return scaled(a, k); }
double length(const Vector& a) { return std::sqrt(dot(a, a)); }

template <typename Value>
Vector vector_at(std::span<const Value> values, std::size_t i) {
    return {double(values[3 * i]), double(values[3 * i + 1]), double(values[3 * i + 2])};
}

template <typename Value>
Vector normal_of(std::span<const Value> values, std::size_t triangle) {
    const Vector a = vector_at(values, 3 * triangle);
    return cross(vector_at(values, 3 * triangle + 1) - a, vector_at(values, 3 * triangle + 2) - a);
}

void require_triangles(std::span<const double> triangles) {
    if (triangles.size() % 9 != 0)
        throw InvalidArgument("triangles take 9 numbers each, and " + std::to_string(triangles.size()) + " were given");
    if (triangles.size() / 3 >= no_receiver)
        throw InvalidArgument("there are too many triangles: ids are 32 bits wide");
}

/// The distance of p from the closed triangle a, b, c, squared; all are small differences.
double squared_distance(const Vector& p, const Vector& b, const Vector& c) {  // a is the origin
    const Vector n = cross(b, c);
    const auto to_edge = [&](const Vector& from, const Vector& along) {
        const double t = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
        const Vector rest = p - from - t * along;
        return dot(rest, rest);
    };
    const bool is_over = dot(cross(b, p), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(p, c), n) >= 0;
    const double height = dot(p, n);
    const double nearest_edge = std::min({to_edge({}, b), to_edge(b, c - b), to_edge({}, c)});
    return is_over ? std::min(nearest_edge, height * height / dot(n, n)) : nearest_edge;
}

/// All that is within `reach` of a triangle lies between its plane's and its edges' half-spaces, moved by `reach`.
struct Neighbourhood {
    struct HalfSpace {
        Vector normal;
        double farthest;  // of normal . p
    };
    std::array<HalfSpace, 5> half_spaces;
    Vector low, high;

    Neighbourhood(const Vector& a, const Vector& b, const Vector& c, double reach) {
        const Vector n = cross(b - a, c - a);
        const std::array<Vector, 5> normals{n, -1 * n, cross(b - a, n), cross(c - b, n), cross(a - c, n)};
        const std::array<Vector, 5> through{a, a, a, b, c};
        for (int i = 0; i < 5; ++i) {
            const double at = dot(normals[i], through[i]), size = length(normals[i]);
            half_spaces[i] = {normals[i], at + size * reach + 1e-12 * (std::abs(at) + size * length(through[i]))};
        }
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min({a[i], b[i], c[i]}) - reach;
            high[i] = std::max({a[i], b[i], c[i]}) + reach;
        }
    }

    bool may_meet(const Vector& box_low, const Vector& box_high) const {
        for (int i = 0; i < 3; ++i)
            if (box_high[i] < low[i] || box_low[i] > high[i]) return false;
        for (const HalfSpace& h : half_spaces) {
            double nearest = 0;
            for (int i = 0; i < 3; ++i) nearest += h.normal[i] * (h.normal[i] > 0 ? box_low[i] : box_high[i]);
            if (nearest > h.farthest) return false;
        }
        return true;
    }
};

/// Positions in a binary tree of boxes, in which each node halves its positions along its longest side.
class PositionTree {
public:
    explicit PositionTree(std::vector<Vector> positions) : positions_(std::move(positions)), order_(positions_.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
    }

    /// Calls `visit` with the index of each position that may lie in the neighbourhood.
    template <typename Visit>
    void visit_near(const Neighbourhood& around, const Visit& visit) const {
        std::uint32_t stack[64];
        int depth = 0;
        if (!nodes_.empty()) stack[depth++] = 0;
        while (depth != 0) {
            const std::uint32_t at = stack[--depth];
            const Node& node = nodes_[at];
            if (!around.may_meet(node.low, node.high)) continue;
            if (node.second == 0) {
                for (std::uint32_t i = node.first; i < node.end; ++i)
                    if (around.may_meet(positions_[order_[i]], positions_[order_[i]])) visit(order_[i]);
            } else {
                stack[depth++] = node.second, stack[depth++] = at + 1;
            }
        }
    }
    const Vector& operator[](std::size_t i) const { return positions_[i]; }

private:
    static constexpr std::uint32_t leaf_size = 8;
    struct Node {
        Vector low, high;
        std::uint32_t first, end;  // in order_
        std::uint32_t second = 0;  // the second child; the first one is the next node; 0: a leaf
    };

    void build(std::uint32_t first, std::uint32_t end) {
        Node node{positions_[order_[first]], positions_[order_[first]], first, end};
        for (std::uint32_t i = first; i < end; ++i)
            for (int c = 0; c < 3; ++c) {
                node.low[c] = std::min(node.low[c], positions_[order_[i]][c]);
                node.high[c] = std::max(node.high[c], positions_[order_[i]][c]);
            }
        const std::size_t at = nodes_.size();
        nodes_.push_back(node);
        if (end - first <= leaf_size) return;
        const Vector size = node.high - node.low;
        const auto axis = std::max_element(size.begin(), size.end()) - size.begin();
        const std::uint32_t middle = first + (end - first) / 2;
        std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                         [&](std::uint32_t i, std::uint32_t j) { return positions_[i][axis] < positions_[j][axis]; });
        build(first, middle);
        nodes_[at].second = static_cast<std::uint32_t>(nodes_.size());
        build(middle, end);
    }

    std::vector<Vector> positions_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

/// Distinct finite positions, ascending, and which of them each corner is (no_receiver: none).
struct Corners {
    std::vector<Vector> positions;
    std::vector<std::uint32_t> of_corner;
    std::vector<std::uint32_t> first_corner;  // a corner at each position

    explicit Corners(std::span<const double> triangles) : of_corner(triangles.size() / 3, no_receiver) {
        std::vector<std::uint32_t> order;
        for (std::size_t i = 0; i < of_corner.size(); ++i)
            if (is_finite(vector_at(triangles, i))) order.push_back(static_cast<std::uint32_t>(i));
        std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
            return std::lexicographical_compare(&triangles[3 * i], &triangles[3 * i] + 3, &triangles[3 * j],
                                                &triangles[3 * j] + 3);
        });
        for (const std::uint32_t corner : order) {
            const Vector p = vector_at(triangles, corner);
            if (positions.empty() || positions.back() != p) positions.push_back(p), first_corner.push_back(corner);
            of_corner[corner] = static_cast<std::uint32_t>(positions.size() - 1);
        }
    }
};

}  // namespace

std::vector<WorldLattice::Change> WorldLattice::changes(std::span<const double> triangles, double degrees) const {
    require_triangles(triangles);
    if (!(degrees >= 0 && degrees <= 90))
        throw InvalidArgument("the angle of tilted triangles must be from 0 to 90 degrees");
    const double cosine = std::cos(degrees * std::numbers::pi / 180);
    const Snapped snapped = snap(triangles);
    std::vector<Change> result(triangles.size() / 9, Change::none);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const Vector before = normal_of(triangles, i), after = normal_of(std::span<const float>(snapped.positions), i);
        if (before == Vector{} || !is_finite(before) || !is_finite(after)) continue;
        const double along = dot(before, after);
        if (after == Vector{})
            result[i] = Change::zero_area;  // exact: the coordinates have 25 bits
        else if (along < 0)
            result[i] = Change::turned_over;
        else if (along < cosine * length(before) * length(after))
            result[i] = Change::tilted;
    }
    return result;
}

std::vector<std::uint32_t> WorldLattice::touched_triangles(std::span<const double> triangles) const {
    require_triangles(triangles);
    const std::vector<float> snapped = snap(triangles).positions;
    const Corners corners(triangles);
    // Differences from the centre of the corners: then the boxes' tests round far less than the reach.
    const Vector centre = world_of({});
    std::vector<Vector> local;
    for (const Vector& p : corners.positions) local.push_back(p - centre);
    const PositionTree tree(std::move(local));

    const double reach = step();
    std::vector<std::uint32_t> touched(corners.positions.size(), no_receiver);
    std::vector<double> distance(corners.positions.size(), reach * reach);
    const auto is_before = [&](std::uint32_t i, std::uint32_t j) {  // does not depend on the triangles' order
        return std::lexicographical_compare(&triangles[9 * i], &triangles[9 * i] + 9, &triangles[9 * j],
                                            &triangles[9 * j] + 9);
    };
    for (std::uint32_t t = 0; t < triangles.size() / 9; ++t) {
        const Vector a = vector_at(triangles, 3 * t), b = vector_at(triangles, 3 * t + 1),
                     c = vector_at(triangles, 3 * t + 2);
        if (!is_finite(a) || !is_finite(b) || !is_finite(c) || cross(b - a, c - a) == Vector{}) continue;
        tree.visit_near(Neighbourhood(a - centre, b - centre, c - centre, reach * (1 + 0x1p-10)), [&](std::uint32_t i) {
            const float* at = &snapped[3 * corners.first_corner[i]];
            for (int k = 0; k < 3; ++k)
                if (std::equal(at, at + 3, &snapped[9 * t + 3 * k])) return;
            // Differences of world coordinates: they do not depend on where the origin lies.
            const double d = squared_distance(corners.positions[i] - a, b - a, c - a);
            if (d > distance[i]) return;
            if (d == distance[i] && touched[i] != no_receiver && !is_before(t, touched[i])) return;
            distance[i] = d, touched[i] = t;
        });
    }
    std::vector<std::uint32_t> result(corners.of_corner.size(), no_receiver);
    for (std::size_t i = 0; i < result.size(); ++i)
        if (corners.of_corner[i] != no_receiver) result[i] = touched[corners.of_corner[i]];
    return result;
}

}  // namespace gnomon
