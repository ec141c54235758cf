// SPDX-License-Identifier: MIT
// Files as they were when gnomon was built; tools/embed_files.cmake writes the definitions.
#pragma once

#include <span>
#include <string_view>

namespace gnomon {

struct EmbeddedFile {
    std::string_view path;  ///< "kernels/techniques/izb.cl"
    std::string_view text;
};
std::span<const EmbeddedFile> embedded_kernels();
/// The texts of the command: help, the gallery's page.
std::span<const EmbeddedFile> embedded_texts();

}  // namespace gnomon
