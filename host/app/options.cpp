// SPDX-License-Identifier: MIT
// The command line: its options, their meanings, and the combinations that are allowed.
#include "options.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "terminal.hpp"

namespace gnomon::app {
namespace {

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

/// Stores a value; a list gets one more entry.
template <typename To>
auto into(To& to) {
    return [&to](const auto& value) {
        if constexpr (requires { to.push_back(value); })
            to.push_back(value);
        else
            to = value;
    };
}

/// CLI11's check that a text is of this kind.
template <typename Value>
auto check_of(const Kind<Value>& kind) {
    return [kind](const std::string& text) {
        return kind.read(text) ? std::string() : "needs " + kind.needs + ", not \"" + text + "\"";
    };
}

/// A group of a command's help. Called, it adds an option with one value, which `store` gets; of the values that a
/// repeated option has the last counts.
struct Group {
    CLI::App& app;
    std::string name;

    template <typename Value, typename Store>
    void operator()(const std::string& names, const std::string& type, const std::string& meaning,
                    const Kind<Value>& kind, const Store& store) const {
        const auto store_all = [=](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) store(*kind.read(text));
        };
        app.add_option_function<std::vector<std::string>>(names, store_all, meaning)
            ->check(check_of(kind))
            ->option_text(type)
            ->group(name)
            ->allow_extra_args(false);
    }
    void flag(const std::string& option, bool& value, const std::string& meaning) const {
        app.add_flag(option, value, meaning)->group(name);
    }
};

/// Each first option needs its second one.
void require(CLI::App& app, std::initializer_list<std::pair<const char*, const char*>> pairs) {
    for (const auto& [option, other] : pairs) app.get_option(option)->needs(app.get_option(other));
}

/// `option` goes with none of the others.
void exclude(CLI::App& app, const char* option, std::initializer_list<const char*> others) {
    for (const char* const other : others) app.get_option(option)->excludes(app.get_option(other));
}

template <typename Value>
Kind<Value> one_of(const std::map<std::string, Value>& values, const std::string& needs) {
    const auto read = [values](const std::string& text) {
        const auto found = values.find(text);
        return found != values.end() ? std::optional(found->second) : std::nullopt;
    };
    return {read, needs};
}

Kind<float> degrees_below(int limit) {
    return only(number(), fmt::format("degrees above 0 and below {}", limit),
                [limit](float degrees) { return degrees > 0 && degrees < float(limit); });
}

Kind<double> above_0() {
    return only(double_number(), "a number above 0", [](double value) { return value > 0; });
}

void add_camera_options(CLI::App& app, ViewOptions& options, bool has_size = true) {
    const Group add{app, "Camera (default: the scene's first, else one that frames the scene)"};
    if (has_size)
        add("--size", "WxH",
            fmt::format("Pixels of the picture, each side up to 16384 (default {}x{})", options.size.width,
                        options.size.height),
            image_size(), into(options.size));
    add("--camera", "NAME|INDEX", "A camera of the scene, by its name or its position from 0", name(),
        into(options.camera));
    add("--eye", "X,Y,Z", "Where the camera stands; needs --target", three_numbers(), into(options.eye));
    add("--target", "X,Y,Z", "What the camera looks at; needs --eye", three_numbers(), into(options.target));
    add("--up", "X,Y,Z", "Which way is up for --eye and --target (default 0,1,0)", three_numbers(), into(options.up));
    add("--fovy", "DEGREES",
        "Vertical field of view, above 0 and below 180\n(default: the camera's own; 50 with --eye)", degrees_below(180),
        into(options.fov_y_degrees));
    require(app, {{"--target", "--eye"}, {"--up", "--eye"}});
    exclude(app, "--camera", {"--eye", "--target", "--up"});
}

/// `more` is added to the help of --light. `render`: with area lights.
void add_light_options(CLI::App& app, ViewOptions& options, const std::string& more = {},
                       RenderOptions* render = nullptr) {
    const Group add{app, "Light (default: the scene's first, else a sun that travels along -0.4,-1,-0.3)"};
    add("--light-direction", "X,Y,Z", "A light infinitely far away: the way it travels",
        only(three_numbers(), "three finite numbers x,y,z that are not all 0",
             [](const Float3& direction) {
                 return direction != Float3{0, 0, 0};
             }),
        into(options.light_direction));
    add("--light-position", "X,Y,Z", "A light at a point", three_numbers(), into(options.light_position));
    if (render)
        add("--area-light", "X,Y,Z,AX,AY,AZ,BX,BY,BZ",
            "A parallelogram that shines: a corner and two edges a and b. It shines on the side of\na x b, with the "
            "cosines at light and surface and the inverse square of each sample's distance",
            nine_numbers(), [render](const auto& corner_and_edges) {
                const auto [corner, a, b] = corner_and_edges;
                render->area_light = {corner, a, b};
            });
    add("--light", "NAME|INDEX", "A light of the scene, by its name or its position from 0" + more, name(),
        into(options.light));
    exclude(app, "--light", {"--light-direction", "--light-position"});
    exclude(app, "--light-direction", {"--light-position"});
    if (render) exclude(app, "--area-light", {"--light", "--light-direction", "--light-position"});
}

void add_scene_options(CLI::App& app, ViewOptions& options) {
    const Group add{app, "Of the scene file (default: its default scene, the pose at rest)"};
    add("--scene", "NAME|INDEX", "One of the file's scenes, by its name or its position from 0", name(),
        into(options.scene_choice));
    add("--animation", "NAME|INDEX", "One of the file's animations (default with --time: the first)", name(),
        into(options.animation));
    add("--time", "SECONDS",
        "Shows the scene as the animation has it at this time; its first and last keyframes\nhold before and after it",
        double_number(), into(options.time_s));
    add("--blend", "opaque|clear|mask",
        "How triangles of alphaMode BLEND cast shadows and are seen: as opaque ones (the\ndefault), not at all, or as "
        "masks with a cutoff of .5",
        one_of<scene::BlendCasters>({{"opaque", scene::BlendCasters::opaque},
                                     {"clear", scene::BlendCasters::clear},
                                     {"mask", scene::BlendCasters::mask}},
                                    "opaque, clear or mask"),
        into(options.blend));
    require(app, {{"--scene", "SCENE"}, {"--animation", "SCENE"}, {"--time", "SCENE"}});
}

void add_sequence_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Sequence (one picture for each time, from --time on)"};
    add("--frames", "N", "Pictures, up to 1000000: NAME.png becomes NAME_0000.png, NAME_0001.png, ...",
        count(1, 1000000), into(options.frames));
    add("--fps", "F", "Frames per second, above 0 (default 24)", above_0(), into(options.frames_per_s));
    require(app, {{"--frames", "SCENE"}, {"--fps", "--frames"}});
}

