// SPDX-License-Identifier: MIT
// Lines of sight over grids of heights: the sweep and all kinds of kernels give the answers of lines that are followed
// one by one, and these are right where they are known. (tests/python/test_viewshed.py compares with rational numbers.)
#include "sight/height_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <random>

#include "support/device.hpp"

namespace {

using namespace support;
using Heights = std::vector<std::int32_t>;

// Rough hills that fall away from their middle, with holes.
Heights hills(int rows, int columns, unsigned seed) {
    std::mt19937 random(seed);
    Heights heights;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const int dx = x - columns / 2, dy = y - rows / 2;
            const int height = 2 * (dx * dx + dy * dy) + int(random() % 900);
            heights.push_back(random() % 97 == 0 ? NO_HEIGHT : height);
        }
    return heights;
}

std::vector<std::int32_t> whole_rows(int rows, int columns) {
    std::vector<std::int32_t> spans;
    for (int y = 0; y < rows; ++y) spans.insert(spans.end(), {0, columns});
    return spans;
}

constexpr int rows = 120, columns = 170;
constexpr gnomon::HeightGrid::Band all_rows{0, rows};

TEST(HeightGrid, SameAnswersWithEveryKernel) {
    const Heights heights = hills(rows, columns, 1);
    const auto spans = whole_rows(rows, columns);
    const gnomon::Eye eyes[] = {{85 * SUBCELLS, 60 * SUBCELLS, 2500, 0},
                                {85 * SUBCELLS + 100, 59 * SUBCELLS + 31, 1500, 200},
                                {3 * SUBCELLS + 1, 2 * SUBCELLS, 30000, 0},
                                {169 * SUBCELLS, 119 * SUBCELLS, 22100, 100},
                                {30 * SUBCELLS + 77, 71 * SUBCELLS + 77, 7000, 0}};
    gnomon::HeightGrid first(device_with(), heights, columns);
    for (const gnomon::Eye& eye : eyes) {
        const auto expected = first.look(eye, all_rows, spans, false);
        const auto seen = std::ranges::count(expected, std::uint8_t(SIGHT_SEEN));
        EXPECT_GT(seen, rows * columns / 100);
        EXPECT_LT(seen, rows * columns * 9 / 10);
        EXPECT_EQ(first.look(eye, all_rows, spans), expected);
        for (const bool gpu_kernels : {false, true})
            for (const bool sweeps : {false, true})
                EXPECT_EQ(
                    gnomon::HeightGrid(device_of(gpu_kernels), heights, columns).look(eye, all_rows, spans, sweeps),
                    expected);
        EXPECT_EQ(gnomon::HeightGrid(device_with(3), heights, columns).look(eye, all_rows, spans), expected);
    }
}

// What no wedge meets would stay hidden: from above a plane all targets are seen, whatever the eye, band and spans.
TEST(HeightGrid, EveryTargetLiesInAWedge) {
    std::mt19937 random(4);
    const auto below = [&](int end) { return int(random() % unsigned(end)); };
    for (const auto& [height, width] : {std::pair(2, 2), {3, 90}, {23, 31}, {61, 17}}) {
        const Heights plane(std::size_t(height) * std::size_t(width), 5);
        for (const bool gpu_kernels : {false, true}) {
            gnomon::HeightGrid grid(device_of(gpu_kernels), plane, width);
            for (int i = 0; i < 60; ++i) {
                gnomon::Eye eye{below((width - 1) * SUBCELLS + 1), below((height - 1) * SUBCELLS + 1), 6000, 0};
                if (i % 3 == 0) eye.x = below(width) * SUBCELLS;
                if (i % 4 == 0) eye.y = below(height) * SUBCELLS;
                const int first = below(height);
                const gnomon::HeightGrid::Band band{first, first + 1 + below(height - first)};
                std::vector<std::int32_t> spans;
                std::vector<std::uint8_t> expected;
                for (int y = band.first_row; y < band.last_row; ++y) {
                    const int from = below(width), to = from + below(width - from + 1);
                    spans.insert(spans.end(), {from, to});
                    for (int x = 0; x < width; ++x) expected.push_back(x >= from && x < to ? SIGHT_SEEN : SIGHT_HIDDEN);
                }
                ASSERT_EQ(grid.look(eye, band, spans), expected) << width << ' ' << eye.x << ' ' << eye.y;
            }
        }
    }
}

