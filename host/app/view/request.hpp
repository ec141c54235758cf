// SPDX-License-Identifier: MIT
// What the page may ask for: options of gnomon render and gnomon explain, in the words of their command lines. The page
// names neither files nor devices, and what it asks for is bounded. Its request is read by the parser of the command
// line, so that the command that it copies makes the same picture.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "../options.hpp"

namespace gnomon::app {

/// The parameters of a request's address, decoded.
using Parameters = std::multimap<std::string, std::string>;

inline constexpr std::uint64_t most_pixels = 1u << 24;
inline constexpr std::uint32_t most_sun_samples = 1024, most_sky_division = 4;

/// The command line behind "gnomon" that makes this picture: "render", the scene with its options, the page's options.
/// Throws UsageError if the page may not set one of them, or if they ask for too much.
std::vector<std::string> render_arguments(const PageOptions& page, const Parameters& parameters);
/// The same that explains its pixel, the parameter `pixel`.
std::vector<std::string> explain_arguments(const PageOptions& page, const Parameters& parameters);
/// The same that colours the hours of a day: the parameters `place` and `day`, and how finely.
std::vector<std::string> hours_arguments(const PageOptions& page, const Parameters& parameters);

RenderOptions render_request(const PageOptions& page, const Parameters& parameters);
ExplainOptions explain_request(const PageOptions& page, const Parameters& parameters);
HoursOptions hours_request(const PageOptions& page, const Parameters& parameters);
/// The suns of the parameters `place` and `day`, every ten minutes.
SunsOfPlace suns_request(const Parameters& parameters);

/// What the page sets before anybody touches it: the options of gnomon view, as parameters.
Parameters start_parameters(const PageOptions& page);

/// "gnomon render ...", for a shell.
std::string shell_line(const std::vector<std::string>& arguments);

}  // namespace gnomon::app
