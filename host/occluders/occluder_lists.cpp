// SPDX-License-Identifier: MIT
#include "occluders/occluder_lists.hpp"

namespace gnomon {

const cl::Buffer* OccluderLists::run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                                     const cl::Buffer& projection, const TriangleInputs& triangles,
                                     const ListSettings& settings, ReceiverDepthPyramid& depths,
                                     const cl::Buffer& counters) {
    const ProjectionInput in_frame(projection, light_frame.perspective == 0);
    const cl::Buffer& pyramid = depths.pyramid();
    cl::StageTimer timer(session, statistics, triangles.clusters != nullptr ? "clusters" : nullptr);
    const cl::Buffer *clusters = clusters_.run(session, in_frame, triangles, &pyramid, counters), *map = nullptr;
    timer.next("triangle_setup");
    setup_.run_bounds(session, in_frame, triangles, clusters, &pyramid, counters);
    if (settings.draws_map) {
        timer.next("conservative_map");
        if (settings.judges_map) map_.judge(session, projection, counters);
        setup_.run_map_tiles(session, in_frame, triangles, pyramid, counters);
        map_.run(session, light_frame, projection, setup_, pyramid, settings.cover_test, counters);
        map = &map_.map();
    }
    timer.next("receiver_depth_pyramid");
    depths.run_depth_after_map(session, light_frame, 1, projection, map);
    timer.next("triangle_setup");
    const PairBuffers pairs = bins_.begin(session, light_frame.bins_x * light_frame.bins_y, setup_);
    setup_.run_tiles(session, in_frame, triangles, &depths.depth_after_map(), &pairs, counters);
    timer.next("bins");
    bins_.run(session, in_frame, setup_, &depths.depth_after_map(), counters);
    return map;
}

bool OccluderLists::fitted(cl::Session& session, const FrameCounters& counted) {
    const bool setup = setup_.fitted(session, counted), references = bins_.fitted(session, counted, setup);
    return setup && references;
}

}  // namespace gnomon
