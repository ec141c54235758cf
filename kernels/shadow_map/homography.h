// SPDX-License-Identifier: MIT
// Linear forms on the light's rays: rows of four numbers, applied to (p_world, 1), that vanish on the light
// (projection.h says why), and the homographies of each family.
#ifndef GN_SHADOW_HOMOGRAPHY_H
#define GN_SHADOW_HOMOGRAPHY_H

#include "polyhedron.h"

typedef struct Homography {
    float4 u, v, w;
} Homography;

static float dot4(float4 row, float4 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w * p.w; }

static float3 unit3(float3 v) { return v / sqrt(dot3(v, v)); }

// All positions below are relative to the views' origin.

// The form n . (p - through).
static float4 form_through(float3 n, float3 through) { return (float4)(n, -dot3(n, through)); }

// The form whose value at p is, up to a factor that all forms seen through this plane share, that of `form` where the
// line from the light through p meets the plane. Vanishes on the light.
static float4 seen_through(float4 form, float4 plane, float4 light) {
    return form * dot4(plane, light) - plane * dot4(form, light);
}

// Towards the light, unit length, for a direction.
static float3 to_light(const ViewPlan* plan) { return unit3(to_float3(plan->light)); }

static bool is_directional(const ViewPlan* plan) { return plan->light[3] == 0.0f; }
static bool has_camera(const ViewPlan* plan) { return plan->eye[3] != 0.0f; }

// A unit vector across the light: `wish` without its part along the light, or any if nothing is left of it.
static float3 across_light(float3 light, float3 wish) {
    float3 rest = wish - light * dot3(wish, light);
    if (dot3(rest, rest) > 1.0e-6f * dot3(wish, wish)) return unit3(rest);
    float3 size = fabs(light);
    float3 axis = (float3)(0.0f, 0.0f, 0.0f);
    if (size.x <= size.y && size.x <= size.z)
        axis.x = 1.0f;
    else if (size.y <= size.z)
        axis.y = 1.0f;
    else
        axis.z = 1.0f;
    return unit3(axis - light * dot3(axis, light));
}

