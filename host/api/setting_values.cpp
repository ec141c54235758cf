// SPDX-License-Identifier: MIT
#include "api/setting_values.hpp"

#include <charconv>

namespace gnomon {
namespace {

template <typename Number>
std::string text_of(Number number) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

template <typename Number>
Number parsed(std::string_view name, std::string_view text, Number low, Number high, const char* kind) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    // The comparison is false for NaN too.
    if (error == std::errc() && end == text.data() + text.size() && number >= low && number <= high) return number;
    throw InvalidArgument(std::string(name) + " is " + kind + " from " + text_of(low) + " to " + text_of(high) +
                          ", not \"" + std::string(text) + "\"");
}

}  // namespace

float number_setting(std::string_view name, std::string_view text, double low, double high) {
    return static_cast<float>(parsed(name, text, low, high, "a number"));
}

std::uint32_t whole_setting(std::string_view name, std::string_view text, std::uint32_t low, std::uint32_t high) {
    return parsed(name, text, low, high, "a whole number");
}

std::uint32_t whole_or_auto_setting(std::string_view name, std::string_view text, std::uint32_t low,
                                    std::uint32_t high) {
    return text == "auto" ? 0 : parsed(name, text, low, high, "auto or a whole number");
}

std::uint32_t choice_setting(std::string_view name, std::string_view text, std::span<const std::string_view> names) {
    std::string listed;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == text) return static_cast<std::uint32_t>(i);
        listed.append(i == 0 ? "" : i + 1 == names.size() ? " or " : ", ").append(names[i]);
    }
    throw InvalidArgument(std::string(name) + " is " + listed + ", not \"" + std::string(text) + "\"");
}

}  // namespace gnomon
