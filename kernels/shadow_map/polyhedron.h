// SPDX-License-Identifier: MIT
// The part of the scene that a slice of the view frustum can hold: the vertices of slice and box, intersected.
//
// Both are convex with six sides; every vertex of their intersection is a vertex of a side of one, clipped by the sides
// of the other (Sutherland and Hodgman 1974). Twelve polygons of at most ten vertices; of a vertex that several share
// each keeps its copy, which bounds do not mind.
#ifndef GN_SHADOW_POLYHEDRON_H
#define GN_SHADOW_POLYHEDRON_H

#include "projection.h"

#define MOST_VERTICES 120
#define MOST_POLYGON 12

typedef struct Polyhedron {
    float4 vertices[MOST_VERTICES];
    int count;
} Polyhedron;

static float3 to_float3(const float* v) { return (float3)(v[0], v[1], v[2]); }

static float dot3(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Corner i of the slice: bits 0, 1, 2 choose right, up, far.
static float3 slice_corner(const ViewPlan* plan, float near_depth, float far_depth, int i) {
    float depth = (i & 4) ? far_depth : near_depth;
    float x = ((i & 1) ? depth : -depth) * plan->right[3], y = ((i & 2) ? depth : -depth) * plan->up[3];
    return to_float3(plan->eye) + to_float3(plan->forward) * depth + to_float3(plan->right) * x +
           to_float3(plan->up) * y;
}

static float3 box_corner(float3 low, float3 high, int i) {
    return (float3)((i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z);
}

// The six sides of a body with corners numbered as above, each in turn around its rim.
__constant int side_corners[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

// The plane through three points, its normal away from `inside`.
static float4 plane_away_from(float3 a, float3 b, float3 c, float3 inside) {
    float3 u = b - a, v = c - a;
    float3 normal = (float3)(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    float4 plane = (float4)(normal, -dot3(normal, a));
    return dot3(normal, inside) + plane.w > 0.0f ? -plane : plane;
}

// Clips the polygon to the side of the plane its normal points away from; returns the new number of vertices.
static int clip_polygon(float3* polygon, int count, float4 plane) {
    float3 clipped[MOST_POLYGON];
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        float3 a = polygon[i], b = polygon[i + 1 < count ? i + 1 : 0];
        float at_a = dot3(plane.xyz, a) + plane.w, at_b = dot3(plane.xyz, b) + plane.w;
        if (at_a <= 0.0f && kept < MOST_POLYGON) clipped[kept++] = a;
        if ((at_a < 0.0f) != (at_b < 0.0f) && at_a != 0.0f && at_b != 0.0f && kept < MOST_POLYGON)
            clipped[kept++] = a + (b - a) * (at_a / (at_a - at_b));
    }
    for (int i = 0; i < kept; ++i) polygon[i] = clipped[i];
    return kept;
}

static void add_clipped_sides(Polyhedron* body, const float3* corners, const float3* clip_corners) {
    float3 inside = (float3)(0.0f);
    for (int i = 0; i < 8; ++i) inside += clip_corners[i] * 0.125f;
    for (int side = 0; side < 6; ++side) {
        float3 polygon[MOST_POLYGON];
        int count = 4;
        for (int i = 0; i < 4; ++i) polygon[i] = corners[side_corners[side][i]];
        for (int cut = 0; cut < 6 && count != 0; ++cut) {
            float4 plane = plane_away_from(clip_corners[side_corners[cut][0]], clip_corners[side_corners[cut][1]],
                                           clip_corners[side_corners[cut][2]], inside);
            count = clip_polygon(polygon, count, plane);
        }
        for (int i = 0; i < count && body->count < MOST_VERTICES; ++i)
            body->vertices[body->count++] = (float4)(polygon[i], 1.0f);
    }
}

// The slice inside the box or, if they do not meet, the slice.
static void make_view_volume(const ViewPlan* plan, float near_depth, float far_depth, float3 box_low, float3 box_high,
                             Polyhedron* body) {
    float3 slice[8], box[8];
    for (int i = 0; i < 8; ++i) {
        slice[i] = slice_corner(plan, near_depth, far_depth, i);
        box[i] = box_corner(box_low, box_high, i);
    }
    body->count = 0;
    add_clipped_sides(body, slice, box);
    add_clipped_sides(body, box, slice);
    if (body->count == 0)
        for (int i = 0; i < 8; ++i) body->vertices[body->count++] = (float4)(slice[i], 1.0f);
}

#endif
