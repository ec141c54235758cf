// SPDX-License-Identifier: MIT
// Messages about a pasted program, from a compiler that ignores #line, with the true files and lines.
#pragma once

#include <string>

namespace gnomon::cl {

/// NVIDIA's compiler gives locations as "<kernel>:LINE" of the whole text, whatever #line gives. Returns `log` with
/// each such location replaced by the location that the #line directives of `source` give
/// ("kernels/trace/trace.cl:12"). Other logs are not changed.
std::string with_source_locations(const std::string& log, const std::string& source);

}  // namespace gnomon::cl
