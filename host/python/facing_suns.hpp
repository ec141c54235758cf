// SPDX-License-Identifier: MIT
// Which suns stand strictly above the triangles of a raster's vertices (gnomon/studies/facing.py), as far as float64
// is certain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::python {

/// One triangle at each of n vertices: its normal, of whole numbers below 2^53, and whether there is one.
struct TrianglesAtVertices {
    std::span<const double> normals;  ///< 3 each
    std::span<const bool> exist;
};

/// Clears the bits of the chosen suns (3 numbers each, float32 values) that are certainly not above a vertex's
/// triangle: bit s % 32 of word s / 32 * n + vertex is sun s. Returns vertex and sun of the pairs that are not certain,
/// in pairs.
std::vector<std::uint32_t> clear_below(const TrianglesAtVertices& triangles, std::span<const double> suns,
                                       std::span<const bool> chosen, std::span<std::uint32_t> lit);

}  // namespace gnomon::python
