// SPDX-License-Identifier: MIT
// Contract of the projections of shadow maps: the layout of a map's texels over the rays of its light.
//
// Light rays are points of a projective plane, so every linear projection of a shadow map is a homography of that
// plane: three rows u, v, w that vanish on the light (a point light's position, or a directional light's direction at
// infinity). All stages rely on the consequences:
//   - u, v and w are the same for a point and for every occluder that can shadow it, so casters beside or behind the
//     camera need no clipping, no "virtual camera" and no reversed depth order, for which perspective shadow maps are
//     known (Kozlov 2004, GPU Gems, chapter 14);
//   - a homography maps no two rays to one position, so the sign of w does not matter.
// Depth (map_view.h) is a row of its own, affine in world space: distance along the light, or along a face's axis.
//
// The families differ in the homography alone:
//   uniform  w = 1: orthographic (directional light); w = distance along a face's axis (point light, one of six faces)
//   psm      the light's perspective view of the camera's post-perspective cube (Stamminger and Drettakis 2002, in
//            Kozlov's practical form of 2004)
//   lispsm   w = y - y_c, y across the light along the view; the line y = y_c lies n = (z_n + sqrt(z_n z_f)) /
//            sin(gamma) before the view volume (Wimmer, Scherzer, Purgathofer 2004). Around a point light, on each face
//            of the cube, the same in the face's own coordinates: a search finds the direction and the line of least
//            error (point_light_perspective.h)
//   logpsm   directional light: as lispsm, with the y_c of least storage, and v taken logarithmically (Lloyd et al.
//            2008); with face partitions w = z_e of the point where the ray leaves the view volume
//   rtw      uniform, then a table per axis that moves texels to where they are needed (Rosen 2012)
// "Lloyd 2007" below is D. B. Lloyd, Logarithmic Perspective Shadow Maps, dissertation, University of North Carolina at
// Chapel Hill.
// Units: world units; u and v in [0, 1] over the map, depth in [0, 1] over the receivers.
// Limits: psm, lispsm and logpsm need the camera of the points (else views are uniform); the six faces of a cube
// (uniform, lispsm) or the sides of the view frustum (psm, logpsm) serve a point light. Faces are warped where they are
// fitted to the receivers.
#pragma once

#include "rivals/rasterizer/map_view.h"

#define PROJECTION_UNIFORM 0u
#define PROJECTION_PSM 1u
#define PROJECTION_LISPSM 2u
#define PROJECTION_LOGPSM 3u

// The target to which a view's rectangle is fitted.
#define FIT_RECEIVERS 0u  // the shading points of the view: the tightest
#define FIT_FRUSTUM 1u    // the slice of the view frustum, cut by the bounding box of the scene
#define FIT_CASTERS 2u    // the bounding box of the scene: the same for every camera
#define FIT_SPHERE 3u     // the slice's bounding sphere, its centre snapped to texels: no swimming (Valient 2008)
#define FIT_QUANTISED 4u  // the slice's bounds, scale and offset quantised: little swimming (Zhang et al. 2009)

#define PARTITION_SINGLE 0u  // one view
#define PARTITION_DEPTH 1u   // view_count slices of camera depth
#define PARTITION_FACES 2u   // one view per side of the view frustum that rays leave through
#define PARTITION_CUBE 3u    // six faces around a point light

#define RANGE_POINTS 0u  // the slices divide the range of the points' depths (Lauritzen, Salvi, Lefohn 2011)
#define RANGE_PLANES 1u  // the slices divide near_plane to far_plane

#define MAX_VIEWS 8u
// If a view shares texels with other views, its side is at most this many times the side of an even share.
#define MAX_SIDES 4u
// Its side has at least this many texels: beside its even shares the map has room for one row of that height per view.
#define MIN_SIDE 16u

