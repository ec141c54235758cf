// SPDX-License-Identifier: MIT
// Stage raster: height fields whose vertices stand in rows and columns (kernels/horizons/sweeps.h).
#pragma once

#include <vector>

#include "kernels/horizons/sweeps.h"
#include "query/inputs.hpp"

namespace gnomon {

class BuiltRaster {
public:
    BuiltRaster(const Device& device, const Triangles& triangles);

    /// True if the triangles are a raster and none of them is masked. If false, the other members are empty.
    bool is_raster() const { return diagonals_ != 0; }
    const Triangles& triangles() const { return triangles_; }
    const RasterParams& params() const { return params_; }
    std::size_t vertex_count() const { return std::size_t(params_.columns) * params_.rows; }
    /// Row and column both grow along the diagonals.
    bool is_rising() const { return diagonals_ == RASTER_RISES; }
    const RasterCopies& copies() const { return copies_; }
    const cl::Buffer& heights() const { return heights_; }
    const cl::Buffer& x() const { return x_; }
    const cl::Buffer& y() const { return y_; }
    const cl::Buffer& copied_heights() const { return copied_; }
    const cl::Buffer& tops() const { return tops_; }

    /// Between columns and between rows, in units of length.
    double spacing(std::size_t axis) const { return spacing_[axis]; }
    /// The greatest height above the lowest one.
    double highest() const { return highest_; }
    /// The greatest difference of heights between neighbouring columns and between neighbouring rows.
    double steepest(std::size_t axis) const { return steepest_[axis]; }
    /// The most by which a column or row is away from its place if all were equally far apart, in spacings.
    double unevenness() const { return unevenness_; }

private:
    bool take(const ImplicitRaster& implicit);
    bool set_places();
    bool find_vertices();
    void measure();
    void copy_heights();

    Device device_;
    Triangles triangles_;
    RasterParams params_{};
    RasterCopies copies_{};
    std::uint32_t diagonals_ = 0;
    cl::Buffer x_, y_, heights_, copied_, tops_, squares_;
    double spacing_[2]{}, steepest_[2]{}, highest_ = 0, unevenness_ = 0;
};

}  // namespace gnomon
