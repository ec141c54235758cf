// SPDX-License-Identifier: MIT
#include "techniques/sub_pixel_shadow_map.hpp"

namespace gnomon {

const SettingsTable<SubPixelShadowMap::Settings>& SubPixelShadowMap::settings_table() {
    static const SettingsTable<Settings> table{
        {{"neighbours", "on", "on or off: test the triangles of the 8 texels around the point's as well"},
         setting::on_off(&Settings::neighbours)},
        {{"map-size", "1024", "texels per side of the light's grid, 16 to 8192"},
         setting::whole(&Settings::map_size, 16, 8192)},
    };
    return table;
}

bool SubPixelShadowMap::list_triangles(Run& run) {
    cl::Session& session = device_.session();
    cl::StageTimer timer(session, run.statistics, "triangle_setup");
    session.fill(counters_, 0, sizeof(FrameCounters));
    setup_.run_bounds(session, frames_.projection(), run.triangles, nullptr, nullptr, counters_);
    setup_.run_tiles(session, frames_.projection(), run.triangles, nullptr, nullptr, counters_);
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
    SubPixelParams params{};
    params.tile_capacity = setup_.tiles().capacity();
    for (params.stores_ids = 0; params.stores_ids < 2; ++params.stores_ids)
        session.launch("techniques/sub_pixel_shadow_map.cl", "sub_pixel_draw", cl::Range::items(params.tile_capacity),
                       params, frames_.projection(), setup_.records(), setup_.bounds(), setup_.tiles().buffer(),
                       counters_, heights_, ids_, map_counters_);
}

void SubPixelShadowMap::decide_points(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    SubPixelParams params{};
    params.first_float = run.triangles.first_float;
    params.frame = frame;
    params.reach = settings_.neighbours;
    params.light_frame = run.light_frame;
    params.layout = run.points.layout;
    session.launch("techniques/sub_pixel_shadow_map.cl", "sub_pixel_lookup",
                   cl::Range::items(params.layout.count / session.lanes() + 1), params, frames_.projection(),
                   run.points.positions, run.points.receivers, run.triangles.vertices, ids_, run.visibility,
                   map_counters_);
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
    texels_ += std::uint64_t(run.light_frame.width) * run.light_frame.height;
    texels_with_triangle_ += map.texels;
    run.in_shadow += map.in_shadow;
}

void SubPixelShadowMap::begin_counts() {
    map_counters_.reserve(device_.session(), sizeof(SubPixelCounters));
    texels_ = texels_with_triangle_ = 0;
}

void SubPixelShadowMap::add_counts(Run& run) const {
    run.statistics.counts.emplace_back("texels", texels_);
    run.statistics.counts.emplace_back("texels_with_triangle", texels_with_triangle_);
}

TechniqueDescription SubPixelShadowMap::describe() {
    return {"sub-pixel",
            "sub-pixel shadow mapping (Lecocq et al. 2014): the map stores triangles, which lookups test exactly",
            false, settings_table().descriptions()};
}

}  // namespace gnomon
