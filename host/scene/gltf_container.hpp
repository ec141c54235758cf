// SPDX-License-Identifier: MIT
// The outside of a glTF file: the JSON text, and where a .glb keeps its binary chunk. The contents decide whether it is
// a .glb (they begin with "glTF"), not the name. The binary chunk is not read here: it goes straight into the buffer
// that it becomes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::scene {

struct ByteRange {
    std::uint64_t offset = 0, size = 0;
};

struct GltfContainer {
    std::string json;
    std::optional<ByteRange> binary_chunk;  ///< of a .glb, if it has one; lies within the file
    bool is_glb = false;
};

/// Throws SceneError if the file is missing, no regular file, empty, cut off, or plainly no glTF.
GltfContainer read_container(const std::filesystem::path& file);

/// Size of a regular file. Throws SceneError (speaking of `scene_file`) if `file` is missing or something else.
std::uint64_t file_size(const std::filesystem::path& file, const std::filesystem::path& scene_file);

/// Reads bytes [offset, offset + size) of `file`, which must have them. Throws SceneError.
std::vector<unsigned char> read_bytes(const std::filesystem::path& file, const ByteRange& range,
                                      const std::filesystem::path& scene_file);

}  // namespace gnomon::scene
