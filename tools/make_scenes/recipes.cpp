// SPDX-License-Identifier: MIT
// The list of scenes.
#include "recipes.hpp"

#include <array>

namespace gnomon::make_scenes {

std::span<const Recipe> recipes() {
    constexpr std::uint32_t most = 20'000'000;
    static constexpr std::array list{
        Recipe{"empty", make_empty, "no triangles at all, only a camera and a light"},
        Recipe{"single_triangle", make_single_triangle, "one triangle and nothing it could shadow"},
        Recipe{"two_triangles_one_edge", make_two_triangles_one_edge,
               "an occluder folded along one shared edge must not leak through it"},
        Recipe{"needle", make_needle, "skinny, nearly parallel triangles: a fan of needles and a stack of them"},
        Recipe{
            "coplanar_pair", make_coplanar_pair,
            "coincident triangles (same and opposite winding), overlapping coplanar ones, a rug in the floor's plane"},
        Recipe{"light_in_plane", make_light_in_plane,
               "fins exactly edge-on to the light, directional and point, beside one honest caster"},
        Recipe{"one_sided_plane", make_one_sided_plane,
               "open planes without thickness, wound either way: both faces cast"},
        Recipe{"degenerate", make_degenerate, "points, lines and zero-area triangles among good ones"},
        Recipe{"lattice", make_lattice,
               "integer blocks under lights along the axes and diagonals: exact ties everywhere"},
        Recipe{"tessellated_floor", make_tessellated_floor,
               "exactly flat fine floors, one level, one tilted, at grazing light: no self-shadow"},
        Recipe{"concave_corners", make_concave_corners, "a room's corner, stairs, a groove and an acute wedge"},
        Recipe{"one_over_everything", make_one_over_everything, "one giant triangle over a small yard"},
        Recipe{"millimetres_in_kilometres", make_millimetres_in_kilometres,
               "pins and dice of millimetres on a plain of kilometres"},
        Recipe{"cathedral_far", make_cathedral_far,
               "a nave a million metres from the origin, where float32 steps are 62 mm"},
        Recipe{"closed_box_lit_inside", make_closed_box_lit_inside,
               "closed meshes with lamps inside, outside and within them"},
        Recipe{"sphere_closed", make_sphere_closed, "a closed, finely divided sphere on a floor"},
        Recipe{"pillars_point_light", make_pillars_point_light, "pillars around a point light and under a spot"},
        Recipe{"thin_wires", make_thin_wires, "wires a millimetre thick, far thinner than a pixel or a texel", true,
               true},
        Recipe{"grass", make_grass, "a lawn of bent blades", true, true},
        Recipe{"million_slivers", make_million_slivers,
               "slivers that all cross over the same few millimetres: one texel sees every one", true, true, 2'000, 10,
               most},
        Recipe{"far_bush", make_far_bush, "a bush of tiny leaves, so far off that all are within 30 x 30 pixels", false,
               true, 200'000, 10, most},
        Recipe{"leaves", make_leaves, "leaves, wires and a veil, cut out by textures and by the alpha of vertices",
               true, true},
        Recipe{"colonnade", make_colonnade,
               "a columned hall with steps, beams and a roof with openings: large polygons", false, true, 300'000,
               10'000, most},
        Recipe{"city", make_city, "blocks of houses and towers with recessed windows", false, true, 6'500'000, 10'000,
               most},
        Recipe{"foliage", make_foliage, "an arcaded courtyard with trees, bushes and ivy: small triangles in disorder",
               false, true, 5'300'000, 10'000, most},
        Recipe{"pipes", make_pipes, "a plant of pipes with elbows and flanges in a steel frame, with vessels", false,
               true, 12'800'000, 10'000, most},
        Recipe{"town", make_town,
               "streets of houses with gable roofs, terraces, flats, gardens and trees: closed solids", false, true,
               60'000, 10'000, most},
        Recipe{"terrain", make_terrain, "a fractal height field over two kilometres, an open sheet", false, true,
               8'000'000, 10'000, most},
    };
    return list;
}

}  // namespace gnomon::make_scenes
