// SPDX-License-Identifier: MIT
#include "conservative_map_alone.hpp"

#include "shadow_map/setting_values.hpp"

namespace gnomon {

struct ConservativeMapAlone::Run {
    TriangleInputs triangles;
    PointInputs points;
    LightFrame light_frame;
    cl_mem visibility;
    Statistics statistics{};
    std::uint64_t frames = 0, grown = 0, map_candidates = 0, map_texels = 0, decided_by_map = 0;
};

bool ConservativeMapAlone::list_triangles(Run& run) {
    cl::Session& session = device_.session();
    cl::StageTimer timer(session, run.statistics, "triangle_setup");
    session.fill(counters_, 0, sizeof(FrameCounters));
    setup_.run_bounds(session, frames_.projection(), run.triangles, nullptr, &farthest_height_.pyramid(), counters_);
    setup_.run_map_tiles(session, frames_.projection(), run.triangles, farthest_height_.pyramid(), counters_);
    return setup_.fitted(session, session.read_value<FrameCounters>(counters_));
}

void ConservativeMapAlone::run_frame(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    {
        cl::StageTimer timer(session, run.statistics, "farthest_height");
        farthest_height_.run(session, run.light_frame, frame, 1, run.points, frames_.projection(), run.visibility);
    }
    while (!list_triangles(run)) ++run.grown;
    {
        cl::StageTimer timer(session, run.statistics, "conservative_map");
        map_.run(session, run.light_frame, frames_.projection(), setup_, farthest_height_.pyramid(), cover_test_,
                 counters_);
    }
    {
        cl::StageTimer timer(session, run.statistics, "lookup");
        session.launch("conservative_map_alone.cl", "conservative_map_lookup",
                       cl::Range::items(run.points.layout.count / session.lanes() + 1), run.light_frame, frame,
                       run.points.layout, frames_.projection(), run.points.positions, map_.map(), run.visibility,
                       counters_);
    }
    const auto counted = session.read_value<FrameCounters>(counters_);
    run.map_candidates += counted.map_candidates;
    run.map_texels += counted.map_texels;
    run.decided_by_map += counted.decided_by_map;
    ++run.frames;
}

Statistics ConservativeMapAlone::run(const Triangles& triangles, const Points& points, const Light& light,
                                     const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    const auto start = std::chrono::steady_clock::now();
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    Run run{triangle_inputs(triangles), point_inputs(points), make_light_frame(light, binned(session, map_size_)),
            visibility.buffer()};
    counters_.reserve(session, sizeof(FrameCounters));
    const FrameCounters facing = frames_.run(session, run.statistics, run.light_frame, run.triangles, run.points,
                                             run.visibility, counters_, [&](cl_uint frame) { run_frame(run, frame); });
    Statistics& s = run.statistics;
    s.counts = {{"points", points.count()},
                {"points_absent", facing.absent},
                {"points_facing_away", facing.facing_away},
                {"points_decided_by_map", run.decided_by_map},
                {"points_in_shadow", facing.facing_away + run.decided_by_map},
                {"triangles", triangles.count()},
                {"frames", run.frames},
                {"map_candidates", run.map_candidates},
                {"map_texels_written", run.map_texels},
                {"lists_grown", run.grown}};
    s.device_memory_bytes = memory.peak_bytes();
    s.total_wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return s;
}

void ConservativeMapAlone::set(std::string_view name, std::string_view value) {
    if (name == "cover-test")
        cover_test_ = static_cast<CoverTest>(choice_setting(name, value, cover_test_names));
    else if (name == "map-size")
        map_size_ = whole_setting(name, value, 16, 8192);
    else
        throw InvalidArgument("conservative-map has no setting \"" + std::string(name) +
                              "\": it has cover-test and map-size");
}

TechniqueDescription ConservativeMapAlone::describe() {
    return {"conservative-map",
            "conservative shadow map (Mizoguchi and Tokuyoshi): never wrongly dark, lit wherever it proves nothing",
            false,
            {{"cover-test", "tight",
              "tight (Mizoguchi and Tokuyoshi) or circle (Hertel et al. 2009): when a texel counts as covered"},
             {"map-size", "1024", "texels per side of the light's grid, 16 to 8192"}}};
}

}  // namespace gnomon
