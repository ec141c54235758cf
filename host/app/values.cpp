// SPDX-License-Identifier: MIT
// Values of options: strict readers (no trailing characters, no NaN, no infinity), each with what its error asks for.
#include "values.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

namespace gnomon::app {
namespace {

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

std::optional<double> double_of(const std::string& text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// Without blanks at its ends: "48.2, 16.4" is what maps copy.
std::string without_blanks(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

/// What `read` finds in each of the `count` parts of a text; nothing if a part is missing or wrong.
template <std::size_t count, typename Value, typename Read>
std::optional<std::array<Value, count>> list_of(const std::string& text, char separator, const Read& read) {
    std::array<Value, count> values{};
    std::size_t first = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t end = i + 1 < count ? text.find(separator, first) : text.size();
        const auto value =
            end != std::string::npos ? read(without_blanks(text.substr(first, end - first))) : std::nullopt;
        if (!value) return std::nullopt;
        values[i] = Value(*value);
        first = end + 1;
    }
    return values;
}

/// Two whole numbers, each from `least` to `largest`, as a `Pair`.
template <typename Pair>
std::function<std::optional<Pair>(const std::string&)> pair_of(char separator, std::uint32_t least,
                                                               std::uint32_t largest) {
    return [=](const std::string& text) -> std::optional<Pair> {
        const auto read = [=](const std::string& part) { return whole_number_of(part, least, largest); };
        const auto two = list_of<2, std::uint32_t>(text, separator, read);
        return two ? std::optional(Pair{(*two)[0], (*two)[1]}) : std::nullopt;
    };
}

std::optional<std::array<Float3, 3>> nine_of(const std::string& text) {
    const auto v = list_of<9, float>(text, ',', float_of);
    if (!v) return std::nullopt;
    return std::array<Float3, 3>{Float3{(*v)[0], (*v)[1], (*v)[2]}, Float3{(*v)[3], (*v)[4], (*v)[5]},
                                 Float3{(*v)[6], (*v)[7], (*v)[8]}};
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

std::optional<std::uint64_t> bytes_of(const std::string& text) {
    std::string_view digits = text;
    const int shift = text.empty() ? 0 : suffix_shift(text.back());
    if (shift != 0) digits.remove_suffix(1);
    const auto number = whole_number_of(digits, 1, std::numeric_limits<std::uint64_t>::max() >> shift);
    return number ? std::optional(*number << shift) : std::nullopt;
}

std::optional<std::pair<std::string, std::string>> setting_of(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) return std::nullopt;
    return std::pair(text.substr(0, equals), text.substr(equals + 1));
}

}  // namespace

Kind<float> number() { return {float_of, "a finite number"}; }

Kind<double> double_number() { return {double_of, "a finite number"}; }

Kind<Float3> three_numbers() {
    return {[](const std::string& text) { return list_of<3, float>(text, ',', float_of); },
            "three finite numbers x,y,z"};
}

Kind<std::array<Float3, 3>> nine_numbers() {
    return {nine_of, "nine finite numbers: a corner and two edges, x,y,z each"};
}

Kind<std::array<double, 2>> latitude_longitude() {
    const Kind<std::array<double, 2>> two{
        [](const std::string& text) { return list_of<2, double>(text, ',', double_of); }, {}};
    return only(two, "a latitude from -90 to 90 and a longitude from -180 to 180 in decimal degrees, such as 48.2,16.4",
                [](const auto& degrees) { return std::abs(degrees[0]) <= 90 && std::abs(degrees[1]) <= 180; });
}

Kind<ImageSize> image_size() {
    return {pair_of<ImageSize>('x', 1, largest_side_px),
            fmt::format("WIDTHxHEIGHT in pixels, each from 1 to {}", largest_side_px)};
}

Kind<Pixel> pixel() {
    return {pair_of<Pixel>(',', 0, largest_side_px - 1), "a pixel X,Y, counted from 0 at the upper left corner"};
}

Kind<std::uint64_t> bytes() { return {bytes_of, "a number of bytes above 0, such as 1500000, 512M or 2G"}; }

Kind<std::uint32_t> count(std::uint32_t least, std::uint32_t largest) {
    return {
        [=](const std::string& text) { return std::optional<std::uint32_t>(whole_number_of(text, least, largest)); },
        fmt::format("a whole number from {} to {}", least, largest)};
}

Kind<std::pair<std::string, std::string>> setting() { return {setting_of, "key=value"}; }

Kind<std::string> name() {
    const Kind<std::string> any{[](const std::string& text) { return std::optional(text); }, {}};
    return only(any, "a value", [](const std::string& text) { return !text.empty() && !text.starts_with("--"); });
}

Kind<std::filesystem::path> file_name(const std::string& extension) {
    const auto read = [=](const std::string& text) -> std::optional<std::filesystem::path> {
        const bool is_name = !text.empty() && !text.starts_with("-");
        if (!is_name || (!extension.empty() && lower_extension(text) != extension)) return std::nullopt;
        return text;
    };
    return {read, "a file name" + (extension.empty() ? "" : " that ends in " + extension) +
                      " (./-name if it begins with a minus)"};
}

std::string lower_extension(const std::filesystem::path& file) { return lower_case(file.extension().string()); }

std::string float_text(float value) { return fmt::format("{:.9g}", double(value)); }

std::string float3_text(const Float3& value) {
    return fmt::format("{:.9g},{:.9g},{:.9g}", double(value[0]), double(value[1]), double(value[2]));
}

}  // namespace gnomon::app
