// SPDX-License-Identifier: MIT
// The technique frustum-traced as a whole, against the oracle (reference::shadowed: exact, independent, no shared
// code): EQUALITY on every point of every scene. Each scene asserts why it is not vacuous: both answers occur, and
// where it is about ties, the float filter had to hand over at least so many pairs. Then: the same bits whatever the
// settings, the work-group size, the order and winding of triangles; and the laws that hold between scenes (adding,
// splitting, swapping triangles; turning everything by 90 degrees).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <ostream>

#include <gnomon.hpp>
#include "cl/session.hpp"
#include "reference/view.hpp"
#include "scene/scene.hpp"
#include "support/expect_exact.hpp"
#include "trace/map_choice.hpp"

namespace {

using namespace support;
using gnomon::Device;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float denormal = std::numeric_limits<float>::denorm_min();

const Settings map_on = {{"conservative-map", "on"}}, map_off = {{"conservative-map", "off"}};

Device& device() {
    static Device opened;
    return opened;
}

/// All points are right with each of the settings, and with the first of them with the light prepared, too.
void expect_exact(const LightScene& scene, const std::vector<Settings>& ways, AnswerTally& tally) {
    const std::vector<float> truth = truth_of(scene);
    tally.add(truth);
    for (const Settings& settings : ways)
        support::expect_exact(device(), scene, settings, tally, Mode::animated, &truth);
    support::expect_exact(device(), scene, ways.front(), tally, Mode::prepared, &truth);
}

// ---- Scenes ---------------------------------------------------------------------------------------------------------

/// A scene for several lights.
struct Scene : LightScene {
    std::vector<Light> lights{};
    std::uint64_t min_uncertain = 0;  ///< pairs that the float filter must leave open, over all lights
    bool both_answers = true;

    LightScene lit_by(const Light& one, const std::optional<Float3>& seen_from = std::nullopt) const {
        LightScene scene = *this;
        scene.light = one;
        scene.eye = seen_from;
        return scene;
    }
    friend std::ostream& operator<<(std::ostream& out, const Scene& scene) { return out << scene.name; }
};

const std::vector<Light> lattice_lights = {along(1, 0, 0),      along(1, 1, 0), along(1, 1, 1), along(0, -1, 0),
                                           along(-1, 2, 3),     at(2, 7, 2),  // at(...): a lattice vertex
                                           at(2.5f, 2.5f, 2.5f)};

/// Points on the triangles: a vertex, an edge's middle or inside, with the triangle as their receiver.
void add_points_on_triangles(Scene& scene, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    const auto triangle_count = static_cast<std::uint32_t>(scene.triangles.size() / 9);
    scene.receivers.resize(scene.points.size() / 3, gnomon::no_receiver);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = random.below(triangle_count);
        const Float3 a = vertex(scene.triangles, 3 * id), b = vertex(scene.triangles, 3 * id + 1),
                     c = vertex(scene.triangles, 3 * id + 2);
        const float u = float(random.below(3)) / 2, v = (1 - u) * float(random.below(3)) / 2;
        for (int k = 0; k < 3; ++k) scene.points.push_back(a[k] * (1 - u - v) + b[k] * u + c[k] * v);
        scene.receivers.push_back(id);
    }
}

Scene lattice(const std::string& name = "lattice") {
    Scene scene{{name, lattice_blocks(24, 5, 7), lattice_points(600, 5, 8)}, lattice_lights, 1000};
    add_points_on_triangles(scene, 400, 9);
    return scene;
}

Scene random_soup(const std::string& name = "soup") {
    Scene scene{{name, soup(400, 0.3f, 1), random_points(800, -1.2f, 1.2f, 2)}};
    scene.lights = {along(0.2f, -1, 0.3f), along(1, 0, 0), along(-0.577f, 0.577f, 0.578f), at(0.1f, 0.2f, 0.3f),
                    at(0.5f, 5, 1)};
    add_points_on_triangles(scene, 700, 3);
    return scene;
}

Scene moved_and_scaled(const Scene& original, double scale, double offset) {
    Scene scene = original;
    scene.name = original.name + " times " + std::to_string(scale) + " plus " + std::to_string(offset);
    const std::array<double, 3> by = {offset, -offset / 2, offset / 3};
    scene.triangles = placed(original.triangles, scale, by);
    scene.points = placed(original.points, scale, by);
    scene.min_uncertain = 0;
    scene.lights.clear();
    for (Light light : original.lights) {
        if (light[3] != 0)
            for (int i = 0; i < 3; ++i) light[i] = static_cast<float>(light[i] * scale + by[i]);
        scene.lights.push_back(light);
    }
    return scene;
}

