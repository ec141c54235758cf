// SPDX-License-Identifier: MIT
// Contract of the self-check: the faults of a device's arithmetic that it can find, one bit each.
#pragma once

#include "prelude.h"

// A device with one of these faults is refused.
#define FAULT_FUSED 0            // a * b + c is rounded once
#define FAULT_REORDERED 1        // (a - (s - b)) + ... is simplified as if nothing rounded
#define FAULT_ROUNDING 2         // + and * do not round to nearest even
#define FAULT_FMA 3              // fma() rounds twice
#define FAULT_DENORMAL_COPIED 4  // a denormal changes by being loaded, chosen, negated or stored
#define FAULT_INTEGERS 5         // 64-bit products, shifts, carries
#define FAULT_KEYS 6             // keys of floats do not keep their order, or atomic_min and atomic_max do not
#define FAULT_EXACT 7            // the exact predicate gives a wrong sign
#define FAULT_ITEMS_MIXED 8      // the same, where neighbouring work-items take different ways through it
#define FAULT_REFUSED 0x1FFu     // all of the above

// These switch double precision off.
#define FAULT_DOUBLE_FUSED 9
#define FAULT_DOUBLE_REORDERED 10
#define FAULT_DOUBLE_ROUNDING 11    // + * / sqrt, and the way back to float
#define FAULT_DENORMAL_WIDENED 12   // a denormal float becomes zero when it is made a double
#define FAULT_DENORMAL_NARROWED 13  // a double becomes another denormal float than the nearest

// This one switches to the kernels for GPUs, which have no vectors.
#define FAULT_WIDE_VECTORS 14  // of 16 floats: the compiler's target has no registers for them (x86)

#define SELF_CHECK_FAULTS 15

// The kernel's result: the faults, and the least and the greatest key over all work-items.
GN_STRUCT_BEGIN(SelfCheckResult)
    uint faults;
    uint min_key;
    uint greatest_key;
    uint zero;  // read: 0, which no compiler can know
GN_STRUCT_END(SelfCheckResult, 16)
