// SPDX-License-Identifier: MIT
// Facing under a prepared light: which points stay open, without a pass of its own. What facing.cl says of a point is
// said here from what was prepared, by the block that is to be traced.
//
// Of each triangle the plane is kept, as (n, -n . a), turned towards the light: a receiver faces away if the eye is not
// above it. A float4 instead of nine floats and two exact signs, and the sign of n . eye - n . a is that of the exact
// determinants where it is beyond plane_bound(); else the predicate is asked. TRACE_BY_PLANES: by another kernel, since
// what the predicate needs of a GPU's registers slows a trace down that hardly ever asks it; here such points are
// strays.
//
// Bound. Let u = 2^-24, N the exact cross product of the computed one n, and s the sums of magnitudes in it (det3's
// float level), scaled by a power of two so that the largest is in [1/2, 1); E and A bound the coordinates of the eye
// and of all triangles. n is off by 4u s: that is 12u (E + A) of N . (eye - a). n . a meets 3 roundings when it is made
// and 2 when it is added: 15u A. The other products meet 3: 9u E. All in all less than 27.2u (E + A); 32u leaves room
// for second-order terms, the bound's own rounding, and what the cross product loses by underflow: 17 2^-106, of sums
// that are at least PLANE_LEAST. 2^-120 covers the underflow of the products here. Beyond 2^100 floats might overflow.
#ifndef GN_PREPARED_FACING_H
#define GN_PREPARED_FACING_H

#include "facing.h"
#include "lit_receivers.h"
#include "prepared_light.h"
#include "receivers.h"

#define PLANE_LEAST 0x1p-60f

// `largest`: coordinate of all finite triangles.
static float plane_bound(float largest, float3 eye) {
    float size = largest + fmax(fmax(fabs(eye.x), fabs(eye.y)), fabs(eye.z));
    return size <= 0x1p100f ? size * (32.0f * GN_U) + 0x1p-120f : INFINITY;
}

typedef struct PlaneBlock {
    PointBlock n;
    LaneFloat minus_offset;
} PlaneBlock;

// -inf as minus_offset: exactly edge-on, which faces away from every eye; inf: not finite, no plane to face anywhere;
// NaN: uncertain.
static PlaneBlock planes_towards_light(const TriangleBlock* t, const LaneCross* normals, LaneInt sides) {
    LaneFloat size = LANES_MAX(normals->size.x, normals->size.y);
    size = LANES_MAX(normals->size.z, size);
    LaneInt usable = normals->usable & LANE_COMPARE(size, >=, (LaneFloat)(PLANE_LEAST));
    // 2^-1 over the size's power of two, with the side's sign.
    LaneInt exponent = LANES_AS_INT(size) >> 23;
    LaneFloat scale = LANES_AS_FLOAT((LaneInt)(253 << 23) - (exponent << 23)) * LANES_TO_FLOAT(sides);
    PlaneBlock planes;
    planes.n.x = normals->value.x * scale;
    planes.n.y = normals->value.y * scale;
    planes.n.z = normals->value.z * scale;
    planes.minus_offset = -(planes.n.x * t->a.x + planes.n.y * t->a.y + planes.n.z * t->a.z);
    planes.minus_offset = LANES_SELECT((LaneFloat)(NAN), planes.minus_offset, usable);
    LaneInt edge_on = LANE_COMPARE(sides, ==, (LaneInt)(0)), finite = finite_triangles(t);
    planes.minus_offset = LANES_SELECT(planes.minus_offset, (LaneFloat)(-INFINITY), edge_on);
    planes.minus_offset = LANES_SELECT((LaneFloat)(INFINITY), planes.minus_offset, finite);
    LaneInt none = ~usable | edge_on | ~finite;
    planes.n.x = LANES_SELECT(planes.n.x, (LaneFloat)(0.0f), none);
    planes.n.y = LANES_SELECT(planes.n.y, (LaneFloat)(0.0f), none);
    planes.n.z = LANES_SELECT(planes.n.z, (LaneFloat)(0.0f), none);
    return planes;
}

// Those of the lanes `asked`, whose ids name triangles; the others repeat one of them.
static PlaneBlock load_planes(__global const float4* planes, LaneInt ids, LaneInt asked) {
    if (repeat_asked(&ids, asked)) {
        float4 one = planes[(uint)LANE_OF_INT(ids, 0)];
        PlaneBlock same = {same_point(one.x, one.y, one.z), (LaneFloat)(one.w)};
        return same;
    }
    __global const float* rows[GN_LANES];
    for (int lane = 0; lane < GN_LANES; ++lane)
        rows[lane] = (__global const float*)(planes + (uint)LANE_OF_INT(ids, lane));
    PlaneBlock p;
    p.n.x = LANES_OF_ROWS(rows, 0), p.n.y = LANES_OF_ROWS(rows, 1), p.n.z = LANES_OF_ROWS(rows, 2);
    p.minus_offset = LANES_OF_ROWS(rows, 3);
    return p;
}