void add_output_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Outputs (at least one)"};
    add("-o,--output", "FILE.png", "The picture, 8-bit sRGB", file_name(".png"), into(options.picture));
    add("--mask", "FILE.png",
        "Visibility, 8-bit, one channel: 255 lit (and sky), 0 in shadow, else the mean of --samples", file_name(".png"),
        into(options.mask));
    add("--aov", "FILE.exr",
        "One EXR, lossless: P.X P.Y P.Z N.X N.Y N.Z visibility (float), receiver (uint), and of the\n"
        "surfaces albedo.R albedo.G albedo.B (linear) Ns.X Ns.Y Ns.Z (shading normal), with\n--ambient sky the sky's "
        "share; "
        "sky: P = N = 0, visibility 1, receiver 4294967295",
        file_name(".exr"), into(options.aov));
    add("--dump-triangles", "FILE",
        "The world triangles, 9 little-endian float32 each;\na receiver is a position in this file", file_name(),
        into(options.triangle_dump));
    add("--dump-points", "FILE",
        "The points whose shadow is decided, 16 little-endian bytes each: x, y, z (float32; sky: NaN)\n"
        "and receiver (uint32); pixel by pixel, for each of --samples in turn",
        file_name(), into(options.point_dump));
    add("--stats", "FILE.json",
        "What was done: the time of each step in ms, counts, memory, the exact camera and\n"
        "light; the time of each stage only with --profile",
        file_name(), into(options.statistics));
    add.flag("--profile", options.profile,
             "Time each stage on the device, for the table and --stats. The host waits after each\n"
             "stage, so that the run as a whole takes a little longer");
}

/// The sky's division, 0 for constant light.
std::optional<std::uint32_t> ambient_of(const std::string& text) {
    if (text == "constant") return 0;
    if (text == "sky") return 1;
    return text.starts_with("sky:") ? count(1, 16).read(text.substr(4)) : std::nullopt;
}

