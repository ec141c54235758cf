// SPDX-License-Identifier: MIT
// The trace of single shadow rays through a light tree (light_tree.h). Where points or lights are few, a ray's own walk
// meets fewer triangles than a shaft's. Lanes are a node's children, then a leaf's triangles. A pair that the filters
// leave undecided is queued; shaft_exact decides it.
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

// A CPU tests eight children or triangles at a time: sixteen do not fit into its registers. On a GPU each item tests
// its own.
#if GN_LANES > 1
typedef float8 EightFloat;
typedef int8 EightInt;
#define LOAD_EIGHT(row) vload8(0, row)
#define EIGHT_COMPARE(a, op, b) ((a)op(b))
#define EIGHT_SELECT(no, yes, mask) select(no, yes, mask)
#define EIGHT_AS_INT(x) as_int8(x)
#define EIGHT_AS_FLOAT(x) as_float8(x)
static uint bits_of_eight(int8 mask) {
#ifdef GN_X86_SIGNS
    return (uint)__builtin_ia32_movmskps256(as_float8(mask));
#else
    int8 bits = mask & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
    int4 four = bits.lo | bits.hi;
    return (uint)(four.x | four.y | four.z | four.w);
#endif
}
#else
typedef float EightFloat;
typedef int EightInt;
#define LOAD_EIGHT(row) ((row)[get_local_id(0)])
#define EIGHT_COMPARE(a, op, b) LANE_COMPARE(a, op, b)
#define EIGHT_SELECT(no, yes, mask) LANES_SELECT(no, yes, mask)
#define EIGHT_AS_INT(x) as_int(x)
#define EIGHT_AS_FLOAT(x) as_float(x)
static uint bits_of_eight(int mask) { return (uint)mask & 1u; }
#endif
#define EIGHT_MIN(a, b) EIGHT_SELECT(b, a, EIGHT_COMPARE(a, <, b))
#define EIGHT_MAX(a, b) EIGHT_SELECT(b, a, EIGHT_COMPARE(a, >, b))

// ---- Boxes ----------------------------------------------------------------------------------------------------------

// How far x lies outside of an extent, within the bound of rounding errors; inside: 0 or less.
static EightFloat outside_of(__global const float* rows, float x, float rounding) {
    EightFloat below = LOAD_EIGHT(rows) - (x + rounding), above = (x - rounding) - LOAD_EIGHT(rows + SHAFT_WIDTH);
    return EIGHT_MAX(below, above);
}

// The children of a node that a ray may meet: eight from `rows` on, or an item's own.
static EightInt boxes_on_ray(__global const float* rows, const Ray* ray, float rounding) {
    EightFloat outside = outside_of(rows + LIGHT_LOW_U * SHAFT_WIDTH, ray->u, rounding);
    EightFloat outside_v = outside_of(rows + LIGHT_LOW_V * SHAFT_WIDTH, ray->v, rounding);
    EightFloat before = (ray->w - rounding) - LOAD_EIGHT(rows + LIGHT_HIGH_W * SHAFT_WIDTH);
    outside = EIGHT_MAX(outside, outside_v);
    outside = EIGHT_MAX(outside, before);
    return EIGHT_COMPARE(outside, <=, (EightFloat)(0.0f));
}

// Pushes the children that a ray may meet, in any order: a ray ends at the first triangle that blocks it, and to sort
// them costs more than it spares (Sponza, sky: 164 against 152 ns a ray).
#if GN_LANES > 1
GN_INLINE_ON_CPU uint push_children_on_ray(uint* stack, uint top, __global const float* node, const Ray* ray,
                                           float rounding) {
    __global const uint* codes = (__global const uint*)node + LIGHT_CODES * SHAFT_WIDTH;
    uint low = bits_of_eight(boxes_on_ray(node, ray, rounding));
    uint high = bits_of_eight(boxes_on_ray(node + 8u, ray, rounding));
    for (uint bits = low | high << 8; bits != 0u;) stack[top++] = codes[take_lowest_bit(&bits)];
    return top;
}
#else
static uint push_children_on_ray(__local uint* stack, uint top, __global const float* node, const Ray* ray,
                                 float rounding, __local uint* shared) {
    __global const uint* codes = (__global const uint*)node + LIGHT_CODES * SHAFT_WIDTH;
    uint bits = group_bits(boxes_on_ray(node, ray, rounding), shared), item = get_local_id(0);
    if ((bits >> item & 1u) != 0u) stack[top + popcount(bits & ((1u << item) - 1u))] = codes[item];
    barrier(CLK_LOCAL_MEM_FENCE);
    return top + popcount(bits);
}
#endif

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

