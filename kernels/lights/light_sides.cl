// SPDX-License-Identifier: MIT
// Decides facing for many lights at once (light_sides.h), exactly. The side of a light relative to a receiver's plane
// is the sign of n . D, which lanes_side() decides; relative to a normal, lanes_normal_faces() decides it.
//
// First, a filter decides all lights of a cone together. With s D = m + u a + v b, s > 0 and |u|, |v| <= 1
// (light_bundle.h), n . D is positive for all of them if n . m > |n . a| + |n . b|. S is the sum of the sizes of n's
// coordinates; for a receiver's normal, of the sizes of both products of each coordinate. In units of 2^-24 S: the
// errors of such a normal (two differences, a product, a difference: 4 of a coordinate's size) make each of the three
// dot products wrong by 4, since no coordinate of m, a and b exceeds 1; each dot product rounds by 3, and their sums by
// 5. Together this is 26, less than 32.
//
// The side of a point light is the sign of n . (S - base), where base is a point of the plane. For a box of lights the
// four dot products, with m - base and with three axes, are together wrong by 8 times a reach that bounds the sum of
// their largest coordinates, and their sums by 4 times that reach.
#include "exact/normal_side.clh"
#include "lights/light_sides.h"
#include "receivers/facing.clh"

typedef struct SidedPoints {
    PointBlock points;
    TriangleBlock receivers;
    LaneCross receiver_normals;
    PointBlock normals;
    LaneInt sided;  // the lanes with a side
    LaneInt eye_side;
    PointBlock base;       // for point lights a point of the plane; else 0
    LaneFloat cone_bound;  // error bound of the cone's filter; infinite: the filter is never certain
} SidedPoints;

// The number of lights in a quarter of a bundle, which has a cone of its own.
#define LIGHTS_OF_CONE (MAX_BUNDLE_LIGHTS / 4u)
#define FIRST_SMALL_CONE 3u

static TriangleBlock gather_triangles(Triangles triangles, LaneInt ids, LaneInt lanes) {
#ifdef GN_RASTER
    TriangleBlock block;
    for (int lane = 0; lane < GN_LANES; ++lane) {
        Triangle t = load_triangle(triangles.vertices, LANE_OF_INT(lanes, lane) ? (uint)LANE_OF_INT(ids, lane) : 0u);
        set_lane(&block.a, lane, t.a);
        set_lane(&block.b, lane, t.b);
        set_lane(&block.c, lane, t.c);
    }
    return block;
#else
    __global const float* rows[GN_LANES];
    for (uint lane = 0; lane < GN_LANES; ++lane)
        rows[lane] = triangles.vertices + 9 * (size_t)(LANE_OF_INT(lanes, lane) ? (uint)LANE_OF_INT(ids, lane) : 0u);
    return load_triangle_rows(rows);
#endif
}

static LaneFloat cone_bound(PointBlock sizes) {
    return (fabs(sizes.x) + fabs(sizes.y) + fabs(sizes.z)) * (32.0f * 0x1p-24f) + 0x1p-98f;
}

static SidedPoints load_sided(const LightSidesParams params, size_t block, __global const float* vertices,
                              __global const float* positions, __global const uint* receivers,
                              __global const float* normals, uint* exact) {
    SidedPoints s;
    s.points = load_block(positions, params.points, block);
    s.base = same_point(0.0f, 0.0f, 0.0f);
    s.sided = valid_lanes(params.points, block) & present_lanes(s.points);
    if (params.side == SIDE_NORMALS) {
        s.normals = load_block(normals, params.points, block);
        s.sided &= present_lanes(s.normals);
        s.eye_side = (LaneInt)(1);
        s.cone_bound = cone_bound(s.normals);
#ifdef GN_POINT_LIGHTS
        s.base = s.points;
#endif
        return s;
    }
    Triangles triangles = triangles_of(vertices, params.triangles);
    LaneInt ids = load_lane_ids(receivers + params.points.first / 3u, params.points, block);
    s.sided &= lanes_below(ids, triangles.count);
    s.receivers = gather_triangles(triangles, ids, s.sided);
    s.sided &= finite_triangles(&s.receivers);
    s.receiver_normals = triangle_normals(&s.receivers);
    s.normals = s.receiver_normals.value;
#ifdef GN_POINT_LIGHTS
    s.base = s.receivers.a;
#endif
    s.cone_bound = LANES_SELECT((LaneFloat)(INFINITY), cone_bound(s.receiver_normals.size), s.receiver_normals.usable);
    s.eye_side = (LaneInt)(1);
    if (params.side == SIDE_EYE) {
        float3 at = eye_of(params.points);
        PointBlock eye = same_point(at.x, at.y, at.z);
        s.eye_side = lanes_side(&s.receivers, &s.receiver_normals, &eye, &s.receivers.a, s.sided, exact);
    }
    return s;
}

