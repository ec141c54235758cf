// SPDX-License-Identifier: MIT
// Whole scenes as subjects: those of the scene maker, made in memory, and those of ../shared/scenes.
#pragma once

#include <filesystem>
#include <string_view>

#include "points.hpp"

namespace stress {

/// A recipe of tools/make_scenes with its cameras and lights.
Subject made_scene(std::string_view recipe, std::uint64_t seed, std::uint32_t triangles = 0);

/// A scene file with the views and lights that views.json, beside it, has for it.
Subject shared_scene(const std::filesystem::path& file);

}  // namespace stress
