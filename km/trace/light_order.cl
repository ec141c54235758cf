// SPDX-License-Identifier: MIT
// The light order of points (light_order.h): the extent of sampled runs, codes, sorted copies, and the way back.
#include "trace/light_order.h"

// The position in the light's plane. Under a directional light the plane is that of the frame's grid. Under a point
// light the directions from the light are folded into a square as an octahedron is (Meyer et al., "On floating-point
// normal vectors", 2010).
static float2 position_in_light_plane(LightFrame frame, float3 p) {
    float at[3] = {p.x, p.y, p.z};
    if (!IS_PERSPECTIVE(frame))
        return (float2)(at[frame.axis_x] - frame.shear_x * at[frame.axis_z],
                        at[frame.axis_y] - frame.shear_y * at[frame.axis_z]);
    float3 d = p - (float3)(frame.light[0], frame.light[1], frame.light[2]);
    float2 folded = d.xy / (fabs(d.x) + fabs(d.y) + fabs(d.z));
    float2 outer = copysign(1.0f - fabs(folded.yx), folded);
    return d.z < 0.0f ? outer : folded;
}

// The box in the light's plane of each sampled run: low x, low y, high x, high y.
__kernel void light_order_extents(const LightOrderParams params, __global const float* positions,
                                  __global float4* boxes) {
    GN_FOR_EACH(run, params.run_count) {
        float2 low = (float2)(INFINITY), high = (float2)(-INFINITY);
        for (uint i = 0; i < LIGHT_ORDER_RUN; ++i) {
            float3 p = load_point(positions, params.points, run * params.run_stride + i);
            if (!is_present(p)) continue;
            float2 at = position_in_light_plane(params.light_frame, p);
            low = fmin(low, at);
            high = fmax(high, at);
        }
        boxes[run] = (float4)(low, high);
    }
}

// Puts a zero between each two bits.
static uint spread_bits_by_one(uint x) {
    x = (x | x << 4) & 0x0F0Fu;
    x = (x | x << 2) & 0x3333u;
    return (x | x << 1) & 0x5555u;
}

__kernel void light_order_codes(const LightOrderParams params, __global const float* positions, __global uint* codes,
                                __global uint* numbers) {
    GN_FOR_EACH(i, params.points.count) {
        float3 p = load_point(positions, params.points, i);
        float2 at = position_in_light_plane(params.light_frame, p) - vload2(0, params.origin);
        float most = (float)((1u << LIGHT_ORDER_BITS) - 1u);
        uint2 cell = convert_uint2_sat(fmin(fmax(at * vload2(0, params.scale), 0.0f), most));
        uint code = spread_bits_by_one(cell.x) | spread_bits_by_one(cell.y) << 1;
        codes[i] = is_present(p) ? code : (1u << 2u * LIGHT_ORDER_BITS) - 1u;
        numbers[i] = (uint)i;
    }
}

__kernel void light_order_gather(const LightOrderParams params, __global const float* positions,
                                 __global const uint* receivers, __global const uint* numbers,
                                 __global float* sorted_positions, __global uint* sorted_receivers) {
    GN_FOR_EACH(i, params.points.count) {
        uint number = numbers[i];
        vstore3(load_point(positions, params.points, number), i, sorted_positions);
        if (params.points.has_receivers != 0u) sorted_receivers[i] = receivers[number];
    }
}

__kernel void light_order_scatter(uint count, __global const float* sorted, __global const uint* numbers,
                                  __global float* visibility) {
    GN_FOR_EACH(i, count) visibility[numbers[i]] = sorted[i];
}
