// SPDX-License-Identifier: MIT
// The classic techniques; each function stands in its technique's file.
#pragma once

#include "technique/registered.hpp"

namespace gnomon {

Registered izb_technique();
Registered shadow_map_technique();
Registered virtual_shadow_map_technique();
Registered shadow_volumes_technique();
Registered sub_pixel_technique();
Registered conservative_map_technique();
/// Named compositions of the shadow-map family, each a technique of its own.
std::vector<Registered> shadow_map_presets();

}  // namespace gnomon
