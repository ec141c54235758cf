// SPDX-License-Identifier: MIT
#include "pictures.hpp"

#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gnomon.hpp>
#include "measure/visibility_errors.hpp"

namespace gnomon::bench {

namespace {

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb sky{214, 228, 245};

std::string base64(std::span<const std::uint8_t> bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < left ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= left ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string data_uri(const std::vector<Rgb>& pixels, int width, int height) {
    std::vector<std::uint8_t> png;
    const auto append = [](void* context, void* data, int size) {
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        auto& all = *static_cast<std::vector<std::uint8_t>*>(context);
        all.insert(all.end(), bytes, bytes + size);
    };
    if (stbi_write_png_to_func(append, &png, width, height, 3, pixels.data(), width * 3) == 0)
        throw Error("a picture of the benchmark's page could not be compressed: out of memory");
    return "data:image/png;base64," + base64(png);
}

// color_of(pixels of the mask): the colour of the one pixel that they are reduced to.
template <typename ColorOf>
std::string reduced(std::uint32_t width, std::uint32_t height, ColorOf color_of) {
    const std::uint32_t side = (width + widest_picture - 1) / widest_picture;
    const std::uint32_t columns = (width + side - 1) / side, rows = (height + side - 1) / side;
    std::vector<Rgb> pixels;
    pixels.reserve(std::size_t(columns) * rows);
    std::vector<std::size_t> block;
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            block.clear();
            for (std::uint32_t y = row * side; y < std::min((row + 1) * side, height); ++y)
                for (std::uint32_t x = column * side; x < std::min((column + 1) * side, width); ++x)
                    block.push_back(std::size_t(y) * width + x);
            pixels.push_back(color_of(block));
        }
    return data_uri(pixels, static_cast<int>(columns), static_cast<int>(rows));
}

}  // namespace

std::string mask_picture(std::span<const float> mask, std::span<const std::uint32_t> receivers, std::uint32_t width,
                         std::uint32_t height) {
    return reduced(width, height, [&](const std::vector<std::size_t>& block) {
        double sum = 0;
        std::size_t points = 0;
        for (const std::size_t i : block)
            if (receivers[i] != no_receiver) {
                sum += mask[i];
                ++points;
            }
        if (points == 0) return sky;
        const auto grey = static_cast<std::uint8_t>(std::lround(255 * sum / double(points)));
        return Rgb{grey, grey, grey};
    });
}

std::string difference_picture(std::span<const float> mask, std::span<const float> truth, std::uint32_t width,
                               std::uint32_t height) {
    const std::vector<std::uint8_t> rgb = measure::difference_picture(mask, truth);
    return reduced(width, height, [&](const std::vector<std::size_t>& block) {
        const auto error = [&](std::size_t i) { return std::abs(mask[i] - truth[i]); };
        const std::size_t worst = *std::ranges::max_element(block, {}, error);
        return Rgb{rgb[3 * worst], rgb[3 * worst + 1], rgb[3 * worst + 2]};
    });
}

}  // namespace gnomon::bench
