// SPDX-License-Identifier: MIT
// Shadow volumes against the exact technique: closed, open and non-manifold casters, the eye inside a volume, both
// lights, both ways of counting, and what the cancellation saves.
#include <gtest/gtest.h>

#include "support/floor_view.hpp"

namespace {

using namespace support;
using gnomon::Float3;

constexpr std::uint32_t width = 160, height = 120;

struct Scene {
    std::string name;
    Floats triangles;
    Float3 eye{0, 2, 4};
};

Scene with_floor(std::string name, const Floats& casters, Float3 eye = {0, 2, 4}) {
    return {std::move(name), over_a_floor(casters), eye};
}

/// Three triangles on one edge: no pairing of neighbours would be right.
Floats three_on_an_edge() {
    Floats triangles;
    for (const Float3 tip : {Float3{1, 0.25f, 0.5f}, Float3{-1, 0.5f, 0.25f}, Float3{0.125f, 1.5f, -0.25f}})
        add(triangles, {0, 0, -1}, {0, 0, 1}, tip);
    return triangles;
}

std::vector<Scene> scenes() {
    return {with_floor("a closed sphere", icosphere(2, 0.8f)),
            with_floor("one open triangle", {-1, 0.5f, -1, 1, 0.75f, -1, 0, 0.25f, 1}),
            with_floor("three triangles on an edge", three_on_an_edge()), with_floor("a soup", soup(60, 0.5f, 5)),
            // Under a roof: the eye itself is in shadow, where z-pass must begin with more than 0.
            with_floor("the eye in a shadow", {-3, 3, -6, 3, 3, -6, 0, 3, 9}, {0, 1, 3})};
}

const std::vector<gnomon::Light>& lights() {
    static const std::vector<gnomon::Light> all = {gnomon::Light::directional({-0.4f, -1, -0.3f}),
                                                   gnomon::Light::directional({0.25f, -1, 0.75f}),
                                                   gnomon::Light::point({1, 4, 0.5f})};
    return all;
}

class ShadowVolumes : public testing::Test {
protected:
    Answer run(const Scene& scene, const gnomon::Light& light, const std::string& technique,
               const Settings& settings = {}) const {
        const auto triangles = gnomon::Triangles::upload(device_, scene.triangles);
        const auto camera = gnomon::Camera::look_at(scene.eye, {0, -0.25f, 0}, {0, 1, 0}, 60);
        const gnomon::View view = gnomon::look(device_, triangles, camera, width, height);
        return answer(device_, *technique_with(device_, settings, technique), triangles, view.points, light);
    }

