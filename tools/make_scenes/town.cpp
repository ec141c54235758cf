// SPDX-License-Identifier: MIT
// A town of houses with gable roofs along streets, with terraces, flats, sheds, hedges, parks, a church and trees.
// Blocks are added from the middle outwards until their buildings take three quarters of the budget; trees take the
// rest, so the count is met within one tree. Buildings are closed solids and reach 30 cm into the ground.
#include <algorithm>
#include <array>
#include <cmath>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr double block_length = 96, block_depth = 46, street = 11, kerb_height = 0.12;
constexpr int plots_per_row = 8, terraced = 14;  // houses in a row
constexpr double plot_width = block_length / plots_per_row;
constexpr int crown_levels = 1, trunk_sides = 6;
constexpr std::uint64_t tree_triangles = 80 + 4 * trunk_sides;

/// A place with two horizontal unit axes at right angles: u runs along, v across, y upwards.
struct Frame {
    Vec3 origin, along{1, 0, 0}, across{0, 0, 1};

    Vec3 at(double u, double y, double v) const { return origin + along * u + Vec3{0, y, 0} + across * v; }
    Frame moved(double u, double v, double turns = 0) const {
        const CosineSine turn = cosine_sine(turns);
        return {at(u, 0, v), along * turn.cosine + across * turn.sine, across * turn.cosine - along * turn.sine};
    }
};

struct Paints {
    std::array<Part*, 3> walls;
    Part *roofs, *flats, *stone, *street, *lawn, *hedges, *wood, *leaves;
};

/// A closed box over [u0, u1] x [v0, v1] from below the ground to `height`.
void block_of(Part& part, const Frame& frame, const std::array<double, 4>& plan, double height, double base = -0.3) {
    const auto& [u0, u1, v0, v1] = plan;
    oriented_box(part, frame.at((u0 + u1) / 2, (base + height) / 2, (v0 + v1) / 2), frame.along * ((u1 - u0) / 2),
                 Vec3{0, (height - base) / 2, 0}, frame.across * ((v1 - v0) / 2));
}

struct House {
    double length = 0, depth = 0, eaves = 0, pitch = 0;  ///< pitch: rise of the roof over its run
    double ridge() const { return eaves + pitch * depth / 2 + 0.25; }
};

/// Walls and a roof that stands out over the eaves, as one closed solid: a profile of nine corners that runs along the
/// ridge from u = 0 on. 32 triangles in two parts that share no vertices.
void gable_house(Part& wall, Part& roof, const Frame& frame, const House& house) {
    const double half = house.depth / 2, over = 0.5, drop = over * house.pitch, thick = 0.25;
    const std::array<std::array<double, 2>, 9> profile{{{-half, -0.3},
                                                        {half, -0.3},
                                                        {half, house.eaves},
                                                        {half + over, house.eaves - drop},
                                                        {half + over, house.eaves - drop + thick},
                                                        {0, house.ridge()},
                                                        {-half - over, house.eaves - drop + thick},
                                                        {-half - over, house.eaves - drop},
                                                        {-half, house.eaves}}};
    const auto corner = [&](std::size_t i, double u) { return frame.at(u, profile[i][1], profile[i][0]); };
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const std::size_t next = (i + 1) % profile.size();
        quad(i < 2 || i == 8 ? wall : roof, corner(i, 0), corner(i, house.length), corner(next, house.length),
             corner(next, 0));
    }
    constexpr std::array<std::array<std::size_t, 3>, 7> cap{
        {{0, 1, 2}, {0, 2, 8}, {8, 2, 5}, {2, 3, 4}, {2, 4, 5}, {8, 5, 6}, {8, 6, 7}}};
    for (std::size_t i = 0; i < cap.size(); ++i) {
        const auto& [a, b, c] = cap[i];
        Part& part = i < 3 ? wall : roof;
        triangle(part, corner(a, 0), corner(b, 0), corner(c, 0));
        triangle(part, corner(a, house.length), corner(c, house.length), corner(b, house.length));
    }
}

