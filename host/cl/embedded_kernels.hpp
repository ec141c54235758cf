// SPDX-License-Identifier: MIT
// The kernel files as they were when gnomon was built; tools/embed_kernels.cmake writes the definition.
#pragma once

#include <span>
#include <string_view>

namespace gnomon {

struct EmbeddedKernel {
    std::string_view path;  ///< "kernels/techniques/izb.cl"
    std::string_view text;
};
std::span<const EmbeddedKernel> embedded_kernels();

}  // namespace gnomon
