// SPDX-License-Identifier: MIT
// Technique virtual-shadow-map: a large shadow map that has only the pages that shading points request
// (kernels/rivals/shadow_map/virtual_map.h). The pipeline:
//
//   facing   decides backfacing points
//   fit      views fitted to the other points, as shadow-map's
//   request  each point requests the page under it, at its pixel's level
//   pages    a prefix sum gives every requested page its slot
//   draw     the nearest caster per texel of these pages
//   lookup   visibility of the points that face the light
//
// Several lights: facing, fit, request and lookup for each, pages and draw once for all.
#include "kernels/rivals/shadow_map/virtual_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lists/scan.hpp"
#include "occluders/triangle_setup.hpp"
#include "query/statistics.hpp"
#include "receivers/facing.hpp"
#include "rivals/rivals.hpp"
#include "rivals/shadow_map/diagnostic.hpp"
#include "rivals/shadow_map/map_projection.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "rivals/shadow_map/virtual_map.cl";

// The least is one page; each size is the double of the previous size.
constexpr std::string_view sizes[] = {"128", "256", "512", "1024", "2048", "4096", "8192", "16384"};

// On a GPU: pairs of a triangle and a page that have room at first; others are drawn at once.
constexpr std::uint64_t first_pairs = 1u << 18;

// Texels are counted in 32 bits.
constexpr std::uint32_t max_pages = 0xFFFFFFFFu / PAGE_TEXELS;

struct Settings : VirtualPlan {
    std::uint32_t size;
    float slope_bias, slope_limit;  ///< as shadow-map's
};

const SettingsTable<Settings>& settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"size", "16384", "texels per side of each view's finest level: a power of two from 128 to 16384"},
         [](S& s, const SettingText& value) { s.size = PAGE_SIZE << value.choice(sizes); }},
        {{"detail", "1", "texels per pixel side that a point requests, 0.01 to 100"},
         setting::number(&S::detail, 0.01, 100)},
        {{"level", "0", "of points without a camera: level that they request, 0 (finest) to 7"},
         setting::whole(&S::level, 0, std::size(sizes) - 1)},
        {{"constant-bias", "0.0001", "subtracted from the receiver's depth, 0 to 1; 1 is the receivers' depth range"},
         setting::number(&S::receiver_bias, 0, 1)},
        {{"slope-bias", "1.5", "times the caster's depth per texel, 0 to 100"},
         setting::number(&S::slope_bias, 0, 100)},
        {{"slope-limit", "0.05", "most depth that slope-bias adds, 0 to 1"}, setting::number(&S::slope_limit, 0, 1)},
    };
    return table;
}

class VirtualShadowMap final : public Technique {
public:
    explicit VirtualShadowMap(const Device& device) : device_(device), session_(session_of(device)) {}
    const Device& device() const override { return device_; }

