// SPDX-License-Identifier: MIT
// The exceptions of gnomon.hpp: an OpenCL error's text has its call, its name and, for builds, the compiler's log.
#include <gnomon.hpp>

namespace gnomon {
namespace {

#define GN_CASE(code) \
    case code:        \
        return #code
const char* error_name(cl_int code) {
    switch (code) {
        GN_CASE(CL_DEVICE_NOT_FOUND);
        GN_CASE(CL_DEVICE_NOT_AVAILABLE);
        GN_CASE(CL_COMPILER_NOT_AVAILABLE);
        GN_CASE(CL_MEM_OBJECT_ALLOCATION_FAILURE);
        GN_CASE(CL_OUT_OF_RESOURCES);
        GN_CASE(CL_OUT_OF_HOST_MEMORY);
        GN_CASE(CL_PROFILING_INFO_NOT_AVAILABLE);
        GN_CASE(CL_MEM_COPY_OVERLAP);
        GN_CASE(CL_BUILD_PROGRAM_FAILURE);
        GN_CASE(CL_MAP_FAILURE);
        GN_CASE(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST);
        GN_CASE(CL_COMPILE_PROGRAM_FAILURE);
        GN_CASE(CL_LINKER_NOT_AVAILABLE);
        GN_CASE(CL_LINK_PROGRAM_FAILURE);
        GN_CASE(CL_INVALID_VALUE);
        GN_CASE(CL_INVALID_DEVICE_TYPE);
        GN_CASE(CL_INVALID_PLATFORM);
        GN_CASE(CL_INVALID_DEVICE);
        GN_CASE(CL_INVALID_CONTEXT);
        GN_CASE(CL_INVALID_QUEUE_PROPERTIES);
        GN_CASE(CL_INVALID_COMMAND_QUEUE);
        GN_CASE(CL_INVALID_HOST_PTR);
        GN_CASE(CL_INVALID_MEM_OBJECT);
        GN_CASE(CL_INVALID_BINARY);
        GN_CASE(CL_INVALID_BUILD_OPTIONS);
        GN_CASE(CL_INVALID_PROGRAM);
        GN_CASE(CL_INVALID_PROGRAM_EXECUTABLE);
        GN_CASE(CL_INVALID_KERNEL_NAME);
        GN_CASE(CL_INVALID_KERNEL_DEFINITION);
        GN_CASE(CL_INVALID_KERNEL);
        GN_CASE(CL_INVALID_ARG_INDEX);
        GN_CASE(CL_INVALID_ARG_VALUE);
        GN_CASE(CL_INVALID_ARG_SIZE);
        GN_CASE(CL_INVALID_KERNEL_ARGS);
        GN_CASE(CL_INVALID_WORK_DIMENSION);
        GN_CASE(CL_INVALID_WORK_GROUP_SIZE);
        GN_CASE(CL_INVALID_WORK_ITEM_SIZE);
        GN_CASE(CL_INVALID_GLOBAL_OFFSET);
        GN_CASE(CL_INVALID_EVENT_WAIT_LIST);
        GN_CASE(CL_INVALID_EVENT);
        GN_CASE(CL_INVALID_OPERATION);
        GN_CASE(CL_INVALID_BUFFER_SIZE);
        GN_CASE(CL_INVALID_GLOBAL_WORK_SIZE);
        GN_CASE(CL_INVALID_PROPERTY);
        case -1001:
            return "CL_PLATFORM_NOT_FOUND_KHR";
        default:
            return "an unknown OpenCL error";
    }
}
#undef GN_CASE

std::string message(std::string_view call, cl_int code, const std::string& build_log, std::string_view remedy) {
    std::string text(call);
    text += " failed with ";
    text += error_name(code);
    text += " (" + std::to_string(code) + ")";
    if (!remedy.empty()) text += ": " + std::string(remedy);
    if (!build_log.empty()) text += ":\n" + build_log;
    return text;
}

}  // namespace

OpenClError::OpenClError(std::string_view call, cl_int code, std::string build_log, std::string_view remedy)
    : Error(message(call, code, build_log, remedy)), code_(code), build_log_(std::move(build_log)) {}

}  // namespace gnomon
