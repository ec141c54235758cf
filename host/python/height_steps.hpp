// SPDX-License-Identifier: MIT
// Heights of a raster as whole steps below a common bending, in one pass over its memory on several threads.
#pragma once

#include <cstdint>
#include <span>

namespace gnomon::python {

/// The least and the greatest finite height; infinity and -infinity where there is none.
struct HeightRange {
    double low, high;
};
template <typename Height>
HeightRange range_of(std::span<const Height> heights);

/// A height becomes floor((height - base - per_square * (across + along)) / 2^exponent + 1 / 2) steps, each operation
/// rounded to double; one that is not finite NO_HEIGHT.
struct Rounding {
    double base, per_square;
    std::span<const double> across, along;  ///< squared distances from the centre: of columns, of rows
    int exponent;
};

/// Writes the steps of rows x columns heights, all of them below 2^31, and whether each is absent. Returns the largest
/// distance by which a height moved.
template <typename Height>
double round_heights(std::span<const Height> heights, const Rounding& rounding, std::span<std::int32_t> steps,
                     std::span<bool> absent);

}  // namespace gnomon::python
