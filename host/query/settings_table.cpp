// SPDX-License-Identifier: MIT
#include "query/settings_table.hpp"

#include <charconv>

namespace gnomon {
namespace {

template <typename Number>
std::string text_of(Number number) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

template <typename Number>
Number parsed(const SettingText& value, Number low, Number high, const char* kind) {
    const std::string_view text = value.text;
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    // The comparison is false for NaN too.
    if (error == std::errc() && end == text.data() + text.size() && number >= low && number <= high) return number;
    throw InvalidArgument(std::string(value.name) + " is " + kind + " from " + text_of(low) + " to " + text_of(high) +
                          ", not \"" + std::string(text) + "\"");
}

// "a, b or c": the text that name_of gives for each.
template <typename List, typename NameOf>
std::string listed(const List& list, const char* last_joint, const NameOf& name_of) {
    std::string text;
    for (std::size_t i = 0; i < list.size(); ++i)
        text.append(i == 0 ? "" : i + 1 == list.size() ? last_joint : ", ").append(name_of(list[i]));
    return text;
}

}  // namespace

float SettingText::number(double low, double high) const {
    return static_cast<float>(parsed(*this, low, high, "a number"));
}

std::optional<float> SettingText::number_or_auto(double low, double high) const {
    return text == "auto" ? std::nullopt : std::optional(number(low, high));
}

std::uint32_t SettingText::whole(std::uint32_t low, std::uint32_t high) const {
    return parsed(*this, low, high, "a whole number");
}

std::uint32_t SettingText::whole_or_auto(std::uint32_t low, std::uint32_t high) const {
    return text == "auto" ? 0 : parsed(*this, low, high, "auto or a whole number");
}

std::uint32_t SettingText::choice(std::span<const std::string_view> names) const {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == text) return static_cast<std::uint32_t>(i);
    throw InvalidArgument(std::string(name) + " is " + listed(names, " or ", std::identity()) + ", not \"" +
                          std::string(text) + "\"");
}

std::optional<std::uint32_t> SettingText::choice_or_auto(std::span<const std::string_view> names) const {
    const std::uint32_t chosen = choice(names);
    return chosen + 1 == names.size() ? std::nullopt : std::optional(chosen);
}

void throw_no_setting(std::string_view technique, std::string_view name, std::span<const SettingDescription> settings) {
    throw InvalidArgument(std::string(technique) + " has no setting \"" + std::string(name) + "\": it has " +
                          listed(settings, " and ", std::mem_fn(&SettingDescription::name)));
}

}  // namespace gnomon
