// SPDX-License-Identifier: MIT
// Small cases to be run under oclgrind, which executes every load and store of the kernels in an interpreter and
// reports accesses out of bounds and data races (tests/CMakeLists.txt registers it so). Each case also compares every
// point with the oracle: oclgrind is a device like any other, and must give the same bits. Plain program, no
// GoogleTest: one process, so that kernels are compiled once. Exit status 0: all cases passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gnomon.hpp>
#include "query/inputs.hpp"
#include "support/cut_out_scenes.hpp"
#include "support/light_scene.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;

bool all_right = true;

void require(bool is_right, const std::string& what) {
    if (is_right) return;
    std::printf("WRONG: %s\n", what.c_str());
    all_right = false;
}

std::size_t differences(const std::vector<float>& got, const std::vector<float>& wanted) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) wrong += got[i] != wanted[i];
    return wrong;
}

/// `is_watched`: also with the diagnostic "decided".
void trace(const gnomon::Device& device, const LightScene& scene, const Settings& settings, bool is_watched = false,
           bool keeps_clusters = false) {
    auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    if (keeps_clusters) triangles.keep_clusters(device);
    const gnomon::Points points = upload_points(device, scene);
    const gnomon::Visibility visibility(device, points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    for (const auto& [name, value] : settings) technique->set(name, value);
    const gnomon::Light light{scene.light};
    const gnomon::Statistics statistics =
        technique->run(triangles, points, light, visibility, {.facing = facing_of(scene.eye)});
    const std::vector<float> got = visibility.read(), truth = truth_of(scene);
    const std::size_t wrong = differences(got, truth);
    const auto dark = static_cast<std::size_t>(std::ranges::count(truth, 0.0f));
    require(wrong == 0, scene.name + ": " + std::to_string(wrong) + " points");
    require(dark > 0 && dark < got.size(), scene.name + ": both answers must occur");
    if (is_watched)
        require(technique->diagnose("decided", triangles, points, light, facing_of(scene.eye)).size() == 4 * got.size(),
                scene.name + ": what decided each point");
    std::printf("%s: %zu points, %zu in shadow, %llu by the map, %llu uncertain pairs\n", scene.name.c_str(),
                got.size(), dark, static_cast<unsigned long long>(statistics.count("points_decided_by_map")),
                static_cast<unsigned long long>(statistics.count("uncertain_pairs")));
}

/// The view once more, with the prepared light.
void prepare(const gnomon::Device& device, const gnomon::Triangles& triangles, const Floats& scene,
             const gnomon::View& view, const Light& light) {
    const gnomon::Visibility visibility(device, view.points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("map-size", "32");
    technique->prepare(triangles, gnomon::Light{light});
    const gnomon::PointsOnHost host = view.points.read(device);
    const std::vector<float> truth =
        truth_of({"", scene, host.position, light, host.receiver, view.points.camera()->camera.eye});
    gnomon::Points unlifted = view.points;
    unlifted.set_camera(view.points.camera()->camera, view.width, view.height);
    for (const gnomon::Points& points : {view.points, unlifted}) {
        const gnomon::Statistics statistics = technique->run(triangles, points, gnomon::Light{light}, visibility);
        const std::size_t wrong = differences(visibility.read(), truth);
        require(wrong == 0, "prepared light: " + std::to_string(wrong) + " pixels");
        require(statistics.count("prepared") == 1, "the prepared light must be used");
    }
}

/// Four samples per pixel, lifted once more as lift() does with a caller's own points.
void sample(const gnomon::Device& device, const gnomon::Triangles& triangles, const Floats& scene,
            const gnomon::View& view, const Light& light) {
    const std::size_t pixels = view.points.count();
    const gnomon::Visibility mean(device, pixels);
    std::vector<int> lit(pixels, 0);
    const auto judge = [&](const gnomon::Points& points) {
        const gnomon::PointsOnHost host = points.read(device);
        const gnomon::Float3 eye = points.camera()->camera.eye;
        const auto shadowed = reference::shadowed(scene, host.position, host.receiver, light, eye);
        for (std::size_t i = 0; i < shadowed.size(); ++i) lit[i % pixels] += shadowed[i] == 0;
        require(gnomon::lift(device, triangles, points, eye).count() == points.count(), "lifted points");
    };
    gnomon::run_samples(*gnomon::make_technique("frustum-traced", device), triangles, view, gnomon::Light{light}, 4,
                        mean, judge);
    const std::vector<float> got = mean.read();
    std::size_t wrong = 0, partly = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        wrong += 4 * got[i] != static_cast<float>(lit[i]);
        partly += lit[i] != 0 && lit[i] != 4;
    }
    require(wrong == 0, "samples: " + std::to_string(wrong) + " pixels");
    require(partly > 0, "samples: pixels that are partly lit must occur");
}

void look(const gnomon::Device& device, const Floats& scene, std::uint32_t size) {
    auto triangles = gnomon::Triangles::upload(device, scene);
    triangles.keep_clusters(device);
    const auto camera = gnomon::Camera::look_at({4, 5, 6}, {1, 1, 1}, {0, 1, 0}, 40);
    const gnomon::View view = gnomon::look(device, triangles, camera, size, size);
    const gnomon::Visibility visibility(device, view.points.count());
    const Light light = along(-0.3f, -1, 0.2f);
    gnomon::make_technique("frustum-traced", device)->run(triangles, view.points, gnomon::Light{light}, visibility);
    gnomon::ViewOnHost host = view.read(device, triangles);
    const std::vector<float> got = visibility.read();
    const auto shadowed = reference::shadowed(scene, host.position, host.receiver, light, camera.eye);
    std::size_t seen = 0, wrong = 0, dark = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        if (host.receiver[i] == gnomon::no_receiver) continue;
        ++seen;
        dark += shadowed[i];
        wrong += got[i] != (shadowed[i] ? 0.0f : 1.0f);
    }
    require(wrong == 0, "camera view: " + std::to_string(wrong) + " pixels");
    require(seen > 0 && seen < got.size() && dark > 0 && dark < seen, "camera view: sky, light and shadow must occur");
    const gnomon::Materials white{std::vector<std::uint32_t>(triangles.count(), 0), {{1, 1, 1}}};
    require(gnomon::shade(device, triangles, view, visibility, white, gnomon::Light{light}).size() == 4 * got.size(),
            "picture");
    sample(device, triangles, scene, view, light);
    prepare(device, triangles, scene, view, light);
    prepare(device, triangles, scene, view, at(1.5f, 6, 1.5f));
    std::printf("camera view: %zu pixels, %zu seen, %zu in shadow\n", got.size(), seen, dark);
}

