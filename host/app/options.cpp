// SPDX-License-Identifier: MIT
// The command line: its options, their meanings, and the combinations that are allowed.
#include "options.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

#include "terminal.hpp"

namespace gnomon::app {
namespace {

constexpr int first_year = 1900, last_year = 2100;  // of the sun's positions

const char* const main_description =
    "gnomon: exact hard shadows as OpenCL kernels.\n"
    "Every pixel's shadow is decided in exact arithmetic: the same bits on every device.";

/// What follows the options in a command's help.
std::string help_text(const std::string& command) {
    const std::string_view text = text_file("help/" + command + ".txt");
    return std::string(text.substr(0, text.find_last_not_of('\n') + 1));
}

/// CLI11 takes the next argument if "--option=" has no value, and keeps the "=" of "-o=file". This function handles
/// both before CLI11 parses the arguments.
std::vector<std::string> without_equals_signs(const std::vector<std::string>& arguments) {
    std::vector<std::string> separated;
    for (const std::string& argument : arguments) {
        if (argument.size() > 2 && argument.starts_with("--") && argument.find('=') == argument.size() - 1)
            throw UsageError(argument + " has no value behind its equals sign");
        const bool is_joined = argument.starts_with("-o=");
        if (is_joined) separated.emplace_back("-o");
        separated.push_back(is_joined ? argument.substr(3) : argument);
    }
    return separated;
}

using Store = std::function<void(const std::string& option, const std::string& text)>;

/// A group of a command's help. Called, it adds an option with one value; `store` gets the option's name (for its
/// sentences: "--mask", "-o (--output)") and the text.
struct Group {
    CLI::App& app;
    std::string name;