static float3 cross3(float3 a, float3 b) {
    return (float3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// The light's own axes across it: y along the view if the map follows the camera, else along a world axis, so that
// texels of a still light never turn.
typedef struct LightAxes {
    float3 x, y, light;
} LightAxes;

static LightAxes make_axes(const ViewPlan* plan, bool follows_camera) {
    LightAxes axes;
    axes.light = to_light(plan);
    float3 wish = (float3)(0.0f);
    if (follows_camera) {
        wish = to_float3(plan->forward);
        // Seen along the light, the view has no direction: the picture's up does as well.
        float along = dot3(wish, axes.light);
        if (along * along > 0.999f) wish = to_float3(plan->up);
    }
    axes.y = across_light(axes.light, wish);
    axes.x = cross3(axes.y, axes.light);
    return axes;
}

static Homography orthographic(LightAxes axes) {
    Homography h;
    h.u = (float4)(axes.x, 0.0f);
    h.v = (float4)(axes.y, 0.0f);
    h.w = (float4)(0.0f, 0.0f, 0.0f, 1.0f);
    return h;
}

// Face `face` of the cube around a positional light: axis face / 2, negative side if odd. |u| and |v| are at most 1 on
// it.
static Homography cube_face(const ViewPlan* plan, uint face) {
    float3 s = to_float3(plan->light);
    float3 axes[3] = {(float3)(1.0f, 0.0f, 0.0f), (float3)(0.0f, 1.0f, 0.0f), (float3)(0.0f, 0.0f, 1.0f)};
    uint axis = face / 2;
    Homography h;
    h.u = form_through(axes[(axis + 1) % 3], s);
    h.v = form_through(axes[(axis + 2) % 3], s);
    h.w = form_through((face & 1u) ? -axes[axis] : axes[axis], s);
    return h;
}

// ---- Light-space perspective ----------------------------------------------------------------------------------------

// w = y - y_c with the line y = y_c `n` before the volume: u is centred on the eye, v = 1/w.
static Homography light_space_perspective(const ViewPlan* plan, LightAxes axes, float y_least, float n) {
    Homography h = orthographic(axes);
    h.u = form_through(axes.x, to_float3(plan->eye));
    h.w = h.v;
    h.w.w -= y_least - n;
    h.v = (float4)(0.0f, 0.0f, 0.0f, 1.0f);
    return h;
}

// Sine of the angle between view and light.
static float view_light_sine(const ViewPlan* plan) {
    float cosine = dot3(to_float3(plan->forward), to_light(plan));
    return sqrt(fmax(0.0f, 1.0f - cosine * cosine));
}

// Distance of the line w = 0 before the volume that makes the perspective error of near and far end equal, which is
// the least maximum (Wimmer et al. 2004, section 4: n = z_n + sqrt(z_f z_n) for a light across the view, over the sine
// otherwise). A texel is as long as w^2 (v = 1/w), a pixel as wide as z: w^2 / z is the same at both ends of
// [z_n, z_f] if n^2 / z_n = (n + z_f - z_n)^2 / z_f.
static float lispsm_distance(float z_near, float z_far, float sine) { return (z_near + sqrt(z_near * z_far)) / sine; }

typedef struct Extents {
    float low_u, high_u, low_w, high_w;  // of u / w, of w
} Extents;

static Extents extents_of(const Homography* h, const Polyhedron* body) {
    Extents e = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < body->count; ++i) {
        float w = dot4(h->w, body->vertices[i]);
        if (!(w > 0.0f)) continue;
        float u = dot4(h->u, body->vertices[i]) / w;
        e.low_u = fmin(e.low_u, u), e.high_u = fmax(e.high_u, u);
        e.low_w = fmin(e.low_w, w), e.high_w = fmax(e.high_w, w);
    }
    return e;
}

// What a logarithmic map costs with this w: with v = log(w / w_0) / log(w_1 / w_0) a texel of unit resolution is
// w (u_1 - u_0) wide and w log(w_1 / w_0) long; a pixel covers z. Largest error along both axes, multiplied: the number
// of texels needed grows like that (Lloyd's storage factor, thesis 4.4.1).
static float logarithmic_storage(const ViewPlan* plan, const Homography* h, const Polyhedron* body) {
    Extents e = extents_of(h, body);
    float4 depth = form_through(to_float3(plan->forward), to_float3(plan->eye));
    float largest = 0.0f;
    for (int i = 0; i < body->count; ++i)
        largest = fmax(largest, dot4(h->w, body->vertices[i]) / dot4(depth, body->vertices[i]));
    return largest * largest * (e.high_u - e.low_u) * fmax(log(e.high_w / e.low_w), 1.0e-6f);
}

// The distance of least storage, among quarter octaves from z_near (the eye itself for a light across the view, where
// the error is then the same everywhere) to so far away that the map is uniform.
static float logpsm_distance(const ViewPlan* plan, LightAxes axes, const Polyhedron* body, float y_least,
                             float y_extent, float z_near) {
    float best = z_near, least = INFINITY;
    for (int step = 0; step < 128; ++step) {
        float n = z_near * exp2(0.25f * (float)step);
        Homography h = light_space_perspective(plan, axes, y_least, n);
        float storage = logarithmic_storage(plan, &h, body);
        if (storage < least) least = storage, best = n;
        if (n > 64.0f * y_extent) break;
    }
    return best;
}

// ---- Perspective shadow maps ----------------------------------------------------------------------------------------

// The forms x, y, z, w of the camera's clip space: the slice becomes the cube |x|, |y|, |z| <= w. A camera moved back
// sees all of the slice through the same angle, so the near end does not fill the cube.
static void camera_clip(const ViewPlan* plan, float near_depth, float far_depth, float4* clip) {
    float3 eye = to_float3(plan->eye) - to_float3(plan->forward) * plan->slide_back;
    float n = near_depth + plan->slide_back, f = far_depth + plan->slide_back;
    clip[0] = form_through(to_float3(plan->right), eye) / plan->right[3];
    clip[1] = form_through(to_float3(plan->up), eye) / plan->up[3];
    clip[3] = form_through(to_float3(plan->forward), eye);
    clip[2] = clip[3] * ((f + n) / (f - n));
    clip[2].w -= 2.0f * f * n / (f - n);
}

// The axis of the narrowest cone around unit vectors: the centre of their smallest ball, approached by steps towards
// the farthest (Badoiu and Clarkson 2003).
static float3 cone_axis(const float3* directions, int count) {
    float3 axis = directions[0];
    for (int step = 1; step <= 64; ++step) {
        int farthest = 0;
        float least = INFINITY;
        for (int i = 0; i < count; ++i) {
            float along = dot3(directions[i], axis);
            if (along < least) least = along, farthest = i;
        }
        axis += (directions[farthest] - axis) / (float)(step + 1);
    }
    return unit3(axis);
}

// The light's view of the post-perspective cube, along the axis of the cone around it. There the light is
// L = clip(light), at L.xyz / L.w; L.w c - L.xyz c.w points from it to c, or back if L.w < 0, whether it is at a point,
// at infinity (L.w = 0) or behind the camera (L.w < 0), where Kozlov needs a projection whose near plane lies beyond
// the far one: rows that vanish on the light need no cases. False if the cone is wider than a half space (light from
// almost straight behind or ahead): no plane in front of the light then has all of the cube on it.
static bool perspective_shadow_map(const ViewPlan* plan, float near_depth, float far_depth, Homography* h) {
    float4 light = (float4)(to_light(plan), 0.0f);
    float4 clip[4], seen[3];
    camera_clip(plan, near_depth, far_depth, clip);
    for (int i = 0; i < 3; ++i) seen[i] = seen_through(clip[i], clip[3], light);
    float3 directions[8];
    for (int i = 0; i < 8; ++i) {
        float4 corner = (float4)(slice_corner(plan, near_depth, far_depth, i), 1.0f);
        directions[i] = unit3((float3)(dot4(seen[0], corner), dot4(seen[1], corner), dot4(seen[2], corner)));
    }
    float3 axis = cone_axis(directions, 8);
    for (int i = 0; i < 8; ++i)
        if (!(dot3(axis, directions[i]) > 0.02f)) return false;
    float3 t = across_light(axis, (float3)(0.0f, 0.0f, 1.0f));
    float3 s = cross3(t, axis);
    h->u = seen[0] * s.x + seen[1] * s.y + seen[2] * s.z;
    h->v = seen[0] * t.x + seen[1] * t.y + seen[2] * t.z;
    h->w = seen[0] * axis.x + seen[1] * axis.y + seen[2] * axis.z;
    // What is left of the light in each row is rounding.
    h->u -= light * dot4(h->u, light);
    h->v -= light * dot4(h->v, light);
    h->w -= light * dot4(h->w, light);
    return true;
}

// ---- Face partitions ------------------------------------------------------------------------------------------------

// Sides hold a little more than themselves: rays through an edge must not fall between two of them. Twice what lookups
// ask of a face.
#define SIDE_RIM (2.0f * FACE_RIM)

// Sides of the view frustum: right, left, up, down, far, near. Rays are told apart by where they leave it, so each side
// has its own map, of the points where its rays leave: on the four long sides u goes across and v = 1/w along, w the
// depth z_e of that point, so that texels are laid out as the camera sees that side (Kozlov's perspective-warped cube
// map); the two ends are uniform. False if no ray leaves through this side.
static bool frustum_side(const ViewPlan* plan, uint side, float near_depth, float far_depth, PlannedView* view,
                         Homography* h) {
    float3 eye = to_float3(plan->eye);
    float4 axes[2] = {form_through(to_float3(plan->right), eye), form_through(to_float3(plan->up), eye)};
    float4 depth = form_through(to_float3(plan->forward), eye), one = (float4)(0.0f, 0.0f, 0.0f, 1.0f);
    float tangents[2] = {plan->right[3], plan->up[3]};
    float4 light = is_directional(plan) ? (float4)(to_light(plan), 0.0f) : (float4)(to_float3(plan->light), 1.0f);
    bool is_end = side >= 4;
    float4 plane;  // grows outwards
    if (is_end)
        plane = side == 4 ? depth - one * far_depth : one * near_depth - depth;
    else
        plane = ((side & 1u) ? -axes[side / 2] : axes[side / 2]) - depth * tangents[side / 2];
    if (!(dot4(plane, light) < 0.0f)) return false;

    for (int i = 0; i < 2; ++i) view->limit_low[i] = -1.0f - SIDE_RIM, view->limit_high[i] = 1.0f + SIDE_RIM;
    float4 form_u, form_v, form_w;
    if (is_end) {
        float z = side == 4 ? far_depth : near_depth;
        form_u = axes[0] / (tangents[0] * z);
        form_v = axes[1] / (tangents[1] * z);
        form_w = one;
    } else {
        uint across = 1 - side / 2;
        form_u = axes[across] / tangents[across];
        form_v = one;
        form_w = depth;
        view->limit_low[1] = (1.0f - SIDE_RIM) / far_depth;
        view->limit_high[1] = (1.0f + SIDE_RIM) / near_depth;
    }
    h->u = seen_through(form_u, plane, light);
    h->v = seen_through(form_v, plane, light);
    h->w = seen_through(form_w, plane, light);
    view->takes_logarithm = !is_end && plan->projection == PROJECTION_LOGPSM;
    view->is_front_only = !is_directional(plan);
    // Of a positional light's lines the half on this side of it leaves through the plane.
    float4 row = is_directional(plan) ? -light : (float4)(plane.xyz, -dot3(plane.xyz, light.xyz));
    view->row_depth[0] = row.x, view->row_depth[1] = row.y, view->row_depth[2] = row.z, view->row_depth[3] = row.w;
    return true;
}

#endif
