// SPDX-License-Identifier: MIT
// The oracle: which points are in shadow, by the visibility contract, decided in exact arithmetic.
//
// A point is in shadow when some triangle other than its receiver meets the open ray from the point towards the light
// (for a position: strictly between). Triangles are closed; edge-on ones, ones of zero area, and ones whose plane
// holds the point do not block; ones with a NaN or infinite vertex are left out. With an eye, a point whose receiver's
// plane does not have the light strictly on the eye's side is in shadow by definition (an eye in the plane included).
// A point with a NaN or infinite coordinate is absent, and lit. A receiver that is no triangle, or one that is left
// out, excludes nothing and has no plane.
//
// Shares no code with the product. Cost: 2 million points on a scene of 262,267 triangles take seconds on 2 cores.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace reference {

class Bvh;
struct Masks;

inline constexpr std::uint32_t NO_RECEIVER = 0xFFFFFFFFu;

/// What shadowed() did. absent + facing_away + lit + shadowed is the number of points.
struct VisibilityCounts {
    std::uint64_t absent = 0;
    std::uint64_t facing_away = 0;
    std::uint64_t lit = 0;
    std::uint64_t shadowed = 0;         ///< by a triangle; facing away is not among them
    std::uint64_t decided_exactly = 0;  ///< points for which the double filter did not do
    std::uint64_t signs = 0;            ///< signs asked for
    std::uint64_t exact_signs = 0;      ///< those that took integers

    VisibilityCounts& operator+=(const VisibilityCounts& other);
};

/// 1 per point in shadow, else 0, computed on all hardware threads.
/// triangles: 9 floats each. points: 3 floats each. receivers: one per point, or none at all. light: (x, y, z, w) with
/// w = 0: minus the direction of travel, else the position. Throws std::invalid_argument for sizes that do not match
/// or a light that is not finite.
std::vector<std::uint8_t> shadowed(std::span<const float> triangles, std::span<const float> points,
                                   std::span<const std::uint32_t> receivers, const std::array<float, 4>& light,
                                   const std::optional<std::array<float, 3>>& eye = std::nullopt,
                                   VisibilityCounts* counts = nullptr, const Masks* masks = nullptr);

/// The same for many questions about the same triangles: `bvh` must be theirs.
std::vector<std::uint8_t> shadowed(const Bvh& bvh, std::span<const float> triangles, std::span<const float> points,
                                   std::span<const std::uint32_t> receivers, const std::array<float, 4>& light,
                                   const std::optional<std::array<float, 3>>& eye = std::nullopt,
                                   VisibilityCounts* counts = nullptr);

/// The same answer from the words of the contract alone: every triangle, exact rationals, no tree, no filter.
std::vector<std::uint8_t> shadowed_by_brute_force(std::span<const float> triangles, std::span<const float> points,
                                                  std::span<const std::uint32_t> receivers,
                                                  const std::array<float, 4>& light,
                                                  const std::optional<std::array<float, 3>>& eye = std::nullopt,
                                                  const Masks* masks = nullptr);

}  // namespace reference
