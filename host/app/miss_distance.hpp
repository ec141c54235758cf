// SPDX-License-Identifier: MIT
// By how much a shadow ray misses a triangle.
#pragma once

#include <gnomon.hpp>

namespace gnomon::app {

/// The least distance between a triangle and the shadow ray from `point` to `light`. In doubles, so rounded: the exact
/// signs say that the ray misses.
double miss_distance(const TriangleSigns& triangle, const Float3& point, const Light& light);

/// Sorts triangles that the shadow ray misses by this distance.
void sort_by_miss_distance(std::vector<TriangleSigns>& triangles, const Float3& point, const Light& light);

}  // namespace gnomon::app
