// SPDX-License-Identifier: MIT
// Statistics of several runs, or of a stage that runs several times, as those of one.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

/// Adds the times of a run's stages to those of several runs: one entry for each name, in the order of their first
/// appearance. A stage counts as skipped if it was in all of them.
void add_stages(Statistics& total, const Statistics& run);

/// The same within one run: one entry per stage, however often it ran.
void merge_stages(Statistics& statistics);

}  // namespace gnomon