std::vector<Scene> general_scenes() {
    std::vector<Scene> scenes = {random_soup(), lattice()};

    // A closed disc of needles: every point under it is in shadow, ties along all shared edges and at the tip.
    Scene fan{{"needle fan", needle_fan(3000, 8)},
              {along(0, -1, 0), along(1, -1, 0), along(0.3f, -1, 0.2f), at(0, 1, 0), at(4, 0, 1), at(2, 0.001f, 3)},
              1000};
    for (int i = 0; i < 400; ++i) add(fan.points, {float(i % 20) * 0.5f - 5, -1, float(i / 20) * 0.5f - 5});
    for (int i = 0; i < 300; ++i) {  // exactly below rim vertices and middles of edges
        const Float3 rim = vertex(fan.triangles, 3 * (7 * i % 3000) + 1);
        const float share = i % 2 == 0 ? 1.0f : 0.5f;
        add(fan.points, {rim[0] * share, -2, rim[2] * share});
    }
    scenes.push_back(fan);

    // Nearly parallel and nearly edge-on, thinner than any texel.
    Scene thin{{"slivers through one texel", slivers(20000, 1e-4f, 4), random_points(300, -1e-3f, 1e-3f, 5)}};
    append(thin.points, random_points(300, -1, 1, 6));
    thin.lights = {along(0, -1, 0), along(0.01f, -1, 0.02f), at(0, 3, 0), along(0.1f, -0.01f, 0)};
    scenes.push_back(thin);

    Scene skinny{{"skinny and nearly parallel", {}, random_points(800, -1, 1, 13)}, {}, 100};
    Random random(12);
    for (int i = 0; i < 500; ++i) {
        const float y = random.between(-1, 1), z = random.between(-1, 1);
        add(skinny.triangles, {-1, y, z}, {1, y + random.between(-1e-6f, 1e-6f), z + random.between(-1e-6f, 1e-6f)},
            {0, y + random.between(-0.05f, 0.05f), z + random.between(-1e-5f, 1e-5f)});
    }
    add_points_on_triangles(skinny, 400, 14);
    skinny.lights = {along(0, 0, -1), along(1e-3f, 0.2f, -1), along(0, -1, 1e-4f), at(0, 0, 2), along(1, 1e-5f, 1e-5f)};
    scenes.push_back(skinny);

    // A flat floor of integer vertices under light that touches it almost: points on it, one ulp over and under it.
    Scene grazing{{"grazing"}, {}, 500};
    for (int x = 0; x < 16; ++x)
        for (int z = 0; z < 16; ++z) {
            const float X = float(x), Z = float(z);
            add(grazing.triangles, {X, 1, Z}, {X + 1, 1, Z}, {X + 1, 1, Z + 1});
            add(grazing.triangles, {X, 1, Z}, {X + 1, 1, Z + 1}, {X, 1, Z + 1});
        }
    add(grazing.triangles, {9, 1, 2}, {9, 1.00002f, 2}, {9, 1, 14});  // a step of a hundredth of a millimetre
    for (int i = 0; i < 600; ++i) {
        const float y = i % 3 == 0 ? 1.0f : i % 3 == 1 ? std::nextafter(1.0f, 2.0f) : std::nextafter(1.0f, 0.0f);
        add(grazing.points, {float(random.below(33)) / 2, y, float(random.below(33)) / 2});
        grazing.receivers.push_back(random.below(513));
    }
    grazing.lights = {along(1, -1e-6f, 0), along(1, -1e-6f, 0.3f), along(-1, 1e-6f, 0),
                      along(1, -1e-6f, 1), at(-100, 1.0001f, 5),   at(8, 1.0000001f, 8)};
    scenes.push_back(grazing);

    // Every triangle three times: as it is, again, and with the other face in front.
    Scene duplicates{{"duplicates and coincident opposite faces", soup(60, 0.6f, 21)}};
    const Floats once = duplicates.triangles;
    append(duplicates.triangles, once);
    append(duplicates.triangles, reversed_winding(once));
    append(duplicates.triangles, lattice_blocks(4, 2, 22));
    append(duplicates.triangles, reversed_winding(lattice_blocks(4, 2, 22)));
    duplicates.points = random_points(500, -1.2f, 1.2f, 23);
    add_points_on_triangles(duplicates, 500, 24);
    duplicates.lights = {along(0, -1, 0), along(0.3f, -0.8f, 0.1f), along(1, 1, 0), at(0.3f, 1.5f, 0.1f)};
    duplicates.min_uncertain = 500;
    scenes.push_back(duplicates);

    // Texels as large as a house; half the yard is covered.
    Scene giant{{"one triangle over everything", {}, random_points(1000, -1, 1, 31)}};
    add(giant.triangles, {0.25f, 3, -1e6f}, {0.25f, 3, 1e6f}, {1e6f, 3.5f, 0});
    append(giant.triangles, soup(50, 0.2f, 32));
    giant.lights = {along(0, -1, 0), along(0.3f, -1, 0.2f), at(0, 50, 0), at(0.5f, 2, 0), along(0, 1, 0)};
    scenes.push_back(giant);

    for (const double scale : {1e-6, 1e-3, 1e6})
        for (const Scene& original : {random_soup(), lattice()}) scenes.push_back(moved_and_scaled(original, scale, 0));
    for (const double offset : {1e3, 1e5, 1e6, 1e7})
        for (const Scene& original : {random_soup(), lattice()})
            scenes.push_back(moved_and_scaled(original, 1, offset));

    // The reference's own hard scenes, at all scales of float32.
    for (const reference::TestScene& hard : reference::all_test_scenes())
        scenes.push_back({{hard.name, hard.triangles, hard.points, {}, hard.receivers}, hard.lights});
    return scenes;
}

