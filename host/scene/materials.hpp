// SPDX-License-Identifier: MIT
// Alpha and base colour textures of a glTF file's materials, from the JSON (tinygltf sees no textures), and their
// images.
#pragma once

#include "gltf.hpp"
#include "scene.hpp"

namespace gnomon::scene {

/// Reads the JSON as far as textures need it. Nothing here throws: what is broken makes a texture unreadable.
MaterialSources material_sources(const nlohmann::json& root);

/// The bytes of an image's file. Throws SceneError.
std::vector<unsigned char> image_bytes(const std::filesystem::path& file, const tinygltf::Model& model,
                                       const ImageSource& source);

}  // namespace gnomon::scene
