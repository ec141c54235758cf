// SPDX-License-Identifier: MIT
// Checks cut-outs, finds the triangles that are opaque or clear all over, and packs the rest for the kernels.
#include "exact/cut_outs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernels/exact/cut_outs.h"

namespace gnomon {
namespace {

constexpr std::uint32_t max_threshold = 255u << 16;

/// The class of a material's triangles if it does not depend on the texture, and the threshold.
struct Threshold {
    std::uint32_t of_all;  ///< a class; CUT_OUT_MASKED: the texture decides
    std::uint32_t value;   ///< in units of 2^-16 / 255
};

Threshold threshold_of(const CutOutMaterial& material) {
    if (!(material.cutoff > 0)) return {CUT_OUT_OPAQUE, 0};
    if (material.cutoff > 1 || !(material.alpha_factor > 0)) return {CUT_OUT_CLEAR, 0};
    // One rounding that is seen: those in double are below 2^-40 of a unit of 1 / 255.
    const double units = std::nearbyint(255.0 * double(material.cutoff) / double(material.alpha_factor) * 65536.0);
    if (units > max_threshold) return {CUT_OUT_CLEAR, 0};
    if (units == 0) return {CUT_OUT_OPAQUE, 0};
    return {CUT_OUT_MASKED, static_cast<std::uint32_t>(units)};
}

struct AlphaRange {
    std::uint8_t least = 255, most = 0;

    void add(const AlphaRange& other) {
        least = std::min(least, other.least);
        most = std::max(most, other.most);
    }
};

/// Texels [first, last], unwrapped.
struct TexelInterval {
    std::int64_t first, last;
};

/// The least and the greatest alpha of each square of 2^l texels, level by level: of a rectangle of texels, it finds
/// bounds of all alphas.
class AlphaPyramid {
public:
    explicit AlphaPyramid(const AlphaTexture& texture) : texture_(texture) {
        for (std::uint32_t w = texture.width, h = texture.height; w > 1 || h > 1;) {
            const std::uint32_t below_w = w, below_h = h;
            w = (w + 1) / 2, h = (h + 1) / 2;
            Level level{w, std::vector<AlphaRange>(std::size_t(w) * h)};
            for (std::uint32_t y = 0; y < below_h; ++y)
                for (std::uint32_t x = 0; x < below_w; ++x)
                    level.ranges[std::size_t(y / 2) * w + x / 2].add(at(levels_.size(), x, y));
            levels_.push_back(std::move(level));
        }
    }

    /// The range of the texture's texels.
    AlphaRange range(const TexelInterval& x, const TexelInterval& y) const {
        constexpr std::int64_t max_squares = 8;  // per side
        std::size_t level = 0;
        while (std::max(x.last - x.first, y.last - y.first) >> level >= max_squares) ++level;
        AlphaRange range;
        for (std::int64_t j = y.first >> level; j <= y.last >> level; ++j)
            for (std::int64_t i = x.first >> level; i <= x.last >> level; ++i)
                range.add(at(level, std::uint32_t(i), std::uint32_t(j)));
        return range;
    }

private:
    struct Level {
        std::uint32_t width;
        std::vector<AlphaRange> ranges;
    };

    AlphaRange at(std::size_t level, std::uint32_t x, std::uint32_t y) const {
        if (level != 0) return levels_[level - 1].ranges[std::size_t(y) * levels_[level - 1].width + x];
        const std::uint8_t alpha = texture_.alpha[std::size_t(y) * texture_.width + x];
        return {alpha, alpha};
    }

