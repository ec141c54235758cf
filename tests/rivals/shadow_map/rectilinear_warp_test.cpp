// SPDX-License-Identifier: MIT
// Warped shadow maps: rectilinear tables against importance counted here, warps against their inverses, and the depth
// pass under both warps against rays through texel centres, one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "kernels/rivals/shadow_map/rectilinear_warp.h"
#include "rivals/shadow_map/depth_pass.hpp"
#include "support/map_fits.hpp"

namespace {

using namespace support;

const gnomon::Light slant = gnomon::Light::directional({-0.5f, -1, 0.3f});

std::span<const float> table_of(const Fitted& fitted, const MapView& view, int axis) {
    return std::span(fitted.tables).subspan(view.forward_first + axis * (view.warp_size + 1), view.warp_size + 1);
}

/// A view whose every cell sees the floor, from as far as it sees any other: nothing there is more important.
Scene flat_scene(float x = 0, float z = 0) {
    Scene scene(gnomon::Camera::look_at({x, 50, z}, {x, 0, z}, {0, 0, -1}, 20));
    Floats floor;
    add(floor, {-60, 0, -60}, {60, 0, -60}, {60, 0, 60});
    add(floor, {-60, 0, -60}, {60, 0, 60}, {-60, 0, 60});
    scene.triangles = gnomon::Triangles::upload(scene.device, floor);
    scene.view = gnomon::look(scene.device, scene.triangles, scene.camera, 600, 400);
    return scene;
}

TEST(RectilinearWarp, FlatImportanceIsThePlainMap) {
    Scene scene = flat_scene();
    const auto down = gnomon::Light::directional({0, -1, 0});
    for (const char* analysis : {"backward", "forward", "hybrid"}) {
        SCOPED_TRACE(analysis);
        const Fitted fitted = fit(scene, down, {{"warp", analysis}, {"importance", "view"}});
        const MapView& view = fitted.views.at(0);
        ASSERT_EQ(view.warp, WARP_RECTILINEAR);
        for (int axis = 0; axis < 2; ++axis) {
            const auto table = table_of(fitted, view, axis);
            for (std::size_t i = 0; i < table.size(); ++i) ASSERT_NEAR(table[i], double(i) / WARP_SEGMENTS, 2e-6);
        }
    }
}

// The definition, by the host in double: largest importance per column and row, blurred, summed.
TEST(RectilinearWarp, TexelsAreSharedInProportionToImportance) {
    Scene scene;
    const Fitted fitted = fit(scene, slant, {{"warp", "backward"}, {"importance", "view+distance"}});
    const MapView& view = fitted.views.at(0);
    double farthest = 0;
    for (std::size_t i = 0; i < scene.positions.size(); i += 3)
        farthest = std::max(farthest, scene.depth(to_double(&scene.positions[i])));
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> lines(WARP_SEGMENTS), shares(WARP_SEGMENTS);
        for (std::size_t i = 0; i < scene.positions.size(); i += 3) {
            const Double3 p = to_double(&scene.positions[i]);
            const SceneBox at = place(view, p);
            double& line = lines[std::size_t((axis == 0 ? at.u : at.v) * WARP_SEGMENTS)];
            line = std::max(line, 1 - scene.depth(p) / farthest);
        }
        double sum = 0;
        for (int i = 0; i < int(WARP_SEGMENTS); ++i) {
            double weights = 0;
            for (int k = -BLUR_REACH; k <= BLUR_REACH; ++k) {
                const double weight = std::exp(-k * k / (2.0 * BLUR_SIGMA * BLUR_SIGMA));
                shares[i] += weight * lines[std::clamp(i + k, 0, int(WARP_SEGMENTS) - 1)];
                weights += weight;
            }
            shares[i] /= weights;
        }
        const double largest = *std::max_element(shares.begin(), shares.end());
        for (double& share : shares) sum += share = std::max(share, MIN_IMPORTANCE * largest);
        const auto table = table_of(fitted, view, axis);
        EXPECT_EQ(table.front(), 0);
        EXPECT_EQ(table.back(), 1);
        // A point on the border of two cells may count for either: a hundredth of the mean share.
        for (int i = 0; i < int(WARP_SEGMENTS); ++i)
            EXPECT_NEAR(table[i + 1] - table[i], shares[i] / sum, 0.01 / WARP_SEGMENTS) << axis << " " << i;
    }
}

/// Texels per cell where p lies, along an axis; 1 is the plain map's.
double density(const Fitted& fitted, int axis, const Double3& p) {
    const MapView& view = fitted.views.at(0);
    const auto table = table_of(fitted, view, axis);
    const SceneBox at = place(view, p);
    const auto cell = std::size_t((axis == 0 ? at.u : at.v) * WARP_SEGMENTS);
    return (table[cell + 1] - table[cell]) * WARP_SEGMENTS;
}

