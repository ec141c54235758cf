// SPDX-License-Identifier: MIT
// Linked into the tests of stages: make_technique() knows the classic techniques before main() begins.
#include <gnomon.hpp>

namespace {
[[maybe_unused]] const bool rivals_are_added = (gnomon::add_rivals(), true);
}
