// SPDX-License-Identifier: MIT
// World coordinates in float64, snapped to a lattice whose points near an origin are float32 values (numerics.md, 13).
#include <gnomon.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "lists/morton.hpp"
#include "query/inputs.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

constexpr double largest_steps = 0x1p24;        // from the origin: float32 holds every whole number up to here
constexpr double largest_world_steps = 0x1p46;  // from world zero: a double then has six bits below the step
constexpr int smallest_exponent = -100, largest_exponent = 100;

/// floor(steps + 1/2), without the rounding of that sum. |steps| is below 2^52.
double rounded_up_at_half(double steps) {
    const double below = std::floor(steps);
    // The difference is exact, but above -1/2 step, where it rounds to no less than 1/2 (tests/proofs/lattice.g).
    return steps - below >= 0.5 ? below + 1 : below;
}

std::string text_of(const double* p) {
    char text[96];
    std::snprintf(text, sizeof(text), "(%.17g, %.17g, %.17g)", p[0], p[1], p[2]);
    return text;
}

// The bounds of the finite positions.
CoordinateBounds bounds_of(std::span<const double> positions) {
    CoordinateBounds bounds;
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
        if (is_finite(&positions[i])) bounds.add(loaded(&positions[i]));
    return bounds;
}

// The finest step at which `bounds` lie within `steps` of an origin at their centre, and within the world's range.
int finest_exponent(const CoordinateBounds& bounds, double steps) {
    int exponent = smallest_exponent;
    if (bounds.is_empty()) return exponent;
    const double reach = largest_coordinate(bounds.high / 2.0 - bounds.low / 2.0);
    const double farthest = largest_coordinate(max(abs(bounds.low), abs(bounds.high)));
    // One step more than the reach: the origin and the positions are rounded by half a step each.
    while (exponent < largest_exponent &&
           (reach > std::ldexp(steps - 1, exponent) || farthest > std::ldexp(largest_world_steps - 1, exponent)))
        ++exponent;
    return exponent;
}

}  // namespace

double WorldLattice::step() const { return std::ldexp(1.0, exponent); }

WorldLattice WorldLattice::around(std::span<const double> positions, int exponent) {
    require_groups(positions.size(), 3, "positions", "numbers");
    if (exponent < smallest_exponent || exponent > largest_exponent)
        throw InvalidArgument("the lattice's step must be a power of two from 2^-100 to 2^100, not 2^" +
                              std::to_string(exponent));
    const CoordinateBounds bounds = bounds_of(positions);
    WorldLattice lattice{exponent, {}};
    for (int c = 0; c < 3 && !bounds.is_empty(); ++c) {
        const double steps = std::ldexp(bounds.low[c] / 2 + bounds.high[c] / 2, -exponent);
        if (!(std::abs(steps) < largest_world_steps))
            throw InvalidArgument("the positions lie too far from world zero for steps of 2^" +
                                  std::to_string(exponent) + ": the finest that fits is 2^" +
                                  std::to_string(finest_exponent(bounds, largest_steps)));
        lattice.origin[c] = static_cast<std::int64_t>(rounded_up_at_half(steps));
    }
    return lattice;
}

WorldLattice WorldLattice::fit(std::span<const double> positions) {
    require_groups(positions.size(), 3, "positions", "numbers");
    return around(positions, finest_exponent(bounds_of(positions), largest_steps / 2));
}

Float3 WorldLattice::snapped(const double* p) const {
    Float3 result{};
    for (int c = 0; c < 3; ++c) {
        const double steps = std::ldexp(p[c], -exponent);
        const double from_origin = std::abs(steps) < largest_world_steps
                                       ? rounded_up_at_half(steps) - static_cast<double>(origin[c])
                                       : std::numeric_limits<double>::infinity();
        if (!(std::abs(from_origin) <= largest_steps)) return {NAN, NAN, NAN};
        result[c] = static_cast<float>(std::ldexp(from_origin, exponent));
    }
    return result;
}

namespace {

/// The bounds of positions and of their mirror images at the lattice's origin: with the step at which they fit, the
/// positions lie within the reach of this origin.
CoordinateBounds bounds_about_origin(const WorldLattice& lattice, std::span<const double> positions) {
    CoordinateBounds bounds = bounds_of(positions);
    if (bounds.is_empty()) return bounds;
    const glm::dvec3 origin = loaded(lattice.world_of({0, 0, 0}));
    const glm::dvec3 reach = max(abs(bounds.low - origin), abs(bounds.high - origin));
    bounds.low = origin - reach;
    bounds.high = origin + reach;
    return bounds;
}

}  // namespace

WorldLattice::Snapped WorldLattice::snap(std::span<const double> positions) const {
    require_groups(positions.size(), 3, "positions", "numbers");
    Snapped result{std::vector<float>(positions.size()), 0};
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const double* p = &positions[i];
        const Float3 at = snapped(p);
        const bool is_absent = !is_finite(p);
        if (std::isnan(at[0]) && !is_absent)
            throw InvalidArgument(
                "row " + std::to_string(i / 3) + " " + text_of(p) + " lies more than 2^24 steps of 2^" +
                std::to_string(exponent) +
                " from the lattice's origin: the finest step that fits these positions is 2^" +
                std::to_string(finest_exponent(bounds_about_origin(*this, positions), largest_steps)));
        std::copy(at.begin(), at.end(), &result.positions[i]);
        if (!is_absent)
            result.largest_move = std::max(result.largest_move, largest_coordinate(loaded(world_of(at)) - loaded(p)));
    }
    return result;
}

std::vector<float> WorldLattice::lift(std::span<const double> positions, std::span<const double> normals) const {
    require_groups(positions.size(), 3, "positions", "numbers");
    if (normals.size() != positions.size())
        throw InvalidArgument("there are " + std::to_string(normals.size() / 3) + " normals for " +
                              std::to_string(positions.size() / 3) + " positions");
    std::vector<double> lifted(positions.begin(), positions.end());
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const glm::dvec3 normal = loaded(&normals[i]);
        const double largest = largest_coordinate(normal);
        if (!(largest > 0) || !std::isfinite(largest))
            throw InvalidArgument("normal " + std::to_string(i / 3) + " " + text_of(&normals[i]) +
                                  " is zero or not finite: a point is lifted along a direction");
        const glm::dvec3 n = normal / largest, move = std::ldexp(lift_steps, exponent) / length(n) * n;
        for (int c = 0; c < 3; ++c) lifted[i + std::size_t(c)] += move[c];
    }
    return snap(lifted).positions;
}

std::array<double, 3> WorldLattice::world_of(const Float3& p) const {
    std::array<double, 3> world{};
    for (int c = 0; c < 3; ++c) world[c] = std::ldexp(static_cast<double>(origin[c]), exponent) + p[c];
    return world;
}

std::vector<float> WorldLattice::rebased(std::span<const float> positions, const WorldLattice& other) const {
    if (other.exponent != exponent)
        throw InvalidArgument("positions on steps of 2^" + std::to_string(exponent) +
                              " cannot move to a lattice with steps of 2^" + std::to_string(other.exponent));
    std::vector<float> moved(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double steps = std::ldexp(static_cast<double>(positions[i]), -exponent) +
                             static_cast<double>(origin[i % 3] - other.origin[i % 3]);
        if (std::abs(steps) > largest_steps)
            throw InvalidArgument("row " + std::to_string(i / 3) + " lies more than 2^24 steps of 2^" +
                                  std::to_string(exponent) + " from the new origin: take a coarser lattice");
        moved[i] = static_cast<float>(std::ldexp(steps, exponent));
    }
    return moved;
}

}  // namespace gnomon