// One by one, where the planes do not tell. Adds to *exact how many needed the exact level.
__attribute__((noinline)) static LaneInt settle_facing(LaneInt ids, LaneInt lanes, float4 light, float3 eye,
                                                       __global const float* vertices, uint* exact) {
    LaneInt away = (LaneInt)(0);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(lanes, lane)) continue;
        int level = DET3_BY_FLOAT;
        if (faces_away(load_triangle(vertices, (uint)LANE_OF_INT(ids, lane)), light, eye, &level))
            LANE_OF_INT(away, lane) = -1;
        *exact += level == DET3_BY_EXACT;
    }
    return away;
}

// What was prepared of the triangles as receivers.
typedef struct PreparedReceivers {
    __global const PreparedDomain* domains;
    __global const float4* planes;
    __global const uint* lit;        // bits
    __global const uint* slots;      // of the triangles' records
    __global const float* vertices;  // from the first triangle on
    float4 light;
    float3 eye;
    float bound;
    uint triangle_count;
} PreparedReceivers;

static PreparedReceivers prepared_receivers(LightFrame light_frame, PointsLayout layout, uint triangle_count,
                                            __global const PreparedDomain* domains, __global const float4* planes,
                                            __global const uint* largest, __global const uint* lit,
                                            __global const uint* slots, __global const float* vertices) {
    PreparedReceivers r;
    r.domains = domains;
    r.planes = planes;
    r.lit = lit;
    r.slots = slots;
    r.vertices = vertices;
    r.light = light_of(light_frame);
    r.eye = eye_of(layout);
    r.bound = plane_bound(as_float(*largest), r.eye);
    r.triangle_count = triangle_count;
    return r;
}

#if GN_LANES == 1
// GN_NO_ID where there is no such record.
static uint slot_of_receiver(const PreparedReceivers* r, LaneInt id) {
    return (uint)id < r->triangle_count ? r->slots[(uint)id] : GN_NO_ID;
}
#endif

// Which of the lanes `asked` face away from the light, as far as the planes tell; not so where `undecided`.
static LaneInt lanes_facing_away(const PreparedReceivers* r, LaneInt ids, LaneInt asked, LaneInt* undecided) {
    PlaneBlock p = load_planes(r->planes, ids, asked);
    LaneFloat above = (p.n.x * r->eye.x + p.n.y * r->eye.y) + (p.n.z * r->eye.z + p.minus_offset);
    *undecided = asked & ~LANE_COMPARE(fabs(above), >, (LaneFloat)(r->bound));
    return asked & ~*undecided & LANE_COMPARE(above, <, (LaneFloat)(0.0f));
}

#if TRACE_BY_PLANES
// Which of these lanes, lifted off receivers that face the light, nothing can shadow (lit_receivers.h).
static LaneInt lanes_on_lit_receivers(const PreparedReceivers* r, LaneInt ids, LaneInt asked,
                                      const PointBlock* points) {
    LaneInt lit = (LaneInt)(0);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        uint id = (uint)LANE_OF_INT(ids, lane);
        if (LANE_OF_INT(asked, lane) && is_lit_receiver(r->lit, id) &&
            is_certainly_within(load_triangle(r->vertices, id), lane_point(*points, lane), r->light.xyz))
            LANE_OF_INT(lit, lane) = -1;
    }
    return lit;
}
#endif

// Points by what becomes of them; the others are lit.
typedef struct PreparedFacing {
    LaneInt absent, away, open, doubtful, strays;
} PreparedFacing;

// `ids`: of their receivers, if they have any.
static PreparedFacing face_points(const PreparedReceivers* r, LightFrame light_frame, PointsLayout layout, size_t block,
                                  const PointBlock* points, LaneInt ids, uint* exact) {
    PreparedFacing facing;
    facing.away = facing.doubtful = (LaneInt)(0);
    LaneInt valid = valid_lanes(layout, block), open = valid & present_lanes(*points), undecided = (LaneInt)(0);
    facing.absent = valid & ~open;
    if (layout.has_receivers) {
        LaneInt asked = open & lanes_below(ids, r->triangle_count);
        if (LANES_ANY(asked)) {
#if TRACE_BY_PLANES
            facing.away = lanes_facing_away(r, ids, asked, &undecided);
            open &= ~lanes_on_lit_receivers(r, ids, asked & ~facing.away & ~undecided, points);
#else
            if (layout.is_lifted) {
                facing.away = lanes_facing_away(r, ids, asked, &undecided);
                if (LANES_ANY(undecided))
                    facing.away |= settle_facing(ids, undecided, r->light, r->eye, r->vertices, exact);
                undecided = (LaneInt)(0);
            } else {
                ReceiverAnswer answer = ask_receivers(ids, asked, points, layout, r->light, true, r->vertices, exact);
                facing.away = answer.faces_away;
                facing.doubtful = answer.doubtful;
            }
#endif
        }
    }
    open &= ~facing.away & ~undecided & LANE_COMPARE(frames_of(light_frame, *points), !=, (LaneInt)((int)LAMP_FRAMES));
    facing.open = prepared_lanes(light_frame, r->domains, *points, open, &facing.strays);
    facing.strays |= undecided;
    return facing;
}

#endif
