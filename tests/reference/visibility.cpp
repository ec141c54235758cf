// SPDX-License-Identifier: MIT
// The oracle with its tree and filter. See visibility.hpp for the contract, predicates.hpp and bvh.hpp for the proofs.
#include "visibility.hpp"

#include <mutex>

#include "arguments.hpp"
#include "bvh.hpp"
#include "parallel.hpp"

namespace reference {
namespace {

/// Whether any triangle but the receiver blocks the ray.
bool is_blocked(const Bvh& bvh, const Ray& ray, std::uint32_t receiver, Effort& effort) {
    bool blocked = false;
    bvh.traverse(ray, [&](std::uint32_t id, const Triangle& triangle) {
        blocked = id != receiver && blocks(ray, triangle, effort) && bvh.is_opaque(id, triangle, ray);
        return blocked ? -1 : ray.last_parameter;
    });
    return blocked;
}

}  // namespace

VisibilityCounts& VisibilityCounts::operator+=(const VisibilityCounts& other) {
    absent += other.absent;
    facing_away += other.facing_away;
    lit += other.lit;
    shadowed += other.shadowed;
    decided_exactly += other.decided_exactly;
    signs += other.signs;
    exact_signs += other.exact_signs;
    return *this;
}

std::vector<std::uint8_t> shadowed(std::span<const float> triangles, std::span<const float> points,
                                   std::span<const std::uint32_t> receivers, const std::array<float, 4>& light,
                                   const std::optional<std::array<float, 3>>& eye, VisibilityCounts* counts,
                                   const Masks* masks) {
    return shadowed(Bvh(triangles, masks), triangles, points, receivers, light, eye, counts);
}

std::vector<std::uint8_t> shadowed(const Bvh& bvh, std::span<const float> triangles, std::span<const float> points,
                                   std::span<const std::uint32_t> receivers, const std::array<float, 4>& light,
                                   const std::optional<std::array<float, 3>>& eye, VisibilityCounts* counts) {
    check_arguments(triangles, points, receivers, light);
    const std::size_t triangle_count = triangles.size() / 9;
    std::vector<std::uint8_t> result(points.size() / 3, 0);
    VisibilityCounts total;
    std::mutex mutex;

    const auto decide = [&](std::size_t i, VisibilityCounts& local) {
        const Float3 point = point_at(points, i);
        if (!is_finite(point)) return ++local.absent, false;
        const std::uint32_t receiver = receivers.empty() ? NO_RECEIVER : receivers[i];
        Effort effort;
        bool facing = true;
        if (eye && receiver < triangle_count) {
            const Triangle plane = triangle_at(triangles, receiver);
            facing = !is_finite(plane) || is_facing(plane, light, *eye, effort);
        }
        const bool blocked = facing && is_blocked(bvh, Ray::to_light(point, light), receiver, effort);
        ++(!facing ? local.facing_away : blocked ? local.shadowed : local.lit);
        local.decided_exactly += effort.exact_signs > 0;
        local.signs += effort.signs;
        local.exact_signs += effort.exact_signs;
        return !facing || blocked;
    };
    for_chunks(result.size(), 1024, [&](std::size_t first, std::size_t last) {
        VisibilityCounts local;
        for (std::size_t i = first; i < last; ++i) result[i] = decide(i, local);
        const std::lock_guard lock(mutex);
        total += local;
    });
    if (counts) *counts = total;
    return result;
}

}  // namespace reference
