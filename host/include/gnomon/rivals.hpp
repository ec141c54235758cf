// SPDX-License-Identifier: MIT
// Experimental: the classic techniques, to be measured beside the exact one (docs/techniques.md).
#pragma once

#pragma GCC visibility push(default)

namespace gnomon {

/// Adds the classic techniques to those that techniques() lists and make_technique() makes. They are a library of their
/// own: link gnomon::rivals or gnomon::full. Any thread may call it, and more than once.
void add_rivals();

}  // namespace gnomon

#pragma GCC visibility pop
