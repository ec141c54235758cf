// SPDX-License-Identifier: MIT
#include "shell.hpp"

#include <bitset>
#include <map>
#include <set>

#include "content.hpp"

namespace gnomon::scene {
namespace {

constexpr double slack_share = 0.01;   ///< of the content's largest side: how far a shell leaves being convex
constexpr double ground_share = 0.01;  ///< of the content's height: what lies lower may be ground, wider than a dome
constexpr double core_share = 0.2;     ///< of what is seen, on each side of its middle: a shell is not there
constexpr double sliver_height = 0x1p-16;  ///< of its coordinates: float32 has turned the plane of what is lower
constexpr double level_slope = 0.01;       ///< of ground that is level
constexpr double near_share = 1.5;         ///< of the way from a shell's middle to a sliver of it
constexpr double width_beside_ground = 0.5;
constexpr double far_larger = 4;        ///< than all else, along each axis: what is open above
constexpr std::size_t least_lines = 5;  ///< along each axis, that meet the shell

double width_of(const Bounds& box) { return std::hypot(box.sides().x, box.sides().z); }

bool is_in(const float* t, const Bounds& box) {
    for (int k = 0; k < 9; ++k)
        if (t[k] < box.least[k % 3] || t[k] > box.most[k % 3]) return false;
    return true;
}

bool is_below(const float* t, double height) { return std::max({t[1], t[4], t[7]}) <= height; }

}  // namespace

std::optional<Shell::Plane> Shell::plane_of(const float* t) {
    const glm::dvec3 a = loaded(t), ab = loaded(t + 3) - a, ac = loaded(t + 6) - a;
    glm::dvec3 normal = cross(ab, ac);
    const double height = length(normal) / std::max({length(ab), length(ac), length(ac - ab)});
    const bool is_sliver = !(height > sliver_height * std::max(largest_coordinate(a), largest_coordinate(a + ab)));
    if (is_sliver || !make_unit(normal)) return {};
    return Plane{normal, dot(normal, loaded(t))};
}

bool Shell::has(const float* triangle) const {
    if (is_in(triangle, ground_)) return true;
    if (is_in(triangle, core_)) return false;
    const std::optional<Plane> plane = plane_of(triangle);
    if (!plane)
        return std::ranges::all_of(std::array{0, 3, 6},
                                   [&](int k) { return exit(middle_, loaded(triangle + k)) < near_share; });
    bool has_above = false, has_below = false;
    for (const glm::dvec3& p : points_) {
        const double above = dot(plane->normal, p) - plane->level;
        has_above = has_above || above > slack_;
        has_below = has_below || above < -slack_;
        if (has_above && has_below) return false;
    }
    return true;
}

double Shell::exit(const glm::dvec3& inside, const glm::dvec3& to) const {
    double part = std::numeric_limits<double>::infinity();
    for (const Plane& plane : planes_) {
        const double way = dot(plane.normal, to - inside);
        if (way < 0) part = std::min(part, (plane.level - dot(plane.normal, inside)) / way);
    }
    return part;
}

bool Shell::is_level(const float* triangle) {
    const std::optional<Plane> plane = plane_of(triangle);
    return plane && std::hypot(plane->normal.x, plane->normal.z) < level_slope;
}

double Shell::ground_height(const Scene& scene, const Content& content) {
    const Bounds& all = content.bounds();
    std::map<double, std::bitset<4>> sides_at;  // that the level triangles of a height reach
    for_each_finite_triangle(scene, [&](const float* t) {
        const double height = std::max({t[1], t[4], t[7]});
        std::bitset<4> sides;
        for (int k = 0; k < 9; k += 3)
            for (const int axis : {0, 2}) {
                sides[std::size_t(axis)] = sides[std::size_t(axis)] || t[k + axis] == all.least[axis];
                sides[std::size_t(axis) + 1] = sides[std::size_t(axis) + 1] || t[k + axis] == all.most[axis];
            }
        if (sides.any() && height < all.middle().y && content.has(t) && is_level(t)) sides_at[height] |= sides;
    });
    double height = all.least.y;
    for (const auto& [of_level, sides] : sides_at)
        if (sides.all()) height = of_level;
    return height;
}

/// The planes of what is seen from four sides and, unless it is open, from above, if they all have each other on one
/// side.
bool Shell::find(const Scene& scene, const Content& content, double least_height) {
    const Bounds& all = content.bounds();
    std::array<Lines, 3> lines{Lines(0, all.middle()), Lines(1, all.middle()), Lines(2, all.middle())};
    for (Lines& of_axis : lines) of_axis.all_over(all);
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!is_below(t, least_height) && content.has(t))
            for (Lines& of_axis : lines) of_axis.add(t);
    });
    std::set<const float*> seen;
    for (const int axis : {0, 1, 2}) {
        if (axis == 1 && is_open_) continue;
        const Lines& of_axis = lines[std::size_t(axis)];
        std::size_t met = 0;
        for (std::size_t i = 0; i < of_axis.hits.size(); ++i) {
            const LineHits& line = of_axis.hits[i];
            if (!std::isfinite(line.outer[0])) continue;
            ++met;
            for (const std::size_t side : {0u, 1u}) {
                if (axis == 1 && side == 0) continue;
                const glm::dvec3 point = of_axis.point(i, line.outer[side]);
                if (point.y >= least_height) points_.push_back(point);  // a wall may go on below the ground
                seen.insert(line.outer_triangle[side]);
            }
        }
        if (met < least_lines) return false;
    }
    if (points_.empty()) return false;
    slack_ = slack_share * largest_coordinate(all.sides());
    Bounds around;
    for (const glm::dvec3& p : points_) middle_ += p / double(points_.size()), around.add(p);
    core_ = {middle_ - core_share * around.sides(), middle_ + core_share * around.sides()};
    for (const float* t : seen) {
        if (!has(t)) return false;
        if (std::optional<Plane> plane = plane_of(t)) {
            const double side = dot(plane->normal, middle_) < plane->level ? -1 : 1;
            fronts_outside_ += side < 0;
            planes_.push_back({side * plane->normal, side * plane->level});
        }
    }
    return true;
}

