// SPDX-License-Identifier: MIT
// Runs one case: its questions one after the other, until enough points were asked.
#pragma once

#include "cases.hpp"
#include "judge.hpp"

namespace stress {

struct RunOptions {
    std::uint64_t seed = 1;
    double points = 1e6;       ///< of a case with share 1
    bool all_variants = true;  ///< false: one variant of each case, for a quick look
};

struct CaseResult {
    std::string name, idea;
    Tally tally;
};

/// Every light with every kind of points for each variant.
CaseResult run_case(const Case& a_case, const gnomon::Device& device, Judge& judge, const RunOptions& options);

}  // namespace stress
