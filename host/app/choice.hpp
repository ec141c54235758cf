// SPDX-License-Identifier: MIT
// The camera and the light of a run, from the options and the scene, and the source of each.
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

/// Throws UsageError if the options make no camera, Error if the scene has none of that name.
ChosenCamera choose_camera(const ViewOptions& options, const scene::Scene& scene);
ChosenLight choose_light(const ViewOptions& options, const scene::Scene& scene);
/// All lights of the scene, in its order, for "--light all" if no light has that name; else choose_light()'s.
std::vector<ChosenLight> choose_lights(const ViewOptions& options, const scene::Scene& scene);

/// The direction in which a directional light travels, with the bits as given.
Float3 direction_of(const Light& light);
/// The position of a point light.
Float3 position_of(const Light& light);
/// The option that gives exactly this light again, e.g. "--light-direction=-0.400000006,-1,-0.300000012".
std::string light_option(const Light& light);

}  // namespace gnomon::app