/// A rival: its small maps may make it wrong up to a bound.
struct Approximation {
    std::string technique;
    Settings settings;
    Light light;
    double max_error;             ///< mean over the pixels that show a triangle
    bool is_lower_bound = false;  ///< never wrongly dark
};

void approximate(const gnomon::Device& device, const Floats& scene, const Approximation& a) {
    const auto triangles = gnomon::Triangles::upload(device, scene);
    const auto camera = gnomon::Camera::look_at({4, 5, 6}, {1, 1, 1}, {0, 1, 0}, 40);
    const gnomon::View view = gnomon::look(device, triangles, camera, 12, 12);
    const gnomon::Visibility visibility(device, view.points.count());
    const auto technique = gnomon::make_technique(a.technique, device);
    for (const auto& [name, value] : a.settings) technique->set(name, value);
    technique->run(triangles, view.points, gnomon::Light{a.light}, visibility);
    const gnomon::PointsOnHost host = view.points.read(device);
    const std::vector<float> got = visibility.read();
    const auto shadowed = reference::shadowed(scene, host.position, host.receiver, a.light, camera.eye);
    double error = 0;
    std::size_t seen = 0, dark = 0, wrongly_dark = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        if (host.receiver[i] == gnomon::no_receiver) continue;
        ++seen;
        dark += shadowed[i];
        wrongly_dark += !shadowed[i] && got[i] < 1;
        error += std::fabs(got[i] - (shadowed[i] ? 0 : 1));
    }
    error /= double(seen);
    const std::string name = a.technique + " " + text_of(a.settings);
    std::printf("%s: %zu pixels, %zu in shadow, mean error %.3f\n", name.c_str(), seen, dark, error);
    require(error <= a.max_error, name + ": too far from the truth");
    require(dark > seen / 8 && dark < seen * 7 / 8, name + ": light and shadow must occur");
    require(!a.is_lower_bound || wrongly_dark == 0, name + ": wrongly dark");
}

std::vector<float> truth_of(const Floats& scene, const reference::Masks& masks, const gnomon::PointsOnHost& points,
                            const Light& light, const std::optional<Float3>& eye) {
    std::vector<float> truth;
    for (const auto in_shadow :
         reference::shadowed(scene, points.position, points.receiver, light, eye, nullptr, &masks))
        truth.push_back(in_shadow ? 0.0f : 1.0f);
    return truth;
}

