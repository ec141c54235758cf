// SPDX-License-Identifier: MIT
// The command line as structs, and the commands that take them. Parsing opens no file and no device, so a wrong command
// line is refused at once. CLI11 splits and documents; values.hpp reads the values.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "area_light.hpp"
#include "scene/scene.hpp"
#include "suns.hpp"
#include "values.hpp"

namespace gnomon::app {

/// `gnomon devices [--check [--device D] [--json]]`
struct ListDevices {
    bool checks = false;
    bool prints_json = false;  ///< of the check
    std::string device;        ///< the one to check; empty: the default
};

/// `gnomon bench`
struct BenchOptions {
    std::string device;  ///< empty: the default
    std::optional<std::filesystem::path> json;
    std::uint32_t seconds = 120;  ///< after that, no further scene is begun
};

/// `gnomon techniques [NAME] [--verbose]`
struct ListTechniques {
    std::string name;  ///< empty: all of them
    bool verbose = false;
};

/// The scene, the camera, the light and the device: for every command that renders.
struct ViewOptions {
    std::optional<std::filesystem::path> scene;  ///< none: the built-in sundial
    ImageSize size{1920, 1080};

    // Of a scene file; scene::LoadOptions says what each means.
    std::optional<std::string> scene_choice, animation;
    std::optional<double> time_s;
    scene::BlendCasters blend = scene::BlendCasters::opaque;

    // Either a camera of the scene, or eye and target; fov_y_degrees goes with both.
    std::optional<std::string> camera;
    std::optional<Float3> eye, target, up;
    std::optional<float> fov_y_degrees;

    // At most one of the following.
    std::optional<std::string> light;
    std::optional<Float3> light_direction, light_position;
    std::optional<AreaLight> area_light;  ///< of gnomon render

    std::optional<float> sun_angle_degrees;    ///< of the disk that a directional light is; none: a point of the sky
    std::optional<std::uint32_t> sun_samples;  ///< of the disk

    std::string device;
    std::uint64_t memory_limit_bytes = 0;  ///< 0: none

    bool strict = false;
    bool quiet = false;
    std::vector<std::string> command_line;  ///< as given, for the statistics
};

inline constexpr std::uint32_t default_sun_samples = 64, truth_sun_samples = 1024;

/// `gnomon render`
struct RenderOptions : ViewOptions {
    // At least one of the following.
    std::optional<std::filesystem::path> picture, mask, aov, triangle_dump, point_dump, statistics;

    std::uint32_t frames = 0;  ///< of a sequence, from time_s on; 0: one picture
    std::optional<double> frames_per_s;

    bool profile = false;                       ///< time each stage on the device
    std::uint32_t samples = 1;                  ///< per pixel
    std::optional<std::string> diagnostic;      ///< drawn instead of the picture
    std::optional<std::uint32_t> area_samples;  ///< of the area light

    std::optional<double> exposure_ev;  ///< of the picture; none: metered, or 0
    bool is_metered = false;
    std::uint32_t sky_division = 0;  ///< of sky_patches(), for the picture's ambient light; 0: ambient light everywhere

    std::string technique = "frustum-traced";
    std::vector<std::pair<std::string, std::string>> settings;  ///< for Technique::set, in this order
};

/// `gnomon gallery`
struct GalleryOptions : ViewOptions {
    std::filesystem::path page = "gallery.html";
    std::vector<std::string> techniques;  ///< NAME or NAME:KEY=VALUE,KEY=VALUE; empty: every one, with its defaults
    std::uint32_t runs = 3;               ///< timed runs of each
};

/// `gnomon hours`
struct HoursOptions : ViewOptions {
    std::optional<std::filesystem::path> result;              ///< .png of a picture; .csv or .npy of points
    std::optional<std::filesystem::path> aov, points;         ///< of a picture; in place of a picture
    std::optional<std::filesystem::path> written_directions;  ///< the table that the run used

    // Exactly one of the following.
    std::optional<std::filesystem::path> directions, weather;
    std::optional<SunsOfPlace> place;

    double north_degrees = 0;    ///< clockwise from -z, seen from above
    bool diffuse = false;        ///< of a weather file the sky's light, too
    bool cosines = false;        ///< each weight times the cosine to the surface's normal
    std::optional<double> most;  ///< the value with the last colour; none: the largest
    std::string unit = "hours";
    std::vector<std::pair<std::string, std::string>> settings;  ///< of frustum-traced
};

/// `gnomon view`: a scene in, a page with its pictures out. The picture's options are what the page starts with.
struct PageOptions : RenderOptions {
    std::string host = "127.0.0.1";  ///< the address that the server listens at
    std::uint32_t port = 0;          ///< 0: any that is free
    bool stays_closed = false;       ///< opens no browser
};

/// `gnomon explain`
struct ExplainOptions : ViewOptions {
    std::optional<std::filesystem::path> triangles;  ///< nine float32 each, in place of a scene

    // Exactly one of the following.
    std::optional<Pixel> pixel;
    std::optional<Float3> point;

    std::optional<std::uint32_t> receiver;  ///< of the point
    std::uint32_t samples = 1, sample = 0;  ///< of the pixel
};

// The commands, one function each.

/// `gnomon render`: a scene in, pictures and figures out. Every error of the request is found before the long work;
/// files appear only when all of them are complete. Throws UsageError, Error or std::bad_alloc; then no output was
/// touched.
void render(const RenderOptions& options);

/// `gnomon hours`: for each pixel or point the sum of the weights of the suns that reach it. Throws as render() does.
void hours(const HoursOptions& options);

/// `gnomon explain`: prints why one pixel, or one point, is lit or in shadow. Throws UsageError or Error; if the
/// technique's visibility and the exact signs differ, prints the explanation and then throws Error.
void explain(const ExplainOptions& options);

/// `gnomon view`: serves a page that shows the scene from all sides, until the program is interrupted. Throws Error if
/// it cannot listen.
void view(const PageOptions& options);

/// `gnomon gallery`: runs every technique of the options on one view and writes one self-contained HTML page. If a
/// technique fails, the page has its error in place of a picture. Throws Error if there is nothing to show.
void gallery(const GalleryOptions& options);

/// `gnomon devices`, as text: the default with the reason, and what each lacks. Throws DeviceNotFound if there is none.
std::string device_list();
std::string device_text(const DeviceDescription& device);  ///< its lines of the list

/// `gnomon devices --check`: prints one page about a device, or the same as JSON: its self-check, answers that are
/// known bit for bit, and times. Throws DeviceNotFound as Device does, and Error, after the page, if an answer is
/// wrong.
void check_device(const ListDevices& options);

/// `gnomon bench`: prints one page about a device: answers of the golden record, and times of whole frames. Throws as
/// check_device() does.
void bench_device(const BenchOptions& options);

/// `gnomon techniques`, as text: a line each, with its settings under --verbose. Throws Error with the list for an
/// unknown name.
std::string technique_list(const ListTechniques& options);

/// Runs what the arguments (the program's name first) name: a command, or the print of a text such as --help's.
using Command = std::function<void()>;

/// Reads the arguments. Throws UsageError.
Command parse_command_line(const std::vector<std::string>& arguments);

/// The options that the arguments of one command give, the program's name first. Throw UsageError as
/// parse_command_line() does.
RenderOptions render_options_of(const std::vector<std::string>& arguments);
ExplainOptions explain_options_of(const std::vector<std::string>& arguments);
HoursOptions hours_options_of(const std::vector<std::string>& arguments);

}  // namespace gnomon::app
