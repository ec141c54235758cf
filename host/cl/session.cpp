// SPDX-License-Identifier: MIT
#include "session.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <utility>
#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "opencl.hpp"

namespace gnomon::cl {

void check(cl_int code, std::string_view call) {
    if (code == CL_SUCCESS) return;
    if (code == forked_process) require_unforked();
    if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES || code == CL_OUT_OF_HOST_MEMORY ||
        code == CL_INVALID_BUFFER_SIZE)
        throw OutOfDeviceMemory(call, code);
    if (code == CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST)
        throw OpenClError(std::string(call) + ", after a command that the device did not complete,", code);
    throw OpenClError(call, code);
}

// ---- Buffer ---------------------------------------------------------------------------------------------------------

void Buffer::reserve(Session& session, std::size_t bytes) {
    bytes = std::max<std::size_t>(bytes, 16);
    if (memory_ != nullptr && bytes <= bytes_) return;
    release();
    memory_ = session.allocate(bytes);
    session_ = &session;
    bytes_ = bytes;
}

void Buffer::swap(Buffer& other) noexcept {
    std::swap(session_, other.session_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
}

void Buffer::release() noexcept {
    if (memory_ != nullptr) session_->deallocate(memory_, bytes_);
    memory_ = nullptr;
    bytes_ = 0;
}

cl_mem Session::allocate(std::size_t bytes) {
    const std::string what = "allocating " + std::to_string(bytes) + " bytes on the device";
    if (memory_limit_bytes_ != 0 && memory_bytes_ + bytes > memory_limit_bytes_)
        throw OutOfDeviceMemory(what + " beside the " + std::to_string(memory_bytes_) + " in use, under the limit of " +
                                    std::to_string(memory_limit_bytes_) + " that was set,",
                                CL_MEM_OBJECT_ALLOCATION_FAILURE, "raise the limit or ask for fewer points");
    if (bytes > description_.largest_allocation_bytes)
        throw OutOfDeviceMemory(what + ", more than its largest allocation of " +
                                    std::to_string(description_.largest_allocation_bytes) + ",",
                                CL_INVALID_BUFFER_SIZE, "ask for fewer points at once, or use another device");
    cl_mem memory =
        made(what, [&](cl_int* code) { return clCreateBuffer(context_, CL_MEM_READ_WRITE, bytes, nullptr, code); });
    if (is_cpu_) ask_for_large_pages(memory, bytes);
    memory_bytes_ += bytes;
    peak_memory_bytes_ = std::max(peak_memory_bytes_, memory_bytes_);
    run_peak_bytes_ = std::max(run_peak_bytes_, memory_bytes_);
    return memory;
}

// A CPU's large buffers lie in pages of 2 MiB where the system has them: lists and triangles are read out of order, and
// a picture's buffers are touched for the first time (foliage: .86 to .96 of the time).
void Session::ask_for_large_pages([[maybe_unused]] cl_mem memory, [[maybe_unused]] std::size_t bytes) noexcept {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t page = std::size_t{1} << 21;
    if (bytes < 2 * page) return;
    cl_int code;
    if (traces_) std::fprintf(stderr, "gnomon: trace: mapping a buffer of %zu bytes for large pages, waits\n", bytes);
    void* const mapped = clEnqueueMapBuffer(queue_, memory, CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0, bytes, 0,
                                            nullptr, nullptr, &code);
    if (mapped == nullptr) return;
    const auto start = reinterpret_cast<std::uintptr_t>(mapped);
    const std::uintptr_t first = (start + page - 1) / page * page, last = (start + bytes) / page * page;
    madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    clEnqueueUnmapMemObject(queue_, memory, mapped, 0, nullptr, nullptr);
#endif
}

void Session::deallocate(cl_mem memory, std::size_t bytes) noexcept {
    clReleaseMemObject(memory);
    memory_bytes_ -= bytes;
}

// ---- Session --------------------------------------------------------------------------------------------------------

Session::Session(const DeviceDescription& description, const DeviceOptions& options) : description_(description) {
    cl_int code;
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                                reinterpret_cast<cl_context_properties>(description.platform_id), 0};
    context_ = clCreateContext(properties, 1, &description_.device_id, nullptr, nullptr, &code);
    check(code, "opening device " + description.name);
    // A CPU's driver may build a kernel at its first launch (PoCL does): the clock tells how long that takes.
    const bool has_clock = options.profile || description.type == "CPU";
    queue_ = clCreateCommandQueue(context_, description_.device_id, has_clock ? CL_QUEUE_PROFILING_ENABLE : 0, &code);
    if (code != CL_SUCCESS) clReleaseContext(context_);
    check(code, "making a command queue on " + description.name);
    times_first_launches_ = description.type == "CPU";
    configure(options);
}

