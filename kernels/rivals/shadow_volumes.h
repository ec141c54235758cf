// SPDX-License-Identifier: MIT
// Contract of the shadow volumes: the sides of a volume, and how a pixel's ray crosses them.
//
// Everything is relative to the eye. A pixel's ray is  ray(X, Y) = forward + X right + Y up  in pixels, and a shading
// point is w ray with view depth w. A side is the flat piece {a + s (b - a) + t c : 0 <= s <= 1, t >= 0} behind the
// edge ab (for a point light at S the direction c goes from a - S to b - S). Rays through it are the cone of a, b and
// the directions, so all tests are signs of functions that are linear in (X, Y):
//     inside the cone   det(u, v, ray) for its edges u, v
//     crossed before P  the eye and P lie on different sides of the side's plane  n . x = n . a:  w (n . ray) - n . a
// A work-item never divides or clips. It computes in float: this technique is not exact.
#pragma once

#include "prelude.h"

// The view and the ranges of a launch. right and up are a pixel's width and height; ray(0, 0) = forward is the
// picture's upper left corner.
GN_STRUCT_BEGIN(VolumeParams)
    ulong first_float;  // where the triangles begin in their buffer
    uint triangle_count;
    uint slot_count;              // of the hash table of edges: a power of two
    uint side_capacity;           // of the buffer of sides
    uint first_side, side_count;  // of the slice of sides that a launch draws
    uint cancels;                 // 1: sides that neighbouring triangles share cancel
    float4 light;                 // homogeneous: w = 0 minus the direction of travel, w = 1 the position
    float4 eye;                   // world; [3] unused
    float4 right;                 // world, [3] unused
    float4 up;                    // world, points down the picture; [3] unused
    float4 forward;               // world, [3] unused
    uint width, height;
    uint tiles_x, tiles_y;    // of TILE x TILE pixels
    uint blocks_x, blocks_y;  // of BLOCK x BLOCK tiles
    uint both_faces;          // 1: every triangle casts; 0: a triangle casts if its winding faces the light
    uint z_fail;              // 1: counts crossings behind the point, and caps; 0: counts crossings before the point
    uint pair_capacity;       // of the queue of (side, tile)
    uint padding[3];
GN_STRUCT_END(VolumeParams, 160)

// One triangle of rays: a volume's side, a half of one, or a cap. A form n . ray is linear in (X, Y): it has the
// coefficients n . right, n . up and n . forward.
GN_STRUCT_BEGIN(VolumeSide)
    float edges[9];     // the forms of the cone's three edges
    float plane[3];     // the form of the side's plane
    float plane_start;  // n . a
    int weight;         // number of volumes with this side, + where n points out of them; 0: nothing to draw
    uint cap_of;        // a cap's triangle: points on it always lie before it, whatever the rounding; else GN_NO_ID
    uint flags;         // bit i < 3: a ray exactly on edge i belongs to this side, not to its neighbour; AT_INFINITY
GN_STRUCT_END(VolumeSide, 64)

GN_STRUCT_BEGIN(VolumeCounters)
    uint casting;             // triangles that cast
    uint edges;               // of casting triangles, without those of length 0
    uint eye_inside;          // volumes that contain the eye (z-pass starts there)
    uint tiles_whole;         // (side, tile) pairs counted by one addition for all pixels
    uint pixels_written_low;  // additions to single pixels: 64 bits in two words
    uint pixels_written_high;
    uint padding[2];
GN_STRUCT_END(VolumeCounters, 32)

// A cap behind every point.
#define VOLUME_AT_INFINITY 8u

#define VOLUME_TILE 16
#define VOLUME_BLOCK 8
