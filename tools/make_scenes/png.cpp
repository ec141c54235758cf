// SPDX-License-Identifier: MIT
#include "png.hpp"

#include <string_view>

namespace gnomon::make_scenes {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, std::string_view text) { bytes.insert(bytes.end(), text.begin(), text.end()); }

void append_big_endian(Bytes& bytes, std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(std::uint8_t(word >> shift));
}

/// CRC-32 of PNG (ISO 3309).
std::uint32_t crc_of(const Bytes& bytes, std::size_t first) {
    std::uint32_t crc = 0xFFFFFFFFu;
    for (std::size_t i = first; i < bytes.size(); ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
    }
    return ~crc;
}

void append_chunk(Bytes& png, std::string_view type, const Bytes& data) {
    append_big_endian(png, std::uint32_t(data.size()));
    const std::size_t first = png.size();
    append(png, type);
    png.insert(png.end(), data.begin(), data.end());
    append_big_endian(png, crc_of(png, first));
}

/// One stored block of deflate in the envelope of zlib (RFC 1950, 1951).
Bytes stored(const Bytes& data) {
    const auto size = std::uint32_t(data.size());
    Bytes out{
        0x78, 0x01, 0x01, std::uint8_t(size), std::uint8_t(size >> 8), std::uint8_t(~size), std::uint8_t(~size >> 8)};
    std::uint32_t a = 1, b = 0;
    for (const std::uint8_t byte : data) {
        out.push_back(byte);
        a = (a + byte) % 65521u;
        b = (b + a) % 65521u;
    }
    append_big_endian(out, b << 16 | a);
    return out;
}

}  // namespace

std::vector<std::uint8_t> png_of(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba) {
    Bytes header, rows, png;
    append_big_endian(header, width);
    append_big_endian(header, height);
    header.insert(header.end(), {8, 6, 0, 0, 0});  // 8 bits, RGBA
    for (std::size_t y = 0; y < height; ++y) {
        rows.push_back(0);  // no filter
        const auto first = rgba.begin() + std::ptrdiff_t(4 * width * y);
        rows.insert(rows.end(), first, first + std::ptrdiff_t(4 * width));
    }
    append(png, "\x89PNG\r\n\x1a\n");
    append_chunk(png, "IHDR", header);
    append_chunk(png, "IDAT", stored(rows));
    append_chunk(png, "IEND", {});
    return png;
}

}  // namespace gnomon::make_scenes
