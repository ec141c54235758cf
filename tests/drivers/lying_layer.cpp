// SPDX-License-Identifier: MIT
// An OpenCL layer that lies: it stands between a program and a sound driver, and gives the device the limits and faults
// of devices that nobody here owns. It keeps the lie: a launch, a buffer or a program that such a device would refuse
// is refused with the code that a real driver gives.
//
//   OPENCL_LAYERS=.../libgnomon_lying_layer.so GNOMON_TEST_LIES=work_group=64,no_fp64 GNOMON_DEVICE=lies PROGRAM
//
// Each device's name ends with the lies, so that GNOMON_DEVICE=lies finds no device where the layer is missing.
//
//   type=gpu             the device is a GPU
//   local_memory=BYTES   what a work-group may use: its kernel's own variables and its arguments
//   work_group=N         the largest work-group
//   kernel_work_group=N  the largest work-group of every kernel, whatever the device names as its largest (a GPU's
//                        kernels that need many registers)
//   compute_units=N, multiple=N (the preferred multiple), allocation=BYTES (the largest buffer), address_bits=N,
//   opencl_c=VERSION, unified=0 or 1 (CL_DEVICE_HOST_UNIFIED_MEMORY)
//   vector_width=N       the native vectors of floats
//   no_fp64              neither the extension nor the type
//   no_int64_atomics     neither the extensions nor the functions
//   no_exact_divide      division is not promised to be rounded correctly, and the option that asks for it is refused
//   no_clock             commands' times are not available
//   fail=CALL:N:CODE     the N-th call of clCALL fails with the code, and does nothing
//   lost=N               the N-th launch succeeds, is not run, and fails later: its event has a negative state, and the
//                        next call that waits returns the error; so do the launches up to there, which would read what
//                        it did not write
//   first_launch=MS      a kernel's first launch takes so many milliseconds more, in which a driver would build it
//   cut=VARIABLE         cuts a list in the environment at its first colon, as Khronos' loader does when it starts
//   wrong_bit=BYTES      a read of at least so many bytes has a wrong bit
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_1_APIS
#include <CL/cl_layer.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

const cl_icd_dispatch* driver = nullptr;
cl_icd_dispatch layer;

// ---- The lies -------------------------------------------------------------------------------------------------------

using Lies = std::map<std::string, std::string>;

const Lies& lies() {
    static const Lies all = [] {
        const char* const known[] = {"type",         "local_memory", "work_group",       "kernel_work_group",
                                     "no_fp64",      "multiple",     "no_int64_atomics", "compute_units",
                                     "fail",         "allocation",   "no_exact_divide",  "address_bits",
                                     "lost",         "opencl_c",     "no_clock",         "unified",
                                     "vector_width", "wrong_bit",    "first_launch",     "cut"};
        Lies found;
        const char* text = std::getenv("GNOMON_TEST_LIES");
        std::istringstream words(text != nullptr ? text : "");
        for (std::string word; std::getline(words, word, ',');) {
            const std::string name = word.substr(0, word.find('='));
            bool is_known = false;
            for (const char* one : known) is_known = is_known || name == one;
            if (!is_known) {
                std::fprintf(stderr, "lying_layer: GNOMON_TEST_LIES has an unknown lie: %s\n", word.c_str());
                std::abort();
            }
            found[name] = word.find('=') == std::string::npos ? "" : word.substr(name.size() + 1);
        }
        return found;
    }();
    return all;
}

bool tells(const std::string& lie) { return lies().count(lie) != 0; }
unsigned long long number_of(const std::string& lie) { return std::stoull(lies().at(lie)); }

std::string all_lies() {
    std::string text;
    for (const auto& [name, value] : lies()) text += ' ' + name + (value.empty() ? "" : "=" + value);
    return text;
}

/// Whether this call of clCALL is the one that fails; *code is then its code.
bool fails(const char* call, cl_int* code) {
    if (!tells("fail")) return false;
    static std::atomic<int> calls{0};
    char name[64];
    int which = 0, with = 0;
    if (std::sscanf(lies().at("fail").c_str(), "%63[^:]:%d:%d", name, &which, &with) != 3) std::abort();
    if (std::strcmp(name, call) != 0 || ++calls != which) return false;
    *code = with;
    return true;
}

// ---- Answers --------------------------------------------------------------------------------------------------------

