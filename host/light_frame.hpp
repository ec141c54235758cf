// SPDX-License-Identifier: MIT
// Stage light_frame: the projection fitted to the points that still need an answer (kernels/light_frame.h).
#pragma once

#include "../kernels/light_frame.h"
#include "inputs.hpp"

namespace gnomon {

/// Texels of a frame, and how they are grouped into bins.
struct FrameGrid {
    std::uint32_t size;      ///< texels per side
    std::uint32_t bin_log2;  ///< texels per bin side, as a power of two
    std::uint32_t bins() const { return (size + (1u << bin_log2) - 1) >> bin_log2; }
    std::uint32_t bin_count() const { return bins() * bins(); }
};

/// One frame for a directional light, six (the faces of a cube around it) for a positional one.
std::vector<LightFrame> light_frames(const Light& light, const FrameGrid& grid);

class LightFrameFit {
public:
    /// Fits projection() to the points of the frame whose visibility is still 1.
    void run(cl::Session& session, const LightFrame& frame, const PointInputs& points, cl_mem visibility);
    const cl::Buffer& projection() const { return projection_; }
    /// Waits, and says how many points the frame has.
    std::uint32_t read_active_points(cl::Session& session) const;

private:
    cl::Buffer group_bounds_, projection_;
};

}  // namespace gnomon
