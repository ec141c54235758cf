// SPDX-License-Identifier: MIT
// What of a table of suns reaches points, and its colours.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "color_scale.hpp"
#include "options.hpp"
#include "suns.hpp"

namespace gnomon::app {

struct SunSums {
    std::vector<double> values;  ///< one per point, in the unit of the table's weights
    Statistics statistics;
};

/// For each point the weights of the suns that reach it. `run`: its facing must be by normals for cosines.
SunSums sun_sums(const HoursOptions& options, Technique& technique, const Triangles& triangles, const Points& points,
                 const SunTable& table, const RunOptions& run);

/// Sets NaN where a camera's points show the sky.
void leave_sky_out(std::span<const std::uint32_t> receivers, std::span<double> values);

/// From 0 to what the options say, or to the largest value.
ColorScale scale_of(const HoursOptions& options, std::span<const double> values);

double largest_of(std::span<const double> values);

}  // namespace gnomon::app
