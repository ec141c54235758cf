// SPDX-License-Identifier: MIT
// Whole scenes as subjects: those of the scene maker, made in memory, and the real ones of scenes/.
#pragma once

#include <string_view>

#include "points.hpp"

namespace stress {

/// A recipe of tools/make_scenes with its cameras and lights.
Subject made_scene(std::string_view recipe, std::uint64_t seed, std::uint32_t triangles = 0);

/// scenes/NAME.glb with the views and lights that scenes/views.json has for it.
Subject real_scene(const std::string& name);

}  // namespace stress
