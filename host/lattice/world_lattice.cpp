// SPDX-License-Identifier: MIT
// World coordinates in float64, snapped to a lattice whose points near an origin are float32 values (numerics.md, 13).
#include <gnomon.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace gnomon {
namespace {

constexpr double largest_steps = 0x1p24;        // from the origin: float32 holds every whole number up to here
constexpr double largest_world_steps = 0x1p46;  // from world zero: a double then has six bits below the step
constexpr int smallest_exponent = -100, largest_exponent = 100;

/// floor(steps + 1/2), without the rounding of that sum. |steps| is below 2^52.
double rounded_up_at_half(double steps) {
    const double below = std::floor(steps);
    return steps - below >= 0.5 ? below + 1 : below;  // the difference is exact: both have the ulp of `steps`
}

std::string text_of(const double* p) {
    char text[96];
    std::snprintf(text, sizeof(text), "(%.17g, %.17g, %.17g)", p[0], p[1], p[2]);
    return text;
}

struct Bounds {
    std::array<double, 3> low, high;
    bool is_empty() const { return !(low[0] <= high[0]); }
    double centre(int c) const { return low[c] / 2 + high[c] / 2; }
};

// The bounds of the finite positions.
Bounds bounds_of(std::span<const double> positions) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Bounds b{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
        const double* p = &positions[i];
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
        for (int c = 0; c < 3; ++c) b.low[c] = std::min(b.low[c], p[c]), b.high[c] = std::max(b.high[c], p[c]);
    }
    return b;
}

// The finest step at which `bounds` lie within `steps` of an origin at their centre, and within the world's range.
int finest_exponent(const Bounds& bounds, double steps) {
    double reach = 0, farthest = 0;
    for (int c = 0; c < 3 && !bounds.is_empty(); ++c) {
        reach = std::max(reach, bounds.high[c] / 2 - bounds.low[c] / 2);
        farthest = std::max({farthest, std::abs(bounds.low[c]), std::abs(bounds.high[c])});
    }
    int exponent = smallest_exponent;
    // One step more than the reach: the origin and the positions are rounded by half a step each.
    while (exponent < largest_exponent &&
           (reach > std::ldexp(steps - 1, exponent) || farthest > std::ldexp(largest_world_steps - 1, exponent)))
        ++exponent;
    return exponent;
}

void require_triples(std::span<const double> values, const char* what) {
    if (values.size() % 3 != 0)
        throw InvalidArgument(std::string(what) + " take 3 numbers each, and " + std::to_string(values.size()) +
                              " were given");
}

}  // namespace

double WorldLattice::step() const { return std::ldexp(1.0, exponent); }

WorldLattice WorldLattice::around(std::span<const double> positions, int exponent) {
    require_triples(positions, "positions");
    if (exponent < smallest_exponent || exponent > largest_exponent)
        throw InvalidArgument("the lattice's step must be a power of two from 2^-100 to 2^100, not 2^" +
                              std::to_string(exponent));
    const Bounds bounds = bounds_of(positions);
    WorldLattice lattice{exponent, {}};
    for (int c = 0; c < 3 && !bounds.is_empty(); ++c) {
        const double steps = std::ldexp(bounds.centre(c), -exponent);
        if (!(std::abs(steps) < largest_world_steps))
            throw InvalidArgument("the positions lie too far from world zero for steps of 2^" +
                                  std::to_string(exponent) + ": the finest that fits is 2^" +
                                  std::to_string(finest_exponent(bounds, largest_steps)));
        lattice.origin[c] = static_cast<std::int64_t>(rounded_up_at_half(steps));
    }
    return lattice;
}

WorldLattice WorldLattice::fit(std::span<const double> positions) {
    require_triples(positions, "positions");
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

WorldLattice::Snapped WorldLattice::snap(std::span<const double> positions) const {
    require_triples(positions, "positions");
    Snapped result{std::vector<float>(positions.size()), 0};
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const double* p = &positions[i];
        const Float3 at = snapped(p);
        const bool is_absent = !std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]);
        if (std::isnan(at[0]) && !is_absent)
            throw InvalidArgument("row " + std::to_string(i / 3) + " " + text_of(p) +
                                  " lies more than 2^24 steps of 2^" + std::to_string(exponent) +
                                  " from the lattice's origin: the finest step that fits these positions is 2^" +
                                  std::to_string(finest_exponent(bounds_of(positions), largest_steps)));
        std::copy(at.begin(), at.end(), &result.positions[i]);
        const std::array<double, 3> world = world_of(at);
        for (int c = 0; c < 3 && !is_absent; ++c)
            result.largest_move = std::max(result.largest_move, std::abs(world[c] - p[c]));
    }
    return result;
}

std::vector<float> WorldLattice::lift(std::span<const double> positions, std::span<const double> normals) const {
    require_triples(positions, "positions");
    if (normals.size() != positions.size())
        throw InvalidArgument("there are " + std::to_string(normals.size() / 3) + " normals for " +
                              std::to_string(positions.size() / 3) + " positions");
    std::vector<double> lifted(positions.begin(), positions.end());
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const double* n = &normals[i];
        const double largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
        if (!(largest > 0) || !std::isfinite(largest))
            throw InvalidArgument("normal " + std::to_string(i / 3) + " " + text_of(n) +
                                  " is zero or not finite: a point is lifted along a direction");
        const double x = n[0] / largest, y = n[1] / largest, z = n[2] / largest;
        const double scale = std::ldexp(lift_steps, exponent) / std::sqrt(x * x + y * y + z * z);
        lifted[i] += scale * x, lifted[i + 1] += scale * y, lifted[i + 2] += scale * z;
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