/// A dormer on the slope towards +v: a box whose back lies inside the roof.
void add_dormer(Part& wall, const Frame& frame, const House& house, double u) {
    const double front = house.depth / 2 - 0.6, foot = house.eaves + 0.5 * house.pitch;
    block_of(wall, frame, {u - 0.9, u + 0.9, front - 1.7 / house.pitch, front}, foot + 1.6, foot - 0.3);
}

void add_chimney(Part& part, const Frame& frame, const House& house, double u) {
    block_of(part, frame, {u - 0.35, u + 0.35, -0.9, -0.3}, house.ridge() + 0.9, house.ridge() - 1.2);
}

void add_details(const Frame& frame, const House& house, Part& wall, const Paints& paints, Random& random) {
    add_chimney(*paints.stone, frame, house, random.between(1, house.length - 1));
    if (random.below(3) == 0) add_dormer(wall, frame, house, house.length * random.between(0.3, 0.7));
    if (random.below(3) == 0)  // an extension towards the garden
        block_of(wall, frame, {0.8, house.length * 0.6, -house.depth / 2 - 3, -house.depth / 2}, 2.8);
}

/// The street lies towards +v. `frame`: the plot's middle on the pavement's edge.
void add_detached(const Frame& frame, const Paints& paints, Random& random) {
    House house{random.between(7, 9), random.between(7, 9), 0, random.between(0.7, 1.1)};
    house.eaves = random.below(3) == 0 ? random.between(3, 3.6) : random.between(5.2, 6.2);
    Part& wall = *paints.walls[random.below(3)];
    const double setback = random.between(2.5, 5) + house.depth / 2;
    const double turn = random.between(-0.012, 0.012);
    const bool is_gable_forward = random.below(4) == 0;
    const Frame middle = frame.moved(0, -setback, is_gable_forward ? turn + 0.25 : turn);
    const Frame start = middle.moved(-house.length / 2, 0);
    gable_house(wall, *paints.roofs, start, house);
    add_details(start, house, wall, paints, random);
    if (random.below(3) == 0)  // a garage behind it
        block_of(*paints.flats, frame.moved(4, -setback - 8), {-1.5, 1.5, -2.5, 2.5}, 2.5);
}

void add_garden(const Frame& frame, const Paints& paints, Random& random) {
    const double side = plot_width / 2 - 0.4, back = block_depth / 2 - 0.4;
    block_of(*paints.hedges, frame, {side - 0.3, side + 0.3, -back, -1.2}, random.between(1.1, 2));
    if (random.below(2) == 0) {
        const Frame shed = frame.moved(random.between(-4, 1), -back + 3, random.between(-0.02, 0.02));
        gable_house(*paints.wood, *paints.roofs, shed, {random.between(2, 3), 2.2, 2, 0.5});
    }
}

/// A row of houses that share their walls and one line of eaves, every few of them a step higher.
void add_terrace(const Frame& row, const Paints& paints, Random& random) {
    House house{block_length / terraced, random.between(8, 9.5), random.between(5.5, 8.5), random.between(0.8, 1.2)};
    Part& wall = *paints.walls[random.below(3)];
    for (int i = 0; i < terraced; ++i) {
        if (random.below(4) == 0) house.eaves += random.between(-0.7, 0.7);
        const Frame start = row.moved(i * house.length + 0.005, -3 - house.depth / 2);
        House own = house;
        own.length -= 0.01;
        gable_house(wall, *paints.roofs, start, own);
        add_details(start, own, wall, paints, random);
    }
}

