// SPDX-License-Identifier: MIT
// Numbers that files write where they have no data: the one list of tables, meshes, weights, places and heights, in C++
// and in Python. Quantized positions of 16 bits or fewer use all numbers, and are not asked.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace gnomon::scene {

/// As a height they stand for no data wherever they occur, as a coordinate or a weight where they are alone.
inline constexpr std::array no_data{-9999.0, -99999.0, -999999.0, -32768.0, -32767.0, -2147483648.0, -1e20, 1e20};
/// A coordinate may have these values. A height or a weight of them stands for no data where it is alone.
inline constexpr std::array no_data_beside_places{
    -99.0,    -99.9,   -99.99,   -99.999,   -999.0, -999.9,  -999.99,
    -999.999, -9999.9, -9999.99, -9999.999, 9999.0, 99999.0, 999999.0,
};

struct NoData {
    std::size_t row, column;
};

/// Most numbers, with which a look at all values ends at once, cannot stand for no data.
constexpr bool may_stand_for_no_data(double number) { return !(number > -9998.0 && number < 1e19); }

/// Of places, rows of two or three coordinates: the first coordinate that stands for no data. It is alone if no other
/// value of its column is on its side of 0 and from half to twice as far out, and none is within 1 of its mirror image
/// on the other side; if its column has no other value, none of all columns. Values of 1e30 or more stand for no data
/// if two of a row are the same and all else is less than half as far out.
template <typename Value>
std::optional<NoData> first_absent_place(std::span<const Value> values, std::size_t columns);

/// The first weight that stands for no data. It is alone if no other is on its side of 0 and at least half as far out.
/// Weights of 1e30 or more can stand for no data, too.
std::optional<std::size_t> first_absent_weight(std::span<const double> weights);

}  // namespace gnomon::scene
