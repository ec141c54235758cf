// SPDX-License-Identifier: MIT
#include "request.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <string_view>

namespace gnomon::app {
namespace {

constexpr std::size_t longest_value = 200;

/// What all commands take.
constexpr std::array camera_options{"size", "camera", "eye", "target", "up", "fovy", "time", "animation"};
/// What gnomon hours does not take.
constexpr std::array light_options{"light", "light-direction", "light-position"};
/// What only gnomon render takes.
constexpr std::array picture_options{"samples", "sun-angle", "sun-samples", "ambient", "exposure", "technique", "set"};
/// What only gnomon hours takes.
constexpr std::array hours_options{"place", "day", "step", "north", "most"};

template <typename Names>
bool has(const Names& names, std::string_view name) {
    return std::ranges::find(names, name) != names.end();
}

/// The scene, and what of it is shown: what gnomon view was started with.
std::vector<std::string> scene_arguments(const PageOptions& page, const Parameters& parameters) {
    std::vector<std::string> arguments;
    if (page.scene) arguments.push_back(page.scene->string());
    if (page.scene_choice) arguments.push_back("--scene=" + *page.scene_choice);
    if (page.animation && !parameters.contains("animation")) arguments.push_back("--animation=" + *page.animation);
    if (page.blend == scene::BlendCasters::clear) arguments.emplace_back("--blend=clear");
    if (page.blend == scene::BlendCasters::mask) arguments.emplace_back("--blend=mask");
    return arguments;
}

std::string option_text(const std::string& name, const std::string& value) {
    if (value.size() > longest_value || value.find('\0') != std::string::npos)
        throw UsageError("the value of " + name + " is too long, or holds a NUL");
    return fmt::format("--{}={}", name, value);
}

/// The command, the scene, and those parameters that `takes` by their name.
template <typename Takes>
std::vector<std::string> arguments_of(const char* command, const PageOptions& page, const Parameters& parameters,
                                      const Takes& takes) {
    std::vector<std::string> arguments = scene_arguments(page, parameters);
    arguments.insert(arguments.begin(), command);
    for (const auto& [name, value] : parameters)
        if (has(camera_options, name) || takes(name)) arguments.push_back(option_text(name, value));
    return arguments;
}

void require_size(const ViewOptions& options) {
    if (std::uint64_t(options.size.width) * options.size.height > most_pixels)
        throw UsageError(fmt::format("a picture of the page has at most {} pixels", most_pixels));
}

void require_bounds(const RenderOptions& options) {
    require_size(options);
    if (options.sun_samples.value_or(0) > most_sun_samples)
        throw UsageError(fmt::format("a sun of the page has at most {} samples", most_sun_samples));
    if (options.sky_division > most_sky_division)
        throw UsageError(fmt::format("a sky of the page is at most sky:{}", most_sky_division));
}

/// `text` in single quotes, unless a shell takes it as it is.
std::string quoted(const std::string& text) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,:+";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::vector<std::string> with_program(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "gnomon");
    return arguments;
}

std::string value_of(const Parameters& parameters, const std::string& name) {
    const auto found = parameters.find(name);
    if (found == parameters.end()) throw UsageError("the request has no " + name);
    return found->second;
}

}  // namespace

std::vector<std::string> render_arguments(const PageOptions& page, const Parameters& parameters) {
    std::vector<std::string> arguments = arguments_of("render", page, parameters, [](const std::string& name) {
        return has(light_options, name) || has(picture_options, name);
    });
    arguments.insert(arguments.end(), {"-o", "view.png"});
    return arguments;
}

std::vector<std::string> explain_arguments(const PageOptions& page, const Parameters& parameters) {
    return arguments_of("explain", page, parameters,
                        [](const std::string& name) { return has(light_options, name) || name == "pixel"; });
}

std::vector<std::string> hours_arguments(const PageOptions& page, const Parameters& parameters) {
    std::vector<std::string> arguments =
        arguments_of("hours", page, parameters, [](const std::string& name) { return has(hours_options, name); });
    arguments.insert(arguments.end(), {"-o", "hours.png"});
    return arguments;
}

RenderOptions render_request(const PageOptions& page, const Parameters& parameters) {
    RenderOptions options = render_options_of(with_program(render_arguments(page, parameters)));
    require_bounds(options);
    return options;
}

ExplainOptions explain_request(const PageOptions& page, const Parameters& parameters) {
    ExplainOptions options = explain_options_of(with_program(explain_arguments(page, parameters)));
    require_size(options);
    return options;
}

HoursOptions hours_request(const PageOptions& page, const Parameters& parameters) {
    HoursOptions options = hours_options_of(with_program(hours_arguments(page, parameters)));
    require_size(options);
    return options;
}

SunsOfPlace suns_request(const Parameters& parameters) {
    const auto argument = [&](const char* name) { return option_text(name, value_of(parameters, name)); };
    return *hours_options_of({"gnomon", "hours", argument("place"), argument("day"), "-o", "hours.png"}).place;
}

Parameters start_parameters(const PageOptions& page) {
    Parameters parameters;
    const auto add = [&](const char* name, const std::optional<std::string>& value) {
        if (value) parameters.emplace(name, *value);
    };
    const auto add_vector = [&](const char* name, const std::optional<Float3>& value) {
        if (value) parameters.emplace(name, float3_text(*value));
    };
    add("camera", page.camera);
    add_vector("eye", page.eye);
    add_vector("target", page.target);
    add_vector("up", page.up);
    if (page.fov_y_degrees) parameters.emplace("fovy", float_text(*page.fov_y_degrees));
    add("light", page.light);
    add_vector("light-direction", page.light_direction);
    add_vector("light-position", page.light_position);
    if (page.time_s) parameters.emplace("time", fmt::format("{}", *page.time_s));
    if (page.sun_angle_degrees) parameters.emplace("sun-angle", float_text(*page.sun_angle_degrees));
    if (page.sun_samples) parameters.emplace("sun-samples", std::to_string(*page.sun_samples));
    parameters.emplace("samples", std::to_string(page.samples));
    return parameters;
}

std::string shell_line(const std::vector<std::string>& arguments) {
    std::string line = "gnomon";
    for (const std::string& argument : arguments) line += fmt::format(" {}", quoted(argument));
    return line;
}

}  // namespace gnomon::app
