// SPDX-License-Identifier: MIT
// The environment that OpenCL drivers start in: a folder for PoCL's kernels, and why no driver has a device.
#include "environment.hpp"

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace gnomon::cl {
namespace {

namespace fs = std::filesystem;

// Where PoCL keeps kernels, and the variable that says so. Without the folder it starts with no device.
struct KernelFolder {
    fs::path folder;
    std::string named_by;
};
KernelFolder folder_of_pocl() {
    if (const std::string own = environment("POCL_CACHE_DIR"); !own.empty()) return {own, "POCL_CACHE_DIR"};
    if (const fs::path cache = environment("XDG_CACHE_HOME"); !cache.empty())
        return {cache / "pocl" / "kcache", "XDG_CACHE_HOME"};
    if (const fs::path home = environment("HOME"); !home.empty()) return {home / ".cache" / "pocl" / "kcache", "HOME"};
    return {"/tmp/pocl/kcache", "no variable"};
}

// Whether a file can be made in the folder, or, where it is not there, in the nearest folder above it that is. This is
// tried: what the permissions say is not all (read-only file systems, the superuser, /proc).
bool is_writable(fs::path folder) {
    std::error_code failed;
    while (!fs::exists(folder, failed) && folder.has_parent_path() && folder != folder.parent_path())
        folder = folder.parent_path();
    if (!fs::is_directory(folder, failed)) return false;
    std::string probe = (folder / ".gnomon-XXXXXX").string();
    if (mkdtemp(probe.data()) == nullptr) return false;
    return rmdir(probe.c_str()) == 0;
}

// A folder of this user's among temporary files; empty if none can be made.
fs::path temporary_folder() {
    for (const fs::path& base : {fs::path(environment("TMPDIR")), fs::path("/tmp"), fs::path("/dev/shm")}) {
        if (base.empty()) continue;
        const fs::path folder = base / ("gnomon-pocl-" + std::to_string(geteuid()));
        struct stat found;
        if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) continue;
        const bool is_ours = lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == geteuid();
        if (is_ours && is_writable(folder)) return folder;
    }
    return {};
}

// Why a driver that is installed gives no device.
std::string state_of_library(const std::string& named_by, const std::string& library) {
    if (dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL) == nullptr)
        return named_by + " names " + library + ", which cannot be loaded (" + dlerror() + ")";
    return named_by + " names " + library + ", which starts and has no device";
}
std::string state_of_driver(const fs::path& file) {
    std::ifstream stream(file);
    std::string library;
    std::getline(stream, library);
    return state_of_library(file.string(), library);
}

// The drivers that the loader finds: a folder of .icd files, or one that OCL_ICD_VENDORS names, or a library.
std::vector<std::string> states_of_drivers(const fs::path& vendors) {
    std::vector<std::string> states;
    std::error_code failed;
    if (fs::is_regular_file(vendors, failed))
        return {vendors.extension() == ".icd" ? state_of_driver(vendors)
                                              : state_of_library("OCL_ICD_VENDORS", vendors.string())};
    for (const auto& entry : fs::directory_iterator(vendors, failed))
        if (entry.path().extension() == ".icd") states.push_back(state_of_driver(entry.path()));
    std::sort(states.begin(), states.end());
    return states;
}

}  // namespace

fs::path cache_directory() {
    if (const std::string own = environment("GNOMON_CACHE_DIR"); !own.empty()) return own;
    if (const fs::path xdg = environment("XDG_CACHE_HOME"); !xdg.empty()) return xdg / "gnomon";
    if (const fs::path home = environment("HOME"); !home.empty()) return home / ".cache" / "gnomon";
    return {};
}

std::string environment(const char* variable) {
    const char* const value = std::getenv(variable);
    return value != nullptr ? value : "";
}

void give_pocl_a_folder() {
    if (std::getenv("POCL_CACHE_DIR") != nullptr && environment("POCL_CACHE_DIR").empty()) unsetenv("POCL_CACHE_DIR");
    if (is_writable(folder_of_pocl().folder)) return;
    if (const fs::path folder = temporary_folder(); !folder.empty()) setenv("POCL_CACHE_DIR", folder.c_str(), 1);
}

KeptLists::KeptLists() {
    for (const char* name : {"OCL_ICD_FILENAMES", "OPENCL_LAYERS"})
        if (std::getenv(name) != nullptr) values_[name] = environment(name);
}

KeptLists::~KeptLists() {
    for (const auto& [name, value] : values_)
        if (environment(name) != value) setenv(name, value.c_str(), 1);
}

std::string why_no_device() {
    const KernelFolder kernels = folder_of_pocl();
    std::string why = "there is no OpenCL device";
    const std::string vendors = environment("OCL_ICD_VENDORS");
    const std::vector<std::string> states = states_of_drivers(vendors.empty() ? "/etc/OpenCL/vendors" : vendors);
    if (states.empty())
        why += ", and no driver in " + (vendors.empty() ? "/etc/OpenCL/vendors" : vendors + " (OCL_ICD_VENDORS)") +
               ": install one (for the processor, Debian and Ubuntu have pocl-opencl-icd)";
    for (std::size_t i = 0; i < states.size(); ++i) why += (i == 0 ? ": " : "; ") + states[i];
    if (!is_writable(kernels.folder))
        why += "; PoCL starts only where it can write its kernels, and cannot in " + kernels.folder.string() + " (by " +
               kernels.named_by + "): name a folder in POCL_CACHE_DIR";
    for (const char* name : {"POCL_DEVICES", "OCL_ICD_VENDORS", "OCL_ICD_FILENAMES", "CUDA_VISIBLE_DEVICES"})
        if (std::getenv(name) != nullptr) why += "; " + std::string(name) + " is set to \"" + environment(name) + "\"";
    return why;
}

}  // namespace gnomon::cl
