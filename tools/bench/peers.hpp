// SPDX-License-Identifier: MIT
// The rival on a CPU: Embree, when it was there at build time. Same points, same light, same number of threads.
//
// Rays: one per point that exists and faces the light (facing is decided beforehand and costs the rival nothing), in
// blocks of 4 x 4 pixels, 16 rays at once, coherent. From the shading point as it is, starting `offset` times the
// scene's diagonal along the ray. Several samples per pixel follow each other, pixel by pixel, so that a packet is one
// or few pixels' rays; of these, the tree of medium quality alone, and a mask is their mean. Modes: `animated` is build
// and rays timed together, `static` the rays alone.
#pragma once

#include <functional>
#include <string>

#include <gnomon.hpp>
#include "row.hpp"
#include "timing.hpp"

namespace gnomon::bench {

struct PeerTask {
    std::span<const float> triangles;
    const ViewOnHost& host;
    Float3 eye;
    Light light;
    std::uint32_t width = 0, height = 0;
    std::uint32_t samples = 1;  ///< per pixel: as many pictures in `host`, one behind the other
    unsigned threads = 0;       ///< 0: all
    RunRule rule;
};

struct PeerResult {
    std::string name;  ///< "embree"
    Settings settings;
    std::string mode;
    Times total;
    std::optional<Times> build;
    std::uint64_t memory_bytes = 0;
    std::vector<float> mask;
};

/// The version of the Embree that was built in; "not built in" without one.
std::string embree_version();

/// Calls `take` with each result: build quality x flags x offset. None without Embree.
void run_peers(const PeerTask& task, const std::function<void(PeerResult&&)>& take);

}  // namespace gnomon::bench
