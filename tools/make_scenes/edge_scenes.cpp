// SPDX-License-Identifier: MIT
// Small scenes about single decisions: edges, planes, ties and degenerate triangles. Coordinates are dyadic wherever a
// scene claims something exact (coplanar, edge-on, on a lattice), so float32 holds them without rounding.
#include <initializer_list>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr std::array<double, 3> stone{0.70, 0.68, 0.63};
constexpr std::array<double, 3> red{0.72, 0.20, 0.15};
constexpr std::array<double, 3> blue{0.16, 0.32, 0.62};
constexpr std::array<double, 3> yellow{0.80, 0.62, 0.15};

}  // namespace

Scene make_empty(const Request&) {
    Scene scene;
    scene.camera("main", {0, 2, 6}, {0, 0, 0});
    scene.directional("sun", {-0.5, -1, -0.25});
    return scene;
}

Scene make_single_triangle(const Request&) {
    Scene scene;
    triangle(scene.part("red", red), {-2, 0, 1}, {2, 0, 1}, {0, 1.5, -2});
    scene.camera("main", {0, 3, 6}, {0, 0.5, 0});
    scene.directional("sun", {-0.5, -1, -0.25});
    return scene;
}

Scene make_two_triangles_one_edge(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -4, -4, 4, 4, 0);
    Part& occluder = scene.part("folded", red);
    const std::uint32_t left = occluder.vertex({-1.75, 1.5, 1.25});
    const std::uint32_t ridge_front = occluder.vertex({0.5, 2.5, 1.5});
    const std::uint32_t ridge_back = occluder.vertex({-0.25, 2.25, -1.5});
    const std::uint32_t right = occluder.vertex({2, 1.25, -0.5});
    occluder.triangle(left, ridge_front, ridge_back);
    occluder.triangle(ridge_back, ridge_front, right);
    scene.camera("main", {1, 6, 8}, {0, 0.75, 0});
    scene.directional("sun", {-0.25, -1, -0.375});
    scene.directional("straight_down", {0, -1, 0});
    return scene;
}

Scene make_needle(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -12, -6, 12, 6, 0);

    // A fan of 96 needles, 20 m long: neighbours share an edge and lean 1/16 degree apart, at varying heights.
    Part& fan = scene.part("fan", red);
    const std::uint32_t tip = fan.vertex({-10, 1, 0});
    std::uint32_t last = 0;
    for (int i = 0; i <= 96; ++i) {
        const CosineSine angle = cosine_sine((i - 48) / 5760.0);
        const double height = i % 2 == 0 ? 1.0 : 1.0 + i / 1024.0;
        const std::uint32_t end = fan.vertex({-10 + 20 * angle.cosine, height, 20 * angle.sine});
        if (i > 0) fan.triangle(tip, last, end);
        last = end;
    }

    // A stack of 64 free needles, each crossing the one below at a ten-thousandth of a turn, 1 mm above it.
    Part& stack = scene.part("stack", blue);
    for (int i = 0; i < 64; ++i) {
        const CosineSine angle = cosine_sine(i / 10000.0);
        const Vec3 along{angle.cosine, 0, angle.sine}, across{-angle.sine, 0, angle.cosine};
        const Vec3 center{0, 0.5 + i / 1000.0, 3};
        triangle(stack, center - along * 9, center + along * 9 - across * 0.0005, center + along * 9 + across * 0.0005);
    }
    scene.camera("main", {0, 6, 13}, {0, 0, 0});
    scene.directional("sun", {-0.125, -1, -0.25});
    scene.directional("along_the_needles", {1, -0.0625, 0.001});
    return scene;
}

