// SPDX-License-Identifier: MIT
// facing.cl for a direction's frame on a GPU (projection.h).
#define GN_DIRECTION_ALONE
#include "facing.cl"
