// SPDX-License-Identifier: MIT
// Diagnostics of shadow maps: the aliasing error against its figure worked out on paper, and
// what the pictures show.
#include "rivals/shadow_map/diagnostic.hpp"

#include <gtest/gtest.h>

#include "support/map_fits.hpp"

namespace {

using namespace support;

gnomon::MapDiagnostic draw(Scene& scene, const gnomon::Light& light, const Settings& settings, cl_uint diagnostic,
                           std::uint32_t size) {
    gnomon::ViewFit stage;
    for (const auto& [name, value] : settings) stage.set(name, value);
    gnomon::cl::Session& session = session_of(scene.device);
    const auto visibility = uploaded(session, std::vector<float>(scene.view.points.count(), 1.0f));
    const gnomon::FitInputs inputs{gnomon::triangle_inputs(scene.triangles), gnomon::point_inputs(scene.view.points),
                                   visibility.get(), light, scene.view.points.camera()};
    gnomon::MapViews map_views;
    stage.run(session, inputs, size, map_views);
    return gnomon::run_map_diagnostic(session, diagnostic, inputs, map_views);
}

/// Two triangles, seen at an angle; every pixel meets them.
Scene floor_scene() {
    Scene scene(gnomon::Camera::look_at({0, 10, 40}, {0, 0, 0}, {0, 1, 0}, 12));
    Floats floor;
    add(floor, {-200, 0, -200}, {200, 0, -200}, {200, 0, 200});
    add(floor, {-200, 0, -200}, {200, 0, 200}, {-200, 0, 200});
    scene.triangles = gnomon::Triangles::upload(scene.device, floor);
    scene.view = gnomon::look(scene.device, scene.triangles, scene.camera, 96, 64);
    return scene;
}

// Slides 23-29 for a directional light and an orthographic map: on a plane the footprint of a pixel along the view is
// (pixel width at distance d, across the ray) / cos psi_e, psi_e between ray and normal; that of a texel is
// (texel width across the light) / cos psi_l. Their ratio is the error m; across the view neither is stretched. The
// light travels in the plane of the view, so both directions are axes of map and picture.
TEST(Diagnostic, AliasingErrorIsTheAnalyticFigure) {
    Scene scene = floor_scene();
    const double tilt = 0.6;  // of the light, from straight down towards the camera's far side
    const auto light = gnomon::Light::directional({0, float(-std::cos(tilt)), float(-std::sin(tilt))});
    const std::uint32_t size = 512;
    const Settings settings{{"fit", "casters"}};
    const MapView view = fit(scene, light, settings, size).views.at(0);
    const auto drawn = draw(scene, light, settings, DIAGNOSTIC_ALIASING, size);
    const gnomon::ViewOnHost host = scene.view.read(scene.device, scene.triangles);
    const double step = 2 * scene.tangent_up() / 64;
    for (const std::uint32_t row : {2u, 20u, 40u, 61u}) {
        const std::size_t pixel = row * 96 + 48;
        const Double3 p = to_double(&host.position[3 * pixel]);
        const double x = p[0] - scene.camera.eye[0], y = p[1] - scene.camera.eye[1], z = p[2] - scene.camera.eye[2];
        const double distance = std::sqrt(x * x + y * y + z * z), depth = scene.depth(p);
        // A pixel subtends less away from the middle: its width across the ray by the cosine to the axis, along y.
        const double cos_axis = depth / distance, cos_view = -y / distance, cos_light = std::cos(tilt);
        const double pixel_along = step * depth * cos_axis / cos_view;
        const double pixel_across = step * depth;
        const double texel_u = 1 / (slope(view, view.row_u, 0.5, p) * size),
                     texel_v = 1 / (slope(view, view.row_v, 0.5, p) * size) / cos_light;
        const double along = pixel_along / texel_v, across = pixel_across / texel_u;
        EXPECT_NEAR(drawn.texels_per_pixel[pixel], std::hypot(along, across), 0.02 * std::hypot(along, across));
    }
}

// One texel to a pixel is green; finer is blue, coarser red.
TEST(Diagnostic, ColoursGradeTexelsPerPixel) {
    Scene scene = floor_scene();
    const auto light = gnomon::Light::directional({0.1f, -1, 0.1f});
    const auto coarse = draw(scene, light, {}, DIAGNOSTIC_ALIASING, 16),
               fine = draw(scene, light, {}, DIAGNOSTIC_ALIASING, 4096);
    const std::size_t pixel = 32 * 96 + 48;
    EXPECT_LT(coarse.texels_per_pixel[pixel], 1);
    EXPECT_GT(fine.texels_per_pixel[pixel], 1);
    EXPECT_GT(coarse.colors[3 * pixel], coarse.colors[3 * pixel + 2]) << "red before blue";
    EXPECT_LT(fine.colors[3 * pixel], fine.colors[3 * pixel + 2]) << "blue before red";
    // Twice the texels, twice the error.
    const auto finer = draw(scene, light, {{"fit", "casters"}}, DIAGNOSTIC_ALIASING, 1024),
               half = draw(scene, light, {{"fit", "casters"}}, DIAGNOSTIC_ALIASING, 512);
    EXPECT_NEAR(finer.texels_per_pixel[pixel] / half.texels_per_pixel[pixel], 2, 0.02);
}

// LogPSM is made to even out what uniform maps leave: its errors over the picture vary less.
TEST(Diagnostic, ShowsThatWarpsEvenTheErrorOut) {
    Scene scene;
    const auto light = gnomon::Light::directional({-1, -1, 0});
    const auto variation = [&](const char* projection) {
        const auto drawn = draw(scene, light, {{"projection", projection}}, DIAGNOSTIC_ALIASING, 512);
        std::vector<float> errors;
        for (const float error : drawn.texels_per_pixel)
            if (error > 0) errors.push_back(error);
        std::sort(errors.begin(), errors.end());
        return errors[errors.size() * 95 / 100] / errors[errors.size() * 5 / 100];
    };
    EXPECT_LT(variation("logpsm"), 0.7 * variation("uniform"));
}

TEST(Diagnostic, ViewsHaveTheirOwnColours) {
    Scene scene;
    const auto drawn = draw(scene, gnomon::Light::directional({0, -1, 0}), {{"cascades", "4"}}, DIAGNOSTIC_VIEWS, 128);
    std::vector<std::pair<int, int>> hues;
    for (std::size_t i = 0; i < drawn.texels_per_pixel.size(); ++i) {
        if (drawn.texels_per_pixel[i] == 0) continue;
        const float* c = &drawn.colors[3 * i];
        hues.emplace_back(std::lround(20 * c[0] / (c[1] + c[2])), std::lround(20 * c[1] / (c[0] + c[2])));
    }
    std::sort(hues.begin(), hues.end());
    hues.erase(std::unique(hues.begin(), hues.end()), hues.end());
    EXPECT_EQ(hues.size(), 4u);
}

// Green is as dense as without a warp: half of red and blue at either end. Its checkerboard darkens, which the ratio of
// two channels does not see.
struct Hues {
    std::size_t green = 0, red = 0, blue = 0;
};
Hues hues_of(const gnomon::MapDiagnostic& drawn) {
    Hues hues;
    for (std::size_t i = 0; i < drawn.texels_per_pixel.size(); ++i) {
        if (drawn.texels_per_pixel[i] == 0) continue;
        const float* c = &drawn.colors[3 * i];
        ++(c[0] > 0.1f * c[1] ? (c[2] > c[0] ? hues.blue : hues.red) : c[2] > 0.1f * c[1] ? hues.blue : hues.green);
    }
    return hues;
}

TEST(Diagnostic, WarpIsGreenWhereThereIsNone) {
    Scene scene;
    const auto light = gnomon::Light::directional({0.2f, -1, 0.3f});
    const Hues plain = hues_of(draw(scene, light, {}, DIAGNOSTIC_WARP, 256));
    EXPECT_GT(plain.green, 1000u);
    EXPECT_EQ(plain.red + plain.blue, 0u);
    // A warp gives to some what it takes from others.
    for (const Settings& settings : {Settings{{"warp", "backward"}}, Settings{{"projection", "logpsm"}}}) {
        const Hues warped = hues_of(draw(scene, light, settings, DIAGNOSTIC_WARP, 256));
        EXPECT_GT(warped.red, 50u) << settings[0].second;
        EXPECT_GT(warped.blue, 50u) << settings[0].second;
    }
}

// The 32 x 32 cells hold the map's texels in equal numbers: two pixels are of one colour of the board exactly if their
// texels, found from the views on the host, lie in cells of one kind.
TEST(Diagnostic, WarpShowsEqualSharesOfTheMap) {
    Scene scene;
    const auto light = gnomon::Light::directional({0.2f, -1, 0.3f});
    const Settings settings{{"fit", "casters"}};
    const MapView view = fit(scene, light, settings, 512).views.at(0);
    const auto drawn = draw(scene, light, settings, DIAGNOSTIC_WARP, 512);
    const gnomon::ViewOnHost host = scene.view.read(scene.device, scene.triangles);
    std::size_t dark = 0, light_ones = 0;
    for (std::size_t i = 0; i < drawn.texels_per_pixel.size(); ++i) {
        if (drawn.texels_per_pixel[i] == 0 || drawn.texels_per_pixel[i] > 4) continue;  // far less than a cell's 16
        const SceneBox at = place(view, to_double(&host.position[3 * i]));
        const double x = at.u * 32, y = at.v * 32;
        if (std::fabs(x - std::round(x)) < 0.01 || std::fabs(y - std::round(y)) < 0.01) continue;
        const bool is_dark = (int(x) + int(y)) % 2 != 0;
        ASSERT_NEAR(drawn.colors[3 * i + 1], is_dark ? 0.6 : 1.0, 1e-6) << "pixel " << i;
        ++(is_dark ? dark : light_ones);
    }
    EXPECT_GT(dark, 200u);
    EXPECT_GT(light_ones, 200u);
}

// As the command asks for it: the technique's own views, four bytes per pixel, opaque; a sentence where there is none.
TEST(Diagnostic, TechniquesDrawTheirOwn) {
    Scene scene;
    const auto light = gnomon::Light::directional({0.3f, -1, 0});
    const auto technique = gnomon::make_technique("sdsm", scene.device);
    const auto views = technique->diagnose("views", scene.triangles, scene.view.points, light);
    const auto drawn = draw(scene, light, {{"cascades", "4"}, {"lambda", "1"}}, DIAGNOSTIC_VIEWS, 1024);
    ASSERT_EQ(views.size(), 4 * scene.view.points.count());
    std::size_t same = 0;
    for (std::size_t i = 0; i < scene.view.points.count(); ++i) {
        EXPECT_EQ(views[4 * i + 3], 255);
        same += views[4 * i] == std::lround(255 * drawn.colors[3 * i]);
    }
    // Points that face away take part in the fit above, and not in the technique's: slices differ a little.
    EXPECT_GT(same, scene.view.points.count() * 9 / 10);
    EXPECT_THROW(technique->diagnose("smell", scene.triangles, scene.view.points, light), gnomon::InvalidArgument);
    const auto bare = gnomon::Points::upload(scene.device, scene.positions);
    EXPECT_THROW(technique->diagnose("grid", scene.triangles, bare, light), gnomon::InvalidArgument);
    const auto exact = gnomon::make_technique("frustum-traced", scene.device);
    EXPECT_THROW(exact->diagnose("grid", scene.triangles, scene.view.points, light), gnomon::InvalidArgument);
}

// What techniques() lists can be drawn, and the sentence for any other name tells of it.
TEST(Diagnostic, WhatIsListedCanBeDrawn) {
    Scene scene;
    const auto light = gnomon::Light::directional({0.3f, -1, 0});
    std::string sentence;
    try {
        gnomon::make_technique("shadow-volumes", scene.device)
            ->diagnose("smell", scene.triangles, scene.view.points, light);
    } catch (const gnomon::InvalidArgument& error) {
        sentence = error.what();
    }
    for (const gnomon::TechniqueDescription& technique : gnomon::techniques())
        for (const gnomon::DiagnosticDescription& diagnostic : technique.diagnostics) {
            EXPECT_NE(sentence.find(diagnostic.name), std::string::npos) << sentence;
            if (technique.name != "frustum-traced" && technique.name != "shadow-map" &&
                technique.name != "virtual-shadow-map")
                continue;  // presets of shadow-map
            EXPECT_NE(sentence.find(technique.name), std::string::npos) << sentence;
            const auto drawn = gnomon::make_technique(technique.name, scene.device)
                                   ->diagnose(diagnostic.name, scene.triangles, scene.view.points, light);
            EXPECT_EQ(drawn.size(), 4 * scene.view.points.count()) << technique.name << " " << diagnostic.name;
        }
}

}  // namespace