std::optional<Shell> Shell::around(const Scene& scene, const Content& content) {
    if (content.bounds().is_empty()) return {};
    std::optional<Shell> closed = around(scene, content, false);
    return closed ? closed : around(scene, content, true);
}

std::optional<Shell> Shell::around(const Scene& scene, const Content& content, bool is_open) {
    const Bounds& all = content.bounds();
    const double least_height = ground_height(scene, content) + ground_share * all.sides().y;
    Shell shell;
    shell.is_open_ = is_open;
    if (!shell.find(scene, content, least_height) || (is_open && shell.has_fronts_outside())) return {};
    Bounds ground;
    for_each_finite_triangle(scene, [&](const float* t) {
        if (is_level(t) && is_below(t, least_height) && content.has(t) && shell.has(t))
            for (int k = 0; k < 9; k += 3) ground.add(loaded(t + k));
    });
    shell.ground_ = ground;
    Bounds rest;
    bool is_all_inside = true;
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!content.has(t)) return;
        const bool is_of_shell = shell.has(t), may_be_ground = is_below(t, least_height);
        for (int k = 0; k < 9; k += 3) {
            if (!is_of_shell) rest.add(loaded(t + k));
            if (is_of_shell && !may_be_ground) shell.bounds_.add(loaded(t + k));
            for (const Plane& plane : shell.planes_)
                if (!is_of_shell && !may_be_ground && dot(plane.normal, loaded(t + k)) < plane.level - shell.slack_)
                    is_all_inside = false;
        }
    });
    if (rest.is_empty() || !is_all_inside || width_of(shell.bounds_) < width_beside_ground * width_of(all)) return {};
    if (is_open && any(lessThan(shell.bounds_.sides(), far_larger * rest.sides()))) return {};
    // Closed: the shell stands on four sides of the rest's middle, and above it.
    std::array<Lines, 3> lines{Lines(0, rest.middle()), Lines(1, rest.middle()), Lines(2, rest.middle())};
    for (Lines& of_axis : lines) of_axis.through_middle();
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!is_below(t, least_height) && content.has(t) && shell.has(t))
            for (Lines& of_axis : lines) of_axis.add(t);
    });
    for (const std::size_t axis : {0u, 1u, 2u})
        for (const int side : {0, 1})
            if (!(axis == 1 && (side == 0 || is_open)) && !lines[axis].hits[0].is_met(side)) return {};
    return shell;
}

}  // namespace gnomon::scene
