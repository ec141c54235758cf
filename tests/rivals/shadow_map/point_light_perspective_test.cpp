// SPDX-License-Identifier: MIT
// Stage point_light_perspective: LiSPSM on the faces of a point light's cube. That every fit holds all points and what
// casts on them is projection_test's; here, when faces are warped, and that it pays where it should.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "support/map_fits.hpp"

namespace {

using namespace support;

const Settings lispsm{{"projection", "lispsm"}};

std::size_t warped_faces(const Fitted& fitted) {
    std::size_t count = 0;
    for (const MapView& view : fitted.views) count += view.width != 0 && view.face != NO_FACE;
    return count;
}

/// Points that the technique has on the wrong side of one half.
std::size_t wrong_points(const Scene& scene, const gnomon::Light& light, const char* technique, const char* size) {
    const auto mask_of = [&](const char* name, const char* texels) {
        const auto made = gnomon::make_technique(name, scene.device);
        if (texels != nullptr) made->set("size", texels);
        const gnomon::Visibility visibility(scene.device, scene.view.points.count());
        made->run(scene.triangles, scene.view.points, light, visibility);
        return visibility.read();
    };
    const std::vector<float> truth = mask_of("frustum-traced", nullptr), mask = mask_of(technique, size);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) wrong += (mask[i] < 0.5f) != (truth[i] < 0.5f);
    return wrong;
}

/// Low over a floor of 240 m, looking along it, with slabs over it that look alike from near to far.
Scene along_the_floor() {
    Scene scene(gnomon::Camera::look_at({0, 1.7f, 2}, {0, 1, -60}, {0, 1, 0}, 50));
    Floats vertices;
    add(vertices, {-120, 0, -240}, {120, 0, -240}, {120, 0, 10});
    add(vertices, {-120, 0, -240}, {120, 0, 10}, {-120, 0, 10});
    Random random(8);
    for (int i = 0; i < 120; ++i) {
        const float away = std::exp(random.between(0.7f, 4.8f)), width = away * random.between(0.02f, 0.1f);
        const float x = away * random.between(-0.6f, 0.6f), y = random.between(0.1f, 0.6f), z = 2 - away;
        add(vertices, {x, y, z}, {x + width, y, z}, {x + width, y, z - width});
        add(vertices, {x, y, z}, {x + width, y, z - width}, {x, y, z - width});
    }
    scene.vertices = vertices;
    scene.triangles = gnomon::Triangles::upload(scene.device, vertices);
    scene.view = gnomon::look(scene.device, scene.triangles, scene.camera, 480, 320);
    return scene;
}

// A mast far down the floor: near the camera a pixel covers little floor, and the plain face's texels are wide there.
TEST(PointLightPerspective, LessIsWrongWhereTheViewLooksAlongTheFloor) {
    const Scene scene = along_the_floor();
    for (const auto& light : {gnomon::Light::point({3, 60, -70}), gnomon::Light::point({-30, 40, -120})}) {
        for (const char* size : {"256", "1024"}) {
            const std::size_t plain = wrong_points(scene, light, "shadow-map", size),
                              warped = wrong_points(scene, light, "lispsm", size);
            EXPECT_GT(plain, 100u) << "nothing to win";
            EXPECT_LT(double(warped), 0.75 * double(plain)) << size;
        }
    }
}

TEST(PointLightPerspective, ErrorFallsWithResolutionTowardsTheTruth) {
    const Scene scene = along_the_floor();
    const auto light = gnomon::Light::point({3, 60, -70});
    const std::size_t coarse = wrong_points(scene, light, "lispsm", "128"),
                      middle = wrong_points(scene, light, "lispsm", "512"),
                      fine = wrong_points(scene, light, "lispsm", "2048");
    EXPECT_GT(coarse, 1000u);
    EXPECT_LT(double(middle), double(coarse) / 2);
    EXPECT_LT(double(fine), double(middle) / 2);
}

