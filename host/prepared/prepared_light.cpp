// SPDX-License-Identifier: MIT
#include "prepared/prepared_light.hpp"

#include <bit>
#include <vector>

#include "kernels/lists/append.h"
#include "kernels/prepared/unshadowed_triangles.h"

namespace gnomon {
namespace {

constexpr const char* file = "prepared/prepared_light.cl";

void lengthen(cl::Session& session, cl::Buffer& buffer, std::size_t kept_bytes, std::size_t bytes) {
    cl::Buffer longer(session, bytes);
    session.copy(buffer, 0, longer, 0, kept_bytes);
    buffer = std::move(longer);
}

}  // namespace

PreparedLight::PreparedLight(cl::Session& session, Statistics& statistics, const Triangles& triangles,
                             const Light& light, const FrameGrid& grid, const ListSettings& settings,
                             std::uint32_t first_capacity)
    : triangles_(triangles),
      light_(light),
      light_frame_(make_light_frame(light, grid)),
      draws_map_(settings.draws_map) {
    const TriangleInputs inputs = triangle_inputs(triangles);
    if (!fit(session, statistics, inputs)) return;
    const cl_uint frame_count = frame_count_of(light_frame_);
    const auto fitted = session.read_values<Projection>(projections().get(), frame_count);
    for (const Projection& frame : fitted)
        if (frame.active_points != 0 && frame.indistinct != 0) return;

    keep_planes(session, statistics, inputs);
    const std::size_t texels = std::size_t(frame_count) * grid.size * grid.size;
    if (draws_map_) map_.reserve(session, texels * sizeof(cl_uint));
    if (draws_map_) session.fill(map_, 0, texels * sizeof(cl_uint));
    for (cl::Buffer* list : {&entries_, &records_, &bounds_}) list->reserve(session, 0);

    ReceiverDepthPyramid anywhere;
    OccluderLists lists;
    lists.limit_initial_capacity(first_capacity);
    anywhere.fill_for_points_anywhere(session, light_frame_, 1);
    const cl::Buffer projection(session, sizeof(Projection)), counters(session, sizeof(FrameCounters));
    for (cl_uint frame = 0; frame < frame_count; ++frame) {
        if (fitted[frame].active_points == 0) continue;
        session.write(projection.get(), &fitted[frame], sizeof(Projection));
        FrameCounters counted;
        do {
            session.fill(counters, 0, sizeof(FrameCounters));
            lists.run(session, statistics, light_frame_, projection, inputs, settings, anywhere, counters);
            counted = session.read_value<FrameCounters>(counters);
        } while (!lists.fitted(session, counted));
        keep(session, statistics, lists, counted, frame);
        add_counters(counted_, counted);
    }
    find_unshadowed_triangles(session, statistics, inputs);
    is_usable_ = true;
}

// A CPU's trace reads neither slots nor bits of unshadowed triangles.
void PreparedLight::reserve_tables(cl::Session& session, cl_uint triangle_count) {
    const std::size_t frame_count = frame_count_of(light_frame_), on_gpu = session.is_cpu() ? 0 : triangle_count;
    std::size_t bytes = 0;
    const auto append = [&bytes](std::size_t table_bytes) {
        const std::size_t first = bytes;
        bytes += (table_bytes + 15) / 16 * 16;
        return static_cast<cl_uint>(first / 16);
    };
    append(frame_count * light_frame_.bins_x * light_frame_.bins_y * 2 * sizeof(cl_uint));  // the ranges
    offsets_.largest = append(sizeof(cl_uint));
    offsets_.unshadowed = append((on_gpu / UNSHADOWED_WORD_BITS + 1) * sizeof(cl_uint));
    const std::size_t zeroed_bytes = bytes;
    offsets_.domains = append(frame_count * sizeof(PreparedDomain));
    offsets_.planes = append(triangle_count * sizeof(cl_float4));
    offsets_.slots = append(on_gpu * sizeof(cl_uint));
    tables_.reserve(session, bytes);
    if (!session.is_cpu()) session.fill(tables_, GN_NO_ID, bytes);  // the slots; the other tables are written whole
    session.fill(tables_, 0, zeroed_bytes);
}

PreparedParams PreparedLight::params(const TriangleInputs& triangles) const {
    return {.triangles = triangles,
            .light_frame = light_frame_,
            .tables = offsets_,
            .record_count = records_kept_,
            .sample_step = 1,
            .padding = 0};
}

// Returns false if there is no triangle to fit to.
bool PreparedLight::fit(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles) {
    cl::StageTimer timer(session, statistics, "light_frame");
    const cl_uint frame_count = frame_count_of(light_frame_);
    const cl::Buffer frame_bounds(session, frame_count * sizeof(PointBounds));
    reserve_tables(session, triangles.count);
    session.fill(frame_bounds, 0, frame_count * sizeof(PointBounds));
    session.launch(file, "prepared_bounds", cl::Range::items(triangles.count), params(triangles), triangles.vertices,
                   frame_bounds);
    session.launch(file, "prepared_domains", cl::Range::groups(1), params(triangles), frame_bounds, tables_);
    light_frame_fit_.run(session, light_frame_, frame_bounds);
    return triangles.count != 0;
}

void PreparedLight::keep_planes(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles) {
    cl::StageTimer timer(session, statistics, "planes");
    session.launch(file, "prepared_planes", session.blocks(triangles.count), params(triangles), triangles.vertices,
                   tables_);
}

// Tests one in `step` of the triangles that have a record.
void PreparedLight::seek_unshadowed_triangles(cl::Session& session, const TriangleInputs& triangles, cl_uint step) {
    const std::size_t sought = records_kept_ / step;
    PreparedParams params = this->params(triangles);
    params.sample_step = step;
    session.launch("prepared/unshadowed_triangles.cl", "unshadowed_candidates", cl::Range::items(sought), params,
                   bounds_, tables_);
    session.launch("prepared/unshadowed_triangles.cl", "unshadowed_triangles",
                   cl::Range::items(sought * UNSHADOWED_TEAM), params, projections(), triangles.vertices, entries_,
                   records_, bounds_, tables_);
}

std::vector<cl_uint> PreparedLight::unshadowed_bits(cl::Session& session) const {
    const std::size_t words = triangles_.count() / UNSHADOWED_WORD_BITS + 1;
    const cl::Buffer copied(session, words * sizeof(cl_uint));
    session.copy(tables_, std::size_t(offsets_.unshadowed) * 16, copied, 0, words * sizeof(cl_uint));
    return session.read_values<cl_uint>(copied.get(), words);
}

// Unshadowed triangles are not searched for under a point light, since a triangle may be in several of its frames and
// hidden in some; nor on a CPU, where the search takes longer than dozens of frames would gain: its trace does not read
// the bits; nor where they are rare (docs/notebook/experiments.md): they gain no time then, and the search takes half
// of preparing.
void PreparedLight::find_unshadowed_triangles(cl::Session& session, Statistics& statistics,
                                              const TriangleInputs& triangles) {
    constexpr cl_uint sample_step = 16;
    constexpr std::size_t min_share = 32;  // at least one triangle in this many
    if (session.is_cpu() || frame_count_of(light_frame_) != 1 || records_kept_ == 0) return;
    cl::StageTimer timer(session, statistics, "unshadowed_triangles");
    if (records_kept_ >= sample_step * min_share) {
        seek_unshadowed_triangles(session, triangles, sample_step);
        std::size_t unshadowed = 0;
        for (const cl_uint word : unshadowed_bits(session)) unshadowed += static_cast<std::size_t>(std::popcount(word));
        if (unshadowed * min_share < records_kept_ / sample_step) return;
    }
    seek_unshadowed_triangles(session, triangles, 1);
}

void PreparedLight::keep(cl::Session& session, Statistics& statistics, const OccluderLists& lists,
                         const FrameCounters& counted, cl_uint frame) {
    if (draws_map_) {
        const std::size_t map_bytes = std::size_t(light_frame_.width) * light_frame_.height * sizeof(cl_uint);
        session.copy(lists.map().map(), 0, map_, frame * map_bytes, map_bytes);
    }
    if (counted.entries == 0) return;
    cl::StageTimer timer(session, statistics, "keep");
    const std::size_t slots = std::min(counted.slots, lists.setup().capacity());
    const cl_uint bin_count = light_frame_.bins_x * light_frame_.bins_y;
    KeptFrame kept{.tables = offsets_,
                   .entry_count = counted.entries,
                   .slot_count = static_cast<cl_uint>(slots),
                   .bin_count = bin_count,
                   .record_count = 0,
                   .first_entry = entries_kept_,
                   .first_record = records_kept_,
                   .first_bin = frame * bin_count,
                   .by_id = session.is_cpu() && light_frame_.perspective == 0};
    const cl::Buffer kept_slots(session, slots * sizeof(cl_uint)), named_count(session, sizeof(cl_uint));
    session.fill(kept_slots, GN_NO_ID, slots * sizeof(cl_uint));
    session.fill(named_count, 0, sizeof(cl_uint));
    session.launch(file, "prepared_kept_slots", cl::Range::items(counted.entries), kept, lists.bins().entries(),
                   lists.setup().bounds(), kept_slots, named_count);
    kept.record_count =
        kept.by_id != 0 ? static_cast<cl_uint>(triangles_.count()) : session.read_value<cl_uint>(named_count);

    const std::uint64_t records = std::uint64_t(records_kept_) + kept.record_count,
                        entries = std::uint64_t(entries_kept_) + counted.entries;
    if (records >= APPEND_OVERFLOW || entries >= APPEND_OVERFLOW)
        throw OutOfDeviceMemory("keeping more than 2^32 entries of a prepared light", CL_MEM_OBJECT_ALLOCATION_FAILURE,
                                "set a smaller map-size, or do without preparing");
    const std::size_t entry_bytes = session.lanes() * BIN_ENTRY_BYTES;
    lengthen(session, entries_, entries_kept_ * entry_bytes, entries * entry_bytes);
    lengthen(session, records_, records_kept_ * sizeof(TriangleRecord), records * sizeof(TriangleRecord));
    lengthen(session, bounds_, records_kept_ * sizeof(TriangleBounds), records * sizeof(TriangleBounds));
    session.launch(file, "prepared_records", cl::Range::items(slots), kept, kept_slots, lists.setup().records(),
                   lists.setup().bounds(), records_, bounds_);
    session.launch(file, "prepared_entries", cl::Range::items(session.is_cpu() ? bin_count : counted.entries), kept,
                   lists.bins().ranges(), lists.bins().entries(), kept_slots, entries_);
    if (!session.is_cpu())
        session.launch(file, "prepared_slots", cl::Range::items(kept.record_count), kept, bounds_, tables_);
    session.launch(file, "prepared_ranges", cl::Range::items(bin_count), kept, lists.bins().ranges(), tables_);
    records_kept_ = static_cast<cl_uint>(records);
    entries_kept_ = static_cast<cl_uint>(entries);
}

std::uint64_t PreparedLight::bytes() const {
    std::uint64_t bytes = 0;
    for (const cl::Buffer* buffer : {&projections(), &tables_, &map_, &entries_, &records_, &bounds_})
        bytes += buffer->bytes();
    return bytes;
}

bool PreparedLight::is_of(const Triangles& triangles, const Light& light) const {
    return triangles.is_same_as(triangles_) && light.xyzw == light_.xyzw;
}

}  // namespace gnomon
