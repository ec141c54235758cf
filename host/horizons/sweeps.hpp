// SPDX-License-Identifier: MIT
// Stage sweeps: decides the lights of points at a raster's vertices (kernels/horizons/sweeps.h). Beams decide the
// lights that stay open.
#pragma once

#include <span>

#include "horizons/horizons.hpp"
#include "horizons/raster.hpp"

namespace gnomon {

/// The vertices at which the sorted points of a run are.
struct RasterPoints {
    cl::Buffer vertices;    ///< a word for each sorted point
    std::size_t count = 0;  ///< points at vertices
};
RasterPoints points_on(const BuiltRaster& raster, const LightsRun& run, const SortedPoints& sorted);

class Sweeps {
public:
    Sweeps(const LightsRun& run, const BuiltRaster& raster, const RasterPoints& at, Statistics& statistics);
    /// The bytes that the answers of a light take at most.
    static std::size_t bytes_of_light(const BuiltRaster& raster, const cl::Session& session);

    /// Decides the lights of the bundles for all vertices of the raster.
    void sweep(const LightBundles& bundles);
    /// `points`: a part of the sorted points. Removes the lights that are decided from the masks.
    void decide(const PointsLayout& points, const HorizonMasks& masks);

private:
    cl::Session& session_;
    const BuiltRaster& raster_;
    const RasterPoints& at_;
    Statistics& statistics_;
    cl::Buffer sweeps_, numbers_, answers_;
};

}  // namespace gnomon
