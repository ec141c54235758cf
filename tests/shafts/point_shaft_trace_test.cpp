// SPDX-License-Identifier: MIT
// Stage point_shaft_trace: what a launch makes of each pair, by the shafts of single points, is what the oracle says,
// and the queue holds the rest.
#include "support/device.hpp"
#include "support/shaft_stages.hpp"

namespace {

using namespace support;

TEST(PointShaftTrace, EqualsReferenceForDirectionalLights) {
    expect_cases_hold(device_of(false), ShaftMethod::points, false);
}
TEST(PointShaftTrace, EqualsReferenceForPointLights) { expect_cases_hold(device_of(false), ShaftMethod::points, true); }
TEST(PointShaftTrace, EqualsReferenceByKernelsForGpus) {
    for (const bool are_positions : {false, true})
        expect_cases_hold(device_of(true), ShaftMethod::points, are_positions);
}

TEST(PointShaftTrace, Grows) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true})
            expect_queue_grows(device_of(gpu_kernels), ShaftMethod::points, are_positions);
}

}  // namespace
