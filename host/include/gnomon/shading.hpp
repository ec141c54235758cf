// SPDX-License-Identifier: MIT
// Experimental: the colours of a view, materials, textures, light. Visibility does not depend on them.
#pragma once

#include <gnomon/view.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

/// Base colours for shade(): one material id per triangle, and linear RGB per material.
struct Materials {
    std::vector<std::uint32_t> triangle_material;
    std::vector<Float3> base_color;
};

/// An image of base colours: 8-bit sRGB with unassociated alpha, 4 bytes per texel, row by row; the first texel is at
/// (u, v) = (0, 0). Sides from 1 to 32768.
struct ColorTexture {
    std::uint32_t width = 0, height = 0;
    std::span<const std::uint8_t> rgba;
};
/// How texels smaller than pixels are filtered: over the pixel's area, through all levels of half the size (as
/// trilinear filters do, along the area's longer axis); or, at the pixel's centre alone, the bilinear mean of four
/// texels or the nearest one.
enum class TextureMinification : std::uint8_t { mean, linear, nearest };
/// How a material takes its texture. Its colours are filtered in linear light; `filter` is for texels larger than
/// pixels.
struct ColorTextureUse {
    std::uint32_t texture = no_texture;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    TextureFilter filter = TextureFilter::linear;
    bool weigh_by_alpha = false;  ///< clear texels give no colour to their neighbours; for cut-outs
    TextureMinification minification = TextureMinification::mean;
};
/// What surfaces show beside the colours of their materials. Refers to the caller's arrays; each may be empty.
struct SurfaceDetail {
    std::span<const float> texture_coordinates{};     ///< u, v of the corners, 6 per triangle
    std::span<const float> corner_colors{};           ///< linear RGB of the corners, 9 per triangle: a factor
    std::span<const std::uint32_t> corner_normals{};  ///< pack_normal() of the corners, 3 per triangle; 0: none
    std::span<const ColorTextureUse> texture_uses{};  ///< one per material
    std::span<const ColorTexture> textures{};
};
/// A normal of any length in 32 bits, to .01 degrees (the octahedral map of Meyer et al. 2010). 0 for one that is 0 or
/// not finite.
std::uint32_t pack_normal(const Float3& normal);

/// What Surfaces::read() returns: 3 floats per pixel each.
struct SurfacesOnHost {
    std::vector<float> albedo;  ///< linear RGB per pixel; sky: 0
    std::vector<float> normal;  ///< unit shading normal on the eye's side of the triangle; sky: 0
};
/// Colour textures on the device, for the next Appearance or Surfaces: give the same object to both.
struct SurfaceTextures {
    struct OnDevice;
    std::shared_ptr<const OnDevice> on_device;
};
class Surfaces;

/// What triangles look like, on the device: materials, and of SurfaceDetail what there is. Checked and copied once, for
/// any number of views: the caller's arrays are not needed any more.
class Appearance {
public:
    /// Of triangles in their order. Textures of `kept` are used again if they are of the same arrays, whose contents
    /// must be as they were. Throws InvalidArgument if arrays and numbers do not fit together, and OutOfDeviceMemory if
    /// not all fits: then Surfaces, made of the same arrays, takes what a view shows.
    static Appearance upload(const Device& device, const Materials& materials, const SurfaceDetail& detail = {},
                             SurfaceTextures* kept = nullptr);
    std::size_t count() const;            ///< of triangles
    std::uint64_t texture_bytes() const;  ///< device memory of the textures
    /// The surfaces of a view of these triangles. Nothing passes between host and device. The buffers of surfaces made
    /// before are used again where no copy of these is left. Throws InvalidArgument if there are other numbers of
    /// triangles, or no camera made the view.
    Surfaces surfaces(const Triangles& triangles, const View& view) const;

    struct Inside;  ///< for the library's own use
    const Inside& inside() const { return *inside_; }

private:
    std::shared_ptr<Inside> inside_;
};