/// Triangles cut out by textures of all kinds, through the paths that read them: a camera's view, its shadows, prepared
/// too, many lights, samples, and maps that test alpha. `is_second`: with alphas of corners, and clusters.
void cut_out(const gnomon::Device& device, bool has_double, bool is_second) {
    const Floats scene = soup(30, 1.5f, 4);
    const CutOutData data(mixed_masks(scene.size() / 9, 6, is_second));
    auto triangles = gnomon::Triangles::upload(device, scene, data.cut_outs());
    require(triangles.cut_out_counts().masked > 5, "cut-outs: masked triangles must occur");
    if (is_second) triangles.keep_clusters(device);
    const auto camera = gnomon::Camera::look_at({0.5f, 1, 3}, {0, 0, 0}, {0, 1, 0}, 50);
    const gnomon::View view = gnomon::look(device, triangles, camera, 10, 10);
    const gnomon::Visibility visibility(device, view.points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("map-size", "32");
    for (const Light& light : {along(-0.3f, -1, 0.2f), at(0.5f, 2, 0.5f)}) {
        const gnomon::Light as_given{light};
        const auto truth = truth_of(scene, data.masks(), view.points.read(device), light, camera.eye);
        for (const bool is_prepared : {false, true}) {
            if (is_prepared) technique->prepare(triangles, as_given);
            technique->run(triangles, view.points, as_given, visibility);
            const std::size_t wrong = differences(visibility.read(), truth);
            require(wrong == 0, "cut-outs: " + std::to_string(wrong) + " pixels");
        }
        technique->set("many-lights", light[3] != 0 ? "one-by-one" : is_second && has_double ? "rays" : "beams");
        const auto bits = gnomon::run_light_table_to_host(*technique, triangles, view.points,
                                                          gnomon::Lights({as_given, as_given}), {.bits = true})
                              .bits;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) wrong += bits[i] != (truth[i] == 1 ? 3u : 0u);
        require(wrong == 0, "cut-outs, many lights: " + std::to_string(wrong) + " pixels");
        std::printf("cut-outs: %zu points, %td lit\n", truth.size(), std::ranges::count(truth, 1.0f));
        if (is_second) continue;
        gnomon::run_samples(*technique, triangles, view, as_given, 4, visibility);
        if (!has_double) continue;  // maps use none
        for (const auto& [name, size] : {std::pair("sub-pixel", "map-size"), std::pair("shadow-map", "size")}) {
            const auto map = gnomon::make_technique(name, device);
            map->set(size, "32");
            map->run(triangles, view.points, as_given, visibility);
        }
    }
}

/// Suns over a terrain with steps, by its horizons, with holes at its border, or by sweeps.
void meet_terrain(const gnomon::Device& device, const std::string& way) {
    Terrain terrain = lattice_terrain(3);
    terrain.columns = 12, terrain.rows = 9;
    const Floats raster = terrain.triangles(), scene = way == "sweeps" ? raster : without_triangle(raster, 25);
    const auto triangles = gnomon::Triangles::upload(device, scene);
    Floats positions;
    for (std::size_t i = 0; i < 60; ++i) add(positions, vertex(scene, 10 * i));
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < 40; ++i)
        lights.push_back(gnomon::Light::directional({1, -float(i % 20) / 8 - 0.1f, i < 20 ? 0.0f : 0.75f}));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("many-lights", way);
    const auto answers = gnomon::run_light_table_to_host(
        *technique, triangles, gnomon::Points::upload(device, positions), gnomon::Lights(lights), {.counts = true});
    std::vector<std::uint32_t> counts(positions.size() / 3);
    for (const gnomon::Light& light : lights) {
        const auto shadowed = reference::shadowed(scene, positions, {}, light.xyzw);
        for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += !shadowed[i];
    }
    require(answers.counts == counts, way + ": counts of lit lights");
    std::printf("%s: %zu points, %zu lights\n", way.c_str(), counts.size(), lights.size());
}

