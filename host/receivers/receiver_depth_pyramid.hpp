// SPDX-License-Identifier: MIT
// Stage receiver_depth_pyramid (Hi-Z): per bin the depth that the farthest open point reaches, and a pyramid over it
// (kernels/receivers/receiver_depth_pyramid.h has a drawing of its two uses).
#pragma once

#include "receivers/light_frame.hpp"

namespace gnomon {

class ReceiverDepthPyramid {
public:
    /// Makes the pyramid of `frame_count` frames from `first_frame` on; their projections lie one behind the other.
    /// `blocks`: Facing::blocks() of these points, for one frame; null: all points are loaded.
    void run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
             const PointInputs& points, const cl::Buffer& projections, const cl::Buffer* blocks, cl_mem visibility);
    /// For points that are not known yet: every bin gets a point infinitely far from the light, and no point may shadow
    /// itself.
    void fill_for_points_anywhere(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count);
    const cl::Buffer& pyramid() const { return pyramid_; }
    const cl::Buffer& self_shadow_depths() const { return self_shadow_depths_; }  ///< per bin

    /// After the map (null: no map, and depth_after_map() is pyramid()): makes a pyramid over the points that the map
    /// leaves open.
    void run_depth_after_map(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                             const cl::Buffer& projections, const cl::Buffer* map);
    const cl::Buffer& depth_after_map() const { return has_map_ ? depth_after_map_ : pyramid_; }

private:
    void fill(cl::Session& session, std::size_t bins, std::size_t cells, std::size_t filled_cells, cl_uint key);

    cl::Buffer pyramid_, self_shadow_depths_, depth_after_map_;
    bool has_map_ = false;  ///< depth_after_map_ has been made
};

}  // namespace gnomon