Session::Session(cl_context context, cl_command_queue queue, const DeviceOptions& options) {
    load_opencl();
    if (context == nullptr || queue == nullptr) throw InvalidArgument("the OpenCL context and queue must not be null");
    const auto get = [queue](cl_command_queue_info what, auto value, const char* call) {
        check(clGetCommandQueueInfo(queue, what, sizeof(value), &value, nullptr), call);
        return value;
    };
    if (get(CL_QUEUE_CONTEXT, cl_context(), "asking the queue for its context") != context)
        throw InvalidArgument("the command queue belongs to another OpenCL context than the one given with it");
    const auto device = get(CL_QUEUE_DEVICE, cl_device_id(), "asking the queue for its device");
    const auto properties =
        get(CL_QUEUE_PROPERTIES, cl_command_queue_properties(), "asking the queue for its properties");
    if (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)
        throw InvalidArgument("the command queue runs out of order: gnomon needs an in-order queue");
    description_ = describe(device);
    if (!description_.lacks.empty())
        throw DeviceNotFound("the device " + description_.name + " cannot be used: it lacks " + description_.lacks);
    check(clRetainContext(context), "retaining the context");
    context_ = context;
    check(clRetainCommandQueue(queue), "retaining the queue");
    queue_ = queue;
    DeviceOptions adjusted = options;
    adjusted.profile = (properties & CL_QUEUE_PROFILING_ENABLE) != 0;
    times_first_launches_ = adjusted.profile && description_.type == "CPU";
    configure(adjusted);
}

void Session::configure(const DeviceOptions& options) {
    // A driver for CPUs without vectors of floats joins work-items to vectors itself (llvmpipe): kernels for GPUs suit
    // it.
    clGetDeviceInfo(description_.device_id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof(native_floats_),
                    &native_floats_, nullptr);
    is_cpu_ = description_.type == "CPU" && native_floats_ > 1 && !options.gpu_kernels &&
              std::getenv("GNOMON_GPU_KERNELS") == nullptr;
    has_fp64_ = description_.has_fp64 && !options.hide_fp64;
    keeps_items_apart_ = description_.type == "CPU" && has_extension(description_.device_id, "cl_intel_vec_len_hint");
    profiles_ = options.profile;
    memory_limit_bytes_ = options.memory_limit_bytes;
    traces_ = std::getenv("GNOMON_TRACE") != nullptr;
    if (description_.type != "CPU") caches_binaries_ = true;  // of a CPU: see keeps_binaries()
    std::size_t largest = 1;
    clGetDeviceInfo(description_.device_id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof(largest), &largest, nullptr);
    const std::size_t wanted = options.work_group_size != 0 ? options.work_group_size : is_cpu_ ? 1 : 128;
    work_group_size_ = std::min(wanted, largest);
}

Session::~Session() {
    if (queue_ != nullptr) clFinish(queue_);
    for (cl_event event : events_) clReleaseEvent(event);
    for (const FirstLaunch& first : first_launches_) clReleaseEvent(first.before), clReleaseEvent(first.launch);
    for (auto& [name, cached] : kernels_) clReleaseKernel(cached.kernel);
    for (auto& [file, program] : programs_) clReleaseProgram(program);
    if (queue_ != nullptr) clReleaseCommandQueue(queue_);
    if (context_ != nullptr) clReleaseContext(context_);
}

std::size_t Session::many_groups() const {
    // A CPU takes chunks: enough of them for even shares, few enough for no overhead. A GPU needs full lanes.
    return is_cpu_ ? compute_units() * 64 : std::max<std::size_t>(1, compute_units() * 2048 / work_group_size_);
}

Range Session::uneven_items(std::size_t items, std::size_t each) const {
    if (!is_cpu_) return Range::groups(items / (each * work_group_size_) + 1);
    // PoCL 3.1 gives a thread half of many_groups() at once where there are two threads (pthread_scheduler.c: up to 32
    // groups for each thread): where that half is the heavier one, the other thread waits.
    constexpr std::size_t pieces = 4;
    return Range::groups(std::min((items + work_group_size_ - 1) / work_group_size_, many_groups() * pieces));
}

Range Session::small_groups() const {
    const std::size_t local = std::min<std::size_t>(work_group_size_, 32);
    return Range::groups(many_groups() * work_group_size_ / local, local);
}

// ---- Launches -------------------------------------------------------------------------------------------------------

void Session::set_raw_argument(cl_kernel kernel, const char* name, cl_uint index, std::size_t bytes,
                               const void* value) {
    const cl_int code = clSetKernelArg(kernel, index, bytes, value);
    if (code != CL_SUCCESS) check(code, "setting argument " + std::to_string(index) + " of kernel " + name);
}

