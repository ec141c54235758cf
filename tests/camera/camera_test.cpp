// SPDX-License-Identifier: MIT
// Stage camera: what a view sees against the exact rays, triangle by triangle; what it promises of its points against
// the reference's judge.
#include "camera/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <limits>
#include <random>
#include <set>

#include "reference/predicates.hpp"
#include "reference/view.hpp"
#include "support/camera_scenes.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

gnomon::ViewOnHost look(const gnomon::Device& device, const CameraScene& scene) {
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
    return gnomon::look(device, triangles, scene.camera(), scene.width, scene.height).read(device, triangles);
}

struct Tally {
    std::uint64_t pixels = 0, sky = 0, contested = 0;
};

/// Of two hits nearer to each other than 2^-28 of their depth either may win (kernels/camera/camera.h).
constexpr long double SAME_DEPTH = 0x1p-28L;

/// Every pixel: the sky only if the exact ray meets nothing, else a triangle it meets, no farther than the nearest.
void check_nearest(const CameraScene& scene, const std::vector<std::uint32_t>& seen, Tally& tally) {
    SCOPED_TRACE(scene.name);
    const gnomon::CameraTables tables = gnomon::camera_tables(scene.camera(), scene.width, scene.height);
    for (std::uint32_t y = 0; y < scene.height; ++y)
        for (std::uint32_t x = 0; x < scene.width; ++x) {
            const auto met = reference::meetings(exact_ray(tables, x, y), scene.triangles);
            const std::uint32_t id = seen[std::size_t(y) * scene.width + x];
            ++tally.pixels;
            tally.sky += met.empty();
            ASSERT_EQ(id == gnomon::no_receiver, met.empty()) << "pixel " << x << ", " << y;
            if (met.empty()) continue;
            const auto found = std::find_if(met.begin(), met.end(), [&](const auto& m) { return m.id == id; });
            ASSERT_NE(found, met.end()) << "pixel " << x << ", " << y << " misses triangle " << id;
            EXPECT_LE(found->parameter, met[0].parameter * (1 + SAME_DEPTH))
                << "pixel " << x << ", " << y << " sees triangle " << id << " behind " << met[0].id;
            tally.contested += met.size() > 1 && met[1].parameter <= met[0].parameter * (1 + SAME_DEPTH);
        }
}

// Not vacuous: thousands of pixels see triangles, and hundreds lie exactly on an edge or a vertex of several.
TEST(Camera, EqualsReference) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const CameraScene& scene : camera_scenes()) check_nearest(scene, look(device, scene).receiver, tally);
    std::cout << tally.pixels << " pixels, " << tally.sky << " of sky, " << tally.contested << " with equal hits\n";
    EXPECT_GT(tally.pixels - tally.sky, 5000u);
    EXPECT_GT(tally.contested, 200u);
}

// From inside a closed mesh no ray escapes, whatever the tessellation and however the rays hit its edges. Not vacuous:
// a single triangle left out of the mesh lets some through.
TEST(Camera, ClosedMeshesHaveNoCracks) {
    const gnomon::Device device = device_with();
    for (const int subdivisions : {0, 2, 4})
        for (const Float3& eye : {Float3{0, 0, 0}, Float3{0.5f, 0.25f, -0.125f}, Float3{0, 0.7f, 0}}) {
            CameraScene scene{
                "inside", icosphere(subdivisions, 1), eye, {eye[0], eye[1], eye[2] - 1}, {0, 1, 0}, 90, 64, 64};
            const auto seen = look(device, scene).receiver;
            ASSERT_EQ(std::count(seen.begin(), seen.end(), gnomon::no_receiver), 0);
            const std::size_t missing = seen[32 * 64 + 32];
            scene.triangles.erase(scene.triangles.begin() + std::ptrdiff_t(9 * missing),
                                  scene.triangles.begin() + std::ptrdiff_t(9 * missing + 9));
            const auto holed = look(device, scene).receiver;
            EXPECT_GT(std::count(holed.begin(), holed.end(), gnomon::no_receiver), 0);
        }
}