/// Nothing inside: auto.
std::optional<std::optional<double>> exposure_of(const std::string& text) {
    if (text == "auto") return std::optional<double>();
    const std::optional<double> ev = double_number().read(text);
    if (!ev || std::abs(*ev) > 30) return std::nullopt;
    return ev;
}

void add_picture_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Picture (masks and --aov's visibility do not depend on these)"};
    add("--exposure", "EV|auto",
        "All light times 2^EV; auto: so that 95 % of the surfaces' pixels are no brighter than .8\n"
        "(default: 0 for one light, auto for more, for --ambient sky and --area-light)",
        Kind<std::optional<double>>{exposure_of, "auto or a number from -30 to 30"}, [&](std::optional<double> ev) {
            options.is_metered = !ev;
            options.exposure_ev = ev;
        });
    add("--ambient", "constant|sky[:N]",
        "sky: each pixel gets the light of those patches of the sky that it sees, each decided\n"
        "exactly: Tregenza's 145 patches (N = 1, the default), or N * N times as many, N up to 16",
        Kind<std::uint32_t>{ambient_of, "constant, sky or sky:N, N up to 16"}, into(options.sky_division));
}

void add_samples(const Group& add, const std::string& meaning, std::uint32_t& samples) {
    const auto is_pattern = [](std::uint32_t n) { return n == 1 || (n >= 4 && (n & (n - 1)) == 0); };
    add("--samples", "1|4|8|16|32", meaning, only(count(1, 32), "1, 4, 8, 16 or 32", is_pattern), into(samples));
}

void add_sun(const Group& add, const char* meaning, std::uint32_t default_samples, ViewOptions& options) {
    add("--sun-angle", "DEGREES", meaning, degrees_below(90), into(options.sun_angle_degrees));
    add("--sun-samples", "N",
        fmt::format("Lights on such a disk, each with its own exact shadow; a pixel gets their mean (default {})",
                    default_samples),
        count(1, 65536), into(options.sun_samples));
    require(add.app, {{"--sun-samples", "--sun-angle"}});
}

void add_technique_options(CLI::App& app, RenderOptions& options) {
    const Group add{app, "Technique (see: gnomon techniques --verbose)"};
    add("--technique", "NAME", "How visibility is computed (default frustum-traced)", name(), into(options.technique));
    add_samples(
        add,
        "Points per pixel, each with its own exact answer; mask and picture get their mean (default 1, its centre)",
        options.samples);
    add_sun(add, "Soft shadows: directional lights are disks of this angle in the sky (the sun's: 0.533)",
            default_sun_samples, options);
    add("--area-samples", "N", "Points of --area-light, each with its own exact shadow (default 64)", count(1, 65536),
        into(options.area_samples));
    add("--set", "KEY=VALUE", "Changes a setting of the technique; may be repeated", setting(), into(options.settings));
    add("--diagnostic", "NAME",
        "Draw how the technique works instead of the picture: decided (frustum-traced), page (virtual-shadow-map),\n"
        "aliasing, grid, views, depth or warp (shadow-map and its presets)",
        name(), into(options.diagnostic));
    for (const auto& [key, type] : {std::pair("conservative-map", "on|off|auto"), std::pair("map-size", "N|auto")})
        add(std::string("--") + key, type, std::string("Short for --set ") + key + "=...", name(),
            [&options, key = key](const std::string& value) { options.settings.emplace_back(key, value); });
    require(app, {{"--area-samples", "--area-light"}});
    exclude(app, "--area-light", {"--sun-angle", "--diagnostic"});
    exclude(app, "--sun-angle", {"--diagnostic"});
}

/// `prints_more`: the command prints more texts than its result.
void add_device_options(CLI::App& app, ViewOptions& options, bool prints_more = true) {
    const Group add{app, "Device and messages"};
    add("--device", "P:D|NAME",
        "The OpenCL device, as gnomon devices lists it or by a part of its\n"
        "name (default: $GNOMON_DEVICE, else the first usable GPU, else CPU)",
        name(), into(options.device));
    add("--memory-limit", "BYTES",
        "Allocate no more than this on the device; K, M, G and T are powers of\n1024. For gnomon render, a scene that "
        "does not fit is processed in parts, with the same bits",
        bytes(), into(options.memory_limit_bytes));
    add.flag("--strict", options.strict, "Warnings become errors");
    if (prints_more) add.flag("--quiet", options.quiet, "Print nothing but warnings and errors");
}