const Session::BuiltKernel& Session::built(const Kernel& which) {
    const auto& [file, name, flags] = which;
    const std::string key = std::string(file) + ' ' + name + macros_of(flags);
    auto found = kernels_.find(key);
    if (found == kernels_.end()) {
        cl_program program = program_of(which);
        cl_kernel kernel = made(std::string("making kernel ") + name + " of " + file,
                                [&](cl_int* code) { return clCreateKernel(program, which.name, code); });
        cl_uint count = 0;
        clGetKernelInfo(kernel, CL_KERNEL_NUM_ARGS, sizeof(count), &count, nullptr);
        std::size_t largest = 0;
        clGetKernelWorkGroupInfo(kernel, description_.device_id, CL_KERNEL_WORK_GROUP_SIZE, sizeof(largest), &largest,
                                 nullptr);
        found = kernels_.emplace(key, BuiltKernel{kernel, count, largest != 0 ? largest : work_group_size_}).first;
        is_first_launch_ = true;
    }
    return found->second;
}

const Session::BuiltKernel& Session::kernel_of(const Kernel& which, std::size_t argument_count) {
    const BuiltKernel& kernel = built(which);
    if (kernel.argument_count != argument_count)
        throw Error(std::string("kernel ") + which.name + " takes " + std::to_string(kernel.argument_count) +
                    " arguments and was given " + std::to_string(argument_count));
    return kernel;
}

void Session::enqueue(const BuiltKernel& kernel, const char* name, Range range) {
    const std::size_t local = std::min(range.local != 0 ? range.local : work_group_size_, kernel.largest_group);
    if (range.is_exact && local != range.local)
        throw Error("kernel " + std::string(name) + " needs work-groups of " + std::to_string(range.local) +
                    " items, and the device allows it " + std::to_string(local) + ": use another device");
    std::size_t groups = range.count;
    if (range.kind != Range::Kind::groups) {
        const bool is_shared = is_cpu_ && range.kind == Range::Kind::shares;
        groups = std::min((range.count + local - 1) / local, is_shared ? compute_units() : many_groups());
    }
    const std::size_t global = std::max<std::size_t>(groups, 1) * local;
    cl_event event = nullptr, before = nullptr;
    const bool is_first = std::exchange(is_first_launch_, false) && times_first_launches_;
    const auto start = Clock::now();
    attempt(std::string("launching kernel ") + name, [&] {
        if (is_first) clEnqueueMarkerWithWaitList(queue_, 0, nullptr, &before);
        const cl_int code = clEnqueueNDRangeKernel(queue_, kernel.kernel, 1, nullptr, &global, &local, 0, nullptr,
                                                   profiles_ || before != nullptr ? &event : nullptr);
        if (code != CL_SUCCESS && before != nullptr) clReleaseEvent(before);
        return code;
    });
    if (before != nullptr) first_launches_.push_back({before, event});
    if (before != nullptr && profiles_) clRetainEvent(event);
    if (profiles_) events_.push_back(event);
    if (traces_) {
        check(clFinish(queue_), "waiting for the device");  // for the trace alone
        std::fprintf(stderr, "gnomon: trace: %-28s %9zu x %-4zu %10.3f ms\n", name, global / local, local,
                     ms_since(start));
    }
}

const Buffer& Session::shares_buffer() {
    constexpr std::size_t bytes = 256;  // prelude.h
    if (shares_.get() != nullptr) return shares_;
    reserve_filled(shares_, 0, bytes);
    memory_bytes_ -= shares_.bytes();  // the session's own: nobody gets it back before the session ends
    return shares_;
}

void Session::fill(cl_mem buffer, std::uint32_t word, std::size_t bytes) {
    attempt_timed("filling a buffer", [&](cl_event* event) {
        return clEnqueueFillBuffer(queue_, buffer, &word, sizeof(word), 0, bytes, 0, nullptr, event);
    });
}

// On a CPU a fill is cheaper than a launch (PoCL 5.0, 16 threads: 14 us and 46), but one thread does it (8 bytes/ns).
void Session::fill_all(std::span<const Fill> fills) {
    constexpr std::size_t bytes_of_an_item = 16384, bytes_worth_a_launch = 262144;
    if (const auto is_small = [](const Fill& f) { return f.bytes < bytes_worth_a_launch; };
        fills.size() == 1 ? !is_cpu_ || is_small(fills[0]) : is_cpu_ && std::ranges::all_of(fills, is_small)) {
        for (const Fill& f : fills)
            if (f.bytes != 0) fill(f.buffer, f.word, f.bytes);
        return;
    }
    std::size_t most = 0;
    for (const Fill& f : fills) most = std::max(most, f.bytes / sizeof(cl_uint));
    const auto fill_at = [&](std::size_t i) { return i < fills.size() ? fills[i] : Fill{fills[0].buffer, 0, 0}; };
    const Range items = Range::items(is_cpu_ ? most * sizeof(cl_uint) / bytes_of_an_item + 1 : most);
    const auto words = [&](std::size_t i) { return cl_ulong(fill_at(i).bytes / sizeof(cl_uint)); };
    launch("lists/fill.cl", "fill_buffers", items, words(0), fill_at(0).word, fill_at(0).buffer, words(1),
           fill_at(1).word, fill_at(1).buffer, words(2), fill_at(2).word, fill_at(2).buffer, words(3), fill_at(3).word,
           fill_at(3).buffer);
}

