// SPDX-License-Identifier: MIT
#include "occluders/conservative_map.hpp"

namespace gnomon {

void ConservativeMap::run(cl::Session& session, const LightFrame& frame, const cl::Buffer& projection,
                          const TriangleSetup& setup, const cl::Buffer& pyramid, CoverTest cover_test,
                          const cl::Buffer& counters) {
    const std::size_t bytes = std::size_t(frame.width) * frame.height * sizeof(cl_uint);
    map_.reserve(session, bytes);
    session.fill({{map_, 0, bytes}});  // below every height's key
    const ConservativeMapParams params{.tile_capacity = setup.map_tiles().capacity(),
                                       .cover_test = static_cast<cl_uint>(cover_test)};
    session.launch("occluders/conservative_map.cl", "conservative_map_draw", cl::Range::shares(params.tile_capacity),
                   params, projection, setup.records(), setup.map_tiles().buffer(), pyramid, map_, counters,
                   cl::LocalBytes{session.work_group_size() * sizeof(cl_uint)},
                   cl::LocalBytes{session.work_group_size() * sizeof(cl_uint2)});
}

void ConservativeMap::judge(cl::Session& session, const cl::Buffer& projection, const cl::Buffer& counters) {
    session.launch("occluders/conservative_map.cl", "conservative_map_judge", cl::Range::groups(1), projection,
                   counters);
}

}  // namespace gnomon
