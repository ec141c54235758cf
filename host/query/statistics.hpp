// SPDX-License-Identifier: MIT
// Statistics of a run. Also sums the statistics of several runs, or of a stage that runs several times, to one.
#pragma once

#include "cl/session.hpp"

namespace gnomon {

/// A run of an object that keeps buffers from run to run. Its Statistics come from finish() alone, so that none lacks
/// memory and time.
class MeasuredRun {
public:
    /// `kept`: bytes of the buffers kept from earlier runs; brought up to date when this one ends, also by an
    /// exception.
    MeasuredRun(cl::Session& session, std::uint64_t& kept)
        : session_(session), kept_(kept), before_(session.memory_bytes()) {
        session.begin_run();
    }
    ~MeasuredRun() { kept_ += session_.memory_bytes() - before_; }
    MeasuredRun(const MeasuredRun&) = delete;
    MeasuredRun& operator=(const MeasuredRun&) = delete;

    /// `stages` with these counts (none: its own).
    Statistics finish(decltype(Statistics::counts) counts = {});
    /// The most device memory so far, without the memory of other objects.
    std::uint64_t peak_bytes() const { return kept_ + session_.run_peak_bytes() - before_; }
    double wall_ms() const { return cl::ms_since(start_); }

    Statistics stages{};  ///< for StageTimer

private:
    cl::Session& session_;
    std::uint64_t& kept_;
    std::uint64_t before_;
    cl::Clock::time_point start_ = cl::Clock::now();
};

/// Adds the times of a run's stages to those of several runs: one entry for each name, in the order of their first
/// appearance. A stage counts as skipped if it was in all of them.
void add_stages(Statistics& total, const Statistics& run);

/// The same within one run: one entry per stage, however often it ran.
void merge_stages(Statistics& statistics);

}  // namespace gnomon
