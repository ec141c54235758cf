// SPDX-License-Identifier: MIT
// Stage raster_triangles: implicit rasters (Raster of gnomon/inputs.hpp, RasterHead of kernels/simd/points.h) on the
// device, and their triangles, which are written out for stages that do not read rasters.
#pragma once

#include "query/inputs.hpp"

namespace gnomon {

class ImplicitRaster {
public:
    ImplicitRaster(const Device& device, const Raster& raster);

    std::uint32_t columns() const { return head_.columns; }  ///< of vertices
    std::uint32_t rows() const { return head_.rows; }
    std::size_t triangle_count() const { return 2 * std::size_t(columns() - 1) * (rows() - 1); }
    cl_mem memory() const { return static_cast<cl_mem>(memory_.get()); }
    /// Nine floats for each triangle, which the first call writes: 72 bytes for each square. Throws OutOfDeviceMemory.
    cl_mem vertices();

    /// The box of all vertices with a height. Without any, low[2] is infinite.
    const std::array<float, 3>& low() const { return low_; }
    const std::array<float, 3>& high() const { return high_; }
    float largest_coordinate() const;
    bool has_holes() const { return has_holes_; }  ///< some vertices have no height
    /// Row and column both rise along the diagonals, if both are counted in the direction of growing coordinates.
    bool is_rising() const { return (head_.joins_first_corner != 0) == (x_falls_ == y_falls_); }

private:
    Device device_;
    RasterHead head_{};
    std::shared_ptr<void> memory_, vertices_;
    std::array<float, 3> low_{}, high_{};
    bool has_holes_ = false, x_falls_ = false, y_falls_ = false;
};

/// As triangle_inputs(), but `vertices` is an implicit raster if the triangles are one: for the kernels of
/// TriangleInputs::flags().
TriangleInputs implicit_inputs(const Triangles& triangles);

}  // namespace gnomon