    void operator()(const std::string& names, const std::string& type, const std::string& meaning, Store store) const {
        const std::size_t comma = names.find(',');
        const std::string option =
            comma == std::string::npos ? names : names.substr(0, comma) + " (" + names.substr(comma + 1) + ")";
        const auto store_all = [option, store = std::move(store)](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) store(option, text);
        };
        app.add_option_function<std::vector<std::string>>(names, store_all, meaning)
            ->option_text(type)
            ->group(name)
            ->allow_extra_args(false);
    }
    void flag(const std::string& option, bool& value, const std::string& meaning) const {
        app.add_flag(option, value, meaning)->group(name);
    }
};

/// Stores what `parse`, a function of values.hpp, reads under these limits. A list gets one more entry.
template <typename To, typename Parse, typename... Limits>
Store into(To& to, Parse parse, Limits... limits) {
    return [=, &to](const std::string& option, const std::string& text) {
        if constexpr (requires { to.push_back(parse(option, text, limits...)); })
            to.push_back(parse(option, text, limits...));
        else
            to = parse(option, text, limits...);
    };
}

void add_camera_options(CLI::App& app, ViewOptions& options) {
    const Group add{app, "Camera (default: the scene's first, else one that frames the scene)"};
    add("--size", "WxH",
        "Pixels of the picture, each side up to 16384 (default " + std::to_string(options.size.width) + "x" +
            std::to_string(options.size.height) + ")",
        into(options.size, parse_size));
    add("--camera", "NAME|INDEX", "A camera of the scene, by its name or its position from 0",
        into(options.camera, parse_name));
    add("--eye", "X,Y,Z", "Where the camera stands; needs --target", into(options.eye, parse_float3));
    add("--target", "X,Y,Z", "What the camera looks at; needs --eye", into(options.target, parse_float3));
    add("--up", "X,Y,Z", "Which way is up for --eye and --target (default 0,1,0)", into(options.up, parse_float3));
    add("--fovy", "DEGREES",
        "Vertical field of view, above 0 and below 180\n(default: the camera's own; 50 with --eye)",
        [&](const std::string& option, const std::string& text) {
            options.fov_y_degrees = parse_float(option, text);
            if (!(*options.fov_y_degrees > 0 && *options.fov_y_degrees < 180))
                throw UsageError(option + " needs degrees above 0 and below 180, not \"" + text + "\"");
        });
}

/// `more` is added to the help of --light. `render`: with area lights.
void add_light_options(CLI::App& app, ViewOptions& options, const std::string& more = {},
                       RenderOptions* render = nullptr) {
    const Group add{app, "Light (default: the scene's first, else a sun that travels along -0.4,-1,-0.3)"};
    add("--light-direction", "X,Y,Z", "A light infinitely far away: the way it travels",
        [&](const std::string& option, const std::string& text) {
            options.light_direction = parse_float3(option, text);
            if (*options.light_direction == Float3{0, 0, 0})
                throw UsageError(option + " needs a direction that is not 0,0,0");
        });
    add("--light-position", "X,Y,Z", "A light at a point", into(options.light_position, parse_float3));
    if (render)
        add("--area-light", "X,Y,Z,AX,AY,AZ,BX,BY,BZ",
            "A parallelogram that shines: a corner and two edges a and b. It shines on the side of\na x b, with the "
            "cosines at light and surface and the inverse square of each sample's distance",
            [render](const std::string& option, const std::string& text) {
                const auto [corner, a, b] = parse_three_float3(option, text);
                render->area_light = {corner, a, b};
            });
    add("--light", "NAME|INDEX", "A light of the scene, by its name or its position from 0" + more,
        into(options.light, parse_name));
}

void add_scene_options(CLI::App& app, ViewOptions& options) {
    const Group add{app, "Of the scene file (default: its default scene, the pose at rest)"};
    add("--scene", "NAME|INDEX", "One of the file's scenes, by its name or its position from 0",
        into(options.scene_choice, parse_name));
    add("--animation", "NAME|INDEX", "One of the file's animations (default with --time: the first)",
        into(options.animation, parse_name));
    add("--time", "SECONDS",
        "Shows the scene as the animation has it at this time; its first and last keyframes\nhold before and after it",
        into(options.time_s, parse_double));
    add("--blend", "opaque|clear|mask",
        "How triangles of alphaMode BLEND cast shadows and are seen: as opaque ones (the\ndefault), not at all, or as "
        "masks with a cutoff of .5",
        [&](const std::string& option, const std::string& text) {
            if (text == "opaque")
                options.blend = scene::BlendCasters::opaque;
            else if (text == "clear")
                options.blend = scene::BlendCasters::clear;
            else if (text == "mask")
                options.blend = scene::BlendCasters::mask;
            else
                throw UsageError(option + " needs opaque, clear or mask, not \"" + text + "\"");
        });
}

void add_sequence_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Sequence (one picture for each time, from --time on)"};
    add("--frames", "N", "Pictures, up to 1000000: NAME.png becomes NAME_0000.png, NAME_0001.png, ...",
        into(options.frames, parse_count, 1u, 1000000u));
    add("--fps", "F", "Frames per second, above 0 (default 24)",
        [&](const std::string& option, const std::string& text) {
            options.frames_per_s = parse_double(option, text);
            if (!(*options.frames_per_s > 0))
                throw UsageError(option + " needs a number above 0, not \"" + text + "\"");
        });
}

void add_output_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Outputs (at least one)"};
    add("-o,--output", "FILE.png", "The picture, 8-bit sRGB", into(options.picture, parse_file, ".png"));
    add("--mask", "FILE.png",
        "Visibility, 8-bit, one channel: 255 lit (and sky), 0 in shadow, else the mean of --samples",
        into(options.mask, parse_file, ".png"));
    add("--aov", "FILE.exr",
        "One EXR, lossless: P.X P.Y P.Z N.X N.Y N.Z visibility (float), receiver (uint), and of the\n"
        "surfaces albedo.R albedo.G albedo.B (linear) Ns.X Ns.Y Ns.Z (shading normal), with\n--ambient sky the sky's "
        "share; "
        "sky: P = N = 0, visibility 1, receiver 4294967295",
        into(options.aov, parse_file, ".exr"));
    add("--dump-triangles", "FILE",
        "The world triangles, 9 little-endian float32 each;\na receiver is a position in this file",
        into(options.triangle_dump, parse_file, ""));
    add("--dump-points", "FILE",
        "The points whose shadow is decided, 16 little-endian bytes each: x, y, z (float32; sky: NaN)\n"
        "and receiver (uint32); pixel by pixel, for each of --samples in turn",
        into(options.point_dump, parse_file, ""));
    add("--stats", "FILE.json",
        "What was done: the time of each step in ms, counts, memory, the exact camera and\n"
        "light; the time of each stage only with --profile",
        into(options.statistics, parse_file, ""));
    add.flag("--profile", options.profile,
             "Time each stage on the device, for the table and --stats. The host waits after each\n"
             "stage, so that the run as a whole takes a little longer");
}

