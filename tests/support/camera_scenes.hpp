// SPDX-License-Identifier: MIT
// Views that test the camera: closed meshes, lattices whose edges pass through pixel centres, needles,
// far from the origin, from inside, with triangles behind and across the eye.
#pragma once

#include "camera/camera.hpp"
#include "kernels/camera/camera.h"
#include "reference/stages/exact_ray.hpp"
#include "scene_makers.hpp"

namespace gnomon {

/// The inputs of a camera's kernels.
struct CameraTables {
    Projection projection;
    std::vector<float> rays;
    PictureRays picture;
};

inline CameraTables camera_tables(const Camera& camera, std::uint32_t width, std::uint32_t height,
                                  SampleOffset offset = {}) {
    return {camera_projection(camera, width, height), camera_rays(camera, width, height, offset),
            picture_rays(camera, width, height)};
}

}  // namespace gnomon

namespace support {

struct CameraScene {
    std::string name;
    Floats triangles;
    Float3 eye, target, up;
    double fov_y_degrees;
    std::uint32_t width, height;

    gnomon::Camera camera() const {
        gnomon::Camera camera = gnomon::Camera::look_at(eye, target, up, fov_y_degrees);
        if (fov_y_degrees == LATTICE_FOV) camera.fov_y_radians = lattice_fov();
        return camera;
    }

    /// tan(half of it) is exactly 1/2 in doubles: see lattice_view().
    static constexpr double LATTICE_FOV = 53.13010235415598;
    static double lattice_fov() {
        double fov = 2 * std::atan(0.5);
        while (std::tan(fov / 2) > 0.5) fov = std::nextafter(fov, 0.0);
        while (std::tan(fov / 2) < 0.5) fov = std::nextafter(fov, 1.0);
        return fov;
    }
};

/// The exact ray of a pixel, from the table that the kernels read.
inline reference::ExactRay exact_ray(const gnomon::CameraTables& tables, std::uint32_t x, std::uint32_t y) {
    const float* column = tables.rays.data() + RAY_FLOATS * std::size_t(x);
    const float* row = tables.rays.data() + RAY_FLOATS * (std::size_t(tables.projection.width) + y);
    const auto vector = [](const float* v) { return Float3{v[0], v[1], v[2]}; };
    const float* eye = tables.projection.center;
    return {vector(eye), {vector(column), vector(column + 3), vector(row), vector(row + 3)}};
}

/// A wall of two triangles per unit cell in the plane z = 0, x and y from -cells to cells.
inline Floats lattice_wall(int cells) {
    Floats triangles;
    for (int y = -cells; y < cells; ++y)
        for (int x = -cells; x < cells; ++x) {
            const Float3 a = {float(x), float(y), 0}, b = {float(x + 1), float(y), 0},
                         c = {float(x + 1), float(y + 1), 0}, d = {float(x), float(y + 1), 0};
            add(triangles, a, b, c);
            add(triangles, a, c, d);
        }
    return triangles;
}

/// A view of the wall in which EVERY pixel's ray runs exactly through a corner of six triangles: `height` is a power of
/// two, so a pixel is 1 / height wide at distance 1, exactly, and 1 at the eye's distance of `height`.
inline CameraScene lattice_view(std::uint32_t width, std::uint32_t height) {
    const Float3 eye = {width % 2 == 0 ? 0.5f : 0.0f, height % 2 == 0 ? 0.5f : 0.0f, float(height)};
    return {"lattice view of " + std::to_string(width) + " x " + std::to_string(height),
            lattice_wall(40),
            eye,
            {eye[0], eye[1], 0},
            {0, 1, 0},
            CameraScene::LATTICE_FOV,
            width,
            height};
}

inline std::vector<CameraScene> camera_scenes() {
    std::vector<CameraScene> scenes;
    const Floats ball = icosphere(2, 1), mess = soup(60, 0.6f, 41);
    scenes.push_back({"ball", ball, {0.3f, 0.4f, 3}, {0, 0, 0}, {0, 1, 0}, 50, 37, 29});
    scenes.push_back({"inside a ball", ball, {0.1f, -0.2f, 0.05f}, {1, 0, 0}, {0, 1, 0}, 100, 33, 17});
    scenes.push_back(lattice_view(17, 16));
    scenes.push_back({"soup around the eye", mess, {0.05f, 0.1f, 0}, {0.2f, 0.1f, -1}, {0, 1, 0}, 80, 40, 23});
    scenes.push_back({"large soup", soup(25, 5, 42), {0, 0, 0}, {0.1f, 0.3f, -1}, {0, 1, 0}, 60, 31, 31});
    scenes.push_back({"huge soup", soup(12, 1e6f, 43), {0.3f, 0.2f, 1}, {0, 0, 0}, {0, 1, 0}, 60, 16, 16});
    for (const double far : {1e3, 1e5, 1e7}) {
        const std::array<double, 3> offset = {far, -far, far};
        const double scale = far > 1e6 ? 20 : 1;
        scenes.push_back({"ball at " + std::to_string(far),
                          placed(ball, scale, offset),
                          {float(far + 0.3 * scale), float(-far + 0.4 * scale), float(far + 3 * scale)},
                          {float(far), float(-far), float(far)},
                          {0, 1, 0},
                          50,
                          24,
                          24});
    }
    scenes.push_back(
        {"tiny ball", placed(ball, 1e-7, {1e-6, 0, 0}), {1.3e-6f, 4e-8f, 3e-7f}, {1e-6f, 0, 0}, {0, 1, 0}, 50, 24, 24});
    scenes.push_back({"microscopic ball",
                      placed(ball, 1e-13, {0, 0, 0}),
                      {3e-14f, 4e-14f, 3e-13f},
                      {0, 0, 0},
                      {0, 1, 0},
                      50,
                      24,
                      24});
    scenes.push_back({"needles", needle_fan(97, 1), {0.2f, 1, 0.7f}, {0, 0, 0}, {0, 1, 0}, 60, 40, 40});
    scenes.push_back({"grazing needles", needle_fan(97, 1), {0.2f, 1e-4f, 1.7f}, {0, 0, 0}, {0, 1, 0}, 60, 40, 40});
    scenes.push_back({"slivers", slivers(40, 1e-6f, 44), {0.2f, 2, 0.7f}, {0, 0.5f, 0}, {0, 1, 0}, 60, 40, 40});
    scenes.push_back({"eye in a wall's plane", lattice_wall(3), {5, 0.5f, 0}, {0, 0.5f, 0}, {0, 1, 0}, 60, 19, 19});
    scenes.push_back({"telescope", placed(ball, 1, {0, 0, -1e5}), {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1e-3, 24, 24});
    scenes.push_back({"fisheye", mess, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 179.99, 24, 24});
    scenes.push_back({"one pixel", ball, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 50, 1, 1});
    scenes.push_back({"one row", ball, {0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 50, 65, 1});
    return scenes;
}

}  // namespace support
