// SPDX-License-Identifier: MIT
// The command's module gnomon_openimageio: EXR files, and images of scenes. OpenImageIO comes
// with some 250 libraries. Loading them takes longer than making a picture, so only runs that need them open the
// module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <gnomon.hpp>
#include "decoded_image.hpp"
#include "output_files.hpp"

namespace gnomon::app {

/// More channels of an EXR; either may be empty.
struct AovSurfaces {
    const SurfacesOnHost* surfaces = nullptr;
    std::span<const float> sky_shares{};
    std::span<const float> irradiance{};
};

/// The functions of the module. Failures are Error.
struct OpenImageIo {
    /// As write_aov() of pictures.hpp; errors call the file `name`, and the file names `software` as its maker.
    void (*write_aov)(ByteSink& file, const std::string& name, const std::string& software, std::uint32_t width,
                      std::uint32_t height, const ViewOnHost& view, std::span<const float> values, const char* channel,
                      const AovSurfaces& surfaces);
    /// decoded_image.hpp
    AlphaImage (*read_alpha)(std::span<const unsigned char> bytes);
    RgbaImage (*read_colors)(std::span<const unsigned char> bytes, std::uint64_t max_bytes);
};

}  // namespace gnomon::app

/// The symbol that the command (pictures.cpp) loads from the module.
extern "C" const gnomon::app::OpenImageIo gnomon_openimageio;
