// SPDX-License-Identifier: MIT
// Where a ray meets a triangle, decided without error: a double filter with a proven bound, then exact integers.
//
// For a ray from o along r and a triangle abc let A = a - o and so on, n = (b - a) x (c - a). Then
//   e0 = det(r, B, C), e1 = det(r, C, A), e2 = det(r, A, B):  the side on which the ray passes each edge,
//   e0 + e1 + e2 = n . r:                                      zero iff edge-on or of zero area,
//   h = det(A, B, C) = n . (a - o):                            zero iff o lies on the plane,
// and the plane is met at the parameter t = h / (n . r). The closed triangle is met iff no two of the e differ in sign
// and one of them is not zero; t > 0 iff h has their sign.
//
// The filter's bound. Inputs are float32, so all values here are multiples of 2^-149 below 2^129 (a pixel ray's
// direction: integers below 2^61), products of three lie between 2^-447 and 2^390: double neither overflows nor
// underflows, and each operation has a relative error of at most u = 2^-53. A determinant is a sum of six terms x y z;
// each term meets at most 8 roundings (one per entry, two products, one difference, two sums), so
//   |computed - exact| <= ((1 + u)^8 - 1) * sum of |terms| <= 8.01 u * sum of |terms|,
// and the permanent, the same sum over absolute values, is computed with the same 8 roundings, hence
//   |computed - exact| <= 8.01 u / (1 - 8.01 u) * computed permanent < 2^-49 * computed permanent.
// The last product is exact. A permanent of 0 means that all six terms, hence the determinant, are 0.
// This needs round-to-nearest and no contraction (-ffp-contract=off).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "exact.hpp"

namespace reference {

using Double3 = std::array<double, 3>;

/// A ray, open at its origin, whose direction is exact though `direction` below is rounded.
struct Ray {
    enum class Towards { direction, position, pixel };

    Float3 origin{};
    Towards towards = Towards::direction;
    Float3 light{};                       ///< direction: towards the light; position: the light
    std::array<std::int64_t, 3> pixel{};  ///< pixel: the direction, each below 2^61
    Double3 direction{};                  ///< the exact direction with each coordinate rounded once
    double last_parameter = std::numeric_limits<double>::infinity();  ///< position: 1, at the light

    /// From `origin` to a light given as (x, y, z, w): w = 0, minus the direction of travel; else the position.
    static Ray to_light(const Float3& origin, const std::array<float, 4>& light);
    static Ray through_pixel(const Float3& eye, const std::array<std::int64_t, 3>& direction);
};

/// A double with a proven bound of its distance to the exact value.
struct Bounded {
    double value = 0;
    double bound = 0;

    /// -1, 0 or +1 if certain.
    std::optional<int> sign() const {
        if (value > bound) return 1;
        if (value < -bound) return -1;
        if (bound == 0) return 0;
        return std::nullopt;
    }
};

/// How often the filter had to hand over. One per thread, or per decision.
struct Effort {
    std::uint64_t signs = 0;
    std::uint64_t exact_signs = 0;
};

/// Sign of n . (a - point): which side of the triangle's plane the point is on, 0 if on it or if the area is zero.
int side_of_point(const Float3& point, const Triangle& triangle, Effort& effort);

/// Sign of n . direction.
int side_of_direction(const Float3& direction, const Triangle& triangle, Effort& effort);

/// Whether the light (x, y, z, w) is strictly on the eye's side of the triangle's plane. An eye or a light in the plane
/// and a triangle of zero area say no.
bool is_facing(const Triangle& triangle, const std::array<float, 4>& light, const Float3& eye, Effort& effort);

/// Sign of n . r if the ray's line passes through the closed triangle, 0 if it does not or is edge-on.
int covering_orientation(const Ray& ray, const Triangle& triangle, Effort& effort);

/// Whether the triangle meets the open ray: after the origin and, for a light at a position, before the light.
bool blocks(const Ray& ray, const Triangle& triangle, Effort& effort);

/// Bounds of the parameter at which the ray meets the triangle's plane, for one that is not behind the origin;
/// `latest` may be infinite.
struct ParameterBounds {
    double earliest = 0;
    double latest = std::numeric_limits<double>::infinity();
};
ParameterBounds parameter_bounds(const Ray& ray, const Triangle& triangle);

/// The same exactly, for a pixel's ray that is not edge-on.
Quotient exact_parameter(const Ray& ray, const Triangle& triangle);

bool is_finite(const Float3& vector);
bool is_finite(const Triangle& triangle);

/// Item `index` of packed arrays: 9 floats per triangle, 3 per point.
Triangle triangle_at(std::span<const float> triangles, std::size_t index);
Float3 point_at(std::span<const float> points, std::size_t index);

}  // namespace reference
