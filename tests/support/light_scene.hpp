// SPDX-License-Identifier: MIT
// A scene with points and a light: the one type for the question "which points are in shadow?", and the oracle's
// visibility for it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gnomon.hpp>
#include "reference/visibility.hpp"
#include "scene_makers.hpp"

namespace support {

/// Settings of a technique: names and values.
using Settings = std::vector<std::pair<std::string, std::string>>;

inline std::string text_of(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings) text += (text.empty() ? "" : " ") + name + "=" + value;
    return text;
}

struct LightScene {
    std::string name;
    Floats triangles{};  ///< 9 each
    Floats points{};     ///< 3 each
    Light light{};
    std::vector<std::uint32_t> receivers{};  ///< one per point, or none
    std::optional<Float3> eye{};
};

inline gnomon::Points upload_points(const gnomon::Device& device, const LightScene& scene) {
    return gnomon::Points::upload(device, scene.points, scene.receivers);
}

inline gnomon::Facing facing_of(const std::optional<Float3>& eye) {
    return eye ? gnomon::Facing::eye(*eye) : gnomon::Facing::none();
}

/// The oracle's visibility of each point: 1 lit, 0 in shadow.
inline std::vector<float> truth_of(const LightScene& scene) {
    std::vector<float> visibility;
    for (const std::uint8_t in_shadow :
         reference::shadowed(scene.triangles, scene.points, scene.receivers, scene.light, scene.eye))
        visibility.push_back(in_shadow ? 0.0f : 1.0f);
    return visibility;
}

}  // namespace support
