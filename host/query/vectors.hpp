// SPDX-License-Identifier: MIT
// Vectors of three doubles for the host's own geometry: cameras, node transforms. Sums are taken from left to right and
// never contracted (the build sets -ffp-contract=off), so every host computes the same bits.
#pragma once

#include <array>
#include <cmath>
#include <span>

namespace gnomon {

using Double3 = std::array<double, 3>;

template <typename Number>
bool is_finite(const std::array<Number, 3>& v) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

inline double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Double3 sum(const Double3& a, const Double3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

inline Double3 scaled(const Double3& v, double factor) { return {v[0] * factor, v[1] * factor, v[2] * factor}; }

inline double determinant(const Double3& a, const Double3& b, const Double3& c) { return dot(a, cross(b, c)); }

inline void store(float* to, const Double3& v) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i]);
}
inline Double3 loaded(const float* from) { return {from[0], from[1], from[2]}; }

/// Scales to unit length, by the largest coordinate first so that nothing leaves double's range. False (and v is left
/// as it is) if v is zero or not finite.
inline bool normalize(Double3& v) {
    const double largest = std::fmax(std::fabs(v[0]), std::fmax(std::fabs(v[1]), std::fabs(v[2])));
    if (!(largest > 0) || !is_finite(v)) return false;
    for (double& c : v) c /= largest;
    const double length = std::sqrt(dot(v, v));
    for (double& c : v) c /= length;
    return true;
}

/// A unit vector at a right angle to `axis`, which is one.
inline Double3 perpendicular(const Double3& axis) {
    Double3 made = cross(axis, std::fabs(axis[1]) < 0.9 ? Double3{0, 1, 0} : Double3{1, 0, 0});
    normalize(made);
    return made;
}

/// Of the unit vectors at right angles to `axis`, which is one, that along which these vectors spread most.
inline Double3 widest_across(const Double3& axis, std::span<const Double3> vectors) {
    const Double3 u = perpendicular(axis), v = cross(axis, u);
    double uu = 0, uv = 0, vv = 0;
    for (const Double3& vector : vectors) {
        const double x = dot(vector, u), y = dot(vector, v);
        uu += x * x, uv += x * y, vv += y * y;
    }
    const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
    return sum(scaled(u, std::cos(angle)), scaled(v, std::sin(angle)));
}

}  // namespace gnomon
