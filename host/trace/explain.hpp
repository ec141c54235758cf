// SPDX-License-Identifier: MIT
// What gnomon::explain() reports: exact signs by kernels/trace/explain.cl, and provenance in words.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

/// All but what a run of frustum-traced tells: visibility, stage and arithmetic are left empty.
Explanation explain_signs(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                          const Light& light);

/// Fills in what a watched run found for the point. `provenance`: PROVENANCE_....
void add_provenance(Explanation& explanation, std::uint32_t provenance, float visibility);

}  // namespace gnomon
