// SPDX-License-Identifier: MIT
// Sentences for people, from names that a stranger's file chose.
#include "messages.hpp"

#include "scene.hpp"

namespace gnomon::scene {

void fail(const std::filesystem::path& file, const std::string& what) { throw SceneError(file.string() + ": " + what); }

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string out = "'";
    for (const char c : text.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        out += byte < 0x20 || byte == 0x7F ? '?' : c;
    }
    if (text.size() > longest) out += "...";
    return out + "'";
}

std::string counted(std::size_t count, std::string_view thing) {
    return std::to_string(count) + " " + std::string(thing) + (count == 1 ? "" : "s");
}

std::string listed(const std::vector<std::string>& entries, std::size_t most) {
    std::string out;
    for (std::size_t i = 0; i < entries.size() && i < most; ++i) {
        if (i > 0) out += ", ";
        out += entries[i];
    }
    if (entries.size() > most) out += " and " + std::to_string(entries.size() - most) + " more";
    return out;
}

}  // namespace gnomon::scene