// The light finds out what the camera sees: of a map over the whole floor, the part in the view. 50 m up with 20
// degrees, that is 8.8 m to both sides along z and 13.2 m along x.
TEST(RectilinearWarp, ForwardAnalysisKnowsWhatIsInView) {
    const double x = 17, z = -14;  // not in the middle of the map: neither axis may be mirrored
    Scene scene = flat_scene(float(x), float(z));
    const auto down = gnomon::Light::directional({0, -1, 0});
    const Fitted fitted = fit(scene, down, {{"warp", "forward"}, {"importance", "view"}, {"fit", "casters"}});
    // The map's axes follow the picture: u along its right, x, and v along its up, z.
    for (const float side : {-1.0f, 1.0f}) {
        const double inside_u = density(fitted, 0, {x + 11 * side, 0, z}),
                     outside_u = density(fitted, 0, {x + 20 * side, 0, z});
        const double inside_v = density(fitted, 1, {x, 0, z + 6.5 * side}),
                     outside_v = density(fitted, 1, {x, 0, z + 16 * side});
        EXPECT_NEAR(outside_u / inside_u, MIN_IMPORTANCE, 0.01);
        EXPECT_NEAR(outside_v / inside_v, MIN_IMPORTANCE, 0.01);
    }
}

// What forward analysis adds: columns and rows in which a post stands before the floor get more texels than the others.
TEST(RectilinearWarp, ShadowEdgesDrawTexels) {
    Scene scene = flat_scene();
    Floats with_post;
    add(with_post, {-60, 0, -60}, {60, 0, -60}, {60, 0, 60});
    add(with_post, {-60, 0, -60}, {60, 0, 60}, {-60, 0, 60});
    add(with_post, {4, 9, 2}, {5, 9, 2}, {4, 9, 3});
    scene.triangles = gnomon::Triangles::upload(scene.device, with_post);
    const auto down = gnomon::Light::directional({0, -1, 0});
    for (const char* analysis : {"forward", "hybrid"}) {
        const Fitted fitted = fit(scene, down, {{"warp", analysis}, {"importance", "view+edge"}});
        for (int axis = 0; axis < 2; ++axis) {
            const double drawn = density(fitted, axis, {4.3, 9, 2.3}), plain = density(fitted, axis, {-4.3, 9, -2.3});
            EXPECT_GT(drawn / plain, 1 + 0.8 * EDGE_GAIN) << analysis;
            EXPECT_LT(drawn / plain, 1 + 1.01 * EDGE_GAIN) << analysis;
        }
    }
}

// Texel centres are the warp's inverse: for the logarithm by the constants of Lloyd's dissertation (2007, eq. 6.4),
//   t = c0 log(c1 y + c2),  v = d0 e^(d1 t) + d2,  with y from y0 to y1 where v goes from 0 to 1.
TEST(RectilinearWarp, TexelCentresAreTheInverseOfTheWarp) {
    Scene scene;
    const Fitted log = fit(scene, slant, {{"projection", "logpsm"}}), tables = fit(scene, slant, {{"warp", "hybrid"}});
    const MapView& view = log.views.at(0);
    ASSERT_EQ(view.warp, WARP_LOGARITHMIC);
    const double y0 = -1, y1 = 1, c1 = view.log_strength / (y1 - y0), c2 = 1 - c1 * y0,
                 c0 = 1 / std::log1p(view.log_strength);
    const double d0 = 1 / (c1 * (y1 - y0)), d1 = 1 / c0, d2 = -(c1 * y0 + c2) / (c1 * (y1 - y0));
    EXPECT_GT(view.log_strength, 1) << "hardly a warp";
    for (std::uint32_t row = 0; row < view.height; ++row) {
        const double t = (row + 0.5) / view.height, v = d0 * std::exp(d1 * t) + d2;
        EXPECT_NEAR(log.tables[view.centres_first + view.width + row], v, 2e-6);
        EXPECT_NEAR(c0 * std::log(c1 * (y0 + v * (y1 - y0)) + c2), t, 1e-12) << "the constants are wrong";
    }
    for (std::uint32_t column = 0; column < view.width; ++column)
        EXPECT_NEAR(log.tables[view.centres_first + column], (column + 0.5) / view.width, 1e-6);

    const MapView& warped = tables.views.at(0);
    for (int axis = 0; axis < 2; ++axis) {
        const auto table = table_of(tables, warped, axis);
        for (std::uint32_t i = 0; i < warped.width; ++i) {
            const double centre = tables.tables[warped.centres_first + axis * warped.width + i] * WARP_SEGMENTS;
            const auto piece = std::min(std::size_t(centre), std::size_t(WARP_SEGMENTS - 1));
            const double again = table[piece] + (centre - double(piece)) * (table[piece + 1] - table[piece]);
            EXPECT_NEAR(again, (i + 0.5) / warped.width, 2e-6);
        }
    }
}

