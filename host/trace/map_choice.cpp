// SPDX-License-Identifier: MIT
#include "trace/map_choice.hpp"

#include <algorithm>

namespace gnomon {

// A map saves the walks of the points that it decides, and the references of the triangles that it hides, assumed to be
// as many per triangle as for the others. A reference costs what it costs in foliage on an H200; the other two
// constants are fitted to runs there with and without a map (docs/notebook/experiments.md).
bool map_was_worth_drawing(const FrameCounters& counted) {
    constexpr double us_per_point = 25e-6, us_per_reference = 82e-6, us_of_map = 40;
    const double listed = std::max(double(counted.survivors) - counted.edge_on - counted.hidden, 1.0);
    const double spared = counted.hidden * (counted.references / listed);
    return us_per_point * counted.decided_by_map + us_per_reference * spared >= us_of_map;
}

bool MapChoice::may_draw(const PointInputs& points) const {
    if (mode_ != MapMode::automatic) return mode_ == MapMode::on;
    return expected_count(points) >= 4096;  // fewer points than that cost less to trace than a map to clear
}

// A CPU estimates in each frame whether a map is worth its cost, between two kernels. On a GPU a map's launches take a
// tenth of a frame, whatever they draw, so the rule uses the counts of the last map.
bool MapChoice::goes_by_last_map(const PointInputs& points) const {
    return mode_ == MapMode::automatic && !session_.is_cpu() && points.footprints == nullptr;
}

ListSettings MapChoice::list_settings(const PointInputs& points, cl_uint frame, CoverTest cover_test) const {
    const bool judges_map = mode_ == MapMode::automatic && session_.is_cpu();
    const bool skips_map = goes_by_last_map(points) && runs_without_map_[frame] != 0;
    return {may_draw(points) && !skips_map, judges_map, cover_test};
}

// A GPU leaves out a map that saves less than it costs for some runs; then it draws and judges a map again.
void MapChoice::note(const PointInputs& points, cl_uint frame, bool drew_map, const FrameCounters& counted) {
    constexpr std::uint32_t runs_until_next = 31;
    if (!may_draw(points) || !goes_by_last_map(points)) return;
    if (!drew_map)
        --runs_without_map_[frame];
    else if (!map_was_worth_drawing(counted))
        runs_without_map_[frame] = runs_until_next;
}

}  // namespace gnomon
