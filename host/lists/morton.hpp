// SPDX-License-Identifier: MIT
// The grid of Morton codes over a box (kernels/lists/morton.h).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "kernels/lists/morton.h"

namespace gnomon {

struct CoordinateBounds {
    std::array<double, 3> low, high;
    /// The largest magnitude of a coordinate.
    float largest() const;
};

/// The box of three minima and three maxima, which kernels store as keys of floats (float_to_key). No value if the
/// first key is still GN_NO_ID: the kernel found no position.
std::optional<CoordinateBounds> bounds_of_keys(std::span<const std::uint32_t> keys);

/// 2^bits cells per axis over the box; one cell if all of it is one position.
MortonGrid morton_grid(const std::array<double, 3>& low, const std::array<double, 3>& high, unsigned bits);

}  // namespace gnomon
