// SPDX-License-Identifier: MIT
// The gallery as HTML: one file that needs no network and no other file. Pictures are data URIs.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "measure/visibility_errors.hpp"

namespace gnomon::app {

/// A diagnostic picture of a technique.
struct ExhibitDiagnostic {
    std::string name, meaning;
    std::string picture;  ///< data URI
};

/// A technique with its settings, and its results.
struct Exhibit {
    std::string name;      ///< as in `gnomon techniques`
    std::string settings;  ///< "key=value key=value", empty for the defaults
    std::string summary;   ///< one line
    bool exact = false;
    std::string failure;  ///< the error, if the technique failed; then no member below is set

    double median_ms = 0, least_ms = 0, most_ms = 0;
    std::uint64_t memory_bytes = 0;
    measure::VisibilityErrors errors;
    std::string picture, difference;  ///< data URIs
    std::vector<ExhibitDiagnostic> diagnostics;
};

/// The content of the page.
struct GalleryPage {
    std::string title;
    std::vector<std::pair<std::string, std::string>> facts;  ///< scene, camera, light, device, ...: label and text
    std::uint32_t width = 0, height = 0;
    std::vector<Exhibit> exhibits;
};

std::string html_of(const GalleryPage& page);

}  // namespace gnomon::app
