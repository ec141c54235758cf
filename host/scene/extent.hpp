// SPDX-License-Identifier: MIT
// Places beside the triangles that float32 moves: cameras, lamps, points of a table.
#pragma once

#include <array>

#include "scene.hpp"

namespace gnomon::scene {

/// Where a scene's finite triangles lie, for the places beside them that float32 may move.
class Extent {
public:
    explicit Extent(const Scene& scene);
    /// How far float32 moves a coordinate of this place, if a scene of this extent can show it; else 0.
    double visible_move(const std::array<double, 3>& place) const;

private:
    double largest_side_ = 0;
    std::array<double, 3> middle_{};
};

}  // namespace gnomon::scene
