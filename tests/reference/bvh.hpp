// SPDX-License-Identifier: MIT
// A tree of boxes that hands out the triangles a ray may meet. It only prunes, and only conservatively.
//
// Boxes are the exact float32 bounds of their triangles: minimum and maximum do not round. Triangles with a NaN or
// infinite vertex are left out. The box test is the usual slabs in double with outward slack:
// per axis q = (plane - o) / r is computed as (plane - o) * (1 / r) with r itself rounded once, so with at most 4
// roundings: |computed - q| <= 4.1 u |q|, u = 2^-53; no underflow or overflow (all lie between 2^-278 and 2^278).
// If the box is met at a parameter t, 0 < t <= last, then near_i <= t <= far_i on every axis, so the computed
//   near = max(0, near_i) <= t (1 + 4.1 u)    and    far = min(last, far_i) >= t (1 - 4.1 u),
// hence near <= far (1 + 9 u), and such boxes are never pruned: the test is near <= far * (1 + 2^-49), whose product
// is at least far (1 + 14 u). An axis with r = 0 (exactly: a difference of floats is 0 in double only if it is 0) is
// compared without arithmetic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "masks.hpp"
#include "predicates.hpp"

namespace reference {

class Bvh {
public:
    /// `triangles`: 9 floats each. With masks, which must outlive this, questions are about triangles with holes.
    explicit Bvh(std::span<const float> triangles, const Masks* masks = nullptr);

    /// Whether the triangle, which the ray meets, is opaque there.
    bool is_opaque(std::uint32_t id, const Triangle& triangle, const Ray& ray) const {
        return masks_ == nullptr || masks_->is_opaque(id, triangle, ray);
    }

    /// Calls visit(id, triangle) for every triangle that the ray may meet at a parameter in (0, last], roughly from
    /// near to far, and possibly for others. `last` starts as the ray's last parameter; visit returns the new one,
    /// which must not be below any parameter still of interest (negative: stop).
    template <typename Visit>
    void traverse(const Ray& ray, Visit visit) const;

    /// Triangles that are not left out.
    std::size_t count() const { return ids_.size(); }

private:
    struct Node {
        Float3 low, high;
        std::uint32_t first;  ///< leaf: the first triangle; else the left child, the right one follows it
        std::uint32_t count;  ///< leaf: its triangles; else 0
    };
    struct Slabs {
        Double3 origin, inverse;
        std::array<bool, 3> is_constant;
    };

    struct Builder;
    static bool may_meet(const Node& node, const Slabs& slabs, double last, double& near);

    /// Median splits below MAX_SURFACE_DEPTH levels halve the rest, so 32 more levels are always enough.
    static constexpr std::uint32_t MAX_SURFACE_DEPTH = 48;
    static constexpr std::uint32_t MAX_DEPTH = MAX_SURFACE_DEPTH + 33;

    std::vector<Node> nodes_;
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> ids_;
    const Masks* masks_ = nullptr;
};

inline bool Bvh::may_meet(const Node& node, const Slabs& slabs, double last, double& near) {
    near = 0;
    double far = last;
    for (int i = 0; i < 3; ++i) {
        if (slabs.is_constant[i]) {
            if (slabs.origin[i] < node.low[i] || slabs.origin[i] > node.high[i]) return false;
            continue;
        }
        const double at_low = (node.low[i] - slabs.origin[i]) * slabs.inverse[i];
        const double at_high = (node.high[i] - slabs.origin[i]) * slabs.inverse[i];
        near = std::max(near, std::min(at_low, at_high));
        far = std::min(far, std::max(at_low, at_high));
    }
    return near <= far * (1 + 0x1p-49);
}

template <typename Visit>
void Bvh::traverse(const Ray& ray, Visit visit) const {
    if (nodes_.empty()) return;
    Slabs slabs{};
    for (int i = 0; i < 3; ++i) {
        slabs.origin[i] = ray.origin[i];
        slabs.is_constant[i] = ray.direction[i] == 0;
        slabs.inverse[i] = slabs.is_constant[i] ? 0 : 1 / ray.direction[i];
    }
    double last = ray.last_parameter;
    struct Pending {
        std::uint32_t node;
        double near;
    };
    std::array<Pending, MAX_DEPTH + 1> stack;
    std::size_t height = 0;
    double near = 0;
    if (may_meet(nodes_[0], slabs, last, near)) stack[height++] = {0, near};
    while (height > 0) {
        const Pending pending = stack[--height];
        if (pending.near > last * (1 + 0x1p-49)) continue;
        const Node& node = nodes_[pending.node];
        if (node.count > 0) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                last = visit(ids_[i], triangles_[i]);
                if (last < 0) return;
            }
            continue;
        }
        double near_left = 0, near_right = 0;
        const bool left = may_meet(nodes_[node.first], slabs, last, near_left);
        const bool right = may_meet(nodes_[node.first + 1], slabs, last, near_right);
        const bool left_last = near_left > near_right;
        if (left && left_last) stack[height++] = {node.first, near_left};
        if (right) stack[height++] = {node.first + 1, near_right};
        if (left && !left_last) stack[height++] = {node.first, near_left};
    }
}

}  // namespace reference
