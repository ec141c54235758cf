// SPDX-License-Identifier: MIT
#include "rivals/shadow_map/map_projection.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/rivals/shadow_map/point_light_perspective.h"
#include "kernels/rivals/shadow_map/rectilinear_warp.h"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "rivals/shadow_map/map_projection.cl";
constexpr const char* faces_file = "rivals/shadow_map/point_light_perspective.cl";
constexpr const char* warp_file = "rivals/shadow_map/rectilinear_warp.cl";

// Two entries come before the views: the scene's box, and camera depths (FIRST_VIEW of map_projection.cl).
constexpr cl_uint first_view = 2;

// In the order of their values in map_projection.h.
constexpr std::string_view projections[] = {"uniform", "psm", "lispsm", "logpsm"};
constexpr std::string_view fits[] = {"receivers", "frustum", "casters", "sphere", "quantised"};
constexpr std::string_view partitions[] = {"single", "depth", "faces", "auto"};
constexpr std::string_view ranges[] = {"points", "planes", "auto"};
constexpr std::string_view storages[] = {"array", "atlas"};

// In the order of their values in rectilinear_warp.h; functions by their bits.
constexpr std::string_view analyses[] = {"off", "backward", "forward", "hybrid"};
constexpr std::string_view functions[] = {"view", "distance", "edge", "normal"};

// "view+edge": their bits.
cl_uint importance_of(const SettingText& value) {
    cl_uint bits = 0;
    for (std::string_view rest = value.text; !rest.empty();) {
        const std::string_view one = rest.substr(0, rest.find('+'));
        bits |= 1u << SettingText{value.name, one}.choice(functions);
        rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    }
    if (bits == 0) throw InvalidArgument(std::string(value.name) + " is view, distance, edge and normal, joined by +");
    return bits;
}

cl_uint view_count(const ViewPlan& plan, cl_uint cascades) {
    if (plan.partition == PARTITION_SINGLE) return 1;
    return plan.partition == PARTITION_DEPTH ? cascades : 6;
}

void store_camera(const PointsCamera& from, ViewPlan& plan) {
    const double tangent = std::tan(from.camera.fov_y_radians / 2);
    std::copy(from.camera.eye.begin(), from.camera.eye.end(), plan.eye.values);
    plan.eye[3] = 1;
    store(plan.right, loaded(from.camera.right));
    store(plan.up, loaded(from.camera.up));
    store(plan.forward, loaded(from.camera.forward));
    plan.right[3] = static_cast<float>(tangent * from.width / std::max(from.height, 1u));
    plan.up[3] = static_cast<float>(tangent);
}

// Entries 0 and 1: the bounds of their rows are the scene's box and the points' camera depths.
std::array<PlannedView, first_view> measures(const ViewPlan& plan) {
    std::array<PlannedView, first_view> planned{};
    for (PlannedView& view : planned) {
        view.row_w[3] = 1;
        for (int axis = 0; axis < 2; ++axis) view.limit_low[axis] = -HUGE_VALF, view.limit_high[axis] = HUGE_VALF;
        view.cover_near = -HUGE_VALF;
        view.cover_far = HUGE_VALF;
        view.face = NO_FACE;
    }
    planned[0].row_u[0] = planned[0].row_v[1] = planned[0].row_depth[2] = 1;
    planned[1].origin = plan.eye;
    planned[1].row_depth = plan.forward;
    return planned;
}

// The triangles' vertices as points, so that one kernel bounds both.
PointInputs vertices_of(const TriangleInputs& triangles) {
    PointsLayout layout{};
    layout.first = static_cast<cl_uint>(triangles.first_float);
    layout.point_stride = 3;
    layout.coordinate_stride = 1;
    layout.count = triangles.count * 3;
    return {layout, triangles.vertices, triangles.vertices};
}

// Texel centres of all views, before the tables of warps.
std::size_t centre_floats(const ViewPlan& plan) { return std::size_t(plan.view_count) * 2 * MAX_SIDES * plan.map_size; }

bool warps_faces(const ViewPlan& plan) {
    return plan.partition == PARTITION_CUBE && plan.projection == PROJECTION_LISPSM && plan.fit == FIT_RECEIVERS;
}

