// SPDX-License-Identifier: MIT
#include "experiments.hpp"

#include <fmt/core.h>
#include <algorithm>

namespace gnomon::bench {

namespace {

constexpr Size quarter_hd{480, 270}, hd{960, 540}, full_hd{1920, 1080}, uhd{3840, 2160}, uhd_8k{7680, 4320};
constexpr const char *technique = "frustum-traced", *papers_technique = "izb";

std::uint64_t pixels(Size size) { return std::uint64_t(size.width) * size.height; }

// Those that the machine takes; if it takes none of them, the largest smaller one that it does.
std::vector<Size> within(const Limits& limits, std::vector<Size> sizes) {
    const auto is_too_large = [&](Size size) { return pixels(size) > limits.largest_points; };
    std::erase_if(sizes, is_too_large);
    if (!sizes.empty()) return sizes;
    sizes = {full_hd, {1280, 720}, hd, {640, 360}, {320, 180}};
    std::erase_if(sizes, is_too_large);
    if (sizes.size() > 1) sizes.resize(1);
    return sizes;
}

Limits of_sweeps(Limits limits) {
    limits.largest_triangles = std::min(limits.largest_triangles, limits.swept_triangles);
    limits.largest_points = std::min(limits.largest_points, limits.swept_points);
    return limits;
}

std::string made(const char* recipe, std::uint64_t triangles, const Limits& limits) {
    return fmt::format("{}:{}", recipe, std::min(triangles, limits.largest_triangles));
}

// Scenes with views: the two of the folder if they are there, else a made one in their place.
struct SceneView {
    std::string scene, only;
};
std::vector<SceneView> usual_views(const SceneShelf& shelf, const Limits& limits) {
    const std::string sponza = shelf.in_folder("sponza.glb"), empire = shelf.in_folder("lost_empire.glb");
    if (sponza.empty() || empire.empty()) return {{made("colonnade", 300'000, limits), "v1.sun"}};
    if (!limits.all_views) return {{sponza, "atrium_floor.noon_slant"}};
    return {{sponza, "atrium_floor.noon_slant"}, {sponza, "balcony_down.along_atrium"}, {empire, "hillside.grazing"}};
}
std::vector<SceneView> large_views(const Limits& limits) {
    const std::string city = made("city", 6'500'000, limits), foliage = made("foliage", 5'300'000, limits),
                      pipes = made("pipes", 12'800'000, limits);
    return {{city, "v1.sun"}, {foliage, "v1.sun"}, {pipes, "v1.sun"}};
}
// The same scenes from afar and from within.
std::vector<SceneView> both_large_views(const Limits& limits) {
    std::vector<SceneView> views;
    for (const SceneView& view : large_views(limits))
        for (const char* only : {"v0.sun", "v1.sun"}) views.push_back({view.scene, only});
    return views;
}

Block block_of(const char* experiment, const SceneView& view, std::vector<Size> sizes,
               std::vector<Configuration> configurations) {
    Block block;
    block.experiment = experiment;
    block.scene = view.scene;
    block.only = view.only;
    block.sizes = std::move(sizes);
    block.configurations = std::move(configurations);
    return block;
}

// ---- Run time against error -----------------------------------------------------------------------------------------

std::vector<Block> errors(const SceneShelf& shelf, const Limits& all_limits) {
    const Limits limits = of_sweeps(all_limits);
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits)) {
        // The settings are swept on the first view; the others show every technique as it comes.
        Block block = block_of("errors", view, within(limits, {full_hd}),
                               blocks.empty() ? swept_configurations(limits.swept_map) : default_configurations());
        block.errors = block.pictures = block.peers = true;
        block.oracle_points = limits.all_views ? 200'000 : 20'000;
        blocks.push_back(std::move(block));
    }
    return blocks;
}

std::vector<Block> techniques_and_settings(const SceneShelf& shelf, const Limits& all_limits) {
    const Limits limits = of_sweeps(all_limits);
    const std::vector<Size> sizes = within(limits, {full_hd});
    std::vector<Block> blocks;
    const auto add = [&](const SceneView& view, const std::optional<OtherLight>& light = std::nullopt) {
        Block block = block_of("techniques", view, sizes,
                               limits.all_views ? swept_configurations(limits.swept_map) : default_configurations());
        for (Configuration& configuration : block.configurations)
            put_on_equal_terms(configuration, std::min(2048u, limits.swept_map),
                               light && !light->light.is_directional());
        block.light = light;
        block.errors = true;
        blocks.push_back(std::move(block));
    };
    // Of the small report, Sponza is in `errors` already, and two more scenes are enough.
    if (const std::string sponza = shelf.in_folder("sponza.glb"); !sponza.empty() && limits.all_views) {
        add({sponza, "atrium_floor.noon_slant"});
        add({sponza, "atrium_floor.position"}, OtherLight{"position", Light::point({-100, 700, -30})});
    }
    add({made("city", 1'000'000, limits), "v1.sun"});
    add({made("colonnade", 300'000, limits), "v1.sun"});
    if (limits.all_views) add({made("foliage", 1'000'000, limits), "v1.sun"});  // the slowest on a CPU: last
    return blocks;
}

std::vector<Block> bias(const SceneShelf& shelf, const Limits& all_limits) {
    const Limits limits = of_sweeps(all_limits);
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits)) {
        blocks.push_back(block_of("bias", view, within(limits, {full_hd}), bias_configurations()));
        blocks.back().errors = true;
    }
    return blocks;
}

// ---- The same mask by other means -----------------------------------------------------------------------------------

// What the documents time: cascades in an array or in an atlas, and volumes with or without the sides that neighbours
// share.
std::vector<Block> alternatives(const SceneShelf& shelf, const Limits& all_limits) {
    const Limits limits = of_sweeps(all_limits);
    std::vector<Configuration> configurations;
    const auto add = [&](const char* name, const char* key, const char* first, const char* second) {
        for (const char* value : {first, second}) configurations.push_back({name, {{key, value}}});
    };
    for (const char* cascades : {"pssm", "sdsm"}) add(cascades, "storage", "array", "atlas");
    add("shadow-volumes", "cancel", "off", "on");
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits)) {
        blocks.push_back(block_of("alternatives", view, within(limits, {hd}), configurations));
        blocks.back().errors = blocks.back().take_turns = true;
    }
    return blocks;
}

// ---- Stages and rivals ----------------------------------------------------------------------------------------------

std::vector<Block> rivals(const SceneShelf& shelf, const Limits& limits) {
    std::vector<SceneView> views = usual_views(shelf, limits);
    if (!shelf.in_folder("sponza.glb").empty() && limits.all_views)
        views.push_back({made("colonnade", 300'000, limits), "v1.sun"});
    std::ranges::copy(large_views(limits), std::back_inserter(views));
    std::vector<Block> blocks;
    for (const SceneView& view : views) {
        std::vector<Configuration> modes(3, truth_configuration());
        modes[1].mode = "moving";
        modes[2].mode = "static";
        blocks.push_back(block_of("rivals", view, within(limits, {full_hd, uhd}), std::move(modes)));
        Block& block = blocks.back();
        block.stages = block.errors = block.peers = block.take_turns = block.frames = true;
    }
    return blocks;
}

// ---- Growth ---------------------------------------------------------------------------------------------------------

std::vector<Block> growth_in_triangles(const SceneShelf&, const Limits& limits) {
    std::vector<Block> blocks;
    for (const char* recipe : {"city", "foliage", "pipes"})
        for (std::uint64_t count = 100'000; count <= std::min<std::uint64_t>(limits.largest_triangles, 20'000'000);
             count = count < 10'000'000 ? 2 * count : count + 7'200'000)  // to 12.8 and 20 million
            blocks.push_back(block_of("growth_in_triangles", {made(recipe, count, limits), "v0.sun"},
                                      within(limits, {full_hd}), {truth_configuration()}));
    return blocks;
}

std::vector<Block> growth_in_points(const SceneShelf& shelf, const Limits& limits) {
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits))
        blocks.push_back(block_of("growth_in_points", view,
                                  within(limits, {quarter_hd, hd, {1280, 720}, full_hd, uhd, uhd_8k}),
                                  {truth_configuration()}));
    return blocks;
}

// ---- Memory ---------------------------------------------------------------------------------------------------------

std::vector<Block> memory(const SceneShelf& shelf, const Limits& limits) {
    std::vector<SceneView> views = usual_views(shelf, limits);
    std::ranges::copy(large_views(limits), std::back_inserter(views));
    std::vector<Block> blocks;
    for (const SceneView& view : views)
        blocks.push_back(block_of("memory", view, within(limits, {uhd}), {truth_configuration()}));
    return blocks;
}

// ---- What a scene doesn't need --------------------------------------------------------------------------------------

// Each view with all its work, then the same scene where there is nothing to do: the camera sees sky alone, or the sun
// shines from below, on no side of what is seen.
std::vector<Block> skips(const SceneShelf& shelf, const Limits& limits) {
    const std::string city = made("city", 6'500'000, limits);
    const std::vector<Size> sizes = within(limits, {full_hd});
    const SceneView usual = usual_views(shelf, limits).front();
    std::vector<Block> blocks;
    const auto add = [&](const SceneView& view) -> Block& {
        Configuration moving = truth_configuration();
        moving.mode = "moving";
        blocks.push_back(block_of("skips", view, sizes, {truth_configuration(), moving}));
        blocks.back().take_turns = true;
        return blocks.back();
    };
    const std::string light = usual.only.substr(usual.only.find('.') + 1);
    const auto add_sky = [&](const std::string& scene, const std::string& of_light) {
        add({scene, "sky." + of_light}).view = {"sky", Camera::look_at({0, 1e6f, 0}, {0, 2e6f, 0}, {0, 0, 1}, 60)};
    };
    add(usual);
    add_sky(usual.scene, light);
    if (const std::string empire = shelf.in_folder("lost_empire.glb"); !empire.empty() && limits.all_views)
        add({empire, "hillside.grazing"});
    add({city, "v0.sun"});
    add({city, "v0.from_below"}).light = {"from_below", Light::directional({0, 1, 0})};
    add_sky(city, "sun");
    add({city, "v1.sun"});
    if (limits.all_views)
        for (const SceneView& view : both_large_views(limits))
            if (view.scene != city) add(view);
    return blocks;
}

// ---- The paper ------------------------------------------------------------------------------------------------------

// The paper's grid: 1024² for 1920x1080, 2048² for 3840x2160.
Settings papers_grid(Size size) { return {{"map-size", size.width > 1920 ? "2048" : "1024"}}; }

std::vector<SceneView> papers_views(const SceneShelf& shelf, const Limits& limits) {
    std::vector<SceneView> views;
    if (const std::string sponza = shelf.in_folder("sponza.glb"); !sponza.empty())
        views = {{sponza, "atrium_floor.noon_slant"}, {sponza, "balcony_down.along_atrium"}};
    for (const char* view : {"v0.sun", "v1.sun"}) views.push_back({made("foliage", 5'300'000, limits), view});
    for (const char* view : {"v0.sun", "v1.sun"}) views.push_back({made("pipes", 12'800'000, limits), view});
    return views;
}

std::vector<Block> table1(const SceneShelf& shelf, const Limits& limits) {
    std::vector<Block> blocks;
    for (const SceneView& view : papers_views(shelf, limits)) {
        Block papers = block_of(
            "table1", view, within(limits, {full_hd, uhd}),
            {{papers_technique, {{"conservative-map", "off"}}}, {papers_technique, {{"conservative-map", "on"}}}});
        papers.more_settings = papers_grid;
        papers.take_turns = papers.stages = true;
        blocks.push_back(papers);
        Block ours = block_of("table1", view, within(limits, {full_hd, uhd}), {{technique, {}}});
        ours.stages = true;
        blocks.push_back(ours);
    }
    return blocks;
}

std::vector<Block> table2(const SceneShelf& shelf, const Limits& limits) {
    std::vector<Block> blocks;
    for (const SceneView& view : papers_views(shelf, limits)) {
        Block block = block_of("table2", view, within(limits, {uhd}),
                               {{technique, {{"conservative-map", "on"}, {"cover-test", "circle"}}},
                                {technique, {{"conservative-map", "on"}, {"cover-test", "tight"}}}});
        block.more_settings = papers_grid;
        block.take_turns = block.stages = true;
        blocks.push_back(std::move(block));
    }
    return blocks;
}

std::vector<Configuration> map_modes() {
    return {{technique, {{"conservative-map", "on"}}},
            {technique, {{"conservative-map", "off"}}},
            {technique, {{"conservative-map", "auto"}}}};
}

// Rungholt's two views, in our city: from the street the light's frustum is small, from above it is wide and triangles
// are smaller than texels.
std::vector<Block> figure5(const SceneShelf&, const Limits& limits) {
    std::vector<Block> blocks;
    for (const char* view : {"v1.sun", "v0.sun"}) {
        blocks.push_back(
            block_of("figure5", {made("city", 6'700'000, limits), view}, within(limits, {uhd}), map_modes()));
        blocks.back().take_turns = blocks.back().stages = true;
    }
    return blocks;
}

std::vector<Block> automatic_map(const SceneShelf& shelf, const Limits& limits) {
    std::vector<SceneView> views;
    for (const SceneView& view : usual_views(shelf, limits))
        views.push_back({view.scene, view.only.substr(0, view.only.find('.') + 1)});  // in every light
    std::ranges::copy(both_large_views(limits), std::back_inserter(views));
    std::vector<Block> blocks;
    for (const SceneView& view : views) {
        blocks.push_back(block_of("auto", view, within(limits, {full_hd}), map_modes()));
        blocks.back().take_turns = true;
    }
    return blocks;
}

// ---- Clusters -------------------------------------------------------------------------------------------------------

std::vector<Block> clusters(const SceneShelf& shelf, const Limits& limits) {
    std::vector<SceneView> views = usual_views(shelf, limits);
    std::ranges::copy(both_large_views(limits), std::back_inserter(views));
    std::vector<Block> blocks;
    for (const SceneView& view : views) {
        blocks.push_back(block_of("clusters", view, within(limits, {full_hd}),
                                  {{technique, {}, "animated"}, {technique, {}, "moving"}}));
        blocks.back().take_turns = blocks.back().stages = true;
    }
    return blocks;
}

// ---- Samples --------------------------------------------------------------------------------------------------------

std::vector<Block> samples(const SceneShelf& shelf, const Limits& limits) {
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits)) {
        Block block = block_of("samples", view, within(limits, {full_hd}), {});
        for (const std::uint32_t count : {1u, 4u, 32u}) {
            block.configurations.push_back(truth_configuration());
            block.configurations.back().samples = count;
        }
        block.take_turns = block.peers = block.frames = true;
        blocks.push_back(std::move(block));
    }
    return blocks;
}

// ---- Soft shadows ---------------------------------------------------------------------------------------------------

std::vector<Block> soft(const SceneShelf& shelf, const Limits& all_limits) {
    constexpr double sun_angle_degrees = 0.533;
    const Limits limits = of_sweeps(all_limits);
    std::vector<Block> blocks;
    for (const SceneView& view : usual_views(shelf, limits)) {
        blocks.push_back(
            block_of("soft", view, within(limits, {full_hd}), soft_configurations(sun_angle_degrees, 1024)));
        blocks.back().errors = blocks.back().pictures = true;
        blocks.back().sun_angle_degrees = sun_angle_degrees;
    }
    return blocks;
}

// ---- Many lights ----------------------------------------------------------------------------------------------------

// The table of docs/notebook/many_lights.md; small, it is a sign of life.
std::vector<Block> many_lights(const SceneShelf& shelf, const Limits& limits) {
    std::vector<Block> blocks;
    const auto add = [&](const std::string& scene, const char* lights) {
        if (scene.empty()) return;
        blocks.push_back(block_of("many_lights", {scene, ""}, {}, {truth_configuration()}));
        blocks.back().peers = true;
        const std::uint64_t points = limits.all_views ? 1'000'000 : 16'384;
        ManyLights& asked = blocks.back().many_lights.emplace();
        asked.lights = lights;
        asked.points = std::min(points, limits.largest_points);
    };
    const std::string sponza = shelf.in_folder("sponza.glb"), empire = shelf.in_folder("lost_empire.glb"),
                      town = made("town", 60'000, limits), city = made("city", 1'000'000, limits);
    if (!limits.all_views) {
        add(town, "suns:256");
        add(made("terrain", 200'000, limits), "suns:256");
        return blocks;
    }
    for (const std::string& scene : {empire, sponza, town, city, made("city", 6'500'000, limits),
                                     made("foliage", 5'300'000, limits), made("terrain", 8'000'000, limits)})
        add(scene, "suns");
    for (const char* lights : {"suns:256", "sky", "disk:64"})
        for (const std::string& scene : {sponza, empire, city}) add(scene, lights);
    return blocks;
}

}  // namespace

const std::vector<Experiment>& experiments() {
    static const std::vector<Experiment> all{
        {"errors", "Run time against error",
         "One mark for each technique and setting; towards the lower left is better. The line joins the marks that no "
         "other one beats in both. Rays alone, without the build that goes before them, are hollow and stand aside. "
         "The "
         "exact technique is checked against an independent oracle; all others are measured against it.",
         errors},
        {"techniques", "Every technique in four scenes",
         "Run time against error of every technique; at full size with the settings worth comparing, and in Sponza "
         "under a sun and a point light besides the three made scenes. Maps have equal texels: 2048 x 2048, or where a "
         "size is asked for its square, which cascades, sides and a point light's faces share; and they fit the "
         "receivers unless a technique defines its own fit.",
         techniques_and_settings},
        {"alternatives", "The same mask by other means",
         "Cascades in an array of maps or side by side in an atlas, and shadow volumes with or without the sides that "
         "neighbouring triangles share. All take turns.",
         alternatives},
        {"bias", "Bias: acne against peter-panning",
         "The same map of 2048 x 2048 with constant, slope-scaled, adaptive and dual-layer bias of several strengths.",
         bias},
        {"rivals", "Rivals, frame by frame, and stages",
         "gnomon's exact technique: animated rebuilds everything in each run, moving keeps the clusters of the mesh, "
         "static has the light prepared too. Embree, with the same camera, light and number of threads: animated "
         "builds "
         "its tree in each run, static has it. All take turns, frame by frame: camera, shadow, shade. Embree's shadow "
         "rays start at gnomon's points, so its wrong points are its rays' alone.",
         rivals},
        {"growth_in_triangles", "Time against triangles",
         "The same kind of scene made larger and larger, at its own view over the whole, 1920x1080.",
         growth_in_triangles},
        {"growth_in_points", "Time against points", "The same view in more and more pixels.", growth_in_points},
        {"memory", "Memory",
         "What the exact technique allocates on the device beside the caller's triangles, points and visibility, for "
         "one run of one sample with nothing kept.",
         memory},
        {"skips", "What a scene doesn't need",
         "What is left out and why, by the statistics of each run; views of nothing but sky, and a sun from below that "
         "no visible side faces, stand beside the same scene with all its work. Animated and moving take turns.",
         skips},
        {"table1", "The paper's table 1",
         "Frustum tracing without and with the conservative map, at the paper's grid sizes, then gnomon with its "
         "defaults. Foliage stands in for San Miguel and pipes for the Power Plant.",
         table1},
        {"table2", "The paper's table 2",
         "When a texel counts as covered: by the circle around it (Hertel et al. 2009), or by its corners.", table2},
        {"figure5", "The paper's figure 5",
         "A city from the street (v1), where the map pays, and from above (v0), where triangles are smaller than "
         "texels.",
         figure5},
        {"auto", "Is the automatic choice right?",
         "conservative-map auto beside on and off; the three take turns, run by run.", automatic_map},
        {"clusters", "A mesh that does not change",
         "Animated: every triangle is looked at in every run. Moving: clusters of 64 triangles are kept, and what "
         "cannot "
         "matter is dropped before its vertices are read; the light or the camera may move. The two take turns.",
         clusters},
        {"samples", "Several samples per pixel",
         "Every sample is a point with its own exact answer, and a pixel gets their mean. The time of several holds "
         "finding them. Embree traces a camera ray and a shadow ray for each sample of the same pattern. All take "
         "turns.",
         samples},
        {"soft", "Soft shadows: the truth beside PCSS and the filters",
         "The sun as a disk of .533 degrees. The truth is the share of 1,024 lights on it that reach the point, each "
         "decided exactly; pcss has the same disk. In penumbrae, the truth is strictly between 0 and 1.",
         soft},
        {"many_lights", "Many lights",
         "Points of a scene times a table of suns: decisions are the pairs whose light is in front of the point's "
         "face, and every one of them is decided. Trees of the rival and kept clusters are not counted; gnomon's "
         "times contain its own tree and its order of the points. Embree is the best of medium and high quality trees "
         "and three ways to hand over rays. The two take turns.",
         many_lights},
    };
    return all;
}

}  // namespace gnomon::bench
