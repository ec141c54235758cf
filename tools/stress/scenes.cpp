// SPDX-License-Identifier: MIT
// See scenes.hpp.
#include "scenes.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "../make_scenes/recipes.hpp"
#include "scene/scene.hpp"

namespace stress {
namespace {

/// A seventh of the diagonal of its box: how far shadows are looked for.
double reach_of(const Floats& triangles) {
    std::array<double, 3> low{0, 0, 0}, high{0, 0, 0};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        low[i % 3] = i < 3 ? triangles[i] : std::min(low[i % 3], double(triangles[i]));
        high[i % 3] = i < 3 ? triangles[i] : std::max(high[i % 3], double(triangles[i]));
    }
    return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / 7;
}

Viewpoint viewpoint_of(const gnomon::Camera& camera) {
    Viewpoint view;
    view.eye = camera.eye;
    for (int c = 0; c < 3; ++c) {
        view.target[c] =
            static_cast<float>(camera.eye[c] + camera.forward[c] * std::max(1.0f, std::fabs(camera.eye[c])));
        view.up[c] = static_cast<float>(camera.up[c]);
    }
    view.fov_y_degrees = camera.fov_y_radians * 180 / std::numbers::pi;
    return view;
}

Subject subject_of(const std::filesystem::path& file) {
    gnomon::scene::Scene scene = gnomon::scene::load(file);
    Subject subject;
    for (const auto& light : scene.lights) subject.lights.push_back(light.light.xyzw);
    for (const auto& camera : scene.cameras) subject.views.push_back(viewpoint_of(camera.camera));
    subject.reach = reach_of(scene.triangles);
    subject.triangles = std::make_shared<const Floats>(std::move(scene.triangles));
    return subject;
}

Float3 float3_of(const nlohmann::json& json) { return {json.at(0), json.at(1), json.at(2)}; }

}  // namespace

Subject made_scene(std::string_view name, std::uint64_t seed, std::uint32_t triangles) {
    using namespace gnomon::make_scenes;
    const auto recipe = std::ranges::find(recipes(), name, &Recipe::name);
    if (recipe == recipes().end()) throw std::invalid_argument("there is no scene " + std::string(name));
    const auto file = std::filesystem::temp_directory_path() / fmt::format("stress_{}.glb", getpid());
    write_glb(recipe->make({triangles != 0 ? triangles : recipe->default_triangles, seed}), file);
    Subject subject = subject_of(file);
    std::filesystem::remove(file);
    return subject;
}

Subject real_scene(const std::string& name) {
    const std::filesystem::path folder = GNOMON_SCENES;
    Subject subject = subject_of(folder / (name + ".glb"));
    std::ifstream stream(folder / "views.json");
    const nlohmann::json views = nlohmann::json::parse(stream).at(name);
    subject.views.clear();
    subject.lights.clear();
    for (const auto& view : views.at("views"))
        subject.views.push_back(
            {float3_of(view["eye"]), float3_of(view["target"]), float3_of(view["up"]), view["fov_y"]});
    for (const auto& light : views.at("lights")) {
        const Float3 d = float3_of(light["direction"]);
        subject.lights.push_back(support::along(d[0], d[1], d[2]));
    }
    return subject;
}

}  // namespace stress