// Bit i: triangle i blocks the ray for certain, or it may.
typedef struct RayDecision {
    uint blocked, undecided;
} RayDecision;

// Eight triangles from `rows` on, or an item's own.
GN_INLINE_ON_CPU void decide_eight(__global const float* rows, const LeafRay* ray, uint present,
                                   RayDecision* decision) {
    EightFloat a_u = LOAD_EIGHT(rows) - ray->u, a_v = LOAD_EIGHT(rows + SHAFT_WIDTH) - ray->v;
    EightFloat b_u = LOAD_EIGHT(rows + 3u * SHAFT_WIDTH) - ray->u, b_v = LOAD_EIGHT(rows + 4u * SHAFT_WIDTH) - ray->v;
    EightFloat c_u = LOAD_EIGHT(rows + 6u * SHAFT_WIDTH) - ray->u, c_v = LOAD_EIGHT(rows + 7u * SHAFT_WIDTH) - ray->v;
    EightFloat e_a = fma(b_u, c_v, -(b_v * c_u)), e_b = fma(c_u, a_v, -(c_v * a_u)), e_c = fma(a_u, b_v, -(a_v * b_u));
    EightFloat sizes = ((fabs(a_u) + fabs(a_v)) + (fabs(b_u) + fabs(b_v))) + (fabs(c_u) + fabs(c_v));
    float least_bound = ray->rounding * ray->rounding + SHAFT_UNDERFLOW;
    EightFloat bound = fma(sizes, (EightFloat)(ray->rounding), (EightFloat)(least_bound));
    EightFloat greatest = EIGHT_MAX(e_a, e_b), least = EIGHT_MIN(e_a, e_b);
    greatest = EIGHT_MAX(greatest, e_c);
    least = EIGHT_MIN(least, e_c);
    EightFloat negative = -least, smaller = EIGHT_MIN(greatest, negative);
    decision->blocked = 0u;
    // Two edges with certain signs that differ: missed.
    decision->undecided = bits_of_eight(EIGHT_COMPARE(smaller, <=, bound)) & present;
    if (decision->undecided == 0u) return;
    EightFloat a_w = LOAD_EIGHT(rows + 2u * SHAFT_WIDTH) - ray->w, b_w = LOAD_EIGHT(rows + 5u * SHAFT_WIDTH) - ray->w;
    EightFloat c_w = LOAD_EIGHT(rows + 8u * SHAFT_WIDTH) - ray->w;
    EightFloat height = fma(e_a, a_w, fma(e_b, b_w, e_c * c_w));
    EightFloat height_bound = fma(bound, fabs(a_w) + fabs(b_w) + fabs(c_w), (EightFloat)(SHAFT_UNDERFLOW));
    height_bound = fma((EightFloat)(ray->rounding), fabs(e_a) + fabs(e_b) + fabs(e_c), height_bound);
    EightInt is_negative = EIGHT_COMPARE(greatest, <, -bound);
    EightInt has_sign = is_negative | EIGHT_COMPARE(least, >, bound);
    height = EIGHT_AS_FLOAT(EIGHT_AS_INT(height) ^ (is_negative & (int)0x80000000));
    EightFloat highest = EIGHT_MAX(a_w, b_w);
    EightInt missed = (has_sign & EIGHT_COMPARE(height, <, -height_bound)) |
                      EIGHT_COMPARE(EIGHT_MAX(highest, c_w), <, (EightFloat)(-ray->rounding));
    decision->blocked = decision->undecided & bits_of_eight(has_sign & EIGHT_COMPARE(height, >, height_bound));
    decision->undecided &= ~(decision->blocked | bits_of_eight(missed));
}

// Decides a pair that may block the ray, and is not certain by decide_eight(): by the shafts' filter, whose bound is
// tighter where triangles are large. Queues the pair if that is not certain either. Returns whether the triangle blocks
// the ray for certain.
GN_INLINE_ON_CPU bool is_blocked_by(const Ray* ray, uint leaf, uint i, uint id, const RayScene* scene,
                                    Reservation* mine) {
    ShaftTriangle t = shaft_triangle(scene->tree.leaves + (size_t)leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH), i);
    PointEdges edges = edges_of_point(&t, ray->p);
    LightDecision decision = decide_lights(&edges, scene->bundle, 1u << scene->light);
