// SPDX-License-Identifier: MIT
// A columned hall on steps, under beams and a roof with openings. The budget decides how finely columns are cut and how
// many there are; paving slabs, 10 triangles each, spend what is left, so the count is met within 10 triangles.
#include <algorithm>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr double bay = 5;            // from column to column
constexpr double column_height = 9;  // top of the abacus
constexpr double beam_height = 0.9;
constexpr double roof_thickness = 0.3;
constexpr double margin = 3.5;  // of the platform around the outer columns

struct Hall {
    int rows = 3, bays = 2;  ///< columns across (x) and along (z)
    int sides = 12;          ///< of a column
    double half_x() const { return (rows - 1) * bay / 2; }
    double half_z() const { return (bays - 1) * bay / 2; }
    double x(int row) const { return row * bay - half_x(); }
    double z(int index) const { return index * bay - half_z(); }
};

void column(Part& part, const Vec3& foot, int sides) {
    box(part, foot + Vec3{-0.75, -0.07, -0.75}, foot + Vec3{0.75, 0.25, 0.75});  // sunk into the paving
    static constexpr std::array profile{ProfilePoint{0.68, 0.25}, ProfilePoint{0.74, 0.34}, ProfilePoint{0.68, 0.45},
                                        ProfilePoint{0.58, 0.50}, ProfilePoint{0.56, 0.60}, ProfilePoint{0.57, 2.50},
                                        ProfilePoint{0.55, 4.50}, ProfilePoint{0.51, 6.50}, ProfilePoint{0.46, 8.20},
                                        ProfilePoint{0.52, 8.24}, ProfilePoint{0.48, 8.32}, ProfilePoint{0.70, 8.65}};
    revolve(part, foot, profile, sides);
    box(part, foot + Vec3{-0.78, 8.65, -0.78}, foot + Vec3{0.78, column_height, 0.78});
}

/// A closed slab with a square hole in its middle: 32 triangles.
void pierced_slab(Part& part, const Vec3& low, const Vec3& high, double rim) {
    std::array<std::uint32_t, 16> corners{};  // bottom outer, bottom inner, top outer, top inner
    for (unsigned i = 0; i < 16; ++i) {
        const double inset = i & 4 ? rim : 0;
        const bool is_far_x = i % 4 == 1 || i % 4 == 2, is_far_z = i % 4 >= 2;
        corners[i] = part.vertex({is_far_x ? high.x - inset : low.x + inset, i & 8 ? high.y : low.y,
                                  is_far_z ? high.z - inset : low.z + inset});
    }
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned next = (i + 1) % 4;
        part.quad(corners[i], corners[next], corners[4 + next], corners[4 + i]);            // underside
        part.quad(corners[8 + i], corners[12 + i], corners[12 + next], corners[8 + next]);  // top
        part.quad(corners[i], corners[8 + i], corners[8 + next], corners[next]);            // outside
        part.quad(corners[4 + i], corners[4 + next], corners[12 + next], corners[12 + i]);  // rim of the hole
    }
}

/// A gable over the front or back: a closed prism of 8 triangles.
void gable(Part& part, double half_x, double y, double height, double low_z, double high_z) {
    const auto first = part.vertex({-half_x, y, high_z});
    part.vertex({half_x, y, high_z});
    part.vertex({0, y + height, high_z});
    part.vertex({-half_x, y, low_z});
    part.vertex({half_x, y, low_z});
    part.vertex({0, y + height, low_z});
    part.triangle(first, first + 1, first + 2);
    part.triangle(first + 3, first + 5, first + 4);
    part.quad(first, first + 3, first + 4, first + 1);
    part.quad(first + 1, first + 4, first + 5, first + 2);
    part.quad(first + 2, first + 5, first + 3, first);
}

/// Everything that one more column brings along, at most: the column, two beams, a pierced piece of roof.
std::uint64_t triangles_per_column(int sides) {
    Part sample;
    column(sample, {}, sides);
    return sample.triangle_count() + 2 * 12 + 32;
}

Hall fit_hall(std::uint64_t triangles) {
    Hall hall;
    hall.sides = triangles < 30'000 ? 10 : triangles < 200'000 ? 16 : triangles < 2'000'000 ? 24 : 40;
    const std::uint64_t columns = triangles * 85 / 100 / triangles_per_column(hall.sides);
    const auto rows_for = [](int bays) { return std::max(3, bays / 3); };
    while (static_cast<std::uint64_t>(rows_for(hall.bays + 1)) * static_cast<std::uint64_t>(hall.bays + 1) <= columns) {
        ++hall.bays;
    }
    hall.rows = rows_for(hall.bays);
    return hall;
}

