// SPDX-License-Identifier: MIT
// A plant of pipes: a steel frame on a lattice of 1 m, filled with pipes that wander along the lattice's axes without
// touching each other, with elbows, flanges and vessels, and gratings to walk on. The frame's size follows from the
// budget, pipes are laid until a few percent of it are left, and gratings, 12 triangles a bar, spend the rest: the
// count is met within 12 triangles.
#include <algorithm>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr int frame_bay = 6, storey = 4;  // in lattice steps of 1 m
constexpr int tower = 3 * frame_bay;      // the frame's height changes from tower to tower

struct Cell {
    int x = 0, y = 0, z = 0;
};

constexpr std::array<Cell, 6> steps{{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, -1, 0}}};

Cell operator+(const Cell& a, const Cell& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Cell operator-(const Cell& a, const Cell& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
bool operator==(const Cell& a, const Cell& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
Vec3 to_vector(const Cell& cell) {
    return {static_cast<double>(cell.x), static_cast<double>(cell.y), static_cast<double>(cell.z)};
}

/// Which lattice points are taken: by a pipe, a vessel or the walkway.
class Lattice {
public:
    Lattice(int size_x, int size_y, int size_z)
        : size_{size_x, size_y, size_z}, taken_(static_cast<std::size_t>(size_x) * size_y * size_z, false) {}

    const Cell& size() const { return size_; }
    /// Lowers each tower to a height of its own, of whole storeys; what lies above is taken.
    void lower_towers(Random& random) {
        const int storeys = size_.y / storey;
        for (int x = 0; x < size_.x; x += tower) {
            for (int z = 0; z < size_.z; z += tower) {
                const auto missing = static_cast<int>(random.below(static_cast<std::uint32_t>(storeys * 2 / 3 + 1)));
                const int height = size_.y - missing * storey;
                take_box({x, height, z}, {x + tower - 1, size_.y - 1, z + tower - 1});
                tower_heights_.push_back(height);
            }
        }
    }
    /// The height of the tower over (x, z), also for the frame's last columns just outside.
    int height_at(int x, int z) const {
        const int across = (size_.z + tower - 1) / tower;
        const int i = std::min(x, size_.x - 1) / tower, j = std::min(z, size_.z - 1) / tower;
        return tower_heights_[static_cast<std::size_t>(i * across + j)];
    }
    bool is_free(const Cell& cell) const {
        const bool is_inside =
            cell.x >= 0 && cell.x < size_.x && cell.y >= 0 && cell.y < size_.y && cell.z >= 0 && cell.z < size_.z;
        return is_inside && !taken_[index(cell)];
    }
    void take(const Cell& cell) { taken_[index(cell)] = true; }
    void take_box(const Cell& low, const Cell& high) {
        for (int x = std::max(low.x, 0); x <= std::min(high.x, size_.x - 1); ++x) {
            for (int y = std::max(low.y, 0); y <= std::min(high.y, size_.y - 1); ++y) {
                for (int z = std::max(low.z, 0); z <= std::min(high.z, size_.z - 1); ++z) take({x, y, z});
            }
        }
    }
    /// The lattice point in the world: the plant's middle is at x = z = 0, its lowest pipes are 0.5 m up.
    Vec3 position(const Cell& cell) const {
        return {cell.x - (size_.x - 1) / 2.0, cell.y + 0.5, cell.z - (size_.z - 1) / 2.0};
    }

private:
    std::size_t index(const Cell& cell) const {
        return (static_cast<std::size_t>(cell.z) * size_.y + cell.y) * size_.x + cell.x;
    }
    Cell size_;
    std::vector<bool> taken_;
    std::vector<int> tower_heights_;
};

/// How finely pipes are cut, and what a lattice point of pipe then costs at most and about.
struct Detail {
    int sides, elbow_segments;
    std::uint64_t max_per_cell() const { return static_cast<std::uint64_t>(2 * sides * (elbow_segments + 1)); }
    std::uint64_t about_per_cell() const { return static_cast<std::uint64_t>(sides) * 9 / 2; }
};

Detail choose_detail(std::uint64_t triangles) {
    if (triangles < 50'000) return {8, 3};
    if (triangles < 500'000) return {10, 4};
    if (triangles < 5'000'000) return {12, 5};
    return {16, 6};
}

/// A lattice in which the budget's pipes take about 45 % of the points, where towers are lowered by a third of their
/// height on average; wide and a third as high.
Lattice fit_lattice(std::uint64_t triangles, const Detail& detail) {
    const std::uint64_t cells = triangles * 100 / 30 / detail.about_per_cell();
    int height = storey;
    const auto width = [](int h) { return h * 10 / 3; };
    while (static_cast<std::uint64_t>(width(height + 1)) * (height + 1) * width(height + 1) <= cells) ++height;
    return {width(height), height, width(height)};
}

/// A pipe's way: free lattice points, each one step from the last, mostly straight on.
std::vector<Cell> route(Lattice& lattice, std::size_t longest, Random& random) {
    const Cell& size = lattice.size();
    Cell at;
    at.x = static_cast<int>(random.below(static_cast<std::uint32_t>(size.x)));
    at.y = static_cast<int>(random.below(static_cast<std::uint32_t>(size.y)));
    at.z = static_cast<int>(random.below(static_cast<std::uint32_t>(size.z)));
    std::vector<Cell> way;
    if (!lattice.is_free(at)) return way;
    way.push_back(at);
    lattice.take(at);
    std::size_t heading = random.below(6);
    while (way.size() < longest) {
        const bool turns = random.below(7) == 0;
        if (turns || !lattice.is_free(at + steps[heading])) {
            // Level ways are likelier than upright ones: the first four of the six.
            const std::size_t first = random.below(4) > 0 ? random.below(4) : 4 + random.below(2);
            std::size_t tries = 0;
            while (tries < 6 && !lattice.is_free(at + steps[(first + tries) % 6])) ++tries;
            if (tries == 6) break;
            heading = (first + tries) % 6;
        }
        at = at + steps[heading];
        way.push_back(at);
        lattice.take(at);
    }
    return way;
}

/// A pipe in the making: one skin from its first ring to its last, so neighbours share every vertex.
class Pipe {
public:
    Pipe(Part& part, double radius, const Detail& detail) : part_(part), radius_(radius), detail_(detail) {}

    void start(const Vec3& at, const Vec3& along) {
        u_ = perpendicular(along);
        v_ = cross(along, u_);
        last_ = add_ring(at);
        cap_ring(part_, last_, at, detail_.sides, true);
    }
    void straight_to(const Vec3& at) {
        const std::uint32_t next = add_ring(at);
        join_rings(part_, last_, next, detail_.sides);
        last_ = next;
    }
    /// A quarter of a torus around the lattice point `corner`, which starts and ends `bend` away from it.
    void elbow(const Vec3& corner, const Vec3& from, const Vec3& to, double bend) {
        const Vec3 axis = cross(from, to);
        const Vec3 center = corner - from * bend + to * bend;
        const auto turned = [&](const Vec3& frame, const CosineSine& angle) {
            // `frame` is at right angles to `from`: its part along `to` turns towards -from, the rest stays.
            return axis * dot(frame, axis) + (to * angle.cosine - from * angle.sine) * dot(frame, to);
        };
        const Vec3 u = u_, v = v_;
        for (int i = 1; i <= detail_.elbow_segments; ++i) {
            const CosineSine angle = cosine_sine(0.25 * i / detail_.elbow_segments);
            u_ = turned(u, angle);
            v_ = turned(v, angle);
            straight_to(center + (from * angle.sine - to * angle.cosine) * bend);
        }
    }
    void end(const Vec3& at) {
        straight_to(at);
        cap_ring(part_, last_, at, detail_.sides, false);
    }

private:
    std::uint32_t add_ring(const Vec3& at) { return ring(part_, at, u_ * radius_, v_ * radius_, detail_.sides); }

    Part& part_;
    double radius_;
    const Detail& detail_;
    Vec3 u_, v_;
    std::uint32_t last_ = 0;
};

/// Two flanges face to face, as one closed disc around the pipe: 4 * sides triangles.
void flange(Part& part, const Vec3& at, const Vec3& along, double radius, int sides) {
    revolve(part, at, along, std::array{ProfilePoint{radius, -0.05}, ProfilePoint{radius, 0.05}}, sides);
}

void lay_pipe(Part& part, Part& steel, const Lattice& lattice, const std::vector<Cell>& way, const Detail& detail,
              Random& random) {
    static constexpr std::array<double, 5> radii{0.06, 0.10, 0.15, 0.21, 0.28};
    const double radius = radii[random.below(5)];
    const double bend = std::min(0.5, 1.5 * radius + 0.08);
    Pipe pipe(part, radius, detail);
    const Vec3 first_along = to_vector(way[1] - way[0]);
    pipe.start(lattice.position(way[0]) - first_along * 0.3, first_along);
    flange(steel, lattice.position(way[0]) - first_along * 0.25, first_along, radius * 1.4 + 0.02, detail.sides);
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
        const Cell from = way[i] - way[i - 1], to = way[i + 1] - way[i];
        const Vec3 corner = lattice.position(way[i]);
        if (from == to) {
            if (random.below(3) == 0) flange(steel, corner, to_vector(from), radius * 1.4 + 0.02, detail.sides);
            continue;
        }
        pipe.straight_to(corner - to_vector(from) * bend);
        pipe.elbow(corner, to_vector(from), to_vector(to), bend);
    }
    const Vec3 last_along = to_vector(way.back() - way[way.size() - 2]);
    pipe.end(lattice.position(way.back()) + last_along * 0.3);
    flange(steel, lattice.position(way.back()) + last_along * 0.25, last_along, radius * 1.4 + 0.02, detail.sides);
}

/// Columns, beams along both axes and a brace here and there, half a step beside the pipes' lattice.
void add_frame(Part& steel, const Lattice& lattice, Random& random) {
    const Cell& size = lattice.size();
    const auto corner = [&](int x, int y, int z) {
        const Vec3 at = lattice.position({std::min(x, size.x), y, std::min(z, size.z)});
        return Vec3{at.x - 0.5, y == 0 ? 0 : at.y - 0.5, at.z - 0.5};
    };
    for (int x = 0; x < size.x + frame_bay; x += frame_bay) {
        for (int z = 0; z < size.z + frame_bay; z += frame_bay) {
            const int height = lattice.height_at(x, z);
            bar(steel, corner(x, 0, z), corner(x, height, z), 0.26);
            for (int y = storey; y <= height; y += storey) {
                if (x < size.x) bar(steel, corner(x, y, z), corner(x + frame_bay, y, z), 0.2);
                if (z < size.z) bar(steel, corner(x, y, z), corner(x, y, z + frame_bay), 0.2);
                if (x < size.x && random.below(6) == 0) {
                    bar(steel, corner(x, y - storey, z), corner(x + frame_bay, y, z), 0.1);
                }
            }
        }
    }
}

/// Upright vessels with domed ends inside the frame; they take their lattice points before any pipe.
void add_vessels(Part& part, Lattice& lattice, const Detail& detail, Random& random) {
    const Cell& size = lattice.size();
    const int count = size.x * size.z / 250;
    for (int i = 0; i < count; ++i) {
        const int x = 3 + static_cast<int>(random.below(static_cast<std::uint32_t>(size.x - 6)));
        const int z = 3 + static_cast<int>(random.below(static_cast<std::uint32_t>(size.z - 6)));
        const int height = std::min(lattice.height_at(x, z) - 1, 3 + static_cast<int>(random.below(6)));
        bool is_free = true;
        for (int a = -2; a <= 2; ++a) {
            for (int b = -2; b <= 2; ++b) is_free = is_free && lattice.is_free({x + a, 0, z + b});
        }
        if (!is_free) continue;
        lattice.take_box({x - 2, 0, z - 2}, {x + 2, height, z + 2});
        const double radius = 1.9;
        std::vector<ProfilePoint> profile{{0.6 * radius, 0}, {0.6 * radius, 0.3}};
        for (int k = 0; k <= detail.elbow_segments; ++k) {
            const CosineSine angle = cosine_sine(0.2 * (k - detail.elbow_segments) / detail.elbow_segments);
            profile.push_back({radius * angle.cosine, 1.1 + 0.8 * angle.sine});
        }
        for (int k = 0; k <= detail.elbow_segments; ++k) {
            const CosineSine angle = cosine_sine(0.24 * k / detail.elbow_segments);
            profile.push_back({radius * angle.cosine, height - 0.8 + 0.8 * angle.sine});
        }
        revolve(part, Vec3{lattice.position({x, 0, 0}).x, 0, lattice.position({0, 0, z}).z}, profile, 2 * detail.sides);
    }
}

/// `count` bars of grating, laid bay by bay over every storey in turn; if they are too many, closer together.
void add_gratings(Part& part, const Lattice& lattice, std::uint64_t count) {
    if (count == 0) return;
    const Cell& size = lattice.size();
    std::vector<Cell> bays;
    for (int y = storey; y <= size.y; y += storey) {
        for (int x = 0; x + frame_bay <= size.x; x += frame_bay) {
            for (int z = 0; z + frame_bay <= size.z; z += frame_bay) {
                if (y <= lattice.height_at(x, z) && (x / frame_bay + 2 * (z / frame_bay) + y / storey) % 3 == 0)
                    bays.push_back({x, y, z});
            }
        }
    }
    const std::uint64_t usual = 60;
    const std::uint64_t used = std::clamp<std::uint64_t>((count + usual - 1) / usual, 1, bays.size());
    for (std::uint64_t bay = 0; bay < used; ++bay) {
        const std::uint64_t bars = (bay + 1) * count / used - bay * count / used;
        const Vec3 corner = lattice.position(bays[bay]) - Vec3{0.5, 0.5, 0.5};
        const double space = frame_bay / static_cast<double>(bars);
        for (std::uint64_t i = 0; i < bars; ++i) {
            const double x = corner.x + space * static_cast<double>(i);
            box(part, {x, corner.y + 0.1, corner.z}, {x + 0.3 * space, corner.y + 0.13, corner.z + frame_bay});
        }
    }
}

}  // namespace

Scene make_pipes(const Request& request) {
    Random random(request.seed);
    const Detail detail = choose_detail(request.triangles);
    Lattice lattice = fit_lattice(request.triangles, detail);
    const Cell size = lattice.size();
    lattice.lower_towers(random);

    Scene scene;
    const double half = size.x * 1.5 + 20;
    floor_quad(scene.part("ground", {0.48, 0.46, 0.42}), -half, -half, half, half, 0);
    Part& steel = scene.part("steel", {0.40, 0.42, 0.45});
    const std::array colors{
        &scene.part("grey_pipes", {0.62, 0.64, 0.66}), &scene.part("rusty_pipes", {0.48, 0.27, 0.16}),
        &scene.part("yellow_pipes", {0.78, 0.60, 0.12}), &scene.part("green_pipes", {0.16, 0.42, 0.26}),
        &scene.part("blue_pipes", {0.16, 0.30, 0.55})};
    add_frame(steel, lattice, random);
    // A walkway through the plant, three wide and three high, from the front to its middle and on.
    const int walk = size.x / 2;
    lattice.take_box({walk - 1, 0, 0}, {walk + 1, 2, size.z});
    add_vessels(scene.part("vessels", {0.70, 0.70, 0.68}), lattice, detail, random);

    // Lay pipes until what is left is 3 % or a full lattice: 200 starts in a row that found no room.
    const std::uint64_t for_gratings = request.triangles * 3 / 100;
    const std::uint64_t per_cell = detail.max_per_cell();
    const std::uint64_t ends = static_cast<std::uint64_t>(12 * detail.sides);
    std::uint64_t left = missing_triangles(scene, request.triangles);
    for (int failures = 0; failures < 200 && left > for_gratings + ends + 3 * per_cell;) {
        const std::uint64_t longest = (left - for_gratings - ends) / per_cell;
        const std::vector<Cell> way = route(lattice, std::min<std::uint64_t>(longest, 90), random);
        if (way.size() < 3) {
            ++failures;
            continue;
        }
        failures = 0;
        lay_pipe(*colors[random.below(5)], steel, lattice, way, detail, random);
        left = missing_triangles(scene, request.triangles);
    }
    add_gratings(scene.part("gratings", {0.34, 0.35, 0.36}), lattice, left / 12);

    const double reach = size.x / 2.0;
    scene.camera("v0", {1.1 * reach + 5, 1.3 * size.y + 3, 1.6 * reach + 7}, {0, 0.2 * size.y, 0.1 * reach}, 50);
    const Vec3 mouth = lattice.position({walk, 1, size.z + 2});
    scene.camera("v1", mouth + Vec3{2, 0.4, 0}, mouth + Vec3{-4, 2, -9}, 70);
    scene.directional("sun", {-0.4, -1, -0.55});
    scene.directional("low", {-0.7, -0.35, -1});
    return scene;
}

}  // namespace gnomon::make_scenes
