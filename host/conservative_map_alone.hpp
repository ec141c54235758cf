// SPDX-License-Identifier: MIT
// Technique conservative-map: the exact pipeline up to its conservative map, and nothing after it: a lower bound of the
// shadow (kernels/conservative_map_alone.cl).
#pragma once

#include "conservative_map.hpp"
#include "farthest_height.hpp"
#include "light_frames.hpp"

namespace gnomon {

class ConservativeMapAlone final : public Technique {
public:
    explicit ConservativeMapAlone(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override;

    static TechniqueDescription describe();

private:
    struct Run;

    void run_frame(Run& run, cl_uint frame);
    /// False if the lists of triangles were too short, which are longer now.
    bool list_triangles(Run& run);

    Device device_;
    CoverTest cover_test_ = CoverTest::tight;
    std::uint32_t map_size_ = 1024;

    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    cl::Buffer counters_;
    LightFrames frames_;
    FarthestHeight farthest_height_;
    TriangleSetup setup_;
    ConservativeMap map_;
};

}  // namespace gnomon
