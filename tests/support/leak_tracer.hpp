// SPDX-License-Identifier: MIT
// For tests that start programs of ours, which may have been built with the sanitizers.
#pragma once

#include <string_view>

namespace support {

/// Whether LeakSanitizer's own tracer crashed at a program's end, judged by the program's standard error. The tracer
/// crashes in one of some thousand programs (google/sanitizers issue 1353; seen with PoCL's threads). The program's
/// leaks and its exit code are unknown then, so the test starts the program once more.
inline bool leak_tracer_crashed(std::string_view errors) {
    return errors.find("LeakSanitizer has encountered a fatal error") != std::string_view::npos;
}

}  // namespace support
