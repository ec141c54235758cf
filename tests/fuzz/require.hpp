// SPDX-License-Identifier: MIT
// What a fuzz target does when a promise is broken: say which, and abort, so that the input is kept.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace fuzz {

inline void require(bool kept, const char* promise) {
    if (kept) return;
    std::fprintf(stderr, "broken promise: %s\n", promise);
    std::abort();
}

}  // namespace fuzz
