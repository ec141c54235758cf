// SPDX-License-Identifier: MIT
// Stage surface: albedo and shading normal of each pixel (kernels/shading/surface.h). gnomon.hpp gives it the class
// Surfaces.
#pragma once

#include "camera/camera.hpp"
#include "kernels/shading/surface.h"

namespace gnomon {

/// What Surfaces keeps on the device.
struct Surfaces::Inside {
    Inside(const Device& on, const Points& of) : device(on), points(of) {}

    Device device;
    Points points;
    cl::Buffer geometric_normals;               ///< 3 floats per pixel, as camera_normals() makes them
    cl::Buffer triangle_material, base_colors;  ///< without detail
    cl::Buffer albedos, shading_normals;        ///< with detail: 3 floats per pixel
    cl::Buffer spreads;                         ///< with shading normals, a float per pixel: kernels/shading/surface.cl
    bool has_detail = false, has_shading_normals = false;
    std::uint64_t texture_bytes = 0;
    std::uint32_t left_out_levels = 0;

    /// The geometric ones where corners have none.
    const cl::Buffer& normals() const { return has_shading_normals ? shading_normals : geometric_normals; }
};

/// Bytes of a texture's levels from `first` on, 4 per texel.
std::uint64_t level_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t first = 0);

/// Writes the levels from `first` on, one behind the other, 4 bytes per texel: 8-bit sRGB and a weight. Each level is
/// the mean of the one before over the area of each texel, in linear light; unless `weighs_alpha`, all weights are 255.
/// A weight is never 0, so that a mean of clear texels has a colour.
void write_levels(const ColorTexture& texture, bool weighs_alpha, std::uint32_t first, std::uint8_t* out);

/// Linear light of the 256 values of 8-bit sRGB.
std::array<float, 256> linear_of_srgb();

}  // namespace gnomon
