// SPDX-License-Identifier: MIT
// Contract of the camera stages: what a pixel's ray is, and where a shading point lies.
//
// The ray of pixel (x, y) leaves the eye along the EXACT sum  r = column[x] + row[y],  each vector given as two float32
// vectors (high + low, 48 bits of what the host computed in double). So coverage can be decided exactly, on every
// device alike, and r differs from the camera's real ray by less than 2^-47 of its length.
//
// Visibility buffer: the nearest triangle that the open ray t > 0 meets, closed triangles, both faces, edge-on never.
// Hits are ordered by 1 / t, computed in double from determinants with a relative error below 2^-29 (evaluated exactly
// where double alone cannot promise that), ties by the smaller id. So of two hits nearer to each other than 2^-28 of
// their depth (1 / 16 ulp of float) either may win, and on every device the same one does.
//
// Shading point: Q = eye + t r + LIFT_ULPS unit n / |n|_max, n the plane's normal towards the eye, unit = one float32
// ulp of m = max(|Q|, |eye|) (largest coordinates); then each coordinate is rounded to float towards the sign of n's.
//   Never under the plane: the rounding moves P only up along n (each coordinate in n's own direction), and the error
//   of the hit along n is at most t |n . r| / |n| 2^-28 <= |Q - eye| 2^-28 < 2^-2 unit, far less than the lift. At most
//   16 ulp away: the lift is at most sqrt(3) LIFT_ULPS unit, the rounding at most sqrt(3) unit, the error of the hit at
//   most 2^-2 unit: together below 9 units for LIFT_ULPS = 4. Why 4: a flat floor's vertices are rounded by half an ulp
//   each; two neighbouring triangles then disagree about the floor by at most sqrt(3) / 2 units each, so 2 units clear
//   a floor whose vertices are no larger than m, and 4 units one whose vertices are up to twice that.
//
// Samples: the same with every pixel's ray moved by a fixed offset, in SAMPLE_UNITS of a pixel, so that it is exact.
#pragma once

#include "simd/points.h"
#include "simd/projection.h"

#define LIFT_ULPS 4.0f

// Offsets of samples are whole numbers of 1 / SAMPLE_UNITS pixels, less than half a pixel: no sample leaves its tile.
#define SAMPLE_UNITS 64

// A pixel tile is a bin of the camera's projection.
#define CAMERA_TILE_LOG2 4

// On a GPU a tile's list of more than CameraParams::long_list entries is walked by several work-groups, each of which
// takes a chunk of at most that many. A list is long only if it is a good part, 1 / LONG_LISTS, of all lists of the
// last frame, since a chunk does not see what hides its triangles in other chunks. (H100: 200,000 triangles within 30 x
// 30 pixels take 2.1 ms unsplit, .73 in chunks of 2048; with every list of over 2048 entries split pipes take 1.5 times
// as long.)
#define FIRST_LONG_LIST 16384u
#define MIN_LONG_LIST 2048u
#define LONG_LISTS 256u

// On a GPU there is a slot for an open pair (camera_filter.cl) per this number of pixels. (Sponza: one pair per 200.)
#define OPEN_PAIRS_EVERY 16u
#define OPEN_PAIRS_EVERY_WITH_CUT_OUTS 2u
#define MIN_OPEN_PAIRS 4096u

// A chunk of a tile's long list. The chunks of one tile follow one another.
GN_STRUCT_BEGIN(ListChunk)
    uint tile, index;
GN_STRUCT_END(ListChunk, 8)

// Floats per entry of the ray table: high xyz, low xyz. Entries: width columns, then height rows.
#define RAY_FLOATS 6

// The inputs of the ray table, doubles as bits: column x of a sample at position_x in its pixel is
//     forward + (x + position_x - half_width) pixel right,      row y   (half_height - (y + position_y)) pixel up,
// every operation rounded, from left to right.
GN_STRUCT_BEGIN(RayAxes)
    ulong right[3], up[3], forward[3];
    ulong pixel;
    ulong half_width, half_height;
    uint width, height;  // pixels
GN_STRUCT_END(RayAxes, 104)

// One sample of every pixel. Pixel i is point first_point + i of point_count.
GN_STRUCT_BEGIN(CameraParams)
    TrianglesLayout triangles;
    PictureRays picture;
    float eye[3];
    float offset[2];  // of the samples from the pixels' centres, pixels
    uint width, height;
    uint first_point, point_count;
    uint has_pixel_receivers;  // 0: the buffer of the pixels' receivers is not read
    uint long_list;
    uint chunk_count;  // for long_lists.cl
GN_STRUCT_END(CameraParams, 112)

// Points of a caller that are lifted off their receivers.
GN_STRUCT_BEGIN(LiftParams)
    ulong first_float;
    PointsLayout layout;
    float eye[3];
    uint triangle_count;
GN_STRUCT_END(LiftParams, 72)
