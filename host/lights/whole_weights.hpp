// SPDX-License-Identifier: MIT
// Weights as whole numbers, whose sums do not depend on any order. Lights and the studies of the Python package use it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

struct WholeWeights {
    std::vector<std::int64_t> values;  ///< in units of 2^exponent
    int exponent = 0;
    double largest_rounding = 0;  ///< the most by which a weight was rounded
};

/// Rounds each weight once to a whole number times 2^exponent. The exponent depends on the largest of them and on their
/// number alone; all values together are at most 2^62. The weights must be finite.
WholeWeights round_weights(std::span<const double> weights);

}  // namespace gnomon
