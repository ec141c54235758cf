// SPDX-License-Identifier: MIT
// Fits the views of a shadow map (map_projection.h) to the shading points, on the device from beginning to end:
//   map_projection_bounds  of the scene, of the points' camera depths, of the points of each view
//   map_projection_plan    slices and homographies, one work-item per view
//   map_projection_fit     the rectangle, the depth range and the texels of each view
//   map_projection_centres the position of each column and row of texels before the warp
#include "rivals/shadow_map/partition.clh"
#include "simd/points.h"

// ---- Bounds ---------------------------------------------------------------------------------------------------------

static void include_position(__local uint* least, float4 position) {
    float values[4] = {position.x, position.y, position.z, position.w};
    for (int i = 0; i < 4; ++i) {
        atomic_min(&least[i], float_to_key(values[i]));
        atomic_min(&least[i + 4], float_to_key(-values[i]));
    }
}

// Bounds of the points of each view of the range. Bounds start as all ones.
__kernel void map_projection_bounds(ViewPlan plan, ViewRange range, PointsLayout layout,
                                    __global const float* positions, __global const float* visibility,
                                    __global const PlannedView* planned, __global KeyBounds* bounds,
                                    __local uint* shared) {
    for (uint index = range.first_view; index < range.first_view + range.view_count; ++index) {
        __global const PlannedView* view = planned + index;
        // A view that is off has no points; the item still runs, since every item must reach the barriers.
        uint points = view->is_off ? 0u : layout.count;
        float4 low = (float4)(INFINITY), high = (float4)(-INFINITY);
        GN_FOR_EACH(i, points) {
            if (range.only_open && visibility[i] != 1.0f) continue;
            float3 p = load_point(positions, layout, i);
            float4 position;
            if (!is_present(p) || !position_in_view(&plan, view, p, &position)) continue;
            low = fmin(low, position);
            high = fmax(high, position);
        }
        GN_FOR_EACH_IN_GROUP(i, 8) shared[i] = 0xFFFFFFFFu;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (low.x <= high.x) {
            include_position(shared, low);
            include_position(shared, high);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        GN_FOR_EACH_IN_GROUP(i, 8) atomic_min(&bounds[index].least[i], shared[i]);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// ---- Plan -----------------------------------------------------------------------------------------------------------

typedef struct SceneBox {
    float3 origin, box_low, box_high;  // the box is relative to the origin, and a little larger than the scene
    float diagonal;
} SceneBox;

// All positions are relative to the middle of the scene, so that offsets stay small far from the world's origin.
static SceneBox scene_box(KeyBounds bounds) {
    if (is_empty(&bounds)) return (SceneBox){(float3)(0.0f), (float3)(0.0f), (float3)(0.0f), 1.0f};
    float3 low = (float3)(min_of(&bounds, 0), min_of(&bounds, 1), min_of(&bounds, 2));
    float3 high = (float3)(greatest_of(&bounds, 0), greatest_of(&bounds, 1), greatest_of(&bounds, 2));
    float3 origin = 0.5f * low + 0.5f * high, extent = high - low;
    float diagonal = fmax(sqrt(dot3(extent, extent)), 1.0e-18f), margin = 1.0e-4f * diagonal;
    return (SceneBox){origin, low - origin - margin, high - origin + margin, diagonal};
}

static ViewPlan relative_to(ViewPlan plan, float3 origin) {
    plan.eye.xyz -= origin;
    if (plan.light.w != 0.0f) plan.light.xyz -= origin;
    return plan;
}

// The part of a slice that can have points: the slice inside the scene's box. Slices that repeat each other stay whole.
static void make_slice_body(const ViewPlan* plan, const PlannedView* view, SceneBox scene, Polyhedron* body) {
    float2 slice = widened_slice(plan, view);
    if (plan->self_similar)
        make_slice_volume(plan, slice.x, slice.y, body);
    else
        make_view_volume(plan, slice.x, slice.y, scene.box_low, scene.box_high, body);
}

// The homography along the view for a directional light, or the plain one if the view gives no direction.
static Homography along_the_view(const ViewPlan* plan, SceneBox scene, PlannedView* view) {
    bool follows = has_camera(plan) && plan->fit != FIT_SPHERE && plan->fit != FIT_QUANTISED;
    LightAxes axes = make_axes(plan, follows);
    Homography h = orthographic(axes);
    // Forms that grow with the scene's box do not use the view; fits against swimming need even texels.
    if (!follows || plan->fit == FIT_CASTERS || plan->projection == PROJECTION_UNIFORM) return h;
    float2 slice = widened_slice(plan, view);
    if (plan->projection == PROJECTION_PSM) {
        Homography perspective;
        return perspective_shadow_map(plan, slice.x, slice.y, &perspective) ? perspective : h;
    }
    float sine = view_light_sine(plan);
    if (sine < 0.02f) return h;
    Polyhedron body;
    make_slice_body(plan, view, scene, &body);
    float y_least = INFINITY, y_greatest = -INFINITY, z_near = slice.y, z_far = slice.x;
    for (int i = 0; i < body.count; ++i) {
        float y = dot3(axes.y, body.vertices[i].xyz);
        float z = dot3(plan->forward.xyz, body.vertices[i].xyz - plan->eye.xyz);
        y_least = fmin(y_least, y), y_greatest = fmax(y_greatest, y);
        z_near = fmin(z_near, z), z_far = fmax(z_far, z);
    }
    z_near = fmax(z_near, slice.x);
    float n = plan->projection == PROJECTION_LISPSM
                  ? lispsm_distance(z_near, z_far, sine)
                  : logpsm_distance(plan, axes, &body, y_least, y_greatest - y_least, z_near);
    view->takes_logarithm = plan->projection == PROJECTION_LOGPSM;
    return light_space_perspective(plan, axes, y_least, n);
}

static void plan_view(const ViewPlan* plan, SceneBox scene, uint i, PlannedView* view) {
    set_limits(view, INFINITY);
    view->origin = (float4)(scene.origin, 0.0f);
    view->takes_logarithm = view->is_front_only = view->is_off = 0;
    view->face = NO_FACE;
    Homography h;
    if (plan->partition == PARTITION_FACES) {
        view->is_off = !frustum_side(plan, i, view->near_depth, view->far_depth, view, &h);
    } else if (plan->partition == PARTITION_CUBE) {
        h = cube_face(plan, i);
        set_limits(view, 1.0f + SIDE_RIM);
        view->is_front_only = 1;
        view->row_depth = h.w;
    } else {
        h = along_the_view(plan, scene, view);
        view->row_depth = (float4)(-to_light(plan), 0.0f);
    }
    view->row_u = h.u;
    view->row_v = h.v;
    view->row_w = h.w;
}

// Slices of a logarithmic split are copies of the first, scaled about the eye, and so are their maps (Lloyd 2007,
// eq. 6.2 and 6.3): at p the first view's form has the value it has at eye + (p - eye) scale.
static float4 scaled_about(float4 row, float3 eye, float scale) {
    return (float4)(row.xyz * scale, row.w + (1.0f - scale) * dot3(row.xyz, eye));
}

static void repeat_first_view(const ViewPlan* plan, const PlannedView* first, PlannedView* view) {
    float scale = first->near_depth / view->near_depth;
    float3 eye = plan->eye.xyz;
    view->row_u = scaled_about(first->row_u, eye, scale);
    view->row_v = scaled_about(first->row_v, eye, scale);
    view->row_w = scaled_about(first->row_w, eye, scale);
}

__kernel void map_projection_plan(ViewPlan world_plan, __global const KeyBounds* bounds,
                                  __global PlannedView* planned) {
    SceneBox scene = scene_box(bounds[0]);
    ViewPlan plan = relative_to(world_plan, scene.origin);
    float2 range = depth_range(&plan, bounds[1], scene.diagonal);
    GN_FOR_EACH(i, plan.view_count) {
        PlannedView view;
        make_slice(&plan, range, i, &view);
        plan_view(&plan, scene, i, &view);
        if (plan.self_similar) {
            PlannedView first;
            make_slice(&plan, range, 0, &first);
            plan_view(&plan, scene, 0, &first);
            repeat_first_view(&plan, &first, &view);
        }
        planned[FIRST_VIEW + i] = view;
    }
}

// ---- Fit ------------------------------------------------------------------------------------------------------------

// Rectangles are bounds of u and v.
static Rectangle bounds_of_vertices(const PlannedView* view, const float4* vertices, int count) {
    Rectangle r = empty_rectangle();
    for (int i = 0; i < count; ++i) include_in(&r, ray_position(view->row_u, view->row_v, view->row_w, vertices[i]).xy);
    return r;
}

static Rectangle bounds_of_box(const PlannedView* view, SceneBox scene) {
    float4 corners[8];
    for (int i = 0; i < 8; ++i) corners[i] = (float4)(box_corner(scene.box_low, scene.box_high, i), 1.0f);
    return bounds_of_vertices(view, corners, 8);
}

// A little room at the rim, so that rounding leaves every point inside: half a texel, and no less than floats resolve
// easily. v = 1/w must stay positive, so its room is a share of v itself.
static Rectangle with_rim(Rectangle r, const PlannedView* view, uint size) {
    float2 room = fmax(0.5f * (r.high - r.low) / (float)size, 1.0e-5f * fmax(fabs(r.low), fabs(r.high)) + 1.0e-18f);
    Rectangle wide = {r.low - room, r.high + room};
    if (view->takes_logarithm) wide.low.y = r.low.y * 0.9999f, wide.high.y = r.high.y * 1.0001f;
    return wide;
}

// A rectangle of half width `half_width` and one texel of room, with its centre on the grid of its own texels. The grid
// has its anchor at the origin: a moved or turned camera moves the rectangle by whole texels alone.
static Rectangle snapped_rectangle(float2 center, float2 half_width, uint size) {
    float2 wide = half_width * (float)size / (float)(size - 2);
    float2 texel = 2.0f * wide / (float)size;
    float2 snapped = floor(center / texel) * texel;
    return (Rectangle){snapped - wide, snapped + wide};
}

// The slice's bounding sphere: its centre lies on the view's axis, equally far from the near and the far corners; if
// that point is beyond the far end, the centre lies in the far end. The radius does not depend on the camera's position
// or direction.
static Rectangle bounds_of_sphere(const ViewPlan* plan, const PlannedView* view) {
    float2 slice = widened_slice(plan, view);
    float n = slice.x, f = slice.y;
    float k2 = plan->right.w * plan->right.w + plan->up.w * plan->up.w;
    float z = fmin(0.5f * (n + f) * (1.0f + k2), f);
    float radius = sqrt((f - z) * (f - z) + k2 * f * f);
    float4 center = (float4)(plan->eye.xyz + plan->forward.xyz * z, 1.0f);
    return snapped_rectangle((float2)(dot4(view->row_u, center), dot4(view->row_v, center)), (float2)(radius),
                             plan->map_size);
}

// The slice's bounds, along each axis their size rounded up to 64ths of the scene's, and their offset to texels.
static Rectangle quantised_bounds(const ViewPlan* plan, const PlannedView* view, SceneBox scene) {
    float2 depths = widened_slice(plan, view);
    float4 corners[8];
    slice_corners(plan, depths.x, depths.y, corners);
    Rectangle slice = bounds_of_vertices(view, corners, 8), box = bounds_of_box(view, scene);
    float2 level = 0.5f * (box.high - box.low) / 64.0f, half_width = 0.5f * (slice.high - slice.low);
    // A scene in which no vertex is present has no levels. (A flat one has the levels of its margin.)
    float2 rounded = select(half_width, ceil(half_width / level) * level, level > 0.0f);
    return snapped_rectangle(0.5f * (slice.low + slice.high), rounded, plan->map_size);
}

static Rectangle fitted_rectangle(const ViewPlan* plan, const PlannedView* view, SceneBox scene, const Polyhedron* body,
                                  KeyBounds points) {
    if (plan->fit == FIT_RECEIVERS || !has_camera(plan)) {
        Rectangle r = {(float2)(min_of(&points, 0), min_of(&points, 1)),
                       (float2)(greatest_of(&points, 0), greatest_of(&points, 1))};
        return with_rim(r, view, plan->map_size);
    }
    if (plan->partition == PARTITION_FACES || plan->partition == PARTITION_CUBE)
        return (Rectangle){vload2(0, view->limit_low), vload2(0, view->limit_high)};
    if (plan->fit == FIT_SPHERE) return bounds_of_sphere(plan, view);
    if (plan->fit == FIT_QUANTISED) return quantised_bounds(plan, view, scene);
    if (plan->fit == FIT_CASTERS) return with_rim(bounds_of_box(view, scene), view, plan->map_size);
    return with_rim(bounds_of_vertices(view, body->vertices, body->count), view, plan->map_size);
}

// The depth range of the scene's box.
static float2 depths_of_box(const PlannedView* view, SceneBox scene) {
    float2 depths = (float2)(INFINITY, -INFINITY);
    for (int i = 0; i < 8; ++i) {
        float depth = dot4(view->row_depth, (float4)(box_corner(scene.box_low, scene.box_high, i), 1.0f));
        depths = (float2)(fmin(depths.x, depth), fmax(depths.y, depth));
    }
    return depths;
}

// Depths that the map resolves: the receivers' depths or, if the map must not follow the camera, the depths of the
// whole scene. Nearer casters are clamped to depth 0, unless the lookup measures their distance.
static float2 fitted_depths(const ViewPlan* plan, const PlannedView* view, SceneBox scene, KeyBounds points) {
    float low = min_of(&points, 2), high = greatest_of(&points, 2);
    float2 box = depths_of_box(view, scene);
    if (plan->fit >= FIT_CASTERS && plan->partition <= PARTITION_DEPTH)
        low = box.x, high = box.y;
    else if (plan->keeps_casters)
        low = fmin(low, view->is_front_only ? fmax(box.x, 0.0f) : box.x);
    float range = fmax(high - low, 1.0e-3f * fmax(fabs(low), fabs(high)) + 1.0e-18f);
    return (float2)(low - NEAR_MARGIN * range, high + FAR_MARGIN * range);
}

// Unit-cube clipping (Kozlov 2004): the rectangle becomes [0, 1], in homogeneous rows.
static float4 unit_row(float4 row, float4 row_w, float low, float high) { return (row - row_w * low) / (high - low); }

// Largest ratios of a texel of unit resolution to a pixel over the vertices. A texel is 1 / |gradient| wide, a pixel in
// proportion to the camera depth: so these are Lloyd's R_s and R_t (2007, eq. 4.5) but for factors that all views
// share. `normal`: texels are measured along the plane with this unit normal; 0: across the light.
static void measure_errors(const ViewPlan* plan, const MapView* map, const Polyhedron* body, float3 normal,
                           float* error_u, float* error_v) {
    float4 row_u = map->row_u, row_v = map->row_v, row_w = map->row_w;
    *error_u = *error_v = 0.0f;
    for (int i = 0; i < body->count; ++i) {
        float4 vertex = body->vertices[i];
        float3 at = ray_position(row_u, row_v, row_w, vertex);
        float3 along_u = (row_u.xyz - row_w.xyz * at.x) / at.z, along_v = (row_v.xyz - row_w.xyz * at.y) / at.z;
        along_u -= normal * dot3(normal, along_u);
        along_v -= normal * dot3(normal, along_v);
        float slope = 1.0f;
        if (map->warp == WARP_LOGARITHMIC)
            slope = map->log_strength /
                    ((1.0f + map->log_strength * clamp(at.y, 0.0f, 1.0f)) * log(1.0f + map->log_strength));
        float z = dot3(plan->forward.xyz, vertex.xyz - plan->eye.xyz);
        *error_u = fmax(*error_u, 1.0f / (sqrt(dot3(along_u, along_u)) * z));
        *error_v = fmax(*error_v, 1.0f / (slope * sqrt(dot3(along_v, along_v)) * z));
    }
}

static MapView map_view_of(const ViewPlan* plan, const PlannedView* view, SceneBox scene, uint i, Rectangle r,
                           float2 depths) {
    MapView map;
    float4 row_w = view->row_w, one = (float4)(0.0f, 0.0f, 0.0f, 1.0f);
    map.row_u = unit_row(view->row_u, row_w, r.low.x, r.high.x);
    map.row_v = unit_row(view->row_v, row_w, r.low.y, r.high.y);
    map.row_w = row_w;
    map.row_depth = unit_row(view->row_depth, one, depths.x, depths.y);
    map.origin = view->origin;
    map.front_depth = view->is_front_only ? -depths.x / (depths.y - depths.x) : -INFINITY;
    bool is_sliced = plan->partition == PARTITION_DEPTH;
    map.select_near = is_sliced && i != 0 ? view->near_depth : -INFINITY;
    map.select_far = is_sliced && i + 1 != plan->view_count ? view->far_depth : INFINITY;
    map.log_strength = view->takes_logarithm ? r.high.y / r.low.y - 1.0f : 0.0f;
    map.warp = map.log_strength > 1.0e-3f ? WARP_LOGARITHMIC : WARP_NONE;
    map.blend_from = map.select_far;
    map.face = view->face;
    map.scene_depth = scene.diagonal * sqrt(dot3(map.row_depth.xyz, map.row_depth.xyz));
    map.warp_size = map.forward_first = map.padding = 0;
    map.centres_first = i * 2 * MAX_SIDES * plan->map_size;
    map.width = map.height = plan->map_size;
    map.row_stride = plan->map_size;
    map.first_texel = i * plan->map_size * plan->map_size;
    if (plan->atlas_columns != 0) {
        map.row_stride = plan->atlas_columns * plan->map_size;
        map.first_texel =
            (i / plan->atlas_columns) * map.row_stride * plan->map_size + (i % plan->atlas_columns) * plan->map_size;
    }
    return map;
}

// The corners of a side of the view frustum.
static void side_vertices(const ViewPlan* plan, const PlannedView* view, uint side, float3* corners) {
    // Sides of slice_corner's numbering, in the order of frustum_side.
    const int sides[6] = {1, 0, 3, 2, 5, 4};
    for (int i = 0; i < 4; ++i)
        corners[i] = slice_corner(plan, view->near_depth, view->far_depth, side_corners[sides[side]][i]);
}

// The places at which the errors of a side are taken (Lloyd 2007, 6.4): its corners for a directional light, for a
// point light the place nearest to it.
static void make_side_body(const ViewPlan* plan, const PlannedView* view, uint side, Polyhedron* body) {
    float3 corners[4];
    side_vertices(plan, view, side, corners);
    body->count = is_directional(plan) ? 4 : 1;
    if (!is_directional(plan)) corners[0] = nearest_on_side(corners, plan->light.xyz);
    for (int i = 0; i < body->count; ++i) body->vertices[i] = (float4)(corners[i], 1.0f);
}

// For a point light inside the view frustum the errors of its sides are taken without the cosine of the light's angle
// to the side (Lloyd 2007, 6.4): texels are measured along the side, whose normal this is. Else 0.
static float3 normal_of_side(const ViewPlan* plan, const PlannedView* view, uint side) {
    if (plan->partition != PARTITION_FACES || is_directional(plan)) return (float3)(0.0f);
    float3 from_eye = plan->light.xyz - plan->eye.xyz;
    float z = dot3(plan->forward.xyz, from_eye);
    if (!(z > view->near_depth) || !(z < view->far_depth) ||
        !(fabs(dot3(plan->right.xyz, from_eye)) < plan->right.w * z) ||
        !(fabs(dot3(plan->up.xyz, from_eye)) < plan->up.w * z))
        return (float3)(0.0f);
    float3 corners[4];
    side_vertices(plan, view, side, corners);
    return unit3(cross3(corners[1] - corners[0], corners[2] - corners[0]));
}

// What the view's rectangle is fitted to and its errors are measured at; empty if neither is asked for, since one item
// clips it.
static void make_body(const ViewPlan* plan, const PlannedView* view, SceneBox scene, uint i, Polyhedron* body) {
    body->count = 0;
    if (!has_camera(plan) || plan->partition == PARTITION_CUBE) return;
    if (plan->shares_resolution == 0u && (plan->fit != FIT_FRUSTUM || plan->partition == PARTITION_FACES)) return;
    if (plan->partition == PARTITION_FACES)
        make_side_body(plan, view, i, body);
    else
        make_slice_body(plan, view, scene, body);
}

__kernel void map_projection_fit(ViewPlan world_plan, __global const KeyBounds* bounds, __global PlannedView* planned,
                                 __global MapView* maps) {
    SceneBox scene = scene_box(bounds[0]);
    ViewPlan plan = relative_to(world_plan, scene.origin);
    GN_FOR_EACH(i, plan.view_count) {
        PlannedView view = planned[FIRST_VIEW + i];
        KeyBounds points = bounds[FIRST_VIEW + i];
        Polyhedron body;
        make_body(&plan, &view, scene, i, &body);
        bool is_off = view.is_off || is_empty(&points);
        MapView map;
        if (is_off) {
            map =
                map_view_of(&plan, &view, scene, i, (Rectangle){(float2)(0.0f), (float2)(1.0f)}, (float2)(0.0f, 1.0f));
            map.width = map.height = 0;
        } else {
            map = map_view_of(&plan, &view, scene, i, fitted_rectangle(&plan, &view, scene, &body, points),
                              fitted_depths(&plan, &view, scene, points));
            if (plan.blends && i + 1 < plan.view_count)
                map.blend_from = fmax(planned[FIRST_VIEW + i + 1].cover_near, view.near_depth);
        }
        float error_u = is_off ? 0.0f : 1.0f, error_v = error_u;
        if (!is_off && body.count != 0)
            measure_errors(&plan, &map, &body, normal_of_side(&plan, &view, i), &error_u, &error_v);
        planned[FIRST_VIEW + i].error_u = error_u;
        planned[FIRST_VIEW + i].error_v = error_v;
        maps[i] = map;
    }
}

// ---- Shares of resolution -------------------------------------------------------------------------------------------

// With T texels in all, view i gets sigma_i T, sigma_i = R_s R_t / sum of R_s R_t, of them along its sides
//   r_s = sqrt((1 - alpha) / alpha  R_s / R_t  sigma T),  r_t = sqrt(alpha / (1 - alpha)  R_t / R_s  sigma T)
// (Lloyd 2007, eq. 6.1). For alpha = 0.5 that is r_s = c R_s, r_t = c R_t with one c for all: the errors R_s / r_s and
// R_t / r_t are the same for every view and both axes, and the largest is as small as T allows. One work-item.
__kernel void map_projection_share(ViewPlan plan, __global const PlannedView* planned, __global MapView* maps) {
    if (get_global_id(0) != 0) return;
    float sum = 0.0f;
    for (uint i = 0; i < plan.view_count; ++i) sum += planned[FIRST_VIEW + i].error_u * planned[FIRST_VIEW + i].error_v;
    float texels = (float)plan.view_count * (float)plan.map_size * (float)plan.map_size;
    float bias = sqrt((1.0f - plan.alpha) / plan.alpha), most = (float)(MAX_SIDES * plan.map_size);
    uint first = 0;
    for (uint i = 0; i < plan.view_count; ++i) {
        float error_u = planned[FIRST_VIEW + i].error_u, error_v = planned[FIRST_VIEW + i].error_v;
        __global MapView* map = maps + i;
        map->first_texel = first;
        if (map->width == 0) continue;
        float even = sqrt(texels / sum);
        map->width = (uint)clamp(even * error_u * bias, (float)MIN_SIDE, most);
        map->height = (uint)clamp(even * error_v / bias, (float)MIN_SIDE, most);
        map->row_stride = map->width;
        first += map->width * map->height;
    }
}

// Fills the tables of texel centres of all views.
__kernel void map_projection_centres(MapSet set, __global const MapView* views, __global float* tables) {
    for (uint v = 0; v < set.view_count; ++v) {
        __global const MapView* view = views + v;
        GN_FOR_EACH(i, view->width + view->height) {
            uint axis = i < view->width ? 0u : 1u;
            float at = axis == 0u ? ((float)i + 0.5f) / (float)view->width
                                  : ((float)(i - view->width) + 0.5f) / (float)view->height;
            tables[view->centres_first + i] = map_unwarp(view, tables, axis, at);
        }
    }
}
