// SPDX-License-Identifier: MIT
// A GPU's trace of single shadow rays through a light tree (light_tree.h). Where points or lights are few, a ray's own
// walk meets fewer triangles than a shaft's. A group's items are a node's children, then a leaf's triangles. A pair
// that the filters leave undecided is queued; shaft_exact decides it.
//
// Filter of a ray and a leaf's triangles. Let a, b, c be the corners minus the ray's point P along the axes u, v, w of
// the light. e_c = a_u b_v - a_v b_u has the sign of det(A - P, B - P, D) but for errors, and where all three e have
// one sign, h = e_a a_w + e_b b_w + e_c c_w has it too exactly if the ray meets the triangle's plane beyond P: for the
// point X where the line meets it, w . (X - P) is the mean of a_w, b_w, c_w with the weights e, and w . D > 0.
//
// Bound. Let O be the leaf's origin, R = |P - O|_1, and S the sum of the sides of the leaf's box. A corner's coordinate
// from O rounds four times (a difference, three of the sum), by 4 x 2^-24 S at most; P's by 4 x 2^-24 R; their
// difference once more. So a_u is wrong by less than 3.1e-7 (S + R), and e_c by that times |a|_1 + |b|_1, by 3 x 2^-24
// (S + R) |b|_1 for its own roundings, and by 5.2e-8 (S + R) (|a|_1 + |b|_1), since u and v are not quite at right
// angles to D: by less than r (|a|_1 + |b|_1 + r) with r = 6.5e-7 (S + R), to which 2^-64 is added for underflow. h is
// wrong by less than that times |w|, and r |e|.
//
// Boxes. With the largest coordinate L a box's side rounds by less than 1.3e-6 L (its origin's coordinate, a corner's
// from it, their sum), a ray's by 4.2e-7 L, and u . D moves X by 1.8e-7 L: `rounding` is 4e-6 L.
#include "shafts/light_tree.h"
#include "shafts/shaft_walk.clh"

#if GN_LANES == 1

#define RAY_BOUND 6.5e-7f

// The launch's arguments, and what is the same for all rays.
typedef struct RayScene {
    ShaftScene tree;  // its leaves have the corners
    __global const float* light_nodes;
    __global const float* light_leaves;
    LightAxes axes;
    __global const LightBundle* bundle;
    uint bundle_index, light;
} RayScene;

// A shadow ray: its point in the scene and along the light's axes.
typedef struct Ray {
    float3 p;
    float u, v, w;
    uint point, receiver;
} Ray;

// ---- Boxes ----------------------------------------------------------------------------------------------------------

// How far x lies outside of the extent of the item's child, within the bound of rounding errors; inside: 0 or less.
static float outside_of(__global const float* rows, float x, float rounding) {
    rows += get_local_id(0);
    return fmax(rows[0] - (x + rounding), (x - rounding) - rows[SHAFT_WIDTH]);
}

// True if the ray may meet the item's child of a node.
static bool is_box_on_ray(__global const float* node, const Ray* ray, float rounding) {
    float outside_u = outside_of(node + LIGHT_LOW_U * SHAFT_WIDTH, ray->u, rounding);
    float outside_v = outside_of(node + LIGHT_LOW_V * SHAFT_WIDTH, ray->v, rounding);
    float before = (ray->w - rounding) - node[LIGHT_HIGH_W * SHAFT_WIDTH + get_local_id(0)];
    return outside_u <= 0.0f && outside_v <= 0.0f && before <= 0.0f;
}

// Pushes the children that a ray may meet, in any order: a ray ends at the first triangle that blocks it, and to sort
// them costs more than it spares.
static uint push_children_on_ray(__local uint* stack, uint top, __global const float* node, const Ray* ray,
                                 float rounding, __local uint* shared) {
    __global const uint* codes = (__global const uint*)node + LIGHT_CODES * SHAFT_WIDTH;
    uint bits = group_bits(is_box_on_ray(node, ray, rounding) ? -1 : 0, shared), item = get_local_id(0);
    if ((bits >> item & 1u) != 0u) stack[top + popcount(bits & ((1u << item) - 1u))] = codes[item];
    barrier(CLK_LOCAL_MEM_FENCE);
    return top + popcount(bits);
}

