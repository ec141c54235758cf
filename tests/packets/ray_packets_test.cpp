// SPDX-License-Identifier: MIT
// Packets, as beam_trace takes them alone: what a launch makes of each pair is what the oracle says, and the queue
// holds the rest. To directional lights the rays of a packet are parallel (parallel_packets.clh), to point lights they
// converge (converging_packets.clh).
#include "support/beam_stages.hpp"
#include "support/device.hpp"

namespace {

using namespace support;

TEST(ParallelPackets, EqualReference) { expect_cases_hold(device_with(), BeamMethod::packets, false); }
TEST(ParallelPackets, Grow) { expect_queue_grows(device_with(), BeamMethod::packets, false); }

TEST(ConvergingPackets, EqualReference) { expect_cases_hold(device_with(), BeamMethod::packets, true); }
TEST(ConvergingPackets, Grow) { expect_queue_grows(device_with(), BeamMethod::packets, true); }

}  // namespace
