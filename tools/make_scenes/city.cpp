// SPDX-License-Identifier: MIT
// A city of square blocks: houses low at the edge, towers in the middle, kerbs, parked cars, lamps and things on roofs.
// Walls are made of window cells: frame, recess, pane and sill, 28 triangles, or left plain. The number of blocks is
// the smallest whose full detail reaches the budget; then facades get their windows from the middle outwards, storey by
// storey, until it is spent. The count is met within one storey of one facade.
#include <algorithm>
#include <numeric>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr double block_size = 66, street = 20, pitch = block_size + street;
constexpr double storey_height = 3.3, kerb_height = 0.15;
constexpr std::uint64_t cell_triangles = 28;

struct Building {
    double low_x = 0, low_z = 0, high_x = 0, high_z = 0;
    int storeys = 1, bays_x = 1, bays_z = 1;
    std::size_t paint = 0;
    std::uint64_t roof_seed = 0;
    double height() const { return storeys * storey_height + 0.5; }
};

/// One wall of a building: `across` is one bay, `out` the way it faces.
struct Facade {
    Vec3 corner, across, out;
    int bays = 0, storeys = 0;
    std::size_t paint = 0;
    double distance_squared = 0;  ///< from the city's centre
    std::uint64_t storey_triangles() const { return cell_triangles * static_cast<std::uint64_t>(bays); }
    std::uint64_t full_triangles() const { return storey_triangles() * static_cast<std::uint64_t>(storeys) + 2; }
};

struct Paints {
    std::array<Part*, 5> walls;
    Part *panes, *roofs, *stone, *street, *metal, *cars;
};

double square(double value) { return value * value; }

Vec3 block_corner(int i, int j, int blocks) { return {(i - blocks / 2.0) * pitch, 0, (j - blocks / 2.0) * pitch}; }

/// Storeys of a building whose lot is `nearness` to the centre: 1 there, 0 at the corner of the city.
int choose_storeys(double nearness, Random& random) {
    const int house = 3 + static_cast<int>(random.below(5));
    const bool is_tower = random.unit() < 0.15 + 0.45 * nearness;
    const double tower = random.between(4, 34) * nearness * nearness;
    return is_tower ? house + static_cast<int>(tower) : house;
}

/// The lots of one block: 2 x 2, 2 x 3 or 3 x 3 of uneven width, each with its own yard.
void plan_block(std::vector<Building>& buildings, const Vec3& corner, double nearness, Random& random) {
    const int across = 2 + static_cast<int>(random.below(2)), along = 2 + static_cast<int>(random.below(2));
    const double pavement = 3, usable = block_size - 2 * pavement;
    for (int i = 0; i < across; ++i) {
        for (int j = 0; j < along; ++j) {
            Building building;
            const double x = corner.x + pavement + usable * i / across, z = corner.z + pavement + usable * j / along;
            building.low_x = x + random.between(0.2, 2);
            building.low_z = z + random.between(0.2, 2);
            building.high_x = x + usable / across - random.between(0.2, 3);
            building.high_z = z + usable / along - random.between(0.2, 3);
            building.storeys = choose_storeys(nearness, random);
            building.bays_x = std::max(2, static_cast<int>((building.high_x - building.low_x) / 3));
            building.bays_z = std::max(2, static_cast<int>((building.high_z - building.low_z) / 3));
            building.paint = random.below(5);
            building.roof_seed = random.next();
            buildings.push_back(building);
        }
    }
}

std::vector<Building> plan_city(int blocks, std::uint64_t seed) {
    std::vector<Building> buildings;
    Random random(seed);
    for (int i = 0; i < blocks; ++i) {
        for (int j = 0; j < blocks; ++j) {
            const Vec3 corner = block_corner(i, j, blocks);
            const double middle_x = corner.x + pitch / 2, middle_z = corner.z + pitch / 2;
            const double reach = 2 * square(blocks * pitch / 2);
            plan_block(buildings, corner, 1 - (square(middle_x) + square(middle_z)) / reach, random);
        }
    }
    return buildings;
}

