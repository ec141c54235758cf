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
#include "content.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

constexpr double framing_fov_y_degrees = 50;
constexpr Float3 origin{0, 0, 0};

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

void meet(const Scene& scene, const Content& content, std::span<Lines> lines) {
    for_each_finite_triangle(scene, [&](const float* t) {
        if (content.has(t))
            for (Lines& of_axis : lines) of_axis.add(t);
    });
}

/// True if lines from the four sides mostly meet backs first, or a plain box.
bool hides_its_inside(const Scene& scene, const Content& content, const glm::dvec3& middle) {
    const Bounds& bounds = content.bounds();
    std::array<Lines, 2> lines{Lines(0, middle), Lines(2, middle)};
    for (Lines& of_axis : lines) of_axis.all_over(bounds);
    meet(scene, content, lines);
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
std::optional<Camera> interior_camera(const Scene& scene, const Content& content) {
    const Bounds& bounds = content.bounds();
    constexpr double eye_height = 0.3, eye_distance = 0.2, interior_fov_y_degrees = 65;
    glm::dvec3 middle = bounds.middle();
    middle.y = bounds.least.y + eye_height * (bounds.most.y - bounds.least.y);
    std::array<Lines, 3> lines{Lines(0, middle), Lines(1, middle), Lines(2, middle)};
    for (Lines& of_axis : lines) of_axis.through_middle();
    meet(scene, content, lines);
    const LineHits &x = lines[0].hits[0], &y = lines[1].hits[0], &z = lines[2].hits[0];
    for (const LineHits* line : {&x, &z})
        if (!line->is_met(0) || !line->is_met(1) || !line->is_inner_up[0] || line->is_inner_up[1]) return {};
    if (!y.is_met(0) || !y.is_inner_up[0] || !hides_its_inside(scene, content, middle)) return {};
    const int axis = x.inner[1] - x.inner[0] >= z.inner[1] - z.inner[0] ? 0 : 2;
    const LineHits& longer = axis == 0 ? x : z;
    glm::dvec3 eye = middle, target = middle;
    eye[axis] = longer.inner[1] - eye_distance * (longer.inner[1] - longer.inner[0]);
    target[axis] = longer.inner[0];
    if (array_of(eye) == array_of(target)) return {};
    return Camera::look_at(array_of(eye), array_of(target), {0, 1, 0}, interior_fov_y_degrees);
}

// ---- Framing --------------------------------------------------------------------------------------------------------

/// Where the viewer may stand. The first is taken unless another shows far more of the triangles.
constexpr Float3 toward_viewers[] = {{0.8f, 0.6f, 1.0f}, {-0.8f, 0.6f, 1.0f}, {0.2f, 1.0f, 0.4f},
                                     {0.2f, 0.3f, 1.0f}, {1.0f, 0.3f, 0.2f},  {0.8f, -0.6f, 1.0f}};
constexpr Float3 low_viewer = {0.8f, 0.1f, 1.0f};
constexpr double least_shown = 0.35;     ///< of what the best viewer sees
constexpr double slope_ratio = 0.8;      ///< of one Reach to the next
constexpr double filled = 0.88;          ///< of the picture's narrower side, or both where they bind
constexpr double distance_of_eye = 2.5;  ///< about: of half the content's diagonal, in a picture that is not narrow

Camera camera_towards(const glm::dvec3& viewer) {
    return Camera::look_at(array_of(viewer), origin, {0, 1, 0}, framing_fov_y_degrees);
}

/// The viewers from whom no plane hides the content. Their mirror images and a lower one come after they all are
/// hidden.
std::vector<glm::dvec3> viewers_of(const Content& content, double aspect) {
    const double distance = distance_of_eye / std::min(aspect, 1.0) * length(content.bounds().sides()) / 2;
    const auto sees = [&](const glm::dvec3& viewer) {
        return !content.is_hidden_from(content.bounds().middle() + distance * normalize(viewer));
    };
    std::vector<glm::dvec3> viewers;
    for (const Float3& viewer : toward_viewers)
        if (sees(loaded(viewer))) viewers.push_back(loaded(viewer));
    if (!viewers.empty()) return viewers;
    for (std::size_t i = 0; i <= std::size(toward_viewers); ++i)
        for (const double x : {1.0, -1.0})
            for (const double z : {1.0, -1.0}) {
                const Float3& viewer = i < std::size(toward_viewers) ? toward_viewers[i] : low_viewer;
                const glm::dvec3 mirrored = loaded(viewer) * glm::dvec3(x, 1, z);
                if (sees(mirrored)) viewers.push_back(mirrored);
            }
    return viewers;
}

/// The camera of the viewer who sees most of the content's areas, or the first.
Camera best_camera(const Scene& scene, const Content& content, const std::vector<glm::dvec3>& viewers) {
    const double scale = std::max(largest_coordinate(content.bounds().sides() / 2.0), 1e-30);
    std::vector<double> shown(viewers.size());
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!content.has(t)) return;
        const glm::dvec3 corner = loaded(t) / scale;
        const glm::dvec3 normal = cross(loaded(t + 3) / scale - corner, loaded(t + 6) / scale - corner);
        for (std::size_t i = 0; i < viewers.size(); ++i) shown[i] += std::fabs(dot(normal, normalize(viewers[i])));
    });
    const std::size_t best = std::size_t(std::ranges::max_element(shown) - shown.begin());
    return camera_towards(viewers[shown[0] >= least_shown * shown[best] ? 0 : best]);
}

}  // namespace

