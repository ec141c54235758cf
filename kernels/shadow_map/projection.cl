// SPDX-License-Identifier: MIT
// Places the views of a shadow map (projection.h) over the shading points, on the device from beginning to end:
//   projection_bounds  of the scene, of the points' camera depths, of the points of each view
//   projection_plan    slices and homographies, one work-item per view
//   projection_fit     the rectangle, the depth range and the texels of each view
#include "../points.h"
#include "homography.h"
#include "partition.h"

// planned[0] and [1] are not views: the scene's box in world space, and camera depths. The views follow.
#define FIRST_VIEW 2

static float4 planned_row(__global const float* row) { return (float4)(row[0], row[1], row[2], row[3]); }

static void set_row(float* row, float4 value) {
    row[0] = value.x;
    row[1] = value.y;
    row[2] = value.z;
    row[3] = value.w;
}

// ---- Bounds ---------------------------------------------------------------------------------------------------------

// (u, v, depth, w) of a point, and whether the view is to hold it. Slices are widened by their overlap.
static bool place_in_view(const ViewPlan* plan, __global const PlannedView* view, bool is_slice, float3 p,
                          float4* place) {
    if (is_slice) {
        float3 eye = to_float3(plan->eye);
        float depth = dot3(to_float3(plan->forward), p - eye);
        float reach = (view->far_depth - view->near_depth) * plan->overlap;
        if (depth < view->near_depth - reach || depth > view->far_depth + reach) return false;
    }
    float4 q = (float4)(p - (float3)(view->origin[0], view->origin[1], view->origin[2]), 1.0f);
    float w = dot4(planned_row(view->row_w), q);
    float u = dot4(planned_row(view->row_u), q) / w, v = dot4(planned_row(view->row_v), q) / w;
    float depth = dot4(planned_row(view->row_depth), q);
    *place = (float4)(u, v, depth, w);
    if (view->is_front_only && !(depth > 0.0f)) return false;
    return u >= view->limit_low[0] && u <= view->limit_high[0] && v >= view->limit_low[1] && v <= view->limit_high[1];
}

static void include_place(__local uint* least, float4 place) {
    float values[4] = {place.x, place.y, place.z, place.w};
    for (int i = 0; i < 4; ++i) {
        atomic_min(&least[i], float_to_key(values[i]));
        atomic_min(&least[i + 4], float_to_key(-values[i]));
    }
}

