// SPDX-License-Identifier: MIT
// The camera and the light of a scene that has none.
#include <algorithm>
#include <cmath>
#include <limits>

#include "affine.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

constexpr double framing_fov_y_degrees = 50;
constexpr double margin = 1.05;
constexpr Float3 origin{0, 0, 0};

struct Bounds {
    Double3 least, most;
    bool is_empty = true;
};

Bounds bounds_of_finite_triangles(const Scene& scene) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Bounds b{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}, true};
    for (std::size_t i = 0; i < scene.triangle_count(); ++i) {
        if (!scene.is_finite(i)) continue;
        const float* t = &scene.triangles[9 * i];
        b.is_empty = false;
        for (int k = 0; k < 9; ++k) {
            b.least[k % 3] = std::min(b.least[k % 3], double(t[k]));
            b.most[k % 3] = std::max(b.most[k % 3], double(t[k]));
        }
    }
    return b;
}

}  // namespace

Camera framing_camera(const Scene& scene) {
    const Float3 toward_viewer{0.8f, 0.6f, 1.0f};
    Camera camera = Camera::look_at(toward_viewer, origin, {0, 1, 0}, framing_fov_y_degrees);
    const Bounds bounds = bounds_of_finite_triangles(scene);
    if (bounds.is_empty) return camera;
    Double3 center, half;
    for (int i = 0; i < 3; ++i) {
        center[i] = bounds.least[i] / 2 + bounds.most[i] / 2;
        half[i] = bounds.most[i] / 2 - bounds.least[i] / 2;
    }
    // Far enough for each corner of the box: |x|, |y| <= (distance + z) tan(fov_y / 2), in a picture no narrower than
    // it is high.
    const double slope = std::tan(camera.fov_y_radians / 2);
    double distance = 0, largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Double3 v;
        for (int i = 0; i < 3; ++i) v[i] = corner >> i & 1 ? half[i] : -half[i];
        const double across = std::max(std::fabs(dot(v, camera.right)), std::fabs(dot(v, camera.up)));
        distance = std::max(distance, across / slope - dot(v, camera.forward));
    }
    for (const double c : center) largest = std::max(largest, std::fabs(c));
    // A small thing far from the origin: the eye is rounded to float32, so it must be many ulps (2^-24) away.
    distance = std::max({distance * margin, std::ldexp(largest, -14), 1e-3});
    constexpr double limit = std::numeric_limits<float>::max();
    Double3 eye;
    for (int i = 0; i < 3; ++i) eye[i] = std::clamp(center[i] - distance * camera.forward[i], -limit, limit);
    camera.eye = rounded(eye);
    return camera;
}

Light default_light() { return Light::directional({-0.4f, -1.0f, -0.3f}); }

}  // namespace gnomon::scene
