// SPDX-License-Identifier: MIT
// Lookups that compare depths, on maps written by hand: each kernel is a mean of hard lookups that is computed here
// from its definition; penumbrae have the width that the formula says.
#include <gtest/gtest.h>

#include <cmath>

#include "kernels/rivals/shadow_map/lookup.h"
#include "support/map_scenes.hpp"

namespace {

using namespace support;
using gnomon::LookupPlan;

constexpr std::uint32_t size = 64;
/// The definition of lookup twelve's taps: radii of a Gaussian's equal shares, at golden angles.
double offset_of(int tap, int axis) {
    const double radius = std::sqrt(-2 * std::log(1 - (tap + 0.5) / 12)), angle = tap * 2.39996322972865332;
    return static_cast<float>(radius * (axis == 0 ? std::cos(angle) : std::sin(angle)));
}

struct Lookup {
    std::vector<float> depths;  ///< size x size, straight view: u = x, v = y, depth = z
    std::vector<float> points;

    std::vector<float> run(const LookupPlan& plan, std::uint32_t group = 0) const {
        const gnomon::Device device = device_with(group);
        gnomon::cl::Session& session = session_of(device);
        std::vector<ViewCase> cases{straight_view(size, size)};
        const gnomon::MapViews views = uploaded_views(session, cases);
        const gnomon::cl::Buffer keys = uploaded(session, depths), positions = uploaded(session, points);
        const std::size_t count = points.size() / 3;
        const gnomon::cl::Buffer visibility = uploaded(session, std::vector<float>(count, 1.0f));
        gnomon::PointsLayout layout{};
        layout.point_stride = 3;
        layout.coordinate_stride = 1;
        layout.count = static_cast<cl_uint>(count);
        session.launch("rivals/shadow_map/lookup.cl", "map_lookup", gnomon::cl::Range::items(count), plan, views.set,
                       layout, positions, positions, positions, views.views, views.tables, keys, keys, keys,
                       visibility);
        return downloaded<float>(session, visibility.get(), count);
    }
    double hard(int x, int y, double depth) const {
        const int column = std::clamp(x, 0, int(size) - 1), row = std::clamp(y, 0, int(size) - 1);
        return depths[std::size_t(row) * size + std::size_t(column)] >= depth ? 1 : 0;
    }
};

/// Every other texel in shadow by chance; points anywhere, borders included.
Lookup random_lookup() {
    Random random(3);
    Lookup lookup;
    for (std::uint32_t i = 0; i < size * size; ++i) lookup.depths.push_back(random.below(2) == 0 ? 0.25f : 0.75f);
    for (int i = 0; i < 500; ++i) add(lookup.points, {random.between(0, 1), random.between(0, 1), 0.5f});
    return lookup;
}

LookupPlan plan_of(std::uint32_t lookup, std::uint32_t taps) {
    LookupPlan plan{};
    plan.lookup = lookup;
    plan.taps = taps;
    plan.softness = 1.5f;
    return plan;
}

/// Mean over weighted taps, each a function of the point's place in texels.
template <typename Mean>
void expect_lookup(const Lookup& lookup, const LookupPlan& plan, double tolerance, const Mean& mean) {
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) {
        const std::vector<float> lit = lookup.run(plan, group);
        for (std::size_t i = 0; i < lit.size(); ++i)
            ASSERT_NEAR(lit[i], mean(double(lookup.points[3 * i]) * size, double(lookup.points[3 * i + 1]) * size),
                        tolerance)
                << "lookup " << plan.lookup << ", " << plan.taps << " taps, point " << i;
    }
}

int whole(double x) { return static_cast<int>(std::floor(x)); }

TEST(DepthLookup, PcfIsTheMeanOfHardLookups) {
    const Lookup lookup = random_lookup();
    for (const std::uint32_t taps : {1u, 2u, 3u, 5u, 8u})
        expect_lookup(lookup, plan_of(taps == 1 ? LOOKUP_HARD : LOOKUP_PCF, taps), 1e-6, [&](double x, double y) {
            double sum = 0;
            for (std::uint32_t j = 0; j < taps; ++j)
                for (std::uint32_t i = 0; i < taps; ++i)
                    sum += lookup.hard(whole(x + i - 0.5 * (taps - 1)), whole(y + j - 0.5 * (taps - 1)), 0.5);
            return sum / (taps * taps);
        });
}

