// SPDX-License-Identifier: MIT
// Values of options: strict readers (no trailing characters, no NaN, no infinity), each with its error message.
#include "values.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "terminal.hpp"

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

/// The number that the digits of `text` spell, or nothing for a number beyond these limits.
std::optional<std::uint64_t> whole_number_of(std::string_view text, std::uint64_t least, std::uint64_t largest) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end || value < least || value > largest) return std::nullopt;
    return value;
}

/// What `read` finds in each of the `count` parts of a text; nothing if a part is missing or wrong.
template <std::size_t count, typename Value, typename Read>
std::optional<std::array<Value, count>> list_of(const std::string& text, char separator, const Read& read) {
    std::array<Value, count> values{};
    std::size_t first = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t end = i + 1 < count ? text.find(separator, first) : text.size();
        const auto value = end != std::string::npos ? read(text.substr(first, end - first)) : std::nullopt;
        if (!value) return std::nullopt;
        values[i] = Value(*value);
        first = end + 1;
    }
    return values;
}

/// Two whole numbers, each from `least` to `largest`.
std::optional<std::array<std::uint32_t, 2>> pair_of(const std::string& text, char separator, std::uint32_t least,
                                                    std::uint32_t largest) {
    return list_of<2, std::uint32_t>(text, separator,
                                     [=](const std::string& part) { return whole_number_of(part, least, largest); });
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

/// The number of bits that a suffix of bytes shifts by; 0 for another character.
int suffix_shift(char suffix) {
    const std::size_t power = std::string_view("kmgt").find(char(std::tolower(static_cast<unsigned char>(suffix))));
    return power == std::string_view::npos ? 0 : 10 * int(power + 1);
}

}  // namespace

float parse_float(const std::string& option, const std::string& text) {
    const std::optional<float> value = float_of(text);
    if (!value) refuse(option, "a finite number", text);
    return *value;
}

double parse_double(const std::string& option, const std::string& text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end || !std::isfinite(value)) refuse(option, "a finite number", text);
    return value;
}

Float3 parse_float3(const std::string& option, const std::string& text) {
    const auto value = list_of<3, float>(text, ',', float_of);
    if (!value) refuse(option, "three finite numbers x,y,z", text);
    return *value;
}

std::array<Float3, 3> parse_three_float3(const std::string& option, const std::string& text) {
    const auto values = list_of<9, float>(text, ',', float_of);
    if (!values) refuse(option, "nine finite numbers: a corner and two edges, x,y,z each", text);
    const auto& v = *values;
    return {Float3{v[0], v[1], v[2]}, Float3{v[3], v[4], v[5]}, Float3{v[6], v[7], v[8]}};
}

ImageSize parse_size(const std::string& option, const std::string& text) {
    const auto size = pair_of(text, 'x', 1, largest_side_px);
    if (!size) refuse(option, "WIDTHxHEIGHT in pixels, each from 1 to " + std::to_string(largest_side_px), text);
    return {(*size)[0], (*size)[1]};
}

Pixel parse_pixel(const std::string& option, const std::string& text) {
    const auto pixel = pair_of(text, ',', 0, largest_side_px - 1);
    if (!pixel) refuse(option, "a pixel X,Y, counted from 0 at the upper left corner", text);
    return {(*pixel)[0], (*pixel)[1]};
}

std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
    std::string_view digits = text;
    const int shift = text.empty() ? 0 : suffix_shift(text.back());
    if (shift != 0) digits.remove_suffix(1);
    const auto number = whole_number_of(digits, 1, std::numeric_limits<std::uint64_t>::max() >> shift);
    if (!number) refuse(option, "a number of bytes above 0, such as 1500000, 512M or 2G", text);
    return *number << shift;
}

std::uint32_t parse_count(const std::string& option, const std::string& text, std::uint32_t least,
                          std::uint32_t largest) {
    const auto number = whole_number_of(text, least, largest);
    if (!number)
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
    if (!extension.empty() && lower_extension(file) != extension)
        refuse(option, "a file name that ends in " + std::string(extension), text);
    return file;
}

std::string lower_extension(const std::filesystem::path& file) { return lower_case(file.extension().string()); }

std::string float_text(float value) {
    return formatted("%.*g", std::numeric_limits<float>::max_digits10, double(value));
}

std::string float3_text(const Float3& value) {
    return float_text(value[0]) + "," + float_text(value[1]) + "," + float_text(value[2]);
}

}  // namespace gnomon::app
