// SPDX-License-Identifier: MIT
// Technique frustum-traced: exact hard shadows. Its roles are objects of their own: one light (trace/frustum_tracer), a
// prepared light (prepared/prepared_runs), tables of lights (light_tables/light_tables). It lends the first two.
#include <limits>

#include "light_tables/light_tables.hpp"
#include "query/settings_table.hpp"
#include "technique/lent_stages.hpp"
#include "technique/registered.hpp"

namespace gnomon {
namespace {

struct Settings : TracerSettings {
    LightsMethod many_lights;
    std::uint32_t bundle_lights;
};

// In the order of MapMode.
constexpr std::string_view map_mode_names[] = {"on", "off", "auto"};

// In the order of SortPoints.
constexpr std::string_view sort_points_names[] = {"on", "off", "auto"};

const SettingsTable<Settings>& settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"conservative-map", "auto",
          "on, off or auto: decide points behind triangles that cover a whole texel at once"},
         setting::choice(&S::map_mode, map_mode_names)},
        {{"cover-test", "tight", cover_test_help}, setting::choice(&S::cover_test, cover_test_names)},
        {{"map-size", "auto", "texels per side of the light's grid, 16 to 8192, or auto"},
         setting::whole_or_auto(&S::map_size, smallest_map_size, largest_map_size)},
        {{"first-capacity", "auto", "entries that growing lists start with, from 1, or auto: for tests"},
         setting::whole_or_auto(&S::first_capacity, 1, std::numeric_limits<std::uint32_t>::max())},
        {{"sort-points", "auto",
          "on, off or auto: sort points that come in no order before they are traced (auto: on a CPU)"},
         setting::choice(&S::sort_points, sort_points_names)},
        {{"many-lights", "auto",
          "auto, one-by-one, beams, point-beams, rays (on a GPU point-beams), horizons (of height fields) or sweeps "
          "(of height fields in rows and columns): the way to decide many lights"},
         setting::choice(&S::many_lights, lights_method_names)},
        {{"bundle-lights", "32", "lights that a beam decides together, 1 to 32"},
         setting::whole(&S::bundle_lights, 1, MAX_BUNDLE_LIGHTS)},
    };
    return table;
}

class FrustumTraced final : public Technique, public LendsStages {
public:
    explicit FrustumTraced(const Device& device) : device_(device) {}
    const Device& device() const override { return device_; }

    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) override {
        require_run(triangles, points, light, visibility);
        return prepared_.run(triangles, point_inputs(points, triangles), light, visibility.buffer());
    }

    Statistics run_table(const Triangles& triangles, const Points& points, const Lights& lights,
                         const LightsOutputs& outputs, const LightsOptions& options) override {
        const bool is_empty = triangles.count() == 0 || points.count() == 0 || lights.count() == 0;
        const LightsRun run{device_, triangles, points, lights, outputs, options};
        if (is_empty || settings_.many_lights == LightsMethod::one_by_one ||
            (settings_.many_lights == LightsMethod::automatic && !LightTables::wants_tree(run)))
            return Technique::run_table(triangles, points, lights, outputs, options);
        return light_tables_.run(*this, run, settings_.many_lights, settings_.bundle_lights);
    }

    LentStages lent_stages() override { return {tracer_, prepared_, kept_by_borrower_}; }

    Statistics prepare(const Triangles& triangles, const Light& light) override {
        require_light(light);
        release_prepared_light();
        return triangles.count() != 0 ? prepared_.prepare(triangles, light) : Statistics{};
    }

    void release_prepared_light() override {
        const MeasuredRun freed(session_of(device_), tracer_.kept_bytes());
        prepared_.release();
        light_tables_.release();
    }

    void set(std::string_view name, std::string_view value) override {
        release_prepared_light();
        settings_table().set(settings_, "frustum-traced", name, value);
        tracer_.set(settings_);
    }

    /// "decided": the provenance of each point, whether or not a camera made the points.
    std::vector<std::uint8_t> draw_diagnostic(std::string_view name, const Triangles& triangles, const Points& points,
                                              const Light& light) override {
        if (name != "decided") return Technique::draw_diagnostic(name, triangles, points, light);
        const Visibility visibility(device_, points.count());
        const std::vector<std::uint32_t> provenance = tracer_.run_watched(triangles, points, light, visibility);
        return provenance_colors(provenance, visibility.read());
    }

    static TechniqueDescription describe() {
        return {"frustum-traced",
                "exact hard shadows: points are traced over lists of the triangles that may block them, with a "
                "conservative map",
                true,
                settings_table().descriptions(),
                {{"decided",
                  "what decided each point: pale and blue the filter, dark blue the map, green to red the exact "
                  "predicate; docs/techniques.md has the legend"}}};
    }

private:
    Device device_;
    Settings settings_ = settings_table().defaults();
    FrustumTracer tracer_{device_};
    PreparedRuns prepared_{tracer_};
    std::shared_ptr<void> kept_by_borrower_;
    LightTables light_tables_{device_, tracer_.kept_bytes()};
};

}  // namespace

Registered frustum_traced_technique() { return registered<FrustumTraced>(); }

}  // namespace gnomon
