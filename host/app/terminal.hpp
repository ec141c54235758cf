// SPDX-License-Identifier: MIT
// The output for people. Results go to stdout; warnings, errors and progress to stderr. On a terminal progress is one
// line, which appears once the work has taken a second and is removed when the work ends. Elsewhere, as in a pipe, it
// is a line after 2, 4, 8 ... seconds.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "measure/grouped.hpp"

namespace gnomon::app {

/// "gnomon: warning: ..." and "gnomon: error: ..." on stderr.
void print_warning(std::string_view sentence);
void print_note(std::string_view sentence);
void print_error(std::string_view sentence);

/// Prints to stdout at once, and throws Error if it cannot (a full disk behind a redirection).
void print_result(std::string_view text);

/// A file of host/app/ that was built into the command: "help/main.txt".
std::string_view text_file(std::string_view name);

/// 1536000 as "1.5 MiB".
std::string bytes_for_people(std::uint64_t bytes);

/// Shows "gnomon: WORK ... 3 s" for the lifetime of the object.
class ProgressLine {
public:
    /// Does nothing at all if `shown` is false.
    ProgressLine(std::string work, bool shown);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

private:
    void show(std::stop_token stop);
    void tell(std::stop_token stop);
    bool is_stopped_within(std::stop_token stop, int seconds);

    std::string work_;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread thread_;  // last: the thread uses the other members
};

}  // namespace gnomon::app
