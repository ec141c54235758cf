// SPDX-License-Identifier: MIT
// The visibility contract in small integers: the judge of tests that enumerate all triangles, points and lights of a
// small grid.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

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

/// All directions with coordinates from -2 to 2.
inline std::vector<Vector> small_directions() {
    std::vector<Vector> directions;
    for (int i = 0; i < 125; ++i)
        if (i != 62) directions.push_back({i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2});
    return directions;
}

/// x -> scale * (matrix x + shift), exactly, in float32. It changes no answer.
struct ExactMap {
    std::array<Vector, 3> matrix{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Vector shift{};
    float scale = 1.0f;

    std::array<float, 3> apply(Vector x, bool is_direction) const {
        std::array<float, 3> y{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector& row = matrix[i];
            const int whole = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + (is_direction ? 0 : shift[i]);
            y[i] = static_cast<float>(whole) * scale;
            EXPECT_EQ(static_cast<double>(y[i]), static_cast<double>(scale) * whole);
        }
        return y;
    }
};

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
