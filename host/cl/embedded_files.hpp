// SPDX-License-Identifier: MIT
// Files as they were when gnomon was built; tools/embed_files.cmake writes the definitions.
#pragma once

#include <span>
#include <string_view>

namespace gnomon {

struct EmbeddedFile {
    std::string_view path;  ///< "kernels/rivals/izb.cl"
    std::string_view text;
};
std::span<const EmbeddedFile> embedded_kernels();
std::span<const EmbeddedFile> embedded_kernels_of_samples();
std::span<const EmbeddedFile> embedded_kernels_of_shading();
std::span<const EmbeddedFile> embedded_kernels_of_sight();
std::span<const EmbeddedFile> embedded_kernels_of_rivals();
/// Adds kernels to those of the core library, which programs are made from (cl/program.cpp); returns true, so that a
/// constant of a library can call it before main() begins.
bool add_embedded_kernels(std::span<const EmbeddedFile> kernels);
/// Null if no library of this program has the file.
const EmbeddedFile* embedded_kernel(std::string_view path);

/// The texts of the command: help, the gallery's page.
std::span<const EmbeddedFile> embedded_texts();

}  // namespace gnomon