void Session::copy(const Buffer& from, std::size_t from_first, const Buffer& to, std::size_t to_first,
                   std::size_t bytes) {
    if (bytes == 0) return;
    attempt_timed("copying a buffer", [&](cl_event* event) {
        return clEnqueueCopyBuffer(queue_, from.get(), to.get(), from_first, to_first, bytes, 0, nullptr, event);
    });
}

void Session::write(cl_mem buffer, const void* data, std::size_t bytes, std::size_t first) {
    if (bytes == 0) return;
    if (traces_) std::fprintf(stderr, "gnomon: trace: writing %zu bytes to the device, waits\n", bytes);
    attempt("writing to the device",
            [&] { return clEnqueueWriteBuffer(queue_, buffer, CL_TRUE, first, bytes, data, 0, nullptr, nullptr); });
}

void Session::read(cl_mem buffer, void* data, std::size_t bytes, std::size_t first) {
    if (bytes == 0) return;
    if (traces_) std::fprintf(stderr, "gnomon: trace: reading %zu bytes from the device, waits\n", bytes);
    attempt("reading from the device",
            [&] { return clEnqueueReadBuffer(queue_, buffer, CL_TRUE, first, bytes, data, 0, nullptr, nullptr); });
}

void Session::bring_to_host(cl_mem buffer, std::size_t bytes) {
    if (traces_) std::fprintf(stderr, "gnomon: trace: mapping a buffer of %zu bytes, waits\n", bytes);
    void* const mapped = made("mapping a buffer", [&](cl_int* code) {
        return clEnqueueMapBuffer(queue_, buffer, CL_TRUE, CL_MAP_READ, 0, bytes, 0, nullptr, nullptr, code);
    });
    attempt("unmapping a buffer", [&] { return clEnqueueUnmapMemObject(queue_, buffer, mapped, 0, nullptr, nullptr); });
}

void Session::finish() {
    if (traces_) std::fprintf(stderr, "gnomon: trace: finishing the queue, waits\n");
    attempt("waiting for the device", [&] { return clFinish(queue_); });
}

namespace {

cl_ulong ns_of(cl_event event, cl_profiling_info moment) {
    cl_ulong ns = 0;
    clGetEventProfilingInfo(event, moment, sizeof(ns), &ns, nullptr);
    return ns;
}

}  // namespace

// A kernel that is new to PoCL is ready to start when the launch before it has ended; it starts when it is built.
KernelBuilds Session::kernel_builds() {
    if (!first_launches_.empty()) finish();
    for (const auto& [before, launch] : first_launches_) {
        const cl_ulong ready =
            std::max(ns_of(before, CL_PROFILING_COMMAND_END), ns_of(launch, CL_PROFILING_COMMAND_QUEUED));
        const cl_ulong started = ns_of(launch, CL_PROFILING_COMMAND_START);
        if (started > ready) builds_.ms += double(started - ready) * 1e-6;
        clReleaseEvent(before);
        clReleaseEvent(launch);
    }
    first_launches_.clear();
    return builds_;
}

double Session::take_device_ms() {
    if (events_.empty()) return 0;
    finish();
    double ms = 0;
    for (cl_event event : events_) {
        ms += double(ns_of(event, CL_PROFILING_COMMAND_END) - ns_of(event, CL_PROFILING_COMMAND_START)) * 1e-6;
        clReleaseEvent(event);
    }
    events_.clear();
    return ms;
}

void StageTimer::next(const char* name) {
    if (name_ != nullptr && name != nullptr && std::string_view(name) == name_) return;
    if (name_ != nullptr) {
        double device_ms = 0;
        try {
            device_ms = session_.take_device_ms();
            if (session_.profiles()) session_.kernel_builds();
        } catch (const Error&) {  // the stage's own failure is already on its way up
        }
        const double wall_ms = ms_since(start_) - (session_.build_ms() - build_ms_);
        statistics_.stages.push_back({name_, device_ms, std::max(0.0, wall_ms), {}});
    }
    name_ = name;
    build_ms_ = session_.build_ms();
    start_ = Clock::now();
}

}  // namespace gnomon::cl
