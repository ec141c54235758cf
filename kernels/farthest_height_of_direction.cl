// SPDX-License-Identifier: MIT
// farthest_height.cl for a direction's frame on a GPU (projection.h).
#define GN_DIRECTION_ALONE
#include "farthest_height.cl"
