// SPDX-License-Identifier: MIT
// Node transforms: 3x4 matrices in double. Sums are taken from left to right and never contracted (the build says
// -ffp-contract=off), so the same file gives the same float32 triangles on every host. A position is rounded to
// float32 once, at the end; the identity returns the input's bits (minus zero and NaN payloads too).
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <gnomon.hpp>
#include "query/vectors.hpp"

namespace gnomon::scene {

/// Rounds to the nearest float32; a value beyond float32's range becomes infinite.
inline Float3 rounded(const Double3& v) {
    static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// p_parent = linear * p + translation.
struct Affine {
    std::array<Double3, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows
    Double3 translation{0, 0, 0};

    bool is_identity() const { return *this == Affine{}; }
    bool operator==(const Affine&) const = default;

    Double3 operator()(const Double3& p) const {
        Double3 out{};
        for (int row = 0; row < 3; ++row) {
            const Double3& m = linear[row];
            out[row] = ((m[0] * p[0] + m[1] * p[1]) + m[2] * p[2]) + translation[row];
        }
        return out;
    }

    /// The direction of the axis (0 x, 1 y, 2 z): a column of the linear part.
    Double3 axis(int column) const { return {linear[0][column], linear[1][column], linear[2][column]}; }

    /// grandparent_from_parent * parent_from_node.
    Affine operator*(const Affine& inner) const {
        Affine out;
        for (int row = 0; row < 3; ++row) {
            const Double3& m = linear[row];
            for (int column = 0; column < 3; ++column) {
                const Double3 n = inner.axis(column);
                out.linear[row][column] = (m[0] * n[0] + m[1] * n[1]) + m[2] * n[2];
            }
        }
        out.translation = (*this)(inner.translation);
        return out;
    }
};

}  // namespace gnomon::scene
