// SPDX-License-Identifier: MIT
#include "rivals/shadow_map/depth_pass.hpp"

#include "occluders/clusters.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "rivals/shadow_map/depth_pass.cl";

}  // namespace

void CasterClusters::run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views,
                         cl_uint view_step) {
    // The order of clusters that have one of their own has no cut-outs behind it.
    const OrderedTriangles ordered = ordered_triangles(triangles);
    const bool uses_order = !triangles.has_cut_outs || ordered.numbers == nullptr;
    triangles_ = uses_order ? static_cast<const TriangleInputs&>(ordered) : triangles;
    const cl::Buffer* boxes = triangles.clusters != nullptr && uses_order ? &triangles.clusters->boxes() : nullptr;
    pass_ = {};
    pass_.triangles = triangles_;
    pass_.cluster_count = triangles.count / CLUSTER_TRIANGLES + (triangles.count % CLUSTER_TRIANGLES != 0);
    pass_.has_boxes = boxes != nullptr;
    pass_.view_count = map_views.set.view_count / view_step;
    pass_.view_step = view_step;
    listed_.reserve(session, sizeof(cl_uint2));
    const std::size_t clusters = std::size_t(pass_.view_count) * pass_.cluster_count;
    if (session.is_cpu()) {
        const std::size_t lanes = session.lanes(), blocks = (pass_.cluster_count + lanes - 1) / lanes;
        covers_.reserve(session, pass_.view_count * blocks * lanes * 6 * sizeof(cl_uint));
        session.launch(triangles.kernel(file, "depth_pass_covers"), cl::Range::groups(session.many_groups(), 1), pass_,
                       triangles_.vertices, boxes ? *boxes : listed_, map_views.views, map_views.tables, covers_);
    } else if (boxes != nullptr) {
        listed_.reserve(session, (clusters + 1) * sizeof(cl_uint2));
        session.fill(listed_, 0, sizeof(cl_uint));
        session.launch(triangles.kernel(file, "depth_pass_clusters"), cl::Range::items(clusters), pass_, *boxes,
                       map_views.views, listed_);
    }
}

void DepthMap::draw(cl::Session& session, const MapViews& map_views, DepthPass pass, cl::Buffer& output) {
    const TriangleInputs& triangles = clusters_.triangles();
    // A little more than the texels: kernels read the last ones in blocks of lanes.
    const std::size_t words = std::size_t(map_views.set.texels) + session.lanes();
    output.reserve(session, words * sizeof(cl_uint));
    if (session.is_cpu()) {
        const std::size_t windows = (words >> (2 * WINDOW_LOG2)) + map_views.set.view_count;
        session.launch(triangles.kernel(file, "depth_pass_windows"), cl::Range::groups(windows, 1), pass,
                       triangles.vertices, map_views.views, map_views.tables, clusters_.covers(), keys_, output);
        return;
    }
    session.fill(output, pass.pass == PASS_SLOPE ? 0 : EMPTY_KEY, words * sizeof(cl_uint));
    session.fill(chunk_count_, 0, sizeof(cl_uint));
    // A word for each tile of each view (word_of_tile).
    if (pass.pass == PASS_NEAREST)
        session.reserve_filled(tile_keys_, EMPTY_KEY,
                               (map_views.set.texels / 16 + 2 + map_views.set.view_count) * sizeof(cl_uint));
    const cl::LocalBytes waiting = CasterClusters::local(session, WAITING_CASTER_WORDS);
    session.launch(triangles.kernel(file, "depth_pass_list"), clusters_.items(), pass, triangles.vertices,
                   map_views.views, map_views.tables, clusters_.listed(), keys_, output, chunks_.buffer(), chunk_count_,
                   tile_keys_, waiting);
    session.launch(triangles.kernel(file, "depth_pass_chunks"), session.small_groups(), pass, triangles.vertices,
                   map_views.views, map_views.tables, keys_, output, chunks_.buffer(), chunk_count_, tile_keys_);
    session.launch(triangles.kernel(file, "depth_pass_small"), clusters_.items(), pass, triangles.vertices,
                   map_views.views, map_views.tables, clusters_.listed(), keys_, output, tile_keys_, waiting);
}

void DepthMap::run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views,
                   const DepthBias& bias, bool with_slopes) {
    clusters_.run(session, triangles, map_views, 1);
    if (!session.is_cpu()) {
        chunk_count_.reserve(session, sizeof(cl_uint));
        chunks_.reserve(session, first_capacity_);
    }
    DepthPass pass = clusters_.pass();
    pass.chunk_capacity = chunks_.capacity();
    pass.slope_bias = bias.slope;
    pass.slope_limit = bias.slope_limit;
    pass.pass = PASS_NEAREST;
    draw(session, map_views, pass, keys_);
    slopes_.reserve(session, sizeof(float));
    if (with_slopes) {
        pass.pass = PASS_SLOPE;
        draw(session, map_views, pass, slopes_);
    }
    if (bias.dual_limit > 0) {
        pass.pass = PASS_SECOND;
        draw(session, map_views, pass, second_);
        session.launch(file, "depth_pass_midpoint", cl::Range::items(map_views.set.texels), map_views.set,
                       bias.dual_limit, keys_, second_);
    }
}

void DepthMap::grow(cl::Session& session) {
    if (chunks_.capacity() != 0)
        chunks_.fitted(session, session.read_value<cl_uint>(chunk_count_), "chunks of casters");
}

}  // namespace gnomon
