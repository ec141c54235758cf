// SPDX-License-Identifier: MIT
#include "facts.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "../miss_distance.hpp"
#include "request.hpp"

namespace gnomon::app {
namespace {

using nlohmann::ordered_json;
constexpr std::size_t most_triangles = 8;  // of a list

ordered_json light_json(const Light& light) {
    const bool is_directional = light.is_directional();
    return {{"directional", is_directional},
            {"at", is_directional ? float3_text(direction_of(light)) : float3_text(position_of(light))}};
}

ordered_json triangles_json(const std::vector<TriangleSigns>& list) {
    ordered_json json = ordered_json::array();
    for (const TriangleSigns& t : list) {
        if (json.size() == most_triangles) break;
        json.push_back({{"triangle", t.triangle}, {"vertices", t.vertices}, {"distance", t.distance}});
    }
    return json;
}

ordered_json techniques_json() {
    ordered_json json = ordered_json::array();
    for (const TechniqueDescription& technique : techniques())
        if (technique.name != "frustum-traced")
            json.push_back({{"name", technique.name}, {"summary", technique.summary}, {"exact", technique.exact}});
    return json;
}

/// Those that a name finds: of several with one name, the first.
template <typename Named, typename More>
ordered_json names_json(const std::vector<Named>& all, const More& more) {
    ordered_json json = ordered_json::array();
    std::set<std::string> seen;
    for (const Named& one : all)
        if (!one.name.empty() && seen.insert(one.name).second) json.push_back(more(one));
    return json;
}

}  // namespace

ordered_json camera_facts(const ChosenCamera& chosen) {
    const Camera& camera = chosen.camera;
    return {{"source", chosen.source},   {"eye", camera.eye},
            {"right", camera.right},     {"up", camera.up},
            {"forward", camera.forward}, {"fovy", camera.fov_y_radians * 180 / std::numbers::pi}};
}

ordered_json light_facts(const PictureLights& lights) {
    ordered_json json = ordered_json::array();
    for (const ChosenLight& light : lights.chosen) {
        json.push_back(light_json(light.light));
        json.back()["source"] = light.source;
        if (json.size() == most_triangles) break;
    }
    return json;
}

ordered_json scene_facts(const PageOptions& page, const scene::Scene& scene, const DeviceDescription& device) {
    ordered_json start = ordered_json::object();
    for (const auto& [name, value] : start_parameters(page)) start[name] = value;
    std::array<double, 6> bounds{1e300, 1e300, 1e300, -1e300, -1e300, -1e300};
    for (std::size_t t = 0; t < scene.triangle_count(); ++t)
        for (std::size_t i = 0; scene.is_finite(t) && i < 9; ++i) {
            const double c = double(scene.triangles[9 * t + i]);
            bounds[i % 3] = std::min(bounds[i % 3], c);
            bounds[3 + i % 3] = std::max(bounds[3 + i % 3], c);
        }
    ordered_json animations = ordered_json::array();
    for (std::size_t i = 0; i < scene.animations.size(); ++i)
        animations.push_back({{"name", scene.animations[i]}, {"end_s", scene.animation_ends_s[i]}});
    return {{"scene", page.scene ? page.scene->filename().string() : "the built-in sundial"},
            {"triangles", scene.triangle_count()},
            {"bounds", bounds},
            {"cameras", names_json(scene.cameras, [](const auto& camera) { return ordered_json(camera.name); })},
            {"lights", names_json(scene.lights,
                                  [](const auto& light) {
                                      ordered_json json = light_json(light.light);
                                      json["name"] = light.name;
                                      json["type"] = light.type;
                                      return json;
                                  })},
            {"animations", std::move(animations)},
            {"techniques", techniques_json()},
            {"warnings", scene.warnings},
            {"device", device.name},
            {"version", std::string(version())},
            {"start", std::move(start)}};
}

ordered_json explanation_facts(const Explained& explained, const ChosenCamera& camera) {
    const Explanation& e = explained.explanation;
    const std::vector<TriangleSigns> near_misses = near_misses_of(explained);
    ordered_json missed = triangles_json(near_misses);
    for (std::size_t i = 0; i < missed.size(); ++i)
        missed[i]["missed_by"] = miss_distance(near_misses[i], e.position, explained.light.light);
    return {{"text", text_of(explained)},
            {"reason", reason(e)},
            {"is_lit", e.is_lit()},
            {"is_absent", !std::all_of(e.position.begin(), e.position.end(), [](float c) { return std::isfinite(c); })},
            {"is_consistent", e.is_consistent()},
            {"stage", e.stage},
            {"arithmetic", e.arithmetic},
            {"position", e.position},
            {"receiver", triangles_json({e.on_receiver})},
            {"occluders", triangles_json(e.occluders)},
            {"near_misses", std::move(missed)},
            {"light", light_json(explained.light.light)},
            {"camera", camera_facts(camera)}};
}

ordered_json legend_facts(const ColorScale& scale) {
    constexpr int steps = 16;
    ordered_json colors = ordered_json::array();
    for (int i = 0; i <= steps; ++i) {
        const auto [r, g, b] = scale.color(scale.least + (scale.most - scale.least) * i / steps);
        colors.push_back(fmt::format("#{:02x}{:02x}{:02x}", r, g, b));
    }
    return {{"least", scale.least}, {"most", scale.most}, {"unit", scale.unit}, {"colors", std::move(colors)}};
}

ordered_json suns_facts(const SunTable& table) {
    ordered_json json = ordered_json::array();
    for (const Sun& sun : table.suns) json.push_back({{"time", sun.time}, {"direction", float3_text(sun.direction)}});
    return json;
}

}  // namespace gnomon::app
