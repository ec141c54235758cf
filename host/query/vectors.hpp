// SPDX-License-Identifier: MIT
// The host's own geometry is computed with GLM's vectors of three doubles. Public headers have arrays: here are the
// ways between them, and the functions that GLM lacks. GLM's sums go from left to right, and the build neither
// contracts them nor lets GLM use SIMD, so every host computes the same bits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>
#include <span>

namespace gnomon {

/// Three numbers in memory, as a vector.
template <typename Number>
glm::dvec3 loaded(const Number* from) {
    return {from[0], from[1], from[2]};
}
/// A public header's array, as a vector.
template <typename Number>
glm::dvec3 loaded(const std::array<Number, 3>& from) {
    return loaded(from.data());
}

/// A vector, rounded to float32.
inline void store(float* to, const glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i]);
}
/// A vector, as a public header's array: rounded to the nearest float32 (beyond float32's range: infinite), or exact.
template <typename Number = float>
std::array<Number, 3> array_of(const glm::dvec3& v) {
    return {static_cast<Number>(v.x), static_cast<Number>(v.y), static_cast<Number>(v.z)};
}

/// Whether none of the three coordinates is infinite or NaN.
template <typename Vector>
bool is_finite(const Vector& v) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// The largest magnitude of a coordinate.
inline double largest_coordinate(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The axis of the largest coordinate, the first of equal ones.
inline int largest_axis(const glm::dvec3& v) { return v.x >= v.y && v.x >= v.z ? 0 : v.y >= v.z ? 1 : 2; }

/// a . (b x c). glm::determinant() sums in another order.
inline double determinant(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) { return dot(a, cross(b, c)); }

/// Scales to unit length, by the largest coordinate first so that nothing leaves double's range, as it may in
/// glm::normalize(). Returns false, and leaves v as it is, if v is zero or not finite.
inline bool make_unit(glm::dvec3& v) {
    const double largest = largest_coordinate(v);
    if (!(largest > 0) || !is_finite(v)) return false;
    v /= largest;
    v /= length(v);
    return true;
}

/// A unit vector perpendicular to the unit vector `axis`.
inline glm::dvec3 perpendicular(const glm::dvec3& axis) {
    glm::dvec3 made = cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0));
    make_unit(made);
    return made;
}

/// The principal axis of `vectors` in the plane perpendicular to the unit vector `axis`.
inline glm::dvec3 widest_across(const glm::dvec3& axis, std::span<const glm::dvec3> vectors) {
    const glm::dvec3 u = perpendicular(axis), v = cross(axis, u);
    double uu = 0, uv = 0, vv = 0;
    for (const glm::dvec3& vector : vectors) {
        const double x = dot(vector, u), y = dot(vector, v);
        uu += x * x, uv += x * y, vv += y * y;
    }
    const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
    return u * std::cos(angle) + v * std::sin(angle);
}

}  // namespace gnomon
