// SPDX-License-Identifier: MIT
// Stage light_frame: the projection fitted to the points that still need an answer (kernels/receivers/light_frame.h).
#pragma once

#include "api/inputs.hpp"
#include "kernels/receivers/light_frame.h"

namespace gnomon {

/// Texels of a frame, and how they are grouped into bins.
struct FrameGrid {
    std::uint32_t size;      ///< texels per side
    std::uint32_t bin_log2;  ///< texels per bin side, as a power of two
    std::uint32_t bins() const { return (size + (1u << bin_log2) - 1) >> bin_log2; }
    std::uint32_t bin_count() const { return bins() * bins(); }
};
/// The finest bins of which there are at most 128 x 128 on a CPU, 512 x 512 on a GPU.
FrameGrid binned(const cl::Session& session, std::uint32_t size);

/// The frame of a directional light, or the first of a positional one's POINT_LIGHT_FRAMES (the faces of a cube around
/// it).
LightFrame make_light_frame(const Light& light, const FrameGrid& grid);
inline cl_uint frame_count_of(const LightFrame& light_frame) {
    return light_frame.perspective ? POINT_LIGHT_FRAMES : 1;
}

class LightFrameFit {
public:
    /// Fits projections(), one per frame, to the points that the facing stage left open, by their bounds.
    void run(cl::Session& session, const LightFrame& light_frame, const cl::Buffer& frame_bounds);
    const cl::Buffer& projections() const { return projections_; }

private:
    cl::Buffer projections_;
};

}  // namespace gnomon