// Every pixel's ray runs exactly through a corner of six triangles, so every pixel is covered six times, by closed
// triangles, and by none if edges were open. Not vacuous: that it is so is checked with the exact rays.
TEST(Camera, WatertightWhereCornersArePixelCentres) {
    const gnomon::Device device = device_with();
    for (const std::uint32_t height : {1u, 2u, 16u, 32u})
        for (const std::uint32_t width : {1u, 15u, 16u, 17u, 33u}) {
            const CameraScene scene = lattice_view(width, height);
            SCOPED_TRACE(scene.name);
            const auto seen = look(device, scene).receiver;
            EXPECT_EQ(std::count(seen.begin(), seen.end(), gnomon::no_receiver), 0);
            const gnomon::CameraTables tables = gnomon::camera_tables(scene.camera(), width, height);
            EXPECT_EQ(reference::meetings(exact_ray(tables, width - 1, 0), scene.triangles).size(), 6u);
        }
}

// Copies of one triangle hit at bit-equal depth: the smaller id is seen. Not vacuous: each pixel has three copies, and
// the copies come in falling order of size of their lists' slots as well.
TEST(Camera, SmallestOfCoincidentIdsIsSeen) {
    const gnomon::Device device = device_with();
    const Floats ball = icosphere(1, 1);
    CameraScene scene{"copies", ball, {0.3f, 0.4f, 2}, {0, 0, 0}, {0, 1, 0}, 50, 48, 48};
    const auto once = look(device, scene).receiver;
    append(scene.triangles, ball);
    append(scene.triangles, ball);
    EXPECT_EQ(look(device, scene).receiver, once);
    EXPECT_LT(std::count(once.begin(), once.end(), gnomon::no_receiver), 48 * 48 / 2);
}

// Not vacuous: the order decides in which sequence a pixel meets its triangles; where hits are not equal the same one
// must win.
TEST(Camera, OrderFree) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const CameraScene& scene : camera_scenes()) {
        CameraScene shuffled = scene;
        const auto order = shuffled_order(scene.triangles.size() / 9, 121);
        for (std::size_t i = 0; i < scene.triangles.size(); ++i)
            shuffled.triangles[i] = scene.triangles[9 * order[i / 9] + i % 9];
        check_nearest(shuffled, look(device, shuffled).receiver, tally);
        CameraScene reversed = scene;
        reversed.triangles = reversed_winding(scene.triangles);
        check_nearest(reversed, look(device, reversed).receiver, tally);
    }
}

bool same_bits(const gnomon::ViewOnHost& a, const gnomon::ViewOnHost& b) {
    const auto same = [](const std::vector<float>& u, const std::vector<float>& v) {
        return u.size() == v.size() && std::memcmp(u.data(), v.data(), u.size() * sizeof(float)) == 0;
    };
    return same(a.position, b.position) && same(a.normal, b.normal) && a.receiver == b.receiver;
}

// Not vacuous: sizes that are no multiple of a tile, and ties that only a fixed rule decides.
TEST(Camera, ShapeFree) {
    std::vector<CameraScene> scenes = camera_scenes();
    scenes.resize(6);
    const gnomon::Device plain = device_with();
    std::vector<gnomon::ViewOnHost> wanted;
    for (const CameraScene& scene : scenes) wanted.push_back(look(plain, scene));
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) {
        const gnomon::Device device = device_with(group);
        for (std::size_t i = 0; i < scenes.size(); ++i)
            EXPECT_TRUE(same_bits(look(device, scenes[i]), wanted[i]))
                << scenes[i].name << ", work-groups of " << group;
    }
}

// Not vacuous: without double precision all of it is done by integers, from denormals to 1e7, and every bit is
// compared.
TEST(Camera, SameBitsWithoutDoublePrecision) {
    const gnomon::Device with = device_with(), without({}, {.hide_fp64 = true});
    EXPECT_FALSE(session_of(without).has_fp64());
    for (const CameraScene& scene : camera_scenes())
        EXPECT_TRUE(same_bits(look(without, scene), look(with, scene))) << scene.name;
}

