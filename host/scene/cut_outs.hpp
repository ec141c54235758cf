// SPDX-License-Identifier: MIT
// The cut-outs of a glTF file: its masked materials, from the JSON (tinygltf sees no textures), and their alpha images.
#pragma once

#include "gltf.hpp"
#include "scene.hpp"

namespace gnomon::scene {

/// Reads the JSON as far as masks need it. Nothing here throws: what is broken makes the mask unreadable.
MaskSources mask_sources(const nlohmann::json& root);

/// The bytes of an image's file. Throws SceneError.
std::vector<unsigned char> image_bytes(const std::filesystem::path& file, const tinygltf::Model& model,
                                       const ImageSource& source);

}  // namespace gnomon::scene
