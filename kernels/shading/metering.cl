// SPDX-License-Identifier: MIT
// The light that most surfaces do not exceed. Contract: metering.h.
#include "shading/metering.h"

static uint meter_digits(uint pass) { return pass == 0u ? 2048u : 1024u; }

// Adds a pass's counts to `counts`, by work-groups: `of_group` has METER_DIGITS counts.
__kernel void meter_count(uint pass, uint pixels, __global const float* lights, __global const Meter* meter,
                          __global uint* counts, __local uint* of_group) {
    uint digits = meter_digits(pass), shift = METER_SHIFT(pass);
    GN_FOR_EACH_IN_GROUP(i, digits) of_group[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint chosen = pass == 0u ? 0u : meter->chosen;
    GN_FOR_EACH(i, pixels) {
        float light = lights[i];
        uint bits = as_uint(light + 0.0f);  // no -0
        if (light >= 0.0f && bits / digits >> shift == chosen) atomic_inc(of_group + (bits >> shift) % digits);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    GN_FOR_EACH_IN_GROUP(i, digits) {
        if (of_group[i] != 0u) atomic_add(counts + i, of_group[i]);
    }
}

// One work-group chooses a pass's digit, and clears the counts for the next pass. `sums`: one for each item.
__kernel void meter_choose(uint pass, __global uint* counts, __global Meter* meter, __local uint* sums) {
    uint digits = meter_digits(pass), items = (uint)get_local_size(0), item = (uint)get_local_id(0);
    uint each = (digits + items - 1u) / items, first = min(item * each, digits), last = min(first + each, digits);
    uint sum = 0u;
    for (uint i = first; i < last; ++i) sum += counts[i];
    sums[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0u) {
        Meter found = *meter;
        if (pass == 0u) {
            found.count = found.chosen = 0u;
            for (uint i = 0; i < items; ++i) found.count += sums[i];
            found.rank = (uint)((ulong)(max(found.count, 1u) - 1u) * METER_NUMERATOR / METER_DENOMINATOR);
        }
        uint part = 0u, digit;
        while (part + 1u < items && found.rank >= sums[part]) found.rank -= sums[part++];
        for (digit = part * each; digit + 1u < digits && found.rank >= counts[digit]; ++digit)
            found.rank -= counts[digit];
        found.chosen = found.chosen * digits + digit;
        *meter = found;
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint i = first; i < last; ++i) counts[i] = 0u;
}