/// Coordinates where floats lose their relative precision, arranged so that the float filter could believe itself sure.
std::vector<Scene> extreme_scenes() {
    std::vector<Scene> scenes;
    const auto add_scene = [&](const std::string& name, std::uint64_t seed, auto coordinate,
                               std::vector<Light> lights) {
        Random random(seed);
        Scene scene{{name}, std::move(lights)};
        for (int i = 0; i < 80 * 9; ++i) scene.triangles.push_back(coordinate(random, i % 3));
        for (int i = 0; i < 500 * 3; ++i) scene.points.push_back(coordinate(random, i % 3));
        add_points_on_triangles(scene, 200, seed + 1);
        scenes.push_back(std::move(scene));
    };
    for (int flat = 0; flat < 3; ++flat) {
        Light towards{};
        towards[flat] = 1;
        Light oblique = {1, 1, 1, 0};
        oblique[flat] = denormal;
        add_scene("heights of a few denormals along axis " + std::to_string(flat), 40 + flat,
                  [flat](Random& r, int c) { return c == flat ? denormal * float(r.below(40)) : r.between(-1, 1); },
                  {towards, {towards[0], towards[1], -towards[2] * 3, 0}, oblique});
        add_scene("widths of a few denormals along axis " + std::to_string(flat), 43 + flat,
                  [flat](Random& r, int c) { return c != flat ? denormal * float(r.below(40)) : r.between(-1, 1); },
                  {towards, oblique, at(0, 0, 0), at(denormal, 2 * denormal, denormal)});
    }
    add_scene("about 1e-38", 50, [](Random& r, int) { return r.between(-1, 1) * 1e-38f; },
              {along(0, -1, 0), along(1, 2, 3), along(1e-38f, 1e-38f, -1e-38f), at(1e-38f, 3e-38f, 0), at(0, 1, 0)});
    add_scene("about 1e-30 heights", 51, [](Random& r, int c) { return r.between(-1, 1) * (c == 1 ? 1e-42f : 1.0f); },
              {along(0, -1, 0), along(1e-3f, -1, 0), at(0, 1e-42f, 0), at(0.3f, 1, 0.1f)});
    add_scene("about 1e38", 52, [](Random& r, int) { return r.between(-1, 1) * 1e38f; },
              {along(0, -1, 0), along(1, 2, 3), along(1e38f, 1e38f, -1e38f), at(1e38f, 3e38f, 0), at(0, 1, 0)});
    add_scene("1e15, where the grid gives up", 53, [](Random& r, int) { return r.between(-1.1f, 1.1f) * 1e15f; },
              {along(0, -1, 0), along(1, 2, 3), at(0, 0, 0), at(0, 3e15f, 0)});
    add_scene("1e9 and 1e-9", 54, [](Random& r, int) { return r.between(-1, 1) * (r.below(2) == 0 ? 1e9f : 1e-9f); },
              {along(0, -1, 0), along(1, 2, 3), at(1e-9f, 0, 0), at(1e9f, 1e-9f, 1)});
    add_scene("points close, triangles everywhere", 55,
              [](Random& r, int) { return std::ldexp(r.between(-1, 1), int(r.below(80)) - 40); },
              {along(0, -1, 0), along(1, 2, 3), at(0, 0, 0), at(1e-12f, 1e3f, 1e-3f)});
    return scenes;
}

class ExactOn : public testing::TestWithParam<Scene> {};

TEST_P(ExactOn, EveryPointWithEveryLight) {
    const Scene& scene = GetParam();
    AnswerTally tally;
    for (const Light& light : scene.lights) {
        LightScene lit = scene.lit_by(light);
        expect_exact(lit, {map_on, map_off}, tally);
        lit.receivers.clear();
        expect_exact(lit, {map_on}, tally);
    }
    if (scene.both_answers) {
        EXPECT_GT(tally.lit, scene.points.size() / 100);
        EXPECT_GT(tally.shadowed, scene.points.size() / 100);
    }
    EXPECT_GE(tally.uncertain, scene.min_uncertain);
}

