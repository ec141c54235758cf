// SPDX-License-Identifier: MIT
// Errors, devices, and the library's version. Stable (gnomon/version.h says what that means).
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gnomon/version.h>

// Private types of the library.
namespace gnomon {
namespace cl {
class Session;
}  // namespace cl
struct Internals;
}  // namespace gnomon

// The library is compiled with hidden visibility (host/CMakeLists.txt): a shared library exports only the declarations
// from here on. This is a pragma since clang 14 does not apply a namespace's attribute to the namespace's functions.
#pragma GCC visibility push(default)

namespace gnomon {

/// Three float32 coordinates: world space, in the scene's unit (glTF: metres), +Y up, right-handed.
using Float3 = std::array<float, 3>;

/// "MAJOR.MINOR.PATCH" of the library that the program runs with (gnomon/version.h has that of the headers).
std::string_view version();

// ---- Errors ---------------------------------------------------------------------------------------------------------

/// Base class of all exceptions that the library throws. what() is one sentence that names the cause and, where there
/// is one, the remedy.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An argument outside its stated range (sizes that do not match, a zero direction, an unknown setting).
class InvalidArgument : public Error {
public:
    using Error::Error;
};

/// No device fits: none is installed, none has that name, or the named device lacks a feature that gnomon needs.
class DeviceNotFound : public Error {
public:
    using Error::Error;
};

/// An OpenCL call failed. Carries the call, the error's name ("CL_INVALID_VALUE") and, for builds, the compiler's log.
class OpenClError : public Error {
public:
    /// what(): "CALL failed with NAME (CODE): REMEDY", then the build log.
    OpenClError(std::string_view call, cl_int code, std::string build_log = {}, std::string_view remedy = {});
    cl_int code() const noexcept { return code_; }                        ///< CL_INVALID_VALUE and so on
    const std::string& build_log() const noexcept { return build_log_; }  ///< the compiler's; empty if no build failed

private:
    cl_int code_;
    std::string build_log_;
};

/// The device has too little memory for the call (CL_MEM_OBJECT_ALLOCATION_FAILURE and similar codes, or the limit
/// given to Device). No object is left in a partial state: the library stays usable.
class OutOfDeviceMemory : public OpenClError {
public:
    /// As OpenClError.
    OutOfDeviceMemory(std::string_view call, cl_int code, std::string_view remedy = "ask for fewer points at once")
        : OpenClError(call, code, {}, remedy) {}
};

/// A progress function ended the run (RunOptions::progress). The contents of the outputs are not defined.
class Cancelled : public Error {
public:
    using Error::Error;
};

// ---- Devices --------------------------------------------------------------------------------------------------------

/// gnomon links no OpenCL library: it loads one when it first needs it. The file that is loaded is the one that the
/// environment variable GNOMON_OPENCL_LIBRARY names, else `library`, else the library that the program itself links,
/// else the system's libOpenCL.so.1. Only programs that must choose the file call this; after the first success it does
/// nothing. Throws DeviceNotFound with the cause and the remedy.
void load_opencl(const std::string& library = {});

/// One OpenCL device of this machine, as `gnomon devices` lists it.
struct DeviceDescription {
    cl_platform_id platform_id = nullptr;
    cl_device_id device_id = nullptr;
    std::string selector;  ///< "P:D", platform and device index: what Device and --device accept
    std::string platform;  ///< platform name, e.g. "Portable Computing Language"
    std::string name;      ///< device name
    std::string vendor;
    std::string driver_version;
    std::string opencl_version;    ///< CL_DEVICE_VERSION
    std::string opencl_c_version;  ///< CL_DEVICE_OPENCL_C_VERSION
    std::string type;              ///< "CPU", "GPU", "accelerator" or "custom"
    std::uint32_t compute_units = 0;
    std::uint64_t global_memory_bytes = 0;
    std::uint64_t largest_allocation_bytes = 0;
    bool has_fp64 = false;
    bool shares_host_memory = false;  ///< CL_DEVICE_HOST_UNIFIED_MEMORY: share() copies nothing
    std::string lacks;                ///< empty if the device can be used, else the features that it lacks
    std::string note;         ///< of an open device: features that its start-up check switched off, and why; else empty
    bool is_default = false;  ///< a Device without a selector opens this one
    std::string why_default;  ///< for the default: the rule that chose it
};

/// All devices of all platforms; empty if there is no OpenCL at all. Never throws for a broken driver: a platform that
/// fails a query is left out.
std::vector<DeviceDescription> devices();

/// How a Device is opened.
struct DeviceOptions {
    /// Time every kernel by events (Statistics then has device times). Slows small launches: off for wall-clock times.
    bool profile = false;
    /// Refuse to allocate more than this many bytes on the device; 0: gnomon sets no limit.
    std::uint64_t memory_limit_bytes = 0;
    /// Hide double precision: the wide filter is skipped, and more pairs reach the exact predicate. Same bits.
    bool hide_fp64 = false;
    /// Work-group size of every kernel, 0: chosen per device. Same bits for every size.
    std::uint32_t work_group_size = 0;
    /// Use the kernels made for GPUs (one point per work-item, cooperating work-groups) on a CPU as well, as the
    /// environment variable GNOMON_GPU_KERNELS does: for tests and measurements. Same bits.
    bool gpu_kernels = false;
};

/// The builds that a Device's runs waited for before their kernels ran. A platform with its own cache (PoCL) compiles
/// or loads a kernel when it is first launched: that wait is counted too if the queue can time it.
struct KernelBuilds {
    std::uint32_t programs = 0;    ///< compiled or loaded
    std::uint32_t from_cache = 0;  ///< loaded from gnomon's cache on disk; 0 on a platform with its own cache
    double ms = 0;
};

/// A device, its context and in-order queue, and the compiled kernels. Building the kernels takes most of the time of a
/// first start; they are cached on disk for later starts.
class Device {
public:
    /// Opens the device that `selector` names: "P:D" (indices as in devices()), or a part of the device's or platform's
    /// name in any case; empty: the environment variable GNOMON_DEVICE, else the default (the first usable GPU, else
    /// the first usable CPU). Throws DeviceNotFound with the list of the devices.
    explicit Device(std::string_view selector = {}, const DeviceOptions& options = {});
    /// Uses the caller's context and queue (both are retained). The queue must be in-order; kernels and copies are
    /// enqueued on it, and results are complete when the queue has executed them. The queue decides whether kernels are
    /// profiled; `options` does not. Throws InvalidArgument if context and queue do not belong together, DeviceNotFound
    /// if the queue's device cannot be used.
    Device(cl_context context, cl_command_queue queue, const DeviceOptions& options = {});

    const DeviceDescription& description() const;  ///< with what its start-up check found
    cl_context context() const;                    ///< not retained for the caller
    cl_command_queue queue() const;                ///< in-order; not retained for the caller
    /// Waits until the device has executed all that was enqueued.
    void finish() const;
    /// Bytes of device memory that gnomon's own buffers occupy now, and the largest number so far.
    std::uint64_t memory_bytes() const;
    /// The largest memory_bytes() so far.
    std::uint64_t peak_memory_bytes() const;
    /// The builds since the device was opened. Waits for the queue if kernels were launched for the first time since
    /// the last call.
    KernelBuilds kernel_builds() const;

private:
    friend struct Internals;

    std::shared_ptr<cl::Session> session_;
};

}  // namespace gnomon

#pragma GCC visibility pop
