// SPDX-License-Identifier: MIT
// What the exact path costs on real scenes: its share of the time of trace and exact_trace together.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stress {

struct ExactPathRow {
    std::string scene, view, light;
    double trace_ms = 0, exact_ms = 0, all_ms = 0;  ///< the stages' device times, the least of 15 runs each
    std::uint64_t points = 0, open_pairs = 0, by_integers = 0;
};

/// Views of Sponza and lost_empire at 1920 x 1080, under their own lights and, for lost_empire, under lights that make
/// exact ties.
std::vector<ExactPathRow> exact_path_costs(std::string_view device);

}  // namespace stress
