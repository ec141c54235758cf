// SPDX-License-Identifier: MIT
// `gnomon explain`: why one pixel, or one point, is lit or in shadow.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// Prints the explanation. Throws UsageError or Error, also where the technique's answer and the exact signs differ
/// (the explanation is printed before).
void explain(const ExplainOptions& options);

}  // namespace gnomon::app
