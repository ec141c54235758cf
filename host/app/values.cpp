// SPDX-License-Identifier: MIT
// Values of options: strict readers (no trailing characters, no NaN, no infinity), each with its error message.
#include "values.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

namespace gnomon::app {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& needs, const std::string& text) {
    throw UsageError(option + " needs " + needs + ", not \"" + text + "\"");
}

/// The finite float that all of `text` spells, or nothing.
std::optional<float> float_of(const std::string& text) {
    // strtof would skip blanks in front. Blanks behind the number are refused, so blanks in front are refused, too.
    if (text.empty() || std::isspace(static_cast<unsigned char>(text.front()))) return std::nullopt;
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    const bool all_read = end == text.c_str() + text.size();  // also refuses a NUL inside
    if (!all_read || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// The number that the digits of `text` spell, or nothing (also if it does not fit).
std::optional<std::uint64_t> whole_number_of(std::string_view text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end) return std::nullopt;
    return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == separator)
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

/// The number of bits that a suffix of bytes shifts by, or nothing for another text.
std::optional<int> suffix_shift(char suffix) {
    const std::size_t power = std::string_view("kmgt").find(char(std::tolower(static_cast<unsigned char>(suffix))));
    if (power == std::string_view::npos) return std::nullopt;
    return 10 * int(power + 1);
}

}  // namespace

float parse_float(const std::string& option, const std::string& text) {
    const std::optional<float> value = float_of(text);
    if (!value) refuse(option, "a finite number", text);
    return *value;
}

Float3 parse_float3(const std::string& option, const std::string& text) {
    const char* const needs = "three finite numbers x,y,z";
    const std::vector<std::string> parts = split(text, ',');
    if (parts.size() != 3) refuse(option, needs, text);
    Float3 result{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::optional<float> value = float_of(parts[i]);
        if (!value) refuse(option, needs, text);
        result[i] = *value;
    }
    return result;
}

ImageSize parse_size(const std::string& option, const std::string& text) {
    const std::string needs = "WIDTHxHEIGHT in pixels, each from 1 to " + std::to_string(largest_side_px);
    const std::vector<std::string> parts = split(text, 'x');
    if (parts.size() != 2) refuse(option, needs, text);
    const auto width = whole_number_of(parts[0]), height = whole_number_of(parts[1]);
    const auto is_a_side = [](const std::optional<std::uint64_t>& side) {
        return side && *side >= 1 && *side <= largest_side_px;
    };
    if (!is_a_side(width) || !is_a_side(height)) refuse(option, needs, text);
    return {std::uint32_t(*width), std::uint32_t(*height)};
}

Pixel parse_pixel(const std::string& option, const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    const auto x = whole_number_of(parts.front()), y = whole_number_of(parts.back());
    const auto fits = [](const auto& side) { return side && *side < largest_side_px; };
    if (parts.size() != 2 || !fits(x) || !fits(y))
        refuse(option, "a pixel X,Y, counted from 0 at the upper left corner", text);
    return {std::uint32_t(*x), std::uint32_t(*y)};
}

std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
    const char* const needs = "a number of bytes above 0, such as 1500000, 512M or 2G";
    std::string_view digits = text;
    const std::optional<int> shift = text.empty() ? std::nullopt : suffix_shift(text.back());
    if (shift) digits.remove_suffix(1);
    const auto number = whole_number_of(digits);
    const bool fits = number && *number <= (std::numeric_limits<std::uint64_t>::max() >> shift.value_or(0));
    if (!fits || *number == 0) refuse(option, needs, text);
    return *number << shift.value_or(0);
}

std::uint32_t parse_count(const std::string& option, const std::string& text, std::uint32_t largest,
                          std::uint32_t least) {
    const auto number = whole_number_of(text);
    if (!number || *number < least || *number > largest)
        refuse(option, "a whole number from " + std::to_string(least) + " to " + std::to_string(largest), text);
    return static_cast<std::uint32_t>(*number);
}

std::pair<std::string, std::string> parse_setting(const std::string& option, const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) refuse(option, "key=value", text);
    return {text.substr(0, equals), text.substr(equals + 1)};
}

std::string parse_name(const std::string& option, const std::string& text) {
    if (text.empty() || text.starts_with("--")) refuse(option, "a value", text);
    return text;
}

std::filesystem::path parse_file(const std::string& option, const std::string& text, std::string_view extension) {
    if (text.empty() || text.starts_with("-")) refuse(option, "a file name (./-name if it begins with a minus)", text);
    const std::filesystem::path file(text);
    if (!extension.empty() && lower_case(file.extension().string()) != extension)
        refuse(option, "a file name that ends in " + std::string(extension), text);
    return file;
}

std::string float_text(float value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.*g", std::numeric_limits<float>::max_digits10, double(value));
    return text.data();
}

std::string float3_text(const Float3& value) {
    return float_text(value[0]) + "," + float_text(value[1]) + "," + float_text(value[2]);
}

}  // namespace gnomon::app
