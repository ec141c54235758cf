// SPDX-License-Identifier: MIT
// Pictures, written into an OutputFile. The format is chosen here, never by the file's name.
// Nothing in a file depends on the time or the machine: the same values give the same bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <gnomon.hpp>
#include "openimageio.hpp"
#include "output_files.hpp"

namespace gnomon::app {

/// An 8-bit sRGB PNG from RGBA bytes, from the top. Alpha is left out: the picture is opaque.
void write_picture(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// An 8-bit PNG of one channel: 255 lit (and sky), 0 in shadow, rounded between.
void write_mask(OutputFile& file, std::uint32_t width, std::uint32_t height, std::span<const float> visibility);

/// One EXR, zip (lossless): P.X P.Y P.Z N.X N.Y N.Z and the values' channel FLOAT, receiver UINT; with surfaces
/// albedo.R .G .B and Ns.X .Y .Z FLOAT, too, with shares of the sky channel sky, and of an area
/// light channel irradiance.
void write_aov(OutputFile& file, std::uint32_t width, std::uint32_t height, const ViewOnHost& view,
               std::span<const float> values, const char* channel = "visibility", const AovSurfaces& surfaces = {});

/// The bytes that write_picture() writes.
std::string png_of(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// A picture inside a page, from RGB or RGBA bytes: "data:image/png;base64,..." is exact, "data:image/jpeg..." for
/// looks.
std::string data_uri(const std::string& format, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels);
/// RGBA bytes as a PNG, or as a JPEG where that is shorter: pictures of a few colours stay exact.
std::string short_data_uri(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// The alpha of an image file in memory (decoded_image.hpp).
AlphaImage decode_alpha(std::span<const unsigned char> bytes);
RgbaImage decode_colors(std::span<const unsigned char> bytes, std::uint64_t max_bytes);

/// Throws Error if write_aov(), decode_alpha() or decode_colors() would: to be called before long work.
void require_openimageio();

}  // namespace gnomon::app
