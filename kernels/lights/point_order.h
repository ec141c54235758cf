// SPDX-License-Identifier: MIT
// Contract of the point order: points sorted so that neighbours in memory are neighbours in space on surfaces that face
// the same way. The order is by the axis that the surface's normal follows most, then along a space-filling curve;
// absent points come last. The points of a picture are ordered by squares of its pixels. The order and the surface
// normals affect only speed.
#pragma once

#include "lists/morton.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(PointOrderParams)
    TrianglesLayout triangles;  // of the receivers
    PointsLayout points;
    PointsLayout normals;  // only `first` and the strides are used
    MortonGrid grid;
    uint has_normals;
    uint padding[3];
GN_STRUCT_END(PointOrderParams, 144)

// Bounds of the points' coordinates as keys (float_to_key): three minima, three maxima.
#define POINT_BOUNDS_WORDS 6u

// The grid has 2^(2 * POINT_CODE_BITS) cells per axis. The code's lower and upper halves are sorted one after the
// other; above the upper half stands the axis of the normal.
#define POINT_CODE_BITS 8u
#define POINT_AXIS_BITS 3u

// A sample of the sorted points has runs of this many neighbours, as many as a packet (packets/ray_packets.clh), so
// that its beams and packets are as thick as those of all points.
#define POINTS_OF_RUN 64u
