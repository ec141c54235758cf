// SPDX-License-Identifier: MIT
#include "lists/sort.hpp"

#include <utility>

#include "kernels/lists/sort.h"

namespace gnomon {

void Sort::run(cl::Session& session, std::uint32_t count, cl::Buffer& keys, cl::Buffer& values, std::uint32_t bits) {
    const std::uint32_t chunk = sort_chunk(session.is_cpu()), chunks = (count + chunk - 1) / chunk;
    if (chunks == 0) return;
    const std::uint32_t counters = chunks * SORT_DIGITS;
    counts_.reserve(session, counters * sizeof(cl_uint));
    slots_.reserve(session, (counters + 1) * sizeof(cl_uint));
    other_keys_.reserve(session, keys.bytes());
    other_values_.reserve(session, values.bytes());
    for (cl_uint shift = 0; shift < bits; shift += SORT_DIGIT_BITS) {
        const SortParams params{.count = count, .shift = shift};
        session.launch("lists/sort.cl", "sort_count", cl::Range::items(chunks), params, keys, counts_);
        scan_.run(session, counters, counts_, slots_);
        session.launch("lists/sort.cl", "sort_scatter", cl::Range::items(chunks), params, keys, values, slots_,
                       other_keys_, other_values_);
        std::swap(keys, other_keys_);
        std::swap(values, other_values_);
    }
}

}  // namespace gnomon
