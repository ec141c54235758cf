// SPDX-License-Identifier: MIT
#include "triangle_lists.hpp"

namespace gnomon {

const cl::Buffer* TriangleLists::run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                                     const cl::Buffer& projection, const TriangleInputs& triangles,
                                     const ListSettings& settings, FarthestHeight& farthest_height,
                                     const cl::Buffer& counters) {
    const ProjectionInput in_frame(projection, light_frame.perspective == 0);
    const cl::Buffer* clusters = nullptr;
    if (triangles.clusters != nullptr) {
        cl::StageTimer timer(session, statistics, "clusters");
        clusters = clusters_.run(session, in_frame, triangles, &farthest_height.pyramid(), counters);
    }
    {
        cl::StageTimer timer(session, statistics, "triangle_setup");
        setup_.run_bounds(session, in_frame, triangles, clusters, &farthest_height.pyramid(), counters);
    }
    const cl::Buffer* map = nullptr;
    if (settings.draws_map) {
        cl::StageTimer timer(session, statistics, "conservative_map");
        if (settings.judges_map) map_.judge(session, projection, counters);
        setup_.run_map_tiles(session, in_frame, triangles, farthest_height.pyramid(), counters);
        map_.run(session, light_frame, projection, setup_, farthest_height.pyramid(), settings.cover_test, counters);
        map = &map_.map();
    }
    cl::StageTimer timer(session, statistics, "bins");
    farthest_height.run_open_heights(session, light_frame, 1, projection, map);
    bins_.run(session, in_frame, triangles, light_frame.bins_x * light_frame.bins_y, setup_,
              &farthest_height.open_heights(), counters);
    return map;
}

bool TriangleLists::fitted(cl::Session& session, const FrameCounters& counted) {
    const bool setup = setup_.fitted(session, counted), references = bins_.fitted(session, counted, setup);
    return setup && references;
}

void TriangleLists::limit_initial_capacity(std::uint32_t capacity) {
    setup_.limit_initial_capacity(capacity);
    bins_.limit_initial_capacity(capacity);
}

}  // namespace gnomon
