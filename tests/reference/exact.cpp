// SPDX-License-Identifier: MIT
// Exact integers made from float32 coordinates. See exact.hpp.
#include "exact.hpp"

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>

namespace reference {
namespace {

/// x = mantissa * 2^exponent with an odd mantissa (0 for zero).
struct Parts {
    std::int32_t mantissa = 0;
    int exponent = 0;
};

Parts parts_of(float x) {
    if (x == 0) return {};
    int exponent = 0;
    const float fraction = std::frexp(x, &exponent);                            // 0.5 <= |fraction| < 1
    const auto mantissa = static_cast<std::int32_t>(std::ldexp(fraction, 24));  // exact: 24 bits
    const int zeros = std::countr_zero(static_cast<std::uint32_t>(mantissa));
    return {mantissa / (1 << zeros), exponent - 24 + zeros};
}

}  // namespace

int common_exponent(std::initializer_list<Float3> vectors) {
    int lowest = INT_MAX;
    for (const Float3& vector : vectors)
        for (const float x : vector)
            if (x != 0) lowest = std::min(lowest, parts_of(x).exponent);
    return lowest == INT_MAX ? 0 : lowest;
}

Integer3 scaled(const Float3& vector, int exponent) {
    Integer3 result;
    for (int i = 0; i < 3; ++i) {
        const Parts parts = parts_of(vector[i]);
        if (parts.mantissa == 0) continue;
        result[i] = std::abs(parts.mantissa);
        result[i] <<= static_cast<unsigned>(parts.exponent - exponent);
        if (parts.mantissa < 0) result[i] = -result[i];
    }
    return result;
}

Integer3 cross(const Integer3& a, const Integer3& b) {
    return {Integer(a[1] * b[2] - a[2] * b[1]), Integer(a[2] * b[0] - a[0] * b[2]), Integer(a[0] * b[1] - a[1] * b[0])};
}

Integer dot(const Integer3& a, const Integer3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

long double Quotient::value() const {
    if (numerator.is_zero()) return 0;
    // Give the integer quotient 70 bits or more, so that what the division drops is below 2^-69 of it.
    Integer magnitude = abs(numerator);
    Integer divisor = denominator;
    const int shift = 70 + static_cast<int>(msb(divisor)) - static_cast<int>(msb(magnitude));
    if (shift > 0)
        magnitude <<= static_cast<unsigned>(shift);
    else
        divisor <<= static_cast<unsigned>(-shift);
    Integer quotient = magnitude / divisor;
    const int drop = static_cast<int>(msb(quotient)) - 63;  // keep the leading 64 bits
    quotient >>= static_cast<unsigned>(drop);
    const long double leading = static_cast<long double>(static_cast<std::uint64_t>(quotient));
    const long double result = std::ldexp(leading, exponent - shift + drop);
    return numerator.sign() < 0 ? -result : result;
}

}  // namespace reference