// Not vacuous: the reference judges thousands of points whose lift and rounding depend on scale, distance and angle.
TEST(Camera, PointsKeepTheirPromises) {
    const gnomon::Device device = device_with();
    std::uint64_t judged = 0;
    for (const CameraScene& scene : camera_scenes()) {
        SCOPED_TRACE(scene.name);
        const gnomon::ViewOnHost view = look(device, scene);
        const reference::PinholeCamera camera{scene.eye,           scene.target, scene.up,
                                              scene.fov_y_degrees, scene.width,  scene.height};
        const reference::ViewReport report = reference::judge_view(scene.triangles, camera, std::nullopt,
                                                                   {view.position, view.normal, view.receiver, {}});
        EXPECT_EQ(report.wrong_nearest.count, 0u);
        EXPECT_EQ(report.wrong_side.count, 0u);
        EXPECT_EQ(report.wrong_distance.count, 0u) << double(report.largest_distance_ulp) << " ulp";
        EXPECT_EQ(report.wrong_normal.count, 0u);
        EXPECT_EQ(report.wrong_sky.count, 0u);
        judged += report.pixels - report.sky;
    }
    EXPECT_GT(judged, 5000u);
}

/// Random points on the scene's triangles, rounded to float32, as a caller's own intersection code would make them.
struct PointsOnTriangles {
    Floats points;
    std::vector<std::uint32_t> receivers;
};
PointsOnTriangles points_on(const Floats& triangles, std::size_t each) {
    PointsOnTriangles places;
    Random random(131);
    for (std::size_t id = 0; id < triangles.size() / 9; ++id)
        for (std::size_t k = 0; k < each; ++k) {
            const double u = random.between(0, 1), v = random.between(0, 1) * (1 - u);
            for (std::size_t c = 0; c < 3; ++c) {
                const double a = triangles[9 * id + c], b = triangles[9 * id + 3 + c], d = triangles[9 * id + 6 + c];
                places.points.push_back(static_cast<float>(a + u * (b - a) + v * (d - a)));
            }
            places.receivers.push_back(static_cast<std::uint32_t>(id));
        }
    return places;
}

std::size_t count_under(const Floats& triangles, const Floats& points, const std::vector<std::uint32_t>& receivers,
                        const Float3& eye) {
    reference::Effort effort;
    std::size_t under = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const reference::Triangle t{vertex(triangles, 3 * receivers[i]), vertex(triangles, 3 * receivers[i] + 1),
                                    vertex(triangles, 3 * receivers[i] + 2)};
        const int eye_side = reference::side_of_point(eye, t, effort);
        under += eye_side != 0 && reference::side_of_point(vertex(points, i), t, effort) != eye_side;
    }
    return under;
}

// A caller's points: above their planes afterwards, by the exact predicate, and at most 9 ulps away. Not vacuous: about
// half of them are under their planes, or on them, before.
TEST(Camera, LiftedPointsLeaveTheirPlanes) {
    const gnomon::Device with = device_with(), without({}, {.hide_fp64 = true});
    std::size_t lifted_count = 0, under_before = 0;
    for (const CameraScene& scene : camera_scenes()) {
        SCOPED_TRACE(scene.name);
        const PointsOnTriangles places = points_on(scene.triangles, 10);
        const std::size_t count = places.receivers.size();
        Floats first;
        for (const gnomon::Device& device : {with, without}) {
            const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
            const auto points = gnomon::Points::upload(device, places.points, places.receivers);
            const gnomon::Points lifted = gnomon::lift(device, triangles, points, scene.eye);
            const Floats moved = downloaded<float>(session_of(device), lifted.positions(), 3 * count);
            EXPECT_EQ(count_under(scene.triangles, moved, places.receivers, scene.eye), 0u);
            for (std::size_t i = 0; i < count; ++i) {
                float size = 0;
                for (std::size_t c = 0; c < 3; ++c)
                    size = std::max({size, std::fabs(moved[3 * i + c]), std::fabs(scene.eye[c])});
                double squared = 0;
                for (std::size_t c = 0; c < 3; ++c)
                    squared += std::pow(double(moved[3 * i + c]) - places.points[3 * i + c], 2);
                const double ulp = std::ldexp(1.0, std::max(std::ilogb(size), -126) - 23);
                ASSERT_LE(std::sqrt(squared), 9 * ulp) << "point " << i;
            }
            if (first.empty()) first = moved;
            EXPECT_EQ(std::memcmp(first.data(), moved.data(), first.size() * sizeof(float)), 0) << "without fp64";
        }
        lifted_count += count;
        under_before += count_under(scene.triangles, places.points, places.receivers, scene.eye);
    }
    std::cout << lifted_count << " points, " << under_before << " of them not above their planes before\n";
    EXPECT_GT(under_before, lifted_count / 4);
}

