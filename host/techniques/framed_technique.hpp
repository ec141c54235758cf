// SPDX-License-Identifier: MIT
// The base of techniques that decide points frame by frame of the light, by a map of triangles. A derived technique
// adds the map and its lookup.
#pragma once

#include "occluders/triangle_setup.hpp"
#include "receivers/light_frames.hpp"

namespace gnomon {

class FramedTechnique : public Technique {
public:
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) final;

protected:
    struct Run {
        TriangleInputs triangles;
        PointInputs points;
        LightFrame light_frame;
        cl_mem visibility;
        Statistics statistics{};
        std::uint64_t frames = 0, grown = 0;
        std::uint64_t in_shadow = 0;  ///< points that frames decided
    };
    explicit FramedTechnique(const Device& device) : device_(device) {}

    virtual FrameGrid grid() const = 0;
    /// Decides the open points of a frame by its projection, frames_.projection(), and counts points in shadow.
    virtual void run_frame(Run& run, cl_uint frame) = 0;
    /// begin_counts() runs before the first frame; add_counts() after the last frame adds the technique's own counts.
    virtual void begin_counts() = 0;
    virtual void add_counts(Run& run) const = 0;

    Device device_;
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers, kept from run to run
    cl::Buffer counters_;           ///< FrameCounters
    LightFrames frames_;
    TriangleSetup setup_;
};

}  // namespace gnomon
