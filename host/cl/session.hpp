// SPDX-License-Identifier: MIT
// OpenCL plumbing: one device, its in-order queue, buffers with accounting, kernels by name, and the one place where
// kernels are launched (argument counts checked, times taken, launches printed under GNOMON_TRACE). All that blocks
// until the device is done is here, too; the trace marks it with "waits".
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <unordered_map>

#include <gnomon.hpp>

namespace gnomon::cl {

using Clock = std::chrono::steady_clock;
inline double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Throws OutOfDeviceMemory or OpenClError unless code is CL_SUCCESS.
void check(cl_int code, std::string_view call);

DeviceDescription describe(cl_device_id device);
bool has_extension(cl_device_id device, std::string_view name);

/// The device that a selector names (see Device). Throws DeviceNotFound with the list of all devices.
DeviceDescription select_device(std::string_view selector);

/// NVIDIA's compiler gives locations as "<kernel>:LINE" of the whole text, whatever #line gives. Returns `log` with
/// each such location replaced by the location that the #line directives of `source` give
/// ("kernels/trace/trace.cl:12"). Other logs are not changed.
std::string with_source_locations(const std::string& log, const std::string& source);

class Session;

/// Device memory of gnomon's own. A buffer that grows loses its contents.
class Buffer {
public:
    Buffer() = default;
    Buffer(Session& session, std::size_t bytes) { reserve(session, bytes); }
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Buffer() { release(); }

    /// At least `bytes` (and at least 16, so that every kernel argument is a buffer).
    void reserve(Session& session, std::size_t bytes);
    cl_mem get() const { return memory_; }
    std::size_t bytes() const { return bytes_; }

private:
    void swap(Buffer& other) noexcept;
    void release() noexcept;

    Session* session_ = nullptr;
    cl_mem memory_ = nullptr;
    std::size_t bytes_ = 0;
};

/// A kernel argument: this many bytes of local memory.
struct LocalBytes {
    std::size_t bytes;
};

/// This many bytes of a buffer, word by word.
struct Fill {
    const Buffer& buffer;
    std::uint32_t word;
    std::size_t bytes;
};

/// One text gives several programs: each flag defines a macro at the beginning of the program's text.
struct ProgramFlags {
    bool directional_only = false;  ///< every projection and light frame is parallel
    bool eye_records = false;       ///< records are made from a camera's rays
    bool queue_overflow = false;    ///< decides the pairs that found no slot in the queue
    bool cached_facing = false;     ///< of a prepared light's trace: facing is cached for each receiver
    bool plane_side = false;        ///< of a prepared light's trace: facing is decided by the receivers' planes
    bool small_groups = false;      ///< work-groups are smaller than a warp
    bool stored_map = false;        ///< a shadow map stores other quantities than depths
    bool point_lights = false;      ///< the lights of bundles have positions
    bool cut_outs = false;          ///< triangles may be masked or clear
    bool raster = false;            ///< the triangles are an implicit raster
    bool operator==(const ProgramFlags&) const = default;
};

/// The macros of these flags, each after a space.
std::string macros_of(const ProgramFlags& flags);

/// Kernel `name` of kernels/<file>, in the program with these flags.
struct Kernel {
    constexpr Kernel(const char* in_file, const char* of_name, const ProgramFlags& with_flags = {})
        : file(in_file), name(of_name), flags(with_flags) {}
    const char* file;
    const char* name;
    ProgramFlags flags;
};

/// The number of work-items: over `items` of GN_FOR_EACH, or exactly `groups` work-groups (of at most `local` items if
/// not 0; exactly this size where `is_exact`). Of a kernel with GN_SHARES: over `shares` (prelude.h).
struct Range {
    enum class Kind { items, groups, shares } kind;
    std::size_t count;
    std::size_t local = 0;
    bool is_exact = false;
    static Range items(std::size_t count) { return {Kind::items, count}; }
    static Range shares(std::size_t count) { return {Kind::shares, count}; }
    static Range groups(std::size_t count, std::size_t local = 0) { return {Kind::groups, count, local}; }
    static Range groups_of(std::size_t local, std::size_t count) { return {Kind::groups, count, local, true}; }
};

class Session {
public:
    Session(const DeviceDescription& description, const DeviceOptions& options);
    Session(cl_context context, cl_command_queue queue, const DeviceOptions& options);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const DeviceDescription& description() const { return description_; }
    void set_note(std::string note) { description_.note = std::move(note); }
    cl_context context() const { return context_; }
    cl_command_queue queue() const { return queue_; }
    bool is_cpu() const { return is_cpu_; }
    bool has_fp64() const { return has_fp64_; }
    /// Floats of a register, as the device states.
    std::uint32_t native_floats() const { return native_floats_; }
    /// A driver for CPUs that joins work-items to vectors itself (Mesa's llvmpipe).
    bool joins_items() const { return description_.type == "CPU" && native_floats_ <= 1; }
    bool profiles() const { return profiles_; }
    /// Points or pixels per work-item of the vector kernels.
    std::uint32_t lanes() const { return is_cpu_ ? 16 : 1; }
    /// Work-items for `count` points or pixels of a vector kernel.
    Range blocks(std::size_t count) const { return Range::items(count / lanes() + 1); }
    /// The same for a kernel with GN_SHARES.
    Range block_shares(std::size_t count) const { return Range::shares(count / lanes() + 1); }
    std::size_t compute_units() const { return description_.compute_units; }
    std::size_t work_group_size() const { return work_group_size_; }
    /// Work-groups that fill the device a few times over.
    std::size_t many_groups() const;
    /// Over `items` of unlike length: on a GPU enough groups to give each work-item about `each` of them, so that a
    /// multiprocessor that is done takes another group; on a CPU more groups than usual, for the same reason.
    Range uneven_items(std::size_t items, std::size_t each) const;
    /// Groups of at most 32 items (a GPU's warp) that fill the device: for groups that share out a few dozen things.
    Range small_groups() const;

