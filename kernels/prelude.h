// SPDX-License-Identifier: MIT
// The base of every kernel and every contract: names that both compilers know, the rounding rules, and the loops that
// share a range out over all work-items.
//
// Rounding: every float operation rounds once, to nearest even. OpenCL C contracts a * b + c by default; the pragma
// below forbids it in all files that include this header (checked at start-up, see self_check.cl). Code that needs a
// fused product calls fma(). No relaxed-math build option is passed.
//
// Host-given macros: GN_FP64 (the device has double precision), GN_CPU (work-items run one after the other, so each
// takes a contiguous chunk), GN_LANES (points per work-item in the vector kernels: 16 on a CPU, 1 on a GPU),
// GN_KEEP_ITEMS_APART (a CPU's compiler has the extension cl_intel_vec_len_hint).
#pragma once

#ifndef __cplusplus

// A compiler for CPUs must not join work-items to vectors: kernels for CPUs are written with vectors. If Intel's
// compiler joins them, it crashes or gives wrong bits (docs/drivers.md), and takes six times as long.
#ifdef GN_KEEP_ITEMS_APART
#define __kernel __attribute__((intel_vec_len_hint(1))) kernel
#endif

#pragma OPENCL FP_CONTRACT OFF
#ifdef GN_FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

#define GN_STRUCT_BEGIN(name) typedef struct name {
#define GN_STRUCT_END(name, bytes) \
    }                              \
    name;                          \
    typedef char name##_has_size[sizeof(name) == (bytes) ? 1 : -1];
// For a size that is a multiple of 16 bytes: a GPU then reads and writes 16 bytes at a time instead of single members.
#define GN_ALIGNED_STRUCT_END(name, bytes) \
    }                                      \
    __attribute__((aligned(16))) name;     \
    typedef char name##_has_size[sizeof(name) == (bytes) ? 1 : -1];

