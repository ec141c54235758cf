// SPDX-License-Identifier: MIT
// The rival on a CPU: Embree, when it was there at build time. Same scene, camera and light, same number of threads.
//
// One sample per pixel:
//   camera   coherent primary rays of the whole picture; a shading point per ray, pushed off its triangle along the
//            normal, and whether it faces the light. The number of pixels whose triangle is not gnomon's is counted.
//   shadow   a ray for each of gnomon's own points that face the light (the search for them costs the rival nothing),
//            from `offset` times the scene's diagonal along the ray on. So a wrong answer is the ray's alone.
//   shade    as gnomon shades.
// Several samples: gnomon's pattern; the camera's rays of 1024 samples, then the shadow rays of those that hit a
// triangle that faces the light, while they are in the cache. The two share the run's time as they share the threads'.
// A sample lies on the nearest triangle; gnomon's lies on its pixel's receiver if its ray meets it. So the means differ
// along silhouettes.
//
// How rays are handed over (packets of 8 or 16, streams of 256) is chosen for each tree and part by measuring. The
// mesh is indexed: its equal vertices are one, which the builder likes. Modes: `animated` builds the tree in each run,
// `static` has it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contestant.hpp"

namespace gnomon::bench {

struct PeerTask {
    const Place& place;
    const Seen& seen;
    std::uint32_t samples = 1;  ///< per pixel
    unsigned threads = 0;       ///< 0: all
    bool has_errors = false;    ///< also the settings that change errors, not only the best
};

struct Peer {
    std::unique_ptr<Contestant> contestant;
    bool takes_turns = false;  ///< one of the rival's best; the others show what its settings change
};

/// The version of the Embree that was built in; "not built in" without one.
std::string embree_version();

/// The best of each build quality; with errors, build quality x flags x offset. None without Embree.
std::vector<Peer> make_peers(const PeerTask& task);

}  // namespace gnomon::bench
