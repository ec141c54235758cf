// SPDX-License-Identifier: MIT
// What lines along the axes meet of a scene: what an eye sees from its sides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "affine.hpp"
#include "scene.hpp"

namespace gnomon::scene {

struct Bounds {
    glm::dvec3 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};

    bool is_empty() const { return !(least.x <= most.x); }
    void add(const glm::dvec3& p) { least = min(least, p), most = max(most, p); }
    void add(const Bounds& other) { least = min(least, other.least), most = max(most, other.most); }
    glm::dvec3 sides() const { return most - least; }
    glm::dvec3 middle() const { return least / 2.0 + most / 2.0; }
};

/// Calls visit(t) with the nine floats of each finite triangle.
template <typename Visit>
void for_each_finite_triangle(const Scene& scene, const Visit& visit) {
    for (std::size_t i = 0; i < scene.triangle_count(); ++i)
        if (scene.is_finite(i)) visit(&scene.triangles[9 * i]);
}

/// Lines parallel to an axis of the box that do not meet its middle's own planes: fractions of its sides.
inline constexpr double line_positions[] = {0.137, 0.319, 0.5071, 0.683, 0.871};

/// What a line along an axis meets: the triangle nearest to the middle on each side, and the outermost on each side.
struct LineHits {
    double inner[2] = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    double outer[2] = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    /// The front points to larger coordinates.
    bool is_inner_up[2] = {}, is_outer_up[2] = {};
    const float* outer_triangle[2] = {};

    void add(const float* triangle, double at, bool is_up, double middle) {
        const int side = at > middle;
        if (side == 0 ? at > inner[0] : at < inner[1]) inner[side] = at, is_inner_up[side] = is_up;
        if (at < outer[0]) outer[0] = at, is_outer_up[0] = is_up, outer_triangle[0] = triangle;
        if (at > outer[1]) outer[1] = at, is_outer_up[1] = is_up, outer_triangle[1] = triangle;
    }
    bool is_met(int side) const { return std::isfinite(inner[side]); }
};

/// Lines along one axis.
class Lines {
public:
    Lines(int axis, const glm::dvec3& middle) : axis_(axis), middle_(middle) {}

    void through_middle() { add_line(middle_[(axis_ + 1) % 3], middle_[(axis_ + 2) % 3]); }
    void all_over(const Bounds& bounds) {
        const auto at = [&](int side, double part) {
            return bounds.least[side] + part * (bounds.most[side] - bounds.least[side]);
        };
        for (const double a : line_positions)
            for (const double b : line_positions) add_line(at((axis_ + 1) % 3, a), at((axis_ + 2) % 3, b));
    }

    void add(const float* t) {
        const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
        const auto [left, right] = std::minmax({t[u], t[u + 3], t[u + 6]});
        const auto [low, high] = std::minmax({t[v], t[v + 3], t[v + 6]});
        const auto first = std::ranges::lower_bound(at_, double(left), {}, [](const auto& line) { return line[0]; });
        for (std::size_t i = std::size_t(first - at_.begin()); i < at_.size() && at_[i][0] <= right; ++i) {
            const auto& [x, y] = at_[i];
            if (y < low || y > high) continue;
            double e[3], sum = 0;
            for (int k = 0; k < 3; ++k) {
                const float *a = t + 3 * ((k + 1) % 3), *b = t + 3 * ((k + 2) % 3);
                e[k] = (a[u] - x) * (b[v] - y) - (a[v] - y) * (b[u] - x);
                sum += e[k];
            }
            const bool is_inside = (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
            if (!is_inside || sum == 0) continue;
            hits[i].add(t, (e[0] * t[axis_] + e[1] * t[axis_ + 3] + e[2] * t[axis_ + 6]) / sum, sum > 0,
                        middle_[axis_]);
        }
    }

    /// The point in which a line meets the plane at this coordinate.
    glm::dvec3 point(std::size_t line, double at) const {
        glm::dvec3 p;
        p[axis_] = at, p[(axis_ + 1) % 3] = at_[line][0], p[(axis_ + 2) % 3] = at_[line][1];
        return p;
    }

    std::vector<LineHits> hits;

private:
    void add_line(double u, double v) {
        at_.push_back({u, v});
        hits.emplace_back();
    }

    int axis_;
    glm::dvec3 middle_;
    std::vector<std::array<double, 2>> at_;  ///< the first coordinate does not fall
};

}  // namespace gnomon::scene
