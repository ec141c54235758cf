// SPDX-License-Identifier: MIT
// Small scenes about scale, number and closedness: the giant and the tiny, the far, the many, the watertight.
#include <algorithm>
#include <array>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr std::array<double, 3> stone{0.70, 0.68, 0.63};
constexpr std::array<double, 3> red{0.72, 0.20, 0.15};
constexpr std::array<double, 3> blue{0.16, 0.32, 0.62};
constexpr std::array<double, 3> yellow{0.80, 0.62, 0.15};
constexpr std::array<double, 3> green{0.18, 0.42, 0.12};

/// A closed cylinder that stands on `foot`: 4 * sides triangles.
void pillar(Part& part, const Vec3& foot, double radius, double height, int sides) {
    revolve(part, foot, std::array{ProfilePoint{radius, 0}, ProfilePoint{radius, height}}, sides);
}

/// A closed, four-sided pyramid: 6 triangles.
void pyramid(Part& part, const Vec3& foot, double half_width, double height) {
    const auto a = part.vertex(foot + Vec3{-half_width, 0, -half_width});
    const auto b = part.vertex(foot + Vec3{-half_width, 0, half_width});
    const auto c = part.vertex(foot + Vec3{half_width, 0, half_width});
    const auto d = part.vertex(foot + Vec3{half_width, 0, -half_width});
    const auto apex = part.vertex(foot + Vec3{0, height, 0});
    part.quad(a, d, c, b);
    part.triangle(a, b, apex);
    part.triangle(b, c, apex);
    part.triangle(c, d, apex);
    part.triangle(d, a, apex);
}

}  // namespace

Scene make_one_over_everything(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -10, -10, 10, 10, 0);
    Part& boxes = scene.part("boxes", red);
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
            const double x = -8 + 4 * i, z = -8 + 4 * j;
            box(boxes, {x - 0.5, 0, z - 0.5}, {x + 0.5, 0.5 + (i * 3 + j * 2) % 4 * 0.5, z + 0.5});
        }
    }
    // A kilometre wide, 40 m up; its one near edge lets the sun reach a strip of the yard.
    triangle(scene.part("giant", blue), {-1000, 40, -1000}, {25, 40, 1000}, {30, 40, -1000});
    scene.camera("main", {14, 9, 17}, {0, 0, 0});
    scene.directional("sun", {-0.5, -1, -0.25});
    scene.directional("all_in_shadow", {0.5, -1, 0.25});
    return scene;
}

Scene make_millimetres_in_kilometres(const Request&) {
    Scene scene;
    floor_quad(scene.part("plain", stone), -4000, -4000, 4000, 4000, 0);
    pyramid(scene.part("mountain", green), {600, -50, -2600}, 900, 1100);

    // The table with the small things is 1.5 km from the origin, where a step of float32 is 0.12 mm.
    const Vec3 place{1234.5, 0, -876.25};
    Part& dice = scene.part("dice", red);
    Part& pins = scene.part("pins", blue);
    for (int i = 0; i < 8; ++i) {
        for (int j = 0; j < 6; ++j) {
            const Vec3 foot = place + Vec3{0.016 * (i - 3.5), 0, 0.016 * (j - 2.5)};
            if ((i + j) % 2 == 0) {
                const double size = 0.002 + 0.0005 * ((i * 5 + j * 3) % 5);
                box(dice, foot + Vec3{-size, 0, -size}, foot + Vec3{size, 2 * size, size});
            } else {
                pillar(pins, foot, 0.0005, 0.012, 6);
                revolve(pins, foot + Vec3{0, 0.012, 0},
                        std::array{ProfilePoint{0.0005, 0}, ProfilePoint{0.0015, 0.0008}, ProfilePoint{0.0005, 0.0018}},
                        6);
            }
        }
    }
    scene.camera("main", place + Vec3{0.06, 0.09, 0.15}, place);
    scene.camera("plain", {1800, 300, 1500}, {500, 100, -2600}, 60);
    scene.directional("sun", {0.5, -1, -0.25});
    scene.directional("low", {0.25, -0.125, 1});
    return scene;
}

