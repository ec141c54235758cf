// SPDX-License-Identifier: MIT
// What the page is told, as JSON. Numbers of options are texts: the page gives them back as they are.
#pragma once

#include <nlohmann/json.hpp>

#include "../color_scale.hpp"
#include "../explained.hpp"
#include "../picture.hpp"
#include "../suns.hpp"

namespace gnomon::app {

nlohmann::ordered_json camera_facts(const ChosenCamera& camera);
nlohmann::ordered_json light_facts(const PictureLights& lights);

/// What the page can choose from, and the options that it starts with.
nlohmann::ordered_json scene_facts(const PageOptions& page, const scene::Scene& scene, const DeviceDescription& device);

/// The text of gnomon explain, and the shapes that it names.
nlohmann::ordered_json explanation_facts(const Explained& explained, const ChosenCamera& camera);

/// The ends of a scale, and its colours at even steps, for a style sheet.
nlohmann::ordered_json legend_facts(const ColorScale& scale);

nlohmann::ordered_json suns_facts(const SunTable& table);

}  // namespace gnomon::app
