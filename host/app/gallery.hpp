// SPDX-License-Identifier: MIT
// `gnomon gallery`: every technique beside the exact truth, on one self-contained HTML page.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// Runs every technique asked for on one view and writes the page. A technique that fails has its sentence on the page
/// in place of a picture. Throws Error where nothing can be shown.
void gallery(const GalleryOptions& options);

}  // namespace gnomon::app
