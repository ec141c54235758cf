// SPDX-License-Identifier: MIT
// What decided each point of an exact run: watched between the stages, only when asked (kernels/trace/provenance.h).
#pragma once

#include "kernels/trace/provenance.h"
#include "trace/trace.hpp"

namespace gnomon {

class Provenance {
public:
    /// Each is called after the stage of its name; second_look() before it.
    void facing(cl::Session& session, const PointInputs& points, cl_mem visibility);
    void trace(cl::Session& session, const LightFrame& light_frame, cl_uint frame, const PointInputs& points,
               const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility);
    void exact_trace(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points,
                     const Light& light, const Trace& trace, cl_mem visibility, const cl::Buffer& counters);
    void queue_overflow(cl::Session& session, const LightFrame& light_frame, cl_uint frame, const PointInputs& points,
                        cl_mem visibility);

    /// A PROVENANCE_... per point.
    std::vector<std::uint32_t> read(cl::Session& session, std::size_t count) const;

private:
    cl::Buffer provenance_;
};

/// RGBA, 4 bytes per point: a colour for each decision, light where it found the point lit and dark where in shadow.
std::vector<std::uint8_t> provenance_colors(std::span<const std::uint32_t> provenance,
                                            std::span<const float> visibility);

}  // namespace gnomon
