// SPDX-License-Identifier: MIT
// Height fields are found where triangles are one, and nowhere else; their grid lists all triangles, and their pyramid
// bounds all heights.
#include <gtest/gtest.h>

#include "horizons/height_field.hpp"
#include "support/device.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;

gnomon::BuiltHeightField field_of(const gnomon::Device& device, const Floats& triangles) {
    return {device, gnomon::Triangles::upload(device, triangles)};
}

TEST(HeightField, IsFoundWhateverItsAxisAndWinding) {
    const gnomon::Device device = device_with();
    for (const Floats& sheet : {lattice_terrain(1).triangles(), rough_terrain(2, 0.3f).triangles()})
        for (const int axis : {0, 1, 2})
            for (const bool is_over : {false, true}) {
                const auto turned = turned_up(is_over ? turned_over(sheet) : sheet, axis);
                const auto found = field_of(device, turned);
                ASSERT_TRUE(found.is_field());
                EXPECT_EQ(found.field().axis, unsigned(axis));
                Float3 low{HUGE_VALF, HUGE_VALF, HUGE_VALF}, high{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
                for (std::size_t i = 0; i < turned.size(); ++i) {
                    low[i % 3] = std::min(low[i % 3], turned[i]);
                    high[i % 3] = std::max(high[i % 3], turned[i]);
                }
                const int x = (axis + 1) % 3, y = (axis + 2) % 3;
                const float sides[4] = {low[x], low[y], high[x], high[y]};
                for (int k = 0; k < 4; ++k) EXPECT_EQ(found.field().inside[k], sides[k]);
            }
}

TEST(HeightField, IsNotFoundWhereTrianglesOverlapTurnOverOrLeaveMuchOut) {
    const gnomon::Device device = device_with();
    const Floats sheet = rough_terrain(3, 0.2f).triangles();
    const std::size_t count = sheet.size() / 9;
    Floats twice = sheet, doubled = sheet, folded = sheet, wall = sheet, odd = sheet;
    append(twice, sheet);
    doubled.insert(doubled.end(), sheet.begin() + 9 * 1320, sheet.begin() + 9 * 1322);  // two in the middle again
    for (int c = 0; c < 3; ++c) std::swap(folded[9 * 700 + 3 + c], folded[9 * 700 + 6 + c]);
    add(wall, {0, 110, 20}, {0, 120, 20}, {0, 110, 24});
    odd[9 * 500 + 4] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(field_of(device, twice).is_field());
    EXPECT_FALSE(field_of(device, folded).is_field());
    EXPECT_FALSE(field_of(device, wall).is_field());
    EXPECT_FALSE(field_of(device, odd).is_field());
    EXPECT_FALSE(field_of(device, lattice_blocks(5, 3, 1)).is_field());
    EXPECT_FALSE(field_of(device, without_triangle(sheet, count / 2)).is_field());  // a hole in the middle
    EXPECT_FALSE(field_of(device, {}).is_field());
    // Two sheets, one above the other: each place has two heights.
    Floats above = sheet;
    for (std::size_t i = 1; i < above.size(); i += 3) above[i] += 30;
    append(above, sheet);
    EXPECT_FALSE(field_of(device, above).is_field());
    EXPECT_FALSE(field_of(device, doubled).is_field());
}

TEST(HeightField, LeavesOutWhatABorderReachesInto) {
    const gnomon::Device device = device_with();
    Terrain terrain = rough_terrain(4, 0);
    const Floats sheet = terrain.triangles();
    const auto found = field_of(device, without_triangle(sheet, 2 * (3 * terrain.columns + 11)));
    ASSERT_TRUE(found.is_field());
    const gnomon::HeightField& field = found.field();
    // The hole is in column 11 of row 3; the ground's axes are z and x.
    const float row = terrain.corner[2] + terrain.spacing * 4;
    EXPECT_EQ(field.inside[0], row);
    EXPECT_EQ(field.inside[1], terrain.corner[0]);
}

/// A place in a triangle, and its height there.
struct Place {
    double x, y, height;
};
Place place_in(const float* v, const gnomon::HeightField& field, double a, double b) {
    const auto of = [&](int c) { return v[c] + a * (double(v[3 + c]) - v[c]) + b * (double(v[6 + c]) - v[c]); };
    const int axis = int(field.axis);
    return {(of((axis + 1) % 3) - field.corner[0]) * field.halves,
            (of((axis + 2) % 3) - field.corner[1]) * field.halves, (of(axis) - field.lowest) * field.units};
}

TEST(HeightField, GridListsAndPyramidBoundsAllPlacesOfAllTriangles) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = gnomon::session_of(device);
    for (const Floats& triangles : {lattice_terrain(5).triangles(), rough_terrain(6, 0.2f).triangles()}) {
        const auto built = field_of(device, triangles);
        ASSERT_TRUE(built.is_field());
        const gnomon::HeightField& field = built.field();
        const auto starts = session.read_values<std::uint32_t>(built.starts().get(), field.columns * field.rows + 1);
        const auto list = session.read_values<std::uint32_t>(built.list().get(), starts.back());
        const auto pyramid =
            session.read_values<std::uint32_t>(built.pyramid().get(), built.pyramid().bytes() / sizeof(std::uint32_t));
        Random random(7);
        for (std::uint32_t t = 0; t < triangles.size() / 9; ++t)
            for (int k = 0; k < 12; ++k) {
                double a = k < 4 ? k % 2 : random.below(1000) / 1000.0, b = k < 4 ? k / 2 : random.below(1000) / 1000.0;
                if (a + b > 1) a = 1 - a, b = 1 - b;
                const Place place = place_in(&triangles[9 * t], field, a, b);
                // Readers look somewhat farther than a cell.
                const double look = 3 * FIELD_SNAP;
                bool is_listed = false;
                for (const double dx : {-look, look})
                    for (const double dy : {-look, look}) {
                        const auto x = std::size_t(std::clamp(place.x / 2 + dx, 0.0, field.columns - 1.0));
                        const auto y = std::size_t(std::clamp(place.y / 2 + dy, 0.0, field.rows - 1.0));
                        const std::size_t cell = y * field.columns + x;
                        for (std::uint32_t at = starts[cell]; at < starts[cell + 1]; ++at) is_listed |= list[at] == t;
                    }
                EXPECT_TRUE(is_listed) << "triangle " << t;
                for (std::size_t l = 0; l < built.levels().size(); ++l) {
                    const gnomon::FieldLevel& level = built.levels()[l];
                    // All entries that hold the place and what is around it.
                    const double size = std::ldexp(1.0, int(l));
                    for (int dx = 0; dx < 2; ++dx)
                        for (int dy = 0; dy < 2; ++dy) {
                            const int x = int(std::floor((place.x - look) / size)) - dx;
                            const int y = int(std::floor((place.y - look) / size)) - dy;
                            if (x < 0 || y < 0 || (place.x + look) / size >= x + 2 || (place.y + look) / size >= y + 2)
                                continue;
                            const std::uint32_t entry = pyramid.at(level.first + std::size_t(y) * level.columns + x);
                            EXPECT_GE(double(entry >> 16), place.height) << "level " << l;
                            EXPECT_LE(double(entry & 0xFFFF), place.height) << "level " << l;
                        }
                }
                if (HasFailure()) return;
            }
    }
}

