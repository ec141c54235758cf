// SPDX-License-Identifier: MIT
// The camera and the light of a scene that has none.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "affine.hpp"
#include "content.hpp"
#include "gltf.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

constexpr double framing_fov_y_degrees = 50, interior_fov_y_degrees = 65;
constexpr Float3 origin{0, 0, 0};

// ---- Interiors ------------------------------------------------------------------------------------------------------
// Walls of a room show their fronts (counter-clockwise vertices) to those inside. So a scene is an interior if its
// middle has walls on four sides and a floor, all with their fronts to it, and there is nothing to see from outside:
// mostly backs, or a plain box around it all.

constexpr double min_backs_outside = 0.5, min_on_box = 0.9;
constexpr double box_share = 0.03;  ///< of a side: how near to the bounding box a plain box is

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
    constexpr double eye_height = 0.3, eye_distance = 0.2;
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
constexpr double least_shown = 0.35;  ///< of what the best viewer sees
constexpr double slope_ratio = 0.8;   ///< of one Reach to the next
constexpr double filled = 0.88;       ///< of the picture's narrower side, or both where they bind
constexpr std::size_t most_shells = 3;
constexpr double before_shell = 0.95;    ///< of the way to a shell: an eye stands there if it were outside
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

/// The mesh's box has the other box on four sides and above, and is far larger.
bool is_around(const Bounds& mesh, const Bounds& others) {
    constexpr double far_larger = 4;
    const bool is_beside = mesh.least.x < others.least.x && mesh.most.x > others.most.x &&
                           mesh.least.z < others.least.z && mesh.most.z > others.most.z;
    return is_beside && mesh.most.y > others.most.y &&
           all(greaterThan(mesh.sides(), glm::dvec3(far_larger * largest_coordinate(others.sides()))));
}

}  // namespace

Framing::Framing(const Scene& scene, double aspect)
    : aspect_(aspect), camera_(camera_towards(loaded(toward_viewers[0]))) {
    auto content = std::make_shared<Content>(scene);
    content_ = content;
    if (content->bounds().is_empty()) return;
    Content inside = *content;
    for (std::size_t shells = 0; shells <= most_shells; ++shells) {
        const std::optional<Camera> of_interior = interior_camera(scene, inside);
        const bool is_shell = inside.leave_out_shell(scene);
        if (of_interior && !(is_shell && inside.is_small_in_shell())) {
            camera_ = *of_interior;
            is_interior_ = true;
            return;
        }
        if (!is_shell) break;
        if (inside.has_room_in_shell()) *content = inside;
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
    for (const Shell& shell : content_->shells()) {
        const double exit = before_shell * shell.exit(middle, eye);
        if (!(exit > 0 && exit < 1)) continue;
        eye = middle + exit * (eye - middle);
        camera.fov_y_radians = interior_fov_y_degrees * std::numbers::pi / 180;
    }
    camera.eye = array_of(clamp(eye, -limit, limit));
    return camera;
}

std::string Framing::left_out(const Scene& scene) const {
    std::map<int, std::size_t> triangles_of_mesh;
    std::size_t total = 0, use = 0;
    for_each_finite_triangle(scene, [&](const float* t) {
        if (content_->has(t)) return;
        ++total;
        const auto triangle = std::size_t(t - scene.triangles.data()) / 9;
        while (use + 1 < scene.mesh_uses.size() && scene.mesh_uses[use + 1].first_triangle <= triangle) ++use;
        if (use < scene.mesh_uses.size()) ++triangles_of_mesh[scene.mesh_uses[use].mesh];
    });
    if (total == 0) return "";
    std::vector<std::pair<int, std::size_t>> meshes(triangles_of_mesh.begin(), triangles_of_mesh.end());
    std::ranges::stable_sort(meshes, std::greater<>(), [](const auto& mesh) { return mesh.second; });
    std::vector<std::string> names;
    for (const auto& [mesh, count] : meshes)
        names.push_back(fmt::format("{} of {}", count, scene.mesh_names[std::size_t(mesh)]));
    return fmt::format(
        "the default view does not frame {} of {}{}{}: what is around, wide or far beside the others would make these "
        "small or hide them; all are drawn and cast shadows, and --eye and --target give another view",
        total, counted(scene.triangle_count(), "triangle"), names.empty() ? "" : ", ", listed(names, 3));
}

std::string Framing::hidden(const Scene& scene) const {
    if (is_interior_) return "";
    std::vector<Bounds> boxes(scene.mesh_names.size());
    std::size_t use = 0;
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!content_->has(t)) return;
        const auto triangle = std::size_t(t - scene.triangles.data()) / 9;
        while (use + 1 < scene.mesh_uses.size() && scene.mesh_uses[use + 1].first_triangle <= triangle) ++use;
        if (use >= scene.mesh_uses.size()) return;
        for (int k = 0; k < 9; k += 3) boxes[std::size_t(scene.mesh_uses[use].mesh)].add(loaded(t + k));
    });
    const auto top = std::ranges::max_element(boxes, {}, [](const Bounds& box) { return box.most.y; });
    Bounds others;
    for (auto box = boxes.begin(); box != boxes.end(); ++box)
        if (box != top && !box->is_empty()) others.add(*box);
    if (others.is_empty() || !is_around(*top, others)) return "";
    return fmt::format(
        "the default view shows {} from outside, and all else is far smaller and inside of it: --eye and --target show "
        "that from there",
        scene.mesh_names[std::size_t(top - boxes.begin())]);
}

Camera framing_camera(const Scene& scene, double aspect) { return Framing(scene, aspect).camera(); }

Light default_light() { return Light::directional({-0.4f, -1.0f, -0.3f}); }

}  // namespace gnomon::scene
