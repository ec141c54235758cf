// SPDX-License-Identifier: MIT
// Stage receiver_depth_pyramid: per bin the height of the point farthest from the light, and a pyramid of minima
// (kernels/receivers/receiver_depth_pyramid.cl).
#pragma once

#include "receivers/light_frame.hpp"

namespace gnomon {

class ReceiverDepthPyramid {
public:
    /// Of the frames from `first_frame` on, `frame_count` of them, whose projections lie one behind the other.
    /// `blocks`: Facing::blocks() of these points, for one frame; null: points are looked at one by one.
    void run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
             const PointInputs& points, const cl::Buffer& projections, const cl::Buffer* blocks, cl_mem visibility);
    /// As if every bin had a point infinitely far from the light, and no doubtful one: for points that are not known
    /// yet.
    void fill_for_points_anywhere(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count);
    const cl::Buffer& pyramid() const { return pyramid_; }
    const cl::Buffer& self_shadow_depths() const { return self_shadow_depths_; }  ///< per bin, of doubtful points alone

    /// After the map (null: none, and then it is pyramid()): per bin a height below which no point needs a list of
    /// triangles; a pyramid too.
    void run_depth_after_map(cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                             const cl::Buffer& projections, const cl::Buffer* map);
    const cl::Buffer& depth_after_map() const { return knows_map_ ? depth_after_map_ : pyramid_; }

private:
    cl::Buffer pyramid_, self_shadow_depths_, depth_after_map_;
    bool knows_map_ = false;  ///< depth_after_map_ has been made
};

}  // namespace gnomon
