// SPDX-License-Identifier: MIT
// What the scene maker can make: one recipe per scene, found by name.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "glb.hpp"

namespace gnomon::make_scenes {

struct Request {
    std::uint64_t triangles = 0;  ///< wanted; ignored by scenes of a fixed size
    std::uint64_t seed = 1;       ///< ignored by scenes without chance
};

struct Recipe {
    std::string_view name;
    Scene (*make)(const Request&);
    std::string_view idea;                ///< one line
    bool is_committed = true;             ///< small: lies in scenes/ and is written by --all
    bool has_seed = false;                ///< something in it is random
    std::uint32_t default_triangles = 0;  ///< 0: the size is fixed
    std::uint32_t fewest_triangles = 0, max_triangles = 0;
};

/// All recipes, small ones first, in the order they are listed.
std::span<const Recipe> recipes();

/// The triangles wanted that are not there yet.
inline std::uint64_t missing_triangles(const Scene& scene, std::uint64_t wanted) {
    const std::uint64_t count = scene.triangle_count();
    return count < wanted ? wanted - count : 0;
}

// Provenance about edges and planes (edge_scenes.cpp).
Scene make_empty(const Request&);
Scene make_single_triangle(const Request&);
Scene make_two_triangles_one_edge(const Request&);
Scene make_needle(const Request&);
Scene make_coplanar_pair(const Request&);
Scene make_light_in_plane(const Request&);
Scene make_one_sided_plane(const Request&);
Scene make_degenerate(const Request&);
Scene make_lattice(const Request&);
Scene make_tessellated_floor(const Request&);
Scene make_concave_corners(const Request&);

// Scale, number and closedness (small_scenes.cpp).
Scene make_one_over_everything(const Request&);
Scene make_millimetres_in_kilometres(const Request&);
Scene make_cathedral_far(const Request&);
Scene make_closed_box_lit_inside(const Request&);
Scene make_sphere_closed(const Request&);
Scene make_pillars_point_light(const Request&);
Scene make_thin_wires(const Request&);
Scene make_grass(const Request&);
Scene make_million_slivers(const Request&);
Scene make_far_bush(const Request&);

// Cut-outs (leaves.cpp).
Scene make_leaves(const Request&);

// Large scenes, each in its own file.
Scene make_colonnade(const Request&);
Scene make_city(const Request&);
Scene make_foliage(const Request&);
Scene make_pipes(const Request&);
Scene make_town(const Request&);
Scene make_terrain(const Request&);

}  // namespace gnomon::make_scenes