void parse_ambient(RenderOptions& options, const std::string& option, const std::string& text) {
    if (text == "constant")
        options.sky_division = 0;
    else if (text == "sky")
        options.sky_division = 1;
    else if (text.starts_with("sky:"))
        options.sky_division = parse_count(option, text.substr(4), 1, 16);
    else
        throw UsageError(option + " needs constant, sky or sky:N, not \"" + text + "\"");
}

void add_picture_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Picture (masks and --aov's visibility do not depend on these)"};
    add("--exposure", "EV|auto",
        "All light times 2^EV; auto: so that 95 % of the surfaces' pixels are no brighter than .8\n"
        "(default: 0 for one light, auto for more, for --ambient sky and --area-light)",
        [&](const std::string& option, const std::string& text) {
            options.is_metered = text == "auto";
            options.exposure_ev = options.is_metered ? std::nullopt : std::optional(parse_double(option, text));
            if (options.exposure_ev && std::abs(*options.exposure_ev) > 30)
                throw UsageError(option + " needs auto or a number from -30 to 30, not \"" + text + "\"");
        });
    add("--ambient", "constant|sky[:N]",
        "sky: each pixel gets the light of those patches of the sky that it sees, each decided\n"
        "exactly: Tregenza's 145 patches (N = 1, the default), or N * N times as many, N up to 16",
        [&](const std::string& option, const std::string& text) { parse_ambient(options, option, text); });
}

void add_samples(const Group& add, const std::string& meaning, std::uint32_t& samples) {
    add("--samples", "1|4|8|16|32", meaning, [&](const std::string& option, const std::string& text) {
        samples = parse_count(option, text, 1, 32);
        if (samples != 1 && (samples < 4 || (samples & (samples - 1)) != 0))
            throw UsageError(option + " needs 1, 4, 8, 16 or 32, not \"" + text + "\"");
    });
}

void add_sun(const Group& add, const char* meaning, std::uint32_t default_samples, ViewOptions& options) {
    add("--sun-angle", "DEGREES", meaning, into(options.sun_angle_degrees, parse_float));
    add("--sun-samples", "N",
        "Lights on such a disk, each with its own exact shadow; a pixel gets their mean (default " +
            std::to_string(default_samples) + ")",
        into(options.sun_samples, parse_count, 1, 65536));
}

void add_technique_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Technique (see: gnomon techniques --verbose)"};
    const auto parse_short_setting = [](const std::string& option, const std::string& text) {
        return std::pair(option.substr(2), parse_name(option, text));
    };
    add("--technique", "NAME", "How visibility is computed (default frustum-traced)",
        into(options.technique, parse_name));
    add_samples(add,
                "Points per pixel, each with its own exact answer; a pixel gets their mean (default 1, its centre)",
                options.samples);
    add_sun(add, "Soft shadows: directional lights are disks of this angle in the sky (the sun's: 0.533)",
            default_sun_samples, options);
    add("--area-samples", "N", "Points of --area-light, each with its own exact shadow (default 64)",
        into(options.area_samples, parse_count, 1, 65536));
    add("--set", "KEY=VALUE", "Changes a setting of the technique; may be repeated",
        into(options.settings, parse_setting));
    add("--diagnostic", "NAME",
        "Draw how the technique works instead of the picture: decided (frustum-traced), page (virtual-shadow-map),\n"
        "aliasing, grid, views, depth or warp (shadow-map and its presets)",
        into(options.diagnostic, parse_name));
    add("--conservative-map", "on|off|auto", "Short for --set conservative-map=...",
        into(options.settings, parse_short_setting));
    add("--map-size", "N|auto", "Short for --set map-size=N", into(options.settings, parse_short_setting));
}

