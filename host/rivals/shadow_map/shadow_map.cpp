// SPDX-License-Identifier: MIT
// Technique shadow-map: projection x partition x stored quantity x prefilter x lookup, each a setting of its own. Named
// compositions are in presets.hpp. The pipeline:
//
//   facing      decides backfacing points
//   fit         projection x partition: views fitted to the other points
//   depth_pass  the nearest caster per texel
//   moments     the stored quantity, where it is more than depth
//   prefilter   its means over neighbourhoods
//   lookup      visibility of the points that face the light
#include <algorithm>
#include <cmath>

#include "kernels/rivals/shadow_map/lookup.h"
#include "query/statistics.hpp"
#include "receivers/facing.hpp"
#include "rivals/rivals.hpp"
#include "rivals/shadow_map/diagnostic.hpp"
#include "rivals/shadow_map/map_projection.hpp"
#include "rivals/shadow_map/presets.hpp"
#include "rivals/shadow_map/stored_map.hpp"

namespace gnomon {
namespace {

/// The settings beside the fit. Depths are in units of the map's depth: 0 to 1 over the receivers.
struct Settings : StorePlan {
    enum class Bias : std::uint32_t { scaled, adaptive, dual };

    std::uint32_t size, filter_width, lookup, taps;
    Prefilter prefilter;
    float softness, light_size;
    Bias bias;
    float slope_bias, slope_limit, dual_limit;
    std::optional<float> set_moment_bias;  ///< none: the store's own
    bool all_bits;
};

// In the order of the constants' values.
constexpr std::string_view store_names[] = {"depth", "variance", "layered", "convolution", "exponential",
                                            "evsm2", "evsm4",    "ewgf",    "moments"};
constexpr std::string_view lookup_names[] = {"hard", "pcf", "bilinear", "gaussian", "twelve", "pcss", "pcss-grid"};
constexpr std::string_view prefilter_names[] = {"none", "gaussian", "summed-area", "mip"};
constexpr std::string_view bias_names[] = {"scaled", "adaptive", "dual"};
constexpr std::string_view bits_names[] = {"64", "128"};

const SettingsTable<Settings>& settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"size", "2048", "texels per side of each view, 16 to 16384"}, setting::whole(&S::size, 16, 16384)},
        {{"store", "depth",
          "what a texel holds: depth, variance, layered, convolution, exponential, evsm2, evsm4, ewgf or moments"},
         setting::choice(&S::store, store_names)},
        {{"prefilter", "none",
          "none, gaussian, summed-area (a box) or mip (as wide as a pixel is there): filters what is stored; not for "
          "depth"},
         setting::choice(&S::prefilter, prefilter_names)},
        {{"filter-width", "5",
          "texels across the prefilter (mip: needs none), 1 to 33; odd for the Gaussian (sigma = width / 4.5)"},
         setting::whole(&S::filter_width, 1, MAX_TAPS)},
        {{"lookup", "hard",
          "of depths: hard, pcf (mean of taps^2 texels), bilinear, gaussian (both smooth), twelve, pcss or pcss-grid "
          "(its taps on one grid: bands in place of noise)"},
         setting::choice(&S::lookup, lookup_names)},
        {{"taps", "3", "texels across the lookup's kernel, 1 to 33"}, setting::whole(&S::taps, 1, MAX_TAPS)},
        {{"softness", "1.5", "of lookup twelve: the deviation of its taps in texels, 0 to 100"},
         setting::number(&S::softness, 0, 100)},
        {{"light-size", "0.01",
          "of lookup pcss: a point light's size in world units; the tangent of a directional light's angle"},
         setting::number(&S::light_size, 0, 1e6)},
        {{"bias", "scaled",
          "scaled by the caster's slope, adaptive (the receiver's plane at each texel) or dual (between two layers)"},
         setting::choice(&S::bias, bias_names)},
        {{"constant-bias", "0.0001",
          "subtracted from the receiver's depth, 0 to 1; 1 is the receivers' depth range (pcss: to the casters), with "
          "bias=adaptive the scene's diagonal"},
         setting::number(&S::receiver_bias, 0, 1)},
        {{"slope-bias", "1.5", "of bias scaled: times the caster's depth per texel, 0 to 100"},
         setting::number(&S::slope_bias, 0, 100)},
        {{"slope-limit", "0.05", "most depth that slope-bias adds, 0 to 1"}, setting::number(&S::slope_limit, 0, 1)},
        {{"dual-limit", "0.05", "of bias dual: most depth behind the first layer, above 0 to 1"},
         setting::number(&S::dual_limit, 1e-7, 1)},
        {{"layers", "4", "of store layered: layers of depth, 1 to 16"}, setting::whole(&S::layers, 1, 16)},
        {{"terms", "16", "of store convolution: terms of the Fourier series, 1 to 16"},
         setting::whole(&S::terms, 1, 16)},
        {{"exponent", "40",
          "of stores exponential, evsm2, evsm4 and ewgf: c of exp(c z), 0.1 to 42; exponential to 80"},
         setting::number(&S::exponent, 0.1, 80)},
        {{"negative-exponent", "5", "of store evsm4: c of -exp(-c z), 0.1 to 42"},
         setting::number(&S::negative_exponent, 0.1, 42)},
        {{"bleeding", "0", "visibility below this becomes 0, the rest is stretched: against light bleeding, 0 to 0.99"},
         setting::number(&S::bleeding, 0, 0.99)},
        {{"threshold", "0", "of store exponential: subtracted from visibility before it is limited to 0 to 1, 0 to 1"},
         setting::number(&S::threshold, 0, 1)},
        {{"moment-bias", "auto",
          "of moments: share of a constant mixed in, 0 to 1; of the others: least deviation of depth; auto: the "
          "store's"},
         setting::number_or_auto(&S::set_moment_bias, 0, 1)},
        {{"bits", "128", "of store moments: 64 or 128 bits of memory per texel"},
         setting::choice(&S::all_bits, bits_names)},
        {{"edges-only", "off", "of store variance: on filters only where the four texels around a point disagree"},
         setting::on_off(&S::edges_only)},
    };
    return table;
}