Scene make_coplanar_pair(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -6, -4, 6, 4, 0);
    // A rug in the floor's own plane: points on either must not be shadowed by the other.
    floor_quad(scene.part("rug", blue), -5, 1, 5, 3, 0);

    Part& twins = scene.part("twins", red);
    const Vec3 a{-5, 2, -2}, b{-3, 2.5, -2.5}, c{-3.5, 1.5, 0};
    triangle(twins, a, b, c);
    triangle(twins, a, b, c);
    const Vec3 right{3.5, 0, 0};
    triangle(twins, a + right, b + right, c + right);
    triangle(twins, a + right, c + right, b + right);
    triangle(twins, b + right, a + right, c + right);

    // One rectangle twice, split along either diagonal, and a third that overlaps it in the plane y = 1 + (x - 2) / 4.
    Part& overlap = scene.part("overlap", yellow);
    const auto on_plane = [](double x, double z) { return Vec3{x, 1 + (x - 2) / 4, z}; };
    quad(overlap, on_plane(2, -2), on_plane(2, 0), on_plane(4, 0), on_plane(4, -2));
    quad(overlap, on_plane(4, -2), on_plane(2, -2), on_plane(2, 0), on_plane(4, 0));
    quad(overlap, on_plane(3, -1), on_plane(3, 1), on_plane(5, 1), on_plane(5, -1));
    scene.camera("main", {0, 6, 10}, {0, 0.5, 0});
    scene.directional("sun", {-0.25, -1, 0.25});
    scene.directional("straight_down", {0, -1, 0});
    return scene;
}

Scene make_light_in_plane(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -8, -8, 8, 8, 0);

    // Fins whose planes contain the sun's direction (1, -2, 0): they cast nothing. Some have an edge along it, too; the
    // last, askew to all axes, has none.
    Part& fins = scene.part("edge_on_to_sun", red);
    for (int i = 0; i < 6; ++i) {
        const double z = -6 + i;
        triangle(fins, {-6, 0, z}, {-4, 0, z}, {-5, 3, z});
    }
    triangle(fins, {-3, 4, -6}, {-1, 0, -6}, {-3, 4, -2});
    triangle(fins, {-1, 0, -6}, {-1, 0, -2}, {-3, 4, -2});
    triangle(fins, {-2, 4, 0}, {-1, 2, 0}, {-1, 3, 2});
    triangle(fins, {-3, 1, 1}, {-1, 0, 3}, {-2, 5, 5});

    // Fins whose planes contain the lamp at (4, 4, 0): each is lamp + u, lamp + v, lamp + u + v.
    Part& rays = scene.part("edge_on_to_lamp", blue);
    const Vec3 lamp{4, 4, 0};
    for (const auto& [u, v] :
         {std::pair{Vec3{1, -2, 1}, Vec3{1, -1, 2}}, std::pair{Vec3{-1, -1, 0}, Vec3{0, -1, 1}},
          std::pair{Vec3{0, -1, 0}, Vec3{2, -1, -3}}, std::pair{Vec3{1, -1, -1}, Vec3{-1, -1, -1}}}) {
        triangle(rays, lamp + u, lamp + v, lamp + u + v);
    }

    triangle(scene.part("honest_caster", yellow), {2, 1, 3}, {4, 1.5, 3}, {3, 1, 5});
    scene.camera("main", {2, 8, 13}, {0, 1, -1});
    scene.directional("sun", {1, -2, 0});
    scene.point("lamp", lamp);
    return scene;
}

Scene make_one_sided_plane(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -6, -6, 6, 6, 0);
    Part& up = scene.part("wound_up", red);
    floor_quad(up, -4, -3, -1, 0, 2);
    Part& down = scene.part("wound_down", blue);
    quad(down, {1, 2, -3}, {4, 2, -3}, {4, 2, 0}, {1, 2, 0});
    Part& screens = scene.part("screens", yellow);
    quad(screens, {-4, 0, 2}, {-1, 0, 2}, {-1, 1.5, 2}, {-4, 1.5, 2});
    quad(screens, {1, 0, 2}, {1, 1.5, 2}, {4, 1.5, 2}, {4, 0, 2});
    scene.camera("main", {0, 6, 11}, {0, 0.5, 0});
    scene.directional("sun", {-0.25, -1, 0.375});
    scene.directional("from_behind", {0.125, -0.5, 1});
    return scene;
}

