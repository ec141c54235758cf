// SPDX-License-Identifier: MIT
// The values of options, from text and back. Numbers are read by strtof and from_chars, not by CLI11: the light and the
// camera get exactly the written number, rounded once (CLI11 rounds to a long double first, reads 010 as 8, and its
// Range accepts nan); float_text() prints enough digits (9) to give the same bits again.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <gnomon.hpp>

namespace gnomon::app {

/// The command line itself is wrong (exit code 2; all other errors: 1). what() is one sentence.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct ImageSize {
    std::uint32_t width = 0, height = 0;
};

struct Pixel {
    std::uint32_t x = 0, y = 0;  ///< from the left, from the top
};

/// The largest picture side that look() accepts, in pixels.
inline constexpr std::uint32_t largest_side_px = 16384;

/// What an option takes: `read` finds the value that a text spells, or nothing; an error says what the option `needs`.
template <typename Value>
struct Kind {
    std::function<std::optional<Value>(const std::string& text)> read;
    std::string needs;
};

/// The values of `kind` that `accepts`.
template <typename Value, typename Accepts>
Kind<Value> only(const Kind<Value>& kind, std::string needs, Accepts accepts) {
    const auto read = [=](const std::string& text) {
        const std::optional<Value> value = kind.read(text);
        return value && accepts(*value) ? value : std::nullopt;
    };
    return {read, std::move(needs)};
}

/// One finite number and nothing after it; as a double, for times.
Kind<float> number();
Kind<double> double_number();
/// "x,y,z".
Kind<Float3> three_numbers();
/// Three of them, with commas between: nine numbers.
Kind<std::array<Float3, 3>> nine_numbers();
/// "latitude,longitude" in degrees.
Kind<std::array<double, 2>> latitude_longitude();
/// "WxH", each from 1 to largest_side_px.
Kind<ImageSize> image_size();
/// "X,Y", each from 0.
Kind<Pixel> pixel();
/// A number of bytes above 0, with K, M, G or T for powers of 1024.
Kind<std::uint64_t> bytes();
/// A whole number from `least` to `largest`.
Kind<std::uint32_t> count(std::uint32_t least, std::uint32_t largest);
/// "key=value", the value may contain further equals signs.
Kind<std::pair<std::string, std::string>> setting();
/// A name that is not empty and is not shaped like an option ("--mask --quiet": a forgotten value).
Kind<std::string> name();
/// A file name with the given extension in any case (".png"); an empty extension allows all.
Kind<std::filesystem::path> file_name(const std::string& extension = {});

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

/// 9 significant digits: strtof gives the same float again.
std::string float_text(float value);
/// "x,y,z" by float_text, in the form that an option takes.
std::string float3_text(const Float3& value);

}  // namespace gnomon::app
