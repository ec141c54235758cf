// SPDX-License-Identifier: MIT
#include "content.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace gnomon::scene {
namespace {

// ---- Strays ---------------------------------------------------------------------------------------------------------

constexpr double stray_gap = 5;         ///< of the content's largest side
constexpr std::size_t stray_share = 4;  ///< the content has at least this many triangles for each stray one

/// Triangles whose extents along an axis have no gap between them, as far as the cells of an axis show it.
struct Run {
    Bounds bounds;
    std::size_t triangles = 0;
};

/// The bounds of a scene, cut into cells along one axis.
class CellsAlongAxis {
public:
    CellsAlongAxis(int axis, const Bounds& all) : axis_(axis), least_(all.least[axis]), side_(all.sides()[axis]) {}

    void add(const Bounds& triangle) {
        const std::size_t first = cell_of(triangle.least[axis_]), last = cell_of(triangle.most[axis_]);
        cells_[first].bounds.add(triangle);
        ++cells_[first].triangles;
        reach_[first] = std::max(reach_[first], last);
    }
    std::vector<Run> runs() const {
        std::vector<Run> runs;
        std::size_t reached = 0;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            if (cells_[i].triangles == 0) continue;
            if (runs.empty() || i > reached + 1) runs.emplace_back();
            runs.back().bounds.add(cells_[i].bounds);
            runs.back().triangles += cells_[i].triangles;
            reached = std::max(reached, reach_[i]);
        }
        return runs;
    }

private:
    std::size_t cell_of(double at) const {
        return side_ > 0 ? std::min(std::size_t((at - least_) / side_ * double(cells_.size())), cells_.size() - 1) : 0;
    }

    int axis_;
    double least_, side_;
    std::array<Run, 256> cells_{};  ///< of the triangles that begin there
    std::array<std::size_t, 256> reach_{};
};

double gap_along(int axis, const Bounds& a, const Bounds& b) {
    return std::max(b.least[axis] - a.most[axis], a.least[axis] - b.most[axis]);
}

/// Boxes of the runs that are strays beside the run with most triangles.
std::vector<Bounds> strays_of(int axis, const std::vector<Run>& runs) {
    const auto most = std::ranges::max_element(runs, {}, &Run::triangles);
    if (most == runs.end()) return {};
    Run content = *most;
    std::vector<Bounds> strays;
    std::size_t stray_triangles = 0;
    const auto go = [&](auto from, auto end) {
        bool is_beyond_gap = false;
        Bounds beyond;
        for (; from != end; ++from) {
            is_beyond_gap = is_beyond_gap || gap_along(axis, content.bounds, from->bounds) >
                                                 stray_gap * largest_coordinate(content.bounds.sides());
            if (is_beyond_gap) {
                beyond.add(from->bounds);
                stray_triangles += from->triangles;
            } else {
                content.bounds.add(from->bounds);
                content.triangles += from->triangles;
            }
        }
        if (is_beyond_gap) strays.push_back(beyond);
    };
    go(most + 1, runs.end());
    go(std::make_reverse_iterator(most), runs.rend());
    return stray_triangles * stray_share <= content.triangles ? strays : std::vector<Bounds>{};
}

// ---- Planes ---------------------------------------------------------------------------------------------------------

constexpr double most_levels = 1e5;
constexpr double level_share = 0.01;  ///< of the bounds' side: how far a triangle of a plane leaves it
constexpr double wide_share = 0.5;    ///< of all: a plane is at least as wide
constexpr double room_share = 0.8;    ///< of a shell's side: what is shorter leaves an eye room
constexpr double case_share = 0.5;    ///< the same, if its fronts are outside: what fills it more lies in a case
constexpr double narrow = 0.25, narrow_on_ground = 0.5;  ///< of all: what is beside planes is narrower
constexpr double edge_share = 0.05;   ///< of the widest plane's area: what has less is the edge of a plate
constexpr double plate_share = 0.05;  ///< of all: levels with a smaller distance are one plate
constexpr std::size_t plate_levels = 4, most_plates = 3, most_boxes = 16;

/// How wide a box is, seen along an axis.
double width_along(int axis, const Bounds& box) {
    const glm::dvec3 sides = box.sides();
    return box.is_empty() ? 0 : std::hypot(sides[(axis + 1) % 3], sides[(axis + 2) % 3]);
}

/// The planes across one axis: their boxes, edges of plates among them, and how many plates they are.
struct PlanesAcross {
    std::vector<Bounds> boxes;
    std::size_t plates = 0;
};

class LevelsAlongAxis {
public:
    /// `near`: a triangle of a plane leaves it by less than a hundredth of this box's side.
    LevelsAlongAxis(int axis, const Bounds& all, const Bounds& near)
        : axis_(axis), least_(all.least[axis]), width_(width_along(axis, all)) {
        const double side = all.sides()[axis], parts = side / (level_share * near.sides()[axis]);
        if (!(side > 0)) return;
        levels_.resize(std::size_t(std::clamp(parts, 1.0, most_levels)));
        step_ = side / double(levels_.size());
    }

