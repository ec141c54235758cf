// SPDX-License-Identifier: MIT
// Contract of rectilinear texture warping (Rosen 2012): moves texels along each axis to the parts of the map that the
// picture needs.
//
// The view's square is covered by WARP_SEGMENTS x WARP_SEGMENTS cells, each with an importance. A column (row) of cells
// needs its largest importance, blurred by a Gaussian so that neighbours differ little; the warp gives every
// column a share of the texels in proportion:
//   table[i] = (sum of the first i columns' importance) / (sum of all).
// An analysis finds the importance of a cell:
//   backward  from the camera's points: the largest importance of the points that lie in the cell
//   forward   from the light: the importance of the surface in a small map of WARP_SEGMENTS^2 texels
//   hybrid    backward, and forward's shadow edges
// It is the product of the chosen functions (d is 0 at the eye, 1 at the farthest point):
//   view      1 in the camera's view, 0 elsewhere
//   distance  1 - d
//   edge      1 + EDGE_GAIN where depth jumps to one of the 8 neighbours, by more than its slope explains (forward
//             only)
//   normal    1 + NORMAL_GAIN max(0, -n . view), n towards the eye: more where the surface is seen face on
// A cell without importance keeps MIN_IMPORTANCE of the largest, so that tables rise strictly. Texels are rasterized
// where the warp puts them (map_view.h): the errors of the original's coarse tessellation do not arise.
#pragma once

#include "rivals/shadow_map/map_projection.h"

#define WARP_SEGMENTS 256u
#define BLUR_SIGMA 3.0f  // cells
#define BLUR_REACH 9     // cells
#define MIN_IMPORTANCE 0.02f
#define EDGE_GAIN 2.0f
#define NORMAL_GAIN 2.0f  // beta of the paper
#define EDGE_JUMP 0.005f  // depth, of the receivers' range

#define ANALYSIS_NONE 0u
#define ANALYSIS_BACKWARD 1u
#define ANALYSIS_FORWARD 2u
#define ANALYSIS_HYBRID 3u

#define IMPORTANCE_VIEW 1u
#define IMPORTANCE_DISTANCE 2u
#define IMPORTANCE_EDGE 4u
#define IMPORTANCE_NORMAL 8u

GN_STRUCT_BEGIN(WarpPlan)
    uint analysis;
    uint functions;     // bits
    uint tables_first;  // where the views' warp tables begin, one after the other
    uint padding;
GN_STRUCT_END(WarpPlan, 16)