void check_samples(const RenderOptions& options) {
    if (options.samples != 1 && options.area_light)
        throw UsageError("--area-light takes one point per pixel: leave out --samples");
}

void check_explained(const ExplainOptions& options) {
    if (!options.pixel && !options.point) throw UsageError("nothing to explain: give --pixel X,Y or --point X,Y,Z");
    if (options.point && options.samples != 1) throw UsageError("--samples goes with --pixel");
    if (options.pixel && options.eye && !options.target) throw UsageError("--eye requires --target");
    if (options.pixel && (options.pixel->x >= options.size.width || options.pixel->y >= options.size.height))
        throw UsageError(fmt::format("--pixel {},{} lies outside the picture of {}x{} pixels: see --size",
                                     options.pixel->x, options.pixel->y, options.size.width, options.size.height));
    if (options.sample >= options.samples)
        throw UsageError(fmt::format("--sample {} needs a larger --samples: samples count from 0", options.sample));
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

/// A command with what every command that renders has: an optional scene, and a text below the options.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& meaning, ViewOptions& options) {
    CLI::App* command = app.add_subcommand(name, meaning);
    // A scene's name can equal a subcommand's name only if it has no extension; "./devices" is a file.
    command
        ->add_option_function<std::string>("SCENE", into(options.scene),
                                           "A .glb or .gltf file (default: a built-in sundial)")
        ->check(check_of(file_name()))
        ->option_text(" ");
    command->footer(help_text(name));
    return command;
}

CLI::App* add_render(CLI::App& app, RenderOptions& options) {
    CLI::App* render = add_command(app, "render", "Renders a scene with exact hard shadows", options);
    add_output_options(*render, options);
    add_scene_options(*render, options);
    add_sequence_options(*render, options);
    add_camera_options(*render, options);
    require(*render, {{"--eye", "--target"}});
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
    add("--pixel", "X,Y", "A pixel of the picture, counted from 0 at the upper left corner", pixel(),
        into(options.pixel));
    add_samples(add, "The pixel's points are these of render's --samples (default 1)", options.samples);
    add("--sample", "I", "Which of the pixel's samples, from 0 (default 0)", count(0, 31), into(options.sample));
    add("--point", "X,Y,Z", "A point of the scene; with --eye it can be backfacing", three_numbers(),
        into(options.point));
    add("--receiver", "ID", "The triangle that the point lies on (default: none)", count(0, no_receiver - 1),
        into(options.receiver));
    add("--triangles", "FILE", "In place of SCENE: triangles as --dump-triangles writes them", file_name(),
        into(options.triangles));
    add_scene_options(*explain, options);
    add_camera_options(*explain, options);
    add_light_options(*explain, options);
    add_device_options(*explain, options, false);
    require(*explain, {{"--receiver", "--point"}});
    exclude(*explain, "--point", {"--pixel", "--camera", "--target", "--up", "--fovy"});
    exclude(*explain, "--triangles", {"SCENE"});
    return explain;
}

CLI::App* add_view(CLI::App& app, PageOptions& options) {
    CLI::App* view = add_command(app, "view", "Shows a scene in the browser: turn, light, compare, ask why", options);
    const Group add{*view, "Page"};
    add("--port", "N", "Where the server listens (default: a port that is free)", count(1, 65535), into(options.port));
    add("--host", "ADDRESS",
        "The address that the server listens at (default 127.0.0.1: this machine alone).\nWho reaches another one, and "
        "reads its token on the way, sees the scene",
        name(), into(options.host));
    add.flag("--no-open", options.stays_closed, "Print the page's address, and open no browser");
    add_samples({*view, "Pictures of a camera that stands still"}, "Points per pixel, at the end (default 8)",
                options.samples);
    add_sun({*view, "Pictures of a camera that stands still"},
            "Soft shadows, at the end: directional lights are disks of this angle in the sky (the sun's: 0.533)",
            default_sun_samples, options);
    add_scene_options(*view, options);
    add_camera_options(*view, options, false);
    require(*view, {{"--eye", "--target"}});
    add_light_options(*view, options);
    add_device_options(*view, options);
    return view;
}

