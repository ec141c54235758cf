// SPDX-License-Identifier: MIT
// In place of embree_peer.cpp where there is no Embree.
#include "peers.hpp"

namespace gnomon::bench {

std::string embree_version() { return "not built in"; }

void run_peers(const PeerTask&, const std::function<void(PeerResult&&)>&) {}

}  // namespace gnomon::bench
