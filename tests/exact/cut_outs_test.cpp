// SPDX-License-Identifier: MIT
// Cut-outs: every path of the exact technique against the oracle, which decides them in rationals.
#include <gtest/gtest.h>

#include <limits>

#include "reference/view.hpp"
#include "support/cut_out_scenes.hpp"
#include "support/expect_exact.hpp"

namespace {

using namespace support;
using gnomon::Device;
using gnomon::Points;
using gnomon::Triangles;

struct Family {
    const char* name;
    Device device;
};
/// A test opens its devices once, since each device loads its programs anew.
std::vector<Family> open_families() {
    return {{"cpu", Device()},
            {"gpu", Device({}, {.gpu_kernels = true})},
            {"cpu without double", Device({}, {.hide_fp64 = true})},
            {"gpu without double", Device({}, {.hide_fp64 = true, .gpu_kernels = true})}};
}
const std::vector<gnomon::Light> lights = {
    gnomon::Light::directional({0.3f, -1, 0.2f}), gnomon::Light::directional({0, 0, -1}),
    gnomon::Light::point({0.2f, 3, 0.1f}), gnomon::Light::point({0.2f, 0.1f, 0.1f})};

Floats small_scene() {
    Floats all = soup(60, 0.6f, 1);
    append(all, soup(10, 1.8f, 2));  // cover whole texels
    append(all, lattice_blocks(2, 5, 3));
    return all;
}

std::vector<float> truth_of_points(const Floats& triangles, const reference::Masks& masks, const Floats& points,
                                   const std::vector<std::uint32_t>& receivers, const gnomon::Light& light,
                                   const std::optional<Float3>& eye = {}) {
    std::vector<float> visibility;
    for (const std::uint8_t in_shadow :
         reference::shadowed(triangles, points, receivers, light.xyzw, eye, nullptr, &masks))
        visibility.push_back(in_shadow ? 0.0f : 1.0f);
    return visibility;
}

void expect_same(const std::vector<float>& got, const std::vector<float>& wanted, const std::string& what) {
    ASSERT_EQ(got.size(), wanted.size());
    std::size_t wrong = 0, first = 0;
    for (std::size_t i = got.size(); i-- != 0;)
        if (got[i] != wanted[i]) ++wrong, first = i;
    EXPECT_EQ(wrong, 0u) << what << ": first wrong is " << first << ", " << got[first] << " instead of "
                         << wanted[first];
}

std::vector<float> run(const Device& device, const Triangles& triangles, const Points& points,
                       const gnomon::Light& light, const Settings& settings = {}, bool prepares = false,
                       const char* technique_name = "frustum-traced") {
    const auto technique = technique_with(device, settings, technique_name);
    technique->set("map-size", "128");  // clearing larger maps would take most of the time
    if (prepares) technique->prepare(triangles, light);
    return answer(device, *technique, triangles, points, light).visibility;
}

TEST(CutOuts, EqualsReference) {
    const Floats scene = small_scene();
    const std::vector<Family> families = open_families();
    for (const bool has_alphas : {false, true}) {
        const CutOutData data(mixed_masks(scene.size() / 9, 5, has_alphas));
        Floats points = random_points(700, -1.2f, 1.2f, 4);
        append(points, lattice_points(300, 5, 6));
        for (const gnomon::Light& light : lights) {
            const auto wanted = truth_of_points(scene, data.masks(), points, {}, light);
            std::size_t dark = 0, differs = 0;
            const auto opaque = reference::shadowed(scene, points, {}, light.xyzw);
            for (std::size_t i = 0; i < wanted.size(); ++i)
                dark += wanted[i] == 0, differs += opaque[i] != (wanted[i] == 0);
            EXPECT_GT(dark, 50u);
            EXPECT_GT(differs, 20u);
            for (const Family& family : families) {
                const Device& device = family.device;
                const Triangles triangles = Triangles::upload(device, scene, data.cut_outs());
                Triangles clustered = triangles;
                clustered.keep_clusters(device);
                const Points given = Points::upload(device, points);
                const std::string what =
                    family.name + std::string(has_alphas ? " with alphas " : " ") + std::to_string(light.xyzw[1]);
                for (const char* map : {"on", "off"}) {
                    const Settings settings{{"conservative-map", map}};
                    expect_same(run(device, triangles, given, light, settings), wanted, what + " animated " + map);
                    expect_same(run(device, clustered, given, light, settings), wanted, what + " clusters " + map);
                    expect_same(run(device, triangles, given, light, settings, true), wanted,
                                what + " prepared " + map);
                }
                expect_same(run(device, triangles, given, light, {{"first-capacity", "1"}}), wanted,
                            what + " overflow");
                expect_same(run(device, triangles, given, light, {}, false, "izb"), wanted, what + " izb");
            }
        }
    }
}

// Controls: an all-clear texture is as if the triangles were absent, an all-opaque one as if they had no texture.
TEST(CutOuts, AllClearAndAllOpaqueAreAsAbsentAndPlain) {
    const Floats scene = small_scene(), points = random_points(2000, -1.2f, 1.2f, 4);
    const std::size_t count = scene.size() / 9;
    Floats absent = scene;
    reference::Masks masks;
    masks.textures = {made_texture(8, 8, [](auto, auto) { return 100; })};
    masks.materials = {{.texture = 0, .cutoff = 0.5f}, {.texture = 0, .cutoff = 0.1f}};
    for (std::size_t i = 0; i < count; ++i) {
        masks.material.push_back(i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : reference::NO_MATERIAL);
        for (int k = 0; k < 6; ++k) masks.coordinates.push_back(0.37f * float(k));
        if (i % 3 == 0) std::fill_n(absent.begin() + std::ptrdiff_t(9 * i), 9, std::numeric_limits<float>::quiet_NaN());
    }
    const CutOutData data(masks);
    const auto camera = gnomon::Camera::look_at({0.3f, 1.4f, 3.0f}, {0, 0, 0}, {0, 1, 0}, 45);
    const auto answers = [&](const Device& device, const Triangles& of) {
        std::vector<std::vector<float>> all;
        for (const gnomon::Light& light : lights) all.push_back(run(device, of, Points::upload(device, points), light));
        return std::pair(all, gnomon::look(device, of, camera, 96, 64).read(device, of).receiver);
    };
    const std::vector<Family> families = open_families();
    const auto plain = answers(families[0].device, Triangles::upload(families[0].device, absent));
    for (const auto& [name, device] : families) {
        const Triangles given = Triangles::upload(device, scene, data.cut_outs());
        EXPECT_EQ(given.cut_out_counts().clear, (count + 2) / 3);
        EXPECT_EQ(given.cut_out_counts().opaque, (count + 1) / 3);
        EXPECT_EQ(given.cut_out_counts().masked, 0u);
        const auto [visibilities, receivers] = answers(device, given);
        for (std::size_t i = 0; i < lights.size(); ++i) expect_same(visibilities[i], plain.first[i], name);
        EXPECT_EQ(receivers, plain.second) << name;
    }
}

TEST(CutOuts, ACameraSeesThroughHoles) {
    const Floats scene = small_scene();
    const std::vector<Family> families = open_families();
    const reference::PinholeCamera pinhole{{0.3f, 1.4f, 3.0f}, {0, 0, 0}, {0, 1, 0}, 45, 96, 64};
    const auto camera = gnomon::Camera::look_at(pinhole.eye, pinhole.target, pinhole.up, pinhole.fov_y_degrees);
    const Triangles plain = Triangles::upload(families[0].device, scene);
    const auto opaque = gnomon::look(families[0].device, plain, camera, 96, 64).read(families[0].device, plain);
    for (const bool has_alphas : {false, true}) {
        const CutOutData data(mixed_masks(scene.size() / 9, 8, has_alphas));
        for (const Family& family : families) {
            const Device& device = family.device;
            Triangles triangles = Triangles::upload(device, scene, data.cut_outs());
            for (const bool clusters : {false, true}) {
                if (clusters) triangles.keep_clusters(device);
                const gnomon::View view = gnomon::look(device, triangles, camera, 96, 64);
                const auto seen = view.read(device, triangles);
                std::size_t differ = 0;
                for (std::size_t i = 0; i < seen.receiver.size(); ++i) differ += seen.receiver[i] != opaque.receiver[i];
                EXPECT_GT(differ, 500u);
                for (const gnomon::Light& light : lights) {
                    const auto visibility = run(device, triangles, view.points, light);
                    const auto report = reference::judge_view(scene, pinhole, light.xyzw,
                                                              {seen.position, seen.normal, seen.receiver, visibility},
                                                              {.masks = &data.masks()});
                    EXPECT_EQ(report.wrong(), 0u) << family.name << report.wrong_nearest.count << " nearest, "
                                                  << report.wrong_visibility.count << " visibility";
                    EXPECT_LT(report.camera_ambiguous, 3u);
                    expect_same(run(device, triangles, view.points, light, {}, true), visibility,
                                std::string(family.name) + " prepared");
                }
                const gnomon::CutOuts cut_outs = data.cut_outs();
                const auto parts = gnomon::look_in_parts(device, {scene, &cut_outs}, camera, 96, 64);
                EXPECT_EQ(parts.view.read(device, parts.triangles).receiver, seen.receiver);
            }
        }
    }
}

TEST(CutOuts, FootprintsAreAsSampleBySample) {
    const Floats scene = small_scene();
    const auto camera = gnomon::Camera::look_at({0.3f, 1.4f, 3.0f}, {0, 0, 0}, {0, 1, 0}, 45);
    const CutOutData data(mixed_masks(scene.size() / 9, 9));
    for (const Family& family : open_families()) {
        const Device& device = family.device;
        const Triangles triangles = Triangles::upload(device, scene, data.cut_outs());
        const gnomon::View view = gnomon::look(device, triangles, camera, 96, 64);
        const auto technique = technique_with(device, {{"map-size", "128"}});
        for (const gnomon::Light& light : lights) {
            std::vector<float> mean(view.points.count());
            const gnomon::Visibility means(device, mean.size());
            gnomon::run_samples(*technique, triangles, view, light, 8, means, [&](const Points& samples) {
                const auto host = samples.read(device);
                const auto one = truth_of_points(scene, data.masks(), host.position, host.receiver, light, camera.eye);
                for (std::size_t i = 0; i < one.size(); ++i) mean[i % mean.size()] += one[i] / 8;
            });
            expect_same(means.read(), mean, std::string(family.name) + " one by one");
            gnomon::run_samples(*technique, triangles, view, light, 8, means);
            expect_same(means.read(), mean, std::string(family.name) + " footprints");
        }
    }
}

struct Beams {
    Family family;
    std::vector<const char*> methods;
    bool has_lamp;
};

void expect_beams_and_explain_honour_masks(const std::vector<Beams>& all_beams) {
    const Floats scene = small_scene(), points = random_points(600, -1.2f, 1.2f, 8);
    const auto suns = gnomon::sun_disk({0.3f, -1, 0.2f}, 5, 40);
    const auto lamp = gnomon::area_light({-0.2f, 1.5f, 0.1f}, {0.5f, 0, 0}, {0, 0.1f, 0.4f}, 40);
    const CutOutData data(mixed_masks(scene.size() / 9, 10, true));
    const auto bits_of = [&](const Device& device, const char* how, const Triangles& of, const gnomon::Lights& table) {
        return gnomon::run_light_table_to_host(*technique_with(device, {{"many-lights", how}}), of,
                                               Points::upload(device, points), table, {.bits = true})
            .bits;
    };
    const Device& first = all_beams[0].family.device;
    const Triangles plain = Triangles::upload(first, scene);
    for (const auto& [family, methods, has_lamp] : all_beams) {
        const auto& [name, device] = family;
        const Points given = Points::upload(device, points);
        const Triangles triangles = Triangles::upload(device, scene, data.cut_outs());
        for (const gnomon::Lights& table : has_lamp ? std::vector{suns, lamp} : std::vector{suns}) {
            const auto one = bits_of(device, "one-by-one", triangles, table);
            for (const char* how : methods)
                EXPECT_EQ(bits_of(device, how, triangles, table), one) << name << ", " << how;
            EXPECT_NE(bits_of(first, "one-by-one", plain, table), one) << name;
        }
        for (const gnomon::Light& light : lights) {
            const auto visibility = run(device, triangles, given, light);
            for (std::size_t i = 0; i < 40; ++i) {
                const auto explained = gnomon::explain(device, triangles, given, i, light);
                EXPECT_EQ(explained.visibility, visibility[i]);
                EXPECT_EQ(explained.occluders.empty(), visibility[i] == 1);
            }
        }
    }
}

TEST(CutOuts, BeamsAndExplainHonourThem) {
    const std::vector<const char*> all = {"beams", "point-beams", "rays"};
    expect_beams_and_explain_honour_masks(
        {{{"cpu", Device()}, all, true}, {{"cpu without double", Device({}, {.hide_fp64 = true})}, all, true}});
}

// PoCL compiles a program of beams for GPUs in 3 to 9 seconds. Beams are traced in float; only the queue is decided in
// double, or without it, by one text for all methods and lights: so one of them is run without double.
TEST(CutOuts, BeamsAndExplainForGpusExhaustive) {
    expect_beams_and_explain_honour_masks(
        {{{"gpu", Device({}, {.gpu_kernels = true})}, {"beams", "point-beams"}, true},
         {{"gpu without double", Device({}, {.hide_fp64 = true, .gpu_kernels = true})}, {"beams"}, false}});
}

}  // namespace
