// SPDX-License-Identifier: MIT
// Stage scan: exclusive prefix sums, saturating.
#include "lists/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "reference/scenes_for_tests.hpp"
#include "support/device.hpp"

namespace {

using namespace support;
using Words = std::vector<std::uint32_t>;

/// The definition, in integers that cannot overflow here.
Words reference_scan(const Words& counts) {
    Words offsets;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i <= counts.size(); ++i) {
        offsets.push_back(
            static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, std::numeric_limits<std::uint32_t>::max())));
        if (i < counts.size()) sum += counts[i];
    }
    return offsets;
}

/// Scans on the device, with canaries behind the offsets.
Words scan(const gnomon::Device& device, const Words& counts) {
    gnomon::cl::Session& session = session_of(device);
    const gnomon::cl::Buffer input = uploaded(session, counts);
    gnomon::cl::Buffer offsets(session, (counts.size() + 9) * sizeof(std::uint32_t));
    put_canaries(session, offsets);
    gnomon::Scan stage;
    stage.run(session, static_cast<std::uint32_t>(counts.size()), input, offsets);
    expect_canaries(session, offsets, (counts.size() + 1) * sizeof(std::uint32_t), "offsets");
    EXPECT_EQ(downloaded<std::uint32_t>(session, input.get(), counts.size()), counts) << "the input was written";
    return downloaded<std::uint32_t>(session, offsets.get(), counts.size() + 1);
}

Words random_counts(std::size_t count, std::uint32_t below, std::uint64_t seed) {
    reference::Random random(seed);
    Words counts(count);
    for (std::uint32_t& c : counts) c = random.below(below);
    return counts;
}

/// Sizes around the chunks of 256 or 2048 counts that work-groups take, and of many chunks.
constexpr std::size_t SIZES[] = {0,    1,    2,    255,   256,   257,   511,   1000,  4096,
                                 2047, 2048, 2049, 32767, 32768, 32769, 65537, 100000};

// Not vacuous: hundreds of chunks in the larger sizes, and sums that every element changes.
TEST(Scan, EqualsReference) {
    const gnomon::Device device = device_with();
    for (const std::size_t size : SIZES) {
        SCOPED_TRACE(std::to_string(size) + " counts");
        const Words counts = random_counts(size, 40, size + 1);
        EXPECT_EQ(scan(device, counts), reference_scan(counts));
    }
}

// Not vacuous: 100000 counts are 391 chunks, more than the items of any of these groups.
TEST(Scan, ShapeFree) {
    for (const std::uint32_t group : WORK_GROUP_SIZES) {
        const gnomon::Device device = device_with(group);
        for (const std::size_t size : {std::size_t(0), std::size_t(1), std::size_t(257), std::size_t(100000)}) {
            SCOPED_TRACE(std::to_string(size) + " counts, work-groups of " + std::to_string(group));
            const Words counts = random_counts(size, 1000, size + 7);
            EXPECT_EQ(scan(device, counts), reference_scan(counts));
        }
    }
}

// A total beyond 32 bits must be seen as one: wrapped around it would look like a list that fits.
// Not vacuous: without saturation every one of these totals is small.
TEST(Scan, SurvivesOverflow) {
    const std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
    // Within a chunk, from chunk to chunk of one work-item, and from one work-item to the next.
    for (const std::uint32_t group : {1u, 3u, 64u}) {
        SCOPED_TRACE("work-groups of " + std::to_string(group));
        const gnomon::Device device = device_with(group);
        for (const Words& counts : {Words{most, 1, 5}, Words{most, most}, Words(70000, 1u << 16), Words{0, most, 0}}) {
            const Words offsets = scan(device, counts);
            EXPECT_EQ(offsets, reference_scan(counts));
            EXPECT_EQ(offsets.back(), most);
        }
        Words late = random_counts(5000, 3, 9);
        late[4000] = most - 100;
        EXPECT_EQ(scan(device, late), reference_scan(late));
    }
}

}  // namespace