    static TechniqueDescription describe() {
        return {
            "virtual-shadow-map",
            "virtual shadow map (Olsson et al. 2014): only the pages that points request, at their pixels' resolution",
            false,
            settings_table().descriptions(),
            {{"page",
              "a colour for each level, red the finest, lighter and darker page by page; black where none serves"}}};
    }

    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "virtual-shadow-map", name, value);
    }

    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) override {
        return run_lights(triangles, points, std::span(&light, 1), std::span(&visibility, 1), [](std::size_t) {})
            .front();
    }

    /// All lights' pages lie in one pool, drawn in one pass.
    std::vector<Statistics> run_lights(const Triangles& triangles, const Points& points, std::span<const Light> lights,
                                       std::span<const Visibility> visibilities,
                                       const std::function<void(std::size_t)>& after_light) override {
        require_run_lights(triangles, points, lights, visibilities);
        const MeasuredRun measured(session_, kept_bytes_);
        light_views_.resize(lights.size());
        counted_ = {};
        static_assert(sizeof(VirtualCounters) <= sizeof(FrameCounters));
        std::vector<LightRun> runs;
        std::vector<LightRun*> drawn;
        runs.reserve(lights.size());
        for (std::size_t i = 0; i < lights.size(); ++i) {
            LightRun& run = runs.emplace_back(LightRun{{triangle_inputs(triangles), point_inputs(points, triangles),
                                                        visibilities[i].buffer(), lights[i], points.camera()}});
            run.index = i;
            light_views_[i].set = {};
            run.facing = facing_.run_alone(session_, run.statistics, run.inputs.triangles, run.inputs.points, lights[i],
                                           run.inputs.visibility, counters_);
            if (points.count() == 0) continue;
            if (triangles.count() != 0 && run.facing.absent + run.facing.facing_away < points.count())
                drawn.push_back(&run);
            else
                run.statistics.stages.push_back({"draw", 0, 0, "no point faces the light, or there are no triangles"});
        }
        if (!drawn.empty()) run_stages(drawn);
        session_.finish();
        // The next run has room for as many pairs as this one made.
        if (!drawn.empty() && !session_.is_cpu())
            pairs_.fitted(session_, session_.read_value<VirtualCounters>(counters_).pairs, "triangles of pages");

        std::vector<Statistics> all;
        std::uint64_t first_page = 0;
        const double total_ms = measured.wall_ms();
        for (LightRun& run : runs) {
            const std::uint64_t view_count = light_views_[run.index].set.view_count;
            Statistics& s = run.statistics;
            s.counts = {{"points", points.count()},
                        {"points_absent", run.facing.absent},
                        {"points_facing_away", run.facing.facing_away},
                        {"points_outside", run.outside},
                        {"triangles", triangles.count()},
                        {"map_views", view_count},
                        {"map_texels", run.pages * PAGE_TEXELS},
                        {"virtual_texels", view_count * settings_.size * settings_.size},
                        {"pages_requested", run.pages},
                        {"pages_drawn", pages_drawn(first_page, run.pages)}};
            first_page += run.pages;
            s.device_memory_bytes = measured.peak_bytes();  // of the pool
            // Every light gets an even share of the time: most of the work serves all lights.
            s.total_wall_ms = total_ms / double(runs.size());
            all.push_back(std::move(s));
            after_light(run.index);
        }
        return all;
    }

    /// "page": the page that serves each point. The points need not be a camera's.
    std::vector<std::uint8_t> draw_diagnostic(std::string_view name, const Triangles& triangles, const Points& points,
                                              const Light& light) override {
        if (name != "page") return Technique::draw_diagnostic(name, triangles, points, light);
        const std::size_t count = points.count();
        // Where no point faces the light the run requests no page.
        session_.reserve_filled(point_entries_, NO_PAGE, count * sizeof(cl_uint));
        const Visibility visibility(device_, count);
        run_light(triangles, points, light, visibility);  // leaves its pages behind
        const FitInputs inputs{triangle_inputs(triangles), point_inputs(points, triangles), visibility.buffer(), light,
                               points.camera()};
        const cl::Buffer colors(session_, 3 * count * sizeof(float));
        session_.launch(file, "virtual_map_page_colors", cl::Range::items(count),
                        plan_of(inputs, light_views_.front().set.view_count), inputs.points.layout,
                        inputs.points.positions, point_entries_, colors);
        return opaque_bytes(session_.read_values<float>(colors.get(), 3 * count));
    }

