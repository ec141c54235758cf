// SPDX-License-Identifier: MIT
#include "light_stages.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace support {
namespace {

using gnomon::cl::Buffer;
using gnomon::cl::Session;

std::size_t pyramid_cells(const gnomon::LightFrame& frame) {
    std::size_t cells = 0;
    for (std::uint32_t w = frame.bins_x, h = frame.bins_y;; w = (w + 1) / 2, h = (h + 1) / 2) {
        cells += std::size_t(w) * h;
        if (w == 1 && h == 1) return cells;
    }
}

std::vector<SetUpTriangle> read_triangles(Session& session, const LightStages& stages,
                                          const gnomon::FrameCounters& counted, const gnomon::Projection& projection) {
    const auto records =
        downloaded<gnomon::TriangleRecord>(session, stages.lists.setup().records().get(), counted.slots);
    const auto bounds = downloaded<gnomon::TriangleBounds>(session, stages.lists.setup().bounds().get(), counted.slots);
    std::vector<SetUpTriangle> triangles;
    for (std::size_t i = 0; i < records.size(); ++i)
        if (!is_dropped(bounds[i])) triangles.push_back({bounds[i].id, records[i], bins_of(bounds[i], projection)});
    std::sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return triangles;
}

/// By texel; the texels of a bin are neighbours, row by row.
std::vector<ListedPoint> read_points(Session& session, LightStages& stages, const gnomon::LightFrame& frame) {
    const std::uint32_t bin_log2 = frame.bin_log2, list_count = frame.bins_x * frame.bins_y << 2 * bin_log2;
    std::vector<std::uint32_t>& offsets = stages.izb_offsets;
    offsets.resize(list_count + 1);
    session.read(stages.izb.offsets().get(), offsets.data(), offsets.size() * sizeof(offsets[0]));
    const std::size_t stride = stages.izb.slot_count();  // arrays of the point's index, X, Y and Z
    const auto lists = downloaded<float>(session, stages.izb.lists().get(), IZB_WORDS * stride);
    std::vector<ListedPoint> points;
    for (std::uint32_t i = 0; i < offsets.back(); ++i)
        if (const auto id = std::bit_cast<std::uint32_t>(lists[i]); id != GN_NO_ID) {
            const auto list = std::uint32_t(std::ranges::upper_bound(offsets, i) - offsets.begin() - 1);
            points.push_back({id, list >> 2 * bin_log2, list & ((1u << 2 * bin_log2) - 1), lists[stride + i],
                              lists[2 * stride + i], lists[3 * stride + i]});
        }
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return points;
}

/// Coordinate `word` of entry `lane` of a block of entries (kernels/occluders/bin_lists.h: lane by lane, coordinate by
/// coordinate).
std::uint16_t entry_word(const std::vector<std::uint16_t>& entries, std::size_t block, std::uint32_t word,
                         std::uint32_t lane, std::uint32_t lanes) {
    return entries[(block * 8 + word) * lanes + lane];
}

std::vector<std::vector<std::uint32_t>> read_references(Session& session, const LightStages& stages,
                                                        std::uint32_t bin_count, const gnomon::FrameCounters& counted) {
    const std::uint32_t lanes = session.lanes();
    const auto ranges = downloaded<std::uint32_t>(session, stages.lists.bins().ranges().get(), 2 * bin_count);
    const auto entries = downloaded<std::uint16_t>(session, stages.lists.bins().entries().get(),
                                                   std::size_t(counted.entries) * lanes * BIN_ENTRY_BYTES / 2);
    const auto bounds = downloaded<gnomon::TriangleBounds>(session, stages.lists.setup().bounds().get(), counted.slots);
    std::vector<std::vector<std::uint32_t>> lists(bin_count);
    for (std::uint32_t bin = 0; bin < bin_count; ++bin) {
        for (std::uint32_t block = ranges[2 * bin]; block < ranges[2 * bin + 1]; ++block)
            for (std::uint32_t lane = 0; lane < lanes; ++lane) {
                const auto word = [&](std::uint32_t i) { return entry_word(entries, block, i, lane, lanes); };
                if (word(0) > word(2)) continue;  // unused
                std::uint32_t slot;
                std::memcpy(&slot, &entries[(std::size_t(block) * 8 + 6) * lanes + 2 * lane], sizeof(slot));
                const gnomon::TriangleBounds& of = bounds.at(slot);
                EXPECT_TRUE(word(0) == of.x0 && word(1) == of.y0 && word(2) == of.x1 && word(3) == of.y1 &&
                            word(4) == of.z);
                lists[bin].push_back(of.id);
            }
        std::sort(lists[bin].begin(), lists[bin].end());
    }
    return lists;
}

}  // namespace