    const AlphaTexture& texture_;
    std::vector<Level> levels_;
};

/// The texels of the texture that unwrapped texels stand for: at most two intervals.
std::vector<TexelInterval> wrapped(const TexelInterval& texels, std::int64_t side, TextureWrap wrap) {
    const TexelInterval all{0, side - 1};
    if (wrap == TextureWrap::clamp)
        return {
            {std::clamp<std::int64_t>(texels.first, 0, side - 1), std::clamp<std::int64_t>(texels.last, 0, side - 1)}};
    if (texels.last - texels.first + 1 >= side) return {all};
    const std::int64_t period = wrap == TextureWrap::mirror ? 2 * side : side;
    const std::int64_t first = ((texels.first % period) + period) % period, last = first + texels.last - texels.first;
    std::vector<TexelInterval> intervals;
    for (std::int64_t start = 0; start <= last; start += side) {  // each copy of the texture, mirrored or not
        const std::int64_t from = std::max(first, start) - start, to = std::min(last, start + side - 1) - start;
        if (from > to) continue;
        const bool turned = wrap == TextureWrap::mirror && start / side % 2 == 1;
        intervals.push_back(turned ? TexelInterval{side - 1 - to, side - 1 - from} : TexelInterval{from, to});
    }
    return intervals;
}

/// One texel more on each side than the triangle reaches: room for the roundings.
TexelInterval texels_between(const float* corners, std::uint32_t side) {
    const auto [low, high] = std::minmax({corners[0], corners[2], corners[4]});
    return {std::int64_t(std::floor(double(low) * side - 0.5)) - 1,
            std::int64_t(std::floor(double(high) * side + 0.5)) + 1};
}

bool is_usable(const float* corners, std::uint32_t side) {
    for (int k = 0; k < 3; ++k)
        if (!(std::abs(double(corners[2 * k]) * side) <= CUT_OUT_FARTHEST_TEXEL)) return false;
    return true;
}

class Packer {
public:
    Packer(std::size_t triangle_count, const CutOuts& cut_outs) : count_(triangle_count), in_(cut_outs) {
        require();
        for (const CutOutMaterial& material : in_.materials) thresholds_.push_back(threshold_of(material));
        for (const AlphaTexture& texture : in_.textures) pyramids_.emplace_back(texture);
    }

    PackedCutOuts pack() {
        PackedCutOuts packed;
        std::vector<std::uint32_t> classes(count_), masked;
        for (std::size_t i = 0; i < count_; ++i) {
            if (in_.material_of_triangle[i] == no_cut_out) continue;
            classes[i] = class_of(i, packed.counts);
            if (classes[i] == CUT_OUT_MASKED) masked.push_back(std::uint32_t(i));
            ++(classes[i] == CUT_OUT_MASKED  ? packed.counts.masked
               : classes[i] == CUT_OUT_CLEAR ? packed.counts.clear
                                             : packed.counts.opaque);
        }
        if (packed.counts.masked + packed.counts.clear == 0) return packed;
        if (count_ >= std::size_t(1) << 31) throw InvalidArgument("a scene with cut-outs has at most 2^31 triangles");
        write_classes(classes, packed.words);
        write_tables(masked, packed.words);
        return packed;
    }

private:
    void require() const {
        const auto fail = [](const std::string& what) { throw InvalidArgument("the cut-outs' " + what); };
        if (in_.material_of_triangle.size() != count_)
            fail("materials are " + std::to_string(in_.material_of_triangle.size()) + " for " + std::to_string(count_) +
                 " triangles: give one each");
        if (!in_.texture_coordinates.empty() && in_.texture_coordinates.size() != 6 * count_)
            fail("texture coordinates must be 6 floats for each triangle, or none at all");
        if (!in_.corner_alphas.empty() && in_.corner_alphas.size() != 3 * count_)
            fail("corner alphas must be 3 floats for each triangle, or none at all");
        for (const std::uint32_t material : in_.material_of_triangle)
            if (material != no_cut_out && material >= in_.materials.size())
                fail("material " + std::to_string(material) + " of a triangle is none of the " +
                     std::to_string(in_.materials.size()) + " materials");
        for (const CutOutMaterial& material : in_.materials) {
            if (material.texture != no_texture && material.texture >= in_.textures.size())
                fail("texture " + std::to_string(material.texture) + " of a material is none of the " +
                     std::to_string(in_.textures.size()) + " textures");
            if (std::isnan(material.cutoff) || std::isnan(material.alpha_factor))
                fail("cutoffs and alpha factors must be numbers");
        }
        for (const AlphaTexture& texture : in_.textures) {
            if (texture.width == 0 || texture.height == 0 || texture.width > CUT_OUT_LARGEST_SIDE ||
                texture.height > CUT_OUT_LARGEST_SIDE)
                fail("texture of " + std::to_string(texture.width) + "x" + std::to_string(texture.height) +
                     " texels: each side must be from 1 to " + std::to_string(CUT_OUT_LARGEST_SIDE));
            if (texture.alpha.size() != std::size_t(texture.width) * texture.height)
                fail("texture of " + std::to_string(texture.width) + "x" + std::to_string(texture.height) +
                     " texels has " + std::to_string(texture.alpha.size()) +
                     " alphas: give one for each texel, row by row");
        }
    }

