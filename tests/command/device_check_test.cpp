// SPDX-License-Identifier: MIT
// The answers that `gnomon devices --check` knows: the hard scenes' are the oracle's, and both answers occur in each.
#include <gtest/gtest.h>

#include <algorithm>

#include "host/app/device_cases.hpp"
#include "reference/visibility.hpp"

namespace {

using gnomon::app::HardCase;

class DeviceCases : public testing::TestWithParam<HardCase> {};

TEST_P(DeviceCases, KnowTheOraclesAnswers) {
    const HardCase& hard = GetParam();
    std::uint64_t hash = gnomon::app::hash_start;
    std::size_t lit = 0, dark = 0;
    for (const gnomon::Light& light : hard.lights) {
        const auto shadowed = reference::shadowed(hard.triangles, hard.points, {}, light.xyzw);
        std::vector<float> visibility;
        for (const std::uint8_t one : shadowed) visibility.push_back(one != 0 ? 0.0f : 1.0f);
        hash = gnomon::app::hash_of(std::as_bytes(std::span(visibility)), hash);
        lit += std::size_t(std::ranges::count(visibility, 1.0f));
        dark += std::size_t(std::ranges::count(visibility, 0.0f));
    }
    EXPECT_EQ(hash, hard.answers) << std::hex << "the oracle's answers have the hash 0x" << hash;
    EXPECT_GT(lit, hard.points.size() / 300);
    EXPECT_GT(dark, hard.points.size() / 300);
}

INSTANTIATE_TEST_SUITE_P(Hard, DeviceCases, testing::ValuesIn(gnomon::app::hard_cases()), [](const auto& of) {
    std::string name = of.param.name;
    std::ranges::replace_if(
        name, [](char c) { return c == ' '; }, '_');
    return name;
});

}  // namespace
