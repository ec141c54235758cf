// SPDX-License-Identifier: MIT
// Why a point is lit or in shadow, in words: what gnomon explain prints and the page of gnomon view shows.
#pragma once

#include <string>
#include <vector>

#include "setup.hpp"

namespace gnomon::app {

struct Explained {
    Explanation explanation;
    std::string where;  ///< "pixel 310,42 of 960x540 (frames the whole scene)"
    ChosenLight light;
};

/// The pixel of the options.
std::string where_of(const ExplainOptions& options, const ChosenCamera& camera);

/// One sentence.
std::string reason(const Explanation& explanation);

/// The triangles that the shadow ray misses by so little that floats were not certain, where that mattered; least
/// missed first.
std::vector<TriangleSigns> near_misses_of(const Explained& explained);

/// What gnomon explain prints.
std::string text_of(const Explained& explained);

}  // namespace gnomon::app