/// `prints_more`: the command prints more texts than its result.
void add_device_options(CLI::App& app, ViewOptions& options, bool prints_more = true) {
    const Group add{app, "Device and messages"};
    add("--device", "P:D|NAME",
        "The OpenCL device, as gnomon devices lists it or by a part of its\n"
        "name (default: $GNOMON_DEVICE, else the first usable GPU, else CPU)",
        into(options.device, parse_name));
    add("--memory-limit", "BYTES",
        "Allocate no more than this on the device; K, M, G and T are powers of\n1024. For gnomon render, a scene that "
        "does not fit is processed in parts, with the same bits",
        into(options.memory_limit_bytes, parse_bytes));
    add.flag("--strict", options.strict, "Warnings become errors");
    if (prints_more) add.flag("--quiet", options.quiet, "Print nothing but warnings and errors");
}

void check_camera_options(const ViewOptions& options) {
    const bool by_eye = options.eye || options.target || options.up;
    if (options.camera && by_eye)
        throw UsageError("--camera cannot be used together with --eye, --target or --up: give one or the other");
    if (options.eye && !options.target) throw UsageError("--eye needs --target as well: the point to look at");
    if (options.target && !options.eye) throw UsageError("--target needs --eye as well: the point to look from");
    if (options.up && !options.eye) throw UsageError("--up needs --eye and --target as well");
}

void check_sun_angle(const ViewOptions& options) {
    const auto& angle = options.sun_angle_degrees;
    if (options.sun_samples && !angle) throw UsageError("--sun-samples needs --sun-angle as well: the disk's size");
    if (angle && !(*angle > 0 && *angle < 90)) throw UsageError("--sun-angle must lie between 0 and 90 degrees");
}

void check_area_light(const RenderOptions& options) {
    if (options.area_samples && !options.area_light) throw UsageError("--area-samples needs --area-light as well");
    if (!options.area_light) return;
    if (options.sun_angle_degrees) throw UsageError("--sun-angle is for directional lights: leave out --area-light");
    if (options.samples != 1) throw UsageError("--area-light takes one point per pixel: leave out --samples");
    if (options.diagnostic) throw UsageError("--diagnostic draws a light without an area: leave out --area-light");
}

void check_sun(const RenderOptions& options) {
    check_sun_angle(options);
    if (!options.sun_angle_degrees) return;
    if (options.samples != 1) throw UsageError("--sun-angle takes one point per pixel: leave out --samples");
    if (options.diagnostic) throw UsageError("--diagnostic draws a light without a disk: leave out --sun-angle");
}

void check_explained(const ExplainOptions& options) {
    if (options.scene && options.triangles) throw UsageError("SCENE and --triangles exclude each other: give one");
    if (options.pixel.has_value() == options.point.has_value())
        throw UsageError(options.pixel ? "--pixel and --point exclude each other: give one of them"
                                       : "nothing to explain: give --pixel X,Y or --point X,Y,Z");
    if (options.point && (options.camera || options.target || options.up || options.fov_y_degrees))
        throw UsageError("--point needs no camera but --eye, the side from which its receiver is seen");
    if (options.point && options.samples != 1) throw UsageError("--samples goes with --pixel");
    if (options.pixel && options.receiver) throw UsageError("--receiver goes with --point: a pixel has its own");
    if (options.pixel && (options.pixel->x >= options.size.width || options.pixel->y >= options.size.height))
        throw UsageError("--pixel " + std::to_string(options.pixel->x) + "," + std::to_string(options.pixel->y) +
                         " lies outside the picture of " + std::to_string(options.size.width) + "x" +
                         std::to_string(options.size.height) + " pixels: see --size");
    if (options.sample >= options.samples)
        throw UsageError("--sample " + std::to_string(options.sample) +
                         " needs a larger --samples: samples count from 0");
    if (options.pixel) check_camera_options(options);
}

void check_light_options(const ViewOptions& options) {
    const int given = int(options.light.has_value()) + int(options.light_direction.has_value()) +
                      int(options.light_position.has_value()) + int(options.area_light.has_value());
    if (given > 1)
        throw UsageError(
            options.area_light
                ? "--area-light takes the place of --light, --light-direction and --light-position: give one of them"
                : "--light, --light-direction and --light-position exclude each other: give one of them");
}

