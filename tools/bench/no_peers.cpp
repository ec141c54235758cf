// SPDX-License-Identifier: MIT
// In place of embree_peer.cpp where there is no Embree.
#include "many_lights.hpp"
#include "peers.hpp"

namespace gnomon::bench {

std::string embree_version() { return "not built in"; }

std::vector<Peer> make_peers(const PeerTask&) { return {}; }

std::vector<std::unique_ptr<LightsContestant>> make_light_peers(const LightsQuestion&, unsigned) { return {}; }

}  // namespace gnomon::bench
