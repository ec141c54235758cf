// SPDX-License-Identifier: MIT
#include "lists/sort.hpp"

#include <algorithm>
#include <utility>

#include "kernels/lists/sort.h"

namespace gnomon {
namespace {

// A GPU's local memory, 16 KiB or more, holds a chunk twice, and counts of this number of items.
constexpr std::size_t most_items = 64;
constexpr std::size_t digits_of_gpu = 1 << sort_digit_bits(false);

std::size_t items_of_group(const cl::Session& session) { return std::min(session.work_group_size(), most_items); }

// On a CPU a work-item takes a chunk, on a GPU a work-group.
cl::Range range_of(const cl::Session& session, std::size_t chunks) {
    if (session.is_cpu()) return cl::Range::shares(chunks);
    return cl::Range::groups(std::min(chunks, session.many_groups()), items_of_group(session));
}

// The words of local memory that sort_scatter needs.
std::size_t local_words(const cl::Session& session) {
    if (session.is_cpu()) return 1;
    return 2 * sort_chunk(false) + digits_of_gpu + (SORT_HALVES + 1) * items_of_group(session);
}

}  // namespace

void Sort::run(cl::Session& session, std::uint32_t count, cl::Buffer& keys, cl::Buffer& values, std::uint32_t bits) {
    const std::uint32_t chunk = sort_chunk(session.is_cpu()), chunks = (count + chunk - 1) / chunk;
    if (chunks == 0) return;
    const std::uint32_t digit_bits = sort_digit_bits(session.is_cpu()), counters = chunks << digit_bits;
    counts_.reserve(session, counters * sizeof(cl_uint));
    if (!session.is_cpu()) slots_.reserve(session, (counters + 1) * sizeof(cl_uint));
    other_keys_.reserve(session, keys.bytes());
    other_values_.reserve(session, values.bytes());
    const cl::Range range = range_of(session, chunks);
    const cl::LocalBytes of_digits{digits_of_gpu * sizeof(cl_uint)}, memory{local_words(session) * sizeof(cl_uint)};
    for (cl_uint shift = 0; shift < bits; shift += digit_bits) {
        const SortParams params{.count = count, .shift = shift};
        session.launch("lists/sort.cl", "sort_count", range, params, keys, counts_, of_digits);
        if (!session.is_cpu()) scan_.run(session, counters, counts_, slots_);
        session.launch("lists/sort.cl", "sort_scatter", range, params, keys, values,
                       session.is_cpu() ? counts_ : slots_, other_keys_, other_values_, memory);
        std::swap(keys, other_keys_);
        std::swap(values, other_values_);
    }
}

}  // namespace gnomon
