// SPDX-License-Identifier: MIT
#include "session.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <mutex>
#include <sstream>

#include "environment.hpp"
#include "opencl.hpp"

namespace gnomon {
namespace cl {
namespace {

template <typename Value>
Value value_of(cl_device_id device, cl_device_info what) {
    Value value{};
    clGetDeviceInfo(device, what, sizeof(value), &value, nullptr);
    return value;
}

template <typename Getter>
std::string text_of(Getter get) {
    std::size_t size = 0;
    if (get(0, nullptr, &size) != CL_SUCCESS) return {};
    std::string text(size, '\0');
    if (size != 0) get(size, text.data(), nullptr);
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    return text.substr(std::min(text.find_first_not_of(' '), text.size()));
}

std::string text_of_device(cl_device_id device, cl_device_info what) {
    return text_of([&](std::size_t size, void* out, std::size_t* needed) {
        return clGetDeviceInfo(device, what, size, out, needed);
    });
}

std::string type_name(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "GPU";
    if (type & CL_DEVICE_TYPE_CPU) return "CPU";
    if (type & CL_DEVICE_TYPE_ACCELERATOR) return "accelerator";
    return "custom";
}

// The most that a kernel uses, in work-groups of 128 (tests/drivers).
constexpr cl_ulong min_local_bytes = 16384;

// The features that gnomon requires. Double precision is not required: kernels can compute it by integers.
std::string missing(cl_device_id device, const DeviceDescription& description) {
    std::string lacks;
    const auto need = [&lacks](bool there, const char* what) {
        if (!there) lacks += (lacks.empty() ? "" : ", ") + std::string(what);
    };
    need(value_of<cl_bool>(device, CL_DEVICE_AVAILABLE), "being available");
    need(value_of<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE), "an OpenCL C compiler");
    int major = 0, minor = 0;
    std::sscanf(description.opencl_c_version.c_str(), "OpenCL C %d.%d", &major, &minor);
    need(major > 1 || (major == 1 && minor >= 2), "OpenCL C 1.2");
    need(value_of<cl_uint>(device, CL_DEVICE_ADDRESS_BITS) == 64, "64-bit addresses");
    need(value_of<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE) >= min_local_bytes, "16 KiB of local memory");
    need(text_of_device(device, CL_DEVICE_PROFILE) == "FULL_PROFILE", "the full profile (64-bit integers, exact fma)");
    need(value_of<cl_bool>(device, CL_DEVICE_ENDIAN_LITTLE), "little-endian memory");
    const auto float_config = value_of<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG);
    need((float_config & CL_FP_ROUND_TO_NEAREST) != 0, "rounding to nearest");
    return lacks;
}

std::string lowered(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

std::string listed(const std::vector<DeviceDescription>& all) {
    std::string text = "there are:";
    for (const DeviceDescription& d : all)
        text += " " + d.selector + " (" + d.name + (d.lacks.empty() ? ")" : ", lacks " + d.lacks + ")");
    return text;
}

void mark_default(std::vector<DeviceDescription>& all) {
    for (const char* type : {"GPU", "CPU", "accelerator"})
        for (DeviceDescription& device : all)
            if (device.lacks.empty() && device.type == type) {
                device.is_default = true;
                device.why_default = std::string("the first usable ") + type +
                                     (std::string_view(type) == "CPU" ? ", since there is no usable GPU" : "");
                return;
            }
}

}  // namespace

bool has_extension(cl_device_id device, std::string_view name) {
    std::istringstream words(text_of_device(device, CL_DEVICE_EXTENSIONS));
    return std::find(std::istream_iterator<std::string>(words), {}, name) != std::istream_iterator<std::string>();
}

DeviceDescription describe(cl_device_id device) {
    DeviceDescription d;
    d.device_id = device;
    d.platform_id = value_of<cl_platform_id>(device, CL_DEVICE_PLATFORM);
    d.platform = text_of([&](std::size_t size, void* out, std::size_t* needed) {
        return clGetPlatformInfo(d.platform_id, CL_PLATFORM_NAME, size, out, needed);
    });
    d.name = text_of_device(device, CL_DEVICE_NAME);
    d.vendor = text_of_device(device, CL_DEVICE_VENDOR);
    d.driver_version = text_of_device(device, CL_DRIVER_VERSION);
    d.opencl_version = text_of_device(device, CL_DEVICE_VERSION);
    d.opencl_c_version = text_of_device(device, CL_DEVICE_OPENCL_C_VERSION);
    d.type = type_name(value_of<cl_device_type>(device, CL_DEVICE_TYPE));
    d.compute_units = value_of<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
    d.global_memory_bytes = value_of<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
    d.largest_allocation_bytes = value_of<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    d.has_fp64 = value_of<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) != 0;
    d.shares_host_memory = value_of<cl_bool>(device, CL_DEVICE_HOST_UNIFIED_MEMORY) == CL_TRUE;
    d.lacks = missing(device, d);
    return d;
}

DeviceDescription select_device(std::string_view selector) {
    load_opencl();
    const std::vector<DeviceDescription> all = devices();
    std::string wanted(selector);
    std::string asked_by = "--device";
    if (wanted.empty())
        if (const char* variable = std::getenv("GNOMON_DEVICE")) {
            wanted = variable;
            asked_by = "GNOMON_DEVICE";
        }
    const std::string part = lowered(wanted);
    for (const DeviceDescription& device : all) {
        const bool fits = wanted.empty()
                              ? device.is_default
                              : device.selector == wanted || lowered(device.name).find(part) != std::string::npos ||
                                    lowered(device.platform).find(part) != std::string::npos;
        if (!fits) continue;
        if (!device.lacks.empty())
            throw DeviceNotFound("the device " + device.name + " cannot be used: it lacks " + device.lacks);
        return device;
    }
    if (all.empty()) throw DeviceNotFound(why_no_device());
    if (wanted.empty()) throw DeviceNotFound("no usable OpenCL device: " + listed(all));
    throw DeviceNotFound("no OpenCL device matches \"" + wanted + "\" (" + asked_by + "): " + listed(all));
}

}  // namespace cl

std::vector<DeviceDescription> devices() {
    std::vector<DeviceDescription> all;
    if (!cl::try_to_load_opencl().empty()) return all;
    // PoCL 3.1 starts at the first call, and tells a second thread meanwhile that it has no device.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    const cl::KeptLists lists;
    cl_uint platform_count = 0;
    if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS) return all;
    std::vector<cl_platform_id> platforms(platform_count);
    if (platform_count != 0) clGetPlatformIDs(platform_count, platforms.data(), nullptr);
    for (cl_uint p = 0; p < platform_count; ++p) {
        cl_uint device_count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 0, nullptr, &device_count) != CL_SUCCESS) continue;
        std::vector<cl_device_id> ids(device_count);
        clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, device_count, ids.data(), nullptr);
        for (cl_uint d = 0; d < device_count; ++d) {
            all.push_back(cl::describe(ids[d]));
            all.back().selector = std::to_string(p) + ":" + std::to_string(d);
        }
    }
    cl::mark_default(all);
    return all;
}

}  // namespace gnomon
