// SPDX-License-Identifier: MIT
#include "techniques/conservative_map_alone.hpp"

namespace gnomon {

const SettingsTable<ConservativeMapAlone::Settings>& ConservativeMapAlone::settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"cover-test", "tight",
          "tight (Mizoguchi and Tokuyoshi) or circle (Hertel et al. 2009): when a texel counts as covered"},
         setting::choice(&S::cover_test, cover_test_names)},
        {{"map-size", "1024", "texels per side of the light's grid, 16 to 8192"},
         setting::whole(&S::map_size, 16, 8192)},
    };
    return table;
}

bool ConservativeMapAlone::list_triangles(Run& run) {
    cl::Session& session = device_.session();
    cl::StageTimer timer(session, run.statistics, "triangle_setup");
    session.fill(counters_, 0, sizeof(FrameCounters));
    setup_.run_bounds(session, frames_.projection(), run.triangles, nullptr, &receiver_depth_pyramid_.pyramid(),
                      counters_);
    setup_.run_map_tiles(session, frames_.projection(), run.triangles, receiver_depth_pyramid_.pyramid(), counters_);
    return setup_.fitted(session, session.read_value<FrameCounters>(counters_));
}

void ConservativeMapAlone::run_frame(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    {
        cl::StageTimer timer(session, run.statistics, "receiver_depth_pyramid");
        receiver_depth_pyramid_.run(session, run.light_frame, frame, 1, run.points, frames_.projection(),
                                    frames_.blocks(), run.visibility);
    }
    while (!list_triangles(run)) ++run.grown;
    {
        cl::StageTimer timer(session, run.statistics, "conservative_map");
        map_.run(session, run.light_frame, frames_.projection(), setup_, receiver_depth_pyramid_.pyramid(),
                 settings_.cover_test, counters_);
    }
    {
        cl::StageTimer timer(session, run.statistics, "lookup");
        session.launch("techniques/conservative_map_alone.cl", "conservative_map_lookup",
                       cl::Range::items(run.points.layout.count / session.lanes() + 1), run.light_frame, frame,
                       run.points.layout, frames_.projection(), run.points.positions, map_.map(), run.visibility,
                       counters_);
    }
    const auto counted = session.read_value<FrameCounters>(counters_);
    map_candidates_ += counted.map_candidates;
    map_texels_ += counted.map_texels;
    run.in_shadow += counted.decided_by_map;
}

void ConservativeMapAlone::add_counts(Run& run) const {
    run.statistics.counts.emplace_back("points_decided_by_map", run.in_shadow);
    run.statistics.counts.emplace_back("map_candidates", map_candidates_);
    run.statistics.counts.emplace_back("map_texels_written", map_texels_);
}

TechniqueDescription ConservativeMapAlone::describe() {
    return {"conservative-map",
            "conservative shadow map (Mizoguchi and Tokuyoshi): never wrongly dark, lit wherever it proves nothing",
            false, settings_table().descriptions()};
}

}  // namespace gnomon
