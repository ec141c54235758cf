// SPDX-License-Identifier: MIT
// What of an area light reaches each pixel: the sums of its definition, in the host's doubles, to the last bit.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shading/received_light.hpp"
#include "shading/surface.hpp"
#include "support/floor_view.hpp"

namespace {

using namespace gnomon;

struct Sums {
    double reaching = 0, facing = 0, towards = 0;
};

Sums sums_of(const ViewOnHost& seen, std::size_t pixel, const glm::dvec3& area, const Lights& lights,
             std::span<const std::uint32_t> row) {
    Sums sums;
    const glm::dvec3 normal = loaded(&seen.normal[3 * pixel]);
    for (std::size_t i = 0; i < lights.count(); ++i) {
        const glm::dvec3 l = loaded(lights.lights()[i].xyzw.data()) - loaded(&seen.position[3 * pixel]);
        const double square = dot(l, l);
        if (square == 0) continue;
        const double f = std::max(0.0, -dot(area, l)) / (square * std::sqrt(square));
        const double fc = f * std::max(0.0, dot(normal, l)) / std::sqrt(square);
        sums.towards += f;
        sums.facing += fc;
        if ((row[i / 32] >> (i % 32) & 1u) != 0) sums.reaching += fc;
    }
    return sums;
}

void expect_sums(const DeviceOptions& options) {
    const Device device({}, options);
    const Triangles triangles = Triangles::upload(device, support::over_a_floor(support::one_triangle));
    const View view = look(device, triangles, Camera::look_at({0, 2, 4}, {0, 0.5f, 0}, {0, 1, 0}, 90), 37, 22);
    const ViewOnHost seen = view.read(device, triangles);
    const Float3 a{1.5f, 0.25f, 0}, b{0, 0, 1};  // a x b points down
    const glm::dvec3 area = cross(loaded(a), loaded(b));
    const Lights lights = area_light({-0.5f, 3, -0.5f}, a, b, 40);
    const std::size_t pixels = view.points.count(), words = 2;
    std::vector<std::uint32_t> rows(pixels * words);
    std::mt19937 random(4);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i / words % 7 == 0 ? 0 : std::uint32_t(random());
    cl::Buffer bits;
    session_of(device).upload(bits, rows);
    const ReceivedLight light = received_light(device, triangles, view, area, lights, bits.get());
    const auto share = light.share.read(), irradiance = light.irradiance.read(), brightness = light.brightness.read();
    std::size_t partly = 0, dark = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (seen.receiver[i] == no_receiver) {
            EXPECT_EQ(share[i], 1);
            EXPECT_TRUE(irradiance[i] == 0 && brightness[i] == 0);
            continue;
        }
        const Sums sums = sums_of(seen, i, area, lights, std::span(rows).subspan(words * i, words));
        const double wanted = sums.facing == 0 ? 0 : sums.reaching / sums.facing;
        ASSERT_EQ(share[i], float(wanted)) << i;
        ASSERT_EQ(irradiance[i], float(sums.facing == 0 ? 0 : sums.reaching / 40)) << i;
        ASSERT_EQ(brightness[i], float(sums.facing == 0 ? 0 : wanted * sums.towards / 40)) << i;
        partly += wanted > 0 && wanted < 1;
        dark += wanted == 0;
    }
    EXPECT_GT(partly, 10u);
    EXPECT_GT(dark, 10u);
}

TEST(ReceivedLight, IsTheSumsOfItsDefinition) {
    expect_sums({});
    expect_sums({.gpu_kernels = true});
    expect_sums({.hide_fp64 = true});
}

TEST(ReceivedLight, SumsOfTheSkyAreRoundedOnce) {
    for (const bool hide_fp64 : {false, true}) {
        const Device device({}, {.hide_fp64 = hide_fp64});
        cl::Session& session = session_of(device);
        const std::vector<double> sums{0, 1, 0.1, 1 + std::exp2(-24), 1 + std::exp2(-24) + std::exp2(-50), 0.7251239};
        cl::Buffer from, to(session, sums.size() * sizeof(float));
        session.upload(from, sums);
        round_sums(session, from.get(), sums.size(), to);
        const auto rounded = session.read_values<float>(to.get(), sums.size());
        for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_EQ(rounded[i], float(sums[i])) << i;
    }
}

}  // namespace
