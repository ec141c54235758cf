// SPDX-License-Identifier: MIT
// Exact answers on the host. See truth.hpp.
#include "truth.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "reference/exact.hpp"
#include "reference/visibility.hpp"

namespace predicates {
namespace {

__extension__ typedef __int128 Wide;

template <typename Number>
Number determinant(const std::array<Number, 9>& row) {
    return row[6] * (row[1] * row[5] - row[2] * row[4]) + row[7] * (row[2] * row[3] - row[0] * row[5]) +
           row[8] * (row[0] * row[4] - row[1] * row[3]);
}

/// x = mantissa * 2^(exponent - 150)
struct Parts {
    std::int32_t mantissa;
    int exponent;
};

Parts parts_of(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const int field = static_cast<int>(bits >> 23 & 0xFFu);
    const auto magnitude = static_cast<std::int32_t>((bits & 0x7FFFFFu) | (field != 0 ? 0x800000u : 0u));
    return {bits >> 31 != 0 ? -magnitude : magnitude, std::max(field, 1)};
}

/// The sign, if the coordinates over a common power of two are below 2^40: then differences are below 2^41, and the sum
/// of six products below 6 * 2^123 < 2^127.
bool sign_in_wide(const Det3Case& numbers, int* sign) {
    std::array<Parts, 18> parts;
    int lowest = 1000, highest = 0;
    for (std::size_t i = 0; i < 18; ++i) {
        parts[i] = parts_of(numbers[i]);
        if (parts[i].mantissa == 0) continue;
        const auto magnitude = static_cast<std::uint32_t>(std::abs(parts[i].mantissa));
        lowest = std::min(lowest, parts[i].exponent + std::countr_zero(magnitude));
        highest = std::max(highest, parts[i].exponent + static_cast<int>(std::bit_width(magnitude)));
    }
    if (highest - lowest > 40) return false;
    const auto scaled = [&](std::size_t i) {
        const int shift = parts[i].exponent - lowest;
        if (parts[i].mantissa == 0) return std::int64_t{0};
        return shift >= 0 ? static_cast<std::int64_t>(parts[i].mantissa) * (std::int64_t{1} << shift)
                          : static_cast<std::int64_t>(parts[i].mantissa) / (std::int64_t{1} << -shift);
    };
    std::array<Wide, 9> rows;
    for (std::size_t i = 0; i < 9; ++i) rows[i] = scaled(i + i / 3 * 3) - scaled(i + i / 3 * 3 + 3);
    const Wide value = determinant(rows);
    *sign = (value > 0) - (value < 0);
    return true;
}

int sign_in_integers(const Det3Case& numbers) {
    std::array<reference::Float3, 6> vectors;
    for (std::size_t i = 0; i < 18; ++i) vectors[i / 3][i % 3] = numbers[i];
    const int unit =
        reference::common_exponent({vectors[0], vectors[1], vectors[2], vectors[3], vectors[4], vectors[5]});
    std::array<reference::Integer3, 6> v;
    std::transform(vectors.begin(), vectors.end(), v.begin(),
                   [unit](const reference::Float3& vector) { return reference::scaled(vector, unit); });
    using reference::operator-;
    return reference::determinant(v[0] - v[1], v[2] - v[3], v[4] - v[5]).sign();
}

}  // namespace

Rational det3_in_rationals(const Det3Case& numbers) {
    std::array<Rational, 9> rows;
    for (std::size_t i = 0; i < 9; ++i)
        rows[i] = Rational(numbers[i + i / 3 * 3]) - Rational(numbers[i + i / 3 * 3 + 3]);
    return determinant(rows);
}

int sign_of_det3(const Det3Case& numbers) {
    int sign = 0;
    return sign_in_wide(numbers, &sign) ? sign : sign_in_integers(numbers);
}

bool is_blocked(const BlocksCase& numbers) {
    const std::span<const float> all(numbers);
    return reference::shadowed_by_brute_force(all.first(9), all.subspan(9, 3), {},
                                              {numbers[12], numbers[13], numbers[14], numbers[15]})[0] != 0;
}

}  // namespace predicates
