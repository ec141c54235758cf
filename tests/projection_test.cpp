// SPDX-License-Identifier: MIT
// Stage projection of the shadow maps: what every fit promises (each point is held by a view, whatever casts on it lies
// at the same place of the map and nearer), and what each family is known for, by formulas of the literature and
// geometry worked out here in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "../host/shadow_map/projection.hpp"
#include "../host/vectors.hpp"
#include "support/device.hpp"
#include "support/scene_makers.hpp"

namespace {

using gnomon::Double3;
using gnomon::MapView;
using namespace support;

using Settings = std::vector<std::pair<std::string, std::string>>;

/// A wide floor with posts and a wall, seen from a little above.
Floats yard() {
    Floats triangles;
    add(triangles, {-60, 0, -60}, {60, 0, -60}, {60, 0, 60});
    add(triangles, {-60, 0, -60}, {60, 0, 60}, {-60, 0, 60});
    Random random(5);
    for (int i = 0; i < 60; ++i) {
        const Float3 foot{random.between(-40, 40), 0, random.between(-50, 10)};
        add(triangles, foot, {foot[0] + 1, 0, foot[2]}, {foot[0], random.between(1, 8), foot[2]});
    }
    return triangles;
}

struct Scene {
    gnomon::Device device = device_with();
    Floats vertices = yard();
    gnomon::Triangles triangles = gnomon::Triangles::upload(device, vertices);
    gnomon::Camera camera;
    gnomon::View view;
    std::vector<float> positions;  ///< of pixels that see something

    explicit Scene(const gnomon::Camera& from) : camera(from) {
        view = gnomon::look(device, triangles, camera, 96, 64);
        const gnomon::ViewOnHost host = gnomon::read(device, triangles, view);
        for (std::size_t i = 0; i < host.receiver.size(); ++i)
            if (host.receiver[i] != gnomon::no_receiver)
                positions.insert(positions.end(), &host.position[3 * i], &host.position[3 * i] + 3);
    }
    Scene() : Scene(gnomon::Camera::look_at({0, 3, 30}, {2, 1, 0}, {0, 1, 0}, 50)) {}