cl_int give(const void* value, size_t bytes, size_t room, void* out, size_t* needed) {
    if (needed != nullptr) *needed = bytes;
    if (out == nullptr) return CL_SUCCESS;
    if (room < bytes) return CL_INVALID_VALUE;
    std::memcpy(out, value, bytes);
    return CL_SUCCESS;
}

template <typename Value>
cl_int give(Value value, size_t room, void* out, size_t* needed) {
    return give(&value, sizeof(value), room, out, needed);
}

cl_int give(const std::string& text, size_t room, void* out, size_t* needed) {
    return give(text.c_str(), text.size() + 1, room, out, needed);
}

template <typename Value>
Value truth(cl_device_id device, cl_device_info what) {
    Value value{};
    driver->clGetDeviceInfo(device, what, sizeof(value), &value, nullptr);
    return value;
}

std::string true_text(cl_device_id device, cl_device_info what) {
    size_t size = 0;
    driver->clGetDeviceInfo(device, what, 0, nullptr, &size);
    std::string text(size, '\0');
    driver->clGetDeviceInfo(device, what, size, text.data(), nullptr);
    return text.c_str();
}

std::string told_extensions(cl_device_id device) {
    std::istringstream words(true_text(device, CL_DEVICE_EXTENSIONS));
    std::string told;
    for (std::string word; words >> word;) {
        if (tells("no_fp64") && word == "cl_khr_fp64") continue;
        if (tells("no_int64_atomics") && word.rfind("cl_khr_int64", 0) == 0) continue;
        told += word + ' ';
    }
    return told;
}

/// Numbers that a lie of the same name replaces. Returns false if the question is another one.
bool told_number(cl_device_info what, size_t room, void* out, size_t* needed, cl_int* code) {
    const auto answer = [&](const char* lie, auto type) {
        if (tells(lie)) *code = give(static_cast<decltype(type)>(number_of(lie)), room, out, needed);
        return tells(lie);
    };
    switch (what) {
        case CL_DEVICE_LOCAL_MEM_SIZE:
            return answer("local_memory", cl_ulong());
        case CL_DEVICE_MAX_WORK_GROUP_SIZE:
            return answer("work_group", size_t());
        case CL_DEVICE_MAX_COMPUTE_UNITS:
            return answer("compute_units", cl_uint());
        case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
            return answer("allocation", cl_ulong());
        case CL_DEVICE_ADDRESS_BITS:
            return answer("address_bits", cl_uint());
        case CL_DEVICE_HOST_UNIFIED_MEMORY:
            return answer("unified", cl_bool());
        case CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT:
            return answer("vector_width", cl_uint());
        default:
            return false;
    }
}

cl_int CL_API_CALL get_device_info(cl_device_id device, cl_device_info what, size_t room, void* out, size_t* needed) {
    cl_int code = CL_SUCCESS;
    if (told_number(what, room, out, needed, &code)) return code;
    if (what == CL_DEVICE_NAME) return give(true_text(device, what) + " that lies:" + all_lies(), room, out, needed);
    if (what == CL_DEVICE_EXTENSIONS) return give(told_extensions(device), room, out, needed);
    if (what == CL_DEVICE_TYPE && tells("type")) return give(cl_device_type(CL_DEVICE_TYPE_GPU), room, out, needed);
    if (what == CL_DEVICE_DOUBLE_FP_CONFIG && tells("no_fp64")) return give(cl_device_fp_config(0), room, out, needed);
    if (what == CL_DEVICE_SINGLE_FP_CONFIG && tells("no_exact_divide"))
        return give(
            truth<cl_device_fp_config>(device, what) & ~cl_device_fp_config(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT), room,
            out, needed);
    if (what == CL_DEVICE_OPENCL_C_VERSION && tells("opencl_c"))
        return give("OpenCL C " + lies().at("opencl_c") + " of a liar", room, out, needed);
    if (what == CL_DEVICE_MAX_WORK_ITEM_SIZES && tells("work_group")) {
        const size_t sizes[3] = {size_t(number_of("work_group")), 1, 1};
        return give(sizes, sizeof(sizes), room, out, needed);
    }
    return driver->clGetDeviceInfo(device, what, room, out, needed);
}

size_t largest_group(cl_kernel kernel, cl_device_id device) {
    size_t largest = 0;
    driver->clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_WORK_GROUP_SIZE, sizeof(largest), &largest, nullptr);
    for (const char* lie : {"work_group", "kernel_work_group"})
        if (tells(lie) && number_of(lie) < largest) largest = number_of(lie);
    return largest;
}

