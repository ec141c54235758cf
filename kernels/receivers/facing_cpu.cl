// SPDX-License-Identifier: MIT
// The facing stage (facing.h) on a CPU: GN_LANES points at once, and receivers' facing from a cache that blocks fill as
// they need it.
#include "receivers/facing_blocks.clh"

FACING_KERNEL(facing, face_each)
FACING_KERNEL(facing_cached, face_cached)
FACING_KERNEL(facing_cached_footprints, face_cached_footprints)
