// SPDX-License-Identifier: MIT
#include "rivals/shadow_map/depth_pass.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "rivals/shadow_map/depth_pass.cl";

}  // namespace

void DepthMap::draw(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views, DepthPass pass,
                    cl::Buffer& output) {
    // A little more than the texels: kernels read the last ones in blocks of lanes.
    const std::size_t words = std::size_t(map_views.set.texels) + session.lanes();
    session.reserve_filled(output, pass.pass == PASS_SLOPE ? 0 : EMPTY_KEY, words * sizeof(cl_uint));
    if (triangles.count == 0) return;
    chunk_count_.reserve(session, sizeof(cl_uint));
    for (pass.view_index = 0; pass.view_index < map_views.set.view_count; ++pass.view_index) {
        // Drawing triangles twice leaves a minimum unchanged: after growing, the pass draws the view again.
        for (bool fitted = false; !fitted;) {
            chunks_.reserve(session, first_capacity_);
            pass.chunk_capacity = chunks_.capacity();
            session.fill(chunk_count_, 0, sizeof(cl_uint));
            session.launch(triangles.kernel(file, "depth_pass_small"), cl::Range::items(triangles.count), pass,
                           triangles.vertices, map_views.views, map_views.tables, keys_, output, chunk_count_,
                           chunks_.buffer());
            session.launch(triangles.kernel(file, "depth_pass_large"), session.small_groups(), pass, triangles.vertices,
                           map_views.views, map_views.tables, keys_, output, chunk_count_, chunks_.buffer());
            fitted = chunks_.fitted(session, session.read_value<cl_uint>(chunk_count_), "chunks of triangles");
        }
    }
}

void DepthMap::run(cl::Session& session, const TriangleInputs& triangles, const MapViews& map_views,
                   const DepthBias& bias, bool with_slopes) {
    DepthPass pass{};
    pass.first_float = triangles.first_float;
    pass.triangle_count = triangles.count;
    pass.slope_bias = bias.slope;
    pass.slope_limit = bias.slope_limit;
    pass.pass = PASS_NEAREST;
    draw(session, triangles, map_views, pass, keys_);
    slopes_.reserve(session, sizeof(float));
    if (with_slopes) {
        pass.pass = PASS_SLOPE;
        draw(session, triangles, map_views, pass, slopes_);
    }
    if (bias.dual_limit > 0) {
        pass.pass = PASS_SECOND;
        draw(session, triangles, map_views, pass, second_);
        session.launch(file, "depth_pass_midpoint", cl::Range::items(map_views.set.texels), map_views.set,
                       bias.dual_limit, keys_, second_);
    }
}

}  // namespace gnomon
