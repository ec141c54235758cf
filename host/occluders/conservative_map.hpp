// SPDX-License-Identifier: MIT
// Stage conservative_map: per texel, a height below which points are certainly in shadow
// (kernels/occluders/conservative_map.cl).
#pragma once

#include "kernels/occluders/conservative_map.h"
#include "occluders/triangle_setup.hpp"
#include "receivers/light_frame.hpp"

namespace gnomon {

// In the order of the constants' values in conservative_map.h.
enum class CoverTest : cl_uint { tight, circle, slope };
inline constexpr std::string_view cover_test_names[] = {"tight", "circle", "slope"};
inline constexpr const char* cover_test_help =
    "tight (Mizokuchi and Tokuyoshi), circle (Hertel et al. 2009) or slope (tight, with the slope-scaled depth of "
    "graphics hardware): when a texel counts as covered, and from which depth on";

class ConservativeMap {
public:
    /// `pyramid` (receiver_depth_pyramid): tiles without a point below the triangle are not drawn.
    void run(cl::Session& session, const LightFrame& frame, const cl::Buffer& projection, const TriangleSetup& setup,
             const cl::Buffer& pyramid, CoverTest cover_test, const cl::Buffer& counters);
    /// After the triangles' bounds: sets map_disabled in the projection if the map would decide too few points. Then
    /// run() draws no map, and no stage uses one.
    void judge(cl::Session& session, const cl::Buffer& projection, const cl::Buffer& counters);
    const cl::Buffer& map() const { return map_; }

private:
    cl::Buffer map_;
};

}  // namespace gnomon
