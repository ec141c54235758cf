// SPDX-License-Identifier: MIT
// What receivers get of suns that reach them, times cosines, in whole units.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::python {

struct WeighedSun {
    std::array<double, 3> towards;
    double weight;  // from 0 to below 2^46 units
};

// For each receiver the sum over suns of weight x cosine, where it is positive, each product rounded once to whole
// units, half-way cases to even ones. planes: for 32 suns, then the next 32, a word a receiver whose bits say which
// suns count. normals: all x, then all y, then all z; empty: each sun counts in full.
std::vector<std::int64_t> energy_sums(std::span<const std::uint32_t> planes, std::span<const double> normals,
                                      std::size_t receivers, std::span<const WeighedSun> suns);

}  // namespace gnomon::python