private:
    /// A light, the inputs of its stages, and the position of its views and points among those of all lights.
    struct LightRun {
        FitInputs inputs;
        Statistics statistics{};
        FrameCounters facing{};
        std::uint64_t outside = 0, pages = 0;
        std::size_t index = 0;
        VirtualLight light{};
    };

    VirtualPlan plan_of(const FitInputs& inputs, std::uint32_t view_count) const {
        VirtualPlan plan = settings_;
        plan.pages_across = settings_.size / PAGE_SIZE;
        plan.levels = static_cast<cl_uint>(std::bit_width(plan.pages_across));
        plan.entries_per_view = (4 * plan.pages_across * plan.pages_across - 1) / 3;
        plan.view_count = view_count;
        if (inputs.camera)
            plan.pixel_size = static_cast<float>(2 * std::tan(inputs.camera->camera.fov_y_radians / 2) /
                                                 std::max(inputs.camera->height, 1u));
        return plan;
    }

    void request(LightRun& run, const VirtualPlan& plan) {
        cl::StageTimer timer(session_, run.statistics, "request");
        const MapViews& views = light_views_[run.index];
        const PointInputs& points = run.inputs.points;
        session_.launch(file, "virtual_map_levels", cl::Range::items(views.set.view_count * plan.levels), plan,
                        run.light, views.views, level_views_.views);
        session_.launch(file, "virtual_map_request", cl::Range::items(points.layout.count), plan, run.light, views.set,
                        points.layout, points.positions, run.inputs.visibility, views.views, views.tables, requested_,
                        point_entries_, counters_);
        const VirtualCounters before = counted_;
        counted_ = session_.read_value<VirtualCounters>(counters_);
        run.outside = counted_.points_outside - before.points_outside;
        run.pages = counted_.pages_requested - before.pages_requested;
    }

    /// Makes a physical page of every requested entry.
    void allocate(const VirtualPlan& plan, Statistics& statistics) {
        cl::StageTimer timer(session_, statistics, "pages");
        fill_centres(session_, level_views_);
        const cl_uint entries = plan.view_count * plan.entries_per_view;
        page_of_.reserve(session_, (std::size_t(entries) + 1) * sizeof(cl_uint));
        scan_.run(session_, entries, requested_, page_of_);
        const cl_uint pages = counted_.pages_requested;
        if (pages > max_pages)
            throw InvalidArgument("the points request " + std::to_string(pages) + " pages of a virtual map of size " +
                                  std::to_string(settings_.size) + ", and there can be " + std::to_string(max_pages) +
                                  ": set a smaller size or detail");
        pages_.reserve(session_, pages * sizeof(MapView));
        page_entries_.reserve(session_, pages * sizeof(cl_uint));
        touched_.reserve(session_, pages * sizeof(cl_uint));
        keys_.reserve(session_, words_of(pages) * sizeof(cl_uint));
        session_.launch(file, "virtual_map_pages", cl::Range::items(entries), plan, level_views_.views, requested_,
                        page_of_, pages_, page_entries_);
    }

    /// A little more than the pages' texels: kernels read the last ones in blocks of lanes.
    std::size_t words_of(cl_uint pages) const { return std::size_t(pages) * PAGE_TEXELS + session_.lanes(); }

    void draw(const TriangleInputs& triangles, const VirtualPlan& plan, Statistics& statistics) {
        cl::StageTimer timer(session_, statistics, "draw");
        clusters_.run(session_, triangles, level_views_, plan.levels);
        const TriangleInputs& drawn = clusters_.triangles();
        VirtualPass pass{clusters_.pass(), plan};
        pass.pass.pass = PASS_NEAREST;
        pass.pass.slope_bias = settings_.slope_bias;
        pass.pass.slope_limit = settings_.slope_limit;
        if (session_.is_cpu()) {
            const cl_uint pages = counted_.pages_requested;
            session_.launch(drawn.kernel(file, "virtual_map_windows"), cl::Range::groups(pages, 1), pass, pages,
                            drawn.vertices, level_views_.tables, clusters_.covers(), pages_, page_entries_, touched_,
                            keys_);
            return;
        }
        session_.fill(touched_, 0, counted_.pages_requested * sizeof(cl_uint));
        session_.fill(keys_, EMPTY_KEY, words_of(counted_.pages_requested) * sizeof(cl_uint));
        session_.reserve_filled(tile_keys_, EMPTY_KEY,
                                std::size_t(counted_.pages_requested) * (PAGE_TEXELS / 16) * sizeof(cl_uint));
        pairs_.reserve(session_, first_pairs);
        pass.pass.chunk_capacity = pairs_.capacity();
        session_.launch(drawn.kernel(file, "virtual_map_scatter"), clusters_.items(), pass, drawn.vertices,
                        level_views_.views, level_views_.tables, clusters_.listed(), page_of_, pages_, touched_, keys_,
                        counters_, pairs_.buffer(), CasterClusters::local(session_, PAGED_CASTER_WORDS));
        session_.launch(drawn.kernel(file, "virtual_map_pairs"), session_.small_groups(), pass, drawn.vertices,
                        level_views_.tables, page_of_, pages_, keys_, counters_, pairs_.buffer(), tile_keys_);
    }

    /// How many of the pages [first, first + count) overlap the rectangle of some caster.
    std::uint64_t pages_drawn(std::uint64_t first, std::uint64_t count) const {
        if (count == 0) return 0;
        const auto touched = session_.read_values<cl_uint>(touched_.get(), first + count);
        return std::uint64_t(std::count(touched.begin() + std::ptrdiff_t(first), touched.end(), 1u));
    }

    /// Views, requests, pages, drawing and lookup for the lights that some point faces.
    void run_stages(std::vector<LightRun*>& runs) {
        cl_uint view_count = 0;
        for (LightRun* run : runs) {
            cl::StageTimer timer(session_, run->statistics, "fit");
            fit_.run(session_, run->inputs, settings_.size, light_views_[run->index]);
            run->light.first_point = cl_ulong(run->index) * run->inputs.points.layout.count;
            run->light.first_view = view_count;
            run->light.view_count = light_views_[run->index].set.view_count;
            view_count += run->light.view_count;
        }
        const FitInputs& any = runs.front()->inputs;
        const VirtualPlan plan = plan_of(any, view_count);
        const std::size_t entries = std::size_t(plan.view_count) * plan.entries_per_view;
        level_views_.set = light_views_[runs.front()->index].set;
        level_views_.set.view_count = plan.view_count * plan.levels;
        level_views_.views.reserve(session_, level_views_.set.view_count * sizeof(MapView));
        level_views_.tables.reserve(session_, std::size_t(plan.view_count) * 4 * settings_.size * sizeof(cl_float));
        session_.reserve_filled(requested_, 0, entries * sizeof(cl_uint));
        point_entries_.reserve(session_, light_views_.size() * any.points.layout.count * sizeof(cl_uint));
        session_.fill(counters_, 0, sizeof(VirtualCounters));
        for (LightRun* run : runs) request(*run, plan);
        allocate(plan, runs.front()->statistics);
        draw(any.triangles, plan, runs.front()->statistics);
        for (LightRun* run : runs) {
            if (run != runs.front())
                run->statistics.stages.push_back({"draw", 0, 0, "in one pass with the first light that is drawn"});
            cl::StageTimer timer(session_, run->statistics, "lookup");
            session_.launch(file, "virtual_map_lookup", cl::Range::items(any.points.layout.count), plan, run->light,
                            any.points.layout, any.points.positions, level_views_.tables, point_entries_, page_of_,
                            pages_, keys_, run->inputs.visibility);
        }
    }

    Device device_;
    cl::Session& session_;
    Settings settings_ = settings_table().defaults();
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run

    ViewFit fit_;
    Scan scan_;
    std::vector<MapViews> light_views_;  ///< of each light
    MapViews level_views_;
    FacingStage facing_;
    cl::Buffer counters_, requested_, page_of_, page_entries_, point_entries_, pages_, touched_, keys_, tile_keys_;
    CasterClusters clusters_;
    GrowingList pairs_{2 * sizeof(cl_uint)};
    VirtualCounters counted_{};
};

}  // namespace

Registered virtual_shadow_map_technique() { return registered<VirtualShadowMap>(); }

}  // namespace gnomon
