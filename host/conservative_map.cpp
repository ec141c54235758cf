// SPDX-License-Identifier: MIT
#include "conservative_map.hpp"

namespace gnomon {
namespace {
// Groups that share one large triangle's rows.
constexpr cl_uint splits = 16;
}  // namespace

void ConservativeMap::run(cl::Session& session, const LightFrame& frame, const cl::Buffer& projection,
                          const TriangleSetup& setup, CoverTest cover_test, const cl::Buffer& counters) {
    const std::size_t bytes = std::size_t(frame.width) * frame.height * sizeof(cl_uint);
    map_.reserve(session, bytes);
    session.fill(map_, 0, bytes);  // below every height's key
    const cl_uint circle_cover = cover_test == CoverTest::circle;
    const std::size_t groups = (session.many_groups() + splits - 1) / splits * splits;
    session.launch("conservative_map.cl", "conservative_map", cl::Range::groups(groups), projection, setup.capacity(),
                   splits, circle_cover, setup.records(), setup.record_bins(), setup.map_candidates(), map_, counters);
}

}  // namespace gnomon