// A wall across a plane: columns behind it are seen from a height above the ground that grows with the distance.
TEST(HeightGrid, LeastHeightsBehindAWall) {
    Heights heights(32 * 40, 0);
    for (int y = 0; y < 32; ++y) heights[y * 40 + 10] = 1000;
    gnomon::HeightGrid grid(device_with(), heights, 40);
    const auto least = grid.least_heights({5 * SUBCELLS, 16 * SUBCELLS, 500, 0}, {0, 32}, whole_rows(32, 40));
    for (int x = 0; x < 40; ++x) {
        // From 500 at column 5 over 1,000 at column 10, and strictly above: 500 + 100 (x - 5) + 1.
        const int expected = x <= 10 ? 0 : 1 + 100 * x;
        EXPECT_EQ(least[16 * 40 + x], expected) << x;
    }
    const std::size_t behind = 16 * 40 + 20;
    for (const int raised : {2000, 2001}) {  // a line that touches the wall's edge is blocked
        const unsigned expected = raised == 2000 ? SIGHT_HIDDEN : SIGHT_SEEN;
        EXPECT_EQ(grid.look({5 * SUBCELLS, 16 * SUBCELLS, 500, raised}, {0, 32}, whole_rows(32, 40))[behind], expected);
    }
    heights[16 * 40 + 6] = MAX_GRID_HEIGHT - 1;
    gnomon::HeightGrid steep(device_with(), heights, 40);
    const auto none = steep.least_heights({6 * SUBCELLS - 1, 16 * SUBCELLS, -1000, 0}, {0, 32}, whole_rows(32, 40));
    EXPECT_EQ(none[16 * 40 + 39], INT_MAX) << "no height up to 2^31 serves";
}

TEST(HeightGrid, SpansLimitTheTargets) {
    const Heights heights = hills(rows, columns, 2);
    gnomon::HeightGrid grid(device_with(), heights, columns);
    const gnomon::Eye eye{85 * SUBCELLS, 60 * SUBCELLS, 4000, 0};
    const auto all = grid.look(eye, all_rows, whole_rows(rows, columns));
    std::vector<std::int32_t> spans;
    for (int y = 0; y < rows; ++y)
        spans.insert(spans.end(), {y < 40 || y > 90 ? 0 : 60 + y % 3, y < 40 || y > 90 ? 0 : 99});
    const auto some = grid.look(eye, all_rows, spans);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const std::size_t at = std::size_t(y) * columns + std::size_t(x);
            const bool is_target = x >= spans[2 * std::size_t(y)] && x < spans[2 * std::size_t(y) + 1];
            ASSERT_EQ(some[at], is_target ? all[at] : SIGHT_HIDDEN) << x << ' ' << y;
        }
}

// Any division into bands gives the rows of the whole; a band is all that the spans are of.
TEST(HeightGrid, BandsAreTheRowsOfTheWhole) {
    const Heights heights = hills(rows, columns, 3);
    for (const bool gpu_kernels : {false, true}) {
        gnomon::HeightGrid grid(device_of(gpu_kernels), heights, columns);
        for (const gnomon::Eye& eye : {gnomon::Eye{85 * SUBCELLS, 60 * SUBCELLS + 7, 4000, 0},
                                       gnomon::Eye{2 * SUBCELLS + 200, 119 * SUBCELLS, 30000, 50}}) {
            const auto whole = grid.look(eye, all_rows, whole_rows(rows, columns));
            const auto heights_of_whole = grid.least_heights(eye, all_rows, whole_rows(rows, columns));
            for (const int each : {1, 7, 32, 61}) {
                std::vector<std::uint8_t> joined;
                std::vector<std::uint32_t> counts;
                std::vector<std::int32_t> least;
                for (int first = 0; first < rows; first += each) {
                    const gnomon::HeightGrid::Band band{first, std::min(first + each, rows)};
                    const auto spans = whole_rows(band.last_row - first, columns);
                    std::ranges::copy(grid.look(eye, band, spans), std::back_inserter(joined));
                    std::ranges::copy(grid.least_heights(eye, band, spans), std::back_inserter(least));
                    std::ranges::copy(grid.look_from({&eye, 1}, band, spans, true).words, std::back_inserter(counts));
                }
                EXPECT_EQ(joined, whole) << each;
                EXPECT_EQ(least, heights_of_whole) << each;
                for (std::size_t i = 0; i < counts.size(); ++i) ASSERT_EQ(counts[i], whole[i] == SIGHT_SEEN) << i;
            }
        }
    }
}

