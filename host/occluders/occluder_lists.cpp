// SPDX-License-Identifier: MIT
#include "occluders/occluder_lists.hpp"

namespace gnomon {

const cl::Buffer* OccluderLists::run(cl::Session& session, Statistics& statistics, const ListInputs& in,
                                     const TriangleInputs& triangles, const cl::Buffer& counters) {
    const bool is_camera = in.light_frame == nullptr;
    const char* setup_stage = is_camera ? "camera_setup" : "triangle_setup";
    const char* cluster_stage = is_camera ? setup_stage : "clusters";
    const cl::Buffer *pyramid = is_camera ? nullptr : &in.depths->pyramid(), *map = nullptr;
    cl::StageTimer timer(session, statistics, triangles.clusters != nullptr ? cluster_stage : nullptr);
    const cl::Buffer* clusters = clusters_.run(session, in.projection, triangles, pyramid, counters);
    timer.next(setup_stage);
    setup_.run_bounds(session, in.projection, triangles, clusters, pyramid, counters);
    if (!is_camera && in.settings.draws_map) {
        timer.next("conservative_map");
        if (in.settings.judges_map) map_.judge(session, in.projection.buffer, counters);
        setup_.run_map_tiles(session, in.projection, triangles, *pyramid, counters);
        map_.run(session, *in.light_frame, in.projection.buffer, setup_, *pyramid, in.settings.cover_test, counters);
        map = &map_.map();
    }
    if (!is_camera) {
        timer.next("receiver_depth_pyramid");
        in.depths->run_depth_after_map(session, *in.light_frame, 1, in.projection.buffer, map);
        pyramid = &in.depths->depth_after_map();
        timer.next(setup_stage);
    }
    const PairBuffers pairs = bins_.begin(session, in.bin_count, setup_);
    setup_.run_tiles(session, in.projection, triangles, pyramid, &pairs, counters);
    timer.next(is_camera ? "camera_bins" : "bins");
    bins_.run(session, in.projection, setup_, pyramid, in.settings.orders_runs, counters);
    return map;
}

bool OccluderLists::fitted(cl::Session& session, const FrameCounters& counted) {
    const bool setup = setup_.fitted(session, counted), references = bins_.fitted(session, counted, setup);
    return setup && references;
}

}  // namespace gnomon
