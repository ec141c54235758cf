// SPDX-License-Identifier: MIT
// The camera and the light of a scene that has none.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "affine.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

constexpr double framing_fov_y_degrees = 50;
constexpr double margin = 1.05;
constexpr Float3 origin{0, 0, 0};

struct Bounds {
    glm::dvec3 least, most;
    bool is_empty = true;
};

Bounds bounds_of_finite_triangles(const Scene& scene) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Bounds b{glm::dvec3(infinity), glm::dvec3(-infinity), true};
    for (std::size_t i = 0; i < scene.triangle_count(); ++i) {
        if (!scene.is_finite(i)) continue;
        const float* t = &scene.triangles[9 * i];
        b.is_empty = false;
        for (int k = 0; k < 9; k += 3) b.least = min(b.least, loaded(t + k)), b.most = max(b.most, loaded(t + k));
    }
    return b;
}

// ---- Interiors ------------------------------------------------------------------------------------------------------
// Walls of a room show their fronts (counter-clockwise vertices) to those inside. So a scene is an interior if its
// middle has walls on four sides and a floor, all with their fronts to it, and there is nothing to see from outside:
// mostly backs, or a plain box around it all.

/// Lines parallel to an axis of the box that do not meet its middle's own planes: fractions of its sides.
constexpr double line_positions[] = {0.137, 0.319, 0.5071, 0.683, 0.871};
constexpr double min_backs_outside = 0.5, min_on_box = 0.9;
constexpr double box_share = 0.03;  ///< of a side: how near to the bounding box a plain box is

/// What a line along an axis meets: the triangle nearest to the middle on each side, and the outermost on each side.
struct LineHits {
    double inner[2] = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    double outer[2] = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    /// The front points to larger coordinates.
    bool is_inner_up[2] = {}, is_outer_up[2] = {};

    void add(double at, bool is_up, double middle) {
        const int side = at > middle;
        if (side == 0 ? at > inner[0] : at < inner[1]) inner[side] = at, is_inner_up[side] = is_up;
        if (at < outer[0]) outer[0] = at, is_outer_up[0] = is_up;
        if (at > outer[1]) outer[1] = at, is_outer_up[1] = is_up;
    }
    bool is_met(int side) const { return std::isfinite(inner[side]); }
};

/// Lines along one axis.
class Lines {
public:
    Lines(int axis, const glm::dvec3& middle) : axis_(axis), middle_(middle) {}

    void through_middle() { add_line(middle_[(axis_ + 1) % 3], middle_[(axis_ + 2) % 3]); }
    void all_over(const Bounds& bounds) {
        const auto at = [&](int side, double part) {
            return bounds.least[side] + part * (bounds.most[side] - bounds.least[side]);
        };
        for (const double a : line_positions)
            for (const double b : line_positions) add_line(at((axis_ + 1) % 3, a), at((axis_ + 2) % 3, b));
    }