#ifdef GN_CUT_OUTS
    if ((id & SHAFT_MASKED) != 0u) decision = (LightDecision){0u, decision.dark | decision.undecided};
    id &= ~SHAFT_MASKED;
#endif
    ShaftPairs pairs = {ray->point, scene->bundle_index, id, decision.undecided};
    if (decision.undecided != 0u) queue_pairs(pairs, &t, ray->p, &scene->tree, mine);
    return decision.dark != 0u;
}

// For triangle i of a leaf, which decide_eight() does not say is missed.
GN_INLINE_ON_CPU bool is_blocked_by_triangle(const Ray* ray, uint leaf, uint i, bool is_certain, const RayScene* scene,
                                             Reservation* mine) {
    uint id = scene->tree.ids[leaf * SHAFT_WIDTH + i];
#ifdef GN_CUT_OUTS
    if ((id & ~SHAFT_MASKED) == ray->receiver) return false;
    is_certain = is_certain && (id & SHAFT_MASKED) == 0u;
#else
    if (id == ray->receiver) return false;
#endif
    return is_certain || is_blocked_by(ray, leaf, i, id, scene, mine);
}

// Tests the triangles of a leaf. Returns whether one of them blocks the ray for certain.
GN_INLINE_ON_CPU bool is_blocked_in_leaf(const Ray* ray, uint leaf, const RayScene* scene,
                                         Reservation* mine SHARED_PARAMETER) {
    __global const float* rows = scene->light_leaves + (size_t)leaf * (LIGHT_LEAF_ROWS * SHAFT_WIDTH);
    LeafRay from_leaf;
    set_leaf_ray(&from_leaf, rows, &scene->axes, ray->p);
    RayDecision decision;
#if GN_LANES > 1
    for (uint first = 0; first < SHAFT_WIDTH; first += 8u) {
        uint present = from_leaf.present >> first;
        if (present == 0u) return false;
        decide_eight(rows + SHAFT_WIDTH + first, &from_leaf, present, &decision);
        for (uint bits = decision.blocked | decision.undecided; bits != 0u;) {
            uint bit = take_lowest_bit(&bits);
            bool is_certain = (decision.blocked >> bit & 1u) != 0u;
            if (is_blocked_by_triangle(ray, leaf, first + bit, is_certain, scene, mine)) return true;
        }
    }
    return false;
#else
    uint i = get_local_id(0);
    decide_eight(rows + SHAFT_WIDTH, &from_leaf, from_leaf.present >> i & 1u, &decision);
    bool blocks = (decision.blocked | decision.undecided) != 0u &&
                  is_blocked_by_triangle(ray, leaf, i, decision.blocked != 0u, scene, mine);
    return group_bits(blocks ? -1 : 0, shared) != 0u;
#endif
}

// ---- Walk -----------------------------------------------------------------------------------------------------------

// *blocking: the leaf that blocked the last ray; neighbouring points are often in one shadow.
GN_INLINE_ON_CPU bool is_blocked(const Ray* ray, const RayScene* scene, uint* blocking,
                                 Reservation* mine SHARED_PARAMETER) {
    SHAFT_BEGIN_STACK(stack);
    uint top = 1u;
    if (*blocking != 0u) SHAFT_PUSH(stack, top, *blocking);
    while (top != 0u) {
        uint code = stack[--top];
        if ((code & SHAFT_LEAF) == 0u) {
            __global const float* node = scene->light_nodes + (size_t)code * (LIGHT_NODE_ROWS * SHAFT_WIDTH);
            top = push_children_on_ray(stack, top, node, ray, scene->tree.rounding SHARED);
        } else if (is_blocked_in_leaf(ray, code & ~SHAFT_LEAF, scene, mine SHARED)) {
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
            if (!is_blocked(&ray, &scene, &blocking, &mine SHARED)) continue;
#if GN_LANES == 1
            barrier(CLK_GLOBAL_MEM_FENCE);  // all items have read the mask
            if (get_local_id(0) != 0) continue;
#endif
            masks[point] &= ~(1u << params.light);
        }
    }
    close_queue(&mine, &scene.tree);
}
