// SPDX-License-Identifier: MIT
// Stage camera: visibility buffer and shading points (kernels/camera.h, kernels/camera.cl). look() and read() of
// gnomon.hpp are its face.
#pragma once

#include "../kernels/projection.h"
#include "inputs.hpp"

namespace gnomon {

/// The camera as kernels take it: a projection to pixels and the table of exact rays.
struct CameraTables {
    Projection projection;
    std::vector<float> rays;  ///< RAY_FLOATS per column, then per row
};
CameraTables camera_tables(const Camera& camera, std::uint32_t width, std::uint32_t height);

/// Unit geometric normals facing the camera, 3 floats per pixel, packed; sky: 0.
cl::Buffer camera_normals(const Device& device, const Triangles& triangles, const View& view);

}  // namespace gnomon
