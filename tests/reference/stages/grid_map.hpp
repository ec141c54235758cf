// SPDX-License-Identifier: MIT
// What a float map from world space to a grid of texels stands for, in long double, and what a triangle's edge
// functions and plane really are there. For measuring how much of a float margin is used: signs are never taken from
// here but from predicates.hpp.
//
// With a 64-bit mantissa every value here has an error below 2^-58 of the sum of magnitudes it comes from, while the
// margins it is compared with are at least 2^-24 of the same sums: a ratio of error to margin is right to 2^-30.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "../predicates.hpp"

namespace reference {

static_assert(std::numeric_limits<long double>::digits >= 64, "the grid's truth needs a 64-bit mantissa");

using Wide3 = std::array<long double, 3>;

inline Wide3 wide(const Float3& v) { return {v[0], v[1], v[2]}; }
inline Wide3 cross(const Wide3& a, const Wide3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline long double dot(const Wide3& a, const Wide3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// (x, y, w): the place in the grid is (x / w, y / w). z: height towards the light.
struct GridPosition {
    long double x, y, w, z;
};

class GridMap {
public:
    /// A light in direction `light` (towards it): grid coordinate i is scale[i] (d_i - light_i / light_k d_k) +
    /// offset[i], height is the sign of light_k times d_k, with k = `axis`, d = p - center, i = the axes after k in
    /// cyclic order.
    static GridMap parallel(const Float3& light, int axis, const Float3& center, const std::array<float, 2>& scale,
                            const std::array<float, 2>& offset) {
        GridMap map;
        map.center_ = wide(center);
        for (int i = 0; i < 2; ++i) {
            const int across = (axis + 1 + i) % 3;
            map.rows_[i][across] = scale[i];
            map.rows_[i][axis] = -static_cast<long double>(scale[i]) * light[across] / light[axis];
            map.offset_[i] = offset[i];
        }
        map.rows_[2][axis] = light[axis] > 0 ? 1 : -1;
        return map;
    }

    /// x, y, w = rows times (p - center); the rows mean what they say.
    static GridMap perspective(const Float3& center, const std::array<Wide3, 3>& rows) {
        GridMap map;
        map.center_ = wide(center);
        map.rows_ = rows;
        map.perspective_ = true;
        return map;
    }

    /// A camera whose pixel coordinates (X, Y) look along  forward + (X - width / 2) s right - (Y - height / 2) s up:
    /// the inverse of that matrix.
    static GridMap camera(const Float3& eye, const Wide3& right, const Wide3& up, const Wide3& forward,
                          long double step, std::uint32_t width, std::uint32_t height) {
        Wide3 x_axis, y_axis, w_axis;
        for (int i = 0; i < 3; ++i) {
            x_axis[i] = step * right[i];
            y_axis[i] = -step * up[i];
            w_axis[i] = forward[i] - width / 2.0L * x_axis[i] - height / 2.0L * y_axis[i];
        }
        const long double determinant = dot(x_axis, cross(y_axis, w_axis));
        std::array<Wide3, 3> rows{cross(y_axis, w_axis), cross(w_axis, x_axis), cross(x_axis, y_axis)};
        for (Wide3& row : rows)
            for (long double& entry : row) entry /= determinant;
        return perspective(eye, rows);
    }

    bool is_perspective() const { return perspective_; }

    GridPosition operator()(const Float3& p) const {
        const Wide3 d{p[0] - center_[0], p[1] - center_[1], p[2] - center_[2]};
        const long double depth = dot(rows_[2], d);
        const long double w = perspective_ ? depth : 1;
        return {dot(rows_[0], d) + offset_[0], dot(rows_[1], d) + offset_[1], w, perspective_ ? 1 / depth : depth};
    }

private:
    Wide3 center_{};
    std::array<Wide3, 3> rows_{};
    Wide3 offset_{};
    bool perspective_ = false;
};

/// A triangle as the grid sees it.
class GridTriangle {
public:
    GridTriangle(const GridMap& map, const Triangle& t)
        : corners_{map(t[0]), map(t[1]), map(t[2])}, perspective_(map.is_perspective()) {}

    const GridPosition& corner(int i) const { return corners_[i]; }

    /// det(corner i, corner i + 1, (x, y, 1))
    long double edge(int i, long double x, long double y) const {
        const GridPosition &a = corners_[i], &b = corners_[(i + 1) % 3];
        return (a.x - a.w * x) * (b.y - b.w * y) - (a.y - a.w * y) * (b.x - b.w * x);
    }

    /// Height of the plane at (x, y); infinite or NaN if edge-on.
    long double height(long double x, long double y) const {
        const GridPosition &a = corners_[0], &b = corners_[1], &c = corners_[2];
        // Relative to (x, y), so that nothing large is subtracted: heights weighted by the edge functions, which are
        // the barycentric coordinates of (x, y); in perspective each vertex has the height 1 / w and the weight w.
        const long double e_ab = edge(0, x, y), e_bc = edge(1, x, y), e_ca = edge(2, x, y);
        if (perspective_) return (e_ab + e_bc + e_ca) / (e_bc * a.w + e_ca * b.w + e_ab * c.w);
        // The reference height is a's, so that a plane far from the center loses nothing.
        return a.z + (e_ca * (b.z - a.z) + e_ab * (c.z - a.z)) / (e_ab + e_bc + e_ca);
    }

private:
    std::array<GridPosition, 3> corners_;
    bool perspective_;
};

}  // namespace reference
