// SPDX-License-Identifier: MIT
// Statistics of a run. Also sums the statistics of several runs, or of a stage that runs several times, to one.
#pragma once

#include "cl/session.hpp"

namespace gnomon {

/// A technique's run from its start on. Its Statistics come from finish() alone, so that none lacks memory and time.
class MeasuredRun {
public:
    /// `kept`: bytes of the buffers that the technique keeps from run to run; brought up to date when the run ends.
    MeasuredRun(cl::Session& session, std::uint64_t& kept) : memory_(session, kept) {}
    Statistics finish(decltype(Statistics::counts) counts);
    std::uint64_t peak_bytes() const { return memory_.peak_bytes(); }
    double wall_ms() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

    Statistics stages{};  ///< for StageTimer

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    cl::RunMemory memory_;
};

/// Adds the times of a run's stages to those of several runs: one entry for each name, in the order of their first
/// appearance. A stage counts as skipped if it was in all of them.
void add_stages(Statistics& total, const Statistics& run);

/// The same within one run: one entry per stage, however often it ran.
void merge_stages(Statistics& statistics);

}  // namespace gnomon
