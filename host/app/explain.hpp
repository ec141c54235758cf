// SPDX-License-Identifier: MIT
// `gnomon explain`: why one pixel, or one point, is lit or in shadow.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// Prints the explanation. Throws UsageError or Error; if the technique's visibility and the exact signs differ, prints
/// the explanation and then throws Error.
void explain(const ExplainOptions& options);

}  // namespace gnomon::app
