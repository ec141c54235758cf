// SPDX-License-Identifier: MIT
// What a renderer usually does: Moeller and Trumbore 1997 in float32, without a bound and without a second opinion.
// The stress suite counts how often it is wrong.
#pragma once

#include "reference/predicates.hpp"

namespace stress {

struct PlainRay {
    reference::Float3 origin, direction;
    float last;  ///< parameter of the light

    static PlainRay to_light(const reference::Float3& p, const std::array<float, 4>& light) {
        if (light[3] == 0) return {p, {light[0], light[1], light[2]}, std::numeric_limits<float>::infinity()};
        return {p, {light[0] - p[0], light[1] - p[1], light[2] - p[2]}, 1};
    }
};

inline reference::Float3 plain_difference(const reference::Float3& a, const reference::Float3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline reference::Float3 plain_cross(const reference::Float3& a, const reference::Float3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline float plain_dot(const reference::Float3& a, const reference::Float3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline bool plain_blocks(const PlainRay& ray, const reference::Triangle& t) {
    const reference::Float3 ab = plain_difference(t[1], t[0]), ac = plain_difference(t[2], t[0]);
    const reference::Float3 across = plain_cross(ray.direction, ac);
    const float determinant = plain_dot(ab, across);
    if (determinant == 0) return false;
    const reference::Float3 from_a = plain_difference(ray.origin, t[0]);
    const float u = plain_dot(from_a, across) / determinant;
    if (!(u >= 0 && u <= 1)) return false;
    const reference::Float3 beside = plain_cross(from_a, ab);
    const float v = plain_dot(ray.direction, beside) / determinant;
    if (!(v >= 0 && u + v <= 1)) return false;
    const float distance = plain_dot(ac, beside) / determinant;
    return distance > 0 && distance < ray.last;
}

}  // namespace stress
