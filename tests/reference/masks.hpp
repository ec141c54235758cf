// SPDX-License-Identifier: MIT
// Cut-outs: where a masked triangle is opaque, from the words of the contract, in rationals. No filter.
//
// A masked triangle blocks at the point X where the ray meets it only if texel(X) * alpha of the corners at X is at
// least 255 cutoff / factor, this in double and rounded once to a multiple of 2^-16. u, v and the corners' alpha at X
// are exact. Nearest: texels are closed squares, and one opaque texel at X suffices. Linear: the exact bilinear mean of
// the four texels whose centres lie around X.
#pragma once

#include <cstdint>
#include <vector>

#include "predicates.hpp"

namespace reference {

enum class MaskWrap { repeat, mirror, clamp };

struct MaskTexture {
    std::uint32_t width = 1, height = 1;
    std::vector<std::uint8_t> alpha{255};  ///< row by row
};

struct MaskMaterial {
    std::int64_t texture = -1;  ///< -1: alpha 255
    MaskWrap wrap_u = MaskWrap::repeat, wrap_v = MaskWrap::repeat;
    bool is_linear = true;
    float cutoff = 0.5f, factor = 1;
};

inline constexpr std::uint32_t NO_MATERIAL = 0xFFFFFFFFu;

struct Masks {
    std::vector<std::uint32_t> material;  ///< one per triangle; NO_MATERIAL: opaque
    std::vector<float> coordinates;       ///< u, v of three corners per triangle, or none
    std::vector<float> alphas;            ///< of three corners per triangle, or none
    std::vector<MaskMaterial> materials;
    std::vector<MaskTexture> textures;

    /// Whether triangle `id`, which the ray meets, is opaque there. Coordinates must be finite.
    bool is_opaque(std::uint32_t id, const Triangle& triangle, const Ray& ray) const;
};

}  // namespace reference
