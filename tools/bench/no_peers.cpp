// SPDX-License-Identifier: MIT
// In place of embree_peer.cpp where there is no Embree.
#include "peers.hpp"

namespace gnomon::bench {

std::string embree_version() { return "not built in"; }

std::vector<Peer> make_peers(const PeerTask&) { return {}; }

}  // namespace gnomon::bench
