// SPDX-License-Identifier: MIT
// Cut-outs for tests: the same data for the library and for the oracle.
#pragma once

#include "light_scene.hpp"
#include "reference/masks.hpp"

namespace support {

/// The library's view of the oracle's masks; both read the same arrays.
class CutOutData {
public:
    explicit CutOutData(reference::Masks masks) : masks_(std::move(masks)) {
        for (const reference::MaskMaterial& m : masks_.materials)
            materials_.push_back(
                {m.texture < 0 ? gnomon::no_texture : std::uint32_t(m.texture), wrap_of(m.wrap_u), wrap_of(m.wrap_v),
                 m.is_linear ? gnomon::TextureFilter::linear : gnomon::TextureFilter::nearest, m.cutoff, m.factor});
        for (const reference::MaskTexture& t : masks_.textures) textures_.push_back({t.width, t.height, t.alpha});
    }
    CutOutData(const CutOutData&) = delete;
    CutOutData& operator=(const CutOutData&) = delete;

    gnomon::CutOuts cut_outs() const {
        return {masks_.material, masks_.coordinates, masks_.alphas, materials_, textures_};
    }
    const reference::Masks& masks() const { return masks_; }

private:
    static gnomon::TextureWrap wrap_of(reference::MaskWrap wrap) {
        return wrap == reference::MaskWrap::repeat   ? gnomon::TextureWrap::repeat
               : wrap == reference::MaskWrap::mirror ? gnomon::TextureWrap::mirror
                                                     : gnomon::TextureWrap::clamp;
    }

    reference::Masks masks_;
    std::vector<gnomon::CutOutMaterial> materials_;
    std::vector<gnomon::AlphaTexture> textures_;
};

inline reference::MaskTexture made_texture(std::uint32_t width, std::uint32_t height, auto alpha_of) {
    reference::MaskTexture texture{width, height, {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) texture.alpha.push_back(std::uint8_t(alpha_of(x, y)));
    return texture;
}

/// Textures of all kinds, and materials of all wraps, filters and cutoffs.
inline reference::Masks mixed_masks(std::size_t triangle_count, std::uint64_t seed, bool has_alphas = false) {
    Random random(seed);
    reference::Masks masks;
    const auto noise = [&](std::uint32_t, std::uint32_t) { return random.below(256); };
    const std::uint8_t ties[] = {0, 51, 102, 127, 128, 153, 204, 255};
    const auto tied = [&](std::uint32_t, std::uint32_t) { return ties[random.below(8)]; };
    masks.textures.push_back(made_texture(7, 5, noise));
    masks.textures.push_back(made_texture(16, 16, tied));
    masks.textures.push_back(made_texture(1, 1, [](auto, auto) { return 128; }));
    masks.textures.push_back(made_texture(64, 64, [](std::uint32_t x, std::uint32_t y) {  // a leaf
        const int dx = int(x) - 32, dy = int(y) - 32;
        return dx * dx + dy * dy < 20 * 20 ? 255 : 0;
    }));
    const reference::MaskWrap wraps[] = {reference::MaskWrap::repeat, reference::MaskWrap::mirror,
                                         reference::MaskWrap::clamp};
    const float cutoffs[] = {0.2f, 0.4f, 0.5f, 0.6f, 0.8f, 0, 1, 1.5f};
    for (int i = 0; i < 48; ++i)
        masks.materials.push_back({i % 7 == 6 ? -1 : i % 4, wraps[random.below(3)], wraps[random.below(3)],
                                   random.below(2) == 0, cutoffs[random.below(i % 2 == 0 ? 5 : 8)],
                                   random.below(4) == 0 ? 0.7f : 1.0f});
    for (std::size_t i = 0; i < triangle_count; ++i) {
        masks.material.push_back(random.below(3) == 0 ? reference::NO_MATERIAL : random.below(48));
        const bool on_lattice = random.below(2) == 0;
        const float scale = random.below(8) == 0 ? 300.0f : 1.5f;
        for (int k = 0; k < 6; ++k)
            masks.coordinates.push_back(on_lattice ? float(int(random.below(65)) - 32) / 16
                                                   : random.between(-scale, scale));
        for (int k = 0; k < 3 && has_alphas; ++k)
            masks.alphas.push_back(random.below(3) == 0 ? 1.0f : random.between(0, 1));
    }
    return masks;
}

}  // namespace support
