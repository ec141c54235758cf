// SPDX-License-Identifier: MIT
// A glTF file in memory, through tinygltf, with checked references: indices, extents, strides, the node hierarchy. The
// code that uses a GltfDocument may read its accessors without a further check, except for the values in them (vertex
// indices, sparse indices).
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace gnomon::scene {

struct GltfDocument {
    tinygltf::Model model;
    std::vector<int> root_nodes;          ///< of the scene that is shown
    std::set<std::string> not_supported;  ///< phrases for the one warning, from the document alone
};

/// Throws SceneError.
GltfDocument read_document(const std::filesystem::path& file);

/// Bytes of one element, without padding.
std::size_t element_bytes(const tinygltf::Accessor& accessor);

}  // namespace gnomon::scene
