// SPDX-License-Identifier: MIT
// Stage scan: exclusive prefix sums (kernels/lists/scan.cl).
#pragma once

#include "cl/session.hpp"

namespace gnomon {

class Scan {
public:
    /// offsets[0..count]: sums of counts rounded up to `alignment` (a power of two) before each, and the total.
    void run(cl::Session& session, std::uint32_t count, std::uint32_t alignment, const cl::Buffer& counts,
             const cl::Buffer& offsets);

private:
    cl::Buffer chunk_sums_;
};

}  // namespace gnomon