    void add(const Bounds& triangle, const glm::dvec3& area) {
        if (levels_.empty() || triangle.sides()[axis_] > step_) return;
        const auto index = std::size_t((triangle.middle()[axis_] - least_) / step_);
        Level& level = levels_[std::min(index, levels_.size() - 1)];
        level.bounds.add(triangle);
        level.area += std::abs(area[axis_]);
    }
    double largest_area() const { return levels_.empty() ? 0 : std::ranges::max(levels_, {}, &Level::area).area; }
    PlanesAcross planes(double least_area) const {
        PlanesAcross planes;
        const Bounds* below = nullptr;
        std::size_t levels_of_plate = 0;
        for (const auto& [level, area] : levels_) {
            if (level.is_empty() || width_along(axis_, level) < wide_share * width_) continue;
            planes.boxes.push_back(level);
            if (planes.boxes.size() > most_boxes) return {};  // the walls of a town
            if (area < least_area) continue;
            const bool is_next = below != nullptr && level.least[axis_] - below->most[axis_] < plate_share * width_;
            levels_of_plate = is_next ? levels_of_plate + 1 : 1;
            if (levels_of_plate > plate_levels) return {};  // relief
            if (!is_next) ++planes.plates;
            below = &level;
        }
        return planes;
    }

private:
    struct Level {
        Bounds bounds;
        double area = 0;
    };
    int axis_;
    double least_, step_ = 0, width_;
    std::vector<Level> levels_;
};

Bounds bounds_of(const float* t, const glm::dmat3& own_from_world) {
    Bounds box;
    for (int k = 0; k < 9; k += 3) box.add(own_from_world * loaded(t + k));
    return box;
}

int thinnest_axis(const glm::dvec3& sides) {
    return sides.y <= sides.x && sides.y <= sides.z ? 1 : sides.x <= sides.z ? 0 : 2;
}

bool is_in(const Bounds& inner, const Bounds& outer) {
    return all(greaterThanEqual(inner.least, outer.least)) && all(lessThanEqual(inner.most, outer.most));
}

/// Whether the line from a to b meets the box.
bool meets(const glm::dvec3& a, const glm::dvec3& b, const Bounds& box) {
    double enter = 0, leave = 1;
    for (int i = 0; i < 3; ++i) {
        const double way = b[i] - a[i], low = box.least[i] - a[i], high = box.most[i] - a[i];
        if (way == 0) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        enter = std::max(enter, std::min(low / way, high / way));
        leave = std::min(leave, std::max(low / way, high / way));
    }
    return enter <= leave;
}

}  // namespace

// ---- Content --------------------------------------------------------------------------------------------------------

Content::Content(const Scene& scene) {
    leave_out(scene, {glm::dmat3(1), {}});
    while (leave_out_strays(scene)) {
    }
    stray_count_ = left_out_.size();
}

bool Content::has(const float* triangle) const {
    if (std::ranges::any_of(shells_, [&](const Shell& shell) { return shell.has(triangle); })) return false;
    for (const LeftOut& left_out : left_out_) {
        if (left_out.boxes.empty()) continue;
        const Bounds own = bounds_of(triangle, left_out.own_from_world);
        if (std::ranges::any_of(left_out.boxes, [&](const Bounds& box) { return is_in(own, box); })) return false;
    }
    return true;
}

void Content::leave_out(const Scene& scene, LeftOut left_out) {
    left_out_.push_back(std::move(left_out));
    bounds_ = {};
    for_each_finite_triangle(scene, [&](const float* t) {
        if (has(t)) bounds_.add(bounds_of(t, glm::dmat3(1)));
    });
}

bool Content::leave_out_strays(const Scene& scene) {
    std::array<CellsAlongAxis, 3> cells{CellsAlongAxis(0, bounds_), CellsAlongAxis(1, bounds_),
                                        CellsAlongAxis(2, bounds_)};
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!has(t)) return;
        for (CellsAlongAxis& of_axis : cells) of_axis.add(bounds_of(t, glm::dmat3(1)));
    });
    for (int axis = 0; axis < 3; ++axis)
        if (std::vector<Bounds> strays = strays_of(axis, cells[std::size_t(axis)].runs()); !strays.empty()) {
            leave_out(scene, {glm::dmat3(1), std::move(strays)});
            return true;
        }
    return false;
}

void Content::leave_out_planes(const Scene& scene) {
    while (leave_out_planes_along(scene, glm::dmat3(1)) ||
           leave_out_planes_along(scene, axes_of_largest_triangle(scene))) {
    }
}

void Content::take_planes_back(const Scene& scene) {
    left_out_.resize(stray_count_);
    leave_out(scene, {glm::dmat3(1), {}});
}

bool Content::leave_out_shell(const Scene& scene) {
    std::optional<Shell> shell = Shell::around(scene, *this);
    if (!shell) return false;
    shells_.push_back(std::move(*shell));
    leave_out(scene, {glm::dmat3(1), {}});
    stray_count_ = left_out_.size();
    return true;
}