Scene make_cathedral_far(const Request&) {
    Scene scene;
    const Vec3 base{1'000'000, 250'000, -1'000'000};
    const double half_length = 40, aisle = 16, pitch = 8;
    Part& floor = scene.part("floor", stone);
    grid(floor, base + Vec3{-aisle, 0, -half_length}, {0, 0, 2 * half_length}, {2 * aisle, 0, 0}, 20, 8);
    Part& pillars = scene.part("pillars", yellow);
    Part& vault = scene.part("vault", stone);
    Part& walls = scene.part("walls", stone);
    for (int i = 0; i <= 10; ++i) {
        const double z = -half_length + pitch * i;
        for (const double side : {-1.0, 1.0}) {
            pillar(pillars, base + Vec3{side * 8, 0, z}, 1, 18, 10);
            // Half an arch from the pillar's head to the ridge, as a bent beam.
            std::vector<Vec3> path;
            for (int k = 0; k <= 6; ++k) {
                const CosineSine angle = cosine_sine(k / 24.0);
                path.push_back(base + Vec3{side * 8 * angle.cosine, 18 + 10 * angle.sine, z});
            }
            tube(vault, path, std::vector<double>(path.size(), 0.5), 4);
            box(walls, base + Vec3{side * aisle - 0.5, 0, z - 1}, base + Vec3{side * aisle + 0.5, 16, z + 1});
        }
    }
    for (const double side : {-1.0, 1.0}) {
        box(walls, base + Vec3{side * aisle - 0.5, 0, -half_length}, base + Vec3{side * aisle + 0.5, 3, half_length});
        box(walls, base + Vec3{side * aisle - 0.5, 13, -half_length}, base + Vec3{side * aisle + 0.5, 16, half_length});
        grid(vault, base + Vec3{side * aisle, 16, -half_length}, {0, 0, 2 * half_length}, {-side * 8, 3, 0}, 10, 1);
    }
    Part& gable = scene.part("gable", red);
    for (int i = 0; i < 10; ++i) {  // every other bay of the roof is open to the sky
        if (i % 2 == 0) continue;
        const double z = -half_length + pitch * i;
        for (const double side : {-1.0, 1.0}) {
            grid(gable, base + Vec3{side * 8, 19, z}, {0, 0, pitch}, {-side * 8, 9.5, 0}, 4, 4);
        }
    }
    scene.camera("main", base + Vec3{3, 5, 38}, base + Vec3{-2, 8, -20}, 65);
    scene.camera("outside", base + Vec3{70, 45, 75}, base + Vec3{0, 8, 0});
    scene.directional("sun", {-0.5, -1, -0.25});
    scene.point("lamp", base + Vec3{0, 12, 0});
    return scene;
}

Scene make_closed_box_lit_inside(const Request&) {
    Scene scene;
    floor_quad(scene.part("ground", stone), -12, -12, 12, 12, 0);
    box(scene.part("room", yellow), {-4, 0, -3}, {4, 5, 3});
    Part& things = scene.part("things", red);
    box(things, {-2.5, 0.5, -1}, {-1.5, 1.5, 0});
    icosphere(things, {2, 2, 0.5}, 0.75, 2);
    box(scene.part("crate", blue), {6, 0, 1}, {8, 2, 3});
    scene.camera("main", {3.5, 4, 2.5}, {-3, 0.5, -2}, 75);
    scene.camera("outside", {14, 8, 14}, {1, 1.5, 0});
    scene.point("lamp_inside", {0, 4, 0});
    scene.point("lamp_in_the_sphere", {2, 2, 0.5});
    scene.point("lamp_outside", {9, 6, 5});
    scene.directional("sun", {-0.5, -1, -0.25});
    return scene;
}

Scene make_sphere_closed(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -4, -4, 4, 4, 0);
    icosphere(scene.part("sphere", red), {0, 1.25, 0}, 1, 4);
    scene.camera("main", {2, 3, 5}, {0, 0.75, 0});
    scene.directional("sun", {-0.75, -1, -0.25});
    scene.directional("low", {-1, -0.125, -0.25});
    scene.point("lamp", {2, 4, 1});
    scene.point("lamp_inside", {0, 1.25, 0});
    return scene;
}

Scene make_pillars_point_light(const Request&) {
    Scene scene;
    floor_quad(scene.part("floor", stone), -12, -12, 12, 12, 0);
    Part& pillars = scene.part("pillars", yellow);
    Part& drums = scene.part("drums", red);
    for (int i = 0; i < 16; ++i) {
        const CosineSine angle = cosine_sine(i / 16.0);
        const double radius = i % 2 == 0 ? 4 : 7;
        pillar(pillars, {radius * angle.cosine, 0, radius * angle.sine}, 0.375, 3 + i % 3, 16);
        if (i % 4 == 1) pillar(drums, {2 * angle.cosine, 0, 2 * angle.sine}, 0.5, 0.5, 16);
    }
    scene.camera("main", {6, 10, 14}, {0, 0.75, 0});
    scene.camera("under_the_lamp", {1, 2.5, 1.5}, {-7, 1, -2}, 70);
    scene.point("lamp", {0.25, 2.25, 0.125});
    scene.spot("spot", {9, 8, 2}, {-1, -1, -0.25});
    scene.directional("sun", {-0.5, -1, -0.25});
    return scene;
}

Scene make_thin_wires(const Request& request) {
    Random random(request.seed);
    Scene scene;
    floor_quad(scene.part("floor", stone), -6, -4, 6, 4, 0);
    Part& posts = scene.part("posts", red);
    for (const double x : {-5.0, 5.0}) bar(posts, {x, 0, 0}, {x, 3, 0}, 0.125);
    for (const double x : {-5.0, 5.0}) bar(posts, {x, 2.75, -2}, {x, 2.75, 2}, 0.125);
    Part& wires = scene.part("wires", blue);
    const int spans = 20;
    for (int i = 0; i < 24; ++i) {
        const double from = random.between(-2, 2);
        const double to = random.between(-2, 2);
        const double sag = random.between(0.1, 1.2);
        std::vector<Vec3> path;
        for (int k = 0; k <= spans; ++k) {
            const double t = static_cast<double>(k) / spans;
            path.push_back({-5 + 10 * t, 2.75 - 4 * sag * t * (1 - t), from + (to - from) * t});
        }
        tube(wires, path, std::vector<double>(path.size(), 0.0005), 3);
    }
    scene.camera("main", {1, 4, 9}, {0, 1, 0});
    scene.camera("close", {0.25, 1.5, 0.75}, {0, 0, -0.5});
    scene.directional("sun", {-0.125, -1, -0.25});
    scene.directional("low", {0.25, -0.125, -1});
    return scene;
}