/// Suns over an implicit raster with a hole, by beams or by sweeps; every other vertex has a receiver and faces by it.
void meet_implicit_raster(const gnomon::Device& device, const std::string& way) {
    Floats x, y, heights, positions;
    for (int i = 0; i < 11; ++i) x.push_back(float(i)), y.push_back(float(-i) * 1.5f);
    for (std::size_t i = 0; i < x.size() * y.size(); ++i) heights.push_back(float(i * 7 % 11) / 4);
    heights[40] = std::numeric_limits<float>::quiet_NaN();
    const auto triangles = gnomon::Triangles::raster(device, {x, y, heights});
    Floats scene(9 * triangles.count());
    gnomon::session_of(device).read(triangles.buffer(), scene.data(), scene.size() * sizeof(float));
    std::vector<std::uint32_t> receivers;
    for (std::uint32_t t = 0; t < triangles.count(); t += 6) {
        if (t / 2 == 40 || t / 2 == 39 || t / 2 == 29 || t / 2 == 30) continue;  // around the hole
        add(positions, vertex(scene, 3 * t));
        receivers.push_back(t % 12 == 0 ? t : gnomon::no_receiver);
    }
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < 20; ++i)
        lights.push_back(gnomon::Light::directional({1, i < 10 ? 0.0f : 0.75f, -float(i % 10) / 8 - 0.1f}));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("many-lights", way);
    const Float3 eye{3, -4, 90};
    const auto answers =
        gnomon::run_light_table_to_host(*technique, triangles, gnomon::Points::upload(device, positions, receivers),
                                        gnomon::Lights(lights), {.counts = true}, {.facing = gnomon::Facing::eye(eye)});
    std::vector<std::uint32_t> counts(receivers.size());
    for (const gnomon::Light& light : lights) {
        const auto shadowed = reference::shadowed(scene, positions, receivers, light.xyzw, eye);
        for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += !shadowed[i];
    }
    require(answers.counts == counts, "implicit raster, " + way + ": counts of lit lights");
    std::printf("implicit raster, %s: %zu points, %zu lights\n", way.c_str(), counts.size(), lights.size());
}

}  // namespace

int main(int count, char** arguments) try {
    gnomon::add_rivals();
    const std::string cases = count > 1 ? arguments[1] : "";
    if (cases.starts_with("cut-outs")) {  // programs of their own
        const bool has_double = cases != "cut-outs-without-double";
        const gnomon::Device device({}, {.hide_fp64 = !has_double});
        for (const bool is_second : {false, true})
            if (cases != (is_second ? "cut-outs-of-textures" : "cut-outs-with-alphas"))
                cut_out(device, has_double, is_second);
        return all_right ? 0 : 1;
    }
    if (cases == "horizons") {
        for (const char* way : {"horizons", "sweeps"}) meet_terrain(gnomon::Device(), way);
        for (const char* way : {"beams", "sweeps"}) meet_implicit_raster(gnomon::Device(), way);
        return all_right ? 0 : 1;
    }
    const Floats blocks = lattice_blocks(2, 3, 1);
    Floats points = lattice_points(200, 3, 2), places = random_points(200, -1, 1, 3);
    std::vector<std::uint32_t> receivers;
    for (std::uint32_t i = 0; i < 200; ++i) receivers.push_back(i % 24);
    for (const std::uint32_t work_group_size : {0u, 7u}) {
        gnomon::DeviceOptions options;
        options.work_group_size = work_group_size;
        const gnomon::Device device({}, options);
        std::printf("%s, work-groups of %u\n", device.description().name.c_str(), work_group_size);
        const Settings small = {{"conservative-map", "on"}, {"map-size", "32"}, {"first-capacity", "5"}};
        trace(device, {"lattice, directional, ties", blocks, points, along(1, 1, 1), receivers}, small,
              work_group_size == 0);
        const LightScene over{"soup, with map and eye", soup(20, 1.2f, 4), places, along(0.1f, -1, 0.2f), {},
                              Float3{0, 5, 0}};
        trace(device, over, small, false, true);
        if (work_group_size != 0) continue;
        trace(device, {"lattice, positional", blocks, points, at(1.5f, 6, 1.5f)}, small);
        trace(device, {"soup, no map", soup(20, 1.2f, 4), places, along(0.1f, -1, 0.2f)},
              {{"conservative-map", "off"}});
        look(device, blocks, 24);
        const Light sun = along(-0.3f, -1, 0.2f), point_light = at(1.5f, 6, 1.5f);
        Floats on_floor = blocks;
        add(on_floor, {-9, -0.5f, -9}, {-9, -0.5f, 27}, {27, -0.5f, -9});
        for (const Approximation& a : std::vector<Approximation>{
                 {"izb", {{"map-size", "64"}}, sun, 0},
                 {"conservative-map", {{"map-size", "64"}}, sun, 0.1, true},
                 {"shadow-map", {{"size", "32"}, {"bias", "dual"}, {"lookup", "pcf"}}, point_light, 0.1},
                 {"shadow-map",
                  {{"size", "32"},
                   {"store", "moments"},
                   {"bits", "64"},
                   {"prefilter", "mip"},
                   {"projection", "lispsm"},
                   {"cascades", "2"},
                   {"share-texels", "on"}},
                  sun,
                  0.15},
                 {"shadow-map",
                  {{"size", "32"}, {"store", "variance"}, {"prefilter", "summed-area"}, {"storage", "atlas"}},
                  sun,
                  0.15},
                 {"virtual-shadow-map", {{"size", "256"}}, sun, 0.02}})
            approximate(device, on_floor, a);
    }
    return all_right ? 0 : 1;
} catch (const gnomon::Error& error) {
    std::printf("%s\n", error.what());
    return 1;
}
