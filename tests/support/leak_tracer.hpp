// SPDX-License-Identifier: MIT
// For tests that start programs of ours, which may have been built with the sanitizers.
#pragma once

#include <string_view>

namespace support {

/// Whether LeakSanitizer's own tracer crashed at a program's end, judged by the program's standard error. The tracer
/// crashes in one of some thousand programs, and in most of those that end while PoCL's threads are still starting
/// (google/sanitizers issue 1353). The program's leaks and its exit code are unknown then, so the test starts the
/// program once more, without the leak check.
inline bool leak_tracer_crashed(std::string_view errors) {
    return errors.find("LeakSanitizer has encountered a fatal error") != std::string_view::npos;
}

/// The value of ASAN_OPTIONS that starts a program without the leak check.
inline constexpr const char* NO_LEAK_CHECK = "detect_leaks=0";

}  // namespace support