// The only thing above a plane is one vertex: it hides what lies behind it on the line from the eye, whichever patches
// that line passes.
TEST(HeightGrid, OneVertexHidesWhatLiesBehindIt) {
    constexpr int eye_x = 80, eye_y = 48;  // diagonals from here pass through corners of patches
    const gnomon::Eye eye{eye_x * SUBCELLS, eye_y * SUBCELLS, 1000, 0};
    const auto spans = whole_rows(rows, columns);
    const gnomon::Device device = device_with();
    std::mt19937 random(6);
    for (int i = 0; i < 48; ++i) {
        const int x = 1 + int(random() % 20), y = i % 3 == 0 ? x : int(random() % 20);
        const int step_x = i % 2 == 0 ? x : -x, step_y = i % 4 < 2 ? y : -y;
        const auto cell = [&](int k) { return std::size_t((eye_y + k * step_y) * columns + eye_x + k * step_x); };
        Heights heights(std::size_t(rows) * columns, 0);
        heights[cell(1)] = 2'000'000;
        gnomon::HeightGrid grid(device, heights, columns);
        for (const bool sweeps : {false, true}) {
            const auto seen = grid.look(eye, all_rows, spans, sweeps);
            EXPECT_EQ(seen[cell(1)], SIGHT_SEEN) << step_x << ' ' << step_y;
            EXPECT_EQ(seen[cell(2)], SIGHT_HIDDEN) << step_x << ' ' << step_y;
        }
    }
}

// Each eye begins with hidden answers, whatever was asked of the grid before it: counts and words are sums of single
// looks, and an odd number of cells is filled to its end.
TEST(HeightGrid, EyesAddUp) {
    constexpr int height = 67, width = 81;
    const Heights heights = hills(height, width, 5);
    const gnomon::HeightGrid::Band band{3, height};
    const auto spans = whole_rows(height - 3, width);
    std::vector<gnomon::Eye> eyes;
    std::vector<std::int32_t> all_spans;
    for (int i = 0; i < 40; ++i) {
        const int x = (i * 29 % (width - 1)) * SUBCELLS + (i % 3) * 50, y = (i * 17 % (height - 1)) * SUBCELLS;
        eyes.push_back({x, y, 9000 + 100 * i, i % 2 * 300});
        all_spans.insert(all_spans.end(), spans.begin(), spans.end());
    }
    for (const bool gpu_kernels : {false, true}) {
        gnomon::HeightGrid grid(device_of(gpu_kernels), heights, width);
        const auto cells = std::size_t(height - 3) * width;
        std::vector<std::uint32_t> counts(cells), words(2 * cells);
        for (std::size_t i = 0; i < eyes.size(); ++i) {
            const auto seen = gnomon::HeightGrid(device_with(), heights, width).look(eyes[i], band, spans, false);
            for (std::size_t cell = 0; cell < cells; ++cell) {
                counts[cell] += seen[cell];
                words[i / 32 * cells + cell] |= std::uint32_t(seen[cell]) << i % 32;
            }
        }
        const auto found = grid.look_from(eyes, band, all_spans, true);
        EXPECT_EQ(found.counts, counts);
        EXPECT_EQ(found.words, words);
        EXPECT_EQ(grid.look(eyes[1], band, spans), grid.look(eyes[1], band, spans, false));
        EXPECT_EQ(grid.look_from(eyes, band, all_spans, false).counts, counts);
    }
}

TEST(HeightGrid, RefusesWhatIsOutOfRange) {
    const gnomon::Device device = device_with();
    const Heights flat(16, 0);
    EXPECT_THROW(gnomon::HeightGrid(device, flat, 1), gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::HeightGrid(device, flat, 5), gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::HeightGrid(device, Heights(16, MAX_GRID_HEIGHT), 4), gnomon::InvalidArgument);
    gnomon::HeightGrid grid(device, flat, 4);
    const auto spans = whole_rows(4, 4);
    EXPECT_THROW(grid.look({-1, 0, 5, 0}, {0, 4}, spans), gnomon::InvalidArgument);
    EXPECT_THROW(grid.look({0, 3 * SUBCELLS + 1, 5, 0}, {0, 4}, spans), gnomon::InvalidArgument);
    EXPECT_THROW(grid.look({0, 0, 5, -1}, {0, 4}, spans), gnomon::InvalidArgument);
    EXPECT_THROW(grid.look({0, 0, 5, 0}, {0, 4}, whole_rows(3, 4)), gnomon::InvalidArgument);
    EXPECT_THROW(grid.look({0, 0, 5, 0}, {2, 5}, whole_rows(3, 4)), gnomon::InvalidArgument);
    EXPECT_THROW(grid.look({0, 0, 5, 0}, {2, 2}, {}), gnomon::InvalidArgument);
}

}  // namespace