/// Depth of the nearest triangle on the ray at (u, v) before the warp, clamped to [0, 1]: 1 if there is none. By the
/// triangle's place in homogeneous coordinates, in double.
double nearest_at(const Floats& vertices, const MapView& view, double u, double v) {
    double nearest = 1;
    for (std::size_t t = 0; t + 9 <= vertices.size(); t += 9) {
        std::array<Double3, 3> h;  // (u w, v w, w)
        std::array<double, 3> depth, weight;
        for (int k = 0; k < 3; ++k) {
            const SceneBox at = place(view, to_double(&vertices[t + 3 * k]));
            h[k] = {at.u * at.w, at.v * at.w, at.w};
            depth[k] = at.depth;
        }
        const Double3 ray{u, v, 1};
        for (int k = 0; k < 3; ++k) weight[k] = dot(ray, cross(h[(k + 1) % 3], h[(k + 2) % 3]));
        const bool all = weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0;
        const bool none = weight[0] <= 0 && weight[1] <= 0 && weight[2] <= 0;
        const double total = weight[0] + weight[1] + weight[2];
        if (!(all || none) || total == 0) continue;
        nearest = std::min(nearest, (weight[0] * depth[0] + weight[1] * depth[1] + weight[2] * depth[2]) / total);
    }
    return std::max(nearest, 0.0);
}

// Every texel holds what its own ray meets. A ray within a thousandth of a texel of an edge may go either way.
TEST(RectilinearWarp, DepthsAreThoseOfTheRaysThroughTexelCentres) {
    Scene scene;
    gnomon::cl::Session& session = session_of(scene.device);
    for (const Settings& settings :
         {Settings{{"projection", "logpsm"}}, Settings{{"projection", "lispsm"}}, Settings{{"projection", "psm"}},
          Settings{{"warp", "hybrid"}}, Settings{{"projection", "logpsm"}, {"partition", "faces"}}}) {
        gnomon::ViewFit stage;
        for (const auto& [name, value] : settings) stage.set(name, value);
        SCOPED_TRACE(settings.front().second);
        const auto visibility = uploaded(session, std::vector<float>(scene.view.points.count(), 1.0f));
        const gnomon::FitInputs inputs{gnomon::triangle_inputs(scene.triangles),
                                       gnomon::point_inputs(scene.view.points), visibility.get(), slant,
                                       scene.view.points.camera()};
        gnomon::MapViews map_views;
        stage.run(session, inputs, 128, map_views);
        gnomon::DepthMap map;
        map.run(session, inputs.triangles, map_views, {}, false);
        const auto views = downloaded<MapView>(session, map_views.views.get(), map_views.set.view_count);
        const auto tables = downloaded<float>(session, map_views.tables.get(), map_views.tables.bytes() / 4);
        const auto keys = downloaded<float>(session, map.keys().get(), map_views.set.texels);
        std::size_t compared = 0, covered = 0;
        for (const MapView& view : views)
            for (std::uint32_t y = 0; y < view.height; y += 3)
                for (std::uint32_t x = 0; x < view.width; x += 3) {
                    const double u = tables[view.centres_first + x], v = tables[view.centres_first + view.width + y];
                    const double found = keys[view.first_texel + std::size_t(y) * view.row_stride + x];
                    bool agrees = false;
                    for (const double du : {0.0, -1e-3, 1e-3})
                        for (const double dv : {0.0, -1e-3, 1e-3})
                            agrees = agrees || std::fabs(nearest_at(scene.vertices, view, u + du / view.width,
                                                                    v + dv / view.height) -
                                                         found) < 1e-4;
                    ++compared;
                    covered += found < 1;
                    EXPECT_TRUE(agrees) << x << ", " << y << ": " << found << " instead of "
                                        << nearest_at(scene.vertices, view, u, v);
                }
        EXPECT_GT(covered, compared / 10);
    }
}

TEST(RectilinearWarp, BadSettingsAreOneClearSentence) {
    gnomon::ViewFit stage;
    EXPECT_THROW(stage.set("warp", "sideways"), gnomon::InvalidArgument);
    EXPECT_THROW(stage.set("importance", ""), gnomon::InvalidArgument);
    EXPECT_THROW(stage.set("importance", "view+colour"), gnomon::InvalidArgument);
    Scene scene;
    EXPECT_THROW(fit(scene, slant, {{"warp", "hybrid"}, {"projection", "logpsm"}}), gnomon::InvalidArgument);
}

}  // namespace
