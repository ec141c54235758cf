// SPDX-License-Identifier: MIT
// Implicit rasters against the same triangles written out by the test, every bit: borders, holes, both diagonals, cells
// that are not square, large coordinates, and lights along rows, columns and diagonals.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bvh/wide_bvh.hpp"
#include "horizons/raster.hpp"
#include "query/raster_triangles.hpp"
#include "support/device.hpp"
#include "support/light_scene.hpp"

namespace {

using namespace support;

constexpr float nan_height = std::numeric_limits<float>::quiet_NaN();

struct Ground {
    std::string name;
    Floats x, y, heights;
    bool joins_first_corner = false;

    gnomon::Raster raster() const { return {x, y, heights, joins_first_corner}; }
    Float3 vertex(std::size_t row, std::size_t column) const {
        return {x[column], y[row], heights[row * x.size() + column]};
    }
    /// As gnomon/inputs.hpp describes them.
    Floats triangles() const {
        Floats made;
        const bool is_north_up = (x[0] < x[1]) != (y[0] < y[1]);
        const auto add_up = [&](const Float3& a, const Float3& b, const Float3& c) {
            is_north_up ? add(made, a, b, c) : add(made, a, c, b);
        };
        for (std::size_t r = 0; r + 1 < y.size(); ++r)
            for (std::size_t c = 0; c + 1 < x.size(); ++c) {
                const Float3 first = vertex(r, c), right = vertex(r, c + 1), below = vertex(r + 1, c),
                             last = vertex(r + 1, c + 1);
                add_up(below, last, joins_first_corner ? first : right);
                joins_first_corner ? add_up(last, right, first) : add_up(below, right, first);
            }
        return made;
    }
};

/// Places that rise or fall, with gaps that differ by a fifth if `is_uneven` (no sweeps then).
Floats places(std::size_t count, float first, float spacing, bool is_uneven = false) {
    Floats made;
    for (std::size_t i = 0; i < count; ++i)
        made.push_back(first + spacing * (float(i) + (is_uneven && i % 2 == 1 ? 0.2f : 0.0f)));
    return made;
}

/// Hills with steps and flat parts; heights are multiples of a quarter, so that rays graze edges.
Ground ground(const std::string& name, Floats x, Floats y, std::uint64_t seed, float base = 0) {
    Ground made{name, std::move(x), std::move(y), {}, seed % 2 == 0};
    Random random(seed);
    for (std::size_t r = 0; r < made.y.size(); ++r)
        for (std::size_t c = 0; c < made.x.size(); ++c)
            made.heights.push_back(base + (c / 4 % 3 == 0 ? 0.0f : float(random.below(13)) / 4) +
                                   (r / 5 % 4 == 2 ? 3.0f : 0.0f));
    return made;
}

Ground with_holes(Ground of) {
    of.name += " with holes";
    Random random(11);
    for (std::size_t i = 0; i < of.heights.size(); ++i) {
        const std::size_t row = i / of.x.size(), column = i % of.x.size();
        const bool is_lake = row > 3 && row < 9 && column > 5 && column < 12;
        if (is_lake || random.below(60) == 0)
            of.heights[i] = i % 2 == 0 ? nan_height : std::numeric_limits<float>::infinity();
    }
    return of;
}

std::vector<Ground> grounds() {
    return {
        ground("two by two", places(2, 0, 1), places(2, 1, -1), 1),
        ground("one row of squares", places(23, -4, 1), places(2, 3, 1), 2),
        ground("north up", places(38, -20, 1), places(31, 15, -1), 3),
        ground("both rise", places(29, 3, 0.5f), places(33, -7, 1.25f), 4),
        ground("both fall", places(26, 9, -1), places(35, 9, -1), 5),
        ground("x falls", places(42, 9, -2), places(18, -9, 1), 6),
        with_holes(ground("north up", places(33, 0, 1), places(29, 28, -1), 7)),
        with_holes(ground("both rise", places(30, 0, 1), places(30, 0, 1), 8)),
        with_holes(ground("uneven", places(25, 0, 1, true), places(31, 0, 2, true), 9)),
        ground("far away", places(27, 400000, 0.5f), places(33, -300016, 1), 10, 100),
    };
}

struct Asked {
    Floats points;
    std::vector<std::uint32_t> receivers;
    std::optional<Float3> eye{};
};

/// All vertices, without receivers.
Asked vertices_of(const Ground& of) {
    Asked asked;
    for (std::size_t r = 0; r < of.y.size(); ++r)
        for (std::size_t c = 0; c < of.x.size(); ++c) add(asked.points, of.vertex(r, c));
    return asked;
}

/// Corners and middles of triangles with these as receivers, seen from above, and points in the air without one.
Asked points_on(const Ground& of, const Floats& triangles) {
    Asked asked;
    asked.eye = Float3{of.x[0], of.y[0], 50000};
    Random random(3);
    for (std::uint32_t t = 0; t < triangles.size() / 9; t += 3) {
        const Float3 a = vertex(triangles, 3 * t), b = vertex(triangles, 3 * t + 1), c = vertex(triangles, 3 * t + 2);
        add(asked.points, t % 2 == 0 ? a : Float3{(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, a[2] + 0.125f});
        asked.receivers.push_back(t % 5 == 0 ? gnomon::no_receiver : t);
    }
    return asked;
}

/// Directions along rows, columns and diagonals, and others, from grazing to steep; some from below.
gnomon::Lights suns(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    while (lights.size() < count) {
        Float3 d;
        for (float& c : d) c = lights.size() % 2 == 0 ? float(int(random.below(5)) - 2) : random.between(-1.0f, 1.0f);
        d[2] = -std::abs(d[2]) * (lights.size() % 3 == 0 ? 0.25f : 1.0f) + (lights.size() % 11 == 10 ? 0.5f : 0.0f);
        if (d != Float3{}) lights.push_back(gnomon::Light::directional(d));
    }
    return gnomon::Lights(lights);
}

gnomon::Lights lamps(const Ground& over, std::size_t count) {
    Random random(5);
    std::vector<gnomon::Light> lights;
    for (std::size_t i = 0; i < count; ++i)
        lights.push_back(gnomon::Light::point({over.x[random.below(over.x.size())] + float(random.below(3)) / 4,
                                               over.y[random.below(over.y.size())], 3 + float(random.below(20))}));
    return gnomon::Lights(lights);
}

std::vector<std::uint32_t> bits_of(const gnomon::Device& device, const gnomon::Triangles& triangles, const Asked& asked,
                                   const gnomon::Lights& lights, const std::string& method) {
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("many-lights", method);
    gnomon::RunOptions options;
    if (asked.eye) options.facing = gnomon::Facing::eye(*asked.eye);
    const auto points = gnomon::Points::upload(device, asked.points, asked.receivers);
    return gnomon::run_light_table_to_host(*technique, triangles, points, lights, {.bits = true}, options).bits;
}

TEST(ImplicitRasters, AreWrittenOutAsTheirDescriptionSays) {
    const gnomon::Device device = device_of(false);
    for (const Ground& of : grounds()) {
        SCOPED_TRACE(of.name);
        const Floats expected = of.triangles();
        const auto triangles = gnomon::Triangles::raster(device, of.raster());
        ASSERT_EQ(triangles.count(), expected.size() / 9);
        const auto written = downloaded<float>(gnomon::session_of(device), triangles.buffer(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i)
            ASSERT_TRUE(written[i] == expected[i] || (std::isnan(written[i]) && std::isnan(expected[i])))
                << "float " << i;
    }
}

/// Expects the bits of the triangles written out, whichever method decides.
void expect_same_bits(const gnomon::Device& device, const Ground& of, const Asked& asked, const gnomon::Lights& lights,
                      const std::vector<const char*>& methods) {
    const auto implicit = gnomon::Triangles::raster(device, of.raster());
    const auto expected =
        bits_of(device, gnomon::Triangles::upload(device, of.triangles()), asked, lights, "one-by-one");
    for (const char* method : methods)
        ASSERT_EQ(bits_of(device, implicit, asked, lights, method), expected)
            << of.name << ", " << method << ", " << lights.count() << " lights";
}

TEST(ImplicitRasters, HaveTheBitsOfTheirTriangles) {
    const gnomon::Device device = device_of(false);
    for (const Ground& of : grounds()) {
        expect_same_bits(device, of, vertices_of(of), suns(70, 2), {"rays", "auto"});
        expect_same_bits(device, of, points_on(of, of.triangles()), suns(3, 3), {"auto"});
    }
}

TEST(ImplicitRasters, HaveTheBitsOfTheirTrianglesByEachMethodExhaustive) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        for (const Ground& of : grounds())
            for (const Asked& asked : {vertices_of(of), points_on(of, of.triangles())}) {
                for (const gnomon::Lights& lights : {suns(70, 2), suns(3, 3), lamps(of, 9)})
                    expect_same_bits(device, of, asked, lights, {"rays", "beams", "point-beams", "auto"});
                if (!of.name.starts_with("uneven")) expect_same_bits(device, of, asked, suns(70, 2), {"sweeps"});
            }
    }
}

/// Where both are rasters, sweeps must have the same ground: else they would leave all to beams, unseen.
TEST(ImplicitRasters, AreTheRastersThatTheirTrianglesAre) {
    const gnomon::Device device = device_of(false);
    std::size_t compared = 0;
    for (const Ground& of : grounds()) {
        SCOPED_TRACE(of.name);
        const gnomon::BuiltRaster found(device, gnomon::Triangles::upload(device, of.triangles()));
        const gnomon::BuiltRaster taken(device, gnomon::Triangles::raster(device, of.raster()));
        if (!found.is_raster() || found.copies().has_holes != 0) continue;
        ++compared;
        ASSERT_TRUE(taken.is_raster());
        EXPECT_EQ(taken.is_rising(), found.is_rising());
        EXPECT_EQ(taken.highest(), found.highest());
        EXPECT_EQ(taken.unevenness(), found.unevenness());
        gnomon::cl::Session& session = gnomon::session_of(device);
        const auto expect_same = [&](const gnomon::cl::Buffer& a, const gnomon::cl::Buffer& b, std::size_t floats) {
            EXPECT_EQ(downloaded<float>(session, a.get(), floats), downloaded<float>(session, b.get(), floats));
        };
        expect_same(found.x(), taken.x(), of.x.size());
        expect_same(found.y(), taken.y(), of.y.size());
        expect_same(found.heights(), taken.heights(), of.heights.size());
    }
    EXPECT_GE(compared, 5u);
}

/// The nodes, as far as the walks' bits do not show them: no box is wider than its patch needs.
TEST(ImplicitRasters, HaveATreeOfTightBoxes) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        const Ground of = ground("", places(700, 0, 1), places(45, 0, -1), 21);
        const gnomon::WideBvh tree(device, gnomon::Triangles::raster(device, of.raster()));
        const std::uint32_t width = gnomon::bvh_width(gnomon::session_of(device)), rows_of_patch = width / 8;
        const std::size_t patches = std::size_t(700 - 1 + 3) / 4 * ((45 - 1 + rows_of_patch - 1) / rows_of_patch);
        EXPECT_EQ(tree.leaf_count(), patches);
        const auto nodes = downloaded<float>(gnomon::session_of(device), tree.nodes().get(),
                                             std::size_t(tree.levels().back()) * 7 * width);
        const auto [lowest, highest] = std::ranges::minmax(of.heights);
        const float expected[6] = {0, -44, lowest, 699, 0, highest};
        for (std::size_t row = 0; row < 6; ++row) {
            const auto begin = nodes.begin() + std::ptrdiff_t(row * width);
            EXPECT_EQ(row < 3 ? *std::min_element(begin, begin + width) : *std::max_element(begin, begin + width),
                      expected[row]);
        }
    }
}

