// SPDX-License-Identifier: MIT
// What stands in for Embree in a build without it: it says so, and is never asked.
#include <stdexcept>

#include "embree.hpp"

namespace stress {

struct EmbreeScene::Handles {};

std::string embree_version() { return {}; }

EmbreeScene::EmbreeScene(std::span<const float>, EmbreeFlags) {
    throw std::logic_error("this build has no Embree: install libembree-dev and configure again");
}

EmbreeScene::~EmbreeScene() = default;

std::vector<std::uint8_t> EmbreeScene::shadowed(std::span<const float>, std::span<const std::uint32_t>,
                                                const support::Light&, double) const {
    return {};
}

}  // namespace stress
