// SPDX-License-Identifier: MIT
// Makers of small scenes, each hard for one reason, the same on every machine (reference::Random, no std distribution),
// shared by the tests of the stages and of the whole pipeline. Triangles are packed, 9 floats each; points 3 each.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "reference/scenes_for_tests.hpp"

namespace support {

using reference::Float3;
using reference::Random;
using Floats = std::vector<float>;
using Light = std::array<float, 4>;  ///< w = 0: minus the direction of travel; w = 1: the position

inline Light along(float x, float y, float z) { return {-x, -y, -z, 0}; }
inline Light at(float x, float y, float z) { return {x, y, z, 1}; }

inline void add(Floats& floats, const Float3& v) { floats.insert(floats.end(), v.begin(), v.end()); }
inline void add(Floats& triangles, const Float3& a, const Float3& b, const Float3& c) {
    for (const Float3& v : {a, b, c}) add(triangles, v);
}
inline void append(Floats& to, const Floats& from) { to.insert(to.end(), from.begin(), from.end()); }
inline Float3 vertex(const Floats& triangles, std::size_t index) {
    return {triangles[3 * index], triangles[3 * index + 1], triangles[3 * index + 2]};
}

inline Float3 random_vector(Random& random, float low, float high) {
    Float3 v;
    for (float& x : v) x = random.between(low, high);
    return v;
}

/// `count` triangles in [-1, 1]^3, sides of up to `size`.
inline Floats soup(std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const Float3 center = random_vector(random, -1, 1);
        for (int k = 0; k < 3; ++k) {
            Float3 v = random_vector(random, -size, size);
            for (int c = 0; c < 3; ++c) v[c] += center[c];
            add(triangles, v);
        }
    }
    return triangles;
}

inline Floats random_points(std::size_t count, float low, float high, std::uint64_t seed) {
    Random random(seed);
    Floats points;
    for (std::size_t i = 0; i < count; ++i) add(points, random_vector(random, low, high));
    return points;
}

/// `count` needles of `length` from one tip at the origin, all around in the plane y = 0 and `width` wide at the end:
/// neighbours share an edge, so together they are a closed disc.
inline Floats needle_fan(std::size_t count, float length) {
    Floats triangles;
    const auto rim = [&](std::size_t i) -> Float3 {
        const double angle = 2 * std::numbers::pi * double(i % count) / double(count);
        return {float(length * std::cos(angle)), 0, float(length * std::sin(angle))};
    };
    for (std::size_t i = 0; i < count; ++i) add(triangles, {0, 0, 0}, rim(i), rim(i + 1));
    return triangles;
}

/// A closed sphere around the origin: an icosahedron, each triangle divided into 4 `subdivisions` times. Neighbours
/// share their vertices bit by bit.
inline Floats icosphere(int subdivisions, float radius) {
    const auto on_sphere = [&](std::array<double, 3> v) -> Float3 {
        const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        return {float(radius * v[0] / length), float(radius * v[1] / length), float(radius * v[2] / length)};
    };
    const double g = std::numbers::phi;
    const std::array<std::array<double, 3>, 12> corners = {{{-1, g, 0},
                                                            {1, g, 0},
                                                            {-1, -g, 0},
                                                            {1, -g, 0},
                                                            {0, -1, g},
                                                            {0, 1, g},
                                                            {0, -1, -g},
                                                            {0, 1, -g},
                                                            {g, 0, -1},
                                                            {g, 0, 1},
                                                            {-g, 0, -1},
                                                            {-g, 0, 1}}};
    constexpr int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    Floats triangles;
    for (const auto& face : faces)
        add(triangles, on_sphere(corners[face[0]]), on_sphere(corners[face[1]]), on_sphere(corners[face[2]]));
    for (int level = 0; level < subdivisions; ++level) {
        Floats finer;
        // a + b is rounded the same as b + a: both neighbours make the same vertex.
        const auto middle = [&](const Float3& a, const Float3& b) {
            return on_sphere({double(a[0]) + b[0], double(a[1]) + b[1], double(a[2]) + b[2]});
        };
        for (std::size_t i = 0; i < triangles.size() / 9; ++i) {
            const Float3 a = vertex(triangles, 3 * i), b = vertex(triangles, 3 * i + 1),
                         c = vertex(triangles, 3 * i + 2);
            const Float3 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            add(finer, a, ab, ca);
            add(finer, ab, b, bc);
            add(finer, ca, bc, c);
            add(finer, ab, bc, ca);
        }
        triangles = std::move(finer);
    }
    return triangles;
}

