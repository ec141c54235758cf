// SPDX-License-Identifier: MIT
// Stages appearance and surface: what triangles look like, on the device, and albedo and shading normal of each pixel
// (kernels/shading/surface.h). gnomon.hpp gives them the classes Appearance and Surfaces.
#pragma once

#include "camera/camera.hpp"
#include "cl/embedded_files.hpp"
#include "kernels/shading/mip_levels.h"
#include "kernels/shading/surface.h"

namespace gnomon {

/// A program that has surfaces has their kernels before it makes its first program for a device.
[[maybe_unused]] inline const bool shading_is_embedded = add_embedded_kernels(embedded_kernels_of_shading());

/// Which textures, and whether alpha weighs their texels: a texture whose texels it weighs is another one.
using TextureKeys = std::vector<std::pair<std::uint32_t, bool>>;

/// Where a texture's levels lie, and the sides of the first.
struct TexturePlace {
    std::uint64_t first_texel;
    std::uint32_t width, height;
};

/// Textures on the device, with their levels.
struct SurfaceTextures::OnDevice {
    Device device;
    TextureKeys keys;
    std::vector<const std::uint8_t*> sources;  ///< of all textures
    std::vector<TexturePlace> places;          ///< by key
    cl::Buffer texels;
    std::uint64_t bytes = 0;
    std::uint32_t left_out = 0;  ///< the finest levels of all textures

    /// Leaves out as many levels, up to the most, as it must. Throws OutOfDeviceMemory.
    OnDevice(const Device& on, TextureKeys shown, std::span<const ColorTexture> all, std::uint32_t max_left_out);

    static std::vector<const std::uint8_t*> sources_of(std::span<const ColorTexture> all);

private:
    void upload(std::span<const ColorTexture> all);
};

/// What triangles have, by slot, on the host: the caller's arrays, or those of shown triangles. Some may be empty.
struct SlotArrays {
    std::span<const std::uint32_t> material;
    std::span<const float> coordinates, colors;
    std::span<const std::uint32_t> normals;
};

/// The same on the device, with the materials: the inputs of the kernel of surfaces.
struct SurfaceArrays {
    SurfaceArrays(const Device& device, const SlotArrays& slots, const Materials& from, const SurfaceDetail& detail,
                  SurfaceTextures* kept, std::uint32_t max_left_out);

    cl::Buffer material, coordinates, colors, normals;
    cl::Buffer materials, linear_of_srgb;
    bool has_colors, has_normals;
    SurfaceTextures textures;
};

/// What shade() reads beside a view's surfaces.
struct ShadeTables {
    cl::Buffer srgb;
    cl::Buffer triangle_material, base_colors;  ///< without detail
};

/// The buffers of a picture, values per pixel. Those that only some pictures need have no memory until then.
struct SurfaceBuffers {
    cl::Buffer normals;           ///< 3 floats: shading normals; without corners' normals, the triangles'
    cl::Buffer albedos;           ///< with detail: 3 floats
    cl::Buffer spreads;           ///< with corners' normals: a float (kernels/shading/surface.cl)
    cl::Buffer lambert, picture;  ///< of shade()
    cl::Buffer sky_shares;
    cl::Buffer brightest, meter, meter_counts;  ///< of a metered exposure
};

struct Appearance::Inside {
    Device device;
    std::size_t count;  ///< of triangles
    std::shared_ptr<const ShadeTables> tables;
    std::shared_ptr<const SurfaceArrays> arrays;  ///< with detail
    std::shared_ptr<SurfaceBuffers> buffers;      ///< of the latest surfaces
};

/// What Surfaces keeps on the device.
struct Surfaces::Inside {
    Device device;
    Points points;
    std::shared_ptr<const ShadeTables> tables;
    std::shared_ptr<SurfaceBuffers> buffers;
    bool has_albedos, has_shading_normals;
    std::uint64_t texture_bytes;
    std::uint32_t left_out_levels;
};

/// Throws InvalidArgument if numbers and arrays do not fit together.
void require_surfaces(std::size_t triangles, const Materials& materials, const SurfaceDetail& detail);

/// Only the sRGB table where there is detail.
std::shared_ptr<const ShadeTables> shade_tables(const Device& device, const Materials& materials, bool has_detail);

/// Enqueues a view's surfaces. `arrays`: null without detail. `slots`: of each pixel in these arrays.
std::shared_ptr<const Surfaces::Inside> surfaces_of(const Device& device, const Triangles& triangles, const View& view,
                                                    std::shared_ptr<const ShadeTables> tables,
                                                    const SurfaceArrays* arrays, cl_mem slots,
                                                    std::shared_ptr<SurfaceBuffers> buffers);

inline bool has_detail(const SurfaceDetail& detail) {
    return !detail.texture_uses.empty() || !detail.corner_colors.empty() || !detail.corner_normals.empty();
}

/// The exposure at which most surfaces' pixels are no brighter than the light that the tone curve keeps
/// (kernels/shading/metering.h), by the lights in buffers.brightest. Waits.
double metered_ev(cl::Session& session, SurfaceBuffers& buffers, std::size_t pixels);

/// Bytes of a texture's levels from `first` on, 4 per texel.
std::uint64_t level_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t first = 0);

/// Writes the levels from `first` on, one behind the other (kernels/shading/mip_levels.h).
void write_levels(const ColorTexture& texture, bool weighs_alpha, std::uint32_t first, std::uint8_t* out);

/// The texels along a side of `from` texels whose mean are those along one of `to`.
std::vector<MipTaps> taps_of(std::uint32_t from, std::uint32_t to);
MipTables mip_tables();

/// Linear light of the 256 values of 8-bit sRGB.
std::array<float, 256> linear_of_srgb();

}  // namespace gnomon