cl_int CL_API_CALL get_kernel_work_group_info(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what,
                                              size_t room, void* out, size_t* needed) {
    if (what == CL_KERNEL_WORK_GROUP_SIZE) return give(largest_group(kernel, device), room, out, needed);
    if (what == CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE && tells("multiple"))
        return give(size_t(number_of("multiple")), room, out, needed);
    return driver->clGetKernelWorkGroupInfo(kernel, device, what, room, out, needed);
}

// ---- Programs -------------------------------------------------------------------------------------------------------

cl_program CL_API_CALL create_program(cl_context context, cl_uint count, const char** texts, const size_t* lengths,
                                      cl_int* code) {
    std::string text;
    if (tells("no_fp64")) text += "#undef cl_khr_fp64\n#define double no_double_here\n";
    if (tells("no_int64_atomics"))
        for (const char* function : {"add", "sub", "xchg", "inc", "dec", "cmpxchg", "min", "max", "and", "or", "xor"})
            text += std::string("#define atom_") + function + " no_int64_atomics_here\n";
    text += "#line 1\n";
    for (cl_uint i = 0; i < count; ++i)
        text += lengths != nullptr && lengths[i] != 0 ? std::string(texts[i], lengths[i]) : std::string(texts[i]);
    const char* all = text.c_str();
    const size_t length = text.size();
    return driver->clCreateProgramWithSource(context, 1, &all, &length, code);
}

cl_int CL_API_CALL build_program(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                                 void(CL_CALLBACK* notify)(cl_program, void*), void* data) {
    cl_int code;
    if (fails("BuildProgram", &code)) return code;
    if (tells("no_exact_divide") && options != nullptr &&
        std::strstr(options, "-cl-fp32-correctly-rounded-divide-sqrt") != nullptr)
        return CL_INVALID_BUILD_OPTIONS;
    return driver->clBuildProgram(program, count, devices, options, notify, data);
}

// ---- Memory and launches --------------------------------------------------------------------------------------------

cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, size_t bytes, void* data, cl_int* code) {
    cl_int failure = CL_SUCCESS;
    if (tells("allocation") && bytes > number_of("allocation")) failure = CL_INVALID_BUFFER_SIZE;
    if (failure != CL_SUCCESS || fails("CreateBuffer", &failure)) {
        if (code != nullptr) *code = failure;
        return nullptr;
    }
    return driver->clCreateBuffer(context, flags, bytes, data, code);
}

std::mutex mutex;
std::map<cl_kernel, std::map<cl_uint, size_t>> local_arguments;  // bytes, by kernel and index
std::atomic<int> launches{0};
std::atomic<bool> has_lost{false};

cl_int CL_API_CALL set_kernel_arg(cl_kernel kernel, cl_uint index, size_t bytes, const void* value) {
    if (value == nullptr) {
        const std::lock_guard lock(mutex);
        local_arguments[kernel][index] = bytes;
    }
    return driver->clSetKernelArg(kernel, index, bytes, value);
}

cl_int CL_API_CALL release_kernel(cl_kernel kernel) {
    cl_uint references = 0;
    driver->clGetKernelInfo(kernel, CL_KERNEL_REFERENCE_COUNT, sizeof(references), &references, nullptr);
    if (references == 1) {
        const std::lock_guard lock(mutex);
        local_arguments.erase(kernel);
    }
    return driver->clReleaseKernel(kernel);
}

/// The local memory of a work-group. A driver may count the arguments set so far among the kernel's own, or not.
size_t local_bytes(cl_kernel kernel, cl_device_id device) {
    cl_ulong of_kernel = 0;
    driver->clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof(of_kernel), &of_kernel, nullptr);
    size_t of_arguments = 0;
    const std::lock_guard lock(mutex);
    for (const auto& [index, bytes] : local_arguments[kernel]) of_arguments += bytes;
    return std::max<size_t>(of_kernel, of_arguments);
}

cl_int refusal(cl_kernel kernel, cl_device_id device, const size_t* local) {
    if (local != nullptr && *local > largest_group(kernel, device)) return CL_INVALID_WORK_GROUP_SIZE;
    if (tells("local_memory") && local_bytes(kernel, device) > number_of("local_memory")) return CL_OUT_OF_RESOURCES;
    return CL_SUCCESS;
}