void check_scene_options(const ViewOptions& options) {
    const char* const given = options.scene_choice ? "--scene"
                              : options.animation  ? "--animation"
                              : options.time_s     ? "--time"
                                                   : nullptr;
    if (given && !options.scene)
        throw UsageError(std::string(given) +
                         " needs a SCENE file: the built-in sundial has one scene and stands still");
}

void check_sequence(const RenderOptions& options) {
    if (options.frames > 0 && !options.scene)
        throw UsageError("--frames needs a SCENE file: the built-in sundial stands still");
    if (options.frames_per_s && options.frames == 0) throw UsageError("--fps goes with --frames");
}

void check_outputs(const RenderOptions& options) {
    const bool has_picture = options.picture && !options.diagnostic;
    if ((options.exposure_ev || options.is_metered) && !has_picture)
        throw UsageError("--exposure is for the picture: give -o FILE.png, without --diagnostic");
    if (options.sky_division != 0 && !has_picture && !options.aov)
        throw UsageError("--ambient is for the picture: give -o FILE.png or --aov FILE.exr, without --diagnostic");
    if (options.light == "all" && (options.aov || options.diagnostic))
        throw UsageError("--aov and --diagnostic show one light: name it with --light instead of all");
    if (!options.picture && !options.mask && !options.aov && !options.triangle_dump && !options.point_dump &&
        !options.statistics)
        throw UsageError(
            "nothing to write: give -o FILE.png (or --mask, --aov, --dump-triangles, --dump-points or --stats)");
}

/// CLI11's help with one blank line between groups instead of two.
std::string help_of(const CLI::App& app) { return CLI::detail::find_and_replace(app.help(), "\n\n\n", "\n\n"); }

/// The first argument that CLI11 could not use, in a sentence. `kind` is its kind if it is no option.
void check_nothing_left(const CLI::App& app, const std::string& command, const std::string& kind) {
    const std::vector<std::string> left = app.remaining();
    if (left.empty()) return;
    const std::string& first = left.front();
    throw UsageError((first.starts_with("-") ? "unknown option" : kind) + " " + first + ": see " + command + " --help");
}

/// A command with what every command that renders has: an optional scene, and a text below the options.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& meaning, ViewOptions& options) {
    CLI::App* command = app.add_subcommand(name, meaning);
    // A scene's name can equal a subcommand's name only if it has no extension; "./devices" is a file.
    command
        ->add_option_function<std::string>(
            "SCENE", [&options](const std::string& text) { options.scene = parse_file("SCENE", text, ""); },
            "A .glb or .gltf file (default: a built-in sundial)")
        ->type_name("");
    command->footer(help_text(name));
    return command;
}

CLI::App* add_render(CLI::App& app, RenderOptions& options) {
    CLI::App* render = add_command(app, "render", "Renders a scene with exact hard shadows", options);
    add_output_options(*render, options);
    add_scene_options(*render, options);
    add_sequence_options(*render, options);
    add_camera_options(*render, options);
    add_light_options(*render, options,
                      ";\nall: every light of the scene, each with its own mask and statistics; the picture\n"
                      "is lit by all, and --mask NAME.png writes NAME_0.png, NAME_1.png, ...",
                      &options);
    add_picture_options(*render, options);
    add_technique_options(*render, options);
    add_device_options(*render, options);
    return render;
}

CLI::App* add_explain(CLI::App& app, ExplainOptions& options) {
    CLI::App* explain = add_command(app, "explain", "Says why a pixel or a point is lit or in shadow", options);
    const Group add{*explain, "What to explain (--pixel or --point)"};
    add("--pixel", "X,Y", "A pixel of the picture, counted from 0 at the upper left corner",
        into(options.pixel, parse_pixel));
    add_samples(add, "The pixel's points are these of render's --samples (default 1)", options.samples);
    add("--sample", "I", "Which of the pixel's samples, from 0 (default 0)",
        into(options.sample, parse_count, 0u, 31u));
    add("--point", "X,Y,Z", "A point of the scene; with --eye it can be backfacing", into(options.point, parse_float3));
    add("--receiver", "ID", "The triangle that the point lies on (default: none)",
        into(options.receiver, parse_count, 0u, no_receiver - 1));
    add("--triangles", "FILE", "In place of SCENE: triangles as --dump-triangles writes them",
        into(options.triangles, parse_file, ""));
    add_scene_options(*explain, options);
    add_camera_options(*explain, options);
    add_light_options(*explain, options);
    add_device_options(*explain, options, false);
    return explain;
}

