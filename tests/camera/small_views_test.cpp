// SPDX-License-Identifier: MIT
// Every small case of the camera: all triangles with coordinates 0, 1 and 2, at three depths before, through and behind
// an eye, under all rays that lead through a grid of 4 x 4. So every degenerate pattern of signs is there, not a sample
// of them. A shear along the depth moves a triangle to pixels of its own; triangles that straddle the eye's plane reach
// the others' pixels, too, where the nearest is seen. Small integers are the judge.
//
// On such numbers all determinants are exact in float. So the views are looked at again under an affine map, which
// changes no answer and makes the products round.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <gnomon.hpp>
#include "support/small_cases.hpp"

namespace {

using namespace support;

constexpr std::uint32_t SIDE = 3, GRID = 27, TRIANGLES = GRID * GRID * GRID, BLOCK = 4;
constexpr std::uint32_t WIDTH = 64, HEIGHT = 32, BLOCKS_IN_A_ROW = WIDTH / BLOCK;
constexpr std::uint32_t TRIANGLES_OF_VIEW = WIDTH * HEIGHT / (BLOCK * BLOCK);
/// A pixel is 1 / 64 wide at distance 1, exactly: the tangent of half the field of view is 1/4 in doubles.
const double FOV = 2 * std::atan(0.25);
constexpr double PIXEL = 2 * 0.25 / HEIGHT;

/// Whole numbers for which a pixel is 2 wide at depth 1, the eye at 0: pixel x, y has the ray (2 x + 1 - WIDTH, HEIGHT
/// - 1 - 2 y, 1).
Vector ray_of(std::uint32_t x, std::uint32_t y) {
    return {2 * int(x) + 1 - int(WIDTH), int(HEIGHT) - 1 - 2 * int(y), 1};
}

/// A point of the grid, moved so that the rays i, j, 1 with i, j from -1 to 2 are those of the block's pixels.
Vector in_block(Vector at, std::uint32_t block, int first_depth) {
    const int column = int(block % BLOCKS_IN_A_ROW), row = int(block / BLOCKS_IN_A_ROW), z = at[2] + first_depth;
    return {2 * at[0] + (8 * column + 3 - int(WIDTH)) * z, 2 * at[1] + (int(HEIGHT) - 5 - 8 * row) * z, z};
}

std::int64_t det(Vector u, Vector v, Vector w) {
    return std::int64_t(u[0]) * (v[1] * w[2] - v[2] * w[1]) + std::int64_t(u[1]) * (v[2] * w[0] - v[0] * w[2]) +
           std::int64_t(u[2]) * (v[0] * w[1] - v[1] * w[0]);
}

struct SmallTriangle {
    Vector a, b, c;
};

/// Where a ray from 0 meets a triangle, in lengths of its direction: over / under, both positive.
struct Hit {
    std::int64_t over, under;
};

/// The contract (docs/numerics.md, 9): closed triangles, never one whose plane holds the eye.
std::optional<Hit> hit(const SmallTriangle& t, Vector ray) {
    const std::int64_t volume = det(t.a, t.b, t.c), sign = (volume > 0) - (volume < 0);
    const std::int64_t of_c = sign * det(t.a, t.b, ray), of_a = sign * det(t.b, t.c, ray),
                       of_b = sign * det(t.c, t.a, ray);
    if (sign == 0 || of_a < 0 || of_b < 0 || of_c < 0) return std::nullopt;
    return Hit{sign * volume, of_a + of_b + of_c};
}

struct Tally {
    std::size_t hits = 0, through_edges = 0, ties = 0, wrong = 0;
};

/// The triangle that a pixel shows: the nearest, and of equally near ones the first.
std::uint32_t seen_by(const std::vector<SmallTriangle>& triangles, Vector ray, Tally& tally) {
    std::uint32_t nearest = gnomon::no_receiver;
    Hit best{1, 0};
    for (std::uint32_t id = 0; id < triangles.size(); ++id) {
        const SmallTriangle& t = triangles[id];
        const auto found = hit(t, ray);
        if (!found) continue;
        ++tally.hits;
        tally.through_edges += det(t.a, t.b, ray) == 0 || det(t.b, t.c, ray) == 0 || det(t.c, t.a, ray) == 0;
        const std::int64_t mine = found->over * best.under, its = best.over * found->under;
        tally.ties += nearest != gnomon::no_receiver && mine == its;
        if (nearest == gnomon::no_receiver || mine < its) nearest = id, best = *found;
    }
    return nearest;
}

/// Of two hits nearer to each other than 2^-28 of their depth either may win.
bool may_show(const std::vector<SmallTriangle>& triangles, Vector ray, std::uint32_t seen, std::uint32_t nearest) {
    if (seen >= triangles.size() || nearest >= triangles.size()) return false;
    const auto found = hit(triangles[seen], ray), best = hit(triangles[nearest], ray);
    return found && found->over * best->under - best->over * found->under <= best->over * found->under >> 28;
}

/// A map of space with the camera that its axes make.
struct Setup {
    ExactMap map;
    gnomon::Camera camera;
    bool rounds;