MapSet map_set(const ViewPlan& plan) {
    MapSet set{};
    const cl_uint even = plan.map_size * plan.map_size;
    set.view_count = plan.view_count;
    set.texels_per_view = even;
    set.texels = plan.view_count * even;
    if (plan.atlas_columns != 0)
        set.texels = (plan.view_count + plan.atlas_columns - 1) / plan.atlas_columns * plan.atlas_columns * even;
    if (plan.shares_resolution != 0) {
        set.texels += plan.view_count * MIN_SIDE * MAX_SIDES * plan.map_size;
        set.texels_per_view = set.texels;
    }
    set.has_camera = plan.eye[3] != 0;
    set.eye = plan.eye;
    set.camera_forward = plan.forward;
    set.light = plan.light;
    return set;
}

}  // namespace

PixelSteps pixel_steps(const PointsCamera& from) {
    PixelSteps steps{};
    const double pixel = 2 * std::tan(from.camera.fov_y_radians / 2) / from.height;
    std::copy(from.camera.eye.begin(), from.camera.eye.end(), steps.eye.values);
    store(steps.forward, loaded(from.camera.forward));
    store(steps.step_x, loaded(from.camera.right) * pixel);
    store(steps.step_y, loaded(from.camera.up) * -pixel);
    return steps;
}

void fill_centres(cl::Session& session, const MapViews& map_views) {
    session.launch(file, "map_projection_centres", cl::Range::items(4096), map_views.set, map_views.views,
                   map_views.tables);
}

const SettingsTable<ViewFit::Settings>& ViewFit::settings_table() {
    using S = Settings;
    constexpr double largest = 1e30;
    static const SettingsTable<S> table{
        {{"projection", "uniform", "uniform, psm, lispsm or logpsm: how texels are laid over the light's rays"},
         setting::choice(&S::projection, projections)},
        {{"fit", "receivers", "receivers, frustum, casters, sphere (does not swim) or quantised: what a view contains"},
         setting::choice(&S::fit, fits)},
        {{"partition", "auto",
          "auto, single, depth or faces (of the view frustum): how views are shared out; point lights: cube faces"},
         setting::choice_or_auto(&S::set_partition, partitions)},
        {{"depth-range", "auto", "points (as far as shading points reach), planes (near to far) or auto"},
         setting::choice_or_auto(&S::set_range, ranges)},
        {{"cascades", "1", "slices of camera depth, 1 to 8"}, setting::whole(&S::cascades, 1, MAX_VIEWS)},
        {{"lambda", "0.5", "split scheme, from 0 (even) to 1 (logarithmic)"}, setting::number(&S::lambda, 0, 1)},
        {{"overlap", "0.02", "each slice covers this share more at both ends, for filters, 0 to 1"},
         setting::number(&S::overlap, 0, 1)},
        {{"blend", "off", "on or off: each slice blends into the next one within its overlap"},
         setting::on_off(&S::blends)},
        {{"near", "0", "near plane of the slices, world units; 0: a thousandth of far"},
         setting::number(&S::near_plane, 0, largest)},
        {{"far", "0", "far plane of the slices, world units; 0: the scene's diagonal"},
         setting::number(&S::far_plane, 0, largest)},
        {{"slide-back", "0", "psm: move the camera back by so much, world units"},
         setting::number(&S::slide_back, 0, largest)},
        {{"share-texels", "off", "on or off: share texels out to views and axes by their error"},
         setting::on_off(&S::shares_resolution)},
        {{"share-v", "0.5", "share-texels: how much goes along the view, 0.05 to 0.95; 0.5 is even"},
         setting::number(&S::alpha, 0.05, 0.95)},
        {{"self-similar", "off", "on or off: slices repeat the first one's fit (lambda 1, fit frustum)"},
         setting::on_off(&S::self_similar)},
        {{"storage", "array", "array or atlas: views one after the other, or side by side"},
         setting::choice(&S::is_atlas, storages)},
        {{"warp", "off", "off, backward, forward or hybrid: move texels to where this analysis finds them needed"},
         setting::choice(&S::analysis, analyses)},
        {{"importance", "view+distance+edge+normal", "what makes a cell of the warp important, joined by +"},
         [](S& s, const SettingText& value) { s.importance = importance_of(value); }},
    };
    return table;
}

