// SPDX-License-Identifier: MIT
// Stages moments and prefilter: depths to stored quantities, filtered (kernels/techniques/shadow_map/moments.h,
// prefilter.cl).
#pragma once

#include "kernels/techniques/shadow_map/moments.h"
#include "techniques/shadow_map/depth_pass.hpp"

namespace gnomon {

enum class Prefilter { none, gaussian, summed_area, mip };

class StoredMap {
public:
    /// Fills planes() from the depths.
    void fill(cl::Session& session, const MapViews& map_views, const DepthMap& depths, const StorePlan& plan);
    /// Sets `plan.summed`, or `plan.mips`, and the members that belong to it.
    void prefilter(cl::Session& session, const MapViews& map_views, Prefilter prefilter, std::uint32_t width,
                   StorePlan& plan);
    const cl::Buffer& planes() const { return planes_; }
    const cl::Buffer& mips() const { return scratch_; }  ///< levels beside the first, if plan.mips is not 0

private:
    cl::Buffer planes_, scratch_, weights_;
};

}  // namespace gnomon
