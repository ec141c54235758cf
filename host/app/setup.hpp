// SPDX-License-Identifier: MIT
// The common start of every command that renders: a device, a scene with its warnings, a technique with its settings.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "options.hpp"
#include "scene/scene.hpp"

namespace gnomon::app {

/// Opens the device of the options; with `profile` kernels are timed by events.
Device open_device(const ViewOptions& options, bool profile);

/// Loads the scene, or the built-in sundial, and prints its warnings (or throws the first, under --strict).
scene::Scene load_scene(const ViewOptions& options);

/// Triangles alone, nine little-endian float32 each, as --dump-triangles writes them. Throws Error.
scene::Scene load_triangles(const std::filesystem::path& file);

/// Makes a technique and sets its settings, in their order.
std::unique_ptr<Technique> make_technique(const Device& device, const std::string& name,
                                          const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace gnomon::app