Scene make_grass(const Request& request) {
    Random random(request.seed);
    Scene scene;
    floor_quad(scene.part("soil", {0.30, 0.20, 0.12}), -2, -2, 2, 2, 0);
    std::array<Part*, 2> blades{&scene.part("grass", green), &scene.part("dry_grass", {0.55, 0.50, 0.20})};
    for (int i = 0; i < 3000; ++i) {
        const Vec3 foot{random.between(-1.9, 1.9), 0, random.between(-1.9, 1.9)};
        const CosineSine heading = cosine_sine(random.unit());
        const double height = random.between(0.12, 0.35);
        const double bend = random.between(0.1, 0.9) * height;
        const double half_width = random.between(0.003, 0.007);
        const Vec3 lean{heading.cosine, 0, heading.sine},
            side{-heading.sine * half_width, 0, heading.cosine * half_width};
        Part& part = *blades[random.below(8) == 0 ? 1 : 0];
        // Two quads and a tip along a parabola.
        std::uint32_t left = part.vertex(foot - side), right = part.vertex(foot + side);
        for (int k = 1; k <= 2; ++k) {
            const double t = k / 3.0;
            const Vec3 spine = foot + Vec3{0, height * t, 0} + lean * (bend * t * t);
            const std::uint32_t next_left = part.vertex(spine - side * (1 - t / 2));
            const std::uint32_t next_right = part.vertex(spine + side * (1 - t / 2));
            part.quad(left, right, next_right, next_left);
            left = next_left;
            right = next_right;
        }
        part.triangle(left, right, part.vertex(foot + Vec3{0, height, 0} + lean * bend));
    }
    scene.camera("main", {1.5, 1, 2.75}, {0, 0.05, 0});
    scene.camera("between_the_blades", {0.5, 0.2, 1.25}, {-0.25, 0.05, 0}, 60);
    scene.directional("sun", {-0.5, -1, -0.25});
    scene.directional("low", {1, -0.25, -0.5});
    return scene;
}

Scene make_million_slivers(const Request& request) {
    Random random(request.seed);
    Scene scene;
    floor_quad(scene.part("floor", stone), -2, -2, 2, 2, 0);
    Part& slivers = scene.part("slivers", blue);
    // Each is 1 to 2 m long, tapers from 0.4 mm to nothing, and has a point of its middle line within 2 mm of the axis
    // x = z = 0, between 0.5 and 1 m up.
    const std::uint64_t count = missing_triangles(scene, request.triangles);
    for (std::uint64_t i = 0; i < count; ++i) {
        const CosineSine heading = cosine_sine(random.unit());
        const Vec3 near_axis{random.between(-0.002, 0.002), random.between(0.5, 1), random.between(-0.002, 0.002)};
        const double slope = random.between(-0.1, 0.1);
        const double half_length = random.between(0.5, 1);
        const Vec3 along{heading.cosine * half_length, slope * half_length, heading.sine * half_length};
        const Vec3 across{-heading.sine * 0.0002, 0, heading.cosine * 0.0002};
        triangle(slivers, near_axis - along - across, near_axis - along + across, near_axis + along);
    }
    scene.camera("main", {1, 2, 3}, {0, 0.375, 0});
    scene.camera("the_texel", {0.125, 0.375, 0.25}, {0, 0, 0});
    scene.directional("sun", {-0.125, -1, -0.0625});
    scene.directional("straight_down", {0, -1, 0});
    return scene;
}

Scene make_far_bush(const Request& request) {
    Random random(request.seed);
    Scene scene;
    floor_quad(scene.part("floor", stone), -60, -100, 60, 20, 0);
    Part& leaves = scene.part("leaves", green);
    // Each leaf is about two pixels long in a picture of 1080 rows, where the bush, 2 m across, is 30 pixels wide.
    const Vec3 middle{0, 1, -75};
    const std::uint64_t count = missing_triangles(scene, request.triangles);
    for (std::uint64_t i = 0; i < count; ++i) {
        const Vec3 foot = middle + random.in_ball() * 0.85;
        const Vec3 along = random.in_ball() * 0.15, across = random.in_ball() * 0.15;
        triangle(leaves, foot, foot + along, foot + across);
    }
    scene.camera("main", {0, 1.5, 2}, middle);
    scene.camera("close", {1.5, 1.5, -71.5}, middle);
    scene.directional("sun", {-0.5, -1, -0.25});
    return scene;
}

}  // namespace gnomon::make_scenes