CLI::App* add_gallery(CLI::App& app, GalleryOptions& options) {
    CLI::App* gallery =
        add_command(app, "gallery", "Every technique beside the exact truth, as one HTML page", options);
    const Group add{*gallery, "Page"};
    add("-o,--output", "FILE.html", "The page, everything in it (default gallery.html)",
        into(options.page, parse_file, ".html"));
    add("--technique", "NAME[:KEY=VALUE,...]",
        "Show this technique, with these settings; may be repeated\n(default: every technique as it comes)",
        into(options.techniques, parse_name));
    add("--runs", "N", "Timed runs of each technique, 1 to 1000 (default 3)",
        into(options.runs, parse_count, 1u, 1000u));
    add_scene_options(*gallery, options);
    add_camera_options(*gallery, options);
    add_light_options(*gallery, options);
    add_sun({*gallery, "Soft shadows"},
            "The truth is soft: the directional light is a disk of this angle (the sun's: 0.533), and errors are also\n"
            "measured in penumbrae alone",
            truth_sun_samples, options);
    add_device_options(*gallery, options);
    return gallery;
}

Store into_pair(double& first, double& second, double most_first, double most_second) {
    return [=, &first, &second](const std::string& option, const std::string& text) {
        const std::size_t comma = text.find(',');
        if (comma == std::string::npos) throw UsageError(option + " needs two numbers, not \"" + text + "\"");
        first = parse_double(option, text.substr(0, comma));
        second = parse_double(option, text.substr(comma + 1));
        if (std::abs(first) > most_first || std::abs(second) > most_second)
            throw UsageError(option + " needs a latitude from -90 to 90 and a longitude from -180 to 180, not \"" +
                             text + "\"");
    };
}

Days parse_day(const std::string& option, const std::string& text) {
    int year = 0, month = 0, day = 0, read = 0;
    const int found = std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &read);
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                           std::chrono::day(unsigned(day))};
    if (found != 3 || std::size_t(read) != text.size() || year < first_year || year > last_year || !date.ok())
        throw UsageError(option + " needs a day as 2026-06-21, not \"" + text + "\"");
    return {year, month, day};
}

void add_sun_options(CLI::App& app, HoursOptions& options, SunsOfPlace& place) {
    const Group add{app, "Suns (a table, or a place with a day or a year)"};
    add("--directions", "FILE.csv", "A table with the columns x,y,z or azimuth,elevation, and weight (default 1)",
        into(options.directions, parse_file, ".csv"));
    const Store store_place = into_pair(place.latitude_degrees, place.longitude_degrees, 90, 180);
    add("--place", "LAT,LON", "Where the scene is, in degrees, north and east positive",
        [&options, &place, store_place](const std::string& option, const std::string& text) {
            store_place(option, text);
            options.place = place;
        });
    add("--day", "YYYY-MM-DD", "The suns of a day", into(place.days, parse_day));
    add("--year", "YYYY", "The suns of a year", [&place](const std::string& option, const std::string& text) {
        place.days = {int(parse_count(option, text, first_year, last_year)), 0, 0};
    });
    add("--step", "MINUTES", "One sun in the middle of each step, which divides a day (default 10; of a year 60)",
        [&place](const std::string& option, const std::string& text) {
            place.step_minutes = parse_count(option, text, 1, 1440);
            if (1440 % place.step_minutes != 0)
                throw UsageError(option + " needs minutes that divide a day of 1440, not \"" + text + "\"");
        });
    add("--utc", "HOURS", "The clock of the days, ahead of universal time (default: the longitude / 15, rounded)",
        [&place](const std::string& option, const std::string& text) {
            place.utc_offset_hours = parse_double(option, text);
            if (!(std::abs(place.utc_offset_hours) <= 14))
                throw UsageError(option + " needs hours from -14 to 14, not \"" + text + "\"");
        });
    add.flag("--apparent", place.is_apparent,
             "Elevations with refraction (Saemundsson, 1010 hPa, 10 C); else true ones. Either way\n"
             "suns whose centre is not above the horizon are left out");
    add("--north", "DEGREES", "Where north lies, clockwise from -z as seen from above (default 0; y is up)",
        into(options.north_degrees, parse_double));
    add("--write-directions", "FILE.csv",
        "Writes the table that was used, which --directions takes back with the same bits\n"
        "(default with --place: the output's name with .suns.csv)",
        into(options.written_directions, parse_file, ".csv"));
}