CLI::App* add_gallery(CLI::App& app, GalleryOptions& options) {
    CLI::App* gallery =
        add_command(app, "gallery", "Every technique beside the exact truth, as one HTML page", options);
    const Group add{*gallery, "Page"};
    add("-o,--output", "FILE.html", "The page, everything in it (default gallery.html)", file_name(".html"),
        into(options.page));
    add("--technique", "NAME[:KEY=VALUE,...]",
        "Show this technique, with these settings; may be repeated\n(default: every technique as it comes)", name(),
        into(options.techniques));
    add("--runs", "N", "Timed runs of each technique, 1 to 1000 (default 3)", count(1, 1000), into(options.runs));
    add_scene_options(*gallery, options);
    add_camera_options(*gallery, options);
    require(*gallery, {{"--eye", "--target"}});
    add_light_options(*gallery, options);
    add_sun({*gallery, "Soft shadows"},
            "The truth is soft: the directional light is a disk of this angle (the sun's: 0.533), and errors are also\n"
            "measured in penumbrae alone",
            truth_sun_samples, options);
    add_device_options(*gallery, options);
    return gallery;
}

std::optional<Days> day_of(const std::string& text) {
    int year = 0, month = 0, day = 0, read = 0;
    const int found = std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &read);
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                           std::chrono::day(unsigned(day))};
    const bool is_day = found == 3 && std::size_t(read) == text.size() && date.ok();
    return is_day && year >= first_year && year <= last_year ? std::optional(Days{year, month, day}) : std::nullopt;
}

void add_sun_options(CLI::App& app, HoursOptions& options, SunsOfPlace& place) {
    const Group add{app, "Suns (a table, a weather file, or a place with a day or a year)"};
    add("--directions", "FILE.csv", "A table with the columns x,y,z or azimuth,elevation, and weight (default 1)",
        file_name(), into(options.directions));
    add("--epw", "FILE",
        "A weather file (EPW, or a TMY3 table): direct irradiation, kWh/m2, by its direct normal irradiance, place,\n"
        "years and time zone, a sun in the middle of each hour; with --cosines",
        file_name(), into(options.weather));
    add.flag("--diffuse", options.diffuse,
             "With --epw: adds the light of Perez' sky by Radiance's program gendaymtx, which must be on the PATH\n"
             "(pyradiance's wheel has it). Values are the sums; --points gets direct and diffuse, too");
    add("--place", "LAT,LON", "Where the scene is, in degrees, north and east positive", latitude_longitude(),
        [&](const auto& degrees) {
            place.latitude_degrees = degrees[0];
            place.longitude_degrees = degrees[1];
            options.place = place;
        });
    add("--day", "YYYY-MM-DD", "The suns of a day", Kind<Days>{day_of, "a day as 2026-06-21"}, into(place.days));
    add("--year", "YYYY", "The suns of a year", count(first_year, last_year), [&place](std::uint32_t year) {
        place.days = {int(year), 0, 0};
    });
    add("--step", "MINUTES", "One sun in the middle of each step, which divides a day (default 10; of a year 60)",
        only(count(1, 1440), "minutes that divide a day of 1440", [](auto minutes) { return 1440 % minutes == 0; }),
        into(place.step_minutes));
    add("--utc", "HOURS", "The clock of the days, ahead of universal time (default: the longitude / 15, rounded)",
        only(double_number(), "hours from -14 to 14", [](double hours) { return std::abs(hours) <= 14; }),
        into(place.utc_offset_hours));
    add.flag("--apparent", place.is_apparent,
             "Elevations with refraction (Saemundsson, 1010 hPa, 10 C); else true ones. Either way\n"
             "suns whose centre is not above the horizon are left out");
    add("--north", "DEGREES", "Where north lies, clockwise from -z as seen from above (default 0; y is up)",
        double_number(), into(options.north_degrees));
    add("--write-directions", "FILE.csv",
        "Writes the table that was used, which --directions takes back with the same bits\n"
        "(default with --place and --epw: the output's name with .suns.csv)",
        file_name(".csv"), into(options.written_directions));
    exclude(app, "--directions", {"--place", "--epw"});
    exclude(app, "--epw", {"--place", "--unit"});
    exclude(app, "--day", {"--year"});
    require(app, {{"--diffuse", "--epw"}});
    for (const char* const option : {"--day", "--year", "--step", "--utc", "--apparent"})
        require(app, {{option, "--place"}});
}