// ---- Triangles ------------------------------------------------------------------------------------------------------

// A ray's point from a leaf's origin, along the axes.
typedef struct LeafRay {
    float u, v, w;
    float rounding;  // r
    uint present;    // bit i: the leaf has a triangle i
} LeafRay;

static void set_leaf_ray(LeafRay* ray, __global const float* leaf, const LightAxes* axes, float3 p) {
    float3 from_origin = p - (float3)(leaf[0], leaf[1], leaf[2]);
    ray->u = along_axis(axes->u, from_origin);
    ray->v = along_axis(axes->v, from_origin);
    ray->w = along_axis(axes->w, from_origin);
    ray->rounding = RAY_BOUND * (sum_of_sizes(from_origin) + leaf[LIGHT_LEAF_SIZE]) + SHAFT_UNDERFLOW;
    ray->present = ((__global const uint*)leaf)[LIGHT_LEAF_PRESENT];
}

typedef enum RayDecision { RAY_MISSED, RAY_UNDECIDED, RAY_BLOCKED } RayDecision;

// For the item's triangle; `rows` are those of the leaf's corners.
static RayDecision decide_ray(__global const float* rows, const LeafRay* ray) {
    rows += get_local_id(0);
    float a_u = rows[0] - ray->u, a_v = rows[SHAFT_WIDTH] - ray->v;
    float b_u = rows[3u * SHAFT_WIDTH] - ray->u, b_v = rows[4u * SHAFT_WIDTH] - ray->v;
    float c_u = rows[6u * SHAFT_WIDTH] - ray->u, c_v = rows[7u * SHAFT_WIDTH] - ray->v;
    float e_a = fma(b_u, c_v, -(b_v * c_u)), e_b = fma(c_u, a_v, -(c_v * a_u)), e_c = fma(a_u, b_v, -(a_v * b_u));
    float sizes = ((fabs(a_u) + fabs(a_v)) + (fabs(b_u) + fabs(b_v))) + (fabs(c_u) + fabs(c_v));
    float bound = fma(sizes, ray->rounding, ray->rounding * ray->rounding + SHAFT_UNDERFLOW);
    float greatest = fmax(fmax(e_a, e_b), e_c), least = fmin(fmin(e_a, e_b), e_c);
    if (greatest > bound && least < -bound) return RAY_MISSED;  // two edges with certain signs that differ
    float a_w = rows[2u * SHAFT_WIDTH] - ray->w, b_w = rows[5u * SHAFT_WIDTH] - ray->w;
    float c_w = rows[8u * SHAFT_WIDTH] - ray->w;
    if (fmax(fmax(a_w, b_w), c_w) < -ray->rounding) return RAY_MISSED;
    bool is_negative = greatest < -bound;
    if (!is_negative && !(least > bound)) return RAY_UNDECIDED;
    float height = fma(e_a, a_w, fma(e_b, b_w, e_c * c_w));
    float height_bound = fma(bound, fabs(a_w) + fabs(b_w) + fabs(c_w), SHAFT_UNDERFLOW);
    height_bound = fma(ray->rounding, fabs(e_a) + fabs(e_b) + fabs(e_c), height_bound);
    if (is_negative) height = -height;
    if (height < -height_bound) return RAY_MISSED;
    return height > height_bound ? RAY_BLOCKED : RAY_UNDECIDED;
}

// For triangle i of a leaf, which decide_ray() does not say is missed. Where it is not certain the filter of a pair,
// whose bound is tighter where triangles are large, decides.
static bool is_blocked_by_triangle(const Ray* ray, uint leaf, uint i, bool is_certain, const RayScene* scene,
                                   Reservation* mine) {
    uint id = scene->tree.ids[leaf * SHAFT_WIDTH + i];
    bool is_masked = false;
#ifdef GN_CUT_OUTS
    is_masked = (id & SHAFT_MASKED) != 0u;
    id &= ~SHAFT_MASKED;
#endif
    if (id == ray->receiver) return false;
    if (is_certain && !is_masked) return true;
    ShaftPairs pair = {ray->point, scene->bundle_index, id, 1u << scene->light};
    __global const float* corners = scene->tree.leaves + (size_t)leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
    return is_pair_blocked(pair, ray->p, corners, i, is_masked, scene->bundle, &scene->tree, mine);
}

