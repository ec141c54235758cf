// SPDX-License-Identifier: MIT
// Stage depth_pass: the nearest caster per texel of a shadow map (kernels/rivals/shadow_map/depth_pass.cl).
#pragma once

#include "kernels/rivals/rasterizer/depth_pass.h"
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

/// The clusters whose casters may reach a view: on a CPU the texels that each may cover, on a GPU a list of those that
/// lie in no view's way, if the triangles keep boxes of clusters.
class CasterClusters {
public:
    /// `views`: view_count views, view_step apart.
    void run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views, cl_uint view_step);
    /// The triangles in the order of their clusters, and what a pass over them needs to know.
    const TriangleInputs& triangles() const { return triangles_; }
    const DepthPass& pass() const { return pass_; }
    const cl::Buffer& covers() const { return covers_; }
    const cl::Buffer& listed() const { return listed_; }
    /// A GPU's work-items over all triangles of all views, and local memory of a caster of so many words for each, and
    /// the end of its share.
    cl::Range items() const {
        return cl::Range::items(std::size_t(pass_.view_count) * pass_.cluster_count * CLUSTER_TRIANGLES);
    }
    static cl::LocalBytes local(const cl::Session& session, std::size_t caster_words) {
        return {session.work_group_size() * (caster_words + 1) * sizeof(cl_uint)};
    }

private:
    TriangleInputs triangles_{};
    DepthPass pass_{};
    cl::Buffer covers_, listed_;
};

class DepthMap {
public:
    /// Draws the triangles into all views. `with_slopes`: slopes() is filled too. Nothing is read back.
    void run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views, const DepthBias& bias,
             bool with_slopes);
    const cl::Buffer& keys() const { return keys_; }      ///< bits of the depth, one float per texel
    const cl::Buffer& slopes() const { return slopes_; }  ///< dx^2 + dy^2, depth per texel, one float per texel
    /// After a run, and the end of its commands: the next one has room for as many chunks as this one made.
    void grow(cl::Session& session);

    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    void draw(cl::Session& session, const MapViews& map_views, DepthPass pass, cl::Buffer& output);

    CasterClusters clusters_;
    cl::Buffer keys_, second_, slopes_, chunk_count_, tile_keys_;
    GrowingList chunks_{sizeof(Chunk)};
    std::uint32_t first_capacity_ = 1u << 18;
};

}  // namespace gnomon
