// SPDX-License-Identifier: MIT
// Embree's answers to the same questions, where its package (libembree-dev) was there at build time.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "support/scene_makers.hpp"

namespace stress {

/// "Embree 3.13.5", or empty if this build has none.
std::string embree_version();

enum class EmbreeFlags { none, robust };

/// The answer of a ray that Embree does not take: beyond 1.844e18, or not finite.
inline constexpr std::uint8_t BEYOND_EMBREE = 2;

/// The triangles in Embree, built with or without its robust flag. Without Embree in the build nothing is ever asked.
class EmbreeScene {
public:
    EmbreeScene(std::span<const float> triangles, EmbreeFlags flags);
    ~EmbreeScene();

    /// 1 per point in shadow, 0 per lit one, or BEYOND_EMBREE, on all hardware threads. Rays start `offset` world units
    /// from their point; a point's receiver is passed over by a filter function, so Embree knows all that gnomon knows.
    std::vector<std::uint8_t> shadowed(std::span<const float> points, std::span<const std::uint32_t> receivers,
                                       const support::Light& light, double offset) const;

private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
};

}  // namespace stress
