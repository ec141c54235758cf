// SPDX-License-Identifier: MIT
#include "occluders/occluder_lists.hpp"

namespace gnomon {

const cl::Buffer* OccluderLists::run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                                     const cl::Buffer& projection, const TriangleInputs& triangles,
                                     const ListSettings& settings, ReceiverDepthPyramid& receiver_depth_pyramid,
                                     const cl::Buffer& counters) {
    const ProjectionInput in_frame(projection, light_frame.perspective == 0);
    const cl::Buffer* clusters = nullptr;
    if (triangles.clusters != nullptr) {
        cl::StageTimer timer(session, statistics, "clusters");
        clusters = clusters_.run(session, in_frame, triangles, &receiver_depth_pyramid.pyramid(), counters);
    }
    {
        cl::StageTimer timer(session, statistics, "triangle_setup");
        setup_.run_bounds(session, in_frame, triangles, clusters, &receiver_depth_pyramid.pyramid(), counters);
    }
    const cl::Buffer* map = nullptr;
    if (settings.draws_map) {
        cl::StageTimer timer(session, statistics, "conservative_map");
        if (settings.judges_map) map_.judge(session, projection, counters);
        setup_.run_map_tiles(session, in_frame, triangles, receiver_depth_pyramid.pyramid(), counters);
        map_.run(session, light_frame, projection, setup_, receiver_depth_pyramid.pyramid(), settings.cover_test,
                 counters);
        map = &map_.map();
    }
    cl::StageTimer timer(session, statistics, "bins");
    receiver_depth_pyramid.run_depth_after_map(session, light_frame, 1, projection, map);
    bins_.run(session, in_frame, triangles, light_frame.bins_x * light_frame.bins_y, setup_,
              &receiver_depth_pyramid.depth_after_map(), counters);
    return map;
}

bool OccluderLists::fitted(cl::Session& session, const FrameCounters& counted) {
    const bool setup = setup_.fitted(session, counted), references = bins_.fitted(session, counted, setup);
    return setup && references;
}

void OccluderLists::limit_initial_capacity(std::uint32_t capacity) {
    setup_.limit_initial_capacity(capacity);
    bins_.limit_initial_capacity(capacity);
}

}  // namespace gnomon
