// SPDX-License-Identifier: MIT
// The common start of every command that renders: a device, a scene with its warnings, the camera and the light (from
// the options and the scene, each with its source), a technique with its settings.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "options.hpp"
#include "scene/scene.hpp"

namespace gnomon::app {

/// Opens the device of the options; with `profile` kernels are timed by events.
Device open_device(const ViewOptions& options, bool profile);

/// The scene's file, read once, or the built-in sundial.
class SceneSource {
public:
    /// `has_colors`: with textures, vertex colours and normals, for a picture.
    SceneSource(const ViewOptions& options, bool has_colors);
    /// Prints the warnings that no earlier time had (or throws the first, under --strict).
    scene::Scene at(std::optional<double> time_s);

private:
    std::unique_ptr<scene::SceneFile> file_;  ///< null: the sundial
    bool strict_, quiet_;
    std::set<std::string> printed_;
};

/// The scene of the options, with its warnings printed as SceneSource does.
scene::Scene load_scene(const ViewOptions& options, bool has_colors = false);

/// The scene's triangles on the device, with their cut-outs, and with clusters if there are enough triangles.
Triangles upload_triangles(const Device& device, const scene::Scene& scene);

/// Triangles alone, nine little-endian float32 each, as --dump-triangles writes them. Throws Error.
scene::Scene load_triangles(const std::filesystem::path& file);

/// The technique of this name. Throws Error with the list of names if there is none.
TechniqueDescription describe_technique(const std::string& name);

/// Makes a technique and sets its settings, in their order.
std::unique_ptr<Technique> make_technique(const Device& device, const std::string& name,
                                          const std::vector<std::pair<std::string, std::string>>& settings);

struct ChosenCamera {
    Camera camera;
    std::string source;  ///< for people: "the scene's camera \"main\"", "--eye and --target", ...
    std::shared_ptr<const scene::Framing> framing{};  ///< of the default view
};

struct ChosenLight {
    Light light;  ///< of an area light: at its centre
    std::string source;
    std::optional<AreaLight> area{};
};

/// Throws UsageError if the options make no camera, Error if the scene has none of that name.
/// `add_more`: adds other times of an animation to what the default camera frames.
ChosenCamera choose_camera(const ViewOptions& options, const scene::Scene& scene,
                           const std::function<void(scene::Framing&)>& add_more = {});
/// What the default view does not show of the scene, unless --quiet.
void print_camera_note(const ViewOptions& options, const scene::Scene& scene, const ChosenCamera& chosen);
ChosenLight choose_light(const ViewOptions& options, const scene::Scene& scene);
/// All lights of the scene, in its order, for "--light all" if no light has that name; else choose_light()'s.
std::vector<ChosenLight> choose_lights(const ViewOptions& options, const scene::Scene& scene);

/// The direction in which a directional light travels, with the bits as given.
Float3 direction_of(const Light& light);
/// The position of a point light.
Float3 position_of(const Light& light);
/// The disk in the sky that a directional light is for --sun-angle. Throws Error for a point light.
Lights sun_of(const ViewOptions& options, const ChosenLight& chosen, std::uint32_t default_samples);
/// The option that gives exactly this light again, e.g. "--light-direction=-0.400000006,-1,-0.300000012".
std::string light_option(const ChosenLight& light);

}  // namespace gnomon::app