    bool has_texture(const CutOutMaterial& material) const {
        return material.texture != no_texture && !in_.texture_coordinates.empty();
    }

    std::uint32_t class_of(std::size_t i, CutOutCounts& counts) const {
        const std::uint32_t id = in_.material_of_triangle[i];
        const CutOutMaterial& material = in_.materials[id];
        if (thresholds_[id].of_all != CUT_OUT_MASKED) return thresholds_[id].of_all;
        double min_alpha = 1, max_alpha = 1;
        if (!in_.corner_alphas.empty()) {
            const auto alphas = in_.corner_alphas.subspan(3 * i, 3);
            min_alpha = *std::min_element(alphas.begin(), alphas.end());
            max_alpha = *std::max_element(alphas.begin(), alphas.end());
            for (const float alpha : alphas)
                if (!(alpha >= 0 && alpha <= 1)) return ++counts.unusable, CUT_OUT_OPAQUE;
        }
        AlphaRange range{255, 255};
        if (has_texture(material)) {
            const AlphaTexture& texture = in_.textures[material.texture];
            const float* corners = &in_.texture_coordinates[6 * i];
            if (!is_usable(corners, texture.width) || !is_usable(corners + 1, texture.height))
                return ++counts.unusable, CUT_OUT_OPAQUE;
            range = {};
            for (const TexelInterval& y :
                 wrapped(texels_between(corners + 1, texture.height), texture.height, material.wrap_v))
                for (const TexelInterval& x :
                     wrapped(texels_between(corners, texture.width), texture.width, material.wrap_u))
                    range.add(pyramids_[material.texture].range(x, y));
        }
        // Exact: 24 bits times 24 bits.
        if (range.least * 65536.0 * min_alpha >= thresholds_[id].value) return CUT_OUT_OPAQUE;
        if (range.most * 65536.0 * max_alpha < thresholds_[id].value) return CUT_OUT_CLEAR;
        return CUT_OUT_MASKED;
    }

    void write_classes(const std::vector<std::uint32_t>& classes, std::vector<std::uint32_t>& words) const {
        std::uint32_t before = 0;
        for (std::size_t first = 0; first < count_; first += CUT_OUT_GROUP) {
            std::uint32_t group = 0, masked = 0;
            for (std::size_t k = 0; k < std::min<std::size_t>(CUT_OUT_GROUP, count_ - first); ++k) {
                group |= classes[first + k] << 2 * k;
                masked += classes[first + k] == CUT_OUT_MASKED;
            }
            words.push_back(group);
            words.push_back(before);
            before += masked;
        }
    }

    void write_tables(const std::vector<std::uint32_t>& masked, std::vector<std::uint32_t>& words) const {
        const bool has_alphas = !in_.corner_alphas.empty();
        const std::size_t header_at = words.size();
        const std::uint32_t triangle_words = has_alphas ? CUT_OUT_TRIANGLE_WORDS_WITH_ALPHAS : CUT_OUT_TRIANGLE_WORDS;
        words.resize(header_at + sizeof(CutOutHeader) / 4);
        CutOutHeader header{std::uint32_t(words.size()), triangle_words, 0, 0};
        for (const std::uint32_t i : masked) {
            words.push_back(in_.material_of_triangle[i]);
            for (std::size_t k = 0; k < 6; ++k)
                words.push_back(in_.texture_coordinates.empty()
                                    ? 0
                                    : std::bit_cast<std::uint32_t>(in_.texture_coordinates[6 * i + k]));
            for (std::size_t k = 0; k < 3 && has_alphas; ++k)
                words.push_back(std::bit_cast<std::uint32_t>(in_.corner_alphas[3 * i + k]));
        }
        header.first_material = std::uint32_t(words.size());
        const std::size_t materials_at = words.size();
        words.resize(words.size() + in_.materials.size() * (sizeof(DeviceMaterial) / 4));
        const std::size_t white_at = words.size();
        words.push_back(0xFFFFFFFFu);  // a texel of alpha 255, for materials without a texture
        std::vector<std::size_t> texels_at;
        for (const AlphaTexture& texture : in_.textures) {
            texels_at.push_back(words.size());
            words.resize(words.size() + (texture.alpha.size() + 3) / 4);
            std::memcpy(&words[texels_at.back()], texture.alpha.data(), texture.alpha.size());
        }
        std::vector<std::size_t> classes_at(in_.materials.size(), 0);
        for (std::size_t m = 0; m < in_.materials.size() && !has_alphas; ++m)
            if (thresholds_[m].of_all == CUT_OUT_MASKED && has_texture(in_.materials[m])) {
                classes_at[m] = words.size();
                write_neighbours(m, words);
            }
        if (words.size() > std::numeric_limits<std::uint32_t>::max())
            throw InvalidArgument("the cut-outs take more than 16 GiB: give smaller textures");
        for (std::size_t m = 0; m < in_.materials.size(); ++m) {
            const CutOutMaterial& from = in_.materials[m];
            DeviceMaterial to{.first_texel = std::uint32_t(white_at),
                              .width = 1,
                              .height = 1,
                              .wraps = 0,
                              .is_linear = 0,
                              .threshold = thresholds_[m].value,
                              .has_alphas = has_alphas,
                              .first_class = std::uint32_t(classes_at[m])};
            if (has_texture(from)) {
                to.first_texel = std::uint32_t(texels_at[from.texture]);
                to.width = in_.textures[from.texture].width;
                to.height = in_.textures[from.texture].height;
                to.wraps = std::uint32_t(from.wrap_u) | std::uint32_t(from.wrap_v) << 2;
                to.is_linear = from.filter == TextureFilter::linear;
            }
            std::memcpy(&words[materials_at + m * (sizeof(to) / 4)], &to, sizeof(to));
        }
        std::memcpy(&words[header_at], &header, sizeof(header));
    }

