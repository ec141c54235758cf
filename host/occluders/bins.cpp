// SPDX-License-Identifier: MIT
#include "occluders/bins.hpp"

namespace gnomon {

void Bins::run(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
               std::uint32_t bin_count, TriangleSetup& setup, const cl::Buffer* heights, const cl::Buffer& counters) {
    const std::size_t count_bytes = bin_count * sizeof(cl_uint);
    const cl_uint lanes = session.lanes(), has_heights = heights != nullptr;
    counts_.reserve(session, count_bytes);
    ranges_.reserve(session, 2 * count_bytes);
    const std::uint32_t likely = std::min(first_capacity_, std::max(4 * setup.capacity(), least_capacity));
    pairs_.reserve(session, likely);
    entries_.reserve(session, likely);
    session.fill(counts_, 0, count_bytes);
    const PairBuffers listed{pairs_.capacity(), pairs_.buffer(), counts_};
    setup.run_tiles(session, projection, triangles, heights, &listed, counters);
    session.launch("occluders/bins.cl", "bins_pairs", cl::Range::items(setup.tiles().capacity()), projection.buffer,
                   setup.tiles().capacity(), has_heights, pairs_.capacity(), setup.records(), setup.tiles().buffer(),
                   heights ? *heights : counts_, counts_, pairs_.buffer(), counters,
                   cl::LocalBytes{session.work_group_size() * sizeof(cl_uint)},
                   cl::LocalBytes{session.work_group_size() * sizeof(cl_uint2)},
                   cl::LocalBytes{session.work_group_size() * PAIRS_AT_ONCE * sizeof(cl_uint2)});
    session.launch("occluders/bins.cl", "bins_ranges",
                   cl::Range::items(session.is_cpu() ? bin_count / 128 + 1 : bin_count), bin_count,
                   entries_.capacity() / lanes, counts_, ranges_, entries_.buffer(), counters,
                   cl::LocalBytes{session.work_group_size() * sizeof(cl_uint)}, cl::LocalBytes{sizeof(cl_uint)});
    const bool orders = lanes == 1;
    listed_.reserve(session, orders ? entries_.capacity() * std::size_t(BIN_ENTRY_BYTES) : 0);
    session.launch("occluders/bins.cl", "bins_scatter", cl::Range::items(pairs_.capacity()), setup.capacity(),
                   setup.map_tiles().capacity(), setup.tiles().capacity(), pairs_.capacity(),
                   entries_.capacity() / lanes, pairs_.buffer(), ranges_, setup.bounds(),
                   orders ? listed_ : entries_.buffer(), counters);
    if (orders)
        session.launch("occluders/bins.cl", "bins_order", cl::Range::items(entries_.capacity()), listed_,
                       entries_.buffer(), counters,
                       cl::LocalBytes{(session.work_group_size() + 2 * LIST_RUN) * sizeof(cl_uint)});
}

bool Bins::fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted) {
    const std::uint32_t wanted = setup_fitted ? counted.pairs : std::max(counted.pairs, counted.slots);
    const bool pairs = pairs_.fitted(session, wanted, "(triangle, bin) pairs");
    const std::uint64_t entries = std::uint64_t(counted.entries) * session.lanes();
    return entries_.fitted(session, entries, "entries of bins") && pairs;
}

}  // namespace gnomon