// for (i over [0, n)), shared out over all work-items: a GPU's items take neighbours (coalesced), a CPU's chunks
// (cached).
#ifdef GN_CPU
#define GN_CHUNK(n) (((size_t)(n) + get_global_size(0) - 1) / get_global_size(0))
#define GN_FOR_EACH(i, n)                                                                 \
    for (size_t i = get_global_id(0) * GN_CHUNK(n),                                       \
                i##_end = min((size_t)(get_global_id(0) + 1) * GN_CHUNK(n), (size_t)(n)); \
         i < i##_end; ++i)
#else
#define GN_FOR_EACH(i, n) for (size_t i = get_global_id(0); i < (size_t)(n); i += get_global_size(0))
#endif

// for (i over [0, n)), shared out over the work-groups: all items of a group take the same i, of this type.
#define GN_FOR_EACH_BY_GROUP(type, i, n) \
    for (type i = (type)get_group_id(0); i < (type)(n); i += (type)get_num_groups(0))
// The same, shared out over the items of the work-group.
#define GN_FOR_EACH_IN_GROUP(i, n) for (uint i = (uint)get_local_id(0); i < (n); i += (uint)get_local_size(0))

// The part of [0, n) that a work-item takes, and the loop over that part: GN_FOR_EACH_OF(i, item_range(n)) is
// GN_FOR_EACH(i, n). In a kernel with GN_SHARES as its last parameter, launched with Session::shares(), the items of a
// CPU, one for each core, take GN_SHARED_RANGE(n) from a counter instead, a run of neighbours at a time: no core waits
// for another one's heavy part, and an item's own costs (counters, unused slots) arise once for each core. Such a
// kernel ends with GN_END_SHARES, which is true on a CPU for the last item to end.
#ifdef GN_CPU
#define GN_SHARES , volatile __global uint* shares
#define GN_SHARED_RANGE(n) shared_range(n, shares)
#define GN_END_SHARES end_shares(shares)

// The words of the launch's shares, 0 between launches, each in a cache line of its own.
#define SHARES_TAKEN 0
#define SHARES_ENDED 32

typedef struct ItemRange {
    size_t first, end;  // the run
    size_t left_first, count, length;
    volatile __global uint* taken;  // null: one run, which is not taken yet
    uint items, runs_before;
} ItemRange;
static ItemRange item_range(size_t n) {
    size_t first = get_global_id(0) * GN_CHUNK(n), end = min((get_global_id(0) + 1) * GN_CHUNK(n), n);
    return (ItemRange){first, end, 0, 0, 0, 0, 0, 0};
}
// A round has a run for each item. Each run is a quarter of the item's part of what the rounds before left: long runs
// first, for the caches' sake, and short ones at the end, when items wait for the last one.
static size_t length_of_runs(size_t left, uint items) { return left / (4 * (size_t)items) + 1; }
static ItemRange shared_range(size_t n, volatile __global uint* shares) {
    uint items = (uint)get_global_size(0);
    return (ItemRange){0, 0, 0, n, length_of_runs(n, items), &shares[SHARES_TAKEN], items, 0};
}
static bool take_run(ItemRange* of) {
    if (of->taken == 0) return of->items++ == 0u && of->first < of->end;
    uint run = atomic_inc(of->taken);
    while (run - of->runs_before >= of->items) {
        of->runs_before += of->items;
        of->left_first = min(of->left_first + of->items * of->length, of->count);
        of->length = length_of_runs(of->count - of->left_first, of->items);
    }
    of->first = of->left_first + (run - of->runs_before) * of->length;
    of->end = min(of->first + of->length, of->count);
    return of->first < of->count;
}
// True for the last item to end. It leaves the shares as the next launch needs them, and sees what all items wrote.
static bool end_shares(volatile __global uint* shares) {
    mem_fence(CLK_GLOBAL_MEM_FENCE);
    if (atomic_inc(&shares[SHARES_ENDED]) != (uint)get_global_size(0) - 1u) return false;
    atomic_xchg(&shares[SHARES_TAKEN], 0u);
    atomic_xchg(&shares[SHARES_ENDED], 0u);
    mem_fence(CLK_GLOBAL_MEM_FENCE);
    return true;
}
#define GN_FOR_EACH_OF(i, items)                             \
    for (ItemRange i##_runs = (items); take_run(&i##_runs);) \
        for (size_t i = i##_runs.first; i < i##_runs.end; ++i)
#else
#define GN_SHARES
#define GN_SHARED_RANGE(n) item_range(n)
#define GN_END_SHARES

typedef struct ItemRange {
    size_t first, end, step;
} ItemRange;
static ItemRange item_range(size_t n) { return (ItemRange){get_global_id(0), n, get_global_size(0)}; }
#define GN_FOR_EACH_OF(i, items) for (size_t i = (items).first; i < (items).end; i += (items).step)
#endif

// A function for a kernel's work. PoCL compiles a kernel three times, once for each way to call it, together with all
// inlined functions that read ids or meet a barrier. This function does neither and is compiled once.
#ifdef GN_CPU
#define GN_NOINLINE_ON_CPU __attribute__((noinline)) static
#else
#define GN_NOINLINE_ON_CPU static
#endif

// A part of a kernel that is a function only for the reader. On an NVIDIA GPU (driver 580) a kernel of the samples wing
// read and wrote addresses out of range when such parts were not inlined.
#define GN_INLINE __attribute__((always_inline)) static

// A function for the innermost loops. PoCL's compiler does not inline a function with several callers, and then passes
// its blocks of 16 lanes through memory.
#ifdef GN_CPU
#define GN_INLINE_ON_CPU GN_INLINE
#else
#define GN_INLINE_ON_CPU static
#endif

// Order-preserving map of floats to unsigned integers (no NaN), so that integer atomics find float minima.
static uint float_to_key(float x) {
    uint bits = as_uint(x);
    return (bits & 0x80000000u) ? ~bits : bits | 0x80000000u;
}
static float key_to_float(uint key) { return as_float((key & 0x80000000u) ? key & 0x7FFFFFFFu : ~key); }

// Loads a word (volatile) that other items change by atomics, only to save an atomic that would change nothing: the
// value may be stale, and the atomic decides. oclgrind reports every such load as a race; in its runs it is an atomic.
#ifdef GN_ATOMIC_RELAXED_LOADS
#define GN_RELAXED_LOAD(address) atomic_or(address, 0u)
#else
#define GN_RELAXED_LOAD(address) (*(address))
#endif

// Prefetches the bytes at an address if a CPU's compiler can. Changes no value.
#if defined(GN_CPU) && defined(__has_builtin) && !defined(__SPIRV__) && !defined(__SPIR__)
#if __has_builtin(__builtin_prefetch)
#define GN_PREFETCH(address) __builtin_prefetch(address)
#endif
#endif
#ifndef GN_PREFETCH
#define GN_PREFETCH(address) (void)(address)
#endif

#define GN_FINITE(x) (fabs(x) <= FLT_MAX)  // false for NaN too

#else  // C++

#include <cstdint>

namespace gnomon {
using uint = std::uint32_t;
using ulong = std::uint64_t;
using ushort = std::uint16_t;
struct alignas(16) float4 {
    float values[4];
    operator float*() { return values; }
    operator const float*() const { return values; }
};
}  // namespace gnomon

#define GN_STRUCT_BEGIN(name) \
    namespace gnomon {        \
    struct name {
#define GN_STRUCT_END(name, bytes)          \
    }                                       \
    ;                                       \
    static_assert(sizeof(name) == (bytes)); \
    }
#define GN_ALIGNED_STRUCT_END GN_STRUCT_END

#endif

// Half an ulp of 1: the relative error of one rounding to nearest.
#define GN_U 5.9604645e-8f

#define GN_NO_ID 0xFFFFFFFFu