CLI::App* add_hours(CLI::App& app, HoursOptions& options, SunsOfPlace& place) {
    CLI::App* hours =
        add_command(app, "hours", "Sun hours, or any weights of many suns, of a scene or points", options);
    const Group add{*hours, "Outputs"};
    add("-o,--output", "FILE", "A .png of the scene coloured by the sums, with a legend; of --points a .csv or .npy",
        file_name(), into(options.result));
    add("--aov", "FILE.exr", "As of gnomon render, with the sum in place of visibility: channel value",
        file_name(".exr"), into(options.aov));
    add("--points", "FILE.csv", "Points in place of a picture: x,y,z and, for the side of the surface, nx,ny,nz",
        file_name(), into(options.points));
    add("--unit", "TEXT", "The unit of the weights, for the legend (default hours)", name(), into(options.unit));
    add("--most", "VALUE", "The value with the last colour (default: the largest)", above_0(), into(options.most));
    add.flag("--cosines", options.cosines, "Each weight times the cosine between the sun and the surface's normal");
    add_sun_options(*hours, options, place);
    add_scene_options(*hours, options);
    add_camera_options(*hours, options);
    require(*hours, {{"--eye", "--target"}});
    add("--set", "KEY=VALUE", "Changes a setting of frustum-traced; may be repeated", setting(),
        into(options.settings));
    add_device_options(*hours, options);
    exclude(*hours, "--points", {"--aov", "--camera", "--eye", "--target", "--most"});
    return hours;
}

/// Checks the options of a place, and completes them.
void complete_place(HoursOptions& options, const SunsOfPlace& place, bool has_offset) {
    if (place.days.year == 0) throw UsageError("--place needs --day YYYY-MM-DD or --year YYYY as well");
    options.place = place;
    if (place.step_minutes == 0) options.place->step_minutes = place.days.month != 0 ? 10 : 60;
    if (!has_offset) options.place->utc_offset_hours = std::round(place.longitude_degrees / 15);
}

/// Checks where the suns are from, and completes it.
void complete_suns(HoursOptions& options, const SunsOfPlace& place, bool has_offset) {
    if (!options.directions && !options.weather && !options.place)
        throw UsageError("no suns: give --directions FILE.csv, --epw FILE, or --place LAT,LON with --day or --year");
    if (options.place) complete_place(options, place, has_offset);
    if (options.weather) {
        options.cosines = true;
        options.unit = "kWh/m2";
    }
    if (options.directions || options.written_directions) return;
    options.written_directions = options.result ? *options.result : *options.aov;
    options.written_directions->replace_extension(".suns.csv");
}

void check_hours(const HoursOptions& options) {
    const std::string extension = options.result ? lower_extension(*options.result) : "";
    if (!options.result && !options.aov) throw UsageError("nothing to write: give -o FILE.png or --aov FILE.exr");
    if (!options.points && options.result && extension != ".png")
        throw UsageError("-o needs a file that ends with .png (.csv and .npy are for --points)");
    if (options.points && extension != ".csv" && extension != ".npy")
        throw UsageError("-o needs a file that ends with .csv or .npy for --points");
}

CLI::App* add_devices(CLI::App& app, ListDevices& options) {
    CLI::App* devices = app.add_subcommand("devices", "Lists every OpenCL device and says which is the default");
    CLI::Option* const check =
        devices->add_flag("--check", options.checks,
                          "Check one of them instead: known answers and times, on one page\nto send; under a minute");
    devices->add_option("--device", options.device, "The device to check (default: as for render)")
        ->type_name("P:D|NAME")
        ->needs(check);
    devices->add_flag("--json", options.prints_json, "Print the check as JSON")->needs(check);
    return devices;
}

