// SPDX-License-Identifier: MIT
// Exact truth for the bounds that a triangle's record gives for a point (kernels/occluders/triangle_setup.h), and the
// real map that a projection's floats approximate.
#pragma once

#include "kernels/simd/projection.h"
#include "light_stages.hpp"
#include "reference/stages/grid_map.hpp"

namespace support {

/// The facts that the contract of TriangleRecord names, for the ray of a light through a point.
struct ExactPair {
    bool covers;  ///< the ray through the point meets the closed triangle (before or after the point)
    bool nearer;  ///< the point is strictly nearer to the light than the triangle's plane
    bool behind;  ///< strictly farther
    bool blocks;  ///< the visibility contract
};

inline ExactPair exact_pair(const reference::Triangle& t, const reference::Float3& p,
                            const std::array<float, 4>& light) {
    reference::Effort effort;
    const reference::Float3 xyz{light[0], light[1], light[2]};
    const reference::Ray ray = reference::Ray::to_light(p, light);
    ExactPair pair{};
    pair.blocks = reference::blocks(ray, t, effort);
    const int side_point = reference::side_of_point(p, t, effort);
    if (light[3] == 0) {
        pair.covers = reference::covering_orientation(ray, t, effort) != 0;
        const int along = reference::side_of_direction(xyz, t, effort);
        pair.behind = side_point * along > 0;
        pair.nearer = side_point * along < 0;
    } else {
        // This ray starts at the light: no triangle behind the light lies on it.
        const reference::Ray from_light = reference::Ray::to_light(xyz, {p[0], p[1], p[2], 1});
        const int orientation = reference::covering_orientation(from_light, t, effort);
        const int side_light = reference::side_of_point(xyz, t, effort);
        pair.covers = orientation != 0 && orientation == side_light;
        pair.behind = side_point * side_light < 0;
        pair.nearer = side_point * side_light > 0;
    }
    return pair;
}

/// The real map that the projection's floats approximate (kernels/simd/projection.h), for a light's frame.
inline reference::GridMap real_map(const gnomon::Projection& p) {
    const reference::Float3 center{p.center[0], p.center[1], p.center[2]};
    if (p.perspective != 0) {
        std::array<reference::Wide3, 3> rows;
        for (int i = 0; i < 3; ++i) rows[0][i] = p.row_x[i], rows[1][i] = p.row_y[i], rows[2][i] = p.row_z[i];
        return reference::GridMap::perspective(center, rows);
    }
    int axis = 0;
    while (p.row_z[axis] == 0) ++axis;
    return reference::GridMap::parallel({p.light[0], p.light[1], p.light[2]}, axis, center,
                                        {p.row_x[(axis + 1) % 3], p.row_y[(axis + 2) % 3]}, {p.row_x[3], p.row_y[3]});
}

}  // namespace support