void add_flats(const Frame& row, const Paints& paints, Random& random) {
    const double height = 3 * (3 + static_cast<double>(random.below(4)));
    for (int i = 0; i < 2; ++i) {
        const double start = 4 + i * block_length / 2, end = start + block_length / 2 - 8;
        block_of(*paints.flats, row, {start, end, -17, -6}, height);
        for (int stairs = 0; stairs < 3; ++stairs) {
            const double u = start + (end - start) * (stairs + 0.5) / 3;
            block_of(*paints.stone, row, {u - 1.5, u + 1.5, -18.2, -15}, height + 1.8);
        }
        for (double y = 3; y < height; y += 3)  // balconies
            block_of(*paints.stone, row, {start + 2, end - 2, -6.1, -4.8}, y + 0.15, y - 0.05);
    }
}

void add_church(const Frame& block, const Paints& paints) {
    Part& stone = *paints.stone;
    gable_house(stone, *paints.roofs, block.moved(30, block_depth / 2), {34, 14, 11, 1.4});
    gable_house(stone, *paints.roofs, block.moved(52, block_depth / 2 - 13, 0.25), {26, 9, 9, 1.4});
    const Frame tower = block.moved(27, block_depth / 2);
    block_of(stone, tower, {-4, 4, -4, 4}, 30);
    revolve(*paints.roofs, tower.at(0, 30, 0), std::array{ProfilePoint{4.4, -0.2}, ProfilePoint{0.05, 18}}, 8);
}

/// A plate that stands open below, on the street.
void add_lawn(Part& part, const Frame& block) {
    const auto corner = [&](bool is_far, bool is_high, bool is_deep) {
        return block.at(is_far ? block_length : 0, is_high ? kerb_height : 0, is_deep ? block_depth : 0);
    };
    quad(part, corner(false, true, false), corner(false, true, true), corner(true, true, true),
         corner(true, true, false));
    for (int side = 0; side < 4; ++side) {
        const auto at = [&](int turn, bool is_high) {
            return corner((side + turn) % 4 == 1 || (side + turn) % 4 == 2, is_high, (side + turn) % 4 >= 2);
        };
        quad(part, at(0, false), at(0, true), at(1, true), at(1, false));
    }
}

/// One block: a kerb, and two rows of plots that face the streets before and behind it.
void add_block(const Frame& block, bool is_middle, const Paints& paints, Random& random) {
    add_lawn(*paints.lawn, block);
    if (is_middle) return add_church(block, paints);
    const std::uint32_t kind = random.below(12);
    if (kind == 0) return;  // a park
    for (int side = 0; side < 2; ++side) {
        const Frame row = side == 0 ? block.moved(block_length, 0, 0.5) : block.moved(0, block_depth);
        if (kind == 1) {
            add_flats(row, paints, random);
            continue;
        }
        const bool is_terrace = random.below(3) == 0;
        if (is_terrace) add_terrace(row, paints, random);
        for (int i = 0; i < plots_per_row; ++i) {
            const Frame plot = row.moved((i + 0.5) * plot_width, 0);
            if (!is_terrace) add_detached(plot, paints, random);
            add_garden(plot, paints, random);
        }
    }
}

/// A trunk, and a crown with 80 faces whose corners lie at uneven distances.
void add_tree(const Vec3& foot, const Paints& paints, Random& random) {
    const double height = random.between(4.5, 12), crown = height * random.between(0.24, 0.34);
    const Vec3 middle = foot + Vec3{0, height - crown, 0};
    tube(*paints.wood, std::array{foot - Vec3{0, 0.3, 0}, middle}, std::array{0.035 * height, 0.02 * height},
         trunk_sides);
    Part ball;
    icosphere(ball, {0, 0, 0}, 1, crown_levels);
    const std::uint32_t first = static_cast<std::uint32_t>(paints.leaves->positions.size() / 3);
    for (std::size_t i = 0; i < ball.positions.size(); i += 3) {
        const double radius = crown * random.between(0.75, 1.15);
        paints.leaves->vertex(middle + Vec3{double(ball.positions[i]), 1.25 * double(ball.positions[i + 1]),
                                            double(ball.positions[i + 2])} *
                                           radius);
    }
    for (const std::uint32_t index : ball.indices) paints.leaves->indices.push_back(first + index);
}