std::string name_of(const testing::TestParamInfo<Scene>& info) {
    std::string name = std::to_string(info.index) + "_";
    for (const char c : info.param.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}
INSTANTIATE_TEST_SUITE_P(Scenes, ExactOn, testing::ValuesIn(general_scenes()), name_of);
INSTANTIATE_TEST_SUITE_P(Extremes, ExactOn, testing::ValuesIn(extreme_scenes()), name_of);

// ---- Closed meshes --------------------------------------------------------------------------------------------------

// No oracle is needed to know this: whatever the tessellation, no light from outside reaches the inside of a sphere.
TEST(ClosedMesh, InsideIsDarkFromEveryDirectionAndEveryPlaceOutside) {
    LightScene question{"sphere", icosphere(3, 2), random_points(1000, -1, 1, 61)};  // |point| < sqrt(3) < the inradius
    const std::size_t inside = question.points.size() / 3;
    append(question.points, random_points(300, 2.5f, 3, 62));
    Random random(63);
    std::size_t lit_outside = 0;
    for (int i = 0; i < 60; ++i) {
        Float3 v = random_vector(random, -1, 1);
        if (i % 4 == 0) v = vertex(question.triangles, random.below(3840));  // exactly through a vertex from the centre
        if (i % 4 == 1) v[i % 3] = 0;
        question.light = i % 2 == 0 ? Light{v[0], v[1], v[2], 0} : at(v[0] * 9 + 3, v[1] * 9, v[2] * 9);
        if (i % 2 != 0 && std::hypot(question.light[0], question.light[1], question.light[2]) < 2.1f) continue;
        const Answer found = answer(device(), question, i % 3 == 0 ? map_off : map_on);
        for (std::size_t k = 0; k < inside; ++k) ASSERT_EQ(found.visibility[k], 0.0f) << "leak at point " << k;
        for (std::size_t k = inside; k < found.visibility.size(); ++k) lit_outside += found.visibility[k] != 0;
        if (i % 6 == 0) expect_equal(found.visibility, truth_of(question), question, "");
    }
    EXPECT_GT(lit_outside, 1000u);
}

// ---- Lights and points in special places ----------------------------------------------------------------------------

TEST(PositionalLight, InsideOutsideAtAVertexInAPlaneAtAPoint) {
    LightScene question{"positional light", icosphere(2, 2), random_points(500, -3, 3, 71)};
    append(question.triangles, lattice_blocks(5, 3, 72));
    append(question.points, lattice_points(500, 3, 73));
    const Float3 corner = vertex(question.triangles, 17), b = vertex(question.triangles, 3);
    const Float3 a_point = {question.points[30], question.points[31], question.points[32]};
    AnswerTally tally;
    for (const Light& light : {at(0, 0, 0), at(0.3f, 0.2f, 0.1f), at(5, 6, 7), at(corner[0], corner[1], corner[2]),
                               at(1, 1, 1), at(0.5f, 1, 0.5f), at(b[0] * 2, b[1] * 2, b[2] * 2), at(1, 7.25f, 2.5f),
                               at(a_point[0], a_point[1], a_point[2]), at(1.5f, 1.5f, 2)}) {
        question.light = light;
        expect_exact(question, {map_on, map_off}, tally);
    }
    EXPECT_GT(tally.lit, 500u);
    EXPECT_GT(tally.shadowed, 500u);
    EXPECT_GT(tally.uncertain, 500u);
    question.light = at(a_point[0], a_point[1], a_point[2]);
    EXPECT_EQ(answer(device(), question, map_on).visibility[10], 1.0f) << "nothing lies between a light and itself";
}

// A caller may say any receiver: then the point need not lie on it, and may be on its far side.
TEST(Receivers, AnyTriangleOrNoneWithAnEyeOrWithout) {
    Scene scene = random_soup();
    append(scene.triangles, placed(soup(20, 1, 81), 1, {0, 0.5, 0}));
    Random random(82);
    for (std::uint32_t& id : scene.receivers) {
        const std::uint32_t kind = random.below(8);
        if (kind == 0) id = 420;  // the first id that is no triangle
        if (kind == 1) id = gnomon::no_receiver;
        if (kind == 2) id = 0x80000000u;
        if (kind >= 5) id = random.below(420);
    }
    // Just under a large receiver that faces both the eye and the light: the receiver is all that is in the way.
    for (int i = 0; i < 2500; ++i) {
        const std::uint32_t id = 400 + random.below(20);
        const float u = random.between(0, 1), v = random.between(0, 1 - u), depth = random.between(0, 0.02f);
        for (int k = 0; k < 3; ++k)
            scene.points.push_back((1 - u - v) * scene.triangles[9 * id + k] + u * scene.triangles[9 * id + 3 + k] +
                                   v * scene.triangles[9 * id + 6 + k] - (k == 1 ? depth : 0));
        scene.receivers.push_back(id);
    }
    AnswerTally tally;
    std::uint64_t facing_away = 0;
    for (const Light& light : {along(0, -1, 0), along(0.3f, -1, 0.2f), at(0.3f, 4, 0), along(0, 1, 0)})
        for (const std::optional<Float3>& eye :
             {std::optional<Float3>(), std::optional<Float3>({0.5f, 3, 0.2f}), std::optional<Float3>({1, 0, 0})}) {
            const LightScene question = scene.lit_by(light, eye);
            expect_exact(question, {{{"conservative-map", "on"}, {"map-size", "256"}}, map_on, map_off}, tally);
            facing_away += answer(device(), question, map_on).statistics.count("points_facing_away");
        }
    EXPECT_GT(tally.lit, 1000u);
    EXPECT_GT(tally.shadowed, 1000u);
    EXPECT_GT(tally.by_map, 1000u);
    EXPECT_GT(facing_away, 1000u);
}

TEST(BadNumbers, TrianglesAndPointsThatAreNotFinite) {
    Scene scene = random_soup();
    Random random(91);
    const float bad[] = {not_a_number, infinity, -infinity};
    std::size_t broken = 0;
    for (std::size_t i = 0; i < scene.triangles.size(); i += 9)
        if (random.below(3) == 0) scene.triangles[i + random.below(9)] = bad[random.below(3)], ++broken;
    for (std::size_t i = 0; i < scene.points.size(); i += 3)
        if (random.below(5) == 0) scene.points[i + random.below(3)] = bad[random.below(3)];
    AnswerTally tally;
    for (const Light& light : scene.lights)
        for (const std::optional<Float3>& eye : {std::optional<Float3>(), std::optional<Float3>({0, 3, 0})}) {
            const LightScene question = scene.lit_by(light, eye);
            expect_exact(question, {map_on, map_off}, tally);
            const gnomon::Statistics statistics = answer(device(), question, map_on).statistics;
            EXPECT_GT(statistics.count("points_absent"), 200u);
            if (light[3] == 0) {
                EXPECT_EQ(statistics.count("triangles_not_finite"), broken);
            }
        }
    EXPECT_GT(tally.lit, 1000u);
    EXPECT_GT(tally.shadowed, 1000u);
}

TEST(NothingToDo, NoTrianglesNoPointsNoneFinite) {
    const LightScene full{"full", soup(10, 1, 1), random_points(100, -1, 1, 2), along(0, -1, 0)};
    for (const Light& light : {along(0, -1, 0), at(0, 3, 0)})
        for (const Settings& settings : {map_on, map_off}) {
            LightScene question = full;
            question.light = light;
            question.triangles.clear();
            EXPECT_EQ(answer(device(), question, settings).visibility, std::vector<float>(100, 1.0f));
            question.triangles.assign(90, not_a_number);
            EXPECT_EQ(answer(device(), question, settings).visibility, std::vector<float>(100, 1.0f));
            question.triangles = full.triangles;
            question.points.clear();
            EXPECT_TRUE(answer(device(), question, settings).visibility.empty());
            question.points.assign(300, not_a_number);
            EXPECT_EQ(answer(device(), question, settings).visibility, std::vector<float>(100, 1.0f));
        }
}

TEST(NothingToDo, OnePointUnderOneTriangleAndBesideIt) {
    for (const Light& light : {along(0, -1, 0), at(0, 5, 0)})
        for (const Settings& settings : {map_on, map_off}) {
            LightScene question{"one triangle", {-1, 1, -1, 1, 1, -1, 0, 1, 1}, {0, 0, 0}, light};
            EXPECT_EQ(answer(device(), question, settings).visibility, std::vector<float>{0});
            question.points = {4, 0, 0};
            EXPECT_EQ(answer(device(), question, settings).visibility, std::vector<float>{1});
        }
}

// ---- The same bits whatever the settings ----------------------------------------------------------------------------

/// Enough points that the map is drawn of itself; ties, both kinds of light, receivers.
std::vector<LightScene> typical_questions() {
    std::vector<LightScene> questions;
    Scene soup_scene = random_soup(), lattice_scene = lattice();
    append(soup_scene.triangles, soup(6, 1.5f, 101));
    append(soup_scene.points, random_points(4000, -1.2f, 1.2f, 102));
    append(lattice_scene.points, lattice_points(4000, 5, 103));
    for (Scene* scene : {&soup_scene, &lattice_scene})
        scene->receivers.resize(scene->points.size() / 3, gnomon::no_receiver);
    for (const Light& light : {soup_scene.lights[0], soup_scene.lights[3]})
        questions.push_back(soup_scene.lit_by(light, Float3{0.3f, 4, 0.5f}));
    for (const Light& light : {lattice_lights[2], lattice_lights[5]}) questions.push_back(lattice_scene.lit_by(light));
    return questions;
}

TEST(SameBits, WhateverTheSettings) {
    const std::vector<Settings> ways = {{},
                                        map_off,
                                        map_on,
                                        {{"cover-test", "circle"}},
                                        {{"map-size", "16"}, {"cover-test", "tight"}},
                                        {{"map-size", "16"}, {"cover-test", "circle"}},
                                        {{"map-size", "17"}},
                                        {{"map-size", "256"}},
                                        {{"map-size", "1000"}, {"cover-test", "circle"}},
                                        {{"map-size", "1024"}},
                                        {{"map-size", "4096"}},
                                        {{"first-capacity", "1"}},
                                        {{"first-capacity", "1"}, {"conservative-map", "off"}, {"map-size", "64"}},
                                        {{"first-capacity", "100"}}};
    AnswerTally tally;
    for (const LightScene& question : typical_questions()) {
        expect_exact(question, ways, tally);
        EXPECT_GT(answer(device(), question, {{"first-capacity", "1"}}).statistics.count("lists_grown"), 0u);
    }
    EXPECT_GT(tally.lit, 2000u);
    EXPECT_GT(tally.shadowed, 2000u);
    EXPECT_GT(tally.by_map, 2000u);
    EXPECT_GT(tally.by_trace, 2000u);
    EXPECT_GT(tally.by_exact, 2000u);
}

TEST(SameBits, WithDoublePrecisionHidden) {
    const Device without({}, {.hide_fp64 = true});
    std::uint64_t by_integers = 0;
    AnswerTally tally;
    const auto expect_same = [&](const LightScene& question) {
        const Answer found = support::expect_exact(without, question, map_on, tally);
        EXPECT_EQ(found.count("decided_by_double"), 0u);
        by_integers += found.count("decided_by_integers");
    };
    for (const LightScene& question : typical_questions()) expect_same(question);
    for (const Scene& scene : extreme_scenes()) expect_same(scene.lit_by(scene.lights[0]));
    EXPECT_GT(by_integers, 1000u);
}

// The kernels with one point per work-item and work-groups that share what they count, also where there is no GPU.
TEST(SameBits, WithTheKernelsMadeForGpus) {
    const Device other({}, {.gpu_kernels = true});
    ASSERT_EQ(session_of(other).lanes(), 1u);
    AnswerTally tally;
    for (const LightScene& question : typical_questions())
        for (const Settings& settings : {map_on, Settings{{"map-size", "100"}, {"first-capacity", "3"}}}) {
            const Answer found = support::expect_exact(other, question, settings, tally);
            // What the work-groups sum up.
            const auto shadowed = std::uint64_t(std::ranges::count(found.visibility, 0.0f));
            EXPECT_EQ(found.count("points_in_shadow"), shadowed);
        }
    support::expect_exact(other, typical_questions().back(), map_on, tally, Mode::prepared);
}

class WorkGroup : public testing::TestWithParam<std::uint32_t> {};

TEST_P(WorkGroup, OfAnySizeGivesTheSameBits) {
    const Device other({}, {.work_group_size = GetParam()});
    AnswerTally tally;
    for (const LightScene& question : typical_questions())
        for (const Settings& settings : {map_on, Settings{{"map-size", "100"}, {"first-capacity", "3"}}})
            support::expect_exact(other, question, settings, tally);
}
INSTANTIATE_TEST_SUITE_P(Sizes, WorkGroup, testing::Values(1, 3, 7, 33, 64));

// A map is drawn on a CPU where it is expected to cover a sixteenth of the texels; the bits are the same.
TEST(AutomaticMap, IsDrawnWhereItCoversEnough) {
    if (session_of(device()).lanes() == 1) GTEST_SKIP() << "a GPU goes by the last map";
    const auto asked_under = [](float roof, const Settings& settings) {
        LightScene question{"roof", {}, random_points(5000, -1, 1, 11), along(0, -1, 0)};
        add(question.triangles, {-roof, 2, -roof}, {roof, 2, -roof}, {-roof, 2, roof});
        AnswerTally tally;
        const Answer found = support::expect_exact(device(), question, settings, tally);
        EXPECT_GT(found.count("map_candidates"), 0u);
        return found.count("map_texels_written");
    };
    EXPECT_GT(asked_under(1.5f, {}), 256u);
    EXPECT_GT(asked_under(0.1f, map_on), 0u);
    EXPECT_EQ(asked_under(0.1f, {}), 0u);
}

// What frames with a map counted on an H200, and how long they took with and without it (2026-11-22). Where one is
// faster by 3 % or more, the rule takes it.
TEST(AutomaticMap, OfAGpuIsTheFasterOne) {
    struct Measured {
        std::uint32_t decided, kept, hidden, references;
        double ms_with, ms_without;
        const char* name;
    };
    constexpr Measured frames[] = {
        {886054, 145329, 95304, 346029, .385, .517, "Sponza atrium, noon, 2K"},
        {404064, 134705, 100030, 290923, .379, .518, "Sponza atrium, along, 2K"},
        {5112655, 162537, 104623, 473557, .589, .838, "Sponza atrium, grazing, 4K"},
        {541963, 141278, 92626, 306540, .386, .485, "Sponza balcony, noon, 2K"},
        {43281, 20876, 267, 92986, .320, .285, "lost_empire hillside, slant, 2K"},
        {439560, 22886, 1291, 106723, .504, .479, "lost_empire hillside, low, 4K"},
        {592267, 41732, 3905, 122138, .273, .253, "lost_empire hillside, grazing, 2K: most open points decided"},
        {2372383, 42464, 3564, 131227, .429, .460, "lost_empire hillside, grazing, 4K: the same"},
        {308191, 57901, 1494, 365824, .685, .644, "lost_empire overview, low, 4K"},
        {8615, 219590, 6901, 504993, .548, .501, "city of a million, v0, 2K"},
        {235682, 66591, 11009, 185326, .373, .338, "city of a million, v1, 2K"},
        {34554, 672291, 87411, 1334449, .650, .617, "foliage of a million, v0, 2K: many triangles hidden"},
        {219686, 329090, 56365, 814254, .534, .518, "foliage of a million, v1, 2K"},
        {17, 230910, 0, 611567, .801, .763, "pipes of a million, v1, 2K"},
    };
    for (const Measured& frame : frames) {
        gnomon::FrameCounters counted{};
        counted.decided_by_map = frame.decided;
        counted.survivors = frame.kept + 10;
        counted.edge_on = 10;
        counted.hidden = frame.hidden;
        counted.references = frame.references;
        EXPECT_EQ(gnomon::map_was_worth_drawing(counted), frame.ms_with < frame.ms_without) << frame.name;
    }
}

// A GPU goes by the last map: where that one saved little it does without for a while, then looks again. The bits are
// the same.
TEST(AutomaticMap, OfAGpuGoesByTheLastMap) {
    const Device other({}, {.gpu_kernels = true});
    const std::vector<float> points = random_points(5000, -1, 1, 11);
    const gnomon::Points uploaded_points = gnomon::Points::upload(other, points);
    const auto technique = gnomon::make_technique("frustum-traced", other);
    const auto texels_under = [&](float roof) {
        LightScene question{"a roof of " + std::to_string(roof), {}, points, along(0, -1, 0)};
        add(question.triangles, {-roof, 2, -roof}, {roof, 2, -roof}, {-roof, 2, roof});
        const Answer found = answer(other, *technique, gnomon::Triangles::upload(other, question.triangles),
                                    uploaded_points, gnomon::Light{question.light});
        expect_equal(found.visibility, truth_of(question), question, "");
        return found.count("map_texels_written");
    };
    // 5000 points save too little whatever the roof is.
    EXPECT_GT(texels_under(1.5f), 0u);
    for (int i = 0; i < 31; ++i) ASSERT_EQ(texels_under(1.5f), 0u) << "run " << i;
    EXPECT_GT(texels_under(1.5f), 0u);
    EXPECT_EQ(texels_under(1.5f), 0u);
}

// ---- Laws between scenes --------------------------------------------------------------------------------------------

TEST(FrustumTraced, OrderAndWindingOfTrianglesMeanNothing) {
    for (const LightScene& question : typical_questions()) {
        const std::vector<float> truth = truth_of(question);
        LightScene other = question;
        other.triangles = reversed_winding(question.triangles);
        expect_equal(answer(device(), other, map_on).visibility, truth, other, "reversed winding");

        const auto old_of_new = shuffled_order(question.triangles.size() / 9, 111);
        std::vector<std::uint32_t> new_of_old(old_of_new.size());
        other.triangles.clear();
        for (std::uint32_t i = 0; i < old_of_new.size(); ++i) {
            new_of_old[old_of_new[i]] = i;
            const auto first = question.triangles.begin() + 9 * old_of_new[i];
            other.triangles.insert(other.triangles.end(), first, first + 9);
        }
        EXPECT_NE(other.triangles, question.triangles);
        for (std::uint32_t& id : other.receivers)
            if (id < new_of_old.size()) id = new_of_old[id];
        expect_equal(answer(device(), other, map_on).visibility, truth, other, "shuffled");
    }
}

/// (x, y, z) becomes (z, x, y), `times` times; then x and y turn by 90 degrees. Exact: coordinates only change places
/// and signs.
template <typename Vector>
void turn(Vector& v, int times) {
    for (int i = 0; i < times; ++i) {
        std::swap(v[0], v[1]);
        std::swap(v[0], v[2]);
    }
    std::swap(v[0], v[1]);
    v[0] = -v[0];
}

TEST(FrustumTraced, TurningEverythingByNinetyDegreesChangesNothing) {
    for (const LightScene& question : typical_questions()) {
        const std::vector<float> truth = truth_of(question);
        for (int times = 0; times < 3; ++times) {
            LightScene turned = question;
            const auto turn_all = [times](Floats& floats) {
                for (std::size_t i = 0; i < floats.size(); i += 3) {
                    Float3 v = {floats[i], floats[i + 1], floats[i + 2]};
                    turn(v, times);
                    std::copy(v.begin(), v.end(), floats.begin() + static_cast<std::ptrdiff_t>(i));
                }
            };
            turn_all(turned.triangles);
            turn_all(turned.points);
            turn(turned.light, times);
            if (turned.eye) turn(*turned.eye, times);
            expect_equal(answer(device(), turned, map_on).visibility, truth, turned, "turned");
        }
    }
}

TEST(FrustumTraced, LengthOfTheLightDirectionMeansNothing) {
    for (const LightScene& question : typical_questions()) {
        if (question.light[3] != 0) continue;
        const std::vector<float> truth = truth_of(question);
        for (const int exponent : {-140, -40, -1, 1, 40, 120}) {
            LightScene other = question;
            for (int i = 0; i < 3; ++i) other.light[i] = std::ldexp(other.light[i], exponent);
            // A direction that lost bits to denormals is another direction: the oracle knows it.
            const bool is_same = std::ldexp(other.light[0], -exponent) == question.light[0] &&
                                 std::ldexp(other.light[1], -exponent) == question.light[1] &&
                                 std::ldexp(other.light[2], -exponent) == question.light[2];
            expect_equal(answer(device(), other, map_on).visibility, is_same ? truth : truth_of(other), other,
                         "direction times 2^" + std::to_string(exponent));
        }
    }
}

// From where the grid tells nothing apart any more (2^50 and beyond) to where a quarter is the smallest denormal.
TEST(FrustumTraced, ScalingByPowersOfTwoChangesNothing) {
    Scene scene = lattice();
    append(scene.points, lattice_points(600, 5, 115));
    scene.receivers.resize(scene.points.size() / 3, gnomon::no_receiver);
    for (const Light& light : lattice_lights) {
        const LightScene question = scene.lit_by(light);
        const std::vector<float> truth = truth_of(question);
        for (const int exponent : {-147, -100, -60, -20, 20, 45, 50, 60, 124}) {
            LightScene scaled = question;
            const auto scale = [exponent](float& x) { x = std::ldexp(x, exponent); };
            std::for_each(scaled.triangles.begin(), scaled.triangles.end(), scale);
            std::for_each(scaled.points.begin(), scaled.points.end(), scale);
            if (light[3] != 0) std::for_each(scaled.light.begin(), scaled.light.begin() + 3, scale);
            for (const Settings& settings : {map_on, map_off})
                expect_equal(answer(device(), scaled, settings).visibility, truth, scaled,
                             "times 2^" + std::to_string(exponent));
        }
    }
}

TEST(FrustumTraced, AddingATriangleNeverLightsAPoint) {
    std::size_t newly_dark = 0;
    for (LightScene question : typical_questions()) {
        std::vector<float> before = answer(device(), question, map_on).visibility;
        for (int step = 0; step < 5; ++step) {
            append(question.triangles, soup(20, 0.5f, 121 + step));
            append(question.triangles, lattice_blocks(1, 5, 131 + step));
            const std::vector<float> after = answer(device(), question, step % 2 == 0 ? map_on : map_off).visibility;
            for (std::size_t i = 0; i < after.size(); ++i) {
                ASSERT_LE(after[i], before[i]) << "point " << i << " was lit by an added triangle";
                newly_dark += after[i] != before[i];
            }
            before = after;
        }
    }
    EXPECT_GT(newly_dark, 500u);
}

TEST(FrustumTraced, SplittingTrianglesAtExactMiddlesChangesNothing) {
    for (const Light& light : lattice_lights) {
        LightScene question{"lattice", placed(lattice_blocks(24, 5, 7), 2, {}),
                            placed(lattice_points(800, 5, 141), 2, {}), light};
        std::vector<float> whole = answer(device(), question, map_on).visibility;
        for (int level = 0; level < 2; ++level) {
            Floats halves;
            for (std::size_t i = 0; i < question.triangles.size() / 9; ++i) {
                // The middle of side ab: halves of small integers, exact.
                const Float3 a = vertex(question.triangles, 3 * i), b = vertex(question.triangles, 3 * i + 1),
                             c = vertex(question.triangles, 3 * i + 2);
                const Float3 middle = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
                add(halves, c, a, middle);
                add(halves, b, c, middle);
            }
            question.triangles = halves;
            expect_equal(answer(device(), question, map_on).visibility, whole, question, "split");
        }
    }
}

// ---- Views of whole scenes ------------------------------------------------------------------------------------------

/// The camera's own points, judged on every pixel. Returns how many points were lit and in shadow.
AnswerTally expect_exact_view(const Floats& triangles_on_host, const gnomon::Camera& camera, const Light& light,
                              std::uint32_t width, std::uint32_t height, const std::string& what) {
    const auto triangles = gnomon::Triangles::upload(device(), triangles_on_host);
    const gnomon::View view = gnomon::look(device(), triangles, camera, width, height);
    const auto technique = gnomon::make_technique("frustum-traced", device());
    const Answer found = answer(device(), *technique, triangles, view.points, gnomon::Light{light});
    AnswerTally tally;
    tally.add(found.statistics);
    const gnomon::ViewOnHost host = view.read(device(), triangles);
    LightScene question{what, triangles_on_host, host.position, light, host.receiver, camera.eye};
    for (std::size_t i = 0; i < host.receiver.size(); ++i)  // the sky is absent
        if (host.receiver[i] == gnomon::no_receiver) question.points[3 * i] = not_a_number;
    const std::vector<float> truth = truth_of(question);
    expect_equal(found.visibility, truth, question, "");
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (host.receiver[i] != gnomon::no_receiver) ++(truth[i] != 0 ? tally.lit : tally.shadowed);
    return tally;
}

class CommittedScene : public testing::TestWithParam<std::string> {};

TEST_P(CommittedScene, EveryPixelOfEveryCameraWithEveryLight) {
    const gnomon::scene::Scene scene = gnomon::scene::load(std::filesystem::path(GNOMON_SCENES) / GetParam());
    ASSERT_FALSE(scene.cameras.empty());
    ASSERT_FALSE(scene.lights.empty());
    std::uint64_t lit = 0, shadowed = 0;
    for (const auto& camera : scene.cameras)
        for (const auto& light : scene.lights) {
            const AnswerTally tally = expect_exact_view(scene.triangles, camera.camera, light.light.xyzw, 160, 96,
                                                        GetParam() + " " + camera.name + " " + light.name);
            lit += tally.lit;
            shadowed += tally.shadowed;
        }
    if (GetParam() == "empty.glb") return;
    EXPECT_GT(lit, 0u);
    EXPECT_EQ(shadowed == 0, GetParam() == "single_triangle.glb");
}

std::vector<std::string> committed_scenes() {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(GNOMON_SCENES))
        if (entry.path().extension() == ".glb") files.push_back(entry.path().filename().string());
    for (const char* real : {"sponza.glb", "lost_empire.glb"}) std::erase(files, real);  // RealScene has their views
    std::sort(files.begin(), files.end());
    return files;
}
INSTANTIATE_TEST_SUITE_P(Scenes, CommittedScene, testing::ValuesIn(committed_scenes()),
                         [](const auto& test) { return std::filesystem::path(test.param).stem().string(); });
