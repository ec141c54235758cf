// SPDX-License-Identifier: MIT
// The right answers for the test of the predicates, in exact arithmetic on the host; no code shared with the kernels.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>

namespace predicates {

/// Six vectors u1, u0, v1, v0, w1, w0, finite; the determinant asked for is det(u1 - u0, v1 - v0, w1 - w0).
using Det3Case = std::array<float, 18>;

/// a, b, c of a triangle, the point, and the light (x, y, z, w).
using BlocksCase = std::array<float, 16>;

using Rational = boost::multiprecision::cpp_rational;

/// From the definition, in rationals. Slow.
Rational det3_in_rationals(const Det3Case& numbers);

/// Its sign: in 128-bit integers where all coordinates are within 40 bits of each other, else in long integers.
int sign_of_det3(const Det3Case& numbers);

/// The visibility contract for one triangle and one point, by the reference's brute force.
bool is_blocked(const BlocksCase& numbers);

}  // namespace predicates