// Tests the triangles of a leaf. Returns whether one of them blocks the ray for certain.
static bool is_blocked_in_leaf(const Ray* ray, uint leaf, const RayScene* scene, Reservation* mine,
                               __local uint* shared) {
    __global const float* rows = scene->light_leaves + (size_t)leaf * (LIGHT_LEAF_ROWS * SHAFT_WIDTH);
    LeafRay from_leaf;
    set_leaf_ray(&from_leaf, rows, &scene->axes, ray->p);
    uint i = get_local_id(0);
    RayDecision decision = RAY_MISSED;
    if ((from_leaf.present >> i & 1u) != 0u) decision = decide_ray(rows + SHAFT_WIDTH, &from_leaf);
    bool blocks = decision != RAY_MISSED && is_blocked_by_triangle(ray, leaf, i, decision == RAY_BLOCKED, scene, mine);
    return group_bits(blocks ? -1 : 0, shared) != 0u;
}

// ---- Walk -----------------------------------------------------------------------------------------------------------

// *blocking: the leaf that blocked the last ray; neighbouring points are often in one shadow.
static bool is_blocked(const Ray* ray, const RayScene* scene, uint* blocking, Reservation* mine, __local uint* shared) {
    SHAFT_BEGIN_STACK(stack);
    uint top = 1u;
    if (*blocking != 0u) SHAFT_PUSH(stack, top, *blocking);
    while (top != 0u) {
        uint code = stack[--top];
        if ((code & SHAFT_LEAF) == 0u) {
            __global const float* node = scene->light_nodes + (size_t)code * (LIGHT_NODE_ROWS * SHAFT_WIDTH);
            top = push_children_on_ray(stack, top, node, ray, scene->tree.rounding, shared);
        } else if (is_blocked_in_leaf(ray, code & ~SHAFT_LEAF, scene, mine, shared)) {
            *blocking = code;
            return true;
        }
    }
    return false;
}

__kernel void ray_trace(const RayParams params, __global const LightBundle* bundles, __global const float* light_nodes,
                        __global const float* light_leaves, __global const float* leaves, __global const uint* ids,
                        __global const float* positions, __global const uint* receivers, __global uint* masks,
                        __global ShaftPairs* queue, __global ShaftCounters* counters, __local uint* shared) {
    RayScene scene = {{light_nodes, leaves, ids, queue, params.queue_capacity, params.rounding, counters},
                      light_nodes,
                      light_leaves,
                      params.axes,
                      &bundles[params.bundle],
                      params.bundle,
                      params.light};
    Reservation mine = no_reservation();
    uint tasks = (params.points.count + RAYS_OF_TASK - 1u) / RAYS_OF_TASK;
    masks += params.bundle * (size_t)params.mask_stride;
    uint blocking = 0u;
    SHAFT_FOR_EACH(task, tasks) {
        uint point = (uint)task * RAYS_OF_TASK;
        for (uint end = min(point + RAYS_OF_TASK, params.points.count); point < end; ++point) {
            if ((masks[point] >> params.light & 1u) == 0u) continue;
            float3 p = load_point(positions, params.points, point);
            if (!is_present(p)) continue;
            Ray ray = {p,
                       along_axis(params.axes.u, p),
                       along_axis(params.axes.v, p),
                       along_axis(params.axes.w, p),
                       point,
                       GN_NO_ID};
            if (params.points.has_receivers != 0u) ray.receiver = receivers[params.points.first / 3u + point];
            if (!is_blocked(&ray, &scene, &blocking, &mine, shared)) continue;
            barrier(CLK_GLOBAL_MEM_FENCE);  // all items have read the mask
            if (get_local_id(0) != 0) continue;
            masks[point] &= ~(1u << params.light);
        }
    }
    close_queue(&mine, &scene.tree);
}

#endif
