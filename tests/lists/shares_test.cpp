// SPDX-License-Identifier: MIT
// Launches whose items share out work as they go (GN_SHARES in prelude.h): each index belongs to one item, launch after
// launch.
#include <gtest/gtest.h>

#include <vector>

#include "cl/session.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

// `last`: how many items were the last to end, and how much the first of them saw of what all items counted.
constexpr const char* kernel = R"(
#include "prelude.h"
__kernel void take_all(uint count, __global uint* times, __global uint* sum, __global uint* last GN_SHARES) {
    uint mine = 0u;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(count)) {
        atomic_inc(&times[i]);
        ++mine;
    }
    atomic_add(sum, mine);
#ifdef GN_CPU
    if (GN_END_SHARES && atomic_inc(&last[0]) == 0u) last[1] = *sum;
#endif
}
)";

class Shares : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Shares, EachIndexIsTakenOnceByEachLaunch) {
    const gnomon::Device device = device_with(GetParam());
    gnomon::cl::Session& session = session_of(device);
    session.add_source("shares_test.cl", kernel);
    std::uint32_t in_order = 0;
    for (const std::uint32_t count : {0u, 1u, 2u, 63u, 64u, 65u, 1000u, 100003u, 5u, 0u, 777u}) {
        SCOPED_TRACE(std::to_string(count) + " indices, launch " + std::to_string(in_order++));
        const gnomon::cl::Buffer times = uploaded(session, std::vector<std::uint32_t>(count + 1, 0));
        const gnomon::cl::Buffer sum = uploaded(session, std::vector<std::uint32_t>{0});
        const gnomon::cl::Buffer last = uploaded(session, std::vector<std::uint32_t>{0, 0});
        session.launch("shares_test.cl", "take_all", gnomon::cl::Range::shares(count), count, times, sum, last);
        std::vector<std::uint32_t> wanted(count, 1);
        wanted.push_back(0);
        EXPECT_EQ(downloaded<std::uint32_t>(session, times.get(), count + 1), wanted);
        if (session.is_cpu()) {
            EXPECT_EQ(downloaded<std::uint32_t>(session, last.get(), 2), (std::vector<std::uint32_t>{1, count}));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Groups, Shares, testing::Values(0u, 1u, 3u, 64u));

}  // namespace
