// SPDX-License-Identifier: MIT
// Where a ray meets a triangle, decided without error. The identities and the bound are in predicates.hpp.
#include "predicates.hpp"

#include <algorithm>
#include <cmath>

namespace reference {
namespace {

Double3 to_double(const Float3& v) { return {v[0], v[1], v[2]}; }

/// Each coordinate has one rounding, and is 0 only if exactly 0.
Double3 difference(const Float3& a, const Float3& b) {
    return {double(a[0]) - double(b[0]), double(a[1]) - double(b[1]), double(a[2]) - double(b[2])};
}

Bounded bounded_determinant(const Double3& u, const Double3& v, const Double3& w) {
    const double yz = v[1] * w[2], zy = v[2] * w[1];
    const double zx = v[2] * w[0], xz = v[0] * w[2];
    const double xy = v[0] * w[1], yx = v[1] * w[0];
    const double value = u[0] * (yz - zy) + u[1] * (zx - xz) + u[2] * (xy - yx);
    const double permanent = std::fabs(u[0]) * (std::fabs(yz) + std::fabs(zy)) +
                             std::fabs(u[1]) * (std::fabs(zx) + std::fabs(xz)) +
                             std::fabs(u[2]) * (std::fabs(xy) + std::fabs(yx));
    return {value, 0x1p-49 * permanent};
}

/// The exact direction up to a positive factor; for a position the factor is 2^-exponent, as for the coordinates.
Integer3 exact_direction(const Ray& ray, int exponent) {
    switch (ray.towards) {
        case Ray::Towards::position:
            return scaled(ray.light, exponent) - scaled(ray.origin, exponent);
        case Ray::Towards::pixel:
            return {Integer(ray.pixel[0]), Integer(ray.pixel[1]), Integer(ray.pixel[2])};
        case Ray::Towards::direction:
            break;
    }
    return scaled(ray.light, common_exponent({ray.light}));
}

/// Sign of det(r, u - o, v - o).
int side_of_edge_exactly(const Ray& ray, const Float3& u, const Float3& v) {
    const bool has_position = ray.towards == Ray::Towards::position;
    const int exponent = common_exponent({ray.origin, u, v, has_position ? ray.light : Float3{}});
    const Integer3 origin = scaled(ray.origin, exponent);
    return sign(
        determinant(exact_direction(ray, exponent), scaled(u, exponent) - origin, scaled(v, exponent) - origin));
}

int side_of_point_exactly(const Float3& point, const Triangle& t) {
    const int exponent = common_exponent({point, t[0], t[1], t[2]});
    const Integer3 origin = scaled(point, exponent);
    return sign(
        determinant(scaled(t[0], exponent) - origin, scaled(t[1], exponent) - origin, scaled(t[2], exponent) - origin));
}

int side_of_direction_exactly(const Float3& direction, const Triangle& t) {
    const int exponent = common_exponent({t[0], t[1], t[2]});
    const Integer3 a = scaled(t[0], exponent);
    return sign(determinant(scaled(direction, common_exponent({direction})), scaled(t[1], exponent) - a,
                            scaled(t[2], exponent) - a));
}

template <typename Exactly>
int decide(const Bounded& filtered, Effort& effort, Exactly exactly) {
    ++effort.signs;
    if (const auto certain = filtered.sign()) return *certain;
    ++effort.exact_signs;
    return exactly();
}

}  // namespace

Ray Ray::to_light(const Float3& origin, const std::array<float, 4>& light) {
    Ray ray;
    ray.origin = origin;
    ray.light = {light[0], light[1], light[2]};
    if (light[3] == 0) {
        ray.direction = to_double(ray.light);
    } else {
        ray.towards = Towards::position;
        ray.direction = difference(ray.light, origin);
        ray.last_parameter = 1;
    }
    return ray;
}

Ray Ray::through_pixel(const Float3& eye, const std::array<std::int64_t, 3>& direction) {
    Ray ray;
    ray.origin = eye;
    ray.towards = Towards::pixel;
    ray.pixel = direction;
    for (int i = 0; i < 3; ++i) ray.direction[i] = static_cast<double>(direction[i]);
    return ray;
}

int side_of_point(const Float3& point, const Triangle& t, Effort& effort) {
    return decide(bounded_determinant(difference(t[0], point), difference(t[1], point), difference(t[2], point)),
                  effort, [&] { return side_of_point_exactly(point, t); });
}

int side_of_direction(const Float3& direction, const Triangle& t, Effort& effort) {
    return decide(bounded_determinant(to_double(direction), difference(t[1], t[0]), difference(t[2], t[0])), effort,
                  [&] { return side_of_direction_exactly(direction, t); });
}

bool is_facing(const Triangle& triangle, const std::array<float, 4>& light, const Float3& eye, Effort& effort) {
    const int eye_side = side_of_point(eye, triangle, effort);
    const Float3 xyz{light[0], light[1], light[2]};
    // n . (a - S) and n . (a - E) agree in sign on one side; n . l points the other way round.
    const int light_side =
        light[3] == 0 ? -side_of_direction(xyz, triangle, effort) : side_of_point(xyz, triangle, effort);
    return eye_side * light_side > 0;
}

int covering_orientation(const Ray& ray, const Triangle& t, Effort& effort) {
    const std::array<Double3, 3> from_origin{difference(t[0], ray.origin), difference(t[1], ray.origin),
                                             difference(t[2], ray.origin)};
    int orientation = 0;
    for (int i = 0; i < 3; ++i) {
        const int u = (i + 1) % 3, v = (i + 2) % 3;
        const int side = decide(bounded_determinant(ray.direction, from_origin[u], from_origin[v]), effort,
                                [&] { return side_of_edge_exactly(ray, t[u], t[v]); });
        if (side == 0) continue;
        if (side == -orientation) return 0;
        orientation = side;
    }
    return orientation;
}

bool blocks(const Ray& ray, const Triangle& triangle, Effort& effort) {
    const int orientation = covering_orientation(ray, triangle, effort);
    if (orientation == 0) return false;
    if (side_of_point(ray.origin, triangle, effort) != orientation) return false;  // t <= 0
    // t < 1 iff the light is strictly on the other side: n . r - h = n . (S - a).
    return ray.towards != Ray::Towards::position || side_of_point(ray.light, triangle, effort) == -orientation;
}

ParameterBounds parameter_bounds(const Ray& ray, const Triangle& t) {
    const Double3 a = difference(t[0], ray.origin), b = difference(t[1], ray.origin), c = difference(t[2], ray.origin);
    const Bounded height = bounded_determinant(a, b, c);
    const Bounded e0 = bounded_determinant(ray.direction, b, c), e1 = bounded_determinant(ray.direction, c, a),
                  e2 = bounded_determinant(ray.direction, a, b);
    // The two sums add at most 2.01 u times the sum of |e|, itself below the permanents: 8.1 u + 2.01 u < 16 u = 2^-49.
    const Bounded speed{e0.value + e1.value + e2.value, e0.bound + e1.bound + e2.bound};
    // Each bound below has up to 3 further roundings; 2^-49 covers them (and those of the sum of bounds) with room.
    const double least = std::max(0.0, std::fabs(height.value) - height.bound);
    const double most = std::fabs(height.value) + height.bound;
    const double slowest = std::fabs(speed.value) - speed.bound;
    const double fastest = std::fabs(speed.value) + speed.bound;
    ParameterBounds bounds;
    if (height.sign().value_or(0) * speed.sign().value_or(0) < 0) return bounds;  // behind: these bound |t| alone
    bounds.earliest = fastest > 0 ? least / fastest * (1 - 0x1p-49) : 0;
    if (slowest > 0) bounds.latest = most / slowest * (1 + 0x1p-49);
    return bounds;
}

Quotient exact_parameter(const Ray& ray, const Triangle& t) {
    const int exponent = common_exponent({ray.origin, t[0], t[1], t[2]});
    const Integer3 origin = scaled(ray.origin, exponent), a = scaled(t[0], exponent), b = scaled(t[1], exponent),
                   c = scaled(t[2], exponent);
    const Integer3 normal = cross(b - a, c - a);
    Quotient parameter{dot(normal, a - origin), dot(normal, exact_direction(ray, exponent)), exponent};
    if (parameter.denominator.sign() < 0) {
        parameter.numerator = -parameter.numerator;
        parameter.denominator = -parameter.denominator;
    }
    return parameter;
}

bool is_finite(const Float3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
bool is_finite(const Triangle& t) { return is_finite(t[0]) && is_finite(t[1]) && is_finite(t[2]); }

Triangle triangle_at(std::span<const float> triangles, std::size_t index) {
    return {point_at(triangles, 3 * index), point_at(triangles, 3 * index + 1), point_at(triangles, 3 * index + 2)};
}
Float3 point_at(std::span<const float> points, std::size_t index) {
    return {points[3 * index], points[3 * index + 1], points[3 * index + 2]};
}

}  // namespace reference