bool Content::has_room_in_shell() const {
    if (shells_.empty()) return true;
    const double share = shells_.front().has_fronts_outside() ? case_share : room_share;
    return any(lessThanEqual(bounds_.sides(), share * shells_.front().bounds().sides()));
}

bool Content::is_small_in_shell() const {
    return !shells_.empty() &&
           largest_coordinate(bounds_.sides()) < narrow * largest_coordinate(shells_.back().bounds().sides());
}

bool Content::leave_out_planes_along(const Scene& scene, const glm::dmat3& own_from_world) {
    Bounds all;
    for_each_finite_triangle(scene, [&](const float* t) {
        if (has(t)) all.add(bounds_of(t, own_from_world));
    });
    // How thin a plane must be depends on what is beside it, which is not known at first. If nothing is, the content
    // may lie within a plane that was taken for thicker than it is.
    Planes planes{{}, all, false};
    std::optional<LeftOut> found;
    for (int finer = 0; finer < 3;) {
        planes = planes_along(scene, own_from_world, all, planes.beside);
        if (planes.are_wide && !planes.beside.is_empty()) {
            const bool is_first = !found;
            found = std::move(planes.left_out);
            if (!is_first) break;
        } else if (planes.are_wide && !found) {
            planes.beside = {all.least, all.least + all.sides() * std::pow(0.1, ++finer)};
        } else {
            break;
        }
    }
    if (found) leave_out(scene, std::move(*found));
    return found.has_value();
}

/// The planes among the triangles with the bounds "all". "beside": about how large the other triangles are.
Content::Planes Content::planes_along(const Scene& scene, const glm::dmat3& own_from_world, const Bounds& all,
                                      const Bounds& beside) const {
    std::array<LevelsAlongAxis, 3> levels{LevelsAlongAxis(0, all, beside), LevelsAlongAxis(1, all, beside),
                                          LevelsAlongAxis(2, all, beside)};
    for_each_finite_triangle(scene, [&](const float* t) {
        if (!has(t)) return;
        const Bounds own = bounds_of(t, own_from_world);
        const glm::dvec3 area = own_from_world * cross(loaded(t + 3) - loaded(t), loaded(t + 6) - loaded(t)) / 2.0;
        levels[std::size_t(thinnest_axis(own.sides()))].add(own, area);
    });
    Planes planes{{own_from_world, {}}, {}, true};
    std::array<std::size_t, 3> plates{};
    const double widest = std::max({levels[0].largest_area(), levels[1].largest_area(), levels[2].largest_area()});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const PlanesAcross across = levels[axis].planes(edge_share * widest);
        planes.left_out.boxes.insert(planes.left_out.boxes.end(), across.boxes.begin(), across.boxes.end());
        plates[axis] = across.plates;
    }
    // More of them are a room or a body.
    const std::size_t all_plates = plates[0] + plates[1] + plates[2];
    if (all_plates == 0 || all_plates > most_plates || std::ranges::max(plates) > 2) return {{}, {}, false};
    for_each_finite_triangle(scene, [&](const float* t) {
        const Bounds own = bounds_of(t, own_from_world);
        const auto is_around = [&](const Bounds& box) { return is_in(own, box); };
        if (has(t) && std::ranges::none_of(planes.left_out.boxes, is_around)) planes.beside.add(own);
    });
    const bool is_upright = own_from_world == glm::dmat3(1);
    for (int axis = 0; axis < 3; ++axis)
        if (plates[std::size_t(axis)] > 0 &&
            width_along(axis, planes.beside) >=
                (is_upright && axis == 1 ? narrow_on_ground : narrow) * width_along(axis, all))
            planes.are_wide = false;
    return planes;
}

/// Its normal, its shortest side and what is across both.
glm::dmat3 Content::axes_of_largest_triangle(const Scene& scene) const {
    glm::dvec3 normal(0), side(0);
    for_each_finite_triangle(scene, [&](const float* t) {
        const glm::dvec3 a = loaded(t), b = loaded(t + 3), c = loaded(t + 6), across = cross(b - a, c - a);
        if (dot(across, across) <= dot(normal, normal) || !has(t)) return;
        normal = across;
        side = std::min({b - a, c - b, a - c}, [](auto& v, auto& w) { return dot(v, v) < dot(w, w); });
    });
    if (!make_unit(normal) || !make_unit(side)) return glm::dmat3(1);
    return transpose(glm::dmat3(normal, side, cross(normal, side)));
}

bool Content::is_hidden_from(const glm::dvec3& eye) const {
    int hidden = 0;
    for (int corner = 0; corner < 8; ++corner) {
        glm::dvec3 at = bounds_.middle();
        for (int i = 0; i < 3; ++i) at[i] += ((corner >> i & 1) != 0 ? 0.25 : -0.25) * bounds_.sides()[i];
        hidden += std::ranges::any_of(left_out_, [&](const LeftOut& left_out) {
            const glm::dvec3 from = left_out.own_from_world * eye, to = left_out.own_from_world * at;
            return std::ranges::any_of(left_out.boxes, [&](const Bounds& box) { return meets(from, to, box); });
        });
    }
    return hidden > 4;
}

}  // namespace gnomon::scene
