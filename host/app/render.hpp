// SPDX-License-Identifier: MIT
// `gnomon render`: a scene in, pictures and figures out. Every error of the request is found before the long work;
// files appear only when all of them are complete.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// Throws UsageError, Error or std::bad_alloc; then no output was touched.
void render(const RenderOptions& options);

}  // namespace gnomon::app