// Depth range of the receivers: a thirty-second of the range stays free before the nearest receiver, so that a caster
// clamped to the near plane is before every receiver by more than any bias; and behind the farthest, so that the map
// has the surfaces from which points were lifted.
#define NEAR_MARGIN 0.03125f
#define FAR_MARGIN 0.03125f

// A run's settings and camera: host to device, by value.
GN_STRUCT_BEGIN(ViewPlan)
    float4 light;                 // homogeneous: w = 0 minus the direction of travel, w = 1 the position
    float4 eye;                   // w = 1: there is a camera; 0: none, and right, up and forward are not read
    float4 right, up;             // unit axes; w: the tangents of half the field of view along them
    float4 forward;               // unit axis
    float near_plane, far_plane;  // of RANGE_PLANES; 0: from the scene's diagonal
    float lambda;                 // split scheme: 0 uniform, 1 logarithmic
    float alpha;                  // share of resolution that goes to v: 0.5 is even (Lloyd 2007, eq. 6.1)
    float overlap;                // each slice is widened by this share of itself, at both ends, for filters
    float slide_back;             // psm: the camera is moved back by this, world units
    uint projection, fit, partition, range;
    uint view_count;
    uint map_size;           // texels per side of a square view; total texels are view_count map_size^2
    uint shares_resolution;  // 1: texels are shared out by error (Lloyd 2007, 6.4)
    uint atlas_columns;      // views side by side in one picture of that many columns; 0: one after the other
    uint self_similar;       // 1: depth slices of lambda 1 repeat the first one's fit (Lloyd 2007, eq. 6.2-6.3)
    uint keeps_casters;      // 1: the map also resolves depths before the receivers, as far as the scene's box reaches
    uint blends;             // 1: slices blend into the next one within its overlap
    uint padding[3];
GN_STRUCT_END(ViewPlan, 160)

// Least values over points, as float_to_key: of u, v, depth and w, then of their negatives. All ones: no point.
GN_STRUCT_BEGIN(KeyBounds)
    uint least[8];
GN_STRUCT_END(KeyBounds, 32)

// A view before its rectangle is fitted: map_projection_plan writes it; map_projection_bounds and map_projection_fit
// read it. Rows are as in map_view.h, but without scale and offset.
GN_STRUCT_BEGIN(PlannedView)
    float4 row_u, row_v, row_w, row_depth;  // of (p_world - origin, 1)
    float4 origin;                          // [3] unused
    uint takes_logarithm;                   // 1: v is spaced by the logarithm of w
    float limit_low[2], limit_high[2];      // u and v that belong to the view; rays beyond belong to other views
    float near_depth, far_depth;            // the slice, along the camera's forward axis
    float cover_near, cover_far;            // camera depths of the points that the view serves: slice and overlap
    float error_u, error_v;  // largest ratio of a texel of unit resolution to a pixel (Lloyd 2007: R_s, R_t)
    uint is_front_only;      // 1: only points with depth > 0 (in front of a point light)
    uint is_off;             // 1: no ray of light leaves the view volume through this side
    uint face;               // serves points that the light sees through this cube face; NO_FACE: the limits decide
    uint padding[2];
GN_STRUCT_END(PlannedView, 144)

// The input of one launch of map_projection_bounds: planned views [first_view, first_view + view_count).
GN_STRUCT_BEGIN(ViewRange)
    uint first_view, view_count;
    uint only_open;  // 1: open points alone
GN_STRUCT_END(ViewRange, 12)

#ifndef __cplusplus

// planned[0] and [1] are not views: the scene's box in world space, and camera depths. The views follow.
#define FIRST_VIEW 2

static bool is_empty(const KeyBounds* bounds) { return bounds->least[0] == 0xFFFFFFFFu; }
static float min_of(const KeyBounds* bounds, uint i) { return key_to_float(bounds->least[i]); }
static float greatest_of(const KeyBounds* bounds, uint i) { return -key_to_float(bounds->least[i + 4]); }

#endif
