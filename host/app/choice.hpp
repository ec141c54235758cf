// SPDX-License-Identifier: MIT
// Which camera and which light a run uses, from the options and what the scene offers, and where each came from.
#pragma once

#include <string>
#include <vector>

#include "options.hpp"
#include "scene/scene.hpp"

namespace gnomon::app {

struct ChosenCamera {
    Camera camera;
    std::string source;  ///< for people: "the scene's camera \"main\"", "--eye and --target", ...
};

struct ChosenLight {
    Light light;
    std::string source;
};

/// Throws UsageError where the options make no camera, Error where the scene has none of that name.
ChosenCamera choose_camera(const ViewOptions& options, const scene::Scene& scene);
ChosenLight choose_light(const ViewOptions& options, const scene::Scene& scene);
/// All lights of the scene, in its order, where "--light all" asks for them and none has that name; else the one above.
std::vector<ChosenLight> choose_lights(const ViewOptions& options, const scene::Scene& scene);

/// The way a directional light travels, bit for bit as it was given.
Float3 direction_of(const Light& light);
/// Where a positional light is.
Float3 position_of(const Light& light);
/// The option that gives exactly this light again, e.g. "--light-direction=-0.400000006,-1,-0.300000012".
std::string light_option(const Light& light);

}  // namespace gnomon::app
