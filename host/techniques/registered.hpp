// SPDX-License-Identifier: MIT
// The techniques of this wing, as the register of gnomon.cpp takes them. A technique's class stands in its own file.
#pragma once

#include <functional>
#include <gnomon.hpp>

namespace gnomon {

struct Registered {
    TechniqueDescription description;
    std::function<std::unique_ptr<Technique>(const Device&)> make;
};

template <typename T>
Registered registered(TechniqueDescription description = T::describe()) {
    return {std::move(description),
            [](const Device& device) -> std::unique_ptr<Technique> { return std::make_unique<T>(device); }};
}

Registered izb_technique();
Registered shadow_map_technique();
Registered virtual_shadow_map_technique();
Registered shadow_volumes_technique();
Registered sub_pixel_technique();
Registered conservative_map_technique();
/// Named compositions of the shadow-map family, each a technique of its own.
std::vector<Registered> shadow_map_presets();

}  // namespace gnomon
