// SPDX-License-Identifier: MIT
// Stage sort: keys and their values in the order of the keys (kernels/lists/sort.h).
#pragma once

#include "lists/scan.hpp"

namespace gnomon {

class Sort {
public:
    /// Puts the first `count` keys and values in order of the keys' lowest `bits`. The buffers may be swapped with
    /// others of the same size.
    void run(cl::Session& session, std::uint32_t count, cl::Buffer& keys, cl::Buffer& values, std::uint32_t bits = 32);

private:
    Scan scan_;
    cl::Buffer counts_, slots_, other_keys_, other_values_;
};

}  // namespace gnomon
