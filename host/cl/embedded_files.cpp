// SPDX-License-Identifier: MIT
#include "cl/embedded_files.hpp"

#include <mutex>
#include <vector>

namespace gnomon {
namespace {

struct EmbeddedKernels {
    std::mutex mutex;
    std::vector<std::span<const EmbeddedFile>> libraries{embedded_kernels()};
};

EmbeddedKernels& all_kernels() {
    static EmbeddedKernels all;
    return all;
}

}  // namespace

bool add_embedded_kernels(std::span<const EmbeddedFile> kernels) {
    EmbeddedKernels& all = all_kernels();
    const std::lock_guard lock(all.mutex);
    all.libraries.push_back(kernels);
    return true;
}

const EmbeddedFile* embedded_kernel(std::string_view path) {
    EmbeddedKernels& all = all_kernels();
    const std::lock_guard lock(all.mutex);
    for (const auto& library : all.libraries)
        for (const EmbeddedFile& kernel : library)
            if (kernel.path == path) return &kernel;
    return nullptr;
}

}  // namespace gnomon
