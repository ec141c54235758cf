// SPDX-License-Identifier: MIT
// clusters.cl for a direction's frame on a GPU (projection.h).
#define GN_DIRECTION_ALONE
#include "clusters.cl"
