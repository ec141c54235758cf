// SPDX-License-Identifier: MIT
// Stage point_beam_trace: what a launch makes of each pair, by the beams of single points, is what the oracle says,
// and the queue holds the rest.
#include "support/beam_stages.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

TEST(PointBeamTrace, EqualsReferenceForDirectionalLights) {
    expect_cases_hold(device_of(false), BeamMethod::points, false);
}
TEST(PointBeamTrace, EqualsReferenceForPointLights) { expect_cases_hold(device_of(false), BeamMethod::points, true); }
TEST(PointBeamTrace, EqualsReferenceByKernelsForGpus) {
    for (const bool are_positions : {false, true})
        expect_cases_hold(device_of(true), BeamMethod::points, are_positions);
}

TEST(PointBeamTrace, Grows) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true})
            expect_queue_grows(device_of(gpu_kernels), BeamMethod::points, are_positions);
}

}  // namespace
