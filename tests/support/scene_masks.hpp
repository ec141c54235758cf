// SPDX-License-Identifier: MIT
// A loaded scene's cut-outs in the oracle's form.
#pragma once

#include "reference/masks.hpp"
#include "scene/scene.hpp"

namespace support {

inline reference::Masks masks_of(const gnomon::scene::Scene& scene) {
    using namespace gnomon;
    const scene::SceneCutOuts& from = scene.cut_outs;
    reference::Masks masks{from.material_of_triangle, scene.texture_coordinates, from.corner_alphas, {}, {}};
    const auto wrap = [](TextureWrap w) {
        return w == TextureWrap::repeat   ? reference::MaskWrap::repeat
               : w == TextureWrap::mirror ? reference::MaskWrap::mirror
                                          : reference::MaskWrap::clamp;
    };
    for (const CutOutMaterial& m : from.materials)
        masks.materials.push_back({m.texture == no_texture ? -1 : std::int64_t(m.texture), wrap(m.wrap_u),
                                   wrap(m.wrap_v), m.filter == TextureFilter::linear, m.cutoff, m.alpha_factor});
    for (const auto& t : from.textures) masks.textures.push_back({t.width, t.height, t.alpha});
    return masks;
}

}  // namespace support
