// SPDX-License-Identifier: MIT
// The shapes that scenes are put together from. All share vertices where the surface goes on, closed ones are
// watertight (every edge has two triangles), and outsides are counter-clockwise.
#pragma once

#include <span>
#include <vector>

#include "glb.hpp"

namespace gnomon::make_scenes {

/// Free triangle and quad with vertices of their own.
void triangle(Part& part, const Vec3& a, const Vec3& b, const Vec3& c);
void quad(Part& part, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// A rectangle at height y, facing up: 2 triangles.
void floor_quad(Part& part, double low_x, double low_z, double high_x, double high_z, double y);

/// u_count * v_count quads over the parallelogram from `origin` along `u` and `v`; faces cross(u, v).
void grid(Part& part, const Vec3& origin, const Vec3& u, const Vec3& v, int u_count, int v_count);

/// Closed, axis-aligned: 12 triangles.
void box(Part& part, const Vec3& low, const Vec3& high);
/// Closed, with the half-axes u, v, w (right-handed): 12 triangles.
void oriented_box(Part& part, const Vec3& center, const Vec3& u, const Vec3& v, const Vec3& w);
/// A closed bar from `from` to `to`, square, `width` wide: 12 triangles.
void bar(Part& part, const Vec3& from, const Vec3& to, double width);
/// Top and sides of an axis-aligned box, open below: 10 triangles.
void lid(Part& part, const Vec3& low, const Vec3& high);

/// A circle of `sides` vertices around `center`, from radius_u towards radius_v. Returns its first index.
std::uint32_t ring(Part& part, const Vec3& center, const Vec3& radius_u, const Vec3& radius_v, int sides);
/// The band between two rings: 2 * sides triangles. Faces outwards if the second lies on the side of cross(u, v).
void join_rings(Part& part, std::uint32_t first, std::uint32_t second, int sides);
/// A fan from a ring to a new vertex: `sides` triangles, facing along cross(u, v), or against it if `is_bottom`.
void cap_ring(Part& part, std::uint32_t first, const Vec3& apex, int sides, bool is_bottom);

struct ProfilePoint {
    double radius, height;
};
/// A closed solid of revolution around the axis +Y through `origin`: rings of the profile from below upwards, capped
/// by a fan at each end. 2 * sides * profile.size() triangles.
void revolve(Part& part, const Vec3& origin, std::span<const ProfilePoint> profile, int sides);
/// The same around a unit axis of any direction.
void revolve(Part& part, const Vec3& origin, const Vec3& axis, std::span<const ProfilePoint> profile, int sides);
/// A closed tube along a path of at least two points, with a radius for each: 2 * sides * points triangles. The frame
/// is carried along without twisting, so that bends stay clean.
void tube(Part& part, std::span<const Vec3> path, std::span<const double> radius, int sides);

/// A closed icosphere: 20 * 4^levels triangles.
void icosphere(Part& part, const Vec3& center, double radius, int levels);

}  // namespace gnomon::make_scenes