// Bounds of the points of planned[first] to planned[first + count - 1]. Bounds start as all ones.
__kernel void projection_bounds(ViewPlan plan, uint first, uint count, uint only_open, PointsLayout layout,
                                __global const float* positions, __global const float* visibility,
                                __global const PlannedView* planned, __global KeyBounds* bounds,
                                __local uint* shared) {
    for (uint index = first; index < first + count; ++index) {
        __global const PlannedView* view = planned + index;
        if (view->is_off) continue;
        bool is_slice = index >= FIRST_VIEW && plan.partition == PARTITION_DEPTH;
        float4 low = (float4)(INFINITY), high = (float4)(-INFINITY);
        GN_FOR_EACH(i, layout.count) {
            if (only_open && visibility[i] != 1.0f) continue;
            float3 p = load_point(positions, layout, i);
            float4 place;
            if (!is_present(p) || !place_in_view(&plan, view, is_slice, p, &place)) continue;
            low = fmin(low, place);
            high = fmax(high, place);
        }
        for (size_t i = get_local_id(0); i < 8; i += get_local_size(0)) shared[i] = 0xFFFFFFFFu;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (low.x <= high.x) {
            include_place(shared, low);
            include_place(shared, high);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (size_t i = get_local_id(0); i < 8; i += get_local_size(0)) atomic_min(&bounds[index].least[i], shared[i]);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// ---- Plan -----------------------------------------------------------------------------------------------------------

typedef struct Place {
    float3 origin, box_low, box_high;  // the box is relative to the origin, and a little larger than the scene
    float diagonal;
} Place;

// Everything is placed relative to the middle of the scene, so that offsets stay small far from the world's origin.
static Place place_of_scene(KeyBounds scene) {
    Place place;
    place.origin = place.box_low = place.box_high = (float3)(0.0f);
    place.diagonal = 1.0f;
    if (is_empty(&scene)) return place;
    float3 low = (float3)(least_of(&scene, 0), least_of(&scene, 1), least_of(&scene, 2));
    float3 high = (float3)(greatest_of(&scene, 0), greatest_of(&scene, 1), greatest_of(&scene, 2));
    place.origin = 0.5f * low + 0.5f * high;
    float3 extent = high - low;
    place.diagonal = fmax(sqrt(dot3(extent, extent)), 1.0e-18f);
    float3 margin = (float3)(1.0e-4f * place.diagonal);
    place.box_low = low - place.origin - margin;
    place.box_high = high - place.origin + margin;
    return place;
}

static ViewPlan relative_to(ViewPlan plan, float3 origin) {
    float o[3] = {origin.x, origin.y, origin.z};
    for (int i = 0; i < 3; ++i) {
        plan.eye[i] -= o[i];
        if (plan.light[3] != 0.0f) plan.light[i] -= o[i];
    }
    return plan;
}

// Depths the slices share out. Points behind the camera are no reason to begin there.
static float2 depth_range(const ViewPlan* plan, KeyBounds depths, float diagonal) {
    float far_depth = plan->far_plane > 0.0f ? plan->far_plane : diagonal;
    float near_depth = plan->near_plane > 0.0f ? plan->near_plane : 1.0e-3f * far_depth;
    if (plan->range == RANGE_POINTS && !is_empty(&depths) && greatest_of(&depths, 2) > 0.0f) {
        far_depth = greatest_of(&depths, 2) * 1.00001f;
        near_depth = fmax(least_of(&depths, 2) * 0.99999f, 1.0e-5f * far_depth);
    }
    return (float2)(near_depth, fmax(far_depth, near_depth * 1.001f));
}

static void make_slice(const ViewPlan* plan, float2 range, uint i, PlannedView* view) {
    bool is_sliced = plan->partition == PARTITION_DEPTH;
    uint m = is_sliced ? plan->view_count : 1, at = is_sliced ? i : 0;
    view->near_depth = split_depth(range.x, range.y, plan->lambda, at, m);
    view->far_depth = split_depth(range.x, range.y, plan->lambda, at + 1, m);
}

// The homography along the view for a directional light, or the plain one where the view gives no direction.
static Homography along_the_view(const ViewPlan* plan, Place place, PlannedView* view) {
    bool follows = has_camera(plan) && plan->fit != FIT_SPHERE && plan->fit != FIT_QUANTISED;
    LightAxes axes = make_axes(plan, follows);
    Homography h = orthographic(axes);
    // Forms that grow with the scene's box have no use for the view; fits against swimming need even texels.
    if (!follows || plan->fit == FIT_CASTERS || plan->projection == PROJECTION_UNIFORM) return h;
    if (plan->projection == PROJECTION_PSM) {
        Homography perspective;
        return perspective_shadow_map(plan, view->near_depth, view->far_depth, &perspective) ? perspective : h;
    }
    float sine = view_light_sine(plan);
    if (sine < 0.02f) return h;
    Polyhedron body;
    make_view_volume(plan, view->near_depth, view->far_depth, place.box_low, place.box_high, &body);
    float y_least = INFINITY, y_greatest = -INFINITY, z_near = view->far_depth, z_far = view->near_depth;
    for (int i = 0; i < body.count; ++i) {
        float y = dot3(axes.y, body.vertices[i].xyz);
        float z = dot3(to_float3(plan->forward), body.vertices[i].xyz - to_float3(plan->eye));
        y_least = fmin(y_least, y), y_greatest = fmax(y_greatest, y);
        z_near = fmin(z_near, z), z_far = fmax(z_far, z);
    }
    z_near = fmax(z_near, view->near_depth);
    float n = plan->projection == PROJECTION_LISPSM
                  ? lispsm_distance(z_near, z_far, sine)
                  : logpsm_distance(plan, axes, &body, y_least, y_greatest - y_least, z_near);
    view->takes_logarithm = plan->projection == PROJECTION_LOGPSM;
    return light_space_perspective(plan, axes, y_least, n);
}

static void plan_view(const ViewPlan* plan, Place place, uint i, PlannedView* view) {
    for (int axis = 0; axis < 2; ++axis) view->limit_low[axis] = -INFINITY, view->limit_high[axis] = INFINITY;
    view->origin[0] = place.origin.x, view->origin[1] = place.origin.y, view->origin[2] = place.origin.z;
    view->takes_logarithm = view->is_front_only = view->is_off = 0;
    Homography h;
    if (plan->partition == PARTITION_FACES) {
        view->is_off = !frustum_side(plan, i, view->near_depth, view->far_depth, view, &h);
    } else if (plan->partition == PARTITION_CUBE) {
        h = cube_face(plan, i);
        for (int axis = 0; axis < 2; ++axis) view->limit_low[axis] = -1.0f, view->limit_high[axis] = 1.0f;
        view->is_front_only = 1;
        set_row(view->row_depth, h.w);
    } else {
        h = along_the_view(plan, place, view);
        set_row(view->row_depth, (float4)(-to_light(plan), 0.0f));
    }
    set_row(view->row_u, h.u);
    set_row(view->row_v, h.v);
    set_row(view->row_w, h.w);
}

__kernel void projection_plan(ViewPlan world_plan, __global const KeyBounds* bounds, __global PlannedView* planned) {
    Place place = place_of_scene(bounds[0]);
    ViewPlan plan = relative_to(world_plan, place.origin);
    float2 range = depth_range(&plan, bounds[1], place.diagonal);
    GN_FOR_EACH(i, plan.view_count) {
        PlannedView view;
        make_slice(&plan, range, i, &view);
        plan_view(&plan, place, i, &view);
        planned[FIRST_VIEW + i] = view;
    }
}
