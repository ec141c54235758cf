// SPDX-License-Identifier: MIT
// Inputs for the test of the predicates, in four classes, each made of several kinds. A case depends on its class, its
// number and the seed alone, so that a failure can be repeated.
#pragma once

#include <cstdint>
#include <random>

#include "truth.hpp"

namespace predicates {

enum class Class {
    ordinary,         ///< random, of a scene's usual sizes
    near_degenerate,  ///< ulps off a plane, an edge or a line; near the origin and far from it; 48-bit differences
    degenerate,       ///< lattices, duplicates, zero vectors: mostly exact zeros
    extreme,          ///< the whole range of float32: denormals, 1e-38, 1e+38, differences that overflow, -0
};

const char* name_of(Class which);

/// splitmix64
class Random {
public:
    using result_type = std::uint64_t;
    explicit Random(std::uint64_t seed) : state_(seed) {}
    static constexpr result_type min() { return 0; }
    static constexpr result_type max() { return ~0ull; }
    result_type operator()() {
        std::uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    int below(int n) { return static_cast<int>((*this)() % static_cast<std::uint64_t>(n)); }
    bool once_in(int n) { return below(n) == 0; }
    /// In [-1, 1), a multiple of 2^-52.
    double unit() { return static_cast<double>(static_cast<std::int64_t>((*this)() >> 11) - (1ll << 52)) * 0x1p-52; }

private:
    std::uint64_t state_;
};

Det3Case det3_case(Class which, std::uint64_t seed, std::uint64_t number);
BlocksCase blocks_case(Class which, std::uint64_t seed, std::uint64_t number);

}  // namespace predicates
