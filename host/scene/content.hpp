// SPDX-License-Identifier: MIT
// What of a scene the default view frames: its finite triangles without strays, shells and wide planes.
#pragma once

#include <limits>
#include <vector>

#include <glm/mat3x3.hpp>

#include "affine.hpp"
#include "axis_lines.hpp"
#include "scene.hpp"
#include "shell.hpp"

namespace gnomon::scene {

/// A triangle belongs to the content unless it lies wholly in a box that was left out. So the content of another time
/// of an animation is known too.
class Content {
public:
    /// Leaves out strays: parts with at most a quarter of the triangles of the others, behind a gap of more than five
    /// times their size.
    explicit Content(const Scene& scene);
    /// Leaves out up to three wide planes or plates (ground, walls, a ceiling) if all else is less than a quarter as
    /// wide, on ground less than half.
    void leave_out_planes(const Scene& scene);
    /// Takes them back.
    void take_planes_back(const Scene& scene);
    /// Leaves out a closed surface that hides all else (a sky box). Returns false if there is none.
    bool leave_out_shell(const Scene& scene);

    bool has(const float* triangle) const;
    /// In world axes; empty if no triangle is finite.
    const Bounds& bounds() const { return bounds_; }
    /// An eye can stand between the content and the outermost shell, which is no case; true without a shell.
    bool has_room_in_shell() const;
    /// The content is less than a quarter as large as the innermost shell.
    bool is_small_in_shell() const;
    const std::vector<Shell>& shells() const { return shells_; }
    /// What was left out, but for shells, lies between this point and more than half of the inner half of the bounds.
    bool is_hidden_from(const glm::dvec3& eye) const;

private:
    /// Boxes along axes that need not be the world's.
    struct LeftOut {
        glm::dmat3 own_from_world;
        std::vector<Bounds> boxes;
    };
    bool leave_out_strays(const Scene& scene);
    bool leave_out_planes_along(const Scene& scene, const glm::dmat3& own_from_world);
    struct Planes {
        LeftOut left_out;
        Bounds beside;          ///< of the other triangles, along the axes of left_out
        bool are_wide = false;  ///< there are some, few enough, and the others are narrow beside them
    };
    Planes planes_along(const Scene& scene, const glm::dmat3& own_from_world, const Bounds& all,
                        const Bounds& beside) const;
    void leave_out(const Scene& scene, LeftOut left_out);
    glm::dmat3 axes_of_largest_triangle(const Scene& scene) const;

    std::vector<LeftOut> left_out_;
    std::vector<Shell> shells_;    ///< each in the one before
    std::size_t stray_count_ = 0;  ///< of left_out_: the first ones
    Bounds bounds_;
};

}  // namespace gnomon::scene
