// SPDX-License-Identifier: MIT
// Shading points: where a ray meets the triangle that it is known to meet, lifted off it. Contract and proof in
// camera.h.
#ifndef GN_SHADING_POINT_H
#define GN_SHADING_POINT_H

#include "camera_rays.h"

// The next float up, or down. On bits, since a device may flush denormals that it computes with.
static float next_towards(float x, bool up) {
    uint bits = as_uint(x);
    if ((bits << 1) == 0u) return as_float(up ? 0x00000001u : 0x80000001u);
    bool away_from_zero = (bits >> 31 == 0u) == up;
    return as_float(away_from_zero ? bits + 1u : bits - 1u);
}

// The nearest float to q on the side that `towards` points to; the nearest of all if it is 0. Never infinite.
static float rounded_towards(Wide q, Wide towards) {
    float x = float_of_wide(q);
    if (!GN_FINITE(x)) return wide_sign(q) > 0 ? FLT_MAX : -FLT_MAX;
    if (wide_sign(towards) > 0 && wide_less(wide_of_float(x), q)) x = next_towards(x, true);
    if (wide_sign(towards) < 0 && wide_less(q, wide_of_float(x))) x = next_towards(x, false);
    return GN_FINITE(x) ? x : copysign(FLT_MAX, x);
}

typedef struct Wide3 {
    Wide x, y, z;
} Wide3;

static Wide largest_coordinate(Wide3 v) {
    return wide_max(wide_max(wide_absolute(v.x), wide_absolute(v.y)), wide_absolute(v.z));
}

// A coordinate of the plane's normal with a small relative error.
static Wide normal_coordinate(Wide value, Wide size, Triangle t, float3 axis) {
    if (is_good(value, wide_mul(DET3_DOUBLE_BOUND, size))) return wide_add(value, WIDE_ZERO);  // no -0
    return exact_component(t, axis, (float3)(0.0f));
}

// The plane's normal, unnormalised, towards the eye.
static Wide3 normal_towards_eye(Det3Row normal, Triangle t, float3 eye) {
    Wide3 n;
    n.x = normal_coordinate(normal.x, normal.size_x, t, (float3)(1.0f, 0.0f, 0.0f));
    n.y = normal_coordinate(normal.y, normal.size_y, t, (float3)(0.0f, 1.0f, 0.0f));
    n.z = normal_coordinate(normal.z, normal.size_z, t, (float3)(0.0f, 0.0f, 1.0f));
    int level = DET3_BY_FLOAT;
    if (det3_sign(t.b, t.a, t.c, t.a, eye, t.a, &level) < 0) {
        n.x = wide_negated(n.x);
        n.y = wide_negated(n.y);
        n.z = wide_negated(n.z);
    }
    return n;
}

// LIFT_ULPS float32 ulps of a size below 2^128.
static Wide lift_of(Wide size) {
    return wide_mul(wide_of_float(LIFT_ULPS), wide_power_of_two(max(wide_exponent(size), -126) - 23));
}

// `hit` moved up along n by `lift` times its largest coordinate, and rounded up along it.
static float3 lifted(Wide3 hit, Wide3 n, Wide lift) {
    Wide scale = wide_div(lift, largest_coordinate(n));
    return (float3)(rounded_towards(wide_add(hit.x, wide_mul(scale, n.x)), n.x),
                    rounded_towards(wide_add(hit.y, wide_mul(scale, n.y)), n.y),
                    rounded_towards(wide_add(hit.z, wide_mul(scale, n.z)), n.z));
}

static Wide3 hit_of(float3 eye, Det3Row ray, Wide distance) {
    Wide3 hit;
    hit.x = wide_add(wide_of_float(eye.x), wide_mul(distance, ray.x));
    hit.y = wide_add(wide_of_float(eye.y), wide_mul(distance, ray.y));
    hit.z = wide_add(wide_of_float(eye.z), wide_mul(distance, ray.z));
    return hit;
}

static Wide eye_size_of(float3 eye) { return wide_of_float(fmax(fmax(fabs(eye.x), fabs(eye.y)), fabs(eye.z))); }

// What all points of a triangle share. Neighbours mostly see the same one.
typedef struct SeenTriangle {
    uint id;
    Triangle t;
    Plane plane;
    Wide3 n;
} SeenTriangle;

static SeenTriangle see_triangle(__global const float* vertices, uint id, float3 eye) {
    SeenTriangle seen;
    seen.id = id;
    seen.t = load_triangle(vertices, id);
    seen.plane = plane_of(seen.t, eye);
    seen.n = normal_towards_eye(seen.plane.normal, seen.t, eye);
    return seen;
}

static float3 shading_point(const SeenTriangle* seen, float3 eye, Ray ray) {
    Wide3 hit = hit_of(eye, ray_row(ray), wide_div(WIDE_ONE, nearness(seen->plane, seen->t, ray)));
    return lifted(hit, seen->n, lift_of(wide_max(largest_coordinate(hit), eye_size_of(eye))));
}

#endif
