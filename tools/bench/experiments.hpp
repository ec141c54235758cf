// SPDX-License-Identifier: MIT
// What is measured under each name of --experiment.
#pragma once

#include <string>
#include <vector>

#include "runner.hpp"

namespace gnomon::bench {

/// How much a machine can take.
struct Limits {
    std::uint64_t largest_triangles = 20'000'000;  ///< made scenes are made no larger
    std::uint64_t largest_points = 33'177'600;     ///< views have no more pixels
};

struct Experiment {
    std::string name, title;
    std::string idea;  ///< a sentence or two for the page
    std::vector<Block> (*blocks)(const SceneShelf&, const Limits&);
};

/// In the order of the page.
const std::vector<Experiment>& experiments();

}  // namespace gnomon::bench
