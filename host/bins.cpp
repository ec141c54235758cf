// SPDX-License-Identifier: MIT
#include "bins.hpp"

namespace gnomon {

void Bins::run_heights(cl::Session& session, std::uint32_t bins_x, std::uint32_t bins_y, const cl::Buffer& farthest) {
    struct Level {
        cl_uint width, height, first;
    };
    std::vector<Level> levels{{bins_x, bins_y, 0}};
    for (Level l = levels[0]; l.width > 1 || l.height > 1; levels.push_back(l))
        l = {(l.width + 1) / 2, (l.height + 1) / 2, l.first + l.width * l.height};
    heights_.reserve(session, (levels.back().first + 1) * sizeof(cl_uint));
    // Each launch makes three levels.
    for (std::size_t i = 0; i == 0 || i + 1 < levels.size(); i += 3) {
        const Level& l = levels[i];
        const cl_uint from_farthest = i == 0;
        session.launch("bins.cl", "bins_heights",
                       cl::Range::items(std::size_t((l.width + 7) / 8) * ((l.height + 7) / 8)), l.width, l.height,
                       from_farthest, l.first, farthest, heights_);
    }
}

void Bins::run(cl::Session& session, const cl::Buffer& projection, std::uint32_t bin_count, const TriangleSetup& setup,
               bool with_heights, const cl::Buffer& counters) {
    const std::size_t count_bytes = bin_count * sizeof(cl_uint);
    counts_.reserve(session, count_bytes);
    offsets_.reserve(session, count_bytes + sizeof(cl_uint));
    pairs_.reserve(session, first_capacity_);
    references_.reserve(session, pairs_.capacity());
    session.fill(counts_, 0, count_bytes);
    const cl_uint has_heights = with_heights;
    session.launch("bins.cl", "bins_pairs", cl::Range::items(setup.tiles().capacity()), projection,
                   setup.tiles().capacity(), has_heights, pairs_.capacity(), setup.records(), setup.tiles().buffer(),
                   with_heights ? heights_ : counts_, counts_, pairs_.buffer(), counters);
    scan_.run(session, bin_count, 1, counts_, offsets_);
    session.launch("bins.cl", "bins_scatter", cl::Range::items(pairs_.capacity()), bin_count, setup.capacity(),
                   setup.map_tiles().capacity(), setup.tiles().capacity(), pairs_.capacity(), pairs_.buffer(), offsets_,
                   references_.buffer(), counters);
}

bool Bins::fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted) {
    const std::uint32_t wanted = setup_fitted ? counted.pairs : std::max(counted.pairs, counted.slots);
    return pairs_.fitted(session, wanted, "(triangle, bin) pairs");
}

}  // namespace gnomon