// Far from the grid's corner a thin fence has no area once coordinates are rounded, and is as high all the same.
TEST(HeightField, PyramidHasTheHeightOfATriangleThatRoundsToALine) {
    const gnomon::Device device = device_with();
    const float side = 5000, thin = 1e-4f;
    Floats triangles;
    const auto quad = [&](const Float3& a, const Float3& b, const Float3& c, const Float3& d) {
        add(triangles, a, b, c);
        add(triangles, a, c, d);
    };
    constexpr int rows = 40;
    for (int j = 0; j < rows; ++j) {
        const float z0 = side * (float(j) / (rows / 2) - 1), z1 = side * (float(j + 1) / (rows / 2) - 1);
        const float columns[] = {-side, -side / 2, -thin, 0, thin, side / 2, side};
        for (int i = 0; i < 6; ++i) {
            const auto at = [&](int k, float z) { return Float3{columns[k], k == 3 ? 50.0f : 0.0f, z}; };
            quad(at(i, z0), at(i, z1), at(i + 1, z1), at(i + 1, z0));
        }
    }
    const auto built = field_of(device, triangles);
    ASSERT_TRUE(built.is_field());
    ASSERT_EQ(built.field().axis, 1u);
    const auto pyramid = gnomon::session_of(device).read_values<std::uint32_t>(
        built.pyramid().get(), built.pyramid().bytes() / sizeof(std::uint32_t));
    const gnomon::FieldLevel& level = built.levels()[0];
    const auto middle = std::uint32_t(side * built.field().halves);  // the ground's axes are z and x
    for (std::uint32_t x = 0; x + 1 < level.columns; ++x)
        EXPECT_GE(pyramid.at(level.first + middle * level.columns + x) >> 16, std::uint32_t(50 * built.field().units));
}

TEST(HeightField, IsNotFoundWhereACellHasVeryManyTriangles) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.columns = terrain.rows = 80;
    terrain.height = [](std::size_t, std::size_t) { return 0.0f; };
    Floats wide = terrain.triangles();
    // All vertices but those of the border's columns in a narrow strip.
    for (std::size_t i = 0; i < wide.size(); i += 3)
        if (wide[i] != 0 && wide[i] != 80) wide[i] = wide[i] / 128;
    EXPECT_TRUE(field_of(device, terrain.triangles()).is_field());
    EXPECT_FALSE(field_of(device, wide).is_field());
}

// Products of distances of smaller cells could underflow.
TEST(HeightField, IsNotFoundWhereCellsAreTiny) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.height = [](std::size_t, std::size_t) { return 0.0f; };
    for (const float spacing : {0x1p-33f, 0x1p-35f}) {
        terrain.spacing = spacing;
        EXPECT_EQ(field_of(device, terrain.triangles()).is_field(), spacing > FIELD_LEAST_CELL);
    }
}

// On a slope the bounds of an entry of the lowest level, which is two half cells wide, are as far apart as the ground.
TEST(HeightField, BoundsOfASlopeAreTight) {
    const gnomon::Device device = device_with();
    Terrain terrain;
    terrain.height = [](std::size_t i, std::size_t) { return float(i) / 8; };
    const auto built = field_of(device, terrain.triangles());
    ASSERT_TRUE(built.is_field());
    const auto pyramid = gnomon::session_of(device).read_values<std::uint32_t>(
        built.pyramid().get(), built.pyramid().bytes() / sizeof(std::uint32_t));
    const gnomon::FieldLevel& level = built.levels()[0];
    const double cell = built.field().units / 8;  // how much the ground rises over one
    ASSERT_EQ(level.columns, 2 * terrain.rows);   // the ground's axes are z and x
    for (std::uint32_t y = 0; y + 1 < level.rows; ++y)
        for (std::uint32_t x = 0; x + 1 < level.columns; ++x) {
            const std::uint32_t entry = pyramid.at(level.first + y * level.columns + x);
            EXPECT_LT(double(entry >> 16) - double(entry & 0xFFFF), 1.1 * cell);
        }
}

}  // namespace
