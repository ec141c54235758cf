// SPDX-License-Identifier: MIT
// Technique sub-pixel: a shadow map of triangles instead of depths (kernels/sub_pixel_shadow_map.h).
#pragma once

#include "../kernels/sub_pixel_shadow_map.h"
#include "light_frames.hpp"
#include "triangle_setup.hpp"

namespace gnomon {

class SubPixelShadowMap final : public Technique {
public:
    explicit SubPixelShadowMap(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override;

    static TechniqueDescription describe();

private:
    struct Run;

    void run_frame(Run& run, cl_uint frame);
    /// False if the lists of triangles were too short, which are longer now.
    bool list_triangles(Run& run);
    void draw(Run& run);
    void decide_points(Run& run, cl_uint frame);

    Device device_;
    bool neighbours_ = true;
    std::uint32_t map_size_ = 1024;

    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    cl::Buffer counters_, map_counters_;
    LightFrames frames_;
    TriangleSetup setup_;
    cl::Buffer heights_, ids_;  ///< per texel
};

}  // namespace gnomon