class ShadowMap final : public Technique {
public:
    /// `name`: of the preset, for the texts of errors.
    explicit ShadowMap(const Device& device, std::string_view name = "shadow-map")
        : device_(device), session_(session_of(device)), name_(name) {}
    const Device& device() const override { return device_; }

    static TechniqueDescription describe() {
        TechniqueDescription description{
            "shadow-map", "shadow map of any composition: projection x partition x store x prefilter x lookup", false,
            settings_table().descriptions(), map_diagnostics()};
        for (SettingDescription& setting : ViewFit::settings()) description.settings.push_back(std::move(setting));
        return description;
    }

    void set(std::string_view name, std::string_view value) override {
        if (!settings_table().set_if_known(settings_, name, value) && !fit_.set(name, value))
            throw_no_setting(name_, name, describe().settings);
    }

    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) override {
        require_run(triangles, points, light, visibility);
        require_consistent();
        MeasuredRun measured(session_, kept_bytes_);
        FitInputs inputs{triangle_inputs(triangles), point_inputs(points, triangles), visibility.buffer(), light,
                         points.camera()};
        // These measure the distance to casters.
        inputs.keeps_casters = settings_.lookup >= LOOKUP_PCSS || settings_.bias == Settings::Bias::adaptive;
        map_views_.set = {};
        const FrameCounters facing = facing_.run_alone(session_, measured.stages, inputs.triangles, inputs.points,
                                                       light, inputs.visibility, counters_);
        if (points.count() != 0) {
            if (triangles.count() != 0 && facing.absent + facing.facing_away < points.count())
                run_stages(inputs, measured.stages);
            else
                measured.stages.stages.push_back(
                    {"depth_pass", 0, 0, "no point faces the light, or there are no triangles"});
        }
        session_.finish();
        depths_.grow(session_);
        return measured.finish({{"points", points.count()},
                                {"points_absent", facing.absent},
                                {"points_facing_away", facing.facing_away},
                                {"triangles", triangles.count()},
                                {"map_views", map_views_.set.view_count},
                                {"map_texels", map_views_.set.texels}});
    }

    std::vector<std::uint8_t> draw_diagnostic(std::string_view name, const Triangles& triangles, const Points& points,
                                              const Light& light) override {
        const auto& all = map_diagnostics();
        const auto asked = std::find_if(all.begin(), all.end(), [&](const auto& d) { return d.name == name; });
        if (asked == all.end()) return Technique::draw_diagnostic(name, triangles, points, light);
        const Visibility visibility(device_, points.count());
        run_light(triangles, points, light, visibility);  // leaves its views behind
        const FitInputs inputs{triangle_inputs(triangles), point_inputs(points, triangles), visibility.buffer(), light,
                               points.camera()};
        const auto diagnostic = static_cast<cl_uint>(asked - all.begin());
        return opaque_bytes(run_map_diagnostic(session_, diagnostic, inputs, map_views_).colors);
    }

