// SPDX-License-Identifier: MIT
// A closed convex surface around all else that a scene shows, such as a sky box: from outside nothing but it is seen.
// Or one that is open above, such as a panorama, if its fronts are inside and all else is far smaller.
#pragma once

#include <optional>
#include <vector>

#include "axis_lines.hpp"

namespace gnomon::scene {

class Content;

class Shell {
public:
    /// The shell of the content, which has something else inside; nothing if there is none.
    static std::optional<Shell> around(const Scene& scene, const Content& content);

    /// The triangle has the shell, and all in it, on one side; or it is a sliver near the shell, or an edge of a plate
    /// of ground below all else.
    bool has(const float* triangle) const;
    /// The part of the way from a point inside to this one at which the shell is met; infinite if it is not met.
    double exit(const glm::dvec3& inside, const glm::dvec3& to) const;
    const Bounds& bounds() const { return bounds_; }
    bool has_fronts_outside() const { return 2 * fronts_outside_ > planes_.size(); }  ///< most of them

private:
    /// dot(normal, p) >= level inside.
    struct Plane {
        glm::dvec3 normal;
        double level;
    };
    /// Nothing for a sliver.
    static std::optional<Plane> plane_of(const float* triangle);
    bool find(const Scene& scene, const Content& content, double least_height);
    static std::optional<Shell> around(const Scene& scene, const Content& content, bool is_open);
    static bool is_level(const float* triangle);
    /// The height of level ground that is as wide as the content, in its lower half; else the content's least height.
    static double ground_height(const Scene& scene, const Content& content);

    std::vector<glm::dvec3> points_;  ///< what lines along the axes meet first
    std::vector<Plane> planes_;       ///< there
    std::size_t fronts_outside_ = 0;  ///< planes whose triangles turn their fronts away from the middle
    glm::dvec3 middle_{0};            ///< of the points
    Bounds core_;                     ///< within the shell
    Bounds ground_;                   ///< of level triangles below all else
    double slack_ = 0;
    bool is_open_ = false;  ///< above
    Bounds bounds_;
};

}  // namespace gnomon::scene
