// SPDX-License-Identifier: MIT
// The grid of Morton codes over a box (kernels/lists/morton.h).
#pragma once

#include <array>

#include "kernels/lists/morton.h"

namespace gnomon {

/// 2^bits cells per axis over the box; one cell if all of it is one position.
MortonGrid morton_grid(const std::array<double, 3>& low, const std::array<double, 3>& high, unsigned bits);

}  // namespace gnomon
