// SPDX-License-Identifier: MIT
// Stage depth_pass: the nearest caster per texel of a shadow map (kernels/rivals/shadow_map/depth_pass.cl).
#pragma once

#include "kernels/rivals/shadow_map/depth_pass.h"
#include "occluders/triangle_setup.hpp"

namespace gnomon {

/// The views of a shadow map. The host knows `set`; the rest stays on the device.
struct MapViews {
    cl::Buffer views;   ///< MapView, set.view_count of them
    cl::Buffer tables;  ///< floats: texel centres of every view, and the tables of rectilinear warps
    MapSet set{};
};

/// Bias that the depth pass adds to the map. All in units of depth, 0 to 1 over the receivers.
struct DepthBias {
    float slope = 0;        ///< times the steeper of the two depth slopes per texel
    float slope_limit = 1;  ///< most that the slope adds
    float dual_limit = 0;   ///< more than 0: half-way to the second layer, at most this (Weiskopf and Ertl 2003)
};

class DepthMap {
public:
    /// Draws the triangles into all views. `with_slopes`: slopes() is filled too.
    void run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views, const DepthBias& bias,
             bool with_slopes);
    const cl::Buffer& keys() const { return keys_; }      ///< bits of the depth, one float per texel
    const cl::Buffer& slopes() const { return slopes_; }  ///< dx^2 + dy^2, depth per texel, one float per texel

    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    void draw(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views, DepthPass pass,
              cl::Buffer& output);

    cl::Buffer keys_, second_, slopes_, chunk_count_;
    GrowingList chunks_{2 * sizeof(cl_uint)};
    std::uint32_t first_capacity_ = 1u << 16;
};

}  // namespace gnomon