// The lanes whose points face a light.
static LaneInt lanes_face(const SidedPoints* s, uint side, float3 direction, uint* exact) {
    if (side == SIDE_NORMALS) return lanes_normal_faces(&s->normals, direction, &s->base, s->sided);
    PointBlock towards = same_point(direction.x, direction.y, direction.z);
    LaneInt light_side = lanes_side(&s->receivers, &s->receiver_normals, &towards, &s->base, s->sided, exact);
    return s->sided & LANE_COMPARE(light_side, ==, s->eye_side) & LANE_COMPARE(light_side, !=, (LaneInt)(0));
}

static LaneFloat normals_along(const PointBlock* n, __global const float* d) {
    return fma(n->x, d[0], fma(n->y, d[1], n->z * d[2]));
}

// The values of n . D over the lights of a cone: their middle, the largest difference from it, the bound of its error.
typedef struct ConeAlongNormals {
    LaneFloat middle, radius, bound;
} ConeAlongNormals;

static ConeAlongNormals cone_along_normals(const SidedPoints* s, __global const LightCone* cone) {
    ConeAlongNormals found;
    found.radius = fabs(normals_along(&s->normals, cone->across)) + fabs(normals_along(&s->normals, cone->along));
#ifdef GN_POINT_LIGHTS
    PointBlock d = difference(same_point(cone->middle[0], cone->middle[1], cone->middle[2]), s->base);
    found.middle = fma(s->normals.x, d.x, fma(s->normals.y, d.y, s->normals.z * d.z));
    found.radius += fabs(normals_along(&s->normals, cone->planes[0]));
    float3 sizes = fabs(vload3(0, cone->across)) + fabs(vload3(0, cone->along)) + fabs(light_box_depth(cone));
    LaneFloat reach = fabs(d.x) + fabs(d.y) + fabs(d.z) + (sizes.x + sizes.y + sizes.z + 1.0f);
    // If a product may overflow, terms that should cancel do not: nothing is certain.
    LaneFloat bound = s->cone_bound * reach;
    found.bound = LANES_SELECT((LaneFloat)(INFINITY), bound, LANE_COMPARE(bound, <, (LaneFloat)(0x1p100f)));
#else
    found.middle = normals_along(&s->normals, cone->middle);
    found.bound = s->cone_bound;
#endif
    return found;
}

// *face: the lanes that face all lights of a cone; other lanes face none. True if that is certain for all sided lanes.
static bool cone_is_certain(const SidedPoints* s, __global const LightCone* cone, LaneInt* face) {
    ConeAlongNormals n = cone_along_normals(s, cone);
    LaneInt front = LANE_COMPARE(n.middle - n.radius, >, n.bound),
            back = LANE_COMPARE(n.middle + n.radius, <, -n.bound);
    LaneInt side = LANES_SELECT(LANES_SELECT((LaneInt)(0), (LaneInt)(-1), back), (LaneInt)(1), front);
    *face = s->sided & LANE_COMPARE(side, ==, s->eye_side);
    return !LANES_ANY(s->sided & ~(front | back));
}

// The lights of a bundle that each point faces.
static LaneInt lights_faced(const SidedPoints* s, uint side, __global const LightBundle* bundle, uint* exact) {
    uint count = bundle->light_count;
    LaneInt face, mask = (LaneInt)((int)(count < 32u ? (1u << count) - 1u : GN_NO_ID));
    if (side == SIDE_NONE) return mask;
    if (cone_is_certain(s, &bundle->cones[0], &face)) return mask & (face | ~s->sided);
    for (uint first = 0; first < count; first += LIGHTS_OF_CONE) {
        LaneInt all = (LaneInt)((int)(((1u << LIGHTS_OF_CONE) - 1u) << first));
        if (cone_is_certain(s, &bundle->cones[FIRST_SMALL_CONE + first / LIGHTS_OF_CONE], &face)) {
            mask &= ~(s->sided & ~face & all);
            continue;
        }
        for (uint l = first; l < min(count, first + LIGHTS_OF_CONE); ++l)
            mask &= ~(s->sided & ~lanes_face(s, side, light_direction(bundle, l), exact) & (LaneInt)((int)(1u << l)));
    }
    return mask;
}

GN_NOINLINE_ON_CPU void decide_light_sides(ItemRange items, const LightSidesParams params,
                                           __global const LightBundle* bundles, __global const float* vertices,
                                           __global const float* positions, __global const uint* receivers,
                                           __global const float* normals, __global uint* masks) {
    uint exact = 0;
    GN_FOR_EACH_OF(block, items) {
        SidedPoints s;
        if (params.side != SIDE_NONE) s = load_sided(params, block, vertices, positions, receivers, normals, &exact);
        for (uint b = 0; b < params.bundle_count; ++b) {
            LaneInt mask = lights_faced(&s, params.side, &bundles[b], &exact);
            store_lanes(LANES_AS_FLOAT(mask), (__global float*)(masks + b * (size_t)params.mask_stride), params.points,
                        block);
        }
    }
}

__kernel void light_sides(const LightSidesParams params, __global const LightBundle* bundles,
                          __global const float* vertices, __global const float* positions,
                          __global const uint* receivers, __global const float* normals, __global uint* masks) {
    decide_light_sides(item_range(block_count(params.points)), params, bundles, vertices, positions, receivers, normals,
                       masks);
}