Framing::Framing(const Scene& scene, double aspect)
    : aspect_(aspect), camera_(camera_towards(loaded(toward_viewers[0]))) {
    auto content = std::make_shared<Content>(scene);
    content_ = content;
    if (content->bounds().is_empty()) return;
    if (const std::optional<Camera> inside = interior_camera(scene, *content)) {
        camera_ = *inside;
        is_interior_ = true;
        return;
    }
    content->leave_out_planes(scene);
    std::vector<glm::dvec3> viewers = viewers_of(*content, aspect);
    if (viewers.empty()) {
        content->take_planes_back(scene);
        for (const Float3& viewer : toward_viewers) viewers.push_back(loaded(viewer));
    }
    middle_ = array_of<double>(content->bounds().middle());
    camera_ = best_camera(scene, *content, viewers);
    add(scene);
}

// An eye at (x, y, z) in the camera's axes sees a point p below the slope k if |p.x - x| <= k (p.z - z), and the same
// for y. So the greatest p.x - k p.z and -p.x - k p.z of all points say how far back it must stand, and where it is in
// their middle. Smaller slopes say where the middle is on the side that does not bind.
void Framing::add(const Scene& scene) {
    if (is_interior_) return;
    const double slope_y = std::tan(camera_.fov_y_radians / 2) * filled, slope_x = slope_y * aspect_;
    const glm::dvec3 right = loaded(camera_.right), up = loaded(camera_.up), forward = loaded(camera_.forward);
    const glm::dvec3 middle = loaded(middle_.data());
    for (std::size_t i = 0; i < reaches_.size(); ++i) reaches_[i].slope = std::pow(slope_ratio, double(i));
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!content_->has(t)) return;
        for (int k = 0; k < 9; k += 3) {
            const glm::dvec3 p = loaded(t + k) - middle;
            const double x = dot(p, right), y = dot(p, up), z = dot(p, forward);
            for (Reach& reach : reaches_) {
                const double zx = reach.slope * slope_x * z, zy = reach.slope * slope_y * z;
                const double at[] = {x - zx, -x - zx, y - zy, -y - zy};
                for (std::size_t i = 0; i < 4; ++i) reach.sides[i] = std::max(reach.sides[i], at[i]);
            }
        }
    });
}

Camera Framing::camera() const {
    if (is_interior_ || !std::isfinite(reaches_[0].sides[0])) return camera_;
    const double slope_y = std::tan(camera_.fov_y_radians / 2) * filled, slopes[] = {slope_y * aspect_, slope_y};
    const auto needed = [&](const Reach& reach, std::size_t axis) {
        return (reach.sides[2 * axis] + reach.sides[2 * axis + 1]) / (2 * reach.slope * slopes[axis]);
    };
    const glm::dvec3 middle = loaded(middle_.data());
    // A small thing far from the origin: rounding to float32 moves the eye by up to 2^-25 of its coordinates,
    // which is at most 1/128 of this distance.
    const double distance =
        std::max({needed(reaches_[0], 0), needed(reaches_[0], 1), std::ldexp(largest_coordinate(middle), -18), 1e-6});
    glm::dvec3 eye = middle - distance * loaded(camera_.forward);
    for (const std::size_t axis : {0u, 1u}) {
        std::size_t i = 0;  // the tightest slope that suits; the middle lies between its own and the next one's
        while (i + 2 < reaches_.size() && needed(reaches_[i + 1], axis) <= distance) ++i;
        const auto middle_of = [&](const Reach& reach) {
            return (reach.sides[2 * axis] - reach.sides[2 * axis + 1]) / 2;
        };
        const double least = needed(reaches_[i], axis), most = needed(reaches_[i + 1], axis);
        const double part = most > least ? std::clamp((distance - least) / (most - least), 0.0, 1.0) : 0;
        const double at = std::lerp(middle_of(reaches_[i]), middle_of(reaches_[i + 1]), part);
        eye += at * loaded(axis == 0 ? camera_.right : camera_.up);
    }
    constexpr double limit = std::numeric_limits<float>::max();
    Camera camera = camera_;
    camera.eye = array_of(clamp(eye, -limit, limit));
    return camera;
}

Camera framing_camera(const Scene& scene, double aspect) { return Framing(scene, aspect).camera(); }

Light default_light() { return Light::directional({-0.4f, -1.0f, -0.3f}); }

}  // namespace gnomon::scene
