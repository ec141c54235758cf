// SPDX-License-Identifier: MIT
// What of a scene the default view frames: its finite triangles without strays and without wide planes.
#pragma once

#include <limits>
#include <vector>

#include <glm/mat3x3.hpp>

#include "affine.hpp"
#include "scene.hpp"

namespace gnomon::scene {

struct Bounds {
    glm::dvec3 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};

    bool is_empty() const { return !(least.x <= most.x); }
    void add(const glm::dvec3& p) { least = min(least, p), most = max(most, p); }
    void add(const Bounds& other) { least = min(least, other.least), most = max(most, other.most); }
    glm::dvec3 sides() const { return most - least; }
    glm::dvec3 middle() const { return least / 2.0 + most / 2.0; }
};

/// Calls visit(t) with the nine floats of each finite triangle.
template <typename Visit>
void for_each_finite_triangle(const Scene& scene, const Visit& visit) {
    for (std::size_t i = 0; i < scene.triangle_count(); ++i)
        if (scene.is_finite(i)) visit(&scene.triangles[9 * i]);
}

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

    bool has(const float* triangle) const;
    /// In world axes; empty if no triangle is finite.
    const Bounds& bounds() const { return bounds_; }
    /// What was left out lies between this point and more than half of the inner half of the bounds.
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
    std::size_t stray_count_ = 0;  ///< of left_out_: the first ones
    Bounds bounds_;
};

}  // namespace gnomon::scene
