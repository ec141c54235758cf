// SPDX-License-Identifier: MIT
// Whether a frame draws a conservative map. The choice affects time alone.
#pragma once

#include <array>

#include "kernels/simd/frame_counters.h"
#include "occluders/occluder_lists.hpp"
#include "receivers/light_frame.hpp"

namespace gnomon {

enum class MapMode { on, off, automatic };

/// On a GPU: true if a frame with a map and these counts took less time than one without.
bool map_was_worth_drawing(const FrameCounters& counted);

/// The number of points that memory and maps go by. How many slots of footprints are used depends on threads.
inline std::size_t expected_count(const PointInputs& points) {
    return points.footprints != nullptr ? points.expected_footprints : points.layout.count;
}

class MapChoice {
public:
    explicit MapChoice(const cl::Session& session) : session_(session) {}
    void set(MapMode mode) { mode_ = mode; }

    /// False: no frame of these points draws a map.
    bool may_draw(const PointInputs& points) const;
    /// For the next frame.
    ListSettings list_settings(const PointInputs& points, cl_uint frame, CoverTest cover_test) const;
    /// After a frame with these settings.
    void note(const PointInputs& points, cl_uint frame, bool drew_map, const FrameCounters& counted);

private:
    bool goes_by_last_map(const PointInputs& points) const;

    const cl::Session& session_;
    MapMode mode_ = MapMode::automatic;
    /// On a GPU, by frame: runs that leave the map out, since the last one decided too few points.
    std::array<std::uint32_t, POINT_LIGHT_FRAMES> runs_without_map_{};
};

}  // namespace gnomon
