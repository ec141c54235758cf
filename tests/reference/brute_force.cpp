// SPDX-License-Identifier: MIT
// The words of the contract in exact integers: every triangle, no tree, no filter, and other formulas than
// predicates.hpp has. With n = (b - a) x (c - a) the plane is met at t = n . (a - o) / (n . r); the point met, times
// n . r, is an integer vector, and lies in the closed triangle iff it is on the inner side of all three edges.
//
// All coordinates are over one power of two, so a degree-seven product of 277-bit numbers is the worst: n (558 bits)
// times an edge (278) times the scaled point (n . r: 836, plus 278, plus a few) stays under 1970 bits.
#include "brute_force.hpp"

#include "arguments.hpp"
#include "masks.hpp"
#include "parallel.hpp"
#include "visibility.hpp"

namespace reference {
namespace {

int brute_exponent(const Float3& origin, const Triangle& triangle, const Float3& other) {
    return common_exponent({origin, triangle[0], triangle[1], triangle[2], other});
}

/// The parameter at which the ray from `origin` along `direction` (same unit) meets the closed triangle's inside, if it
/// is not edge-on.
std::optional<Quotient> meeting_parameter(const Integer3& origin, const Integer3& direction,
                                          const std::array<Integer3, 3>& vertex, int exponent) {
    const Integer3 normal = cross(vertex[1] - vertex[0], vertex[2] - vertex[0]);
    Integer speed = dot(normal, direction);
    if (speed.is_zero()) return std::nullopt;
    Integer height = dot(normal, vertex[0] - origin);
    if (speed.sign() < 0) speed = -speed, height = -height;
    for (int i = 0; i < 3; ++i) {
        const Integer3& from = vertex[i];
        const Integer3 edge = vertex[(i + 1) % 3] - from;
        Integer3 from_edge;  // (origin + height / speed * direction - from) * speed
        for (int k = 0; k < 3; ++k) from_edge[k] = (origin[k] - from[k]) * speed + height * direction[k];
        if (dot(normal, cross(edge, from_edge)).sign() < 0) return std::nullopt;
    }
    return Quotient{height, speed, exponent};
}

std::array<Integer3, 3> scaled_vertices(const Triangle& triangle, int exponent) {
    return {scaled(triangle[0], exponent), scaled(triangle[1], exponent), scaled(triangle[2], exponent)};
}

bool blocks_by_the_contract(const Float3& point, const std::array<float, 4>& light, const Triangle& triangle) {
    const Float3 xyz{light[0], light[1], light[2]};
    const bool has_position = light[3] != 0;
    const int exponent = brute_exponent(point, triangle, xyz);
    const Integer3 origin = scaled(point, exponent);
    const Integer3 direction = has_position ? scaled(xyz, exponent) - origin : scaled(xyz, exponent);
    const auto t = meeting_parameter(origin, direction, scaled_vertices(triangle, exponent), exponent);
    if (!t || t->numerator.sign() <= 0) return false;
    return !has_position || t->numerator < t->denominator;
}

bool is_facing_by_the_contract(const Triangle& triangle, const std::array<float, 4>& light, const Float3& eye) {
    const Float3 xyz{light[0], light[1], light[2]};
    const int exponent = common_exponent({eye, triangle[0], triangle[1], triangle[2], xyz});
    const auto vertex = scaled_vertices(triangle, exponent);
    const Integer3 normal = cross(vertex[1] - vertex[0], vertex[2] - vertex[0]);
    const Integer3 towards = light[3] == 0 ? scaled(xyz, exponent) : scaled(xyz, exponent) - vertex[0];
    return dot(normal, scaled(eye, exponent) - vertex[0]).sign() * dot(normal, towards).sign() > 0;
}

}  // namespace

std::vector<std::uint8_t> shadowed_by_brute_force(std::span<const float> triangles, std::span<const float> points,
                                                  std::span<const std::uint32_t> receivers,
                                                  const std::array<float, 4>& light,
                                                  const std::optional<std::array<float, 3>>& eye, const Masks* masks) {
    check_arguments(triangles, points, receivers, light);
    const std::size_t triangle_count = triangles.size() / 9;
    const auto decide = [&](std::size_t i) {
        const Float3 point = point_at(points, i);
        if (!is_finite(point)) return false;
        const std::uint32_t receiver = receivers.empty() ? NO_RECEIVER : receivers[i];
        if (eye && receiver < triangle_count && is_finite(triangle_at(triangles, receiver)) &&
            !is_facing_by_the_contract(triangle_at(triangles, receiver), light, *eye))
            return true;
        for (std::size_t id = 0; id < triangle_count; ++id) {
            const Triangle triangle = triangle_at(triangles, id);
            if (id != receiver && is_finite(triangle) && blocks_by_the_contract(point, light, triangle) &&
                (masks == nullptr ||
                 masks->is_opaque(static_cast<std::uint32_t>(id), triangle, Ray::to_light(point, light))))
                return true;
        }
        return false;
    };
    std::vector<std::uint8_t> result(points.size() / 3);
    for_chunks(result.size(), 4, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) result[i] = decide(i);
    });
    return result;
}

std::optional<NearestByBruteForce> nearest_by_brute_force(std::span<const float> triangles, const Ray& ray) {
    std::optional<NearestByBruteForce> nearest;
    for (std::size_t id = 0; id < triangles.size() / 9; ++id) {
        const Triangle triangle = triangle_at(triangles, id);
        if (!is_finite(triangle)) continue;
        const Integer3 direction{Integer(ray.pixel[0]), Integer(ray.pixel[1]), Integer(ray.pixel[2])};
        const auto t = meeting_parameter(scaled(ray.origin, FINEST_EXPONENT), direction,
                                         scaled_vertices(triangle, FINEST_EXPONENT), FINEST_EXPONENT);
        if (!t || t->numerator.sign() <= 0) continue;
        const int order =
            nearest
                ? (t->numerator * nearest->parameter.denominator).compare(nearest->parameter.numerator * t->denominator)
                : -1;
        if (order > 0) continue;
        if (order < 0) nearest = NearestByBruteForce{{}, *t};
        nearest->ids.push_back(static_cast<std::uint32_t>(id));
    }
    return nearest;
}

}  // namespace reference
