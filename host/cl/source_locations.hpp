// SPDX-License-Identifier: MIT
// What a compiler that ignores #line says about a pasted program, with the true files and lines.
#pragma once

#include <string>

namespace gnomon::cl {

/// NVIDIA's compiler gives places as "<kernel>:LINE" of the whole text, whatever #line says: `log` with each of them
/// replaced by what the #line directives of `source` make of it ("kernels/trace/trace.cl:12"). Other logs stay as they
/// are.
std::string with_source_locations(const std::string& log, const std::string& source);

}  // namespace gnomon::cl