    /// `scale`: a power of two that makes the axes about 1 long.
    Setup(const ExactMap& with, double scale, bool products_round) : map(with), rounds(products_round) {
        const auto axis = [&](std::size_t column, double length) {
            std::array<double, 3> of{};
            for (std::size_t i = 0; i < 3; ++i) of[i] = map.matrix[i][column] * length * scale;
            return of;
        };
        camera.eye = map.apply({0, 0, 0}, false);
        camera.right = axis(0, 2 / PIXEL);
        camera.up = axis(1, 2 / PIXEL);
        camera.forward = axis(2, 1);
        camera.fov_y_radians = FOV;
    }
};

/// Depths are of the size of the picture.
const Setup SAME({{{{1, 0, 0}, {0, 1, 0}, {0, 0, 128}}}, {}, 1.0f}, 0x1p-7, false);
/// Coordinates of up to 23 bits.
const Setup ROUNDED({{{{20011, 3643, 480017}, {-3251, 19997, -520021}, {4801, -5227, 2400011}}},
                     {100003, -77773, 55579},
                     0x1p-9f},
                    0x1p-21, true);

class SmallViews : public testing::TestWithParam<const Setup*> {
protected:
    void look_at(std::uint32_t first, int first_depth) {
        std::vector<SmallTriangle> triangles;
        std::vector<float> vertices;
        for (std::uint32_t block = 0; block < TRIANGLES_OF_VIEW && first + block < TRIANGLES; ++block) {
            const std::uint32_t id = first + block;
            const auto corner = [&](std::uint32_t of_grid) {
                const Vector at = in_block(grid_point(of_grid, SIDE), block, first_depth);
                for (const float x : GetParam()->map.apply(at, false)) vertices.push_back(x);
                return at;
            };
            const Vector a = corner(id % GRID), b = corner(id / GRID % GRID), c = corner(id / GRID / GRID);
            triangles.push_back({a, b, c});
        }
        const auto uploaded = gnomon::Triangles::upload(device_, vertices);
        const auto seen = pass_.look(uploaded, GetParam()->camera, WIDTH, HEIGHT).points.read(device_).receiver;
        for (std::uint32_t pixel = 0; pixel < WIDTH * HEIGHT; ++pixel) {
            const Vector ray = ray_of(pixel % WIDTH, pixel / WIDTH);
            const std::uint32_t right = seen_by(triangles, ray, tally_);
            if (seen[pixel] == right || (GetParam()->rounds && may_show(triangles, ray, seen[pixel], right))) continue;
            if (++tally_.wrong <= 3)
                ADD_FAILURE() << "depths from " << first_depth << ", triangles from " << first << ", pixel "
                              << pixel % WIDTH << ", " << pixel / WIDTH << " shows " << seen[pixel] << ", must show "
                              << right;
        }
    }

    gnomon::Device device_;
    gnomon::CameraPass pass_{device_};
    Tally tally_;
};

TEST_P(SmallViews, EqualIntegers) {
    for (const int first_depth : {1, 0, -1})
        for (std::uint32_t first = 0; first < TRIANGLES; first += TRIANGLES_OF_VIEW) look_at(first, first_depth);
    EXPECT_EQ(tally_.wrong, 0u);
    std::cout << 3 * TRIANGLES << " triangles, " << tally_.hits << " hits, " << tally_.through_edges
              << " of them on edges, " << tally_.ties << " as near as one before\n";
    EXPECT_GT(tally_.through_edges, 100000u);
    EXPECT_GT(tally_.ties, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Maps, SmallViews, testing::Values(&SAME, &ROUNDED),
                         [](const auto& of) { return std::string(of.param == &SAME ? "Exact" : "Rounded"); });

}  // namespace