// The folder being wrong must not look like success.
TEST(CommittedScenes, AreThere) { EXPECT_GE(committed_scenes().size(), 20u); }

struct RealView {
    const char* file;
    reference::PinholeCamera camera;
    Light grazing, point_light;

    friend std::ostream& operator<<(std::ostream& out, const RealView& view) { return out << view.file; }
};

class RealScene : public testing::TestWithParam<RealView> {};

// Views and grazing lights of scenes/views.json, smaller.
TEST_P(RealScene, EveryPixelWithAGrazingLightAndAPointLight) {
    const auto file = std::filesystem::path(GNOMON_SCENES) / GetParam().file;
    const gnomon::scene::Scene scene = gnomon::scene::load(file);
    const reference::PinholeCamera& from = GetParam().camera;
    const auto camera = gnomon::Camera::look_at(from.eye, from.target, from.up, from.fov_y_degrees);
    for (const Light& light : {GetParam().grazing, GetParam().point_light}) {
        const AnswerTally tally =
            expect_exact_view(scene.triangles, camera, light, from.width, from.height, file.stem());
        EXPECT_GT(tally.lit, 1000u);
        EXPECT_GT(tally.shadowed, 1000u);
        EXPECT_GT(tally.by_map + tally.by_trace, 1000u);
    }
}
INSTANTIATE_TEST_SUITE_P(Views, RealScene,
                         testing::Values(RealView{"sponza.glb",
                                                  {{-1000, 150, -40}, {200, 200, -30}, {0, 1, 0}, 60, 480, 270},
                                                  along(0.35f, -1, -0.004f),
                                                  at(0, 400, -30)},
                                         RealView{"sponza.glb",
                                                  {{800, 600, -35}, {-300, 120, -40}, {0, 1, 0}, 65, 480, 270},
                                                  along(0.35f, -1, -0.004f),
                                                  at(-200, 300, 0)},
                                         RealView{"lost_empire.glb",
                                                  {{34, 27, 72}, {-6, 20, 20}, {0, 1, 0}, 60, 480, 270},
                                                  along(0.9f, -0.12f, -0.35f),
                                                  at(10, 40, 40)},
                                         RealView{"lost_empire.glb",
                                                  {{-34, 58, 58}, {4, 22, 22}, {0, 1, 0}, 55, 480, 270},
                                                  along(0.9f, -0.12f, -0.35f),
                                                  at(0, 45, 30)}),
                         [](const auto& test) {
                             return std::filesystem::path(test.param.file).stem().string() + std::to_string(test.index);
                         });

}  // namespace
