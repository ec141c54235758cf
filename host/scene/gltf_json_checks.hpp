// SPDX-License-Identifier: MIT
// The checks of the JSON before tinygltf reads it. tinygltf 2.7 ignores a property of the wrong type or sign (a
// negative byteOffset becomes 0, a mesh "3" no mesh), truncates integers to 32 bits and leaves most indices unchecked;
// so types, ranges and indices are checked here, on the exact numbers of the file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace gnomon::scene {

/// Parses the text. Throws SceneError with the byte of the first error, or if the text nests too deep (the recursive
/// code of tinygltf and nlohmann would run out of stack).
nlohmann::json parse_json(const std::filesystem::path& file, const std::string& text);

/// Throws SceneError, naming the property, unless every property that gnomon or tinygltf reads has its type and range,
/// every index is within its array, the version is 2.x and no required extension is unknown.
void check_json(const std::filesystem::path& file, const nlohmann::json& root);

/// True for extensions that change a surface's colour but not its position: safe to ignore without a warning.
bool concerns_shading_only(std::string_view extension);

}  // namespace gnomon::scene
