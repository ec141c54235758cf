// SPDX-License-Identifier: MIT
#include "sub_pixel_shadow_map.hpp"

#include "shadow_map/setting_values.hpp"

namespace gnomon {

struct SubPixelShadowMap::Run {
    TriangleInputs triangles;
    PointInputs points;
    LightFrame light_frame;
    cl_mem visibility;
    Statistics statistics{};
    SubPixelCounters total{};  ///< over the frames
    std::uint64_t frames = 0, grown = 0;
};

namespace {

constexpr std::string_view off_on[] = {"off", "on"};

}  // namespace

bool SubPixelShadowMap::list_triangles(Run& run) {
    cl::Session& session = device_.session();
    cl::StageTimer timer(session, run.statistics, "triangle_setup");
    session.fill(counters_, 0, sizeof(FrameCounters));
    setup_.run_bounds(session, frames_.projection(), run.triangles, nullptr, nullptr, counters_);
    setup_.run_tiles(session, frames_.projection(), run.triangles, nullptr, counters_);
    return setup_.fitted(session, session.read_value<FrameCounters>(counters_));
}

void SubPixelShadowMap::draw(Run& run) {
    cl::Session& session = device_.session();
    const std::size_t bytes = std::size_t(run.light_frame.width) * run.light_frame.height * sizeof(cl_uint);
    heights_.reserve(session, bytes);
    ids_.reserve(session, bytes);
    session.fill(heights_, 0, bytes);
    session.fill(ids_, GN_NO_ID, bytes);
    session.fill(map_counters_, 0, sizeof(SubPixelCounters));
    for (const cl_uint stores_ids : {0u, 1u})
        session.launch("sub_pixel_shadow_map.cl", "sub_pixel_draw", cl::Range::items(setup_.tiles().capacity()),
                       frames_.projection(), setup_.tiles().capacity(), stores_ids, setup_.records(), setup_.bounds(),
                       setup_.tiles().buffer(), counters_, heights_, ids_, map_counters_);
}

void SubPixelShadowMap::decide_points(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    const cl_uint reach = neighbours_;
    session.launch("sub_pixel_shadow_map.cl", "sub_pixel_lookup",
                   cl::Range::items(run.points.layout.count / session.lanes() + 1), run.light_frame, frame,
                   run.points.layout, frames_.projection(), reach, run.triangles.first_float, run.points.positions,
                   run.points.receivers, run.triangles.vertices, ids_, run.visibility, map_counters_);
}

void SubPixelShadowMap::run_frame(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    while (!list_triangles(run)) ++run.grown;
    {
        cl::StageTimer timer(session, run.statistics, "sub_pixel_draw");
        draw(run);
    }
    {
        cl::StageTimer timer(session, run.statistics, "sub_pixel_lookup");
        decide_points(run, frame);
    }
    const auto map = session.read_value<SubPixelCounters>(map_counters_);
    run.total.texels += map.texels;
    run.total.in_shadow += map.in_shadow;
    ++run.frames;
}

Statistics SubPixelShadowMap::run(const Triangles& triangles, const Points& points, const Light& light,
                                  const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    const auto start = std::chrono::steady_clock::now();
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    Run run{triangle_inputs(triangles), point_inputs(points), make_light_frame(light, {map_size_, 0}),
            visibility.buffer()};
    counters_.reserve(session, sizeof(FrameCounters));
    map_counters_.reserve(session, sizeof(SubPixelCounters));
    const FrameCounters facing = frames_.run(session, run.statistics, run.light_frame, run.triangles, run.points,
                                             run.visibility, counters_, [&](cl_uint frame) { run_frame(run, frame); });

    Statistics& s = run.statistics;
    s.counts = {{"points", points.count()},
                {"points_absent", facing.absent},
                {"points_facing_away", facing.facing_away},
                {"points_in_shadow", std::uint64_t(facing.facing_away) + run.total.in_shadow},
                {"triangles", triangles.count()},
                {"frames", run.frames},
                {"texels", run.frames * map_size_ * map_size_},
                {"texels_with_triangle", run.total.texels},
                {"lists_grown", run.grown}};
    s.device_memory_bytes = memory.peak_bytes();
    s.total_wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return s;
}

void SubPixelShadowMap::set(std::string_view name, std::string_view value) {
    if (name == "neighbours")
        neighbours_ = choice_setting(name, value, off_on) == 1;
    else if (name == "map-size")
        map_size_ = whole_setting(name, value, 16, 8192);
    else
        throw InvalidArgument("sub-pixel has no setting \"" + std::string(name) + "\": it has neighbours and map-size");
}

TechniqueDescription SubPixelShadowMap::describe() {
    return {"sub-pixel",
            "sub-pixel shadow mapping (Lecocq et al. 2014): the map stores triangles, which lookups test exactly",
            false,
            {{"neighbours", "on", "on or off: ask the triangles of the 8 texels around the point's as well"},
             {"map-size", "1024", "texels per side of the light's grid, 16 to 8192"}}};
}

}  // namespace gnomon
