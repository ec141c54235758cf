// SPDX-License-Identifier: MIT
#include "cases.hpp"

#include <fmt/core.h>
#include <stb_image.h>

#include <charconv>
#include <fstream>
#include <limits>
#include <memory>
#include <random>

#include "make_scenes/recipes.hpp"

namespace gnomon::bench {

namespace {

Float3 float3_of(const Json& json) { return {json.at(0), json.at(1), json.at(2)}; }

Json read_json(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw InvalidArgument("cannot read the views in " + file.string());
    try {
        return Json::parse(stream);
    } catch (const Json::exception& error) {
        throw InvalidArgument("the views in " + file.string() + " are not JSON: " + error.what());
    }
}

// By stb, since the benchmark must also run where OpenImageIO is not.
scene::SceneCutOuts::Texture alpha_of(std::span<const unsigned char> bytes) {
    const int size = int(std::min<std::size_t>(bytes.size(), std::numeric_limits<int>::max()));
    int width = 0, height = 0, channels = 0;
    if (stbi_is_16_bit_from_memory(bytes.data(), size) != 0) throw InvalidArgument("16-bit images are not read");
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), &stbi_image_free);
    if (!pixels) throw InvalidArgument(stbi_failure_reason());
    scene::SceneCutOuts::Texture texture{std::uint32_t(width), std::uint32_t(height), {}};
    for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height); ++i)
        texture.alpha.push_back(pixels.get()[4 * i + 3]);
    return texture;
}

scene::Scene loaded_from(const std::filesystem::path& file) {
    scene::LoadOptions options;
    options.decode_alpha = alpha_of;
    return scene::load(file, options);
}

// RECIPE:TRIANGLES, through a file as a user would make it; the file is removed again.
scene::Scene made(const std::string& recipe_name, const std::string& count) {
    std::uint64_t triangles = 0;
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), triangles);
    if (error != std::errc() || end != count.data() + count.size())
        throw InvalidArgument("a made scene is RECIPE:TRIANGLES, not \"" + recipe_name + ":" + count + "\"");
    for (const make_scenes::Recipe& recipe : make_scenes::recipes()) {
        if (recipe.name != recipe_name) continue;
        if (triangles < recipe.fewest_triangles || triangles > recipe.max_triangles)
            throw InvalidArgument(fmt::format("{} takes {} to {} triangles, not {}", recipe_name,
                                              recipe.fewest_triangles, recipe.max_triangles, count));
        make_scenes::Scene scene = recipe.make({triangles, 1});
        scene.name = recipe.name;
        const auto file =
            std::filesystem::temp_directory_path() / fmt::format("gnomon_bench_{}.glb", std::random_device{}());
        make_scenes::write_glb(scene, file);
        struct Remover {
            const std::filesystem::path& file;
            ~Remover() {
                std::error_code ignored;
                std::filesystem::remove(file, ignored);
            }
        } remover{file};
        return loaded_from(file);
    }
    throw InvalidArgument("make_scenes has no recipe \"" + recipe_name + "\"; make_scenes --list shows their names");
}

}  // namespace

SceneShelf::SceneShelf(const std::filesystem::path& views_file, std::filesystem::path folder)
    : folder_(std::move(folder)) {
    const std::string found = views_file.empty() ? in_folder("views.json") : views_file.string();
    if (!found.empty()) views_ = read_json(found);
}

std::string SceneShelf::in_folder(const std::string& file) const {
    if (folder_.empty() || !std::filesystem::exists(folder_ / file)) return {};
    return (folder_ / file).string();
}

const NamedScene& SceneShelf::get(const std::string& name) {
    if (asked_ == name) return loaded_;
    loaded_ = {};
    asked_.clear();
    const std::size_t colon = name.find(':');
    if (name == "sundial")
        loaded_ = {name, scene::sundial(), {}};
    else if (colon != std::string::npos)
        loaded_ = {name.substr(0, colon) + "_" + name.substr(colon + 1),
                   made(name.substr(0, colon), name.substr(colon + 1)),
                   {}};
    else
        loaded_ = {std::filesystem::path(name).stem().string(), loaded_from(name), {}};
    loaded_.cases = cases_of(loaded_);
    asked_ = name;
    return loaded_;
}

std::vector<Case> SceneShelf::cases_of(const NamedScene& loaded) const {
    std::vector<Case> cases;
    // NAME_textured shows what NAME shows.
    const std::string viewed = loaded.name.substr(0, loaded.name.find("_textured"));
    if (views_.contains(viewed)) {
        const Json& of_scene = views_[viewed];
        for (const Json& view : of_scene["views"])
            for (const Json& light : of_scene["lights"])
                cases.push_back({view["name"], light["name"],
                                 Camera::look_at(float3_of(view["eye"]), float3_of(view["target"]),
                                                 float3_of(view["up"]), view["fov_y"]),
                                 Light::directional(float3_of(light["direction"]))});
        return cases;
    }
    for (const auto& camera : loaded.scene.cameras)
        for (const auto& light : loaded.scene.lights)
            cases.push_back({camera.name, light.name, camera.camera, light.light});
    if (cases.empty())
        cases.push_back({"framing", "default", scene::framing_camera(loaded.scene), scene::default_light()});
    return cases;
}

}  // namespace gnomon::bench
