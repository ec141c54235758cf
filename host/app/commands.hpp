// SPDX-License-Identifier: MIT
// The commands of gnomon: one function each, called by main() with the options.
#pragma once

#include "options.hpp"

namespace gnomon::app {

/// `gnomon render`: a scene in, pictures and figures out. Every error of the request is found before the long work;
/// files appear only when all of them are complete. Throws UsageError, Error or std::bad_alloc; then no output was
/// touched.
void render(const RenderOptions& options);

/// `gnomon explain`: prints why one pixel, or one point, is lit or in shadow. Throws UsageError or Error; if the
/// technique's visibility and the exact signs differ, prints the explanation and then throws Error.
void explain(const ExplainOptions& options);

/// `gnomon gallery`: runs every technique of the options on one view and writes one self-contained HTML page. If a
/// technique fails, the page has its error in place of a picture. Throws Error if there is nothing to show.
void gallery(const GalleryOptions& options);

/// `gnomon devices`, as text: the default with the reason, and what each lacks. Throws DeviceNotFound if there is none.
std::string device_list();

/// `gnomon techniques`, as text: a line each, with its settings under --verbose. Throws Error with the list for an
/// unknown name.
std::string technique_list(const ListTechniques& options);

}  // namespace gnomon::app
