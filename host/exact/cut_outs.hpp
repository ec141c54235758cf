// SPDX-License-Identifier: MIT
// Cut-outs as the kernels read them (kernels/exact/cut_outs.h).
#pragma once

#include <vector>

#include <gnomon.hpp>

namespace gnomon {

struct PackedCutOuts {
    std::vector<std::uint32_t> words;  ///< to be put behind the vertices; empty if every triangle is opaque
    CutOutCounts counts;
};

/// Throws InvalidArgument unless sizes match and all numbers name something.
PackedCutOuts pack_cut_outs(std::size_t triangle_count, const CutOuts& cut_outs);

}  // namespace gnomon
