// SPDX-License-Identifier: MIT
// Sums over the items of a work-group, of any size.
#ifndef GN_GROUP_SCAN_H
#define GN_GROUP_SCAN_H

#include "prelude.h"

// Sets sums[item] to the sum of the values of items 0 to `item`, for all to read. Every item of the group must come
// here; what they wrote to global memory before is visible to all of them afterwards.
static void scan_group(uint value, __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    sums[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    for (uint step = 1; step < items; step *= 2) {
        uint before = item >= step ? sums[item - step] : 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        sums[item] += before;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

#endif
