// SPDX-License-Identifier: MIT
// Pass backfacing: a point becomes dark unless the light is strictly on the side that the caller gives, by a normal or
// by the winding of its receiver. The judge is integer arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "receivers/backfacing.hpp"
#include "reference/exact.hpp"
#include "support/device.hpp"

namespace {

using namespace support;
using reference::Float3;
using reference::operator-;

constexpr float KEPT = 0.5f;  ///< no technique's answer, so a value that the pass must not touch is seen
constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();

void fill(const gnomon::Device& device, const gnomon::Visibility& visibility, float value) {
    const std::vector<float> values(visibility.count(), value);
    session_of(device).write(visibility.buffer(), values.data(), values.size() * sizeof(float));
}

/// The pass alone, as a run makes it after the technique.
void darken(const gnomon::Device& device, const gnomon::Triangles& triangles, const gnomon::Points& points,
            const gnomon::Facing& facing, const gnomon::Light& light, const gnomon::Visibility& visibility) {
    darken_backfacing(device, triangles, points, facing_inputs(device, triangles, points, facing), light, visibility);
}

/// n . D > 0 in integers, where D is the direction towards the light.
bool is_in_front(const Float3& n, const Float3& p, const gnomon::Light& light) {
    const Float3 l{light.xyzw[0], light.xyzw[1], light.xyzw[2]};
    const Float3 from = light.is_directional() ? Float3{} : p;
    const int exponent = reference::common_exponent({l, from});
    const int exponent_of_normal = reference::common_exponent({n});
    return reference::sign(reference::dot(reference::scaled(n, exponent_of_normal),
                                          reference::scaled(l, exponent) - reference::scaled(from, exponent))) > 0;
}

/// Points with normals that are random, exactly perpendicular to D, within an ulp of it, tiny, denormal and huge.
struct Cases {
    std::vector<float> points, normals;

    Cases(const gnomon::Light& light, std::size_t count) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> coordinate(-4, 4);
        constexpr float scales[] = {1, 0x1p-140f, 0x1p-126f, 0x1p-60f, 0x1p60f, 0x1p124f};
        for (std::size_t i = 0; i < count; ++i) {
            Float3 p{coordinate(random), coordinate(random), coordinate(random)};
            for (float& c : p) c = std::round(c * 64) / 64;
            const Float3 l{light.xyzw[0], light.xyzw[1], light.xyzw[2]};
            Float3 d = l;
            if (!light.is_directional())
                for (int c = 0; c < 3; ++c) d[c] = l[c] - p[c];
            // Perpendicular to D, exactly where the products of these short numbers do not round.
            Float3 n{d[1], -d[0], 0};
            if (i % 3 == 1) n[i % 2] = std::nextafter(n[i % 2], i % 2 == 0 ? -9.0f : 9.0f);
            if (i % 3 == 2) n = {coordinate(random), coordinate(random), coordinate(random)};
            for (const float c : n) normals.push_back(c * scales[(i / 3) % 6]);
            points.insert(points.end(), p.begin(), p.end());
        }
    }
    std::size_t count() const { return points.size() / 3; }
};

TEST(Backfacing, NormalsEqualTheIntegers) {
    const gnomon::Device device = device_with();
    for (const gnomon::Light& light :
         {gnomon::Light::directional({-0.5f, -1, 0.25f}), gnomon::Light::point({1.5f, 2.25f, -0.75f}),
          gnomon::Light::directional({0x1p-130f, 0x1.8p-140f, -0x1p-149f}),
          gnomon::Light::directional({0x1p100f, -0x1.2p99f, 0x1p20f})}) {
        Cases cases(light, 3000);
        cases.points[0] = NOT_A_NUMBER;   // absent: keeps its value
        cases.normals[3] = NOT_A_NUMBER;  // has no side: keeps its value
        const gnomon::Points points = gnomon::Points::upload(device, cases.points);
        const gnomon::Visibility visibility(device, cases.count() + 2);
        fill(device, visibility, KEPT);
        darken(device, {}, points, gnomon::Facing::normals(cases.normals), light, visibility);
        const std::vector<float> after = visibility.read();
        std::size_t front = 0, edge = 0;
        for (std::size_t i = 2; i < cases.count(); ++i) {
            const Float3 n{cases.normals[3 * i], cases.normals[3 * i + 1], cases.normals[3 * i + 2]};
            const Float3 p{cases.points[3 * i], cases.points[3 * i + 1], cases.points[3 * i + 2]};
            if (!std::isfinite(n[0]) || !std::isfinite(n[1]) || !std::isfinite(n[2])) {
                EXPECT_EQ(after[i], KEPT) << "a normal that overflowed has no side";
                continue;
            }
            const bool expected = is_in_front(n, p, light);
            ASSERT_EQ(after[i], expected ? KEPT : 0.0f)
                << "point " << i << " normal " << n[0] << ' ' << n[1] << ' ' << n[2] << ", light w " << light.xyzw[3];
            front += expected;
            edge += !expected && !is_in_front({-n[0], -n[1], -n[2]}, p, light);
        }
        EXPECT_EQ(after[0], KEPT);
        EXPECT_EQ(after[1], KEPT);
        EXPECT_EQ(after[cases.count()], KEPT) << "the pass wrote behind its points";
        EXPECT_GT(front, 500u);
        EXPECT_GT(edge, 200u) << "no normal is exactly perpendicular";
    }
}