private:
    /// Throws InvalidArgument where settings contradict each other.
    void require_consistent() const {
        const Settings& s = settings_;
        const std::string store(store_names[s.store]);
        const bool is_depth = s.store == STORE_DEPTH;
        if (is_depth && s.prefilter != Prefilter::none)
            throw InvalidArgument(
                "depths must not be filtered before they are compared: set prefilter=none, or a store "
                "other than depth");
        if (!is_depth && s.lookup != LOOKUP_HARD)
            throw InvalidArgument("lookup=" + std::string(lookup_names[s.lookup]) + " compares depths, and store=" +
                                  store + " holds none: set lookup=hard, and filter by prefilter");
        if (!is_depth && s.bias == Settings::Bias::adaptive)
            throw InvalidArgument("bias=adaptive compares depths texel by texel, and store=" + store +
                                  " holds none: set bias=scaled");
        if (s.prefilter == Prefilter::gaussian && s.filter_width % 2 == 0)
            throw InvalidArgument("filter-width is odd where prefilter=gaussian, not " +
                                  std::to_string(s.filter_width));
        const bool unit_range = s.store == STORE_VARIANCE || s.store == STORE_LAYERED || s.store == STORE_CONVOLUTION ||
                                s.store == STORE_MOMENTS;
        if (s.prefilter == Prefilter::summed_area && !unit_range)
            throw InvalidArgument("sums of store=" + store +
                                  " would lose its precision: set prefilter=gaussian, or store=variance or moments");
        const bool squares = s.store == STORE_EVSM2 || s.store == STORE_EVSM4 || s.store == STORE_EWGF;
        if (squares && s.exponent > 42)
            throw InvalidArgument("the squares of store=" + store + " overflow beyond exponent=42: set a smaller one");
    }

    StorePlan store_plan() const {
        const Settings& s = settings_;
        StorePlan plan = s;
        plan.half_bits = !s.all_bits && s.store == STORE_MOMENTS;
        plan.edges_only = s.edges_only && s.store == STORE_VARIANCE;
        // For moments as in Peters and Klein 2015; for the others: the bias that rounding of their squares needs.
        const float own_bias = s.store != STORE_MOMENTS ? (s.store <= STORE_LAYERED ? 1e-3f : 1e-4f)
                               : s.all_bits             ? 3e-7f
                                                        : 3e-5f;
        plan.moment_bias = s.set_moment_bias.value_or(own_bias);
        plan.planes = s.store == STORE_LAYERED                             ? 2 * s.layers
                      : s.store == STORE_CONVOLUTION                       ? 2 * s.terms
                      : s.store == STORE_EXPONENTIAL                       ? 1
                      : s.store == STORE_EVSM4 || s.store == STORE_MOMENTS ? 4
                                                                           : 2;
        return plan;
    }

    /// Fills and filters what the map holds instead of depth.
    void store_quantity(const FitInputs& inputs, StorePlan& plan, Statistics& statistics) {
        // Pixel footprints need a camera and receivers.
        const bool has_footprints = inputs.camera && inputs.points.layout.has_receivers != 0;
        const bool lacks_footprints = settings_.prefilter == Prefilter::mip && !has_footprints;
        const Prefilter prefilter = lacks_footprints ? Prefilter::none : settings_.prefilter;
        cl::StageTimer timer(session_, statistics, "moments");
        stored_.fill(session_, map_views_, depths_, plan);
        timer.next("prefilter");
        stored_.prefilter(session_, map_views_, prefilter, settings_.filter_width, plan);
        timer.next(nullptr);
        if (prefilter != Prefilter::none) return;
        statistics.stages.back().skipped =
            lacks_footprints ? "mip needs points of a camera: looked up unfiltered" : "switched off";
    }

    void look_up(const FitInputs& inputs, const StorePlan& store) {
        const Settings& s = settings_;
        const bool is_stored = s.store != STORE_DEPTH;
        const LookupPlan plan{.first_float = inputs.triangles.first_float,
                              .triangle_count = inputs.triangles.count,
                              .lookup = s.lookup,
                              .taps = s.taps,
                              .adaptive = s.bias == Settings::Bias::adaptive,
                              .softness = s.softness,
                              .light_size = s.light_size,
                              .store = store,
                              .steps = inputs.camera ? pixel_steps(*inputs.camera) : PixelSteps{}};
        const cl::Buffer& planes = is_stored ? stored_.planes() : depths_.keys();
        session_.launch({"rivals/shadow_map/lookup.cl", "map_lookup", {.stored_map = is_stored}},
                        cl::Range::items(inputs.points.layout.count), plan, map_views_.set, inputs.points.layout,
                        inputs.points.positions, inputs.points.receivers, inputs.triangles.vertices, map_views_.views,
                        map_views_.tables, depths_.keys(), planes, store.mips != 0 ? stored_.mips() : planes,
                        inputs.visibility);
    }

    void run_stages(const FitInputs& inputs, Statistics& statistics) {
        const Settings& s = settings_;
        cl::StageTimer timer(session_, statistics, "fit");
        fit_.run(session_, inputs, s.size, map_views_);
        timer.next(nullptr);
        if (const std::string limits = fit_.limits(inputs); !limits.empty())
            statistics.stages.push_back({"fit_along_view", 0, 0, limits});
        timer.next("depth_pass");
        DepthBias bias;
        if (s.bias == Settings::Bias::scaled && s.store == STORE_DEPTH) bias.slope = s.slope_bias;
        bias.slope_limit = s.slope_limit;
        if (s.bias == Settings::Bias::dual) bias.dual_limit = s.dual_limit;
        depths_.run(session_, inputs.triangles, map_views_, bias,
                    s.store == STORE_VARIANCE || s.store == STORE_LAYERED);
        timer.next(nullptr);
        StorePlan plan = store_plan();
        if (s.store != STORE_DEPTH) store_quantity(inputs, plan, statistics);
        timer.next("lookup");
        look_up(inputs, plan);
    }

    Device device_;
    cl::Session& session_;
    std::string name_;
    Settings settings_ = settings_table().defaults();
    ViewFit fit_;
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    FacingStage facing_;
    cl::Buffer counters_;
    MapViews map_views_;
    DepthMap depths_;
    StoredMap stored_;
};

