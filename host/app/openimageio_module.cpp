// SPDX-License-Identifier: MIT
// Opens the module gnomon_openimageio: beside the command (build folder), or in ../lib/gnomon (installed).
#include <dlfcn.h>

#include <filesystem>

#include "openimageio.hpp"

namespace gnomon::app {
namespace {

std::filesystem::path module_path() {
    const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const char* const name = "gnomon_openimageio.so";
    const std::filesystem::path beside = folder / name;
    return std::filesystem::exists(beside) ? beside : folder.parent_path() / "lib" / "gnomon" / name;
}

const OpenImageIo& opened_module() {
    // The module is never closed: its objects may live as long as the program.
    void* const module = ::dlopen(module_path().c_str(), RTLD_NOW | RTLD_LOCAL);
    const void* const found = module != nullptr ? ::dlsym(module, "gnomon_openimageio") : nullptr;
    if (found == nullptr)
        throw Error(std::string("cannot open the module that makes EXR files and galleries, which is built and "
                                "installed with the command: ") +
                    ::dlerror());
    return *static_cast<const OpenImageIo*>(found);
}

}  // namespace

const OpenImageIo& open_image_io() {
    static const OpenImageIo& module = opened_module();
    return module;
}

}  // namespace gnomon::app
