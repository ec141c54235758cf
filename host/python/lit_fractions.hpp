// SPDX-License-Identifier: MIT
// The lit share of planar triangles under directional lights, as intervals that contain the truth.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gnomon::python {

struct LitFractionsSettings {
    double within;        // an interval is refined until it is at most this wide
    std::uint64_t limit;  // subtractions for one triangle and one light, after which it stays as it is
    unsigned threads;
    bool centroids;
    std::function<bool()> goes_on;  // asked some times a second by the calling thread; false ends the work
};

// For each light and face, one after the other: lowest and highest lit share; the centroid of the part that is proven
// lit, in steps, NaN where there is none (empty unless asked for).
struct LitFractions {
    std::vector<double> low, high, centroid;
};

// A triangle's corners in whole steps of a lattice, at most 2^24 from its origin.
using LatticeTriangle = std::array<std::array<std::int32_t, 3>, 3>;

// What is found is whole unless goes_on() returned false. triangles: all occluders. face: of each triangle, from 0 on;
// negative: an occluder alone. Triangles of one face do not shadow each other. towards: to each light, x, y, z.
LitFractions lit_fractions(std::span<const LatticeTriangle> triangles, std::span<const std::int32_t> face,
                           std::uint32_t face_count, std::span<const float> towards,
                           const LitFractionsSettings& settings);

}  // namespace gnomon::python