Paints make_paints(Scene& scene) {
    Paints paints{};
    paints.street = &scene.part("street", {0.26, 0.26, 0.27});
    paints.lawn = &scene.part("lawn", {0.30, 0.42, 0.20});
    paints.walls = {&scene.part("brick", {0.50, 0.25, 0.18}), &scene.part("plaster", {0.80, 0.76, 0.66}),
                    &scene.part("clinker", {0.40, 0.30, 0.26})};
    paints.roofs = &scene.part("tiles", {0.45, 0.18, 0.12});
    paints.flats = &scene.part("concrete", {0.58, 0.58, 0.56});
    paints.stone = &scene.part("stone", {0.55, 0.53, 0.48});
    paints.hedges = &scene.part("hedges", {0.12, 0.26, 0.10});
    paints.wood = &scene.part("wood", {0.33, 0.24, 0.16});
    paints.leaves = &scene.part("leaves", {0.16, 0.34, 0.12});
    return paints;
}

struct Place {
    int i = 0, j = 0;
    std::int64_t distance = 0;  ///< squared, from the middle block, in metres
};

/// The places of at least `count` blocks, those nearest to the middle first.
std::vector<Place> places_of(std::uint64_t count) {
    int reach = 3;
    while (std::uint64_t(reach) * std::uint64_t(reach) < count) ++reach;
    std::vector<Place> places;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            const auto x = std::int64_t(i) * std::int64_t(block_length + street);
            const auto z = std::int64_t(j) * std::int64_t(block_depth + street);
            places.push_back({i, j, x * x + z * z});
        }
    }
    std::ranges::stable_sort(places, {}, &Place::distance);
    return places;
}

}  // namespace

Scene make_town(const Request& request) {
    Scene scene;
    const Paints paints = make_paints(scene);
    const Frame town = Frame{}.moved(0, 0, 0.047);
    const std::uint64_t for_buildings = request.triangles * 3 / 4;
    const std::vector<Place> places = places_of(request.triangles / 300);
    std::vector<Frame> blocks;
    Random random(request.seed);
    double reach = 0;
    while (blocks.size() < places.size() && scene.triangle_count() < for_buildings) {
        const Place& place = places[blocks.size()];
        blocks.push_back(town.moved(place.i * (block_length + street) - block_length / 2,
                                    place.j * (block_depth + street) - block_depth / 2));
        add_block(blocks.back(), blocks.size() == 1, paints, random);
        for (const double u : {0.0, block_length}) {
            for (const double v : {0.0, block_depth}) {
                const Vec3 corner = blocks.back().at(u, 0, v);
                reach = std::max({reach, std::fabs(corner.x) + street, std::fabs(corner.z) + street});
            }
        }
    }
    floor_quad(*paints.street, -reach, -reach, reach, reach, 0);
    for (std::uint64_t left = missing_triangles(scene, request.triangles) / tree_triangles; left > 0; --left) {
        // Trees stand at the back of the gardens, where the two rows of a block meet.
        const Frame& block = blocks[random.below(static_cast<std::uint32_t>(blocks.size()))];
        const double u = random.between(2, block_length - 2);
        add_tree(block.at(u, kerb_height, block_depth / 2 + random.between(-5, 5)), paints, random);
    }
    scene.camera("v0", {0.5 * reach, 0.32 * reach + 30, 0.85 * reach}, {0, 0, -0.05 * reach}, 50);
    const Frame& middle = blocks.front();
    scene.camera("v1", middle.at(-20, 1.7, -street / 2), middle.at(60, 6, -street / 2 + 6), 65);
    scene.directional("sun", {-0.5, -1, -0.35});
    scene.directional("low", {0.85, -0.3, -0.5});
    return scene;
}

}  // namespace gnomon::make_scenes
