// SPDX-License-Identifier: MIT
// Stage shaft_trace, by the shafts of blocks: what a launch makes of each pair is what the oracle says, the queue holds
// the rest, and shaft_exact decides the queue.
#include "support/device.hpp"
#include "support/shaft_stages.hpp"

namespace {

using namespace support;

TEST(ShaftTrace, EqualsReferenceForDirectionalLights) {
    expect_cases_hold(device_of(false), ShaftMethod::blocks, false);
}
TEST(ShaftTrace, EqualsReferenceForPointLights) { expect_cases_hold(device_of(false), ShaftMethod::blocks, true); }
TEST(ShaftTrace, EqualsReferenceByKernelsForGpus) {
    for (const bool are_positions : {false, true})
        expect_cases_hold(device_of(true), ShaftMethod::blocks, are_positions);
}

TEST(ShaftTrace, Grows) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true})
            expect_queue_grows(device_of(gpu_kernels), ShaftMethod::blocks, are_positions);
}

}  // namespace
