// SPDX-License-Identifier: MIT
// Contract of horizons: over a height field, a point's horizon decides the lights of a sector. A sector has lights of
// nearly one azimuth, at any height: a light above the field's horizon in the sector reaches the point, a light below
// it does not. Bounds of the horizon come from the triangles near the point, one by one, and from the pyramid farther
// away. A light between the bounds stays open, for point beams.
//
// Along the ground a sector is a strip: at a distance q from the point, measured along the strip's middle, it extends
// half_width q to either side. A light's slope is the height of its ray over the point, in units, at q = 1 half cell.
#pragma once

#include "horizons/height_field.h"
#include "lights/light_bundle.h"

// Up to this many cells away along its major axis, a strip's triangles are tested one by one.
#define NEAR_CELLS 4
// A strip is wider than its lights require by this much, on either side, at q = 1.
#define STRIP_MARGIN 1e-4f

GN_STRUCT_BEGIN(HorizonSector)
    float along[2], across[2];  // their dot products with a vector along the ground are q and the distance across
    float half_width;
    float near_reach;                // the q up to which triangles are tested one by one; steps begin there
    uint first_step, stretch_count;  // no stretch: no light is decided
    float least[2], most[2];         // extent of the strip's coordinates, in half cells, at q = 1
    uint major;                      // the axis of the ground along which the strip goes farther
    int forward;                     // the strip's direction along the major axis, 1 or -1
    float min_minor, max_minor;      // extent along the other axis, per unit along the major axis
    float min_major, max_major;      // extent along the major axis, in cells, at q = 1
    uint near_stretches;             // number of first stretches whose triangles may be tested one by one
    uint light_count;
    float slopes[MAX_BUNDLE_LIGHTS];
GN_STRUCT_END(HorizonSector, 208)

// A part of the strip, from q to `end`; one entry of a level of the pyramid contains it. Steps come in stretches: a
// step over the whole stretch, then STEPS_OF_STRETCH steps over its parts.
#define STEPS_OF_STRETCH 8u
GN_STRUCT_BEGIN(HorizonStep)
    float low[2];  // the least coordinates of the part, relative to the point, in half cells
    float q, q_inverse, end;
    float size_inverse;         // of the side of the level's squares
    uint first, columns, rows;  // of the level
    uint padding[3];
GN_STRUCT_END(HorizonStep, 48)

GN_STRUCT_BEGIN(HorizonParams)
    HeightField field;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;    // a sector each
    uint mask_stride;
    uint padding[2];
GN_STRUCT_END(HorizonParams, 144)