/// Four texels around a place, by their distance: what a filtering sampler returns.
double bilinear(const Lookup& lookup, double x, double y) {
    const int column = whole(x - 0.5), row = whole(y - 0.5);
    const double fx = x - 0.5 - column, fy = y - 0.5 - row;
    return (1 - fy) * ((1 - fx) * lookup.hard(column, row, 0.5) + fx * lookup.hard(column + 1, row, 0.5)) +
           fy * ((1 - fx) * lookup.hard(column, row + 1, 0.5) + fx * lookup.hard(column + 1, row + 1, 0.5));
}

// Gruen's filter reads each texel once; what it must equal is the weighted mean of taps^2 bilinear lookups.
TEST(DepthLookup, SmoothFiltersAreMeansOfBilinearLookups) {
    const Lookup lookup = random_lookup();
    for (const std::uint32_t kind : {LOOKUP_BILINEAR, LOOKUP_GAUSSIAN})
        for (const std::uint32_t taps : {1u, 4u, 9u})
            expect_lookup(lookup, plan_of(kind, taps), 2e-5, [&](double x, double y) {
                double sum = 0, all = 0;
                for (std::uint32_t j = 0; j < taps; ++j)
                    for (std::uint32_t i = 0; i < taps; ++i) {
                        const double dx = i - 0.5 * (taps - 1), dy = j - 0.5 * (taps - 1), sigma = taps / 4.5;
                        const double weight =
                            kind == LOOKUP_GAUSSIAN ? std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)) : 1;
                        sum += weight * bilinear(lookup, x + dx, y + dy);
                        all += weight;
                    }
                return sum / all;
            });
}

TEST(DepthLookup, TwelveTapsAreAMeanOfTwelve) {
    const Lookup lookup = random_lookup();
    expect_lookup(lookup, plan_of(LOOKUP_TWELVE, 1), 1e-6, [&](double x, double y) {
        double sum = 0;
        for (std::size_t i = 0; i < 12; ++i)
            sum += lookup.hard(whole(x + 1.5 * offset_of(i, 0)), whole(y + 1.5 * offset_of(i, 1)), 0.5);
        return sum / 12;
    });
}

TEST(DepthLookup, BiasMovesTheComparisonAndPointsOutsideAreLit) {
    Lookup lookup;
    lookup.depths.assign(size * size, 0.5f);
    lookup.points = {0.5f, 0.5f, 0.509f, 0.5f, 0.5f, 0.511f, 1.5f, 0.5f, 0.9f, 0.5f, -0.1f, 0.9f};
    LookupPlan plan = plan_of(LOOKUP_HARD, 1);
    plan.store.receiver_bias = 0.01f;
    EXPECT_EQ(lookup.run(plan), (std::vector<float>{1, 0, 1, 1}));
}

// A half-plane at depth 0.2 over a floor at depth 0.7, under a sun whose disc has tangent 0.4 across: its edge throws a
// penumbra 0.4 (0.7 - 0.2) = 0.2 wide (Fernando 2005), that is 12.8 texels.
TEST(DepthLookup, PenumbraIsAsWideAsBlockerAndLightMakeIt) {
    Lookup lookup;
    for (std::uint32_t i = 0; i < size * size; ++i) lookup.depths.push_back(i % size < size / 2 ? 0.2f : 1.0f);
    for (int i = 0; i <= 100; ++i) add(lookup.points, {0.3f + 0.004f * float(i), 0.5f, 0.7f});
    LookupPlan plan = plan_of(LOOKUP_PCSS, 25);
    plan.light_size = 0.4f;
    const std::vector<float> lit = lookup.run(plan);
    for (int i = 0; i <= 100; ++i) {
        const double x = 0.3 + 0.004 * i;
        // A texel, and one of 25 taps.
        const double truth = std::clamp((x - 0.5) / 0.2 + 0.5, 0.0, 1.0), tolerance = (1.0 / 64) / 0.2 + 1.0 / 25;
        EXPECT_NEAR(lit[std::size_t(i)], truth, tolerance) << "x = " << x;
    }
    // Contact: no gap, no penumbra but the texel of the edge.
    for (std::size_t i = 0; i < 101; ++i) lookup.points[3 * i + 2] = 0.201f;
    const std::vector<float> contact = lookup.run(plan);
    for (std::size_t i = 0; i < 101; ++i)
        if (std::fabs(lookup.points[3 * i] - 0.5f) > 1.0f / size) {
            EXPECT_EQ(contact[i], lookup.points[3 * i] > 0.5f ? 1.0f : 0.0f);
        }
}

}  // namespace
