// SPDX-License-Identifier: MIT
// The stages of a technique that a library beside the core runs for itself (samples/classify_footprints.hpp does).
#pragma once

#include "prepared/prepared_runs.hpp"

namespace gnomon {

/// Objects of a technique, valid as long as the technique.
struct LentStages {
    FrustumTracer& tracer;
    PreparedRuns& prepared;
    std::shared_ptr<void>& kept;  ///< what the library keeps with the technique from run to run; null before the first
};

/// A technique that lends its stages. run_samples() uses them if a technique implements this interface.
class LendsStages {
public:
    virtual ~LendsStages() = default;
    virtual LentStages lent_stages() = 0;
};

}  // namespace gnomon
