// SPDX-License-Identifier: MIT
// Stage scan: exclusive prefix sums (kernels/lists/scan.cl).
#pragma once

#include "cl/session.hpp"

namespace gnomon {

class Scan {
public:
    /// offsets[0..count]: the sums of the counts before each, and the total, all at most 2^32 - 1.
    void run(cl::Session& session, std::uint32_t count, const cl::Buffer& counts, const cl::Buffer& offsets);

private:
    cl::Buffer chunk_sums_;
};

}  // namespace gnomon
