// SPDX-License-Identifier: MIT
// The report of gnomon::explain(): exact signs by kernels/trace/explain.cl, and provenance in words.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

/// The report without the result of a frustum-traced run: visibility, stage and arithmetic are empty.
Explanation explain_signs(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                          const Light& light);

/// Adds the result of a run that recorded the point's provenance. `provenance`: PROVENANCE_....
void add_provenance(Explanation& explanation, std::uint32_t provenance, float visibility);

}  // namespace gnomon