// Who has no plane stays: no receiver, one that is no triangle, absent points.
TEST(Camera, LiftLeavesAloneWhatHasNoPlane) {
    const gnomon::Device device = device_with();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Floats scene;
    add(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    add(scene, {2, 2, 2}, {2, 2, 2}, {2, 2, 2});
    add(scene, {0, 0, 0}, {1, 0, nan}, {0, 1, 0});
    const auto triangles = gnomon::Triangles::upload(device, scene);
    const Floats places{0.25f, 0.25f, 0, 0.25f, 0.25f, 0, 2, 2, 2, 0.25f, 0.25f, 0, nan, 1, 2};
    const auto points =
        gnomon::Points::upload(device, places, std::vector<std::uint32_t>{0, gnomon::no_receiver, 1, 2, 0});
    const gnomon::Points lifted = gnomon::lift(device, triangles, points, {0, 0, -1});
    const Floats moved = downloaded<float>(session_of(device), lifted.positions(), places.size());
    EXPECT_LT(moved[2], 0) << "the first has one, and the eye is below";
    EXPECT_EQ(moved[0], places[0]);
    EXPECT_EQ(std::memcmp(&moved[3], &places[3], 9 * sizeof(float)), 0);
    EXPECT_TRUE(std::isnan(moved[12]));
    EXPECT_THROW(gnomon::lift(device, triangles, gnomon::Points::upload(device, places), {0, 0, -1}),
                 gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::lift(device, triangles, points, {0, nan, -1}), gnomon::InvalidArgument);
}

// Triangles that are no triangles, wholly behind the eye, through the eye, with the eye in their plane or at a vertex.
// Not vacuous: each stands in the middle of the view, in front of a wall that must be seen.
TEST(Camera, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    CameraScene scene{"degenerates", {}, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90, 31, 33};
    add(scene.triangles, {-1, -1, -1}, {1, -1, -1}, {0, 1, nan});
    add(scene.triangles, {-1, -1, -1}, {1, -1, -inf}, {0, 1, -1});
    add(scene.triangles, {0, 0, -1}, {0, 0, -1}, {0, 0, -1});
    add(scene.triangles, {-1, 0, -1}, {0, 0, -1}, {1, 0, -1});
    add(scene.triangles, {0, 0, 0}, {1, 0, -1}, {-1, 0, -1});
    add(scene.triangles, {-1, 0, -1}, {1, 0, -1}, {0, 0, 2});                              // the eye inside it
    add(scene.triangles, {-1, -1, 1}, {1, -1, 1}, {0, 1, 1});                              // behind
    add(scene.triangles, {-1e-45f, -1e-45f, -1}, {1e-45f, -1e-45f, -1}, {0, 1e-45f, -1});  // met by the centre's ray
    const auto wall = static_cast<std::uint32_t>(scene.triangles.size() / 9);
    add(scene.triangles, {-3e38f, -3e38f, -2e38f}, {3e38f, -3e38f, -2e38f}, {0, 3e38f, -2e38f});
    add(scene.triangles, {-9, 9, 5}, {9, 9, 5}, {0, -1, -9});  // straddles
    Tally tally;
    const auto seen = look(device, scene).receiver;
    check_nearest(scene, seen, tally);
    EXPECT_GT(std::count(seen.begin(), seen.end(), wall), 100);
    EXPECT_GT(std::count(seen.begin(), seen.end(), wall + 1), 50);
    EXPECT_EQ(seen[16 * 31 + 15], wall - 1) << "the smallest triangle there is covers the centre's ray exactly";
    scene.triangles.clear();
    const auto nothing = look(device, scene).receiver;
    EXPECT_EQ(std::count(nothing.begin(), nothing.end(), gnomon::no_receiver), 31 * 33);
}

// One pass looks at scene after scene, sizes and triangles changing, and the earlier views still exist. Not vacuous:
// the pass starts with lists for the smallest scene, and uses a dropped view's buffers again.
TEST(Camera, PassGivesTheBitsOfSingleLooks) {
    const gnomon::Device device = device_with();
    gnomon::CameraPass pass(device);
    std::vector<gnomon::View> views;
    std::vector<CameraScene> scenes = camera_scenes();
    std::ranges::sort(scenes, {}, [](const CameraScene& s) { return s.triangles.size(); });
    for (const CameraScene& scene : scenes) {
        const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
        views.push_back(pass.look(triangles, scene.camera(), scene.width, scene.height));
        EXPECT_TRUE(same_bits(views.back().read(device, triangles), look(device, scene))) << scene.name;
    }
    for (std::size_t i = 0; i < scenes.size(); ++i)
        EXPECT_EQ(views[i].points.read(device).receiver, look(device, scenes[i]).receiver) << scenes[i].name;
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scenes.back().triangles);
    const auto again = [&] { return pass.look(triangles, scenes.back().camera(), 64, 48); };
    const cl_mem buffer = again().points.positions();
    const gnomon::View kept = again();
    EXPECT_EQ(kept.points.positions(), buffer);
    EXPECT_NE(again().points.positions(), buffer);
}

