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
    // Where every technique runs, which takes many times as long as the exact one alone:
    std::uint64_t swept_triangles = 1'000'000, swept_points = 2'073'600;
    std::uint32_t swept_map = 8192;  ///< no settings with more texels per side
    bool all_views = true;           ///< else of the usual ones the first alone
};

/// All experiments in less than ten minutes on two cores.
constexpr Limits small_limits{1'000'000, 921'600, 200'000, 230'400, 1024, false};

struct Experiment {
    std::string name, title;
    std::string idea;  ///< a sentence or two for the report
    std::vector<Block> (*blocks)(const SceneShelf&, const Limits&);
};

/// In the order of the report.
const std::vector<Experiment>& experiments();

}  // namespace gnomon::bench
