// SPDX-License-Identifier: MIT
// The same benchmark with several numbers of threads, and how much each part and stage gains from more of them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace gnomon::bench {

/// A part or a stage of a row, and its times.
struct ThreadTimes {
    std::string row, part;
    std::vector<double> ms;  ///< for each number of threads
};

/// What took time in all reports (texts of --json, one for each number of threads), in the first one's order.
std::vector<ThreadTimes> thread_times(std::span<const std::string> reports);

/// Runs this program's command line once for each number of threads, as a process of its own, since PoCL reads the
/// number when it starts; then prints the table. With --json FILE the reports are FILE.THREADS. Returns the exit code.
int run_with_each(std::span<const unsigned> threads, std::span<char* const> command_line);

}  // namespace gnomon::bench
