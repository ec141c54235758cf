// SPDX-License-Identifier: MIT
#include "light_stages.hpp"

#include <algorithm>
#include <bit>

namespace support {
namespace {

using gnomon::cl::Buffer;
using gnomon::cl::Session;

gnomon::Points upload_points(const gnomon::Device& device, const LightScene& scene) {
    gnomon::Points points = gnomon::Points::upload(device, scene.points, scene.receivers);
    if (scene.eye) points.set_eye(*scene.eye);
    return points;
}

std::size_t pyramid_cells(const gnomon::LightFrame& frame) {
    std::size_t cells = 0;
    for (std::uint32_t w = frame.bins_x, h = frame.bins_y;; w = (w + 1) / 2, h = (h + 1) / 2) {
        cells += std::size_t(w) * h;
        if (w == 1 && h == 1) return cells;
    }
}

std::vector<SetUpTriangle> read_triangles(Session& session, const LightStages& stages,
                                          const gnomon::FrameCounters& counted, const gnomon::Projection& projection) {
    const auto records = downloaded<gnomon::TriangleRecord>(session, stages.setup.records().get(), counted.slots);
    const auto bounds = downloaded<gnomon::TriangleBounds>(session, stages.setup.bounds().get(), counted.slots);
    std::vector<SetUpTriangle> triangles;
    for (std::size_t i = 0; i < records.size(); ++i)
        if (!is_dropped(bounds[i])) triangles.push_back({bounds[i].id, records[i], bins_of(bounds[i], projection)});
    std::sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return triangles;
}

std::vector<ListedPoint> read_points(Session& session, const LightStages& stages, std::uint32_t bin_count) {
    const auto offsets = downloaded<std::uint32_t>(session, stages.izb.offsets().get(), bin_count + 1);
    const std::size_t slots = offsets[bin_count];
    const auto x = downloaded<float>(session, stages.izb.x().get(), slots);
    const auto y = downloaded<float>(session, stages.izb.y().get(), slots);
    const auto z = downloaded<float>(session, stages.izb.z().get(), slots);
    const auto order = downloaded<std::uint32_t>(session, stages.izb.order().get(), slots);
    std::vector<ListedPoint> points;
    for (std::uint32_t bin = 0; bin < bin_count; ++bin)
        for (std::size_t i = offsets[bin]; i < offsets[bin + 1]; ++i)
            if (order[i] != GN_NO_ID) points.push_back({order[i], bin, x[i], y[i], z[i]});
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return points;
}

std::vector<std::vector<std::uint32_t>> read_references(Session& session, const LightStages& stages,
                                                        std::uint32_t bin_count, const gnomon::FrameCounters& counted) {
    const auto offsets = downloaded<std::uint32_t>(session, stages.bins.offsets().get(), bin_count + 1);
    const auto slots = downloaded<std::uint32_t>(session, stages.bins.references().get(), counted.references);
    const auto bounds = downloaded<gnomon::TriangleBounds>(session, stages.setup.bounds().get(), counted.slots);
    std::vector<std::vector<std::uint32_t>> lists(bin_count);
    for (std::uint32_t bin = 0; bin < bin_count; ++bin) {
        for (std::uint32_t i = offsets[bin]; i < offsets[bin + 1]; ++i) lists[bin].push_back(bounds[slots[i]].id);
        std::sort(lists[bin].begin(), lists[bin].end());
    }
    return lists;
}

}  // namespace

bool is_dropped(const gnomon::TriangleBounds& bounds) { return bounds.x0 > bounds.x1; }

BinRange bins_of(const gnomon::TriangleBounds& bounds, const gnomon::Projection& projection) {
    // The first texel of which a coordinate may have been rounded to this whole number, and the last.
    const auto first = [&](std::uint32_t q, std::uint32_t texels) { return (q > 0 ? q - 1 : 0) / (65536 / texels); };
    const auto last = [&](std::uint32_t q, std::uint32_t texels) {
        return std::min(q / (65536 / texels), texels - 1) >> projection.bin_log2;
    };
    return {first(bounds.x0, projection.width) >> projection.bin_log2,
            first(bounds.y0, projection.height) >> projection.bin_log2, last(bounds.x1, projection.width),
            last(bounds.y1, projection.height)};
}

UploadedScene::UploadedScene(const gnomon::Device& device, const LightScene& scene)
    : triangles(gnomon::Triangles::upload(device, scene.triangles)),
      points(upload_points(device, scene)),
      light{scene.light},
      visibility(device.session(), scene.points.size() / 3 * sizeof(float)),
      counters(device.session(), sizeof(gnomon::FrameCounters)) {
    device.session().fill(visibility, std::bit_cast<std::uint32_t>(1.0f), scene.points.size() / 3 * sizeof(float));
    device.session().fill(counters, 0, sizeof(gnomon::FrameCounters));
}

bool run_stages_once(Session& session, LightStages& stages, const UploadedScene& scene, const StageSettings& settings,
                     FrameOutput& out) {
    const gnomon::TriangleInputs triangles = scene.triangle_inputs();
    const gnomon::PointInputs points = scene.point_inputs();
    const cl_mem visibility = scene.visibility.get();
    const Buffer& projection = stages.light_frame.projection();
    const std::uint32_t bin_count = out.frame.bins_x * out.frame.bins_y;
    session.fill(scene.counters, 0, sizeof(gnomon::FrameCounters));
    stages.light_frame.run(session, out.frame, points, visibility);
    session.read(projection.get(), &out.projection, sizeof(out.projection));
    if (out.projection.active_points == 0) return true;
    stages.farthest_height.run(session, out.frame, points, projection, visibility);
    stages.setup.run_bounds(session, projection, triangles, &stages.farthest_height.pyramid(), scene.counters);
    if (settings.with_map) {
        stages.setup.run_map_tiles(session, projection, triangles, stages.farthest_height.pyramid(), scene.counters);
        stages.map.run(session, out.frame, projection, stages.setup, stages.farthest_height.pyramid(),
                       settings.cover_test, scene.counters);
    }
    stages.izb.run(session, out.frame, triangles, points, projection, settings.with_map ? &stages.map.map() : nullptr,
                   visibility, scene.counters);
    out.visibility_after_izb = downloaded<float>(session, visibility, scene.points.count());
    stages.bins.run_heights(session, out.frame.bins_x, out.frame.bins_y, stages.izb.farthest());
    stages.setup.run_tiles(session, projection, triangles, &stages.bins.heights(), scene.counters);
    stages.bins.run(session, projection, bin_count, stages.setup, true, scene.counters);
    stages.trace.run(session, out.frame, points, stages.izb, stages.bins, stages.setup, visibility, scene.counters);
    gnomon::run_exact_trace(session, triangles, points, scene.light, stages.trace, visibility, scene.counters);
    session.read(scene.counters.get(), &out.counters, sizeof(out.counters));
    const bool setup = stages.setup.fitted(session, out.counters);
    const bool references = stages.bins.fitted(session, out.counters, setup);
    const bool pairs = stages.trace.fitted(session, out.counters);
    return setup && references && pairs;
}

std::vector<FrameOutput> run_light_stages(const gnomon::Device& device, const LightScene& scene,
                                          const StageSettings& settings) {
    Session& session = device.session();
    const UploadedScene uploaded_scene(device, scene);
    gnomon::run_facing(session, uploaded_scene.triangle_inputs(), uploaded_scene.point_inputs(), uploaded_scene.light,
                       uploaded_scene.visibility.get(), uploaded_scene.counters);
    LightStages stages;
    if (settings.first_capacity != 0) {
        stages.setup.limit_initial_capacity(settings.first_capacity);
        stages.bins.limit_initial_capacity(settings.first_capacity);
        stages.trace.limit_initial_capacity(settings.first_capacity);
    }
    std::vector<FrameOutput> outputs;
    for (const gnomon::LightFrame& frame : gnomon::light_frames(uploaded_scene.light, settings.grid)) {
        FrameOutput out{};
        out.frame = frame;
        const std::uint32_t bin_count = frame.bins_x * frame.bins_y;
        // A repeated pass starts from where the first one did, so that its outputs speak of all points.
        const auto before = downloaded<float>(session, uploaded_scene.visibility.get(), uploaded_scene.points.count());
        while (!run_stages_once(session, stages, uploaded_scene, settings, out))
            session.write(uploaded_scene.visibility.get(), before.data(), before.size() * sizeof(float));
        if (out.projection.active_points == 0) continue;
        out.pyramid = downloaded<std::uint32_t>(session, stages.farthest_height.pyramid().get(), pyramid_cells(frame));
        out.triangles = read_triangles(session, stages, out.counters, out.projection);
        if (settings.with_map)
            out.map = downloaded<std::uint32_t>(session, stages.map.map().get(), frame.width * frame.height);
        out.points = read_points(session, stages, bin_count);
        out.farthest = downloaded<std::uint32_t>(session, stages.izb.farthest().get(), bin_count);
        out.references = read_references(session, stages, bin_count, out.counters);
        out.visibility = downloaded<float>(session, uploaded_scene.visibility.get(), uploaded_scene.points.count());
        outputs.push_back(std::move(out));
    }
    return outputs;
}

}  // namespace support
