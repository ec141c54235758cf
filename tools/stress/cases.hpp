// SPDX-License-Identifier: MIT
// The cases of the stress suite: everything that is known to break shadows, each an endless row of questions that a
// seed makes the same on every machine.
#pragma once

#include "points.hpp"

namespace stress {

struct Case {
    std::string name;
    std::string idea;  ///< one line
    /// Made anew for each variant; the triangles of one variant serve all its questions.
    std::function<Subject(std::uint64_t variant)> make_subject;
    std::vector<MakePoints> make_points;
    double share = 1;            ///< of the points asked for: less where a point costs more
    std::uint64_t variants = 4;  ///< at least so many, where there are enough points to ask
    std::size_t largest_question = 1'000'000;
};

struct CaseOptions {
    std::uint64_t seed = 1;
    std::uint32_t slivers = 1'000'000;  ///< through one texel
    std::uint32_t longest_side = 4096;  ///< of the large square view, up to 16384
};

std::vector<Case> all_cases(const CaseOptions& options);
void add_cut_outs(std::vector<Case>& list, std::uint64_t seed);  ///< cut_out_cases.cpp

}  // namespace stress
