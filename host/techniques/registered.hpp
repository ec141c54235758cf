// SPDX-License-Identifier: MIT
// The register of techniques. A technique's class stands in its own file, and its name in the list here.
#pragma once

#include <functional>
#include <gnomon.hpp>

namespace gnomon {

struct Registered {
    TechniqueDescription description;
    std::function<std::unique_ptr<Technique>(const Device&)> make;
};

template <typename T>
Registered registered() {
    return {T::describe(), [](const Device& device) { return std::make_unique<T>(device); }};
}

/// The techniques in the order of techniques(); each function stands in its technique's file. The same text declares
/// the functions here and calls them in gnomon.cpp.
#define GN_TECHNIQUES                                                                                    \
    frustum_traced_technique(), izb_technique(), shadow_map_technique(), virtual_shadow_map_technique(), \
        shadow_volumes_technique(), sub_pixel_technique(), conservative_map_technique()
Registered GN_TECHNIQUES;

/// Named compositions of the shadow-map family, each a technique of its own.
std::vector<Registered> shadow_map_presets();

}  // namespace gnomon
