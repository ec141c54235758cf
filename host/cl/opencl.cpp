// SPDX-License-Identifier: MIT
#include "opencl.hpp"

#include <dlfcn.h>

#include <mutex>

#include "environment.hpp"

namespace gnomon {

#define GN_DEFINE(name) cl::Function<decltype(&::name)> name;
GN_OPENCL_FUNCTIONS(GN_DEFINE)
#undef GN_DEFINE

namespace cl {
namespace {

constexpr const char* system_library = "libOpenCL.so.1";

// The first function that `library` lacks; empty if all are loaded.
std::string load_functions(void* library) {
    std::string missing;
#define GN_LOAD(name)                                                               \
    name.pointer = reinterpret_cast<decltype(name.pointer)>(dlsym(library, #name)); \
    if (name.pointer == nullptr && missing.empty()) missing = #name;
    GN_OPENCL_FUNCTIONS(GN_LOAD)
#undef GN_LOAD
    return missing;
}

std::string load_from(const std::string& file) {
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        return "no OpenCL library can be loaded (" + std::string(dlerror()) +
               "): install one (Debian and Ubuntu: ocl-icd-libopencl1 and a driver such as pocl-opencl-icd; Python: "
               "pip install gnomon[pocl]), or name its file in GNOMON_OPENCL_LIBRARY";
    const std::string missing = load_functions(library);
    if (missing.empty()) return {};
    dlclose(library);
    return file + " is no OpenCL 1.2 library: it lacks " + missing + "; name another in GNOMON_OPENCL_LIBRARY";
}

}  // namespace

std::string try_to_load_opencl(const std::string& library) {
    require_unforked();
    note_use(true);
    static std::mutex mutex;
    static bool is_loaded = false;
    const std::lock_guard lock(mutex);
    if (is_loaded) return {};
    give_pocl_a_folder();
    std::string failure;
    if (const std::string named = environment("GNOMON_OPENCL_LIBRARY"); !named.empty())
        failure = load_from(named);
    else if (!library.empty())
        failure = load_from(library);
    else if (!load_functions(RTLD_DEFAULT).empty())  // a program's own, or one that a debugger put before it
        failure = load_from(system_library);
    is_loaded = failure.empty();
    note_use(is_loaded);
    return failure;
}

}  // namespace cl

void load_opencl(const std::string& library) {
    const std::string failure = cl::try_to_load_opencl(library);
    if (!failure.empty()) throw DeviceNotFound(failure);
}

}  // namespace gnomon