// Triangles smaller than the distance between samples, everywhere in the pixels; some hold a sample. Not vacuous: the
// pixels' centres see some of them, and the 32 samples see others, which the lists of the centres may leave out.
TEST(Camera, SpecksBetweenSamples) {
    const gnomon::Device device = device_with();
    CameraScene scene{"specks", {}, {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40, 48, 48};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(-1.4f, 1.4f), size(-0.032f, 0.032f);
    for (int i = 0; i < 8000; ++i) {
        const float x = at(random), y = at(random), z = at(random);
        for (int k = 0; k < 3; ++k)
            for (const float c : {x, y, z}) scene.triangles.push_back(c + size(random));
    }
    Tally tally;
    const auto centres = look(device, scene).receiver;
    check_nearest(scene, centres, tally);
    EXPECT_GT(tally.sky, 100u);
    EXPECT_GT(tally.pixels - tally.sky, 500u);
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
    gnomon::CameraStage all(device), one(device);
    const auto pattern = gnomon::sample_pattern(32);
    gnomon::Statistics of_all, of_one;
    all.aim(triangles, scene.camera(), scene.width, scene.height, pattern);
    all.fit_lists(of_all);
    one.aim(triangles, scene.camera(), scene.width, scene.height, pattern.first(1));
    one.fit_lists(of_one);
    EXPECT_LT(of_one.count("references"), of_all.count("references") / 2);
    EXPECT_LE(of_all.count("references"), 4 * scene.triangles.size() / 9);
}

// Twenty thousand triangles within some eight pixels: the list of one tile is as long as the scene. Not vacuous: dozens
// of pixels see them, each a different one.
TEST(Camera, AllTrianglesInOneTile) {
    const gnomon::Device device = device_with();
    CameraScene scene{"one tile", {}, {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 20.6f, 32, 32};
    std::mt19937 random(9);
    std::uniform_real_distribution<float> at(-0.15f, 0.15f), depth(-1, 1), size(-0.03f, 0.03f);
    for (int i = 0; i < 20000; ++i) {
        const Float3 p{at(random) + 0.2f, at(random) + 0.2f, depth(random)};
        for (int k = 0; k < 3; ++k)
            for (const float c : p) scene.triangles.push_back(c + size(random));
    }
    Tally tally;
    const auto seen = look(device, scene).receiver;
    check_nearest(scene, seen, tally);
    EXPECT_GT(std::set(seen.begin(), seen.end()).size(), 50u);
    EXPECT_LT(tally.pixels - tally.sky, 400u);
}

// A million copies of one triangle: every comparison is a tie, and the first copy is seen; then a triangle before all
// of them, the last of the list. Each is looked at twice: what a list is called long by the first time sets the second.
TEST(Camera, MillionCoincidentTriangles) {
    const gnomon::Device device = device_with();
    CameraScene scene{"copies", {}, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 50, 48, 48};
    const Floats triangle{-0.9f, -0.8f, 0.1f, 0.9f, -0.7f, -0.2f, 0.05f, 0.85f, 0.3f};
    scene.triangles = triangle;
    const auto once = look(device, scene).receiver;
    for (int i = 1; i < 1'000'000; ++i) append(scene.triangles, triangle);
    gnomon::CameraPass pass(device);
    const auto expect_twice = [&](const std::vector<std::uint32_t>& receivers) {
        const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
        for (int i = 0; i < 2; ++i) {
            const gnomon::View view = pass.look(triangles, scene.camera(), scene.width, scene.height);
            EXPECT_EQ(view.points.read(device).receiver, receivers);
        }
    };
    expect_twice(once);
    EXPECT_GT(std::count(once.begin(), once.end(), 0u), 200);
    add(scene.triangles, {-9, -9, 1}, {9, -9, 1}, {0, 12, 1});
    expect_twice(std::vector<std::uint32_t>(once.size(), 1'000'000u));
}

// The last triangle stands before all others: whatever a tile's list has kept before is dropped.
TEST(Camera, LastTriangleHidesAll) {
    const gnomon::Device device = device_with();
    CameraScene scene{"hidden", soup(50000, 0.2f, 44), {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30, 96, 96};
    add(scene.triangles, {-9, -9, 3}, {9, -9, 3}, {0, 12, 3});
    const auto seen = look(device, scene).receiver;
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 50000u), 96 * 96);
    scene.triangles.resize(9 * 50000);
    const auto without = look(device, scene).receiver;
    EXPECT_GT(std::set(without.begin(), without.end()).size(), 1000u);
}

// The kernels themselves, with canaries behind what they write. Not vacuous: sizes that leave part of a tile over.
TEST(Camera, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const CameraScene scene = camera_scenes().front();
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::TriangleInputs inputs = gnomon::triangle_inputs(triangles);
    const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
    const std::size_t pixels = std::size_t(scene.width) * scene.height;
    const gnomon::CameraTables tables = gnomon::camera_tables(scene.camera(), scene.width, scene.height);
    const gnomon::cl::Buffer rays = uploaded(session, tables.rays);
    gnomon::cl::Buffer positions(session, (pixels * 3 + 8) * sizeof(float));
    gnomon::cl::Buffer normals(session, (pixels * 3 + 8) * sizeof(float));
    put_canaries(session, positions);
    put_canaries(session, normals);
    gnomon::CameraParams params{};
    params.triangles = inputs;
    std::copy(scene.eye.begin(), scene.eye.end(), params.eye);
    params.width = scene.width;
    params.height = scene.height;
    params.point_count = cl_uint(pixels);
    const auto range = gnomon::cl::Range::shares(pixels);
    const gnomon::cl::Buffer counters = uploaded(session, std::vector<gnomon::FrameCounters>{gnomon::FrameCounters{}});
    session.launch("camera/camera.cl", "camera_points", range, params, inputs.vertices, rays, view.points.receivers(),
                   positions, counters);
    session.launch("camera/camera.cl", "camera_normals", range, params, inputs.vertices, view.points.receivers(),
                   normals);
    expect_canaries(session, positions, pixels * 3 * sizeof(float), "positions");
    expect_canaries(session, normals, pixels * 3 * sizeof(float), "normals");
}

}  // namespace
