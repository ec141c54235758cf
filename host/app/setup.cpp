// SPDX-License-Identifier: MIT
// A device, a scene, a camera, a light, a technique. Names win over positions, so that a light called "1" can be had.
#include "setup.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numbers>

#include "output_files.hpp"
#include "pictures.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

constexpr double default_fov_y_degrees = 50;

/// The number of an entry in its file; its position where there is no file, or several entries are one of the file's
/// (two nodes with one camera).
template <typename Named>
std::size_t number_of(const std::vector<Named>& all, std::size_t position) {
    std::set<int> numbers;
    for (const Named& one : all) numbers.insert(one.file_index);
    const bool are_unique = numbers.size() == all.size() && !numbers.contains(-1);
    return are_unique ? std::size_t(all[position].file_index) : position;
}

/// "0 \"main\", 1 \"top\"", or the end of a sentence for an empty list.
template <typename Named>
std::string list_of(const std::vector<Named>& all) {
    std::string text;
    for (std::size_t i = 0; i < all.size(); ++i)
        text += fmt::format("{}{} \"{}\"", i == 0 ? "" : ", ", number_of(all, i), all[i].name);
    return text;
}

/// The entry of that name or number. `kind` is "camera" or "light".
template <typename Named>
const Named& find_named(const std::vector<Named>& all, const std::string& name, const std::string& kind) {
    for (const Named& one : all)
        if (one.name == name) return one;
    std::size_t index = 0;
    const auto [stopped, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error == std::errc{} && stopped == name.data() + name.size())
        for (std::size_t i = 0; i < all.size(); ++i)
            if (number_of(all, i) == index) return all[i];
    const std::string there_is =
        all.empty() ? "the scene has no " + kind + "s" : "the scene has these: " + list_of(all);
    throw Error("there is no " + kind + " \"" + name + "\": " + there_is);
}

Camera camera_of_eye(const ViewOptions& options) {
    const Float3 up = options.up.value_or(Float3{0, 1, 0});
    try {
        return Camera::look_at(*options.eye, *options.target, up, default_fov_y_degrees);
    } catch (const InvalidArgument& error) {
        throw UsageError("--eye, --target and --up make no camera: " + std::string(error.what()));
    }
}

ChosenCamera camera_with_its_own_view(const ViewOptions& options, const scene::Scene& scene,
                                      const std::function<void(scene::Framing&)>& add_more) {
    if (options.eye) return {camera_of_eye(options), "--eye and --target"};
    if (options.camera) {
        const scene::NamedCamera& found = find_named(scene.cameras, *options.camera, "camera");
        return {found.camera, "the scene's camera \"" + found.name + "\""};
    }
    if (!scene.cameras.empty())
        return {scene.cameras.front().camera, "the scene's first camera, \"" + scene.cameras.front().name + "\""};
    const double aspect = double(options.size.width) / double(options.size.height);
    const auto framing = std::make_shared<scene::Framing>(scene, aspect);
    if (add_more) add_more(*framing);
    return {framing->camera(), "the default: frames the scene, or stands in an interior", framing};
}

}  // namespace

Device open_device(const ViewOptions& options, bool profile) {
    DeviceOptions device_options;
    device_options.profile = profile;
    device_options.memory_limit_bytes = options.memory_limit_bytes;
    return Device(options.device, device_options);
}

SceneSource::SceneSource(const ViewOptions& options, bool has_colors) : strict_(options.strict), quiet_(options.quiet) {
    if (!options.scene) return;
    scene::LoadOptions choices;
    choices.scene = options.scene_choice;
    choices.animation = options.animation;
    choices.blend = options.blend;
    choices.decode_alpha = [](std::span<const unsigned char> bytes) {
        AlphaImage image = decode_alpha(bytes);
        return scene::SceneCutOuts::Texture{image.width, image.height, std::move(image.alpha)};
    };
    if (has_colors)
        choices.decode_colors = [](std::span<const unsigned char> bytes, std::uint64_t max_bytes) {
            RgbaImage image = decode_colors(bytes, max_bytes);
            return scene::ColorImage{image.width, image.height, std::move(image.rgba)};
        };
    file_ = std::make_unique<scene::SceneFile>(*options.scene, choices);
}

scene::Scene SceneSource::at(std::optional<double> time_s) {
    scene::Scene loaded = file_ ? file_->at(time_s) : scene::sundial();
    if (strict_ && !loaded.warnings.empty()) throw Error(loaded.warnings.front() + " (an error because of --strict)");
    for (const std::string& warning : loaded.warnings)
        if (printed_.insert(warning).second) print_warning(warning);
    for (const std::string& note : loaded.notes)
        if (!quiet_ && printed_.insert(note).second) print_note(note);
    return loaded;
}

