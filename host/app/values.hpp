// SPDX-License-Identifier: MIT
// The values of options, from text and back. Every function takes the option's name, so that its error names the wrong
// option. Numbers are float32 by strtof: the light and the camera get exactly the written number, rounded once;
// float_text() prints enough digits (9) to give the same bits again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
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

/// One finite number and nothing after it.
float parse_float(const std::string& option, const std::string& text);
/// The same as a double, for times.
double parse_double(const std::string& option, const std::string& text);
/// "x,y,z", each as parse_float.
Float3 parse_float3(const std::string& option, const std::string& text);
/// Three of them, with commas between: nine numbers.
std::array<Float3, 3> parse_three_float3(const std::string& option, const std::string& text);
/// "WxH", each from 1 to largest_side_px.
ImageSize parse_size(const std::string& option, const std::string& text);
/// "X,Y", each from 0.
Pixel parse_pixel(const std::string& option, const std::string& text);
/// A number of bytes above 0, with K, M, G or T for powers of 1024.
std::uint64_t parse_bytes(const std::string& option, const std::string& text);
/// A whole number from `least` to `largest`.
std::uint32_t parse_count(const std::string& option, const std::string& text, std::uint32_t least,
                          std::uint32_t largest);
/// "key=value", the value may contain further equals signs.
std::pair<std::string, std::string> parse_setting(const std::string& option, const std::string& text);
/// A name that is not empty and is not shaped like an option ("--mask --quiet": a forgotten value).
std::string parse_name(const std::string& option, const std::string& text);
/// A file name with the given extension in any case (".png"); an empty extension allows all.
std::filesystem::path parse_file(const std::string& option, const std::string& text, std::string_view extension);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

/// 9 significant digits: strtof gives the same float again.
std::string float_text(float value);
/// "x,y,z" by float_text, in the form that an option takes.
std::string float3_text(const Float3& value);

}  // namespace gnomon::app