    std::uint64_t memory_bytes() const { return memory_bytes_; }
    std::uint64_t peak_memory_bytes() const { return peak_memory_bytes_; }
    /// The largest amount since begin_run(): the memory that one run needed.
    std::uint64_t run_peak_bytes() const { return run_peak_bytes_; }
    void begin_run() { run_peak_bytes_ = memory_bytes_; }
    void forget_peak() { peak_memory_bytes_ = run_peak_bytes_ = memory_bytes_; }

    /// Enqueues a kernel. Arguments: Buffer, cl_mem, LocalBytes or plain values, all of them.
    template <typename... Arguments>
    void launch(const Kernel& which, Range range, const Arguments&... arguments) {
        const bool shares = is_cpu_ && range.kind == Range::Kind::shares;
        const BuiltKernel& kernel = kernel_of(which, sizeof...(Arguments) + shares);
        cl_uint index = 0;
        (set_argument(kernel.kernel, which.name, index++, arguments), ...);
        if (shares) set_argument(kernel.kernel, which.name, index, shares_buffer());
        enqueue(kernel, which.name, range);
    }
    /// The items that the device allows in a work-group of a kernel.
    std::size_t largest_group(const Kernel& which) { return built(which).largest_group; }
    template <typename... Arguments>
    void launch(const char* file, const char* name, Range range, const Arguments&... arguments) {
        launch(Kernel{file, name}, range, arguments...);
    }

    void fill(cl_mem buffer, std::uint32_t word, std::size_t bytes);
    void fill(const Buffer& buffer, std::uint32_t word, std::size_t bytes) { fill(buffer.get(), word, bytes); }
    /// Several buffers, or a large one, by one launch.
    template <std::size_t count>
    void fill(const Fill (&fills)[count]) {
        static_assert(count <= 4, "kernels/lists/fill.cl fills four buffers at most");
        fill_all(fills);
    }
    void reserve_filled(Buffer& buffer, std::uint32_t word, std::size_t bytes) {
        buffer.reserve(*this, bytes);
        fill(buffer, word, bytes);
    }
    /// From byte `from_first` of one buffer to byte `to_first` of another.
    void copy(const Buffer& from, std::size_t from_first, const Buffer& to, std::size_t to_first, std::size_t bytes);
    /// To byte `first` of the buffer.
    void write(cl_mem buffer, const void* data, std::size_t bytes, std::size_t first = 0);
    template <typename Values>
    void upload(Buffer& buffer, const Values& values) {
        const std::size_t bytes = values.size() * sizeof(values[0]);
        buffer.reserve(*this, bytes);
        write(buffer.get(), values.data(), bytes);
    }
    /// From byte `first` of the buffer.
    void read(cl_mem buffer, void* data, std::size_t bytes, std::size_t first = 0);
    /// Makes a buffer's bytes appear in the host's memory that the buffer was made of.
    void bring_to_host(cl_mem buffer, std::size_t bytes);
    /// The first bytes of the buffer.
    template <typename Value>
    Value read_value(const Buffer& buffer) {
        Value value;
        read(buffer.get(), &value, sizeof(value));
        return value;
    }
    template <typename Value>
    std::vector<Value> read_values(cl_mem buffer, std::size_t count) {
        std::vector<Value> values(count);
        read(buffer, values.data(), count * sizeof(Value));
        return values;
    }
    void finish();

    /// Makes a kernel file of this text known under `file`; it may include files of kernels/. For tests, which add
    /// kernels of their own to the functions of the headers.
    void add_source(const std::string& file, std::string text) { added_sources_[file] = std::move(text); }

    /// Called before each OpenCL call that may fail on a sound device, with the call as errors name it. Returns the
    /// code with which the call fails instead of being made, or CL_SUCCESS. For tests; not set otherwise.
    using FaultInjector = std::function<cl_int(std::string_view call)>;
    void inject_faults(FaultInjector injector) { injector_ = std::move(injector); }

