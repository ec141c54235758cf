// SPDX-License-Identifier: MIT
// Contract of horizons: over a height field, what the lights of a fan can be blocked by. A fan has lights of nearly one
// azimuth, at any height: a light above the field's horizon in the fan reaches a point, one below it does not. Bounds
// of the horizon come from the triangles near the point, one by one, and from the pyramid farther away. A light between
// them stays open, for shafts.
//
// Along the ground a fan is a strip: at a distance q from the point, measured along the strip's middle, it is
// half_width q wide on either side. A light's slope is its height over the ground, in units, at q = 1 half cell.
#pragma once

#include "lights/light_bundle.h"
#include "shafts/height_field.h"

// So many cells away, along its major axis, a strip's triangles are met one by one.
#define NEAR_CELLS 4
// Strips are wider than their lights by this, on either side, at q = 1.
#define STRIP_MARGIN 1e-4f

GN_STRUCT_BEGIN(HorizonFan)
    float along[2], across[2];  // q and the way across are their products with a vector along the ground
    float half_width;
    float near_reach;               // so far triangles are met one by one; the steps go on from there
    uint first_step, group_count;   // none: no light is decided
    float least[2], most[2];        // of the coordinates, in half cells, at q = 1
    uint major;                     // the axis of the ground along which the strip goes farther,
    int forward;                    // in this direction, 1 or -1
    float least_minor, most_minor;  // along the other axis, for each unit along this one
    float least_major, most_major;  // cells along the major axis at q = 1
    uint near_groups;               // so many first groups may be met triangle by triangle
    uint light_count;
    float slopes[MOST_BUNDLE_LIGHTS];
GN_STRUCT_END(HorizonFan, 208)

// A part of the strip, from q to `end`; an entry of a level of the pyramid holds it. Steps come in groups: a step over
// the whole group, then STEPS_OF_GROUP of its parts.
#define STEPS_OF_GROUP 8u
GN_STRUCT_BEGIN(HorizonStep)
    float low[2];  // the least coordinates of the part, from the point, in half cells
    float q, q_inverse, end;
    float size_inverse;         // of the level's squares
    uint first, columns, rows;  // of the level
    uint padding[3];
GN_STRUCT_END(HorizonStep, 48)

GN_STRUCT_BEGIN(HorizonParams)
    HeightField field;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;    // a fan each
    uint mask_stride;
    uint padding[2];
GN_STRUCT_END(HorizonParams, 144)