ViewPlan ViewFit::plan_of(const FitInputs& inputs, std::uint32_t size) const {
    ViewPlan plan = settings_;
    const bool is_point_light = !inputs.light.is_directional();
    plan.light = float4_of(inputs.light.xyzw);
    if (inputs.camera) store_camera(*inputs.camera, plan);
    plan.projection = inputs.camera ? settings_.projection : PROJECTION_UNIFORM;
    plan.fit = inputs.camera || settings_.fit == FIT_CASTERS ? settings_.fit : FIT_RECEIVERS;
    plan.partition = settings_.set_partition.value_or(settings_.cascades > 1 ? PARTITION_DEPTH : PARTITION_SINGLE);
    if (!inputs.camera) plan.partition = PARTITION_SINGLE;
    const bool follows_view = plan.projection == PROJECTION_PSM || plan.projection == PROJECTION_LOGPSM;
    if (is_point_light && plan.partition != PARTITION_FACES)
        plan.partition = follows_view ? PARTITION_FACES : PARTITION_CUBE;
    plan.range = settings_.set_range.value_or(RANGE_POINTS);
    if (plan.fit == FIT_SPHERE || plan.fit == FIT_QUANTISED) plan.range = RANGE_PLANES;
    plan.blends = settings_.blends && plan.partition == PARTITION_DEPTH;
    plan.map_size = size;
    plan.keeps_casters = inputs.keeps_casters;
    plan.view_count = view_count(plan, settings_.cascades);
    plan.self_similar = settings_.self_similar && plan.partition == PARTITION_DEPTH && plan.fit == FIT_FRUSTUM;
    if (plan.self_similar != 0) plan.lambda = 1;
    plan.shares_resolution = settings_.shares_resolution && plan.view_count > 1;
    if (settings_.is_atlas && plan.shares_resolution == 0)
        while (plan.atlas_columns * plan.atlas_columns < plan.view_count) ++plan.atlas_columns;
    return plan;
}

std::string ViewFit::limits(const FitInputs& inputs) const {
    if (!inputs.camera && (settings_.projection != PROJECTION_UNIFORM || settings_.cascades > 1 ||
                           settings_.fit != FIT_RECEIVERS || settings_.analysis != ANALYSIS_NONE))
        return "the points have no camera: one uniform view is fitted to them";
    if (!inputs.light.is_directional() && settings_.projection == PROJECTION_LISPSM &&
        settings_.set_partition != PARTITION_FACES && settings_.fit != FIT_RECEIVERS)
        return "lispsm warps the faces around a point light where they are fitted to the receivers: set fit=receivers";
    return {};
}

void ViewFit::run_bounds(cl::Session& session, const ViewPlan& plan, const ViewRange& range, const PointInputs& points,
                         cl_mem visibility) {
    session.launch(file, "map_projection_bounds", cl::Range::groups(session.many_groups()), plan, range, points.layout,
                   points.positions, visibility, planned_, bounds_, cl::LocalBytes{sizeof(KeyBounds)});
}

// The views' rows, rectangles and texels, from the bounds.
void ViewFit::run_fit(cl::Session& session, const ViewPlan& plan, MapViews& map_views) {
    map_views.set = map_set(plan);
    map_views.views.reserve(session, plan.view_count * sizeof(MapView));
    map_views.tables.reserve(
        session, (centre_floats(plan) + std::size_t(plan.view_count) * 2 * (WARP_SEGMENTS + 1)) * sizeof(float));
    session.launch(file, "map_projection_fit", cl::Range::items(plan.view_count), plan, bounds_, planned_,
                   map_views.views);
    if (plan.shares_resolution != 0)
        session.launch(file, "map_projection_share", cl::Range::groups(1), plan, planned_, map_views.views);
}