void add_platform(Part& part, const Hall& hall) {
    for (int step = 0; step < 4; ++step) {
        const double x = hall.half_x() + margin + 0.5 * (3 - step), z = hall.half_z() + margin + 0.5 * (3 - step);
        box(part, {-x, -1.6 + 0.38 * step, -z}, {x, -1.6 + 0.38 * (step + 1), z});
    }
}

void add_beams(Part& part, const Hall& hall) {
    const double low = column_height, high = column_height + beam_height;
    for (int row = 0; row < hall.rows; ++row) {
        for (int i = 0; i + 1 < hall.bays; ++i) {
            box(part, {hall.x(row) - 0.6, low, hall.z(i)}, {hall.x(row) + 0.6, high, hall.z(i + 1)});
        }
    }
    for (int i = 0; i < hall.bays; ++i) {
        for (int row = 0; row + 1 < hall.rows; ++row) {
            box(part, {hall.x(row), low + 0.25, hall.z(i) - 0.45}, {hall.x(row + 1), high, hall.z(i) + 0.45});
        }
    }
}

void add_roof(Part& part, const Hall& hall, Random& random) {
    const double low = column_height + beam_height, high = low + roof_thickness;
    for (int row = 0; row + 1 < hall.rows; ++row) {
        for (int i = 0; i + 1 < hall.bays; ++i) {
            const Vec3 from{hall.x(row), low, hall.z(i)}, to{hall.x(row + 1), high, hall.z(i + 1)};
            if (random.below(2) == 0) {
                box(part, from, to);
            } else {
                pierced_slab(part, from, to, random.between(0.6, 1.2));
            }
        }
    }
    const double x = hall.half_x() + 1.2, z = hall.half_z() + 1.2;
    box(part, {-x, low, -z}, {-x + 1.2, high + 0.5, z});
    box(part, {x - 1.2, low, -z}, {x, high + 0.5, z});
    const double height = 0.22 * x;
    gable(part, x, high + 0.5, height, -z, -z + 1.2);
    gable(part, x, high + 0.5, height, z - 1.2, z);
}

/// `count` slabs in rows across the platform, a hair apart, none quite level with the next.
void add_paving(Part& part, const Hall& hall, std::uint64_t count, Random& random) {
    if (count == 0) return;
    const double low_x = -hall.half_x() - margin, low_z = -hall.half_z() - margin;
    const double size_x = -2 * low_x, size_z = -2 * low_z;
    const auto lines = std::clamp<std::uint64_t>(
        static_cast<std::uint64_t>(std::sqrt(static_cast<double>(count) * size_z / size_x)), 1, count);
    for (std::uint64_t line = 0; line < lines; ++line) {
        const std::uint64_t slabs = (line + 1) * count / lines - line * count / lines;
        const double depth = size_z / static_cast<double>(lines), width = size_x / static_cast<double>(slabs);
        const double z = low_z + depth * static_cast<double>(line);
        for (std::uint64_t i = 0; i < slabs; ++i) {
            const double x = low_x + width * static_cast<double>(i);
            const double top = random.between(-0.006, 0);
            lid(part, {x, -0.08, z}, {x + 0.99 * width, top, z + 0.99 * depth});
        }
    }
}

}  // namespace

Scene make_colonnade(const Request& request) {
    Random random(request.seed);
    const Hall hall = fit_hall(request.triangles);
    Scene scene;
    const double ground = 60 + 4 * hall.half_z();
    floor_quad(scene.part("ground", {0.36, 0.40, 0.24}), -ground, -ground, ground, ground, -1.6);
    add_platform(scene.part("steps", {0.66, 0.62, 0.55}), hall);
    Part& columns = scene.part("columns", {0.80, 0.76, 0.68});
    for (int i = 0; i < hall.bays; ++i) {
        for (int row = 0; row < hall.rows; ++row) column(columns, {hall.x(row), 0, hall.z(i)}, hall.sides);
    }
    add_beams(scene.part("beams", {0.74, 0.70, 0.62}), hall);
    add_roof(scene.part("roof", {0.62, 0.33, 0.22}), hall, random);
    Part& paving = scene.part("paving", {0.58, 0.55, 0.52});
    add_paving(paving, hall, missing_triangles(scene, request.triangles) / 10, random);

    const double x = hall.half_x(), z = hall.half_z();
    scene.camera("v0", {x + 0.55 * z + 10, 0.25 * z + 10, 1.35 * z + 10}, {0, 2, 0.3 * z}, 45);
    scene.camera("v1", {hall.x(1) + 1.9, 1.7, hall.z(hall.bays - 1) - 1.5}, {hall.x(0), 2.6, -z}, 65);
    scene.directional("sun", {-0.5, -1, -0.35});
    scene.directional("low", {-1, -0.22, -0.55});
    return scene;
}

}  // namespace gnomon::make_scenes
