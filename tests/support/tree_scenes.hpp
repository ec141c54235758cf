// SPDX-License-Identifier: MIT
// Triangles that are hard to make a tree of: few, coincident, nested, or not finite.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene_makers.hpp"

namespace support {

struct TreeScene {
    std::string name;
    Floats triangles;
};

inline Floats strewn_triangles(std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    Floats made;
    for (std::size_t i = 0; i < count; ++i) {
        const float at[3] = {float(random.below(1000)), float(random.below(1000)), float(random.below(1000))};
        for (int k = 0; k < 9; ++k) made.push_back(at[k % 3] + size * float(random.below(1000)) / 1000);
    }
    return made;
}

/// Each triangle's box contains those of all before it, and is larger by the factor.
inline Floats nested_triangles(std::size_t count, float factor) {
    Floats made;
    float size = 1e-30f;
    for (std::size_t i = 0; i < count; ++i, size = std::min(size * factor, 1e5f))
        append(made, {-size, -size, -size, size, size, -size, -size, size, size});
    return made;
}

inline std::vector<TreeScene> tree_scenes() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<TreeScene> made{{"one", strewn_triangles(1, 1, 1)},
                                {"two", strewn_triangles(2, 1, 2)},
                                {"a leaf and one", strewn_triangles(17, 1, 3)},
                                {"small ones", strewn_triangles(5000, 3, 4)},
                                {"large ones", strewn_triangles(3000, 900, 5)},
                                {"nested, by tenths", nested_triangles(2500, 1.1f)},
                                {"nested, twice as large each", nested_triangles(300, 2)},
                                {"coincident", {}},
                                {"some not finite", strewn_triangles(700, 3, 6)},
                                {"none finite", Floats(9 * 40, nan)}};
    for (int i = 0; i < 2000; ++i) append(made[7].triangles, {1, 2, 3, 4, 2, 3, 1, 5, 3});
    for (std::size_t i = 0; i < made[8].triangles.size(); i += 50)
        made[8].triangles[i] = i % 100 == 0 ? nan : std::numeric_limits<float>::infinity();
    return made;
}

/// The numbers of the finite triangles, rising.
inline std::vector<std::uint32_t> finite_triangles(const Floats& triangles) {
    std::vector<std::uint32_t> ids;
    for (std::size_t i = 0; i < triangles.size(); i += 9)
        if (std::all_of(&triangles[i], &triangles[i] + 9, [](float x) { return std::isfinite(x); }))
            ids.push_back(static_cast<std::uint32_t>(i / 9));
    return ids;
}

}  // namespace support
