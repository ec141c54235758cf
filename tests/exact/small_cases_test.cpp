// SPDX-License-Identifier: MIT
// Every small case of the visibility contract: all triangles and points with coordinates 0, 1 and 2, all directional
// lights with coordinates from -2 to 2, and all point lights at coordinates 0, 1 and 2. So every degenerate pattern of
// signs is there, not a sample of them. The kernels' float filter and exact path answer; small integers know better.
//
// On such numbers all determinants are exact in float. So the cases are asked again under affine maps, which change no
// answer: the products round, in float and in double, and meet the filters' bounds.
//
// GNOMON_SMALL_CASES=4 in the environment makes it a grid of 4 x 4 x 4, 3.15 billion cases: seconds on a GPU.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include "query/inputs.hpp"
#include "reference/parallel.hpp"
#include "support/small_cases.hpp"

namespace {

using namespace support;

constexpr const char* KERNELS = "small_cases_test.cl";
const std::uint32_t SIDE = std::getenv("GNOMON_SMALL_CASES") ? std::atoi(std::getenv("GNOMON_SMALL_CASES")) : 3;
const std::uint32_t GRID = SIDE * SIDE * SIDE, TRIANGLES = GRID * GRID * GRID;

std::vector<SmallLight> all_lights() {
    std::vector<SmallLight> lights;
    for (const Vector direction : small_directions()) lights.push_back({direction, false});
    for (std::uint32_t i = 0; i < GRID; ++i) lights.push_back({grid_point(i, SIDE), true});
    return lights;
}

/// For each triangle and light the blocked points, one bit each.
std::vector<std::uint64_t> expected(const std::vector<SmallLight>& lights) {
    std::vector<std::uint64_t> masks(TRIANGLES * lights.size());
    reference::for_chunks(masks.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto id = static_cast<std::uint32_t>(i / lights.size());
            const Vector a = grid_point(id % GRID, SIDE), b = grid_point(id / GRID % GRID, SIDE),
                         c = grid_point(id / GRID / GRID, SIDE);
            for (std::uint32_t p = 0; p < GRID; ++p)
                if (is_blocked(a, b, c, grid_point(p, SIDE), lights[i % lights.size()]))
                    masks[i] |= std::uint64_t(1) << p;
        }
    });
    return masks;
}

/// Counts of the pairs that float, double and integers decided.
using Levels = std::array<std::uint32_t, 3>;

struct Answers {
    std::vector<std::uint64_t> masks;
    Levels levels{};
};

Answers answers_of(const ExactMap& map, const std::vector<SmallLight>& lights, bool hide_fp64) {
    gnomon::Device device({}, {.hide_fp64 = hide_fp64});
    gnomon::cl::Session& session = session_of(device);
    std::ifstream stream(GNOMON_TESTS "/exact/predicates/small_cases.cl");
    std::ostringstream text;
    text << stream.rdbuf();
    session.add_source(KERNELS, text.str());

    const auto upload = [&](const auto& values) {
        gnomon::cl::Buffer buffer(session, values.size() * sizeof(values[0]));
        session.write(buffer.get(), values.data(), values.size() * sizeof(values[0]));
        return buffer;
    };
    std::vector<float> grid, vertices, positions;
    for (std::uint32_t i = 0; i < GRID; ++i)
        for (const float x : map.apply(grid_point(i, SIDE), false)) grid.push_back(x);
    for (std::uint32_t i = 0; i < TRIANGLES; ++i)
        for (const std::uint32_t corner : {i % GRID, i / GRID % GRID, i / GRID / GRID})
            vertices.insert(vertices.end(), grid.begin() + 3 * corner, grid.begin() + 3 * corner + 3);
    for (const SmallLight& light : lights) {
        for (const float x : map.apply(light.at, !light.is_position)) positions.push_back(x);
        positions.push_back(light.is_position ? 1.0f : 0.0f);
    }
    Answers answers;
    answers.masks.resize(TRIANGLES * lights.size());
    const auto count = static_cast<cl_uint>(answers.masks.size()), light_count = static_cast<cl_uint>(lights.size());
    const gnomon::cl::Buffer on_grid = upload(grid), of_triangles = upload(vertices), of_lights = upload(positions),
                             masks(session, count * sizeof(cl_ulong)), levels = upload(Levels{});
    session.launch(KERNELS, "blocked_points", gnomon::cl::Range::items(count), light_count, GRID, count, on_grid,
                   of_triangles, of_lights, masks, levels);
    session.read(masks.get(), answers.masks.data(), count * sizeof(cl_ulong));
    session.read(levels.get(), answers.levels.data(), sizeof(Levels));
    return answers;
}

const ExactMap SAME;
/// Odd entries up to 2^20: coordinates of 23 bits, differences just below the 2^20 up to which the float level is used.
const ExactMap ROUNDED{{{{1048575, -786433, 524289}, {-699051, 917503, 1000003}, {838861, 1047553, -611669}}},
                       {999983, -655361, 786431},
                       0.125f};

/// FNV-1a over the masks.
std::uint64_t digest(const std::vector<std::uint64_t>& masks) {
    std::uint64_t value = 0xCBF29CE484222325u;
    for (const std::uint64_t mask : masks) value = (value ^ mask) * 0x100000001B3u;
    return value;
}

class SmallCases : public testing::Test {
protected:
    static void judge(const Answers& answers) {
        static const std::vector<std::uint64_t> right = expected(all_lights());
        std::size_t wrong = 0, first = 0, blocked = 0;
        for (std::size_t i = right.size(); i-- > 0;) {
            if (answers.masks[i] != right[i]) ++wrong, first = i;
            blocked += right[i] != 0;
        }
        const std::size_t lights = all_lights().size();
        EXPECT_EQ(wrong, 0u) << "first: triangle " << first / lights << ", light " << first % lights << ": points "
                             << std::hex << answers.masks[first] << ", must be " << right[first];
        EXPECT_GT(blocked, right.size() / 100);
        std::cout << right.size() * GRID << " cases, digest " << std::hex << digest(answers.masks) << std::dec
                  << "; float, double and integers decided " << answers.levels[0] << ", " << answers.levels[1]
                  << " and " << answers.levels[2] << " pairs\n";
    }
};

TEST_F(SmallCases, EqualIntegers) { judge(answers_of(SAME, all_lights(), false)); }

TEST_F(SmallCases, EqualIntegersUnderAnAffineMap) {
    const Answers answers = answers_of(ROUNDED, all_lights(), false);
    judge(answers);
    EXPECT_GT(answers.levels[0], 0u);
    EXPECT_GT(answers.levels[2], 0u);
}

}  // namespace