    double depth(const Double3& p) const {
        return gnomon::dot(camera.forward, {p[0] - camera.eye[0], p[1] - camera.eye[1], p[2] - camera.eye[2]});
    }
    double tangent_up() const { return std::tan(camera.fov_y_radians / 2); }
    double tangent_right() const { return tangent_up() * 96 / 64; }
};

Double3 to_double(const float* v) { return {v[0], v[1], v[2]}; }
Double3 sum(const Double3& a, const Double3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

struct Fitted {
    std::vector<MapView> views;
    gnomon::MapSet set;
};

Fitted fit(Scene& scene, const gnomon::Light& light, const Settings& settings, std::uint32_t size = 256,
           bool with_camera = true) {
    gnomon::ViewFit stage;
    for (const auto& [name, value] : settings) EXPECT_TRUE(stage.set(name, value)) << name;
    gnomon::cl::Session& session = scene.device.session();
    const std::vector<float> ones(scene.view.points.count(), 1.0f);
    const auto visibility = uploaded(session, ones);
    gnomon::FitInputs inputs{gnomon::triangle_inputs(scene.triangles), gnomon::point_inputs(scene.view.points),
                             visibility.get(), light, std::nullopt};
    if (with_camera) inputs.camera = scene.view.points.camera();
    gnomon::MapViews map_views;
    stage.run(session, inputs, size, map_views);
    return {downloaded<MapView>(session, map_views.views.get(), map_views.set.view_count), map_views.set};
}

struct Place {
    double u, v, depth, w;
};

double apply(const float* row, const Double3& q) { return row[0] * q[0] + row[1] * q[1] + row[2] * q[2] + row[3]; }

Place place(const MapView& view, const Double3& p) {
    const Double3 q{p[0] - view.origin[0], p[1] - view.origin[1], p[2] - view.origin[2]};
    const double w = apply(view.row_w, q);
    return {apply(view.row_u, q) / w, apply(view.row_v, q) / w, apply(view.row_depth, q), w};
}

/// Steepness of u (or v) in world space, per unit.
double slope(const MapView& view, const float* row, double value, const Double3& p) {
    Double3 gradient;
    for (int i = 0; i < 3; ++i) gradient[i] = row[i] - value * view.row_w[i];
    return std::sqrt(gnomon::dot(gradient, gradient)) / std::fabs(place(view, p).w);
}

bool is_inside(const Place& at) { return at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1; }

/// As map_view.h selects, in double.
const MapView* view_of(const Fitted& fitted, const Scene& scene, const Double3& p) {
    for (const MapView& view : fitted.views) {
        const double depth = fitted.set.has_camera != 0 ? scene.depth(p) : 0;
        if (view.width == 0 || depth < view.select_near || depth >= view.select_far) continue;
        const Place at = place(view, p);
        if (is_inside(at) && at.depth > view.front_depth) return &view;
    }
    return nullptr;
}

/// Towards the light from p, unit length.
Double3 towards(const gnomon::Light& light, const Double3& p) {
    Double3 d{light.xyzw[0], light.xyzw[1], light.xyzw[2]};
    if (!light.is_directional()) d = {d[0] - p[0], d[1] - p[1], d[2] - p[2]};
    gnomon::normalize(d);
    return d;
}

std::vector<std::pair<std::string, gnomon::Light>> lights() {
    return {{"noon", gnomon::Light::directional({0.1f, -1, 0.05f})},
            {"side", gnomon::Light::directional({-1, -0.4f, 0.1f})},
            {"from behind", gnomon::Light::directional({0.1f, -0.3f, -1})},
            {"from ahead", gnomon::Light::directional({0.05f, -0.3f, 1})},
            {"lamp in view", gnomon::Light::positional({1, 6, 4})},
            {"lamp behind", gnomon::Light::positional({-8, 9, 45})}};
}

std::vector<Settings> compositions() {
    std::vector<Settings> all;
    for (const char* projection : {"uniform", "psm", "lispsm", "logpsm"}) {
        for (const char* form : {"receivers", "frustum"})
            for (const char* partition : {"single", "depth", "faces"})
                all.push_back({{"projection", projection}, {"fit", form}, {"partition", partition}, {"cascades", "3"}});
        all.push_back({{"projection", projection}, {"cascades", "4"}, {"lambda", "1"}, {"overlap", "0"}});
        all.push_back({{"projection", projection}, {"cascades", "4"}, {"share-texels", "on"}});
    }
    for (const char* form : {"casters", "sphere", "quantised"})
        for (const char* cascades : {"1", "4"}) all.push_back({{"fit", form}, {"cascades", cascades}});
    all.push_back({{"projection", "logpsm"}, {"cascades", "3"}, {"self-similar", "on"}, {"fit", "frustum"}});
    all.push_back({{"cascades", "5"}, {"storage", "atlas"}});
    all.push_back({{"cascades", "4"}, {"depth-range", "planes"}, {"fit", "frustum"}});
    return all;
}

std::string named(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings) text += (text.empty() ? "" : " ") + name + "=" + value;
    return text;
}

// What the lookups rely on, for every composition and light.
TEST(projection, holds_every_point_and_what_casts_on_it) {
    Scene scene;
    for (const auto& [name, light] : lights())
        for (const Settings& settings : compositions()) {
            SCOPED_TRACE(name + ", " + named(settings));
            const Fitted fitted = fit(scene, light, settings);
            std::size_t lost = 0;
            double astray = 0;
            for (std::size_t i = 0; i < scene.positions.size(); i += 3) {
                const Double3 p = to_double(&scene.positions[i]);
                const MapView* view = view_of(fitted, scene, p);
                if (view == nullptr) {
                    ++lost;
                    continue;
                }
                const Place at = place(*view, p);
                EXPECT_TRUE(at.depth >= 0 && at.depth <= 1) << at.depth;
                // A caster 3 m nearer: same texel, smaller depth, and for a direction by the same for all points.
                const Place nearer = place(*view, sum(p, gnomon::scaled(towards(light, p), 3)));
                EXPECT_LT(nearer.depth, at.depth);
                // Rows are floats: what they are off by is less than a twentieth of a texel, or a tenth of a
                // millimetre where a view of few points has texels finer than that.
                astray = std::max({astray,
                                   std::min(std::fabs(nearer.u - at.u) * view->width / 0.05,
                                            std::fabs(nearer.u - at.u) / slope(*view, view->row_u, at.u, p) / 1e-4),
                                   std::min(std::fabs(nearer.v - at.v) * view->height / 0.05,
                                            std::fabs(nearer.v - at.v) / slope(*view, view->row_v, at.v, p) / 1e-4)});
            }
            EXPECT_EQ(lost, 0u) << "of " << scene.positions.size() / 3;
            EXPECT_LT(astray, 1) << "a point and what shades it lie at different places";
        }
}

}  // namespace
