// SPDX-License-Identifier: MIT
// Fits of shadow maps on a small scene, copied to the host, for the tests of projections, partitions and warps.
#pragma once

#include <cmath>

#include "device.hpp"
#include "light_scene.hpp"
#include "query/vectors.hpp"
#include "rivals/shadow_map/map_projection.hpp"

namespace support {

using gnomon::Double3;
using gnomon::MapView;

/// A wide floor with posts.
inline Floats yard() {
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

/// One device for all tests: a driver compiles its kernels again for each device.
inline gnomon::Device shared_device() {
    static const gnomon::Device device = device_with();
    return device;
}

struct Scene {
    gnomon::Device device;
    Floats vertices = yard();
    gnomon::Triangles triangles = gnomon::Triangles::upload(device, vertices);
    gnomon::Camera camera;
    gnomon::View view;
    std::vector<float> positions;  ///< of pixels that show a triangle

    explicit Scene(const gnomon::Camera& from, const gnomon::Device& on = shared_device()) : device(on), camera(from) {
        view = gnomon::look(device, triangles, camera, 96, 64);
        const gnomon::ViewOnHost host = view.read(device, triangles);
        for (std::size_t i = 0; i < host.receiver.size(); ++i)
            if (host.receiver[i] != gnomon::no_receiver)
                positions.insert(positions.end(), &host.position[3 * i], &host.position[3 * i] + 3);
    }
    explicit Scene(const gnomon::Device& on = shared_device())
        : Scene(gnomon::Camera::look_at({0, 3, 30}, {2, 1, 0}, {0, 1, 0}, 50), on) {}

    double depth(const Double3& p) const {
        return gnomon::dot(camera.forward, {p[0] - camera.eye[0], p[1] - camera.eye[1], p[2] - camera.eye[2]});
    }
    double tangent_up() const { return std::tan(camera.fov_y_radians / 2); }
    double tangent_right() const { return tangent_up() * 96 / 64; }
};

inline Double3 to_double(const float* v) { return {v[0], v[1], v[2]}; }
inline Double3 sum(const Double3& a, const Double3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

struct Fitted {
    std::vector<MapView> views;
    std::vector<float> tables;
    gnomon::MapSet set;
};

inline Fitted fit(Scene& scene, const gnomon::Light& light, const Settings& settings, std::uint32_t size = 256,
                  bool with_camera = true) {
    gnomon::ViewFit stage;
    for (const auto& [name, value] : settings) EXPECT_TRUE(stage.set(name, value)) << name;
    gnomon::cl::Session& session = session_of(scene.device);
    const std::vector<float> ones(scene.view.points.count(), 1.0f);
    const auto visibility = uploaded(session, ones);
    gnomon::FitInputs inputs{gnomon::triangle_inputs(scene.triangles), gnomon::point_inputs(scene.view.points),
                             visibility.get(), light, std::nullopt};
    if (with_camera) inputs.camera = scene.view.points.camera();
    gnomon::MapViews map_views;
    stage.run(session, inputs, size, map_views);
    return {downloaded<MapView>(session, map_views.views.get(), map_views.set.view_count),
            downloaded<float>(session, map_views.tables.get(), map_views.tables.bytes() / sizeof(float)),
            map_views.set};
}

struct SceneBox {
    double u, v, depth, w;
};

inline double row_at(const float* row, const Double3& q) {
    return row[0] * q[0] + row[1] * q[1] + row[2] * q[2] + row[3];
}

inline SceneBox place(const MapView& view, const Double3& p) {
    const Double3 q{p[0] - view.origin[0], p[1] - view.origin[1], p[2] - view.origin[2]};
    const double w = row_at(view.row_w, q);
    return {row_at(view.row_u, q) / w, row_at(view.row_v, q) / w, row_at(view.row_depth, q), w};
}

/// Steepness of u (or v) in world space, per unit.
inline double slope(const MapView& view, const float* row, double value, const Double3& p) {
    Double3 gradient;
    for (int i = 0; i < 3; ++i) gradient[i] = row[i] - value * view.row_w[i];
    return std::sqrt(gnomon::dot(gradient, gradient)) / std::fabs(place(view, p).w);
}

inline bool is_inside(const SceneBox& at) { return at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1; }

}  // namespace support
