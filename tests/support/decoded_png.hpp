// SPDX-License-Identifier: MIT
// The alpha of PNG files by stb, for tests on machines without the command's library for images.
#pragma once

#include <stb/stb_image.h>

#include <memory>
#include <span>
#include <stdexcept>

#include "scene/scene.hpp"

namespace support {

inline gnomon::scene::SceneCutOuts::Texture alpha_of_png(std::span<const unsigned char> png) {
    int width = 0, height = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> rgba(
        stbi_load_from_memory(png.data(), int(png.size()), &width, &height, nullptr, 4), stbi_image_free);
    if (!rgba) throw std::runtime_error(stbi_failure_reason());
    gnomon::scene::SceneCutOuts::Texture texture{std::uint32_t(width), std::uint32_t(height), {}};
    for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height); ++i)
        texture.alpha.push_back(rgba.get()[4 * i + 3]);
    return texture;
}

}  // namespace support
