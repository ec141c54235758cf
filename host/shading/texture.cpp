// SPDX-License-Identifier: MIT
// Levels of colour textures as kernels/shading/mip_levels.h describes them, on the host: for textures that do not fit
// into the device's memory with all that makes their levels there.
#include <algorithm>
#include <cmath>

#include "shading/surface.hpp"

namespace gnomon {
namespace {

constexpr std::size_t encoded_size = MIP_ENCODED;

double linear_of(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// 8-bit sRGB of encoded_size linear values.
const std::vector<std::uint8_t>& encoded_of_linear() {
    static const std::vector<std::uint8_t> table = [] {
        std::vector<std::uint8_t> made(encoded_size);
        // The largest linear value that rounds to each 8-bit value.
        std::size_t i = 0;
        for (int value = 0; value < 256; ++value) {
            const double limit = value == 255 ? 2 : linear_of((value + 0.5) / 255);
            for (; i < encoded_size && double(i) / double(encoded_size - 1) < limit; ++i)
                made[i] = static_cast<std::uint8_t>(value);
        }
        return made;
    }();
    return table;
}

/// Linear colour times weight, and weight, 4 floats per texel.
struct Level {
    std::uint32_t width = 0, height = 0;
    std::vector<float> texels;
};

Level first_level(const ColorTexture& texture, bool weighs_alpha) {
    static const std::array<float, 256> decoded = linear_of_srgb();
    Level level{texture.width, texture.height, {}};
    level.texels.resize(texture.rgba.size());
    for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
        const std::uint8_t* texel = &texture.rgba[i];
        const float weight = weighs_alpha ? float(std::max<int>(texel[3], 1)) / 255.0f : 1.0f;
        for (std::size_t k = 0; k < 3; ++k) level.texels[i + k] = decoded[texel[k]] * weight;
        level.texels[i + 3] = weight;
    }
    return level;
}

/// The next level of one with even sides: the mean of four.
Level halved(const Level& from) {
    Level to{from.width / 2, from.height / 2, {}};
    to.texels.resize(std::size_t(4) * to.width * to.height);
    const std::size_t row = std::size_t(4) * from.width;
    for (std::uint32_t y = 0; y < to.height; ++y) {
        const float* in = &from.texels[2 * row * y];
        float* out = &to.texels[std::size_t(4) * to.width * y];
        for (std::uint32_t x = 0; x < to.width; ++x, in += 8, out += 4)
            for (int k = 0; k < 4; ++k) out[k] = 0.25f * ((in[k] + in[k + 4]) + (in[row + k] + in[row + k + 4]));
    }
    return to;
}

/// The same of texels with even sides, without their level in floats: that would be most of the work.
Level halved(const ColorTexture& texture, bool weighs_alpha) {
    static const std::array<float, 256> decoded = linear_of_srgb();
    Level to{texture.width / 2, texture.height / 2, {}};
    to.texels.resize(std::size_t(4) * to.width * to.height);
    const std::size_t row = std::size_t(4) * texture.width;
    for (std::uint32_t y = 0; y < to.height; ++y) {
        const std::uint8_t* in = &texture.rgba[2 * row * y];
        float* out = &to.texels[std::size_t(4) * to.width * y];
        for (std::uint32_t x = 0; x < to.width; ++x, in += 8, out += 4) {
            float sum[4] = {};
            for (const std::uint8_t* texel : {in, in + 4, in + row, in + row + 4}) {
                const float weight = weighs_alpha ? float(std::max<int>(texel[3], 1)) / 255.0f : 1.0f;
                for (int k = 0; k < 3; ++k) sum[k] += decoded[texel[k]] * weight;
                sum[3] += weight;
            }
            for (int k = 0; k < 4; ++k) out[k] = 0.25f * sum[k];
        }
    }
    return to;
}

Level next_level(const Level& from) {
    if (from.width % 2 == 0 && from.height % 2 == 0) return halved(from);
    Level to{std::max(1u, from.width / 2), std::max(1u, from.height / 2), {}};
    to.texels.assign(std::size_t(4) * to.width * to.height, 0.0f);
    const std::vector<MipTaps> columns = taps_of(from.width, to.width), rows = taps_of(from.height, to.height);
    for (std::uint32_t y = 0; y < to.height; ++y)
        for (std::uint32_t dy = 0; dy < 3; ++dy) {
            if (rows[y].shares[dy] == 0) continue;
            const float* row = &from.texels[std::size_t(4) * from.width * (rows[y].first + dy)];
            float* out = &to.texels[std::size_t(4) * to.width * y];
            for (std::uint32_t x = 0; x < to.width; ++x, out += 4)
                for (std::uint32_t dx = 0; dx < 3; ++dx) {
                    const float share = rows[y].shares[dy] * columns[x].shares[dx];
                    if (share == 0) continue;
                    const float* texel = row + std::size_t(4) * (columns[x].first + dx);
                    for (int k = 0; k < 4; ++k) out[k] += share * texel[k];
                }
        }
    return to;
}

std::uint8_t* write_level(const Level& level, std::uint8_t* out) {
    const std::vector<std::uint8_t>& encoded = encoded_of_linear();
    for (std::size_t i = 0; i < level.texels.size(); i += 4, out += 4) {
        const float weight = level.texels[i + 3];
        for (std::size_t k = 0; k < 3; ++k) {
            const float linear = std::clamp(level.texels[i + k] / weight, 0.0f, 1.0f);
            out[k] = encoded[static_cast<std::size_t>(linear * float(encoded_size - 1) + 0.5f)];
        }
        out[3] = static_cast<std::uint8_t>(std::max(1.0f, std::round(weight * 255.0f)));
    }
    return out;
}

}  // namespace

std::array<float, 256> linear_of_srgb() {
    std::array<float, 256> table;
    for (int i = 0; i < 256; ++i) table[std::size_t(i)] = static_cast<float>(linear_of(i / 255.0));
    return table;
}

std::vector<MipTaps> taps_of(std::uint32_t from, std::uint32_t to) {
    std::vector<MipTaps> taps(to);
    const double side = double(from) / to;
    for (std::uint32_t i = 0; i < to; ++i) {
        const double low = i * side, high = (i + 1) * side;
        taps[i].first = std::min(static_cast<std::uint32_t>(low), from - 1);
        for (std::uint32_t k = 0; k < 3; ++k) {
            const double left = std::max(low, double(taps[i].first + k));
            const double right = std::min({high, double(taps[i].first + k + 1), double(from)});
            taps[i].shares[k] = static_cast<float>(std::max(0.0, right - left) / side);
        }
    }
    return taps;
}

MipTables mip_tables() {
    MipTables tables;
    std::ranges::copy(linear_of_srgb(), tables.linear_of);
    for (int i = 0; i < 256; ++i) tables.weight_of[i] = float(i) / 255.0f;
    std::ranges::copy(encoded_of_linear(), tables.srgb_of);
    return tables;
}

std::uint64_t level_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t first) {
    std::uint64_t bytes = 0;
    for (std::uint32_t level = 0;; ++level) {
        const bool is_last = width == 1 && height == 1;
        if (level >= first || is_last) bytes += std::uint64_t(4) * width * height;
        if (is_last) return bytes;
        width = std::max(1u, width / 2);
        height = std::max(1u, height / 2);
    }
}

void write_levels(const ColorTexture& texture, bool weighs_alpha, std::uint32_t first, std::uint8_t* out) {
    const bool is_one_texel = texture.width == 1 && texture.height == 1;
    if (first == 0 || is_one_texel)  // the texels as they are
        for (std::size_t i = 0; i < texture.rgba.size(); i += 4, out += 4) {
            std::copy_n(&texture.rgba[i], 3, out);
            out[3] = weighs_alpha ? std::max<std::uint8_t>(texture.rgba[i + 3], 1) : 255;
        }
    if (is_one_texel) return;
    const bool is_even = texture.width % 2 == 0 && texture.height % 2 == 0;
    Level level = is_even ? halved(texture, weighs_alpha) : next_level(first_level(texture, weighs_alpha));
    for (std::uint32_t i = 1;; ++i) {
        const bool is_last = level.width == 1 && level.height == 1;
        if (i >= first || is_last) out = write_level(level, out);
        if (is_last) return;
        level = next_level(level);
    }
}

}  // namespace gnomon
