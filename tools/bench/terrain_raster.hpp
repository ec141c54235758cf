// SPDX-License-Identifier: MIT
// A made terrain as an elevation model: Triangles::raster() in place of its triangles. Its rows of vertices lie along
// x, one after the other along z, and y points up, where a raster's heights are along z: so all of the question is
// turned, (x, y, z) -> (x, -z, y), which rounds nothing. The answers stay the same bits.
#pragma once

#include <span>
#include <vector>

#include "gnomon/inputs.hpp"
#include "gnomon/lights.hpp"

namespace gnomon::bench {

/// Three floats for each point or vector.
std::vector<float> with_z_up(std::span<const float> with_y_up);
Lights with_z_up(const Lights& with_y_up);

/// Of a terrain's triangles with y up, as `make_scenes terrain` writes them. Throws InvalidArgument for others.
Triangles raster_of_terrain(const Device& device, std::span<const float> triangles);

}  // namespace gnomon::bench
