// SPDX-License-Identifier: MIT
// Scenes by name, and what is seen of them: a case is a camera and a light.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include <gnomon.hpp>
#include "scene/scene.hpp"

namespace gnomon::bench {

using Json = nlohmann::ordered_json;

struct Case {
    std::string view, light_name;
    Camera camera;
    Light light;
};

struct NamedScene {
    std::string name;  ///< "sponza", "city_6500000", "sundial"
    scene::Scene scene;
    std::vector<Case> cases;
};

/// Loads scenes: a glTF file, `sundial` (built in), or RECIPE:TRIANGLES (of make_scenes: `city:6500000`).
class SceneShelf {
public:
    /// `views`: views and lights by scene name, as in scenes/views.json; a scene that is not named there is
    /// seen by each of its own cameras in each of its own lights.
    /// `folder`: of the two real scenes, sponza.glb and lost_empire.glb; may be empty.
    SceneShelf(const std::filesystem::path& views_file, std::filesystem::path folder);

    /// The scene last asked for is kept, so ask for all of one scene in a row.
    const NamedScene& get(const std::string& name);
    /// The path of a file of the folder; empty if it is not there.
    std::string in_folder(const std::string& file) const;

private:
    std::vector<Case> cases_of(const NamedScene& loaded) const;

    Json views_ = Json::object();
    std::filesystem::path folder_;
    std::string asked_;
    NamedScene loaded_;
};

}  // namespace gnomon::bench
