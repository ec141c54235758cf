// SPDX-License-Identifier: MIT
// Stage horizons: lights of sectors decided by the horizon of a height field (kernels/horizons/horizons.h), before
// beams decide what stays open.
#pragma once

#include "horizons/height_field.hpp"
#include "kernels/horizons/horizons.h"
#include "lights/many_lights.hpp"

namespace gnomon {

/// Masks of some points, row by row for each bundle. All three buffers have a word for each mask.
struct HorizonMasks {
    const cl::Buffer& masks;   ///< the lights that a point faces; then those that are open
    const cl::Buffer& lit;     ///< the lights that reach the point for certain
    const cl::Buffer& begins;  ///< float32: how far along the ground the open lights' rays meet nothing
    cl_uint bundle_count;
    cl_uint stride;  ///< words of a row
};

class Horizons {
public:
    /// `bundles`: make_sector_bundles() of the run's lights, around the field's axis.
    Horizons(const LightsRun& run, const SortedPoints& sorted, const BuiltHeightField& field,
             const LightBundles& bundles, Statistics& statistics);

    /// `points`: a part of the sorted points. Of the lights in the masks leaves those that it cannot decide.
    void decide(const PointsLayout& points, const HorizonMasks& masks);
    /// Adds to the masks the lights that decide() found to reach the points.
    void join(const PointsLayout& points, const HorizonMasks& masks);

private:
    HorizonParams params_of(const PointsLayout& points, const HorizonMasks& masks) const;

    const LightsRun& run_;
    const SortedPoints& sorted_;
    const BuiltHeightField& field_;
    cl::Session& session_;
    Statistics& statistics_;
    cl::Buffer sectors_, steps_;
};

}  // namespace gnomon
