// SPDX-License-Identifier: MIT
// Views of shadow maps made by hand, and their truth in double: the ray of a texel's centre and its first intersection.
// Shares only the contract with the kernels (kernels/rivals/rasterizer/map_view.h).
#pragma once

#include <functional>
#include <limits>

#include "device.hpp"
#include "rivals/shadow_map/map_projection.hpp"
#include "scene_makers.hpp"

namespace support {

struct Double2 {
    double x, y;
};
struct RayOfLight {
    std::array<double, 3> origin, direction;  ///< depth of origin + s direction is s times depth_per_s
    double depth_per_s;
};

/// A view, and its truth: the ray through (u, v), and (u, v) of a warped position in the map.
struct ViewCase {
    std::string name;
    gnomon::MapView view;
    std::vector<float> tables;  ///< of a rectilinear warp, from forward_first = 0 on
    std::function<RayOfLight(Double2)> ray;
    std::function<Double2(Double2)> unwarp = [](Double2 at) { return at; };
};

inline gnomon::MapView bare_view(std::uint32_t width, std::uint32_t height) {
    gnomon::MapView view{};
    view.front_depth = -std::numeric_limits<float>::infinity();
    view.face = NO_FACE;
    view.select_near = -std::numeric_limits<float>::infinity();
    view.select_far = view.blend_from = std::numeric_limits<float>::infinity();
    view.width = view.row_stride = width;
    view.height = height;
    return view;
}

inline void set_row(float* row, const std::array<float, 4>& values) { std::copy(values.begin(), values.end(), row); }

/// Light along +z over the unit square: u = x, v = y, depth = z.
inline ViewCase straight_view(std::uint32_t width, std::uint32_t height) {
    ViewCase c{"straight", bare_view(width, height), {}, {}};
    set_row(c.view.row_u, {1, 0, 0, 0});
    set_row(c.view.row_v, {0, 1, 0, 0});
    set_row(c.view.row_w, {0, 0, 0, 1});
    set_row(c.view.row_depth, {0, 0, 1, 0});
    c.ray = [](Double2 at) { return RayOfLight{{at.x, at.y, 0}, {0, 0, 1}, 1}; };
    return c;
}

/// The same light, seen through u = x / w, v = y / w with w = sign (1 + x / 2): the ends of rows are 1.5 times as dense
/// as their beginnings. With sign -1 every w is negative.
inline ViewCase projective_view(std::uint32_t width, std::uint32_t height, float sign) {
    ViewCase c = straight_view(width, height);
    c.name = sign > 0 ? "projective" : "projective, w below 0";
    set_row(c.view.row_u, {1.5f * sign, 0, 0, 0});
    set_row(c.view.row_v, {0, sign, 0, 0});
    set_row(c.view.row_w, {0.5f * sign, 0, 0, sign});
    c.ray = [](Double2 at) {
        const double x = at.x / (1.5 - 0.5 * at.x);  // u = 1.5 x / (1 + x / 2)
        return RayOfLight{{x, at.y * (1 + x / 2), 0}, {0, 0, 1}, 1};
    };
    return c;
}

/// A point light at the origin with a view along +z and a right angle: u = (x / z + 1) / 2, depth = z.
inline ViewCase perspective_view(std::uint32_t width, std::uint32_t height) {
    ViewCase c{"positional", bare_view(width, height), {}, {}};
    set_row(c.view.row_u, {0.5f, 0, 0.5f, 0});
    set_row(c.view.row_v, {0, 0.5f, 0.5f, 0});
    set_row(c.view.row_w, {0, 0, 1, 0});
    set_row(c.view.row_depth, {0, 0, 1, 0});
    c.view.front_depth = 0;
    c.ray = [](Double2 at) { return RayOfLight{{0, 0, 0}, {2 * at.x - 1, 2 * at.y - 1, 1}, 1}; };
    return c;
}

inline ViewCase logarithmic_view(std::uint32_t width, std::uint32_t height) {
    ViewCase c = straight_view(width, height);
    c.name = "logarithmic";
    c.view.warp = WARP_LOGARITHMIC;
    c.view.log_strength = 20;
    c.unwarp = [](Double2 at) { return Double2{at.x, (std::pow(21.0, at.y) - 1) / 20}; };
    return c;
}

/// u has two segments: the first half of the scene takes three quarters of the map. v has one straight segment.
inline ViewCase rectilinear_view(std::uint32_t width, std::uint32_t height) {
    ViewCase c = straight_view(width, height);
    c.name = "rectilinear";
    c.view.warp = WARP_RECTILINEAR;
    c.view.warp_size = 2;
    c.tables = {0, 0.75f, 1, 0, 0.5f, 1};
    c.unwarp = [](Double2 at) { return Double2{at.x < 0.75 ? at.x / 1.5 : 0.5 + (at.x - 0.75) * 2, at.y}; };
    return c;
}

inline std::vector<ViewCase> view_cases(std::uint32_t width, std::uint32_t height) {
    return {straight_view(width, height),    projective_view(width, height, 1), projective_view(width, height, -1),
            perspective_view(width, height), logarithmic_view(width, height),   rectilinear_view(width, height)};
}

/// The views of all cases in one map, one after the other.
inline gnomon::MapViews uploaded_views(gnomon::cl::Session& session, std::vector<ViewCase>& cases) {
    gnomon::MapViews map_views;
    std::vector<float> tables;
    std::vector<gnomon::MapView> views;
    map_views.set.view_count = static_cast<std::uint32_t>(cases.size());
    for (ViewCase& c : cases) {
        c.view.forward_first = static_cast<std::uint32_t>(tables.size());
        tables.insert(tables.end(), c.tables.begin(), c.tables.end());
        c.view.centres_first = static_cast<std::uint32_t>(tables.size());
        tables.resize(tables.size() + c.view.width + c.view.height);
        c.view.first_texel = map_views.set.texels;
        map_views.set.texels += c.view.width * c.view.height;
        map_views.set.texels_per_view = std::max(map_views.set.texels_per_view, c.view.width * c.view.height);
        views.push_back(c.view);
    }
    map_views.views = uploaded(session, views);
    map_views.tables = uploaded(session, tables);
    gnomon::fill_centres(session, map_views);
    return map_views;
}

struct Triangles {
    gnomon::cl::Buffer vertices;
    gnomon::TriangleInputs inputs;
};
inline Triangles uploaded_triangles(gnomon::cl::Session& session, const Floats& vertices) {
    Triangles triangles{uploaded(session, vertices), {}};
    triangles.inputs = {{.first_float = 0, .count = static_cast<cl_uint>(vertices.size() / 9), .padding = 0},
                        triangles.vertices.get(),
                        nullptr,
                        false};
    return triangles;
}

}  // namespace support
