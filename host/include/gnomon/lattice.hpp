// SPDX-License-Identifier: MIT
// float64 coordinates as float32 without loss. Experimental (gnomon/version.h says what that means). A library of its
// own: link gnomon::lattice or gnomon::full.
#pragma once

#include <span>

#include <gnomon/device.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

/// float64 coordinates, for example of a national grid, as float32 without loss: each is snapped once to a whole number
/// of steps, floor(x / step + 1/2), and stored as its distance from an origin on the lattice. A distance of up to 2^24
/// steps is a float32 value, so nothing rounds again, and since all answers are exact and do not change when everything
/// moves by the same vector, they do not depend on the origin: one scene, cut into tiles with origins of their own,
/// gives the same bits as a whole. A directional light is rounded once, for the world; a point light is snapped too.
/// docs/numerics.md, 13, has the proofs.
struct WorldLattice {
    int exponent = -10;                    ///< the step is 2^exponent, from -100 to 100
    std::array<std::int64_t, 3> origin{};  ///< in steps; all positions are below 2^46 steps

    /// The step, in the unit of the world's coordinates.
    double step() const;
    /// A lattice of this step with the origin nearest the centre of the finite positions (3 numbers each). Throws
    /// InvalidArgument if the step is out of range.
    static WorldLattice around(std::span<const double> positions, int exponent);
    /// The finest step at which the positions lie within 2^23 steps of the origin: half the range, so that points
    /// around the scene fit too.
    static WorldLattice fit(std::span<const double> positions);

    /// What snap() returns.
    struct Snapped {
        std::vector<float> positions;  ///< relative to the origin; NaN where a position is not finite
        double largest_move = 0;       ///< of any coordinate: at most half a step
    };
    /// Snaps positions (3 numbers each). Throws InvalidArgument with the first that lies more than 2^24 steps from the
    /// origin, and the finest step that fits.
    Snapped snap(std::span<const double> positions) const;
    /// Snaps points that lie on a surface so that this surface does not shadow them: moves each by `lift_steps` steps
    /// along its normal (3 numbers each, of any length, of the surface before snapping), then snaps. If the surface was
    /// flat, and the point within sqrt(3)/2 steps of it, no snapped triangle of it meets a ray from the point to the
    /// normal's side. Decide facing by the same normal. Throws as snap() does, or if a normal is zero or not finite.
    std::vector<float> lift(std::span<const double> positions, std::span<const double> normals) const;
    /// What snapping does to each of these triangles (9 numbers each): it leaves them without area, turns them over (by
    /// more than a right angle), or tilts them by more than `degrees`, 0 to 90. Triangles that have no area before, or
    /// are not finite, are `none`. Throws as snap() does.
    enum class Change : std::uint8_t { none, zero_area, turned_over, tilted };
    /// One value for each triangle.
    std::vector<Change> changes(std::span<const double> triangles, double degrees = 1) const;
    /// For each corner of these triangles (9 numbers each) another triangle that it touches: one within a step of the
    /// corner, before snapping, that has no corner there, after snapping (a T-junction, a wall that stands on terrain,
    /// tiles of two triangulations); no_receiver if there is none, the nearest if there are several. Such a corner is
    /// to be lifted off that triangle as a point on its surface, since snapping may have put the corner below it. Some
    /// seconds for a million triangles. Throws as snap() does.
    std::vector<std::uint32_t> touched_triangles(std::span<const double> triangles) const;
    /// The world's coordinates of a snapped position, exactly.
    std::array<double, 3> world_of(const Float3& position) const;
    /// Snapped positions relative to the origin of another lattice of the same step, exactly. Throws InvalidArgument if
    /// the steps differ, or a position lies more than 2^24 steps from the new origin.
    std::vector<float> rebased(std::span<const float> positions, const WorldLattice& other) const;

    /// A vertex, a point's own error and its snapping move by at most sqrt(3)/2 steps each: 3 sqrt(3)/2 = 2.598...
    static constexpr double lift_steps = 2.625;

private:
    Float3 snapped(const double* position) const;  ///< NaN if it is not finite or out of range
};

}  // namespace gnomon

#pragma GCC visibility pop