void ViewFit::warp_faces(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs) {
    const cl_uint count = inputs.points.layout.count;
    WarpSampling sampling{};
    sampling.stride = count / WARP_SAMPLES | 1u;  // odd: not in step with the picture's rows
    sampling.sample_count = (count + sampling.stride - 1) / sampling.stride;
    const std::size_t choices = std::size_t(plan.view_count) * WARP_DIRECTIONS * WARP_CHOICES;
    samples_.reserve(session, sampling.sample_count * 3 * sizeof(float));
    faces_.reserve(session, sampling.sample_count * sizeof(cl_uint));
    costs_.reserve(session, choices * sizeof(float));
    session.launch(faces_file, "point_light_perspective_samples", cl::Range::items(sampling.sample_count), plan,
                   sampling, inputs.points.layout, inputs.points.positions, inputs.visibility, planned_, samples_,
                   faces_);
    session.launch(faces_file, "point_light_perspective_costs", cl::Range::items(choices), plan, sampling, samples_,
                   faces_, bounds_, costs_);
    session.launch(faces_file, "point_light_perspective_warp", cl::Range::items(plan.view_count), plan, costs_, bounds_,
                   planned_);
}

void ViewFit::warp_texels(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, MapViews& map_views) {
    const WarpPlan warp{settings_.analysis, settings_.importance, static_cast<cl_uint>(centre_floats(plan)), 0};
    const std::size_t cells = std::size_t(plan.view_count) * WARP_SEGMENTS * WARP_SEGMENTS;
    session.reserve_filled(importance_, 0, cells * sizeof(cl_uint));
    if (warp.analysis != ANALYSIS_FORWARD)
        session.launch(warp_file, "rectilinear_backward", cl::Range::items(inputs.points.layout.count), plan, warp,
                       map_views.set, inputs.points.layout, inputs.triangles.first_float, inputs.points.positions,
                       inputs.points.receivers, inputs.triangles.vertices, inputs.visibility, map_views.views, bounds_,
                       importance_);
    if ((warp.analysis & ANALYSIS_FORWARD) != 0) {
        ViewPlan small = plan;
        small.map_size = WARP_SEGMENTS;
        small.shares_resolution = small.atlas_columns = 0;
        run_fit(session, small, small_views_);
        fill_centres(session, small_views_);
        small_map_.run(session, inputs.triangles, small_views_, {}, false);
        session.launch(warp_file, "rectilinear_forward", cl::Range::items(cells), plan, warp, small_views_.views,
                       small_map_.keys(), bounds_, importance_);
    }
    session.launch(warp_file, "rectilinear_tables", cl::Range::groups(2 * plan.view_count), warp, importance_,
                   map_views.views, map_views.tables, cl::LocalBytes{2 * WARP_SEGMENTS * sizeof(float)});
}

void ViewFit::run(cl::Session& session, const FitInputs& inputs, std::uint32_t size, MapViews& map_views) {
    if (settings_.analysis != ANALYSIS_NONE && settings_.projection == PROJECTION_LOGPSM)
        throw InvalidArgument("logpsm warps its map already: set warp=off, or projection=uniform, psm or lispsm");
    const ViewPlan plan = plan_of(inputs, size);
    const ViewRange scene{0, 1, 0}, camera_depths{1, 1, 1}, views{first_view, plan.view_count, 1};
    const std::size_t entries = first_view + plan.view_count;
    planned_.reserve(session, entries * sizeof(PlannedView));
    session.reserve_filled(bounds_, 0xFFFFFFFFu, entries * sizeof(KeyBounds));
    const auto measured = measures(plan);
    session.write(planned_.get(), measured.data(), sizeof(measured));

    run_bounds(session, plan, scene, vertices_of(inputs.triangles), inputs.visibility);
    // A single map that is fitted to the receivers does not follow their depths from the camera, if nothing warps it.
    const bool is_plain = settings_.analysis == ANALYSIS_NONE && plan.projection == PROJECTION_UNIFORM;
    if (inputs.camera && !(is_plain && plan.partition == PARTITION_SINGLE && plan.fit == FIT_RECEIVERS))
        run_bounds(session, plan, camera_depths, inputs.points, inputs.visibility);
    session.launch(file, "map_projection_plan", cl::Range::items(plan.view_count), plan, bounds_, planned_);
    run_bounds(session, plan, views, inputs.points, inputs.visibility);
    if (warps_faces(plan)) {
        warp_faces(session, plan, inputs);
        run_bounds(session, plan, views, inputs.points, inputs.visibility);
    }
    run_fit(session, plan, map_views);
    if (settings_.analysis != ANALYSIS_NONE && inputs.camera) warp_texels(session, plan, inputs, map_views);
    fill_centres(session, map_views);
}

}  // namespace gnomon
