// SPDX-License-Identifier: MIT
// Contract of the sums over lights: what a run over many lights writes for each point, from the masks of its bundles.
// Weights are whole numbers, so that a sum does not depend on the order of its terms.
#pragma once

#include "lights/light_bundle.h"

#define WANTS_BITS 1u
#define WANTS_COUNTS 2u
#define WANTS_SUMS 4u
#define WANTS_FIRST 8u
#define WANTS_LAST 16u
// Each weight is multiplied by the cosine of the angle between the point's normal and the light.
#define WANTS_COSINES 32u

GN_STRUCT_BEGIN(LightSumsParams)
    uint first_point;  // of the sorted points
    uint point_count;
    uint first_bundle;  // the first bundle of the masks
    uint bundle_count;
    uint mask_stride;
    uint wants;
    uint words;      // of packed bits, per point
    uint is_sorted;  // `order` has the number of each sorted point; else a point's index is its number
    int exponent;    // a weight is its whole number times 2^exponent
    uint padding;
    PointsLayout normals;  // only `first` and the strides are used
GN_STRUCT_END(LightSumsParams, 88)

// A light of a bundle. Light l of a bundle has the slot MAX_BUNDLE_LIGHTS bundle + l.
GN_STRUCT_BEGIN(LightSlot)
    float direction[3];  // the unit vector towards the light, for cosines
    float weight;
    uint light;  // its index; GN_NO_ID: none
    uint padding[3];
GN_STRUCT_END(LightSlot, 32)

// weight_tables[(4 bundle + b) 256 + m]: the sum of the whole weights of the lights 8 b + i with bit i set in m.
#define WEIGHT_TABLE 256u
#define WEIGHT_TABLES (MAX_BUNDLE_LIGHTS / 8u)  // per bundle
