// SPDX-License-Identifier: MIT
// The visibility contract in small integers: the judge of tests that enumerate all triangles, points and lights of a
// small grid.
#pragma once

#include <array>
#include <cstdint>

namespace support {

using Vector = std::array<int, 3>;

inline Vector operator-(Vector a, Vector b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// Point i of the grid of side^3 points with coordinates from 0 to side - 1.
inline Vector grid_point(std::uint32_t i, std::uint32_t side) {
    return {static_cast<int>(i % side), static_cast<int>(i / side % side), static_cast<int>(i / side / side)};
}

inline int sign_of_det(Vector u, Vector v, Vector w) {
    const int det =
        u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
    return (det > 0) - (det < 0);
}

/// A direction in which light comes towards the points' shadow rays (minus its direction of travel), or a position.
struct SmallLight {
    Vector at;
    bool is_position;
};

/// The contract (docs/numerics.md, 1) in integers.
inline bool is_blocked(Vector a, Vector b, Vector c, Vector p, const SmallLight& light) {
    const Vector d = light.is_position ? light.at - p : light.at;
    const int s = sign_of_det(b - a, c - a, d);
    if (s == 0 || sign_of_det(b - a, c - a, a - p) != s) return false;
    if (light.is_position && sign_of_det(b - a, c - a, a - light.at) != -s) return false;
    return s * sign_of_det(a - p, b - p, d) >= 0 && s * sign_of_det(b - p, c - p, d) >= 0 &&
           s * sign_of_det(c - p, a - p, d) >= 0;
}

}  // namespace support