TEST(Backfacing, StridesAndOffsetsOfACallersBuffer) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const std::vector<float> positions(6, 0.0f);
    // Structure of arrays, from float 1 on: normals (0, 1, 0) and (0, -1, 0).
    const gnomon::cl::Buffer normals = uploaded(session, std::vector<float>{9, 0, 0, 1, -1, 0, 0});
    const gnomon::Visibility visibility(device, 2);
    fill(device, visibility, 1);
    darken(device, {}, gnomon::Points::upload(device, positions), gnomon::Facing::normals(normals.get(), {1, 1, 2}),
           gnomon::Light::directional({0, -1, 0}), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 0}));
}

TEST(Backfacing, WindingEqualsTheIntegers) {
    const gnomon::Device device = device_with();
    // A triangle in y = 0 that faces up, the same turned over, one exactly edge-on to the light, one without a plane.
    const std::vector<float> vertices{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, NOT_A_NUMBER,
                                      0, 0};
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device, vertices);
    const std::vector<float> positions(18, 0.125f);
    const std::vector<std::uint32_t> receivers{0, 1, 2, 3, gnomon::no_receiver, 4};
    const gnomon::Points points = gnomon::Points::upload(device, positions, receivers);
    for (const gnomon::Light& light : {gnomon::Light::directional({0, -1, 0}), gnomon::Light::point({0, 1, 0})}) {
        const gnomon::Visibility visibility(device, 6);
        fill(device, visibility, KEPT);
        darken(device, triangles, points, gnomon::Facing::winding(), light, visibility);
        EXPECT_EQ(visibility.read(), (std::vector<float>{KEPT, 0, 0, KEPT, KEPT, KEPT}));
    }
}

TEST(Backfacing, RefusesWhatDoesNotFit) {
    const gnomon::Device device = device_with();
    const gnomon::Points points = gnomon::Points::upload(device, std::vector<float>(6));
    const gnomon::Light light = gnomon::Light::directional({0, -1, 0});
    const gnomon::Visibility visibility(device, 2), small(device, 1);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const std::vector<float> one(3), both(6);
    const auto run = [&](const gnomon::Facing& facing, const gnomon::Visibility& to) {
        technique->run(gnomon::Triangles::upload(device, {}), points, light, to, {.facing = facing});
    };
    run(gnomon::Facing::normals(both), visibility);
    EXPECT_THROW(run(gnomon::Facing::normals(one), visibility), gnomon::InvalidArgument);
    EXPECT_THROW(run(gnomon::Facing::normals(both), small), gnomon::InvalidArgument);
    EXPECT_THROW(run(gnomon::Facing::normals(both), gnomon::Visibility::wrap(device, points.positions(), 2)),
                 gnomon::InvalidArgument);
    const gnomon::Points normals = gnomon::Points::upload(device, both);
    run(gnomon::Facing::normals(normals.positions()), visibility);
    EXPECT_THROW(run(gnomon::Facing::normals(normals.positions(), {3, 3, 1}), visibility), gnomon::InvalidArgument);
    EXPECT_THROW(
        run(gnomon::Facing::normals(normals.positions()), gnomon::Visibility::wrap(device, normals.positions(), 2)),
        gnomon::InvalidArgument);
}

}  // namespace
