// SPDX-License-Identifier: MIT
// Contract of the point order: points sorted so that neighbours in memory are neighbours in space on surfaces that face
// the same way: by the axis that their surface's normal follows most, then along a space-filling curve, absent points
// last; those of a picture by squares of its pixels. The order, and the surface normals, affect speed alone.
#pragma once

#include "lists/morton.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(PointOrderParams)
    TrianglesLayout triangles;  // of the receivers
    PointsLayout points;
    PointsLayout normals;  // `first` and the strides
    MortonGrid grid;
    uint has_normals;
    uint padding[3];
GN_STRUCT_END(PointOrderParams, 144)

// Bounds of the points' coordinates as keys (float_to_key): three minima, three maxima.
#define POINT_BOUNDS_WORDS 6u

// The grid has 2^(2 * POINT_CODE_BITS) cells per axis. The code's lower and upper halves are sorted one after the
// other.
#define POINT_CODE_BITS 8u

// A sample of sorted points takes this many neighbours at a time, as many as a packet (shafts/ray_packets.clh), so that
// shafts of blocks and packets are as thick as in the whole.
#define POINTS_OF_RUN 64u
