// SPDX-License-Identifier: MIT
// Kernels of tests, in files beside the tests.
#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "cl/session.hpp"

namespace support {

/// Makes a kernel file of tests/ known to the session.
inline void add_kernel_file(gnomon::cl::Session& session, const std::string& file) {
    std::ifstream stream(GNOMON_TESTS "/" + file);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw std::runtime_error("cannot read " GNOMON_TESTS "/" + file);
    session.add_source(file, text.str());
}

}  // namespace support
