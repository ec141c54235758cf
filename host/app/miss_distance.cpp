// SPDX-License-Identifier: MIT
#include "miss_distance.hpp"

#include <algorithm>
#include <limits>

#include "query/vectors.hpp"

namespace gnomon::app {
namespace {

using glm::dvec3;

/// From `start` along `along`, whose multiples up to `longest` belong to it.
struct Ray {
    dvec3 start, along;
    double longest;

    dvec3 at(double s) const { return start + s * along; }
};

/// Distance between a ray and the edge from `a` to `b` (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
double distance_to_edge(const Ray& ray, const dvec3& a, const dvec3& b) {
    const dvec3 edge = b - a, apart = ray.start - a;
    const double rr = dot(ray.along, ray.along), re = dot(ray.along, edge), ee = dot(edge, edge);
    const double ra = dot(ray.along, apart), ea = dot(edge, apart), area = rr * ee - re * re;
    double s = area > 0 ? std::clamp((re * ea - ra * ee) / area, 0.0, ray.longest) : 0;
    const double t = ee > 0 ? std::clamp((re * s + ea) / ee, 0.0, 1.0) : 0;
    s = rr > 0 ? std::clamp((re * t - ra) / rr, 0.0, ray.longest) : 0;
    return distance(ray.at(s), a + t * edge);
}

/// Distance of an end of the ray to the triangle's plane, where it stands over the triangle; else infinite.
double distance_over(const dvec3& end, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 normal = cross(b - a, c - a);
    const auto is_inside = [&](const dvec3& from, const dvec3& to) {
        return dot(cross(to - from, end - from), normal) >= 0;
    };
    const double size = length(normal);
    if (!(size > 0) || !is_inside(a, b) || !is_inside(b, c) || !is_inside(c, a))
        return std::numeric_limits<double>::infinity();
    return std::abs(dot(end - a, normal)) / size;
}

}  // namespace

double miss_distance(const TriangleSigns& triangle, const Float3& point, const Light& light) {
    const float* const v = triangle.vertices.data();
    const dvec3 a = loaded(v), b = loaded(v + 3), c = loaded(v + 6), from = loaded(point);
    const bool is_far = light.is_directional();
    const dvec3 towards = loaded(light.xyzw.data());
    const Ray ray{from, is_far ? towards : towards - from, is_far ? std::numeric_limits<double>::max() : 1};
    double least = distance_over(from, a, b, c);
    if (!is_far) least = std::min(least, distance_over(towards, a, b, c));
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        least = std::min(least, distance_to_edge(ray, p, q));
    return least;
}

void sort_by_miss_distance(std::vector<TriangleSigns>& triangles, const Float3& point, const Light& light) {
    std::ranges::stable_sort(triangles, {}, [&](const TriangleSigns& t) { return miss_distance(t, point, light); });
}

}  // namespace gnomon::app
