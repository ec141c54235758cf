// SPDX-License-Identifier: MIT
// Node transforms in double, of GLM's matrices. A 3x3 matrix beside a translation: the product of a glm::dmat4 and a
// vector adds two pairs, (x + y) + (z + w), and these sums go from left to right, as all others do (query/vectors.hpp),
// so the same file gives the same float32 triangles on every host. A position is rounded to float32 once, at the end;
// the identity returns the input's bits (minus zero and NaN payloads too).
#pragma once

#include <glm/mat3x3.hpp>

#include "query/vectors.hpp"

namespace gnomon::scene {

/// p_parent = linear * p + translation.
struct Affine {
    glm::dmat3 linear{1};
    glm::dvec3 translation{0};

    bool is_identity() const { return *this == Affine{}; }
    bool operator==(const Affine&) const = default;

    glm::dvec3 operator()(const glm::dvec3& p) const { return linear * p + translation; }
    /// grandparent_from_parent * parent_from_node.
    Affine operator*(const Affine& inner) const { return {linear * inner.linear, (*this)(inner.translation)}; }
};

}  // namespace gnomon::scene
