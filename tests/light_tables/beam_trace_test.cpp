// SPDX-License-Identifier: MIT
// Stage beam_trace, by the beams of blocks: what a launch makes of each pair is what the oracle says, the queue holds
// the rest, and beam_exact decides the queue.
#include "support/beam_stages.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

TEST(BeamTrace, EqualsReferenceForDirectionalLights) { expect_cases_hold(device_of(false), BeamMethod::blocks, false); }
TEST(BeamTrace, EqualsReferenceForPointLights) { expect_cases_hold(device_of(false), BeamMethod::blocks, true); }
TEST(BeamTrace, EqualsReferenceByKernelsForGpus) {
    for (const bool are_positions : {false, true})
        expect_cases_hold(device_of(true), BeamMethod::blocks, are_positions);
}

TEST(BeamTrace, Grows) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true})
            expect_queue_grows(device_of(gpu_kernels), BeamMethod::blocks, are_positions);
}

}  // namespace
