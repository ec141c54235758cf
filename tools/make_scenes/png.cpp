// SPDX-License-Identifier: MIT
#include "png.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>

namespace {

/// One stored block of deflate in the envelope of zlib (RFC 1950, 1951), which stb frees.
unsigned char* stored(unsigned char* bytes, int count, int* stored_count, int) {
    std::vector<std::uint8_t> out{0x78,
                                  0x01,
                                  0x01,
                                  std::uint8_t(count),
                                  std::uint8_t(count >> 8),
                                  std::uint8_t(~count),
                                  std::uint8_t(~count >> 8)};
    std::uint32_t a = 1, b = 0;
    for (const unsigned char byte : std::span(bytes, std::size_t(count))) {
        out.push_back(byte);
        a = (a + byte) % 65521u;
        b = (b + a) % 65521u;
    }
    for (const std::uint32_t word : {b >> 8, b, a >> 8, a}) out.push_back(std::uint8_t(word));
    *stored_count = int(out.size());
    auto* const result = static_cast<unsigned char*>(std::malloc(out.size()));
    if (result != nullptr) std::copy(out.begin(), out.end(), result);
    return result;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS stored
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace gnomon::make_scenes {

std::vector<std::uint8_t> png_of(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba) {
    stbi_write_force_png_filter = 0;
    std::vector<std::uint8_t> png;
    const auto append = [](void* to, void* bytes, int count) {
        const auto* const first = static_cast<const std::uint8_t*>(bytes);
        static_cast<std::vector<std::uint8_t>*>(to)->assign(first, first + count);
    };
    stbi_write_png_to_func(append, &png, int(width), int(height), 4, rgba.data(), 0);
    return png;
}

}  // namespace gnomon::make_scenes