/// The surfaces of a view on the device: albedo (material x vertex colours x texture) and shading normal (interpolated;
/// without corner normals the triangle's own) at each pixel's centre. Visibility does not depend on them.
class Surfaces {
public:
    /// For one view, and where an Appearance does not fit: only what the view shows is copied. If its textures do not
    /// fit into the device's memory, the finest levels of all are left out. Those of `kept` are used again as by
    /// Appearance::upload(). Throws InvalidArgument if arrays and numbers do not fit together.
    Surfaces(const Device& device, const Triangles& triangles, const View& view, const Materials& materials,
             const SurfaceDetail& detail = {}, SurfaceTextures* kept = nullptr);
    std::size_t count() const;              ///< pixels
    cl_mem normals() const;                 ///< the shading normals, 3 floats per pixel
    std::uint64_t texture_bytes() const;    ///< device memory of the textures
    std::uint32_t left_out_levels() const;  ///< the finest ones, of each texture; 0: none
    SurfacesOnHost read() const;            ///< waits until the device has made them, and copies them

    struct Inside;  ///< for the library's own use
    const Inside& inside() const { return *inside_; }

private:
    friend class Appearance;
    explicit Surfaces(std::shared_ptr<const Inside> inside) : inside_(std::move(inside)) {}

    std::shared_ptr<const Inside> inside_;
};

/// How shade() exposes, and where the sky lights.
struct ShadeOptions {
    /// All light times 2^this. None: metered, so that 95 % of the surfaces' pixels are no brighter than .8.
    std::optional<double> exposure_ev = 0;
    /// For each pixel the part of the sky's light that reaches it, 1 for a free horizontal surface. Empty: ambient
    /// light everywhere.
    std::span<const float> sky_shares{};
    /// The same on the device: float64, as LightsOutputs::sums. Null: `sky_shares`.
    cl_mem sky_sums = nullptr;
};
/// What shade() returns: width * height pixels.
struct Picture {
    std::vector<std::uint8_t> rgba;  ///< 8-bit sRGB, 4 bytes per pixel
    double exposure_ev = 0;          ///< as given or metered
};
/// Lambert with visibility, plus ambient light, times the exposure: the sum over the lights, each as bright as the
/// others. Where normals are interpolated, each cosine is shifted, so that a light fades out before its triangle is
/// backfacing (the shadow terminator; as appleseed and Cycles do). Colours up to .8 stay as they are, brighter ones
/// follow the curve of Khronos' PBR Neutral tone mapper. visibilities[i] belongs to lights[i]: throws InvalidArgument
/// if the two numbers differ.
Picture shade(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
              const ShadeOptions& options = {});
/// The same into the caller's buffer: 8-bit sRGB, 4 bytes (RGBA) per pixel. Returns the exposure. The picture is
/// complete when the device's queue has executed it. Throws InvalidArgument also if the buffer is too small.
double shade_into(cl_mem rgba, const Surfaces& surfaces, std::span<const Visibility> visibilities,
                  std::span<const Light> lights, const ShadeOptions& options = {});
/// The mean of pictures of one size, such as those of SampleViews, of the light after the tone curve.
class PictureMean {
public:
    /// Throws InvalidArgument if `pictures` is 0.
    PictureMean(const Device& device, std::size_t pixels, std::uint32_t pictures);
    ~PictureMean();
    /// Adds the picture that shade() would make. Returns its exposure: give the first picture's to the others. Throws
    /// InvalidArgument as shade() does, if the surfaces have another number of pixels, or if all pictures were added.
    double add(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
               const ShadeOptions& options = {});
    /// 8-bit sRGB, 4 bytes (RGBA) per pixel. Waits. Throws InvalidArgument if a picture is missing.
    std::vector<std::uint8_t> read() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};
/// The same with base colours alone, as 8-bit sRGB, 4 bytes (RGBA) per pixel.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                std::span<const Visibility> visibilities, const Materials& materials,
                                std::span<const Light> lights);
/// The same for one light.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                const Visibility& visibility, const Materials& materials, const Light& light);

}  // namespace gnomon

#pragma GCC visibility pop
