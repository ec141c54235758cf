// SPDX-License-Identifier: MIT
#include "sun_sums.hpp"

#include <cmath>
#include <limits>

namespace gnomon::app {

SunSums sun_sums(const HoursOptions& options, Technique& technique, const Triangles& triangles, const Points& points,
                 const SunTable& table, const RunOptions& run) {
    if (table.suns.empty()) return {std::vector<double>(points.count(), 0.0), {}};  // a polar night
    LightsOnHost found = run_light_table_to_host(technique, triangles, points, table.lights(),
                                                 {.sums = true, .cosines = options.cosines}, run);
    for (double& sum : found.sums) sum /= table.weights_per_unit();
    return {std::move(found.sums), std::move(found.statistics)};
}

void leave_sky_out(std::span<const std::uint32_t> receivers, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (receivers[i] == no_receiver) values[i] = std::numeric_limits<double>::quiet_NaN();
}

double largest_of(std::span<const double> values) {
    double largest = 0;
    for (const double value : values)
        if (value > largest) largest = value;
    return largest;
}

ColorScale scale_of(const HoursOptions& options, std::span<const double> values) {
    return {0, options.most.value_or(largest_of(values)), options.unit};
}

}  // namespace gnomon::app
