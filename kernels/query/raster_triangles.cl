// SPDX-License-Identifier: MIT
// Writes the triangles of an implicit raster, nine floats each, for stages that read triangles only so.
#include "simd/points.h"

__kernel void raster_triangles(const uint count, __global const float* raster, __global float* vertices) {
    uint squares = ((__global const RasterHead*)raster)->columns - 1u;
    GN_FOR_EACH(id, count) {
        uint square = (uint)id >> 1;
        Triangle t = raster_triangle(raster, square / squares, square % squares, (uint)id & 1u);
        vstore3(t.a, 3 * id, vertices);
        vstore3(t.b, 3 * id + 1, vertices);
        vstore3(t.c, 3 * id + 2, vertices);
    }
}
