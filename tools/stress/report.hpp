// SPDX-License-Identifier: MIT
// The suite's result as Markdown.
#pragma once

#include <string>
#include <vector>

#include "exact_path.hpp"
#include "run.hpp"

namespace stress {

struct Report {
    std::string command, device, driver;
    RunOptions options;
    std::vector<CaseResult> cases;
    std::vector<ExactPathRow> exact_path;
    double seconds = 0;

    Tally sum() const;
};

std::string markdown(const Report& report);

/// One line for the terminal.
std::string line_of(const CaseResult& result);

}  // namespace stress
