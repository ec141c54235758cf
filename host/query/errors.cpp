// SPDX-License-Identifier: MIT
// The exceptions of gnomon.hpp: an OpenCL error's text has its call, its name and, for builds, the compiler's log.
#include <gnomon.hpp>

namespace gnomon {
namespace {

#define GN_ERRORS(NAME)                                                                                             \
    NAME(CL_DEVICE_NOT_FOUND), NAME(CL_DEVICE_NOT_AVAILABLE), NAME(CL_COMPILER_NOT_AVAILABLE),                      \
        NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE), NAME(CL_OUT_OF_RESOURCES), NAME(CL_OUT_OF_HOST_MEMORY),             \
        NAME(CL_PROFILING_INFO_NOT_AVAILABLE), NAME(CL_MEM_COPY_OVERLAP), NAME(CL_BUILD_PROGRAM_FAILURE),           \
        NAME(CL_MAP_FAILURE), NAME(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST), NAME(CL_COMPILE_PROGRAM_FAILURE), \
        NAME(CL_LINKER_NOT_AVAILABLE), NAME(CL_LINK_PROGRAM_FAILURE), NAME(CL_INVALID_VALUE),                       \
        NAME(CL_INVALID_DEVICE_TYPE), NAME(CL_INVALID_PLATFORM), NAME(CL_INVALID_DEVICE), NAME(CL_INVALID_CONTEXT), \
        NAME(CL_INVALID_QUEUE_PROPERTIES), NAME(CL_INVALID_COMMAND_QUEUE), NAME(CL_INVALID_HOST_PTR),               \
        NAME(CL_INVALID_MEM_OBJECT), NAME(CL_INVALID_BINARY), NAME(CL_INVALID_BUILD_OPTIONS),                       \
        NAME(CL_INVALID_PROGRAM), NAME(CL_INVALID_PROGRAM_EXECUTABLE), NAME(CL_INVALID_KERNEL_NAME),                \
        NAME(CL_INVALID_KERNEL_DEFINITION), NAME(CL_INVALID_KERNEL), NAME(CL_INVALID_ARG_INDEX),                    \
        NAME(CL_INVALID_ARG_VALUE), NAME(CL_INVALID_ARG_SIZE), NAME(CL_INVALID_KERNEL_ARGS),                        \
        NAME(CL_INVALID_WORK_DIMENSION), NAME(CL_INVALID_WORK_GROUP_SIZE), NAME(CL_INVALID_WORK_ITEM_SIZE),         \
        NAME(CL_INVALID_GLOBAL_OFFSET), NAME(CL_INVALID_EVENT_WAIT_LIST), NAME(CL_INVALID_EVENT),                   \
        NAME(CL_INVALID_OPERATION), NAME(CL_INVALID_BUFFER_SIZE), NAME(CL_INVALID_GLOBAL_WORK_SIZE),                \
        NAME(CL_INVALID_PROPERTY)
#define GN_NAMED(code) \
    { code, #code }
constexpr struct {
    cl_int code;
    const char* name;
} error_names[] = {GN_ERRORS(GN_NAMED), {-1001, "CL_PLATFORM_NOT_FOUND_KHR"}};
#undef GN_NAMED
#undef GN_ERRORS

const char* error_name(cl_int code) {
    for (const auto& error : error_names)
        if (error.code == code) return error.name;
    return "an unknown OpenCL error";
}

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
