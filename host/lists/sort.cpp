// SPDX-License-Identifier: MIT
#include "lists/sort.hpp"

#include <utility>

#include "kernels/lists/sort.h"

namespace gnomon {

void Sort::run(cl::Session& session, std::uint32_t count, cl::Buffer& keys, cl::Buffer& values) {
    const std::uint32_t piece = sort_piece(session.is_cpu()), pieces = (count + piece - 1) / piece;
    if (pieces == 0) return;
    const std::uint32_t counters = pieces * SORT_DIGITS;
    counts_.reserve(session, counters * sizeof(cl_uint));
    places_.reserve(session, (counters + 1) * sizeof(cl_uint));
    other_keys_.reserve(session, keys.bytes());
    other_values_.reserve(session, values.bytes());
    for (cl_uint shift = 0; shift < 32; shift += SORT_DIGIT_BITS) {
        session.launch("lists/sort.cl", "sort_count", cl::Range::items(pieces), count, shift, keys, counts_);
        scan_.run(session, counters, 1, counts_, places_);
        session.launch("lists/sort.cl", "sort_scatter", cl::Range::items(pieces), count, shift, keys, values, places_,
                       other_keys_, other_values_);
        std::swap(keys, other_keys_);
        std::swap(values, other_values_);
    }
}

}  // namespace gnomon
