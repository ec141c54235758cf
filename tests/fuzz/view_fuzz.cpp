// SPDX-License-Identifier: MIT
// Fuzz target: the bytes are a request to the server of gnomon view, "name=value" lines behind a first line with its
// headers Host and Origin. Whatever they are, who asks is judged, and the request is refused with a reason or asks for
// a bounded picture; what the page copies is a command line that means the same, and names no file that the page named.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <gnomon.hpp>
#include "app/terminal.hpp"
#include "app/view/guard.hpp"
#include "app/view/request.hpp"
#include "require.hpp"

// The commands that the parser of command lines names, of which none is run here.
namespace gnomon::app {
void render(const RenderOptions&) {}
void hours(const HoursOptions&) {}
void explain(const ExplainOptions&) {}
void gallery(const GalleryOptions&) {}
void bench_device(const BenchOptions&) {}
void view(const PageOptions&) {}
void check_device(const ListDevices&) {}
std::string device_list() { return {}; }
std::string technique_list(const ListTechniques&) { return {}; }
void print_result(std::string_view) {}
std::string_view text_file(std::string_view) { return "\n"; }
}  // namespace gnomon::app

namespace {

using fuzz::require;
using namespace gnomon::app;

std::string_view next_line(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    return line;
}

void judge(std::string_view line) {
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string_view host = line.substr(0, space), origin = line.substr(std::min(line.size(), space + 1));
    if (is_own_host(host, "127.0.0.1")) require(host.find('/') == std::string_view::npos, "a host, and no path");
    if (is_own_origin(origin, host)) require(origin.empty() || origin.ends_with(host), "an origin of this host");
    require(equals_in_constant_time(host, origin) == (host == origin), "equal where equal");
}

bool is_bounded(const RenderOptions& options) {
    return std::uint64_t(options.size.width) * options.size.height <= most_pixels && options.size.width > 0 &&
           options.size.height > 0 && options.samples >= 1 && options.samples <= 32 &&
           options.sun_samples.value_or(1) <= most_sun_samples && options.sky_division <= most_sky_division;
}

void check_picture(const PageOptions& page, const Parameters& parameters) {
    const RenderOptions options = render_request(page, parameters);
    require(is_bounded(options), "a bounded picture");
    require(options.scene == page.scene && options.device.empty(), "the scene and the device of the start");
    require(options.picture == "view.png" && !options.mask && !options.aov && !options.triangle_dump &&
                !options.point_dump && !options.statistics && options.frames == 0,
            "no file but the picture's");
    for (const auto& eye : {options.eye, options.target, options.light_direction, options.light_position})
        if (eye) require(std::ranges::all_of(*eye, [](float c) { return std::isfinite(c); }), "finite numbers");
    const std::string line = shell_line(render_arguments(page, parameters));
    require(std::ranges::count(line, '\'') % 2 == 0 || line.find('\\') != std::string::npos, "closed quotes");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    judge(next_line(text));
    Parameters parameters;
    while (!text.empty() && parameters.size() < 40) {
        const std::string_view line = next_line(text);
        const std::size_t equals = std::min(line.find('='), line.size());
        parameters.emplace(line.substr(0, equals), line.substr(std::min(line.size(), equals + 1)));
    }
    PageOptions page;
    page.scene = "scene.glb";
    const auto refusable = [&](const auto& check) {
        try {
            check();
        } catch (const UsageError& error) {
            require(*error.what() != '\0', "a reason");
        }
    };
    refusable([&] { check_picture(page, parameters); });
    refusable([&] {
        const ExplainOptions options = explain_request(page, parameters);
        require(options.pixel && !options.point && !options.triangles, "a pixel of the scene");
    });
    refusable([&] {
        const HoursOptions options = hours_request(page, parameters);
        require(options.place && options.place->days.month != 0 && !options.directions, "a day of a place");
        require(options.result == "hours.png" && !options.aov && !options.points && options.device.empty(),
                "no file but the picture's");
        require(std::uint64_t(options.size.width) * options.size.height <= most_pixels, "a bounded picture");
    });
    refusable([&] { require(suns_request(parameters).days.month != 0, "a day"); });
    return 0;
}