scene::Scene load_scene(const ViewOptions& options, bool has_colors) {
    return SceneSource(options, has_colors).at(options.time_s);
}

scene::Scene load_triangles(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream.is_open() || std::filesystem::is_directory(file)) refuse_input(file);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) refuse_input(file);
    constexpr std::size_t triangle_bytes = 9 * sizeof(float);
    if (bytes.size() % triangle_bytes != 0)
        throw Error(
            fmt::format("{} holds {} bytes: triangles take 36 bytes each, nine float32", file.string(), bytes.size()));
    scene::Scene scene;
    scene.triangles.resize(bytes.size() / sizeof(float));
    std::memcpy(scene.triangles.data(), bytes.data(), bytes.size());
    return scene;
}

Triangles upload_triangles(const Device& device, const scene::Scene& scene) {
    Triangles triangles = scene::upload(device, scene);
    if (triangles.count() >= triangles_worth_clusters) triangles.keep_clusters(device);
    return triangles;
}

ChosenCamera choose_camera(const ViewOptions& options, const scene::Scene& scene,
                           const std::function<void(scene::Framing&)>& add_more) {
    ChosenCamera chosen = camera_with_its_own_view(options, scene, add_more);
    if (options.fov_y_degrees) chosen.camera.fov_y_radians = double(*options.fov_y_degrees) * std::numbers::pi / 180;
    return chosen;
}

void print_camera_note(const ViewOptions& options, const scene::Scene& scene, const ChosenCamera& chosen) {
    if (options.quiet || !chosen.framing) return;
    for (const std::string& note : {chosen.framing->left_out(scene), chosen.framing->hidden(scene)})
        if (!note.empty()) print_note(note);
}

ChosenLight choose_light(const ViewOptions& options, const scene::Scene& scene) {
    if (options.light_direction) return {Light::directional(*options.light_direction), "--light-direction"};
    if (options.light_position) return {Light::point(*options.light_position), "--light-position"};
    if (options.area_light) {
        options.area_light->require_area();
        return {Light::point(options.area_light->centre()), "--area-light", options.area_light};
    }
    if (options.light) {
        const scene::NamedLight& found = find_named(scene.lights, *options.light, "light");
        return {found.light, "the scene's " + found.type + " light \"" + found.name + "\""};
    }
    if (!scene.lights.empty()) {
        const scene::NamedLight& first = scene.lights.front();
        return {first.light, "the scene's first light, " + first.type + " \"" + first.name + "\""};
    }
    return {scene::default_light(), "the default light, as the scene has none"};
}

std::vector<ChosenLight> choose_lights(const ViewOptions& options, const scene::Scene& scene) {
    const bool is_name =
        std::any_of(scene.lights.begin(), scene.lights.end(), [](const auto& light) { return light.name == "all"; });
    if (options.light != "all" || is_name) return {choose_light(options, scene)};
    if (scene.lights.empty()) throw Error("--light all: the scene has no lights");
    std::vector<ChosenLight> lights;
    for (const scene::NamedLight& light : scene.lights)
        lights.push_back({light.light, "the scene's " + light.type + " light \"" + light.name + "\""});
    return lights;
}

Float3 direction_of(const Light& light) { return {-light.xyzw[0], -light.xyzw[1], -light.xyzw[2]}; }

Float3 position_of(const Light& light) { return {light.xyzw[0], light.xyzw[1], light.xyzw[2]}; }

Lights sun_of(const ViewOptions& options, const ChosenLight& chosen, std::uint32_t default_samples) {
    if (!chosen.light.is_directional())
        throw Error("--sun-angle is for directional lights, and " + chosen.source + " is a point light");
    return sun_disk(direction_of(chosen.light), *options.sun_angle_degrees,
                    options.sun_samples.value_or(default_samples));
}

std::string light_option(const ChosenLight& chosen) {
    if (const auto& area = chosen.area)
        return "--area-light=" + float3_text(area->corner) + "," + float3_text(area->edge_a) + "," +
               float3_text(area->edge_b);
    const Light& light = chosen.light;
    return light.is_directional() ? "--light-direction=" + float3_text(direction_of(light))
                                  : "--light-position=" + float3_text(position_of(light));
}

TechniqueDescription describe_technique(const std::string& name) {
    std::string names;
    for (TechniqueDescription& technique : techniques()) {
        if (technique.name == name) return std::move(technique);
        names += (names.empty() ? "" : ", ") + technique.name;
    }
    throw Error("there is no technique \"" + name + "\": these exist: " + names);
}

std::unique_ptr<Technique> make_technique(const Device& device, const std::string& name,
                                          const std::vector<std::pair<std::string, std::string>>& settings) {
    std::unique_ptr<Technique> technique = gnomon::make_technique(name, device);
    for (const auto& [key, value] : settings) technique->set(key, value);
    return technique;
}

}  // namespace gnomon::app
