// SPDX-License-Identifier: MIT
// Sentences for people, with names that a stranger's file chose.
#include "gltf.hpp"

#include "scene.hpp"

namespace gnomon::scene {
namespace {

std::string without_control_characters(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7F) c = '?';
    return out;
}

}  // namespace

// `what` may contain unquoted words of the file: property names, or the text of a tinygltf error.
void fail(const std::filesystem::path& file, const std::string& what) {
    throw SceneError(file.string() + ": " + without_control_characters(what));
}

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string out = "'";
    out += without_control_characters(text.substr(0, longest));
    if (text.size() > longest) out += "...";
    return out + "'";
}

std::string word_or_quotes(std::string_view name) {
    constexpr std::string_view word = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    const bool is_word = !name.empty() && name.size() <= 30 && name.find_first_not_of(word) == std::string_view::npos;
    return is_word ? std::string(name) : in_quotes(name);
}

std::string counted(std::size_t count, std::string_view thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string listed(const std::vector<std::string>& entries, std::size_t most) {
    std::string out;
    for (std::size_t i = 0; i < entries.size() && i < most; ++i) {
        if (i > 0) out += ", ";
        out += entries[i];
    }
    if (entries.size() > most) out += fmt::format(" and {} more", entries.size() - most);
    return out;
}

}  // namespace gnomon::scene