Scene make_degenerate(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -6, -4, 6, 4, 0);

    // Over the left half nothing casts: every triangle there is a point or a line.
    Part& flat = scene.part("zero_area", red);
    const auto corner = flat.vertex({-4, 2, 0});
    const auto end = flat.vertex({-2, 2, 0});
    flat.triangle(corner, corner, corner);
    flat.triangle(corner, corner, end);
    flat.triangle(corner, end, end);
    flat.triangle(end, corner, end);
    triangle(flat, {-4, 1, 1}, {-3, 1.5, 1.5}, {-2, 2, 2});                // collinear
    triangle(flat, {-4, 1, -2}, {-2, 1, -2}, {-3, 1, -2});                 // collinear, the middle one last
    triangle(flat, {-5, 2, -1}, {-5, 2, -1}, {-5, 2, -1});                 // three vertices in one place
    triangle(flat, {-5, 2, 1}, {-5, 2, 1}, {-3, 1, 3});                    // two vertices in one place
    triangle(flat, {-1, 0, 0}, {-1, 0, 2}, {-1, 0, 1});                    // a line in the floor
    triangle(flat, {-3e30, 1e30, 0}, {-3e30, 1e30, 0}, {-3e30, 1e30, 0});  // a far point

    // The right half: good triangles, with degenerate ones sharing their vertices and edges.
    Part& good = scene.part("good", blue);
    const auto a = good.vertex({1, 1.5, -1});
    const auto b = good.vertex({4, 1.5, -1});
    const auto c = good.vertex({4, 2, 2});
    const auto d = good.vertex({1, 2, 2});
    const auto middle = good.vertex({2.5, 1.75, 0.5});  // on the diagonal ac
    good.triangle(a, b, c);
    good.triangle(a, middle, c);
    good.triangle(a, c, a);
    good.triangle(a, c, d);
    // Good, though its smallest side is one step of float32.
    triangle(good, {5, 1, -2}, {5, 1, 2}, {5.00000047683715820312, 1, 2});
    scene.camera("main", {0, 6, 10}, {0, 0.5, 0});
    scene.directional("sun", {-0.25, -1, -0.25});
    return scene;
}

