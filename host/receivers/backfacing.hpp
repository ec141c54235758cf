// SPDX-License-Identifier: MIT
// Facing by normals, by winding or by the fans of vertices: a pass after the technique darkens the backfacing points
// (kernels/receivers/backfacing.h).
#pragma once

#include "query/inputs.hpp"

namespace gnomon {

/// Sets the visibility of the points that face away from the light by these sides to 0; other values stay. Launches
/// nothing where points face by an eye, which the technique itself decides, or by nothing. Call it after the technique
/// for the same points and light, whose checks it relies on.
void darken_backfacing(const Device& device, const Triangles& triangles, const Points& points,
                       const FacingInputs& sides, const Light& light, const Visibility& visibility);

}  // namespace gnomon