// A point light at the eye before a wall across the view sees what the camera sees: texels are as even as pixels, and
// nothing is to be won. The map is the plain one, to the bit.
TEST(PointLightPerspective, APointLightAtTheEyeKeepsItsPlainFaces) {
    Scene scene(gnomon::Camera::look_at({0, 0, 20}, {0, 0, 0}, {0, 1, 0}, 50));
    Floats wall;
    add(wall, {-60, -60, 0}, {60, -60, 0}, {60, 60, 0});
    add(wall, {-60, -60, 0}, {60, 60, 0}, {-60, 60, 0});
    scene.triangles = gnomon::Triangles::upload(scene.device, wall);
    scene.view = gnomon::look(scene.device, scene.triangles, scene.camera, 96, 64);
    const auto at_the_eye = gnomon::Light::point({0, 0, 20}), aside = gnomon::Light::point({60, 3, 2});
    const Fitted plain = fit(scene, at_the_eye, {}), warped = fit(scene, at_the_eye, lispsm);
    ASSERT_EQ(warped.views.size(), plain.views.size());
    for (std::size_t face = 0; face < plain.views.size(); ++face)
        EXPECT_EQ(std::memcmp(&warped.views[face], &plain.views[face], sizeof(MapView)), 0) << face;
    EXPECT_GT(warped_faces(fit(scene, aside, lispsm)), 0u) << "no point light would warp";
}

/// Which of the colours of diagnostic "views" (diagnostic_colors.h) is this, however dark?
int view_of(const std::uint8_t* color) {
    constexpr double colors[6][3] = {{0.9, 0.3, 0.25}, {0.95, 0.75, 0.2}, {0.4, 0.75, 0.3},
                                     {0.25, 0.7, 0.8}, {0.3, 0.4, 0.9},   {0.65, 0.35, 0.8}};
    int best = 0;
    double most = 0;
    for (int i = 0; i < 6; ++i) {
        const auto& c = colors[i];
        const double along = (color[0] * c[0] + color[1] * c[1] + color[2] * c[2]) / std::hypot(c[0], c[1], c[2]);
        if (along > most) most = along, best = i;
    }
    return best;
}

// A warped face's map reaches beyond the face; what lies there is another's all the same.
TEST(PointLightPerspective, PointsAreServedByTheirOwnFace) {
    const Scene scene = along_the_floor();
    const gnomon::ViewOnHost host = scene.view.read(scene.device, scene.triangles);
    const Double3 position{3, 60, -70};
    const auto technique = gnomon::make_technique("lispsm", scene.device);
    const std::vector<std::uint8_t> colors =
        technique->diagnose("views", scene.triangles, scene.view.points, gnomon::Light::point({3, 60, -70}));
    std::array<std::size_t, 6> served{}, astray{};
    for (std::size_t i = 0; i < host.receiver.size(); ++i) {
        if (host.receiver[i] == gnomon::no_receiver) continue;
        Double3 d;
        for (std::size_t c = 0; c < 3; ++c) d[c] = double(host.position[3 * i + c]) - position[c];
        int axis = 0;
        for (int c = 1; c < 3; ++c)
            if (std::fabs(d[c]) > std::fabs(d[axis])) axis = c;
        // Near an edge two faces may serve; what is all but black faces away.
        if (std::max(std::fabs(d[(axis + 1) % 3]), std::fabs(d[(axis + 2) % 3])) > 0.99 * std::fabs(d[axis])) continue;
        if (std::max({colors[4 * i], colors[4 * i + 1], colors[4 * i + 2]}) < 40) continue;
        const int face = 2 * axis + (d[axis] < 0 ? 1 : 0);
        ++(view_of(&colors[4 * i]) == face ? served : astray)[face];
    }
    EXPECT_EQ(astray, (std::array<std::size_t, 6>{}));
    EXPECT_GE(std::ranges::count_if(served, [](std::size_t count) { return count > 100; }), 3);
}

// Without a camera there is nothing to follow, and faces that are not fitted to receivers are plain.
TEST(PointLightPerspective, WarpsOnlyWhatFollowsTheReceivers) {
    Scene scene;
    const auto point_light = gnomon::Light::point({1, 6, 4});
    EXPECT_GT(warped_faces(fit(scene, point_light, lispsm)), 0u);
    EXPECT_EQ(warped_faces(fit(scene, point_light, lispsm, 256, false)), 0u);
    EXPECT_EQ(warped_faces(fit(scene, point_light, {{"projection", "lispsm"}, {"fit", "frustum"}})), 0u);
    EXPECT_EQ(warped_faces(fit(scene, point_light, {})), 0u);
}

// Sums have one order: the same map for every work-group size.
TEST(PointLightPerspective, IsTheSameForEveryWorkGroupSize) {
    std::vector<MapView> first;
    for (const std::uint32_t work_group_size : FEW_WORK_GROUP_SIZES) {
        Scene scene(device_with(work_group_size));
        const auto views = fit(scene, gnomon::Light::point({1, 6, 4}), lispsm).views;
        if (first.empty()) first = views;
        for (std::size_t face = 0; face < first.size(); ++face)
            EXPECT_EQ(std::memcmp(&views[face], &first[face], sizeof(MapView)), 0) << face;
    }
}

}  // namespace