bool is_dropped(const gnomon::TriangleBounds& bounds) { return bounds.x0 > bounds.x1; }

BinRange bins_of(const gnomon::TriangleBounds& bounds, const gnomon::Projection& projection) {
    // The first and the last texel with a coordinate that may have been rounded to this whole number.
    const auto first = [&](std::uint32_t q, std::uint32_t texels) { return (q > 0 ? q - 1 : 0) / (65536 / texels); };
    const auto last = [&](std::uint32_t q, std::uint32_t texels) {
        return std::min(q / (65536 / texels), texels - 1) >> projection.bin_log2;
    };
    return {first(bounds.x0, projection.width) >> projection.bin_log2,
            first(bounds.y0, projection.height) >> projection.bin_log2, last(bounds.x1, projection.width),
            last(bounds.y1, projection.height)};
}

std::vector<gnomon::LightFrame> light_frames(const gnomon::Light& light, const gnomon::FrameGrid& grid) {
    const gnomon::LightFrame first = gnomon::make_light_frame(light, grid);
    std::vector<gnomon::LightFrame> frames(gnomon::frame_count_of(first), first);
    if (first.perspective != 0)
        for (std::uint32_t face = 0; face < frames.size(); ++face) {
            frames[face].axis_z = face / 2;
            frames[face].axis_x = (face / 2 + 1) % 3;
            frames[face].axis_y = (face / 2 + 2) % 3;
            frames[face].sign_z = face % 2 == 0 ? 1.0f : -1.0f;
        }
    return frames;
}

UploadedScene::UploadedScene(const gnomon::Device& device, const LightScene& scene)
    : triangles(gnomon::Triangles::upload(device, scene.triangles)),
      points(gnomon::Internals::seen_from(upload_points(device, scene), scene.eye)),
      light{scene.light},
      visibility(session_of(device), scene.points.size() / 3 * sizeof(float)),
      counters(session_of(device), sizeof(gnomon::FrameCounters)) {
    session_of(device).fill(counters, 0, sizeof(gnomon::FrameCounters));
    facing.run(session_of(device), gnomon::make_light_frame(light, StageSettings{}.grid), triangle_inputs(),
               point_inputs(), visibility.get(), counters);
}

namespace {

/// The traversal of izb from the same state on: lists the points, and must give `expected`.
void run_izb(Session& session, LightStages& stages, const UploadedScene& scene, const gnomon::TraceInputs& inputs,
             const gnomon::FrameCounters& counted, FrameOutput& out, const std::vector<float>& expected) {
    session.write(inputs.visibility, out.visibility_before.data(), out.visibility_before.size() * sizeof(float));
    session.write(scene.counters.get(), &counted, sizeof(counted));
    stages.izb.run(session, inputs);
    out.visibility_after_izb = downloaded<float>(session, inputs.visibility, scene.points.count());
    session.read(scene.counters.get(), &out.izb_counters, sizeof(out.izb_counters));
    out.points = read_points(session, stages, out.frame);
    stages.izb.trace(session, inputs, stages.lists.bins(), stages.trace);
    out.points_left = read_points(session, stages, out.frame);
    out.visibility_after_izb_trace = downloaded<float>(session, inputs.visibility, scene.points.count());
    stages.trace.decide_queue(session, inputs);
    EXPECT_EQ(downloaded<float>(session, inputs.visibility, scene.points.count()), expected)
        << "triangles over points and points over triangles differ";
}

}  // namespace

