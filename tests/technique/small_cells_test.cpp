// SPDX-License-Identifier: MIT
// Every small case through whole runs: lists, prepared light, packets, beams and point beams by their own kernels. All
// triangles with coordinates 0, 1 and 2 lie in cells of one scene, each with the grid's 27 points; the cells stand side
// by side in a plane across the light, so that no cell shadows another. One scene for each of the 98 directions with
// coordinates from -2 to 2 that are no double of another, whose numbers would be the same, times two. Small integers
// are the judge. An affine map changes no answer and makes the products round.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <gnomon.hpp>
#include "support/small_cases.hpp"

namespace {

using namespace support;

constexpr std::uint32_t SIDE = 3, GRID = 27, TRIANGLES = GRID * GRID * GRID, CELLS_IN_A_ROW = 141;
/// Cells are at most 2 wide along each axis, so this many steps of an integer vector lead out of a cell's shadow.
constexpr int STEPS = 4;

Vector cross(Vector u, Vector v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}
bool is_zero(Vector v) { return v == Vector{0, 0, 0}; }
Vector shortest(Vector v) {
    for (const int by : {2, 3, 5})
        while (v[0] % by == 0 && v[1] % by == 0 && v[2] % by == 0) v = {v[0] / by, v[1] / by, v[2] / by};
    return v;
}

const ExactMap SAME;
/// Rays need coordinates up to 2^19.
const ExactMap ROUNDED{{{{601, -433, 279}, {-359, 577, 593}, {467, 599, -331}}}, {}, 1.0f / 64};

/// The scene of one direction, which points towards the light. Triangle i is that of cell i.
struct Cells {
    std::vector<float> vertices, points;
    gnomon::Light light;

    Cells(Vector towards_light, const ExactMap& map) {
        const Vector side =
            cross(towards_light, is_zero(cross(towards_light, {1, 0, 0})) ? Vector{0, 1, 0} : Vector{1, 0, 0});
        const Vector u = shortest(side), v = shortest(cross(towards_light, u));
        for (std::uint32_t id = 0; id < TRIANGLES; ++id) {
            const int column = int(id % CELLS_IN_A_ROW) - int(CELLS_IN_A_ROW / 2),
                      row = int(id / CELLS_IN_A_ROW) - int(CELLS_IN_A_ROW / 2);
            const auto add = [&](std::vector<float>& to, std::uint32_t of_grid) {
                Vector at = grid_point(of_grid, SIDE);
                for (std::size_t k = 0; k < 3; ++k) at[k] += STEPS * (column * u[k] + row * v[k]);
                for (const float x : map.apply(at, false)) to.push_back(x);
            };
            for (const std::uint32_t corner : {id % GRID, id / GRID % GRID, id / GRID / GRID}) add(vertices, corner);
            for (std::uint32_t p = 0; p < GRID; ++p) add(points, p);
        }
        const auto d = map.apply(towards_light, true);
        light = gnomon::Light::directional({-d[0], -d[1], -d[2]});
    }
};

std::vector<bool> blocked_in_cells(Vector towards_light) {
    std::vector<bool> blocked;
    blocked.reserve(std::size_t(TRIANGLES) * GRID);
    for (std::uint32_t id = 0; id < TRIANGLES; ++id) {
        const Vector a = grid_point(id % GRID, SIDE), b = grid_point(id / GRID % GRID, SIDE),
                     c = grid_point(id / GRID / GRID, SIDE);
        for (std::uint32_t p = 0; p < GRID; ++p)
            blocked.push_back(is_blocked(a, b, c, grid_point(p, SIDE), {towards_light, false}));
    }
    return blocked;
}

/// The answers of each way by which whole runs decide a light.
class Ways {
public:
    std::vector<float> by_run(const Cells& cells, bool prepare) {
        const auto triangles = gnomon::Triangles::upload(device_, cells.vertices);
        const auto points = gnomon::Points::upload(device_, cells.points);
        gnomon::Visibility visibility(device_, points.count());
        if (prepare) technique_->prepare(triangles, cells.light);
        technique_->run(triangles, points, cells.light, visibility);
        technique_->release_prepared_light();
        return visibility.read();
    }
    std::vector<float> by_table(const Cells& cells, const std::string& method) {
        const auto triangles = gnomon::Triangles::upload(device_, cells.vertices);
        const auto points = gnomon::Points::upload(device_, cells.points);
        technique_->set("many-lights", method);
        const auto lit =
            run_light_table_to_host(*technique_, triangles, points, gnomon::Lights({cells.light}, {}), {.bits = true});
        return {lit.bits.begin(), lit.bits.end()};
    }

private:
    gnomon::Device device_;
    std::unique_ptr<gnomon::Technique> technique_ = gnomon::make_technique("frustum-traced", device_);
};

void expect_equal(const std::vector<float>& lit, const std::vector<bool>& blocked, const std::string& way,
                  Vector towards_light) {
    ASSERT_EQ(lit.size(), blocked.size());
    std::size_t wrong = 0, first = 0;
    for (std::size_t i = lit.size(); i-- > 0;)
        if (lit[i] != (blocked[i] ? 0.0f : 1.0f)) ++wrong, first = i;
    EXPECT_EQ(wrong, 0u) << way << ", light at " << towards_light[0] << " " << towards_light[1] << " "
                         << towards_light[2] << "; first: triangle " << first / GRID << ", point " << first % GRID;
}

/// Those of small_directions() that are no double of another.
std::vector<Vector> primitive_directions() {
    std::vector<Vector> directions = small_directions();
    std::erase_if(directions, [](Vector v) { return v[0] % 2 == 0 && v[1] % 2 == 0 && v[2] % 2 == 0; });
    return directions;
}

void expect_all_equal(const ExactMap& map, const std::vector<std::string>& methods) {
    Ways ways;
    for (const Vector towards_light : primitive_directions()) {
        const Cells cells(towards_light, map);
        const std::vector<bool> blocked = blocked_in_cells(towards_light);
        expect_equal(ways.by_run(cells, false), blocked, "lists", towards_light);
        expect_equal(ways.by_run(cells, true), blocked, "prepared", towards_light);
        for (const std::string& method : methods)
            expect_equal(ways.by_table(cells, method), blocked, method, towards_light);
    }
}

TEST(SmallCells, EqualIntegers) { expect_all_equal(SAME, {}); }
TEST(SmallCells, ExhaustiveEqualIntegersUnderAnAffineMap) {
    expect_all_equal(ROUNDED, {"rays", "beams", "point-beams"});
}

}  // namespace