CLI::App* add_bench(CLI::App& app, BenchOptions& options) {
    CLI::App* bench =
        app.add_subcommand("bench", "Measures a device in two minutes: known answers and times, on one page to send");
    const Group add{*bench, "Options"};
    add("--device", "P:D|NAME", "The device to measure (default: as for render)", name(), into(options.device));
    add("-o", "FILE.json", "Also write all figures there, as JSON", file_name(".json"), into(options.json));
    add("--seconds", "N",
        fmt::format("Begin no further scene after this time (default {}); answers that are\nknown are always checked",
                    options.seconds),
        count(1, 3600), into(options.seconds));
    return bench;
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

/// CLI11's sentence; where it is no whole one, completed.
std::string sentence_of(const CLI::ParseError& error) {
    const std::string text = error.what();
    const std::size_t colon = text.find(": ");
    // "--mask: 1 required TEXT missing": every option with a value takes exactly one.
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return text.substr(0, colon) + " needs a value";
    if (dynamic_cast<const CLI::ValidationError*>(&error)) return text.substr(0, colon) + text.substr(colon + 1);
    if (dynamic_cast<const CLI::ExcludesError*>(&error)) return text + ": give one of them";
    return text;
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
    } catch (const CLI::ExtrasError&) {  // whose own text has them from the last to the first
        throw UsageError(fmt::format("unexpected argument: {} (see --help)", fmt::join(parser.remaining(true), " ")));
    } catch (const CLI::ParseError& error) {
        throw UsageError(sentence_of(error));
    }
    return {};
}

/// The parser of all commands, before any is added.
void describe(CLI::App& parser) {
    parser.set_version_flag("--version", "gnomon " + std::string(version()), "Print the version");
    parser.set_help_flag("-h,--help", "Print this help");
    parser.footer(help_text("main"));
    parser.require_subcommand(0, 1);
    parser.get_formatter()->column_width(36);
}

/// Parses a command line of the one command that `add` adds.
template <typename Add>
void parse_one(const std::vector<std::string>& arguments, const Add& add) {
    CLI::App parser(main_description, "gnomon");
    const CLI::App* const command = add(parser);
    if (parse_or_text(parser, arguments) || !*command) throw UsageError("is no command line of this command");
}

}  // namespace

RenderOptions render_options_of(const std::vector<std::string>& arguments) {
    RenderOptions options;
    parse_one(arguments, [&](CLI::App& parser) { return add_render(parser, options); });
    check_samples(options);
    check_outputs(options);
    return options;
}

ExplainOptions explain_options_of(const std::vector<std::string>& arguments) {
    ExplainOptions options;
    parse_one(arguments, [&](CLI::App& parser) { return add_explain(parser, options); });
    check_explained(options);
    return options;
}

HoursOptions hours_options_of(const std::vector<std::string>& arguments) {
    HoursOptions options;
    SunsOfPlace place;
    parse_one(arguments, [&](CLI::App& parser) { return add_hours(parser, options, place); });
    check_hours(options);
    complete_suns(options, place, false);
    return options;
}

Command parse_command_line(const std::vector<std::string>& arguments) {
    RenderOptions render_options;
    ListDevices devices_options;
    BenchOptions bench_options;
    ListTechniques techniques_options;
    ExplainOptions explain_options;
    PageOptions page_options;
    GalleryOptions gallery_options;
    HoursOptions hours_options;
    SunsOfPlace place;
    gallery_options.size = {960, 540};
    page_options.samples = 8;
    render_options.command_line = gallery_options.command_line = arguments;

    CLI::App parser(main_description, "gnomon");
    describe(parser);
    CLI::App* const render = add_render(parser, render_options);
    CLI::App* const explain = add_explain(parser, explain_options);
    CLI::App* const view = add_view(parser, page_options);
    CLI::App* const gallery = add_gallery(parser, gallery_options);
    CLI::App* const hours = add_hours(parser, hours_options, place);
    CLI::App* const devices = add_devices(parser, devices_options);
    CLI::App* const bench = add_bench(parser, bench_options);
    CLI::App* const techniques = add_techniques(parser, techniques_options);
    if (const std::optional<std::string> text = parse_or_text(parser, arguments)) return print(*text);

    if (*render) return checked(app::render, render_options, check_samples, check_outputs);
    if (*hours) {
        check_hours(hours_options);
        complete_suns(hours_options, place, hours->count("--utc") != 0);
        return checked(app::hours, hours_options);
    }
    if (*explain) return checked(app::explain, explain_options, check_explained);
    if (*view) return checked(app::view, page_options);
    if (*gallery) return checked(app::gallery, gallery_options);
    if (*devices && devices_options.checks) return checked(check_device, devices_options);
    if (*devices) return [] { print_result(device_list()); };
    if (*bench) return checked(bench_device, bench_options);
    if (*techniques) return [=] { print_result(technique_list(techniques_options)); };
    return print(help_of(parser));
}

}  // namespace gnomon::app