Scene make_lattice(const Request&) {
    Scene scene;
    // The floor is a chequerboard of tiles: what travels upwards comes through its holes, along their very edges.
    Part& tiles = scene.part("tiles", stone);
    for (int x = 0; x < 14; ++x) {
        for (int z = 0; z < 14; ++z) {
            if ((x + z) % 2 == 0) floor_quad(tiles, x, z, x + 1, z + 1, 0);
        }
    }
    Part& walls = scene.part("walls", yellow);
    grid(walls, {14, 0, 0}, {0, 0, 14}, {0, 8, 0}, 14, 8);
    grid(walls, {0, 0, 14}, {0, 8, 0}, {14, 0, 0}, 8, 14);
    Part& blocks = scene.part("blocks", red);
    for (int x = 1; x <= 11; x += 2) {
        for (int y = 1; y <= 5; y += 2) {
            for (int z = 1; z <= 11; z += 2) {
                if ((x + 2 * y + 3 * z) % 8 != 2) continue;
                const Vec3 low{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
                box(blocks, low, low + Vec3{1, 1, 1});
            }
        }
    }
    // Blocks that touch: along a face, along an edge, at a corner.
    box(blocks, {6, 2, 6}, {7, 3, 7});
    box(blocks, {7, 2, 6}, {8, 3, 7});
    box(blocks, {8, 3, 6}, {9, 4, 7});
    box(blocks, {9, 4, 7}, {10, 5, 8});
    scene.camera("main", {-5, 10, -8}, {8, 2.5, 8});
    scene.camera("straight_on", {7, 4, -12}, {7, 4, 14});
    scene.directional("along_100", {1, 0, 0});
    scene.directional("along_110", {1, 1, 0});
    scene.directional("along_111", {1, 1, 1});
    scene.directional("straight_down", {0, -1, 0});
    scene.directional("down_111", {1, -1, 1});
    scene.point("lamp", {4, 6, 4});
    return scene;
}

Scene make_tessellated_floor(const Request&) {
    Scene scene;
    // Steps of 1/8 m, slopes of 1/4 and 1/8: every vertex is exact in float32, so both floors are exactly flat and no
    // triangle of one may shadow another. The sun (1, -0.01, -2) is 0.26 degrees above both planes: in the tilted one
    // the slope along its way, 1/4 - 2/8, is 0 too.
    const Vec3 along_x{8, 0, 0}, along_z{0, 0, 8};
    grid(scene.part("level", stone), {-12, 0, -4}, along_z, along_x, 64, 64);
    const Vec3 tilted_x{8, 2, 0}, tilted_z{0, 1, 8};
    grid(scene.part("tilted", blue), {4, 0.5, -4}, tilted_z, tilted_x, 64, 64);
    box(scene.part("kerb", red), {-9, 0, 1}, {-8, 0.015625, 2});
    scene.camera("main", {-2, 7, 14}, {0, 0.5, 0});
    scene.camera("low", {-11.5, 0.5, 4.5}, {-6, 0, -2});
    scene.directional("grazing", {1, -0.01, -2});
    scene.directional("sun", {-0.25, -1, 0.5});
    return scene;
}

Scene make_concave_corners(const Request&) {
    Scene scene;
    Part& room = scene.part("room", stone);
    quad(room, {-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4});
    quad(room, {-4, 0, -4}, {4, 0, -4}, {4, 4, -4}, {-4, 4, -4});
    quad(room, {-4, 0, 4}, {-4, 0, -4}, {-4, 4, -4}, {-4, 4, 4});

    // Stairs in the corner, one surface that folds inwards and outwards in turn, with its cheek.
    Part& stairs = scene.part("stairs", yellow);
    for (int i = 0; i < 10; ++i) {
        const double x = -1 - 0.3 * i, y = 0.2 * i;
        quad(stairs, {x, y, -1}, {x, y, -4}, {x, y + 0.2, -4}, {x, y + 0.2, -1});
        quad(stairs, {x, y + 0.2, -1}, {x, y + 0.2, -4}, {x - 0.3, y + 0.2, -4}, {x - 0.3, y + 0.2, -1});
        quad(stairs, {x, 0, -1}, {x, y + 0.2, -1}, {x - 0.3, y + 0.2, -1}, {x - 0.3, 0, -1});
    }

    // A wedge whose faces meet the floor at about 3 degrees, and one at 45.
    Part& wedges = scene.part("wedges", red);
    quad(wedges, {0.5, 0, 1}, {0.5, 0, 3}, {3.5, 0.15, 3}, {3.5, 0.15, 1});
    quad(wedges, {-3, 0, 1}, {-3, 0, 3}, {-2, 1, 3}, {-2, 1, 1});

    // A groove: two slopes that meet in a line, and two boxes that lean against each other.
    Part& groove = scene.part("groove", blue);
    const auto left_front = groove.vertex({1, 0.75, -1}), left_back = groove.vertex({1, 0.75, -3});
    const auto bottom_front = groove.vertex({2, 0.05, -1}), bottom_back = groove.vertex({2, 0.05, -3});
    const auto right_front = groove.vertex({3, 0.75, -1}), right_back = groove.vertex({3, 0.75, -3});
    groove.quad(left_front, bottom_front, bottom_back, left_back);
    groove.quad(bottom_front, right_front, right_back, bottom_back);
    box(groove, {-1, 0, 1.5}, {-0.25, 0.75, 2.25});
    oriented_box(groove, {0.0625, 0.4, 1.875}, Vec3{0.8, 0.6, 0} * 0.3, Vec3{-0.6, 0.8, 0} * 0.4, {0, 0, 0.3});
    scene.camera("main", {5, 5, 7}, {-0.5, 0.75, -0.75});
    scene.camera("into_the_corner", {1, 1.5, 0}, {-4, 0.5, -4}, 60);
    scene.directional("sun", {-0.5, -1, -0.375});
    scene.directional("low", {-1, -0.125, -0.5});
    scene.point("lamp", {1.5, 3, 1});
    return scene;
}

}  // namespace gnomon::make_scenes
