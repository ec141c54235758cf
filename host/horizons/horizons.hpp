// SPDX-License-Identifier: MIT
// Stage horizons: decides the lights of sectors by the horizon of a height field (kernels/horizons/horizons.h). Beams
// decide the lights that stay open.
#pragma once

#include "horizons/height_field.hpp"
#include "kernels/horizons/horizons.h"
#include "lights/many_lights.hpp"

namespace gnomon {

/// The masks of a part's points: a row for each bundle. All three buffers have a word for each mask.
struct HorizonMasks {
    const cl::Buffer& masks;   ///< the lights that a point faces; after decide() the open ones
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

    /// `points`: a part of the sorted points. Removes the lights that it decides from the masks.
    void decide(const PointsLayout& points, const HorizonMasks& masks);

private:
    const LightsRun& run_;
    const SortedPoints& sorted_;
    const BuiltHeightField& field_;
    cl::Session& session_;
    Statistics& statistics_;
    cl::Buffer sectors_, steps_;
};

}  // namespace gnomon
