// SPDX-License-Identifier: MIT
// The form of the errors of host/scene: one sentence that begins with the file and names the wrong part of it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::scene {

/// Throws SceneError "FILE: what".
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what);

/// A text of the file in quotes, fit for one line of a terminal: control characters replaced, cut after 60 bytes.
std::string in_quotes(std::string_view text);

/// A name of the file inside a path: unchanged if it is a plain word (POSITION), else in quotes.
std::string word_or_quotes(std::string_view name);

/// "3 triangles", "1 triangle".
std::string counted(std::size_t count, std::string_view thing);

/// "a, b, c and 4 more": at most `most` entries, so that a scene with a thousand entries still gives one readable line.
std::string listed(const std::vector<std::string>& entries, std::size_t most = 8);

}  // namespace gnomon::scene
