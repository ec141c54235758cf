// SPDX-License-Identifier: MIT
// A courtyard with an arcade on all four sides, a fountain, trees, bushes and ivy. Walls, arcade and branches take a
// part of the budget that shrinks as it grows; leaves of 4 triangles spend the rest, so the count is met within 4
// triangles. Leaves get smaller as they get more, so the trees stay as dense.
#include <algorithm>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr double half_x = 18, half_z = 14;  // of the open court
constexpr double gallery = 3.5;             // depth of the arcade
constexpr double bay = 4, column_height = 2.6, arch_radius = 1.6, storey = 5, wall_height = 9;

/// How finely things are cut, chosen by the budget.
struct Detail {
    int arch_segments, sides, branch_levels, rolls_per_bay, paving;
};

Detail choose_detail(std::uint64_t triangles) {
    if (triangles < 18'000) return {4, 5, 1, 1, 8};
    if (triangles < 50'000) return {6, 6, 2, 2, 12};
    if (triangles < 500'000) return {12, 12, 3, 4, 20};
    if (triangles < 3'000'000) return {16, 20, 4, 6, 40};
    if (triangles < 10'000'000) return {24, 32, 5, 8, 40};
    return {32, 48, 6, 8, 40};
}

/// A place that leaves grow around: a twig, a piece of a bush, a patch of ivy.
struct Site {
    Vec3 center;
    Vec3 spread;  ///< half-axes of the ellipsoid that the leaves fill
};

struct Court {
    Part *walls, *arcade, *floor, *tiles, *wood, *water, *pots;
    std::vector<Site> tree_sites, bush_sites, ivy_sites;
};

/// One bay of the arcade, from `corner` along `across` (one bay long): a column at its start and a wall with a round
/// arch, `thickness` deep along `inwards`.
void arcade_bay(Part& part, const Vec3& corner, const Vec3& across, const Vec3& inwards, const Detail& detail) {
    const double thickness = 0.5;
    static constexpr std::array shaft{ProfilePoint{0.30, 0.0},  ProfilePoint{0.30, 0.18}, ProfilePoint{0.22, 0.26},
                                      ProfilePoint{0.19, 2.25}, ProfilePoint{0.27, 2.38}, ProfilePoint{0.29, 2.44}};
    const Vec3 foot = corner + inwards * (thickness / 2);
    revolve(part, foot, shaft, detail.sides);
    box(part, foot + Vec3{-0.36, 2.44, -0.36}, foot + Vec3{0.36, column_height, 0.36});

    // The wall over the arch: from the arch's points straight up to the storey's height, on both faces.
    const Vec3 unit = normalized(across), depth = inwards * thickness;
    const Vec3 middle = corner + across * 0.5 + Vec3{0, column_height, 0};
    std::array<std::uint32_t, 4> last{};
    for (int i = 0; i <= detail.arch_segments + 2; ++i) {
        Vec3 low = middle - unit * (bay / 2), high;
        if (i == detail.arch_segments + 2) {
            low = middle + unit * (bay / 2);
        } else if (i > 0) {
            const CosineSine angle = cosine_sine(0.5 - 0.5 * (i - 1) / detail.arch_segments);
            low = middle + unit * (arch_radius * angle.cosine) + Vec3{0, arch_radius * angle.sine, 0};
        }
        high = {low.x, storey, low.z};
        const std::array<std::uint32_t, 4> current{part.vertex(low), part.vertex(high), part.vertex(low + depth),
                                                   part.vertex(high + depth)};
        if (i > 0) {
            part.quad(last[0], current[0], current[1], last[1]);
            part.quad(last[2], last[3], current[3], current[2]);
            part.quad(last[0], last[2], current[2], current[0]);
        }
        last = current;
    }
}

/// The upper storey over one bay: a wall with a window, whose reveals are 0.4 m deep, and a shutter on each side.
void upper_bay(Court& court, const Vec3& corner, const Vec3& across, const Vec3& inwards) {
    const auto at = [&](double u, double y, double depth) {
        return corner + across * u + Vec3{0, y, 0} + inwards * depth;
    };
    Part& wall = *court.walls;
    std::array<std::uint32_t, 4> outer{}, inner{}, deep{};
    const std::array<std::array<double, 2>, 4> ends{{{0, storey}, {1, storey}, {1, wall_height}, {0, wall_height}}};
    const std::array<std::array<double, 2>, 4> opening{{{0.36, 6.1}, {0.64, 6.1}, {0.64, 8.1}, {0.36, 8.1}}};
    for (unsigned i = 0; i < 4; ++i) outer[i] = wall.vertex(at(ends[i][0], ends[i][1], 0));
    for (unsigned i = 0; i < 4; ++i) inner[i] = wall.vertex(at(opening[i][0], opening[i][1], 0));
    for (unsigned i = 0; i < 4; ++i) deep[i] = wall.vertex(at(opening[i][0], opening[i][1], 0.4));
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned next = (i + 1) % 4;
        wall.quad(outer[i], outer[next], inner[next], inner[i]);
        wall.quad(inner[i], inner[next], deep[next], deep[i]);
    }
    wall.quad(deep[0], deep[1], deep[2], deep[3]);
    const Vec3 half_width = across * 0.065, half_depth = inwards * -0.03;
    for (const double u : {0.29, 0.71}) {
        oriented_box(*court.wood, at(u, 7.1, -0.05), half_width, Vec3{0, 1, 0}, half_depth);
    }
}

/// One side of the court: `bays` bays from `corner` on, the gallery's vault, back wall and the tiled roof.
void add_side(Court& court, const Vec3& corner, const Vec3& along, int bays, const Detail& detail) {
    const Vec3 inwards = cross(along, Vec3{0, 1, 0});  // away from the court, into the building
    for (int i = 0; i < bays; ++i) {
        const Vec3 start = corner + along * (bay * i);
        arcade_bay(*court.arcade, start, along * bay, inwards, detail);
        upper_bay(court, start, along * bay, inwards);
    }
    const Vec3 length_along = along * (bay * bays), out = inwards * gallery, up{0, 1, 0};
    const Vec3 longer_start = corner - along * gallery, longer = length_along + along * (2 * gallery);
    quad(*court.walls, longer_start + out, longer_start + out + longer, longer_start + out + longer + up * wall_height,
         longer_start + out + up * wall_height);
    quad(*court.walls, corner + up * storey, corner + up * storey + length_along,
         longer_start + longer + out + up * storey, longer_start + out + up * storey);
    // The roof rises away from the court, its eaves reach over the wall by 0.6 m.
    const Vec3 eaves = corner - inwards * 0.6 + along * 0.6 + up * (wall_height - 0.2);
    const Vec3 eaves_end = corner + length_along - inwards * 0.6 - along * 0.6 + up * (wall_height - 0.2);
    const Vec3 ridge = longer_start + out + up * (wall_height + 1.8);
    quad(*court.tiles, eaves, eaves_end, ridge + longer, ridge);
    // Rolls of tiles over it.
    const int rolls = bays * detail.rolls_per_bay;
    for (int i = 0; i < rolls; ++i) {
        const double t = (i + 0.5) / rolls;
        bar(*court.tiles, eaves + (eaves_end - eaves) * t, corner + length_along * t + out + up * (wall_height + 1.8),
            0.16);
    }
    // Ivy hangs from the eaves over every pier, some of it down to the arcade.
    for (int i = 0; i < bays; ++i) {
        const Vec3 pier = corner + along * (bay * i) - inwards * 0.12;
        const int patches = 2 + (i * 5 + bays) % 5;
        for (int k = 0; k < patches; ++k) {
            const double aside = 0.3 * ((i + 2 * k) % 3 - 1), width = 0.9 - 0.09 * k;
            const Vec3 spread = along * width + inwards * 0.12 + up * 0.75;
            court.ivy_sites.push_back({pier + along * aside + up * (8.2 - 0.8 * k), spread});
        }
    }
}

/// A branch as a bent tube, then its children, down to twigs, which become sites.
void add_branch(Court& court, const Vec3& from, const Vec3& along, double length_m, double radius, int levels,
                const Detail& detail, Random& random) {
    const Vec3 bend = random.in_ball() * (0.15 * length_m);
    const Vec3 end = from + along * length_m + bend;
    const std::array path{from, from + along * (length_m / 2) + bend * 0.2, end};
    const int sides = levels >= detail.branch_levels - 1 ? std::max(5, detail.sides / 2) : 4;
    tube(*court.wood, path, std::array{radius, radius * 0.85, radius * 0.7}, sides);
    if (levels == 0) {
        const double spread = 0.25 + 0.45 * length_m;
        court.tree_sites.push_back({end, {spread, 0.7 * spread, spread}});
        return;
    }
    for (int child = 0; child < 3; ++child) {
        const double forwards = child == 0 ? 1.1 : 0.55;
        const Vec3 sideways = random.direction();
        Vec3 direction = normalized(along * forwards + sideways * 0.75 + Vec3{0, 0.2, 0});
        const double shrink = random.between(0.62, 0.82);
        add_branch(court, end, direction, length_m * shrink, radius * 0.62, levels - 1, detail, random);
    }
}

void add_tree(Court& court, const Vec3& foot, double height, const Detail& detail, Random& random) {
    revolve(*court.pots, foot,
            std::array{ProfilePoint{0.9, 0}, ProfilePoint{1.0, 0.45}, ProfilePoint{0.9, 0.5}, ProfilePoint{0.85, 0.42}},
            detail.sides);
    const Vec3 lean = random.direction() * 0.12;
    add_branch(court, foot, normalized(Vec3{lean.x, 1, lean.z}), 0.36 * height, 0.028 * height, detail.branch_levels,
               detail, random);
}

void add_bush(Court& court, const Vec3& foot, const Detail& detail, Random& random) {
    revolve(*court.pots, foot,
            std::array{ProfilePoint{0.28, 0}, ProfilePoint{0.42, 0.5}, ProfilePoint{0.46, 0.5},
                       ProfilePoint{0.44, 0.58}, ProfilePoint{0.38, 0.5}},
            detail.sides);
    for (int i = 0; i < 3; ++i) {
        const Vec3 offset = random.in_ball() * 0.25;
        court.bush_sites.push_back({foot + Vec3{offset.x, 0.85 + 0.2 * i, offset.z}, {0.4, 0.35, 0.4}});
    }
}

void add_fountain(Court& court, const Detail& detail) {
    static constexpr std::array basin{ProfilePoint{2.6, 0},    ProfilePoint{2.6, 0.15}, ProfilePoint{2.4, 0.2},
                                      ProfilePoint{2.4, 0.55}, ProfilePoint{2.5, 0.6},  ProfilePoint{2.5, 0.7},
                                      ProfilePoint{2.2, 0.7},  ProfilePoint{2.2, 0.25}};
    static constexpr std::array stem{ProfilePoint{0.5, 0.2},   ProfilePoint{0.25, 0.5}, ProfilePoint{0.2, 1.3},
                                     ProfilePoint{0.5, 1.5},   ProfilePoint{1.1, 1.75}, ProfilePoint{1.15, 1.85},
                                     ProfilePoint{0.9, 1.75},  ProfilePoint{0.15, 1.6}, ProfilePoint{0.12, 2.2},
                                     ProfilePoint{0.25, 2.35}, ProfilePoint{0.05, 2.6}};
    revolve(*court.arcade, {}, basin, 2 * detail.sides);
    revolve(*court.arcade, {}, stem, 2 * detail.sides);
    revolve(*court.water, {}, std::array{ProfilePoint{2.19, 0.26}, ProfilePoint{2.19, 0.5}}, 2 * detail.sides);
}

void add_benches(Court& court) {
    for (const double side : {-1.0, 1.0}) {
        for (const double x : {-9.0, 9.0}) {
            const Vec3 at{x, 0, side * 6.5};
            box(*court.wood, at + Vec3{-1, 0.42, -0.25}, at + Vec3{1, 0.48, 0.25});
            box(*court.wood, at + Vec3{-1, 0.6, side * 0.25 - 0.03}, at + Vec3{1, 0.95, side * 0.25 + 0.03});
            for (const double leg : {-0.9, 0.9})
                box(*court.wood, at + Vec3{leg - 0.04, 0, -0.22}, at + Vec3{leg + 0.04, 0.42, 0.22});
        }
    }
}

void add_plants(Court& court, const Detail& detail, Random& random) {
    for (const double x : {-13.0, -6.5, 6.5, 13.0}) {
        for (const double z : {-8.5, 8.5}) {
            const double height = random.between(7.5, 10.5);
            add_tree(court, {x, 0, z}, height, detail, random);
        }
    }
    for (const double x : {-12.0, 12.0}) add_tree(court, {x, 0, 0}, 6.5, detail, random);
    for (int i = 0; i < 8; ++i) {
        const double x = -14 + 4 * i;
        for (const double z : {-12.6, 12.6}) {
            if (i % 3 != 1) add_bush(court, {x, 0, z}, detail, random);
        }
    }
}

/// Two quads folded along the midrib and lifted to a hollow: 4 triangles around a middle vertex.
void leaf(Part& part, const Vec3& base, const Vec3& along, const Vec3& side, const Vec3& fold) {
    const auto stem = part.vertex(base);
    const auto left = part.vertex(base + along * 0.45 - side + fold);
    const auto tip = part.vertex(base + along);
    const auto right = part.vertex(base + along * 0.45 + side + fold);
    const auto middle = part.vertex(base + along * 0.5);
    part.triangle(stem, left, middle);
    part.triangle(left, tip, middle);
    part.triangle(tip, right, middle);
    part.triangle(right, stem, middle);
}

/// `count` leaves over the sites, evenly by chance. `area`: of all of them together, in square metres.
void add_leaves(std::span<Part* const> parts, const std::vector<Site>& sites, std::uint64_t count, double area,
                Random& random) {
    if (count == 0) return;
    const double size = std::clamp(std::sqrt(area / static_cast<double>(count)), 0.012, 0.40);
    for (std::uint64_t i = 0; i < count; ++i) {
        const Site& site = sites[random.below(static_cast<std::uint32_t>(sites.size()))];
        const Vec3 offset = random.in_ball();
        const Vec3 base =
            site.center + Vec3{offset.x * site.spread.x, offset.y * site.spread.y, offset.z * site.spread.z};
        const Vec3 heading = random.direction();
        const Vec3 along = normalized(heading + Vec3{0, -0.4, 0});
        const Vec3 side = normalized(cross(along, random.direction() + Vec3{0, 2.1, 0}));
        const double length_m = size * random.between(1.0, 1.7);
        Part& part = *parts[random.below(4) == 0 ? 1 : 0];
        leaf(part, base, along * length_m, side * (0.45 * length_m), cross(side, along) * (0.12 * length_m));
    }
}

/// Leaves that fell: single ones, flat on the paving.
void add_fallen_leaves(std::span<Part* const> parts, std::uint64_t count, Random& random) {
    const std::vector<Site> ground{{{0, 0.06, 0}, {half_x - 1, 0.05, half_z - 1}}};
    add_leaves(parts, ground, count, 25, random);
}

}  // namespace

Scene make_foliage(const Request& request) {
    Random random(request.seed);
    const Detail detail = choose_detail(request.triangles);
    Scene scene;
    Court court{};
    court.floor = &scene.part("paving", {0.60, 0.52, 0.42});
    court.walls = &scene.part("walls", {0.78, 0.60, 0.38});
    court.arcade = &scene.part("arcade", {0.74, 0.68, 0.58});
    court.tiles = &scene.part("tiles", {0.58, 0.26, 0.16});
    court.wood = &scene.part("wood", {0.28, 0.19, 0.12});
    court.water = &scene.part("water", {0.12, 0.30, 0.36});
    court.pots = &scene.part("pots", {0.64, 0.34, 0.22});

    floor_quad(scene.part("earth", {0.44, 0.38, 0.28}), -60, -60, 60, 60, -0.05);
    const double reach_x = half_x + gallery, reach_z = half_z + gallery;
    grid(*court.floor, {-reach_x, 0, -reach_z}, {0, 0, 2 * reach_z}, {2 * reach_x, 0, 0}, detail.paving, detail.paving);
    const int bays_x = static_cast<int>(2 * half_x / bay), bays_z = static_cast<int>(2 * half_z / bay);
    add_side(court, {half_x, 0, -half_z}, {-1, 0, 0}, bays_x, detail);
    add_side(court, {-half_x, 0, half_z}, {1, 0, 0}, bays_x, detail);
    add_side(court, {half_x, 0, half_z}, {0, 0, -1}, bays_z, detail);
    add_side(court, {-half_x, 0, -half_z}, {0, 0, 1}, bays_z, detail);
    add_fountain(court, detail);
    add_benches(court);
    add_plants(court, detail, random);

    const std::array leaves{&scene.part("leaves", {0.16, 0.36, 0.08}), &scene.part("young_leaves", {0.36, 0.46, 0.12})};
    const std::array ivy{&scene.part("ivy", {0.10, 0.28, 0.08}), leaves[0]};
    const std::uint64_t count = missing_triangles(scene, request.triangles) / 4;
    const std::uint64_t of_bushes = count / 10, of_ivy = count / 10, fallen = count / 100;
    add_leaves(leaves, court.tree_sites, count - of_bushes - of_ivy - fallen, 1300, random);
    add_leaves(leaves, court.bush_sites, of_bushes, 60, random);
    add_leaves(ivy, court.ivy_sites, of_ivy, 160, random);
    add_fallen_leaves(leaves, fallen, random);

    scene.camera("v0", {-18.5, 12, 15}, {1, 0.5, -2}, 62);
    scene.camera("v1", {4.5, 1.6, 5.5}, {-8, 3.2, -6.5}, 60);
    scene.directional("sun", {-0.4, -1, 0.3});
    scene.directional("low", {0.8, -0.55, -0.5});
    return scene;
}

}  // namespace gnomon::make_scenes