template <typename Use>
void for_each_setting(std::string_view settings, const Use& use) {
    while (!settings.empty()) {
        const std::string_view one = settings.substr(0, settings.find(' '));
        settings.remove_prefix(std::min(one.size() + 1, settings.size()));
        const std::size_t equals = one.find('=');
        use(one.substr(0, equals), one.substr(equals + 1));
    }
}

Registered registered_preset(const ShadowMapPreset& preset) {
    TechniqueDescription description = ShadowMap::describe();
    description.name = preset.name;
    description.summary = preset.summary;
    for_each_setting(preset.settings, [&](std::string_view name, std::string_view value) {
        for (SettingDescription& setting : description.settings)
            if (setting.name == name) setting.default_value = value;
    });
    return {std::move(description), [preset](const Device& device) {
                auto technique = std::make_unique<ShadowMap>(device, preset.name);
                for_each_setting(preset.settings,
                                 [&](std::string_view name, std::string_view value) { technique->set(name, value); });
                return technique;
            }};
}

}  // namespace

Registered shadow_map_technique() { return registered<ShadowMap>(); }

std::vector<Registered> shadow_map_presets() {
    std::vector<Registered> all;
    for (const ShadowMapPreset& preset : presets) all.push_back(registered_preset(preset));
    return all;
}

}  // namespace gnomon
