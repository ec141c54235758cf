// SPDX-License-Identifier: MIT
// The alpha of the PNG files that make_scenes writes (tools/make_scenes/png.cpp), for tests on machines without a
// library for images: 8-bit RGBA, no filter, one block that is not compressed.
#pragma once

#include <span>
#include <stdexcept>

#include "scene/scene.hpp"

namespace support {

inline gnomon::scene::SceneCutOuts::Texture alpha_of_made_png(std::span<const unsigned char> png) {
    constexpr std::size_t width_at = 16, rows_at = 48;  // behind IHDR, and behind the headers of IDAT, zlib and deflate
    const auto word = [&](std::size_t at) {
        return std::uint32_t(png[at]) << 24 | std::uint32_t(png[at + 1]) << 16 | std::uint32_t(png[at + 2]) << 8 |
               png[at + 3];
    };
    if (png.size() < rows_at || png[43] != 1) throw std::runtime_error("no PNG of make_scenes");
    gnomon::scene::SceneCutOuts::Texture texture{word(width_at), word(width_at + 4), {}};
    const std::size_t row = 1 + 4 * std::size_t(texture.width);
    if (png.size() < rows_at + row * texture.height) throw std::runtime_error("a PNG of make_scenes is cut off");
    for (std::size_t y = 0; y < texture.height; ++y)
        for (std::size_t x = 0; x < texture.width; ++x) texture.alpha.push_back(png[rows_at + y * row + 1 + 4 * x + 3]);
    return texture;
}

}  // namespace support