    /// The class of each texel with its eight neighbours.
    void write_neighbours(std::size_t m, std::vector<std::uint32_t>& words) const {
        const CutOutMaterial& material = in_.materials[m];
        const AlphaTexture& texture = in_.textures[material.texture];
        const std::size_t width = texture.width, height = texture.height, first = words.size();
        const std::size_t tiles = CUT_OUT_TILES(width);
        words.resize(first + tiles * CUT_OUT_TILES(height));
        const auto neighbour = [](std::size_t i, std::size_t side, TextureWrap wrap, bool after) -> std::size_t {
            if (after ? i + 1 < side : i > 0) return after ? i + 1 : i - 1;
            return wrap != TextureWrap::repeat ? i : after ? 0 : side - 1;
        };
        std::vector<AlphaRange> columns(width);  // of three rows
        for (std::size_t y = 0; y < height; ++y) {
            const std::size_t rows[3] = {neighbour(y, height, material.wrap_v, false), y,
                                         neighbour(y, height, material.wrap_v, true)};
            for (std::size_t x = 0; x < width; ++x) {
                columns[x] = {};
                for (const std::size_t row : rows) {
                    const std::uint8_t alpha = texture.alpha[row * width + x];
                    columns[x].add({alpha, alpha});
                }
            }
            for (std::size_t x = 0; x < width; ++x) {
                AlphaRange range = columns[x];
                range.add(columns[neighbour(x, width, material.wrap_u, false)]);
                range.add(columns[neighbour(x, width, material.wrap_u, true)]);
                const std::uint32_t threshold = thresholds_[m].value;
                const std::uint32_t of_texel = std::uint32_t(range.least) << 16 >= threshold ? CUT_OUT_OPAQUE
                                               : std::uint32_t(range.most) << 16 < threshold ? CUT_OUT_CLEAR
                                                                                             : CUT_OUT_MASKED;
                words[first + y / CUT_OUT_TILE * tiles + x / CUT_OUT_TILE] |=
                    of_texel << 2 * (y % CUT_OUT_TILE * CUT_OUT_TILE + x % CUT_OUT_TILE);
            }
        }
    }

    std::size_t count_;
    const CutOuts& in_;
    std::vector<Threshold> thresholds_;
    std::vector<AlphaPyramid> pyramids_;
};

}  // namespace

PackedCutOuts pack_cut_outs(std::size_t triangle_count, const CutOuts& cut_outs) {
    return Packer(triangle_count, cut_outs).pack();
}

CutOuts CutOuts::part(std::size_t first, std::size_t count) const {
    CutOuts part = *this;
    part.material_of_triangle = material_of_triangle.subspan(first, count);
    if (!texture_coordinates.empty()) part.texture_coordinates = texture_coordinates.subspan(6 * first, 6 * count);
    if (!corner_alphas.empty()) part.corner_alphas = corner_alphas.subspan(3 * first, 3 * count);
    return part;
}

}  // namespace gnomon
