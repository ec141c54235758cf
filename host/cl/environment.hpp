// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace gnomon::cl {

/// Empty if the variable is not set.
std::string environment(const char* variable);

/// The folder of programs' binaries: GNOMON_CACHE_DIR, else by the user's; empty if there is none. It may not exist.
std::filesystem::path cache_directory();

/// Names a temporary folder in POCL_CACHE_DIR where PoCL could not write its kernels, since it would then start without
/// a device, or end the process. Call it before OpenCL is loaded.
void give_pocl_a_folder();

/// Restores the lists of drivers and layers in the environment when it is destroyed: Khronos' loader cuts them at their
/// first colon, in place, when it starts, and processes that this one starts would find the first driver alone.
class KeptLists {
public:
    KeptLists();
    ~KeptLists();
    KeptLists(const KeptLists&) = delete;
    KeptLists& operator=(const KeptLists&) = delete;

private:
    std::map<const char*, std::string> values_;
};

/// The sentence for a machine on which drivers list no device: what is installed, and which variable to look at.
std::string why_no_device();

}  // namespace gnomon::cl
