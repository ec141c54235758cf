// SPDX-License-Identifier: MIT
// Exact integers made from float32 coordinates: the reference's last word.
//
// Every finite float32 is an integer times 2^-149 and smaller than 2^128, so coordinates over a common power of two are
// integers of at most 277 bits. Nothing here rounds. The largest value anyone forms is the brute force's degree-seven
// product, under 1970 bits (see there); INTEGER_BITS leaves room above it. Only the limbs in use cost time.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <initializer_list>

namespace reference {

using Float3 = std::array<float, 3>;
using Triangle = std::array<Float3, 3>;

inline constexpr unsigned INTEGER_BITS = 2048;
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    INTEGER_BITS, INTEGER_BITS, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
using Integer3 = std::array<Integer, 3>;

/// No coordinate has a finer unit than 2^FINEST_EXPONENT.
inline constexpr int FINEST_EXPONENT = -149;

/// The largest e such that every coordinate of every vector is a multiple of 2^e (0 if all are zero). Finite input.
int common_exponent(std::initializer_list<Float3> vectors);

/// vector / 2^exponent, which must be integers.
Integer3 scaled(const Float3& vector, int exponent);

inline Integer3 operator-(const Integer3& a, const Integer3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integer3 cross(const Integer3& a, const Integer3& b);
Integer dot(const Integer3& a, const Integer3& b);
/// u . (v x w)
inline Integer determinant(const Integer3& u, const Integer3& v, const Integer3& w) { return dot(u, cross(v, w)); }
inline int sign(const Integer& value) { return value.sign(); }

/// A rational number times 2^exponent; the denominator is positive.
struct Quotient {
    Integer numerator;
    Integer denominator;
    int exponent = 0;

    /// Truncated to long double: relative error below 2^-62.
    long double value() const;
};

}  // namespace reference