std::vector<Facade> facades_of(const std::vector<Building>& buildings) {
    std::vector<Facade> facades;
    for (const Building& b : buildings) {
        const double width = (b.high_x - b.low_x) / b.bays_x, depth = (b.high_z - b.low_z) / b.bays_z;
        const double y = kerb_height;
        const double distance = square((b.low_x + b.high_x) / 2) + square((b.low_z + b.high_z) / 2);
        const auto add = [&](const Vec3& corner, const Vec3& across, const Vec3& out, int bays) {
            facades.push_back({corner, across, out, bays, b.storeys, b.paint, distance});
        };
        add({b.low_x, y, b.high_z}, {width, 0, 0}, {0, 0, 1}, b.bays_x);
        add({b.high_x, y, b.high_z}, {0, 0, -depth}, {1, 0, 0}, b.bays_z);
        add({b.high_x, y, b.low_z}, {-width, 0, 0}, {0, 0, -1}, b.bays_x);
        add({b.low_x, y, b.low_z}, {0, 0, depth}, {-1, 0, 0}, b.bays_z);
    }
    return facades;
}

/// A cell with its lower left corner at `corner`: the wall around the opening, its four reveals, a pane, a sill.
/// `outer` are the wall's vertices at the cell's corners, shared with the neighbours.
void window_cell(Part& wall, Part& panes, const std::array<std::uint32_t, 4>& outer, const Vec3& corner,
                 const Vec3& across, const Vec3& out, bool is_ground_floor) {
    const Vec3 up{0, storey_height, 0};
    const double left = is_ground_floor ? 0.12 : 0.25, low = is_ground_floor ? 0.06 : 0.28;
    const double high = is_ground_floor ? 0.80 : 0.85;
    const std::array opening{corner + across * left + up * low, corner + across * (1 - left) + up * low,
                             corner + across * (1 - left) + up * high, corner + across * left + up * high};
    const Vec3 inwards = out * -0.25;
    std::array<std::uint32_t, 4> inner{}, deep{};
    for (unsigned i = 0; i < 4; ++i) inner[i] = wall.vertex(opening[i]);
    for (unsigned i = 0; i < 4; ++i) deep[i] = wall.vertex(opening[i] + inwards);
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned next = (i + 1) % 4;
        wall.quad(outer[i], outer[next], inner[next], inner[i]);
        wall.quad(inner[i], inner[next], deep[next], deep[i]);
    }
    quad(panes, opening[0] + inwards, opening[1] + inwards, opening[2] + inwards, opening[3] + inwards);
    // The sill, or over a shop its sign: a bar whose back is the wall.
    const Vec3 base = is_ground_floor ? opening[3] + up * 0.05 : opening[0] - up * 0.05;
    const Vec3 width = opening[1] - opening[0], rise = up * 0.05, depth = out * 0.18;
    std::array<std::uint32_t, 8> bar{};
    for (unsigned i = 0; i < 8; ++i) {
        bar[i] = wall.vertex(base + width * (i & 1 ? 1 : 0) + rise * (i & 2 ? 1 : 0) + depth * (i & 4 ? 1 : 0));
    }
    wall.quad(bar[4], bar[5], bar[7], bar[6]);
    wall.quad(bar[0], bar[1], bar[5], bar[4]);
    wall.quad(bar[2], bar[6], bar[7], bar[3]);
    wall.quad(bar[0], bar[4], bar[6], bar[2]);
    wall.quad(bar[1], bar[3], bar[7], bar[5]);
}

