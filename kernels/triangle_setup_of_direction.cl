// SPDX-License-Identifier: MIT
// triangle_setup.cl for a direction's frame on a GPU (projection.h).
#define GN_DIRECTION_ALONE
#include "triangle_setup.cl"
