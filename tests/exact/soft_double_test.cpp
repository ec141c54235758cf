// SPDX-License-Identifier: MIT
// Double precision by integers (kernels/exact/soft_double.clh) against the host's own, bit for bit: every pair of
// special values, then random pairs near ties, cancellation, overflow and the denormals.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include "exact/predicates/cases.hpp"
#include "query/inputs.hpp"

namespace {

using predicates::Random;

constexpr const char* KERNELS = "soft_double_test.cl";
constexpr std::size_t RESULTS = 9;  // as in soft_double.cl
constexpr const char* NAMES[RESULTS] = {
    "x + y", "x - y", "x * y", "x / y", "sqrt(x)", "x < y", "x made a float", "float made double", "uint made double"};
constexpr std::uint64_t SIGN = 1ull << 63, INFINITE = 0x7FFull << 52, NOT_A_NUMBER = 0x7FF8ull << 48;

using Pair = std::array<std::uint64_t, 2>;
using Results = std::array<std::uint64_t, RESULTS>;

/// One NaN for all.
std::uint64_t bits_of(double x) { return std::isnan(x) ? NOT_A_NUMBER : std::bit_cast<std::uint64_t>(x); }

Results truth_of(const Pair& pair) {
    const auto x = std::bit_cast<double>(pair[0]), y = std::bit_cast<double>(pair[1]);
    const auto low = static_cast<std::uint32_t>(pair[1]);
    const auto narrow = static_cast<float>(x);
    return {bits_of(x + y),
            bits_of(x - y),
            bits_of(x * y),
            bits_of(x / y),
            bits_of(std::sqrt(x)),
            x < y,
            std::isnan(narrow) ? 0x7FC00000u : std::bit_cast<std::uint32_t>(narrow),
            bits_of(std::bit_cast<float>(low)),
            bits_of(low)};
}

std::vector<Pair> pairs_of_special_values() {
    std::vector<std::uint64_t> values;
    // Zero, the least and greatest denormals, powers of two around every limit of double and float, infinity, NaN; each
    // with its neighbours and its negative.
    for (const std::uint64_t exponent :
         {0,    1,    2,         53,        500,        1023 - 150, 1023 - 149, 1023 - 127, 1023 - 126, 1022,
          1023, 1024, 1023 + 52, 1023 + 53, 1023 + 127, 1023 + 128, 1500,       2045,       2046,       2047})
        for (const std::uint64_t fraction : {0ull, 1ull, 2ull, 1ull << 28, 1ull << 29, (1ull << 29) - 1, 3ull << 28,
                                             1ull << 51, (1ull << 52) - (1ull << 28), (1ull << 52) - 1})
            for (const std::uint64_t sign : {std::uint64_t{0}, SIGN})
                values.push_back(sign | exponent << 52 | fraction);
    for (const std::uint64_t bits : {0x00000001u, 0x80000001u, 0x007FFFFFu, 0x00800000u, 0x7F7FFFFFu, 0x7F800000u})
        values.push_back(bits);  // limits of float, in the lower half
    std::vector<Pair> pairs;
    for (const std::uint64_t x : values)
        for (const std::uint64_t y : values) pairs.push_back({x, y});
    return pairs;
}

/// Sparse or dense fraction: random bits, a run of ones, a single bit.
std::uint64_t random_fraction(Random& random) {
    const std::uint64_t all = (1ull << 52) - 1;
    switch (random.below(4)) {
        case 0:
            return random() & all;
        case 1:
            return all >> random.below(53);
        case 2:
            return all & ~(all >> random.below(53));
        default:
            return 1ull << random.below(52);
    }
}

std::uint64_t random_number(Random& random) {
    return (random() & SIGN) | static_cast<std::uint64_t>(random.below(2048)) << 52 | random_fraction(random);
}

Pair random_pair(Random& random) {
    const std::uint64_t x = random_number(random);
    switch (random.below(5)) {
        case 0:
            return {x, random_number(random)};
        case 1:
            return {x, x ^ SIGN ^ (random() & 7u)};  // cancels but for the last bits
        case 2: {                                    // exponents at most 60 apart: sums that round
            const auto exponent = static_cast<std::int64_t>((x & INFINITE) >> 52) + random.below(121) - 60;
            const auto clamped = static_cast<std::uint64_t>(std::clamp<std::int64_t>(exponent, 0, 2046));
            return {x, (random() & SIGN) | clamped << 52 | random_fraction(random)};
        }
        case 3: {  // products and quotients around the least numbers, narrowed ones around those of float
            const auto a = static_cast<std::uint64_t>(800 + random.below(100));
            const auto product =
                static_cast<std::uint64_t>(1023 - 1080 + 1023 - static_cast<int>(a) + random.below(70));
            return {(random() & SIGN) | a << 52 | random_fraction(random),
                    (random() & SIGN) | product << 52 | random_fraction(random)};
        }
        default: {  // halfway between two floats, and a little beside
            const std::uint64_t tie = (x & ~((1ull << 29) - 1)) | 1ull << 28;
            const auto exponent = static_cast<std::uint64_t>(1023 - 160 + random.below(300));
            return {((tie + static_cast<std::uint64_t>(random.below(3)) - 1) & ~INFINITE) | exponent << 52, random()};
        }
    }
}

/// Runs all pairs and expects the host's bits. The host adds in doubles (x86-64 and every other host we build for).
void expect_same_bits(const std::vector<Pair>& pairs) {
    static_assert(std::numeric_limits<double>::is_iec559);
    const gnomon::Device device;
    gnomon::cl::Session& session = session_of(device);
    std::ifstream stream(GNOMON_TESTS "/exact/predicates/soft_double.cl");
    std::ostringstream text;
    text << stream.rdbuf();
    ASSERT_TRUE(stream) << "cannot read " GNOMON_TESTS "/exact/predicates/soft_double.cl";
    session.add_source(KERNELS, text.str());
    const gnomon::cl::Buffer in(session, pairs.size() * sizeof(Pair)), out(session, pairs.size() * sizeof(Results));
    session.write(in.get(), pairs.data(), pairs.size() * sizeof(Pair));
    session.launch(KERNELS, "soft_double_results", gnomon::cl::Range::items(pairs.size()), cl_uint(pairs.size()), in,
                   out);
    std::vector<Results> results(pairs.size());
    session.read(out.get(), results.data(), results.size() * sizeof(Results));
    for (std::size_t k = 0; k < RESULTS; ++k) {
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (results[i][k] == truth_of(pairs[i])[k]) continue;
            if (++wrong <= 5)
                ADD_FAILURE() << NAMES[k] << std::hex << ", x = " << pairs[i][0] << ", y = " << pairs[i][1] << ": "
                              << results[i][k] << " instead of " << truth_of(pairs[i])[k];
        }
        EXPECT_EQ(wrong, 0u) << NAMES[k] << ", of " << pairs.size();
    }
}

TEST(SoftDouble, SpecialValuesHaveTheHostsBits) { expect_same_bits(pairs_of_special_values()); }

TEST(SoftDouble, RandomValuesHaveTheHostsBits) {
    Random random(1);
    std::vector<Pair> pairs(500000);
    for (Pair& pair : pairs) pair = random_pair(random);
    expect_same_bits(pairs);
}

}  // namespace