/// The wall with windows in its lowest `detailed` storeys and one plain rectangle above them. The strip of half a metre
/// over the last storey is plain too: it hides the roof's edge.
void add_facade(const Facade& facade, int detailed, const Paints& paints) {
    Part& wall = *paints.walls[facade.paint];
    const auto columns = static_cast<std::uint32_t>(facade.bays + 1);
    const auto first = static_cast<std::uint32_t>(wall.positions.size() / 3);
    const Vec3 up{0, storey_height, 0};
    if (detailed > 0) {
        for (int storey = 0; storey <= detailed; ++storey) {
            for (int i = 0; i <= facade.bays; ++i) wall.vertex(facade.corner + up * storey + facade.across * i);
        }
        for (int storey = 0; storey < detailed; ++storey) {
            for (int i = 0; i < facade.bays; ++i) {
                const std::uint32_t at =
                    first + static_cast<std::uint32_t>(storey) * columns + static_cast<std::uint32_t>(i);
                window_cell(wall, *paints.panes, {at, at + 1, at + columns + 1, at + columns},
                            facade.corner + up * storey + facade.across * i, facade.across, facade.out, storey == 0);
            }
        }
    }
    const Vec3 low = facade.corner + up * detailed;
    const Vec3 rest = up * (facade.storeys - detailed) + Vec3{0, 0.5, 0};
    const Vec3 end = facade.across * facade.bays;
    quad(wall, low, low + end, low + end + rest, low + rest);
}

void add_roof(const Building& b, const Paints& paints) {
    Random random(b.roof_seed);
    const double wall_top = kerb_height + b.height(), y = wall_top - 0.5;
    floor_quad(*paints.roofs, b.low_x, b.low_z, b.high_x, b.high_z, y);
    const double t = 0.3, top = wall_top + 0.25;  // a coping sits on the walls
    Part& coping = *paints.stone;
    box(coping, {b.low_x - 0.1, wall_top, b.low_z - 0.1}, {b.high_x + 0.1, top, b.low_z + t});
    box(coping, {b.low_x - 0.1, wall_top, b.high_z - t}, {b.high_x + 0.1, top, b.high_z + 0.1});
    box(coping, {b.low_x - 0.1, wall_top, b.low_z + t}, {b.low_x + t, top, b.high_z - t});
    box(coping, {b.high_x - t, wall_top, b.low_z + t}, {b.high_x + 0.1, top, b.high_z - t});
    // A stair house, fans, and on some roofs a water tank on legs.
    const auto place = [&](double inset) {
        return Vec3{random.between(b.low_x + inset, b.high_x - inset), y,
                    random.between(b.low_z + inset, b.high_z - inset)};
    };
    const Vec3 stairs = place(3);
    box(*paints.roofs, stairs + Vec3{-1.5, 0, -2}, stairs + Vec3{1.5, 2.6, 2});
    const int fans = 1 + static_cast<int>(random.below(3));
    for (int i = 0; i < fans; ++i) {
        const Vec3 fan = place(1.5);
        const double size = random.between(0.4, 0.9);
        box(*paints.metal, fan + Vec3{-size, 0, -size}, fan + Vec3{size, 1.4 * size, size});
    }
    if (random.below(4) == 0) {
        const Vec3 tank = place(2.5);
        for (const double x : {-0.9, 0.9}) {
            for (const double z : {-0.9, 0.9}) bar(*paints.metal, tank + Vec3{x, 0, z}, tank + Vec3{x, 2, z}, 0.12);
        }
        revolve(*paints.roofs, tank, std::array{ProfilePoint{1.4, 2}, ProfilePoint{1.4, 4.5}, ProfilePoint{0.05, 5.4}},
                12);
    }
}

void add_car(const Vec3& at, bool is_along_x, const Paints& paints) {
    const Vec3 along = is_along_x ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    const Vec3 across = is_along_x ? Vec3{0, 0, -1} : Vec3{1, 0, 0};
    const Vec3 up{0, 1, 0};
    oriented_box(*paints.cars, at + up * 0.6, across * 0.85, up * 0.35, along * 2.1);
    oriented_box(*paints.panes, at + up * 1.2 - along * 0.2, across * 0.75, up * 0.3, along * 1.1);
}

void add_lamp(const Vec3& foot, const Vec3& towards_street, const Paints& paints) {
    const Vec3 head = foot + Vec3{0, 7, 0};
    bar(*paints.metal, foot, head, 0.14);
    bar(*paints.metal, head, head + towards_street * 1.8, 0.1);
    box(*paints.metal, head + towards_street * 1.8 + Vec3{-0.25, -0.1, -0.25},
        head + towards_street * 1.8 + Vec3{0.25, 0.05, 0.25});
}

