// SPDX-License-Identifier: MIT
// Stage beam_intersect: the filter of a triangle and the shadow rays of a block to a bundle. What it calls certain, for
// a cone of lights at once or for one light, is so by the exact predicate; and it is certain of most pairs.
#include <gtest/gtest.h>

#include <bit>
#include <iostream>

#include "support/block_cases.hpp"
#include "support/kernel_file.hpp"

namespace {

using namespace support;

constexpr const char* KERNELS = "beams/beam_intersect_test.cl";

/// As in beam_intersect_test.cl.
struct Decisions {
    std::uint32_t all, blocked, missed, dark, undecided;
};

struct Tally {
    std::size_t pairs = 0, blocked = 0, undecided = 0, cones = 0, cones_decided = 0;
};

/// The lights of a cone, as bits.
std::uint32_t lights_of(std::uint32_t cone, std::size_t count) {
    std::vector<std::uint32_t> slots(count);
    for (std::uint32_t slot = 0; slot < count; ++slot) slots[slot] = slot;
    std::uint32_t lights = 0;
    for (const std::uint32_t slot : gnomon::lights_of_cone(slots, cone)) lights |= 1u << slot;
    return lights;
}

/// The lights that are blocked for a point and a triangle, as bits.
std::uint32_t blocked_lights(const BlockCase& one, std::size_t p, std::size_t k) {
    reference::Effort effort;
    std::uint32_t blocked = 0;
    for (std::size_t l = 0; l < one.lights.size(); ++l)
        if (reference::blocks(reference::Ray::to_light(one.points[p], one.lights[l]), one.triangles[k], effort))
            blocked |= 1u << l;
    return blocked;
}

void expect_true(const Decisions& decisions, std::uint32_t truth, std::uint32_t all, std::uint32_t of_cone,
                 Tally& tally) {
    EXPECT_EQ(decisions.blocked & ~truth, 0u) << "called blocked, lane by lane";
    EXPECT_EQ(decisions.missed & truth, 0u) << "called missed, lane by lane";
    EXPECT_EQ(decisions.dark & ~truth, 0u) << "called blocked, light by light";
    EXPECT_EQ(truth & ~decisions.dark & ~decisions.undecided, 0u) << "called missed, light by light";
    EXPECT_EQ((decisions.dark | decisions.undecided | decisions.blocked | decisions.missed) & ~all, 0u)
        << "a light that is none";
    if ((decisions.all & 1) != 0) {
        EXPECT_EQ(of_cone & ~truth, 0u) << "called blocked for a cone";
    }
    if ((decisions.all & 2) != 0) {
        EXPECT_EQ(of_cone & truth, 0u) << "called missed for a cone";
    }
    tally.pairs += std::size_t(std::popcount(all));
    tally.blocked += std::size_t(std::popcount(truth));
    tally.undecided +=
        std::size_t(std::popcount(all & ~(decisions.blocked | decisions.missed)) + std::popcount(decisions.undecided));
    ++tally.cones;
    tally.cones_decided += decisions.all != 0;
}

/// Of a bundle's cones: each time another one that has lights.
std::uint32_t some_cone(Random& random, std::size_t lights) {
    for (;;)
        if (const std::uint32_t cone = random.below(random.below(2) == 0 ? 1 : LIGHT_CONES);
            lights_of(cone, lights) != 0)
            return cone;
}

/// Cases, and of each point and triangle the lights that are blocked.
struct KnownCases {
    std::vector<BlockCase> cases;
    std::vector<std::uint32_t> truth;
};

KnownCases known_cases(std::size_t width, bool are_positions) {
    KnownCases known;
    const std::vector<BlockCase> all = block_cases(width, are_positions);
    for (std::size_t i = 0; i < all.size(); i += width / BVH_WIDTH_ON_CPU) known.cases.push_back(all[i]);
    for (const BlockCase& one : known.cases)
        for (std::size_t p = 0; p < width; ++p)
            for (std::size_t k = 0; k < width; ++k) known.truth.push_back(blocked_lights(one, p, k));
    return known;
}

std::vector<Decisions> decisions_of(gnomon::cl::Session& session, const std::vector<BlockCase>& cases,
                                    const std::vector<std::uint32_t>& cones, const char* kernel) {
    add_kernel_file(session, KERNELS);
    const std::size_t width = gnomon::bvh_width(session);
    const bool are_positions = cases[0].are_positions();
    Floats roundings, positions, leaves;
    std::vector<gnomon::LightBundle> bundles;
    for (const BlockCase& one : cases) {
        roundings.push_back(beam_rounding(one.largest(), are_positions));
        for (const Float3& p : one.points) add(positions, p);
        append_leaf(leaves, one.triangles);
        bundles.push_back(one.bundle);
    }
    gnomon::PointsLayout layout{};
    layout.point_stride = 3;
    layout.coordinate_stride = 1;
    layout.count = cl_uint(positions.size() / 3);
    const auto count = cl_uint(cases.size());
    const gnomon::cl::Buffer decisions(session, count * width * width * sizeof(Decisions));
    session.launch({KERNELS, kernel, {.point_lights = are_positions}}, gnomon::bvh_range(session, count * width), count,
                   layout, uploaded(session, roundings), uploaded(session, bundles), uploaded(session, cones),
                   uploaded(session, positions), uploaded(session, leaves), decisions,
                   gnomon::cl::LocalBytes{BEAM_LOCAL_WORDS * sizeof(cl_uint)});
    return downloaded<Decisions>(session, decisions.get(), count * width * width);
}

void expect_certain_is_true(gnomon::cl::Session& session, const KnownCases& known, const char* kernel) {
    SCOPED_TRACE(kernel);
    const std::size_t width = gnomon::bvh_width(session);
    Random random(9);
    std::vector<std::uint32_t> cones;
    for (const BlockCase& one : known.cases) cones.push_back(some_cone(random, one.lights.size()));
    const std::vector<Decisions> decisions = decisions_of(session, known.cases, cones, kernel);
    Tally tally;
    for (std::size_t i = 0; i < decisions.size(); ++i) {
        const std::size_t of = i / (width * width), lights = known.cases[of].lights.size();
        expect_true(decisions[i], known.truth[i], lights_of(0, lights), lights_of(cones[of], lights), tally);
        ASSERT_FALSE(testing::Test::HasFailure())
            << "case " << of << ", point " << i / width % width << ", triangle " << i % width;
    }
    std::cout << tally.pairs << " pairs, " << tally.blocked << " blocked, " << tally.undecided
              << " undecided by lanes or by lights; " << tally.cones_decided << " of " << tally.cones
              << " cones decided\n";
    EXPECT_GT(tally.blocked, tally.pairs / 20);
    EXPECT_LT(tally.undecided, tally.pairs / 2);
    EXPECT_GT(tally.cones_decided, tally.cones / 4);
}

void expect_law(bool are_positions) {
    for (const bool gpu_kernels : {false, true}) {
        SCOPED_TRACE(gpu_kernels ? "kernels for GPUs" : "");
        const gnomon::Device device = device_of(gpu_kernels);
        gnomon::cl::Session& session = session_of(device);
        const KnownCases known = known_cases(gnomon::bvh_width(session), are_positions);
        for (const char* kernel : {"filter_by_points", "filter_by_triangles"})
            expect_certain_is_true(session, known, kernel);
        if (testing::Test::HasFailure()) return;
    }
}

TEST(BeamFilter, WhatIsCertainIsTrueForDirectionalLights) { expect_law(false); }
TEST(BeamFilter, WhatIsCertainIsTrueForPointLights) { expect_law(true); }

}  // namespace