TEST(ImplicitRasters, AreReadWithoutTheirTriangles) {
    const gnomon::Device device = device_of(false);
    const Ground of = ground("", places(1500, 0, 1), places(1000, 0, -1), 6);
    const auto triangles = gnomon::Triangles::raster(device, of.raster());
    Asked asked;
    for (std::size_t i = 0; i < 5000; ++i) add(asked.points, of.vertex(i % 999, i * 7 % 1499));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const auto points = gnomon::Points::upload(device, asked.points);
    const gnomon::Lights lights = suns(2, 9);
    const std::size_t words = asked.points.size() / 3;
    const gnomon::cl::Buffer bits(gnomon::session_of(device), words * sizeof(cl_uint));
    const auto run = technique->run_light_table(triangles, points, lights, {.bits = bits.get()});
    EXPECT_LT(run.device_memory_bytes, triangles.count() * 16) << "the triangles alone take 36 bytes each";
}

TEST(ImplicitRasters, SayWhatIsWrongWithTheirInputs) {
    const gnomon::Device device = device_of(false);
    const Floats two{0, 1}, four(4, 0.0f), same{0, 0}, back{0, 1, 0.5f}, six(6, 0.0f), one{0},
        infinite{0, std::numeric_limits<float>::infinity()};
    const auto refusal = [&](const gnomon::Raster& raster) -> std::string {
        try {
            gnomon::Triangles::raster(device, raster);
        } catch (const gnomon::InvalidArgument& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(refusal({two, two, four}), "none");
    EXPECT_NE(refusal({one, two, two}).find("at least two of each"), std::string::npos);
    EXPECT_NE(refusal({two, two, six}).find("6 heights"), std::string::npos);
    EXPECT_NE(refusal({same, two, four}).find("x[1]"), std::string::npos);
    EXPECT_NE(refusal({back, two, six}).find("x[2]"), std::string::npos);
    EXPECT_NE(refusal({two, infinite, four}).find("y[1]"), std::string::npos);
}

}  // namespace
