// SPDX-License-Identifier: MIT
// The outside of a glTF file: the JSON text, and the range of the binary chunk in a .glb. A file that begins with
// "glTF" is a .glb, whatever its name. This file does not read the binary chunk: the chunk is read directly into its
// buffer.
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

/// Size of a regular file. Throws SceneError (its text names `scene_file`) if `file` is missing or something else.
std::uint64_t file_size(const std::filesystem::path& file, const std::filesystem::path& scene_file);

/// Reads bytes [offset, offset + size) of `file`, which must have them. Throws SceneError.
std::vector<unsigned char> read_bytes(const std::filesystem::path& file, const ByteRange& range,
                                      const std::filesystem::path& scene_file);

}  // namespace gnomon::scene