void add_street_furniture(const Vec3& corner, const Paints& paints, Random& random) {
    box(*paints.stone, corner, corner + Vec3{block_size, kerb_height, block_size});
    for (int i = 0; i < 9; ++i) {
        const double along = 4 + 6.5 * i;
        if (random.below(3) > 0) add_car(corner + Vec3{along + 2, 0, -1.6}, true, paints);
        if (random.below(3) > 0) add_car(corner + Vec3{-1.6, 0, along + 2}, false, paints);
        if (i % 3 == 1) {
            add_lamp(corner + Vec3{along, kerb_height, 0.6}, {0, 0, -1}, paints);
            add_lamp(corner + Vec3{0.6, kerb_height, along}, {-1, 0, 0}, paints);
        }
    }
}

Paints make_paints(Scene& scene) {
    Paints paints{};
    paints.street = &scene.part("street", {0.24, 0.24, 0.25});
    paints.stone = &scene.part("stone", {0.56, 0.55, 0.52});
    paints.walls = {&scene.part("brick", {0.52, 0.24, 0.17}), &scene.part("plaster", {0.76, 0.70, 0.58}),
                    &scene.part("concrete", {0.55, 0.56, 0.57}), &scene.part("ochre", {0.70, 0.52, 0.28}),
                    &scene.part("slate", {0.32, 0.38, 0.44})};
    paints.panes = &scene.part("glass", {0.10, 0.14, 0.18});
    paints.roofs = &scene.part("roofs", {0.30, 0.27, 0.26});
    paints.metal = &scene.part("metal", {0.42, 0.44, 0.46});
    paints.cars = &scene.part("cars", {0.60, 0.10, 0.10});
    return paints;
}

std::uint64_t full_facades(const std::vector<Facade>& facades) {
    return std::accumulate(facades.begin(), facades.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Facade& facade) { return sum + facade.full_triangles(); });
}

/// Windows for the facades nearest to the centre first, while the budget lasts; the others stay plain.
void add_facades(std::vector<Facade> facades, std::uint64_t budget, const Paints& paints) {
    std::ranges::stable_sort(facades, {}, &Facade::distance_squared);
    std::uint64_t for_windows = budget - std::min<std::uint64_t>(budget, 2 * facades.size());
    for (const Facade& facade : facades) {
        const std::uint64_t storeys =
            std::min(for_windows / facade.storey_triangles(), static_cast<std::uint64_t>(facade.storeys));
        for_windows -= storeys * facade.storey_triangles();
        add_facade(facade, static_cast<int>(storeys), paints);
    }
}

}  // namespace

Scene make_city(const Request& request) {
    int blocks = 2;
    std::vector<Building> buildings = plan_city(blocks, request.seed);
    while (full_facades(facades_of(buildings)) < request.triangles) buildings = plan_city(++blocks, request.seed);

    Scene scene;
    const Paints paints = make_paints(scene);
    const double half = blocks * pitch / 2;
    floor_quad(*paints.street, -2 * half, -2 * half, 2 * half, 2 * half, 0);
    Random random(request.seed + 1);
    for (int i = 0; i < blocks; ++i) {
        for (int j = 0; j < blocks; ++j) add_street_furniture(block_corner(i, j, blocks), paints, random);
    }
    for (const Building& building : buildings) add_roof(building, paints);
    add_facades(facades_of(buildings), missing_triangles(scene, request.triangles), paints);

    // The street between blocks is centred half a street before the corner of the next block.
    const Vec3 crossing = block_corner(blocks / 2, blocks / 2, blocks) + Vec3{-street / 2, 0, -street / 2};
    scene.camera("v0", {0.75 * half + 40, 0.35 * half + 70, 1.05 * half + 60}, {0, 0, -0.1 * half}, 50);
    scene.camera("v1", crossing + Vec3{2.5, 1.8, 62}, crossing + Vec3{-1, 14, -60}, 65);
    scene.directional("sun", {-0.45, -1, -0.3});
    scene.directional("low", {0.8, -0.3, -0.55});
    return scene;
}

}  // namespace gnomon::make_scenes