/// The launch that is lost: its event fails, and the next call that waits does.
cl_int lose(cl_command_queue queue, cl_event* event) {
    has_lost = true;
    if (event == nullptr) return CL_SUCCESS;
    cl_context context = nullptr;
    driver->clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof(context), &context, nullptr);
    cl_int code;
    *event = driver->clCreateUserEvent(context, &code);
    return code == CL_SUCCESS ? driver->clSetUserEventStatus(*event, CL_OUT_OF_RESOURCES) : code;
}

bool is_new(cl_kernel kernel) {
    static std::set<cl_kernel> launched;
    const std::lock_guard lock(mutex);
    return launched.insert(kernel).second;
}

cl_int CL_API_CALL enqueue_kernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                                  const size_t* global, const size_t* local, cl_uint count, const cl_event* waits,
                                  cl_event* event) {
    cl_device_id device = nullptr;
    driver->clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof(device), &device, nullptr);
    cl_int code = refusal(kernel, device, local);
    if (code != CL_SUCCESS || fails("EnqueueNDRangeKernel", &code)) return code;
    if (tells("lost") && (++launches == int(number_of("lost")) || has_lost)) return lose(queue, event);
    if (tells("first_launch") && is_new(kernel)) {
        driver->clFinish(queue);
        std::this_thread::sleep_for(std::chrono::milliseconds(number_of("first_launch")));
    }
    return driver->clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, count, waits, event);
}

cl_int CL_API_CALL finish(cl_command_queue queue) {
    cl_int code = driver->clFinish(queue), injected;
    if (has_lost.exchange(false)) code = CL_OUT_OF_RESOURCES;
    return fails("Finish", &injected) ? injected : code;
}

cl_int CL_API_CALL read_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocks, size_t first, size_t bytes,
                               void* data, cl_uint count, const cl_event* waits, cl_event* event) {
    cl_int code;
    if (fails("EnqueueReadBuffer", &code)) return code;
    if (blocks && has_lost.exchange(false)) return CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST;
    code = driver->clEnqueueReadBuffer(queue, buffer, blocks, first, bytes, data, count, waits, event);
    if (tells("wrong_bit") && blocks && bytes >= number_of("wrong_bit"))
        static_cast<unsigned char*>(data)[bytes / 2] ^= 1;
    return code;
}

cl_int CL_API_CALL get_event_times(cl_event event, cl_profiling_info what, size_t room, void* out, size_t* needed) {
    if (tells("no_clock")) return CL_PROFILING_INFO_NOT_AVAILABLE;
    return driver->clGetEventProfilingInfo(event, what, room, out, needed);
}

}  // namespace

// ---- What the loader calls ------------------------------------------------------------------------------------------

extern "C" __attribute__((visibility("default"))) cl_int CL_API_CALL clGetLayerInfo(cl_layer_info what, size_t room,
                                                                                    void* out, size_t* needed) {
    if (what == CL_LAYER_API_VERSION) return give(cl_layer_api_version(CL_LAYER_API_VERSION_100), room, out, needed);
    if (what == CL_LAYER_NAME) return give(std::string("lying_layer of gnomon's tests"), room, out, needed);
    return CL_INVALID_VALUE;
}

extern "C" __attribute__((visibility("default"))) cl_int CL_API_CALL clInitLayer(cl_uint entries,
                                                                                 const cl_icd_dispatch* target,
                                                                                 cl_uint* entries_out,
                                                                                 const cl_icd_dispatch** table_out) {
    if (target == nullptr || entries_out == nullptr || table_out == nullptr) return CL_INVALID_VALUE;
    if (entries < sizeof(layer) / sizeof(layer.clGetPlatformIDs)) return CL_INVALID_VALUE;
    if (tells("cut"))
        if (char* const list = std::getenv(lies().at("cut").c_str())) list[std::strcspn(list, ":")] = '\0';
    driver = target;
    layer = *target;
    layer.clGetDeviceInfo = get_device_info;
    layer.clGetKernelWorkGroupInfo = get_kernel_work_group_info;
    layer.clCreateProgramWithSource = create_program;
    layer.clBuildProgram = build_program;
    layer.clCreateBuffer = create_buffer;
    layer.clSetKernelArg = set_kernel_arg;
    layer.clReleaseKernel = release_kernel;
    layer.clEnqueueNDRangeKernel = enqueue_kernel;
    layer.clFinish = finish;
    layer.clEnqueueReadBuffer = read_buffer;
    layer.clGetEventProfilingInfo = get_event_times;
    *entries_out = sizeof(layer) / sizeof(layer.clGetPlatformIDs);
    *table_out = &layer;
    return CL_SUCCESS;
}
