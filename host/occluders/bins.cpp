// SPDX-License-Identifier: MIT
#include "occluders/bins.hpp"

namespace gnomon {

PairBuffers Bins::begin(cl::Session& session, std::uint32_t bin_count, const TriangleSetup& setup) {
    const std::size_t count_bytes = bin_count * sizeof(cl_uint);
    bin_count_ = bin_count;
    const std::size_t items = session.is_cpu() ? session.compute_units() * session.work_group_size() : 1;
    const bool has_own_rows = session.is_cpu() && items * bin_count <= max_own_counts;
    count_rows_ = static_cast<std::uint32_t>(has_own_rows ? items : 1);
    counts_.reserve(session, count_rows_ * count_bytes);
    ranges_.reserve(session, 2 * count_bytes);
    const std::uint32_t likely = std::min(first_capacity_, std::max(4 * setup.capacity(), min_capacity));
    pairs_.reserve(session, likely);
    entries_.reserve(session, likely);
    if (!has_own_rows) session.fill({{counts_, 0, count_bytes}});
    return {pairs_.capacity(), count_rows_, pairs_.buffer(), counts_};
}

void Bins::run(cl::Session& session, const ProjectionInput& projection, const TriangleSetup& setup,
               const cl::Buffer* pyramid, bool orders_runs, const cl::Buffer& counters) {
    const std::size_t group = session.work_group_size();
    const BinsParams params{.bin_count = bin_count_,
                            .bounds_capacity = setup.capacity(),
                            .map_tile_capacity = setup.map_tiles().capacity(),
                            .tile_capacity = setup.tiles().capacity(),
                            .pair_capacity = pairs_.capacity(),
                            .entry_capacity = entries_.capacity() / session.lanes(),
                            .has_pyramid = pyramid != nullptr,
                            .count_rows = count_rows_};
    if (!session.is_cpu())
        session.launch("occluders/bins.cl", "bins_pairs", cl::Range::items(params.tile_capacity), params,
                       projection.buffer, setup.records(), setup.tiles().buffer(), pyramid ? *pyramid : counts_,
                       counts_, pairs_.buffer(), counters, cl::LocalBytes{group * sizeof(cl_uint)},
                       cl::LocalBytes{group * sizeof(cl_uint2)},
                       cl::LocalBytes{group * PAIRS_AT_ONCE * sizeof(cl_uint2)});
    session.launch("occluders/bins.cl", "bins_ranges",
                   cl::Range::items(session.is_cpu() ? bin_count_ / 128 + 1 : bin_count_), params, counts_, ranges_,
                   entries_.buffer(), counters, cl::LocalBytes{group * sizeof(cl_uint)},
                   cl::LocalBytes{sizeof(cl_uint)});
    const bool orders = session.lanes() == 1 && orders_runs;
    unordered_.reserve(session, orders ? entries_.capacity() * std::size_t(BIN_ENTRY_BYTES) : 0);
    session.launch("occluders/bins.cl", "bins_scatter", cl::Range::shares(params.pair_capacity), params,
                   pairs_.buffer(), counts_, ranges_, setup.bounds(), orders ? unordered_ : entries_.buffer(),
                   counters);
    if (orders)
        session.launch("occluders/bins.cl", "bins_order", cl::Range::items(entries_.capacity()), unordered_,
                       entries_.buffer(), counters, cl::LocalBytes{(group + 2 * LIST_RUN) * sizeof(cl_uint)});
}

bool Bins::fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted) {
    const std::uint32_t wanted = setup_fitted ? counted.pairs : std::max(counted.pairs, counted.slots);
    const bool pairs = pairs_.fitted(session, wanted, "(triangle, bin) pairs");
    const std::uint64_t entries = std::uint64_t(counted.entries) * session.lanes();
    return entries_.fitted(session, entries, "entries of bins") && pairs;
}

}  // namespace gnomon