bool run_stages_once(Session& session, LightStages& stages, const UploadedScene& scene, const StageSettings& settings,
                     FrameOutput& out) {
    const gnomon::TriangleInputs triangles = scene.triangle_inputs();
    const gnomon::PointInputs points = scene.point_inputs();
    const cl_mem visibility = scene.visibility.get();
    const gnomon::LightFrame first_frame = gnomon::make_light_frame(scene.light, settings.grid);
    const std::uint32_t face = first_frame.perspective != 0 ? 2 * out.frame.axis_z + (out.frame.sign_z < 0) : 0;
    session.fill(scene.counters, 0, sizeof(gnomon::FrameCounters));
    stages.light_frame.run(session, first_frame, scene.facing.frame_bounds());
    out.projection = downloaded<gnomon::Projection>(session, stages.light_frame.projections().get(), face + 1).at(face);
    if (out.projection.active_points == 0) return true;
    stages.projection.reserve(session, sizeof(gnomon::Projection));
    session.write(stages.projection.get(), &out.projection, sizeof(out.projection));
    out.visibility_before = downloaded<float>(session, visibility, scene.points.count());
    stages.receiver_depth_pyramid.run(session, first_frame, face, 1, points, stages.projection, scene.facing.blocks(),
                                      visibility);
    gnomon::Statistics statistics;
    const Buffer* map = stages.lists.run(session, statistics, first_frame, stages.projection, triangles,
                                         {settings.with_map, false, settings.cover_test}, stages.receiver_depth_pyramid,
                                         scene.counters);
    gnomon::FrameCounters listed{};
    session.read(scene.counters.get(), &listed, sizeof(listed));
    const gnomon::TraceInputs inputs{first_frame, face,
                                     1,           triangles,
                                     points,      stages.projection,
                                     map,         gnomon::list_buffers(stages.lists.bins(), stages.lists.setup()),
                                     visibility,  scene.counters};
    stages.trace.run(session, gnomon::Task::trace, inputs, scene.facing.blocks());
    stages.trace.decide_queue(session, inputs);
    session.read(scene.counters.get(), &out.counters, sizeof(out.counters));
    if (!stages.lists.fitted(session, out.counters)) return false;
    if (!stages.trace.fitted(session, points, out.counters)) {
        stages.trace.run(session, gnomon::Task::trace_queue_overflow, inputs, nullptr);
        session.read(scene.counters.get(), &out.counters, sizeof(out.counters));
    }
    out.visibility = downloaded<float>(session, visibility, scene.points.count());
    run_izb(session, stages, scene, inputs, listed, out, out.visibility);
    return true;
}

std::vector<FrameOutput> run_light_stages(const gnomon::Device& device, const LightScene& scene,
                                          const StageSettings& settings, LightStages* kept) {
    Session& session = session_of(device);
    const UploadedScene uploaded_scene(device, scene);
    LightStages own;
    LightStages& stages = kept != nullptr ? *kept : own;
    if (settings.first_capacity != 0) {
        stages.lists.limit_initial_capacity(settings.first_capacity);
        stages.trace.limit_initial_capacity(settings.first_capacity);
    }
    std::vector<FrameOutput> outputs;
    for (const gnomon::LightFrame& frame : light_frames(uploaded_scene.light, settings.grid)) {
        FrameOutput out{};
        out.frame = frame;
        const std::uint32_t bin_count = frame.bins_x * frame.bins_y;
        while (!run_stages_once(session, stages, uploaded_scene, settings, out)) {
        }
        if (out.projection.active_points == 0) continue;
        out.pyramid =
            downloaded<std::uint32_t>(session, stages.receiver_depth_pyramid.pyramid().get(), pyramid_cells(frame));
        out.self_shadow_depths =
            downloaded<std::uint32_t>(session, stages.receiver_depth_pyramid.self_shadow_depths().get(), bin_count);
        out.depth_after_map =
            downloaded<std::uint32_t>(session, stages.receiver_depth_pyramid.depth_after_map().get(), bin_count);
        out.triangles = read_triangles(session, stages, out.counters, out.projection);
        if (settings.with_map)
            out.map = downloaded<std::uint32_t>(session, stages.lists.map().map().get(), frame.width * frame.height);
        out.references = read_references(session, stages, bin_count, out.counters);
        outputs.push_back(std::move(out));
    }
    return outputs;
}

}  // namespace support