CLI::App* add_hours(CLI::App& app, HoursOptions& options, SunsOfPlace& place) {
    CLI::App* hours =
        add_command(app, "hours", "Sun hours, or any weights of many suns, of a scene or points", options);
    const Group add{*hours, "Outputs"};
    add("-o,--output", "FILE", "A .png of the scene coloured by the sums, with a legend; of --points a .csv or .npy",
        into(options.result, parse_file, ""));
    add("--aov", "FILE.exr", "As of gnomon render, with the sum in place of visibility: channel value",
        into(options.aov, parse_file, ".exr"));
    add("--points", "FILE.csv", "Points in place of a picture: x,y,z and, for the side of the surface, nx,ny,nz",
        into(options.points, parse_file, ".csv"));
    add("--unit", "TEXT", "The unit of the weights, for the legend (default hours)", into(options.unit, parse_name));
    add("--most", "VALUE", "The value with the last colour (default: the largest)", into(options.most, parse_double));
    add.flag("--cosines", options.cosines, "Each weight times the cosine between the sun and the surface's normal");
    add_sun_options(*hours, options, place);
    add_scene_options(*hours, options);
    add_camera_options(*hours, options);
    add("--set", "KEY=VALUE", "Changes a setting of frustum-traced; may be repeated",
        into(options.settings, parse_setting));
    add_device_options(*hours, options);
    return hours;
}

/// Checks the options of a place, and completes them.
void complete_place(HoursOptions& options, const SunsOfPlace& place, bool has_offset) {
    if (options.directions && options.place)
        throw UsageError("--directions and --place exclude each other: give one of them");
    if (!options.directions && !options.place)
        throw UsageError("no suns: give --directions FILE.csv, or --place LAT,LON with --day or --year");
    if (!options.place) {
        if (place.days.year != 0 || place.step_minutes != 0 || has_offset || place.is_apparent)
            throw UsageError("--day, --year, --step, --utc and --apparent go with --place");
        return;
    }
    if (place.days.year == 0) throw UsageError("--place needs --day YYYY-MM-DD or --year YYYY as well");
    options.place = place;
    if (place.step_minutes == 0) options.place->step_minutes = place.days.month != 0 ? 10 : 60;
    if (!has_offset) options.place->utc_offset_hours = std::round(place.longitude_degrees / 15);
    if (options.written_directions) return;
    options.written_directions = options.result ? *options.result : *options.aov;
    options.written_directions->replace_extension(".suns.csv");
}

void check_hours(const HoursOptions& options) {
    const std::string extension = options.result ? lower_extension(*options.result) : "";
    if (!options.result && !options.aov) throw UsageError("nothing to write: give -o FILE.png or --aov FILE.exr");
    if (options.most && !(*options.most > 0)) throw UsageError("--most needs a number above 0");
    if (!options.points) {
        if (options.result && extension != ".png")
            throw UsageError("-o needs a file that ends with .png (.csv and .npy are for --points)");
        return;
    }
    if (extension != ".csv" && extension != ".npy")
        throw UsageError("-o needs a file that ends with .csv or .npy for --points");
    if (options.aov || options.camera || options.eye || options.target || options.most)
        throw UsageError("--points is in place of a picture: leave out --aov, --most and the camera");
}

CLI::App* add_devices(CLI::App& app, ListDevices& options) {
    CLI::App* devices = app.add_subcommand("devices", "Lists every OpenCL device and says which is the default");
    devices->add_flag("--check", options.checks,
                      "Check one of them instead: known answers and times, on one page\nto send; under a minute");
    devices->add_option("--device", options.device, "The device to check (default: as for render)")
        ->type_name("P:D|NAME");
    return devices;
}

