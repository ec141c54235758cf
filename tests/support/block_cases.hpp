// SPDX-License-Identifier: MIT
// Blocks of points, each with a bundle of lights and a leaf's triangles: bundles from an ulp wide to wide, blocks from
// one position to a scene's size, point lights near and far, triangles that rays meet exactly at corners and edges,
// that are edge-on, slivers, or have no area, at ordinary coordinates and near the largest that beams take.
#pragma once

#include "bvh/wide_bvh.hpp"
#include "device.hpp"
#include "kernels/beams/beam.h"
#include "lights/light_bundles.hpp"
#include "reference/stages/grid_map.hpp"
#include "tie_points.hpp"

namespace support {

using reference::Wide3;

struct BlockCase {
    std::vector<Float3> points;  ///< as many as a block has
    std::vector<Light> lights;   ///< by their slots in the bundle
    gnomon::LightBundle bundle;
    std::vector<reference::Triangle> triangles;  ///< as many as a leaf has
    Float3 normal{};                             ///< of the points' surface, or 0
    double scale = 1;                            ///< of the scene
    std::array<double, 3> middle{};

    bool are_positions() const { return lights[0][3] != 0; }
    /// Of points, triangles and point lights.
    float largest() const {
        float largest = 0;
        const auto take = [&](const Float3& v) {
            for (const float c : v) largest = std::max(largest, std::abs(c));
        };
        for (const Float3& p : points) take(p);
        for (const reference::Triangle& t : triangles) std::ranges::for_each(t, take);
        if (are_positions())
            for (const Light& l : lights) take({l[0], l[1], l[2]});
        return largest;
    }
};

/// The bound of rounding errors that beams are given for a largest coordinate (LightMasks::params_of()).
inline float beam_rounding(float largest, bool are_positions) {
    return (are_positions ? BEAM_ROUNDING_OF_POSITIONS : BEAM_ROUNDING) * largest + BEAM_ROUNDING_LEAST;
}

/// P + t D, where D is the light's direction or runs from P to the light.
inline Wide3 place_on_ray(const Float3& p, const Light& light, long double t) {
    Wide3 place;
    for (int c = 0; c < 3; ++c) place[c] = p[c] + t * (light[3] == 0 ? light[c] : (long double)(light[c]) - p[c]);
    return place;
}

/// A parameter of a place: the ray's begin, near it, before the light, or a point light itself.
inline long double parameter_on_ray(Random& random, const BlockCase& of) {
    const std::uint32_t kind = random.below(6);
    if (kind == 0) return 0;
    if (kind == 1 && of.are_positions()) return 1;
    const double t = random.between(0, 1);
    return (kind == 2 ? t * t * t * t : t) * (of.are_positions() ? 1 : 2 * of.scale);
}

inline Float3 rounded(const Wide3& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

namespace detail {

inline Float3 moved_by(const Wide3& v, const Float3& by, double scale) {
    return {float(v[0] + scale * by[0]), float(v[1] + scale * by[1]), float(v[2] + scale * by[2])};
}

/// A triangle at a place on a ray of the block.
inline reference::Triangle tight_triangle(Random& random, const BlockCase& of) {
    const Float3& p = of.points[random.below(std::uint32_t(of.points.size()))];
    const Light& light = of.lights[random.below(std::uint32_t(of.lights.size()))];
    const long double t = parameter_on_ray(random, of);
    const Wide3 x = place_on_ray(p, light, t);
    const double size = of.scale * std::exp2(-double(random.below(9)));
    const Float3 u = random_vector(random, -1, 1), v = random_vector(random, -1, 1), w = random_vector(random, -1, 1);
    switch (random.below(8)) {
        case 0:
            return {rounded(x), moved_by(x, u, size), moved_by(x, v, size)};  // a corner on the ray
        case 1:
            return {moved_by(x, u, size), moved_by(x, u, -size), moved_by(x, v, size)};  // an edge
        case 2:
            return {rounded(x), rounded(place_on_ray(p, light, t / 2)), moved_by(x, v, size)};  // edge-on
        case 3:
            return {moved_by(x, u, size), moved_by(x, u, -size), moved_by(x, v, 1e-6 * size)};  // a sliver
        case 4:
            return {moved_by(x, u, size), moved_by(x, u, size), moved_by(x, v, size)};  // no area
        case 5:
            return {p, moved_by(x, u, size), moved_by(x, v, size)};  // touches the point
        case 6:
            return {moved_by(x, u, 9 * size), moved_by(x, v, 9 * size), moved_by(x, w, 9 * size)};
        default:
            return {moved_by(x, u, size), moved_by(x, v, size), moved_by(x, w, size)};
    }
}

inline void set_lights(Random& random, BlockCase& of, bool are_positions, double spread, double away) {
    Float3 base = random_vector(random, -1, 1);
    if (random.below(2) == 0) base = {float(random.below(3)) - 1, 1, float(random.below(3)) - 1};
    std::vector<gnomon::Light> lights;
    const std::uint32_t counts[] = {1, 7, 32};
    for (std::uint32_t i = 0, count = counts[random.below(3)]; i < count; ++i) {
        Float3 v;
        for (int c = 0; c < 3; ++c)
            v[c] = float(are_positions ? of.middle[c] + of.scale * (away * base[c] + spread * random.between(-1, 1))
                                       : base[c] + spread * random.between(-1, 1));
        lights.push_back(are_positions ? gnomon::Light::point(v) : gnomon::Light::directional({-v[0], -v[1], -v[2]}));
    }
    const gnomon::LightBundles bundles = gnomon::make_light_bundles(lights, MAX_BUNDLE_LIGHTS).value();
    of.bundle = bundles.bundles[0];
    for (std::uint32_t slot = 0; slot < of.bundle.light_count; ++slot)
        of.lights.push_back(lights[bundles.lights[slot]].xyzw);
}

}  // namespace detail

/// `width`: points of a block, and triangles of a leaf.
inline std::vector<BlockCase> block_cases(std::size_t width, bool are_positions) {
    struct Place {
        double scale;
        std::array<double, 3> middle;
    };
    const Place places[] = {{1, {0, 0, 0}}, {1e-4, {0, 0, 0}}, {16, {0x1p18, -0x1p18, 0x1p17}}, {0x1p15, {0, 0, 0}}};
    std::vector<BlockCase> cases;
    Random random(71);
    for (const Place& place : places)
        for (const double spread : {1e-7, 1e-3, 0.03, 0.4})
            for (const double size : {0.0, 1e-3, 0.1, 1.0}) {
                BlockCase made;
                made.scale = place.scale;
                made.middle = place.middle;
                detail::set_lights(random, made, are_positions, spread, size == 0.1 ? 0.05 : 2);
                for (std::size_t i = 0; i < width; ++i) {
                    Float3 p;
                    for (int c = 0; c < 3; ++c)
                        p[c] = float(place.middle[c] + place.scale * size * random.between(-1, 1));
                    made.points.push_back(p);
                }
                for (std::size_t i = 0; i < width; ++i) made.triangles.push_back(detail::tight_triangle(random, made));
                if (random.below(3) != 0) made.normal = random_vector(random, -1, 1);
                cases.push_back(made);
            }
    return cases;
}

/// A leaf of the tree: rows of the corners' coordinates.
inline void append_leaf(Floats& leaves, const std::vector<reference::Triangle>& triangles) {
    for (int corner = 0; corner < 3; ++corner)
        for (int c = 0; c < 3; ++c)
            for (const reference::Triangle& t : triangles) leaves.push_back(t[corner][c]);
}

}  // namespace support
