// SPDX-License-Identifier: MIT
#include "forks.hpp"

#include <pthread.h>
#if __has_include(<link.h>)
#include <link.h>
#endif

#include <cstring>
#include <gnomon.hpp>

namespace gnomon::cl {
namespace {

std::atomic<bool> uses_opencl = false;

// Whether some part of the program has loaded an OpenCL driver, as a loader does when it is asked for the platforms.
bool has_driver() noexcept {
#if __has_include(<link.h>)
    const auto is_driver = [](dl_phdr_info* info, std::size_t, void*) {
        const char* const slash = std::strrchr(info->dlpi_name, '/');
        const char* const name = slash != nullptr ? slash + 1 : info->dlpi_name;
        for (const char* driver : {"libpocl", "libnvidia-opencl", "libamdocl", "libintelocl", "libigdrcl",
                                   "libMesaOpenCL", "libRusticlOpenCL"})
            if (std::strncmp(name, driver, std::strlen(driver)) == 0) return 1;
        return 0;
    };
    return dl_iterate_phdr(is_driver, nullptr) != 0;
#else
    return false;
#endif
}

// Runs in the child before fork() returns there.
void note_fork() noexcept {
    if (uses_opencl || has_driver()) is_forked = true;
}
[[maybe_unused]] const int registered = pthread_atfork(nullptr, nullptr, note_fork);

}  // namespace

std::atomic<bool> is_forked = false;

void require_unforked() {
    if (is_forked)
        throw Error(
            "this process was forked after OpenCL was used in its parent, which no driver survives: start worker "
            "processes by 'spawn' (Python: multiprocessing.get_context('spawn')), or use gnomon in the workers alone");
}

void note_use(bool is_used) { uses_opencl = is_used; }

}  // namespace gnomon::cl