Command checked_devices(const ListDevices& options) {
    if (options.checks) return [=] { check_device(options); };
    if (!options.device.empty()) throw UsageError("--device needs --check as well: the device to check");
    return [] { print_result(device_list()); };
}

CLI::App* add_techniques(CLI::App& app, ListTechniques& options) {
    CLI::App* techniques = app.add_subcommand("techniques", "Lists the techniques, a line each");
    techniques->add_option("NAME", options.name, "Only this one, with its settings")->type_name("");
    techniques->add_flag("--verbose", options.verbose, "With the settings of each");
    return techniques;
}

/// The command, once its options have passed the checks.
template <typename Options, typename... Checks>
Command checked(void (*run)(const Options&), const Options& options, Checks... checks) {
    (checks(options), ...);
    return [=] { run(options); };
}

Command print(const std::string& text) {
    return [text] { print_result(text); };
}

/// Parses, or returns the text of --help or --version.
std::optional<std::string> parse_or_text(CLI::App& parser, const std::vector<std::string>& arguments) {
    std::vector<std::string> from_the_back = without_equals_signs({arguments.begin() + 1, arguments.end()});
    std::reverse(from_the_back.begin(), from_the_back.end());
    try {
        parser.parse(from_the_back);
    } catch (const CLI::CallForHelp&) {
        return help_of(parser);
    } catch (const CLI::CallForVersion& call) {
        return std::string(call.what()) + "\n";
    } catch (const CLI::ArgumentMismatch& error) {
        // "--mask: 1 required TEXT missing": every option with a value takes exactly one.
        const std::string text = error.what();
        throw UsageError(text.substr(0, text.find(':')) + " needs a value");
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    return {};
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& arguments) {
    RenderOptions render_options;
    ListDevices devices_options;
    ListTechniques techniques_options;
    ExplainOptions explain_options;
    GalleryOptions gallery_options;
    HoursOptions hours_options;
    SunsOfPlace place;
    gallery_options.size = {960, 540};
    render_options.command_line = gallery_options.command_line = arguments;

    CLI::App parser(main_description, "gnomon");
    parser.set_version_flag("--version", "gnomon " + std::string(version()), "Print the version");
    parser.set_help_flag("-h,--help", "Print this help");
    parser.footer(help_text("main"));
    parser.require_subcommand(0, 1);
    parser.allow_extras();
    parser.get_formatter()->column_width(36);
    CLI::App* const render = add_render(parser, render_options);
    CLI::App* const explain = add_explain(parser, explain_options);
    CLI::App* const gallery = add_gallery(parser, gallery_options);
    CLI::App* const hours = add_hours(parser, hours_options, place);
    CLI::App* const devices = add_devices(parser, devices_options);
    CLI::App* const techniques = add_techniques(parser, techniques_options);
    for (CLI::App* command : {render, explain, gallery, hours, devices, techniques}) command->allow_extras();

    if (const std::optional<std::string> text = parse_or_text(parser, arguments)) return print(*text);
    for (const CLI::App* command : parser.get_subcommands())
        check_nothing_left(*command, "gnomon " + command->get_name(), "unexpected argument");
    check_nothing_left(parser, "gnomon", "unknown command");

    if (*render)
        return checked(app::render, render_options, check_scene_options, check_sequence, check_camera_options,
                       check_light_options, check_sun, check_area_light, check_outputs);
    if (*hours) {
        check_hours(hours_options);
        complete_place(hours_options, place, hours->count("--utc") != 0);
        return checked(app::hours, hours_options, check_scene_options, check_camera_options);
    }
    if (*explain)
        return checked(app::explain, explain_options, check_scene_options, check_explained, check_light_options);
    if (*gallery)
        return checked(app::gallery, gallery_options, check_scene_options, check_camera_options, check_light_options,
                       check_sun_angle);
    if (*devices) return checked_devices(devices_options);
    if (*techniques) return [=] { print_result(technique_list(techniques_options)); };
    return print(help_of(parser));
}

}  // namespace gnomon::app
