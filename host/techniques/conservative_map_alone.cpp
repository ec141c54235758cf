// SPDX-License-Identifier: MIT
#include "techniques/conservative_map_alone.hpp"

#include "api/setting_values.hpp"

namespace gnomon {

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
        map_.run(session, run.light_frame, frames_.projection(), setup_, receiver_depth_pyramid_.pyramid(), cover_test_,
                 counters_);
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