    void add(const float* t) {
        const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
        const auto [left, right] = std::minmax({t[u], t[u + 3], t[u + 6]});
        const auto [low, high] = std::minmax({t[v], t[v + 3], t[v + 6]});
        const auto first = std::ranges::lower_bound(at_, double(left), {}, [](const auto& line) { return line[0]; });
        for (std::size_t i = std::size_t(first - at_.begin()); i < at_.size() && at_[i][0] <= right; ++i) {
            const auto& [x, y] = at_[i];
            if (y < low || y > high) continue;
            double e[3], sum = 0;
            for (int k = 0; k < 3; ++k) {
                const float *a = t + 3 * ((k + 1) % 3), *b = t + 3 * ((k + 2) % 3);
                e[k] = (a[u] - x) * (b[v] - y) - (a[v] - y) * (b[u] - x);
                sum += e[k];
            }
            const bool is_inside = (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
            if (!is_inside || sum == 0) continue;
            hits[i].add((e[0] * t[axis_] + e[1] * t[axis_ + 3] + e[2] * t[axis_ + 6]) / sum, sum > 0, middle_[axis_]);
        }
    }

    std::vector<LineHits> hits;

private:
    void add_line(double u, double v) {
        at_.push_back({u, v});
        hits.emplace_back();
    }

    int axis_;
    glm::dvec3 middle_;
    std::vector<std::array<double, 2>> at_;  ///< the first coordinate does not fall
};

void meet(const Scene& scene, std::span<Lines> lines) {
    for (std::size_t i = 0; i < scene.triangle_count(); ++i)
        if (scene.is_finite(i))
            for (Lines& of_axis : lines) of_axis.add(&scene.triangles[9 * i]);
}

/// True if lines from the four sides mostly meet backs first, or a plain box.
bool hides_its_inside(const Scene& scene, const Bounds& bounds, const glm::dvec3& middle) {
    std::array<Lines, 2> lines{Lines(0, middle), Lines(2, middle)};
    for (Lines& of_axis : lines) of_axis.all_over(bounds);
    meet(scene, lines);
    std::size_t backs = 0, seen = 0, on_box = 0;
    for (int i = 0; i < 2; ++i) {
        const double least = bounds.least[2 * i], most = bounds.most[2 * i], near = box_share * (most - least);
        for (const LineHits& line : lines[std::size_t(i)].hits) {
            if (!std::isfinite(line.outer[0])) continue;
            seen += 2;
            backs += std::size_t(line.is_outer_up[0]) + std::size_t(!line.is_outer_up[1]);
            on_box += std::size_t(line.outer[0] - least < near) + std::size_t(most - line.outer[1] < near);
        }
    }
    return double(backs) > min_backs_outside * double(seen) || double(on_box) > min_on_box * double(seen);
}

/// The camera of an interior: above the middle of its floor, near one end of the longer axis and looking along it.
/// Nothing for other scenes.
std::optional<Camera> interior_camera(const Scene& scene, const Bounds& bounds) {
    constexpr double eye_height = 0.3, eye_distance = 0.2, interior_fov_y_degrees = 65;
    glm::dvec3 middle = bounds.least / 2.0 + bounds.most / 2.0;
    middle.y = bounds.least.y + eye_height * (bounds.most.y - bounds.least.y);
    std::array<Lines, 3> lines{Lines(0, middle), Lines(1, middle), Lines(2, middle)};
    for (Lines& of_axis : lines) of_axis.through_middle();
    meet(scene, lines);
    const LineHits &x = lines[0].hits[0], &y = lines[1].hits[0], &z = lines[2].hits[0];
    for (const LineHits* line : {&x, &z})
        if (!line->is_met(0) || !line->is_met(1) || !line->is_inner_up[0] || line->is_inner_up[1]) return {};
    if (!y.is_met(0) || !y.is_inner_up[0] || !hides_its_inside(scene, bounds, middle)) return {};
    const int axis = x.inner[1] - x.inner[0] >= z.inner[1] - z.inner[0] ? 0 : 2;
    const LineHits& longer = axis == 0 ? x : z;
    glm::dvec3 eye = middle, target = middle;
    eye[axis] = longer.inner[1] - eye_distance * (longer.inner[1] - longer.inner[0]);
    target[axis] = longer.inner[0];
    if (array_of(eye) == array_of(target)) return {};
    return Camera::look_at(array_of(eye), array_of(target), {0, 1, 0}, interior_fov_y_degrees);
}

}  // namespace

Camera framing_camera(const Scene& scene) {
    const Float3 toward_viewer{0.8f, 0.6f, 1.0f};
    Camera camera = Camera::look_at(toward_viewer, origin, {0, 1, 0}, framing_fov_y_degrees);
    const Bounds bounds = bounds_of_finite_triangles(scene);
    if (bounds.is_empty) return camera;
    if (const std::optional<Camera> inside = interior_camera(scene, bounds)) return *inside;
    const glm::dvec3 center = bounds.least / 2.0 + bounds.most / 2.0, half = bounds.most / 2.0 - bounds.least / 2.0;
    const glm::dvec3 right = loaded(camera.right), up = loaded(camera.up), forward = loaded(camera.forward);
    // Far enough for each corner of the box: |x|, |y| <= (distance + z) tan(fov_y / 2), in a picture no narrower than
    // it is high.
    const double slope = std::tan(camera.fov_y_radians / 2);
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 v = mix(-half, half, glm::bvec3(corner & 1, corner & 2, corner & 4));
        const double across = std::max(std::fabs(dot(v, right)), std::fabs(dot(v, up)));
        distance = std::max(distance, across / slope - dot(v, forward));
    }
    // A small thing far from the origin: the eye is rounded to float32, so it must be many ulps (2^-24) away.
    distance = std::max({distance * margin, std::ldexp(largest_coordinate(center), -14), 1e-3});
    constexpr double limit = std::numeric_limits<float>::max();
    camera.eye = array_of(clamp(center - distance * forward, -limit, limit));
    return camera;
}

Light default_light() { return Light::directional({-0.4f, -1.0f, -0.3f}); }

}  // namespace gnomon::scene