    /// Waits where kernels were launched for the first time since the last call.
    KernelBuilds kernel_builds();
    /// The part of it that is known without a wait.
    double build_ms() const { return builds_.ms; }

    /// Device time of the commands enqueued since the last call, in ms (waits); 0 without profiling.
    double take_device_ms();

private:
    friend class Buffer;
    /// Makes an OpenCL call (a function that returns its code); throws as check() does.
    template <typename Call>
    void attempt(std::string_view what, Call&& call) {
        const cl_int injected = injector_ ? injector_(what) : CL_SUCCESS;
        check(injected != CL_SUCCESS ? injected : call(), what);
    }
    /// The same for a call that returns what it makes, and its code through a pointer.
    template <typename Make>
    auto made(std::string_view what, Make&& make) {
        decltype(make(nullptr)) object{};
        attempt(what, [&] {
            cl_int code = CL_SUCCESS;
            object = make(&code);
            return code;
        });
        return object;
    }
    /// The same for a command, whose event the call gets a place for where the session profiles.
    template <typename Call>
    void attempt_timed(std::string_view what, Call&& call) {
        cl_event event = nullptr;
        attempt(what, [&] { return call(profiles_ ? &event : nullptr); });
        if (event != nullptr) events_.push_back(event);
    }
    cl_mem allocate(std::size_t bytes);
    void ask_for_large_pages(cl_mem memory, std::size_t bytes) noexcept;
    void deallocate(cl_mem memory, std::size_t bytes) noexcept;
    std::string source_of(const std::string& program, const ProgramFlags& flags) const;
    struct BuiltKernel {
        cl_kernel kernel;
        cl_uint argument_count;
        std::size_t largest_group;  ///< on a GPU a kernel that needs many registers may allow less than the device
    };
    const BuiltKernel& built(const Kernel& which);
    const BuiltKernel& kernel_of(const Kernel& which, std::size_t argument_count);
    cl_program program_of(const Kernel& kernel);
    cl_program load_or_build(const std::string& file, const ProgramFlags& flags);
    cl_program build(const std::string& file, const std::string& source);
    cl_program load_cached(const std::string& key);
    void store_cached(const std::string& key, cl_program program);
    std::string build_options() const;
    std::string cache_key(const std::string& source) const;
    void enqueue(const BuiltKernel& kernel, const char* name, Range range);
    const Buffer& shares_buffer();
    void fill_all(std::span<const Fill> fills);
    void configure(const DeviceOptions& options);

    void set_argument(cl_kernel kernel, const char* name, cl_uint index, const Buffer& buffer) {
        set_argument(kernel, name, index, buffer.get());
    }
    void set_argument(cl_kernel kernel, const char* name, cl_uint index, LocalBytes local) {
        set_raw_argument(kernel, name, index, local.bytes, nullptr);
    }
    template <typename Value>
    void set_argument(cl_kernel kernel, const char* name, cl_uint index, const Value& value) {
        static_assert(std::is_trivially_copyable_v<Value>);
        set_raw_argument(kernel, name, index, sizeof(value), &value);
    }
    static void set_raw_argument(cl_kernel kernel, const char* name, cl_uint index, std::size_t bytes,
                                 const void* value);

    DeviceDescription description_;
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
    bool is_cpu_ = false, has_fp64_ = false, profiles_ = false, traces_ = false;
    std::optional<bool> caches_binaries_;  ///< none: not yet known
    bool keeps_items_apart_ = false;
    cl_uint native_floats_ = 0;
    std::size_t work_group_size_ = 1;
    std::uint64_t memory_bytes_ = 0, peak_memory_bytes_ = 0, run_peak_bytes_ = 0, memory_limit_bytes_ = 0;
    FaultInjector injector_;
    std::unordered_map<std::string, std::string> added_sources_;
    std::unordered_map<std::string, cl_program> programs_;
    std::unordered_map<std::string, BuiltKernel> kernels_;
    std::vector<cl_event> events_;
    KernelBuilds builds_;
    bool times_first_launches_ = false, is_first_launch_ = false;
    struct FirstLaunch {
        cl_event before, launch;
    };
    std::vector<FirstLaunch> first_launches_;  ///< launches with waits that are not yet in builds_
    Buffer shares_;                            ///< of a CPU: the counter of the launch that runs (GN_SHARES)
};

/// Times one stage after the other into Statistics: wall time, and device time where the session profiles. Without a
/// name it times nothing.
class StageTimer {
public:
    StageTimer(Session& session, Statistics& statistics, const char* name = nullptr)
        : session_(session), statistics_(statistics) {
        next(name);
    }
    ~StageTimer() { next(nullptr); }
    void next(const char* name);  ///< the same name: the stage goes on

private:
    Session& session_;
    Statistics& statistics_;
    const char* name_ = nullptr;
    double build_ms_;
    Clock::time_point start_;
};

}  // namespace gnomon::cl