    gnomon::Device device_;
};

/// Pixels off the truth where the truth is the same all around: a float may err at an edge, and nowhere else.
std::size_t wrong_inside(const std::vector<float>& mask, const std::vector<float>& truth) {
    std::size_t wrong = 0;
    for (std::uint32_t y = 1; y + 1 < height; ++y)
        for (std::uint32_t x = 1; x + 1 < width; ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            bool uniform = true;
            for (std::uint32_t v = y - 1; v <= y + 1; ++v)
                for (std::uint32_t u = x - 1; u <= x + 1; ++u) uniform &= truth[std::size_t(v) * width + u] == truth[i];
            wrong += uniform && mask[i] != truth[i];
        }
    return wrong;
}

std::size_t differences(const std::vector<float>& a, const std::vector<float>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

TEST_F(ShadowVolumes, AreTheTruthAwayFromItsEdges) {
    for (const Scene& scene : scenes())
        for (const gnomon::Light& light : lights())
            for (const char* method : {"z-pass", "z-fail"}) {
                SCOPED_TRACE(scene.name + ", " + method + ", w " + std::to_string(light.xyzw[3]));
                const std::vector<float> truth = run(scene, light, "frustum-traced").visibility;
                const std::vector<float> mask = run(scene, light, "shadow-volumes", {{"method", method}}).visibility;
                ASSERT_GT(std::count(truth.begin(), truth.end(), 0.0f), 100) << "a scene without shadow proves nothing";
                ASSERT_GT(std::count(truth.begin(), truth.end(), 1.0f), 100);
                EXPECT_EQ(wrong_inside(mask, truth), 0u);
                EXPECT_LE(differences(mask, truth), mask.size() / 500);
            }
}

TEST_F(ShadowVolumes, TheEyeInAShadowIsCounted) {
    const Answer answer = run(scenes().back(), lights().front(), "shadow-volumes");
    EXPECT_EQ(answer.count("eye_inside"), 1u);
    EXPECT_EQ(run(scenes().front(), lights().front(), "shadow-volumes").count("eye_inside"), 0u);
}

TEST_F(ShadowVolumes, CancellationChangesNoPixelAndSavesMost) {
    const Scene scene = scenes().front();
    for (const gnomon::Light& light : lights()) {
        const Answer with = run(scene, light, "shadow-volumes");
        const Answer without = run(scene, light, "shadow-volumes", {{"cancel", "off"}});
        EXPECT_EQ(with.visibility, without.visibility);
        // Of a closed sphere of 320 triangles only the silhouette is left. Every edge is in two triangles.
        const std::uint64_t halves = light.is_directional() ? 1 : 2;  // a point light's side is drawn in two
        EXPECT_EQ(without.count("sides"), without.count("edges") * halves);
        EXPECT_LT(with.count("sides") * 5, without.count("sides"));
        EXPECT_LT(with.count("pixels_written") * 3, without.count("pixels_written"));
    }
}

TEST_F(ShadowVolumes, FrontFacesAreEnoughForAClosedMesh) {
    const Scene scene = scenes().front();
    const Answer both = run(scene, lights().front(), "shadow-volumes");
    const Answer front = run(scene, lights().front(), "shadow-volumes", {{"faces", "front"}});
    EXPECT_LT(front.count("triangles_casting"), both.count("triangles_casting"));
    EXPECT_LE(differences(front.visibility, both.visibility), both.visibility.size() / 500);
    // And not enough for an open one that turns its back to the light.
    Scene turned = with_floor("turned", {-1, 0.5f, -1, 1, 0.5f, -1, 0, 0.5f, 1});
    const auto lit = [&](const Settings& settings) {
        const std::vector<float> mask = run(turned, lights().front(), "shadow-volumes", settings).visibility;
        return std::count(mask.begin(), mask.end(), 1.0f);
    };
    EXPECT_LT(lit({}), lit({{"faces", "front"}}));
}

TEST_F(ShadowVolumes, NothingThereIsLit) {
    const Scene nothing{"nothing", {}, {0, 2, 4}};
    for (const float v : run(nothing, lights().front(), "shadow-volumes").visibility) ASSERT_EQ(v, 1.0f);
}

TEST_F(ShadowVolumes, RefusesPointsThatAreNoPicture) {
    const auto triangles = gnomon::Triangles::upload(device_, over_a_floor({}));
    const auto points = gnomon::Points::upload(device_, Floats{0, 0, 0});
    const gnomon::Visibility visibility(device_, 1);
    const auto technique = gnomon::make_technique("shadow-volumes", device_);
    EXPECT_THROW(technique->run(triangles, points, lights().front(), visibility), gnomon::InvalidArgument);
    EXPECT_THROW(technique->set("faces", "none"), gnomon::InvalidArgument);
    EXPECT_THROW(technique->set("colour", "blue"), gnomon::InvalidArgument);
}

TEST_F(ShadowVolumes, SameBitsForEveryWorkGroupSize) {
    const Scene scene = scenes()[3];
    const Answer expected = run(scene, lights().back(), "shadow-volumes");
    for (const std::uint32_t size : FEW_WORK_GROUP_SIZES) {
        device_ = device_with(size);
        EXPECT_EQ(run(scene, lights().back(), "shadow-volumes").visibility, expected.visibility) << size;
    }
}

}  // namespace