/// Unit cubes in random cells of an integer lattice of `side` cells: coincident faces, shared edges, vertices.
inline Floats lattice_blocks(std::size_t count, std::uint32_t side, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const Float3 corner = {float(random.below(side)), float(random.below(side)), float(random.below(side))};
        for (int axis = 0; axis < 3; ++axis)
            for (int far = 0; far < 2; ++far) {
                const auto at_corner = [&](int u, int v) {
                    Float3 p = corner;
                    p[axis] += float(far);
                    p[(axis + 1) % 3] += float(u);
                    p[(axis + 2) % 3] += float(v);
                    return p;
                };
                add(triangles, at_corner(0, 0), at_corner(1, 0), at_corner(1, 1));
                add(triangles, at_corner(0, 0), at_corner(1, 1), at_corner(0, 1));
            }
    }
    return triangles;
}

/// Points on the lattice's vertices, edges and faces and in cells: multiples of a half.
inline Floats lattice_points(std::size_t count, std::uint32_t side, std::uint64_t seed) {
    Random random(seed);
    Floats points;
    for (std::size_t i = 0; i < 3 * count; ++i) points.push_back(float(random.below(2 * side + 3)) * 0.5f - 0.5f);
    return points;
}

/// Slivers of length 2 and a width of `width` at heights between 0 and 1, all across the y axis.
inline Floats slivers(std::size_t count, float width, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const float angle = random.between(0, float(2 * std::numbers::pi)), height = random.between(0.1f, 1);
        const float c = std::cos(angle), s = std::sin(angle), shift = random.between(-width, width);
        const auto place = [&](float u, float v) { return Float3{u * c - v * s, height + 0.1f * u, u * s + v * c}; };
        add(triangles, place(-1, shift), place(1, shift), place(random.between(-1, 1), shift + width));
    }
    return triangles;
}

/// Every triangle's vertices in turn as [1] [0] [2]: the other face in front.
inline Floats reversed_winding(Floats triangles) {
    for (std::size_t i = 0; i < triangles.size(); i += 9)
        for (std::size_t c = 0; c < 3; ++c) std::swap(triangles[i + c], triangles[i + 3 + c]);
    return triangles;
}

/// v * scale + offset, rounded once per coordinate: a new scene, not an equivalent one.
inline Floats placed(Floats floats, double scale, const std::array<double, 3>& offset) {
    for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = static_cast<float>(floats[i] * scale + offset[i % 3]);
    return floats;
}

/// Each coordinate, less than 4 in size, on the grid of 2^-20, so that midpoints are exact floats.
inline Floats on_grid(Floats floats) {
    for (float& v : floats) v = std::ldexp(std::round(std::ldexp(v, 20)), -20);
    return floats;
}
/// The middle of each triangle's first edge: in the triangle's plane, which no arithmetic but integers can tell where
/// coordinates have many bits.
inline Floats edge_middles(const Floats& triangles) {
    Floats middles;
    for (std::size_t i = 0; i + 9 <= triangles.size(); i += 9)
        for (std::size_t c = 0; c < 3; ++c) middles.push_back((triangles[i + c] + triangles[i + 3 + c]) / 2);
    return middles;
}

/// A permutation that takes new index to old (Fisher and Yates).
inline std::vector<std::uint32_t> shuffled_order(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
    for (auto left = static_cast<std::uint32_t>(count); left > 1; --left)
        std::swap(order[left - 1], order[random.below(left)]);
    return order;
}

}  // namespace support
