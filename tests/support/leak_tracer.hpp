// SPDX-License-Identifier: MIT
// For tests that start programs of ours, which may have been built with the sanitizers.
#pragma once

#include <string_view>

namespace support {

/// Did LeakSanitizer's own tracer crash at a program's end, by what the program wrote to its standard error? It does so
/// once in some thousand programs (google/sanitizers issue 1353; seen with PoCL's threads), and nothing is known then
/// of the program's leaks, nor its exit code. So it has to be started once more.
inline bool leak_tracer_crashed(std::string_view errors) {
    return errors.find("LeakSanitizer has encountered a fatal error") != std::string_view::npos;
}

}  // namespace support
