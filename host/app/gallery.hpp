// SPDX-License-Identifier: MIT
// `gnomon gallery`: every technique beside the exact truth, on one self-contained HTML page.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// Runs every technique of the options on one view and writes the page. If a technique fails, the page has its error in
/// place of a picture. Throws Error if there is nothing to show.
void gallery(const GalleryOptions& options);

}  // namespace gnomon::app
