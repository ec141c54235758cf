// SPDX-License-Identifier: MIT
// Stage sort: keys in order, each value with its key, and equal keys as they came; whatever the size of work-groups.
#include "lists/sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "reference/scenes_for_tests.hpp"
#include "support/device.hpp"

namespace {

using namespace support;
using Words = std::vector<std::uint32_t>;

struct Sorted {
    Words keys, values;
    bool operator==(const Sorted&) const = default;
};

/// By the standard library: each value is the index that its key had before.
Sorted reference_sort(const Words& keys) {
    Sorted sorted{keys, Words(keys.size())};
    std::iota(sorted.values.begin(), sorted.values.end(), 0u);
    std::ranges::stable_sort(sorted.values, {}, [&](std::uint32_t index) { return keys[index]; });
    std::ranges::sort(sorted.keys);
    return sorted;
}

Sorted sort(const gnomon::Device& device, gnomon::Sort& stage, const Words& keys) {
    gnomon::cl::Session& session = session_of(device);
    Words indices(keys.size());
    std::iota(indices.begin(), indices.end(), 0u);
    gnomon::cl::Buffer sorted_keys = uploaded(session, keys), values = uploaded(session, indices);
    stage.run(session, static_cast<std::uint32_t>(keys.size()), sorted_keys, values);
    return {downloaded<std::uint32_t>(session, sorted_keys.get(), keys.size()),
            downloaded<std::uint32_t>(session, values.get(), keys.size())};
}

/// Keys that differ in all bytes, or only in those that `mask` leaves.
Words random_keys(std::size_t count, std::uint32_t mask, std::uint64_t seed) {
    reference::Random random(seed);
    Words keys(count);
    for (std::uint32_t& key : keys) key = (random.below(1u << 16) << 16 | random.below(1u << 16)) & mask;
    return keys;
}

/// Sizes around the chunks (4096 keys on a CPU, 1024 on a GPU).
constexpr std::size_t SIZES[] = {1, 2, 63, 130, 1023, 1024, 1025, 4095, 4096, 4097, 100000};

// Not vacuous: under the narrow masks most keys have equals, hundreds of them in other chunks.
TEST(Sort, EqualsReference) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        gnomon::Sort stage;
        for (const std::size_t size : SIZES)
            for (const std::uint32_t mask : {0xFFFFFFFFu, 0x000000FFu, 0x80000100u, 0u}) {
                SCOPED_TRACE(std::to_string(size) + " keys under the mask " + std::to_string(mask));
                const Words keys = random_keys(size, mask, size + mask);
                EXPECT_TRUE(sort(device, stage, keys) == reference_sort(keys));
            }
    }
}

TEST(Sort, ShapeFree) {
    const Words keys = random_keys(30000, 0xF00F00FFu, 5);
    const Sorted wanted = reference_sort(keys);
    const auto expect_sorted = [&](std::uint32_t group, bool gpu_kernels) {
        SCOPED_TRACE("work-groups of " + std::to_string(group) + (gpu_kernels ? ", a GPU's kernels" : ""));
        gnomon::DeviceOptions options;
        options.work_group_size = group;
        options.gpu_kernels = gpu_kernels;
        gnomon::Sort stage;
        EXPECT_TRUE(sort(gnomon::Device({}, options), stage, keys) == wanted);
    };
    for (const std::uint32_t group : WORK_GROUP_SIZES) expect_sorted(group, false);
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) expect_sorted(group, true);
}

TEST(Sort, NothingInNothingOut) {
    const gnomon::Device device = device_with();
    gnomon::Sort stage;
    EXPECT_TRUE(sort(device, stage, {}) == Sorted{});
}

}  // namespace
