// SPDX-License-Identifier: MIT
// Provenance: what decided each point of an exact run, recorded between the stages (kernels/trace/provenance.h).
#pragma once

#include "kernels/trace/provenance.h"
#include "trace/trace.hpp"

namespace gnomon {

enum class Moment { after_facing, after_trace, after_exact_trace, before_queue_overflow };

class Provenance {
public:
    /// Called at each of these moments of each frame. After facing it reads only the points and their visibility.
    void record(cl::Session& session, Moment moment, const TraceInputs& inputs, const Trace& trace);

    /// A PROVENANCE_... per point.
    std::vector<std::uint32_t> read(cl::Session& session, std::size_t count) const;

private:
    cl::Buffer provenance_;
};

/// RGBA, 4 bytes per point: a colour for each provenance, light for lit points and dark for points in shadow.
std::vector<std::uint8_t> provenance_colors(std::span<const std::uint32_t> provenance,
                                            std::span<const float> visibility);

}  // namespace gnomon
