// SPDX-License-Identifier: MIT
#include "rivals/framed_technique.hpp"

#include <algorithm>

namespace gnomon {
namespace {

const SettingsTable<FramedSettings>& all_settings() {
    using S = FramedSettings;
    static const SettingsTable<S> table{
        {{"conservative-map", "on", "on or off: decide points behind triangles that cover a whole texel at once"},
         setting::on_off(&S::draws_map)},
        {{"neighbours", "on", "on or off: test the triangles of the 8 texels around the point's as well"},
         setting::on_off(&S::neighbours)},
        {{"cover-test", "tight", cover_test_help}, setting::choice(&S::cover_test, cover_test_names)},
        {{"map-size", "1024", "texels per side of the light's grid, 16 to 8192"},
         setting::whole(&S::map_size, smallest_map_size, largest_map_size)},
    };
    return table;
}

auto named(std::string_view name) {
    return [name](const SettingDescription& setting) { return setting.name == name; };
}

}  // namespace

FramedTechnique::FramedTechnique(const Device& device, TechniqueDescription description)
    : device_(device),
      session_(session_of(device)),
      settings_(all_settings().defaults()),
      description_(std::move(description)) {}

std::vector<SettingDescription> FramedTechnique::settings(std::initializer_list<std::string_view> names) {
    const std::vector<SettingDescription> all = all_settings().descriptions();
    std::vector<SettingDescription> some;
    for (const std::string_view name : names) some.push_back(*std::find_if(all.begin(), all.end(), named(name)));
    return some;
}

void FramedTechnique::set(std::string_view name, std::string_view value) {
    const auto& own = description_.settings;
    if (std::none_of(own.begin(), own.end(), named(name))) throw_no_setting(description_.name, name, own);
    all_settings().set_if_known(settings_, name, value);
}

FramedParams FramedTechnique::params_of(const Run& run, cl_uint frame) const {
    return {.triangles = run.triangles,
            .light_frame = run.light_frame,
            .layout = run.points.layout,
            .frame = frame,
            .padding = 0};
}

void FramedTechnique::list_triangles(Run& run, bool for_map) {
    const cl::Buffer* pyramid = for_map ? &frames_.receiver_depths().pyramid() : nullptr;
    for (;; ++run.grown) {
        cl::StageTimer timer(session_, run.statistics, "triangle_setup");
        session_.fill(counters_, 0, sizeof(FrameCounters));
        setup_.run_bounds(session_, frames_.projection(), run.triangles, nullptr, pyramid, counters_);
        if (for_map)
            setup_.run_map_tiles(session_, frames_.projection(), run.triangles, *pyramid, counters_);
        else
            setup_.run_tiles(session_, frames_.projection(), run.triangles, nullptr, nullptr, counters_);
        if (setup_.fitted(session_, session_.read_value<FrameCounters>(counters_))) return;
    }
}

Statistics FramedTechnique::run_light(const Triangles& triangles, const Points& points, const Light& light,
                                      const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    MeasuredRun measured(session_, kept_bytes_);
    Run run{{triangle_inputs(triangles), point_inputs(points, triangles), make_light_frame(light, grid()),
             visibility.buffer()}};
    counters_.reserve(session_, sizeof(FrameCounters));
    FrameCounters facing{};
    if (points.count() != 0) {
        frames_.start_facing(session_, run.statistics, run, counters_);
        facing = session_.read_value<FrameCounters>(counters_);
        if (triangles.count() != 0)
            frames_.for_each(session_, run.statistics, run.light_frame, [&](cl_uint frame) {
                const FrameCounters counted = run_frame(run, frame);
                add_counters(run.counted, counted);
                run.tests += counted.tests_low + (std::uint64_t(counted.tests_high) << 32);
                ++run.frames;
            });
    }
    merge_stages(run.statistics);
    measured.stages = std::move(run.statistics);
    const FrameCounters& c = run.counted;
    decltype(Statistics::counts) counts{{"points", points.count()},
                                        {"points_absent", facing.absent},
                                        {"points_facing_away", facing.facing_away},
                                        {"points_in_shadow", std::uint64_t(facing.facing_away) + c.decided_by_map +
                                                                 c.decided_by_trace + c.decided_by_exact},
                                        {"triangles", triangles.count()},
                                        {"frames", run.frames},
                                        {"lists_grown", run.grown}};
    for (auto& own : counts_of(run)) counts.push_back(std::move(own));
    return measured.finish(std::move(counts));
}

}  // namespace gnomon
