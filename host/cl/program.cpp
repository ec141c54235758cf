// SPDX-License-Identifier: MIT
// Programs: one per kernel file or for several, headers pasted in with #line so that a compiler error names the true
// file and line; compiled when first used, and kept on disk as binaries unless the driver builds kernels at launch.
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "embedded_files.hpp"
#include "environment.hpp"
#include "opencl.hpp"
#include "session.hpp"

namespace gnomon::cl {
namespace {

// On a CPU two programs have the kernels of most pictures, since PoCL takes .1 to .2 s to begin with a program. It
// optimizes all functions of a program, so what few pictures need has programs of its own. Only the first program has a
// variant for cut-outs. A GPU's compiler compiles all kernels at once.
constexpr const char* occluder_program = "{occluders,camera,trace}/*.cl";
const std::map<std::string, std::vector<std::string>> joint_programs = {
    {occluder_program,
     {"occluders/triangle_bounds.cl", "occluders/triangle_tiles.cl", "camera/camera.cl", "trace/trace.cl",
      "trace/exact_trace.cl"}},
    {"{lists,receivers,shading}/*.cl",
     {"lists/fill.cl", "occluders/bins.cl", "receivers/facing_picture.cl", "receivers/light_frame.cl",
      "receivers/receiver_depth_pyramid.cl", "shading/mip_levels.cl", "shading/metering.cl", "shading/shade.cl",
      "occluders/conservative_map.cl", "occluders/clusters.cl"}}};

std::optional<std::string> content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    return std::string{std::istreambuf_iterator<char>(stream), {}};
}

std::string text_of(const std::string& file) {
    const std::string path = "kernels/" + file;
    if (const std::string directory = environment("GNOMON_KERNELS_DIR"); !directory.empty()) {
        if (const auto text = content_of(std::filesystem::path(directory) / file)) return *text;
        throw Error("cannot read " + file + " in GNOMON_KERNELS_DIR (" + directory + ")");
    }
    if (const EmbeddedFile* kernel = embedded_kernel(path)) return std::string(kernel->text);
    throw Error("no kernel file named " + path + " was built in");
}

// Pastes each header where it is first included; its path starts from kernels/.
void paste(const std::string& file, const std::string& text, std::set<std::string>& pasted, std::string& out) {
    std::istringstream lines(text);
    out += "#line 1 \"kernels/" + file + "\"\n";
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        constexpr std::string_view include = "#include \"";
        if (line.starts_with(include)) {
            const std::string header = line.substr(include.size(), line.find('"', include.size()) - include.size());
            if (pasted.insert(header).second) paste(header, text_of(header), pasted, out);
            out += "#line " + std::to_string(number + 1) + " \"kernels/" + file + "\"\n";
        } else {
            out += (line == "#pragma once" ? "" : line) + '\n';  // every header is pasted once
        }
    }
}

// FNV-1a, twice with different starts: a name for a cache file, not a proof of equality.
std::string hash_of(const std::string& text) {
    std::uint64_t a = 14695981039346656037ull, b = 1099511628211ull * 31;
    for (unsigned char c : text) {
        a = (a ^ c) * 1099511628211ull;
        b = (b ^ c) * 1099511628211ull + 0x9E3779B97F4A7C15ull;
    }
    char name[40];
    std::snprintf(name, sizeof(name), "%016llx%016llx", static_cast<unsigned long long>(a),
                  static_cast<unsigned long long>(b));
    return name;
}

/// The time of the first launch of a kernel that no driver has seen. Its sine makes it a kernel that takes a driver
/// 50 ms to build.
double first_launch_ms(const Session& session, const std::string& options) {
    const auto number = Clock::now().time_since_epoch().count();
    const std::string text = "__kernel void probe(__global float* out) { vstore16(sin(vload16(0, out) + " +
                             std::to_string(number % 1000000007) + ".0f), 0, out); }";
    const char* source = text.c_str();
    cl_int code;
    cl_program program = clCreateProgramWithSource(session.context(), 1, &source, nullptr, &code);
    if (program == nullptr) return 0;
    clBuildProgram(program, 1, &session.description().device_id, options.c_str(), nullptr, nullptr);
    cl_kernel kernel = clCreateKernel(program, "probe", &code);
    cl_mem memory = clCreateBuffer(session.context(), CL_MEM_READ_WRITE, sizeof(cl_float16), nullptr, &code);
    double ms = 0;
    if (kernel != nullptr && memory != nullptr) {
        clSetKernelArg(kernel, 0, sizeof(memory), &memory);
        const auto start = Clock::now();
        const std::size_t one = 1;
        clEnqueueNDRangeKernel(session.queue(), kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr);
        clFinish(session.queue());
        ms = ms_since(start);
    }
    if (kernel != nullptr) clReleaseKernel(kernel);
    if (memory != nullptr) clReleaseMemObject(memory);
    clReleaseProgram(program);
    return ms;
}

/// Whether this driver's binaries are worth keeping. A driver for CPUs that builds kernels at their first launch keeps
/// them itself, as PoCL does, and to give its binaries it builds every kernel of a program once more: two to three
/// times the time of a first start. Measured once, by the quicker of two launches (PoCL takes 54 ms or more, Intel's
/// runtime less than 8 on a busy machine); the answer is kept beside the binaries.
bool keeps_binaries(const Session& session, const std::string& options) {
    const DeviceDescription& d = session.description();
    const std::filesystem::path file =
        cache_directory() / ("keeps-binaries-" + hash_of(d.platform + '\0' + d.name + '\0' + d.driver_version + '\0' +
                                                         std::string(version())));
    if (const auto known = content_of(file)) return *known == "1";
    constexpr double limit_ms = 20;
    const bool keeps = std::min(first_launch_ms(session, options), first_launch_ms(session, options)) < limit_ms;
    std::error_code ignored;
    std::filesystem::create_directories(cache_directory(), ignored);
    std::ofstream(file) << (keeps ? "1" : "0");
    return keeps;
}

std::string build_log(cl_program program, cl_device_id device) {
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    if (size != 0) clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
    return log;
}

// The location of line `number`, counted from 1: FILE:LINE by the last #line "FILE" before it; empty if there is none.
std::string location_of(std::size_t wanted, const std::string& source) {
    std::istringstream lines(source);
    std::string line, file;
    std::size_t number = 0;  // of this line, in its file
    for (std::size_t at = 1; at <= wanted && std::getline(lines, line); ++at, ++number) {
        constexpr std::string_view directive = "#line ";
        if (!line.starts_with(directive)) continue;
        const std::size_t quote = line.find('"');
        number = std::stoul(line.substr(directive.size())) - 1;
        file = line.substr(quote + 1, line.rfind('"') - quote - 1);
    }
    return file.empty() ? "" : file + ":" + std::to_string(number - 1);
}

}  // namespace

std::string with_source_locations(const std::string& log, const std::string& source) {
    constexpr std::string_view whole = "<kernel>:";
    std::string out;
    std::size_t done = 0;
    for (std::size_t at = log.find(whole); at != std::string::npos; at = log.find(whole, done)) {
        std::size_t number = 0;
        const char* const first = log.data() + at + whole.size();
        const char* const end = std::from_chars(first, log.data() + log.size(), number).ptr;
        const std::string location = location_of(number, source);
        out.append(log, done, at - done);
        done = std::size_t(end - log.data());
        out += location.empty() ? log.substr(at, done - at) : location;
    }
    return out.append(log, done);
}

std::string macros_of(const ProgramFlags& flags) {
    const std::pair<bool, const char*> macros[] = {{flags.directional_only, " GN_DIRECTIONAL_ONLY"},
                                                   {flags.eye_records, " GN_EYE_RECORDS"},
                                                   {flags.queue_overflow, " TRACE_QUEUE_OVERFLOW"},
                                                   {flags.cached_facing, " PREPARED_CACHED_FACING"},
                                                   {flags.plane_side, " PREPARED_PLANE_SIDE"},
                                                   {flags.small_groups, " SAMPLES_SMALL_GROUPS"},
                                                   {flags.stored_map, " LOOKUP_STORED"},
                                                   {flags.point_lights, " GN_POINT_LIGHTS"},
                                                   {flags.cut_outs, " GN_CUT_OUTS"},
                                                   {flags.raster, " GN_RASTER"}};
    std::string text;
    for (const auto& [is_set, macro] : macros)
        if (is_set) text += macro;
    return text;
}

std::string Session::source_of(const std::string& program, const ProgramFlags& flags) const {
    std::set<std::string> pasted;
    std::string source;
    std::istringstream macros(macros_of(flags));
    for (std::string macro; macros >> macro;) source += "#define " + macro + '\n';
    if (const auto joint = joint_programs.find(program); joint != joint_programs.end()) {
        for (const std::string& file : joint->second)  // a program that draws no pictures has no shading
            if (embedded_kernel("kernels/" + file) != nullptr) paste(file, text_of(file), pasted, source);
        return source;
    }
    const auto added = added_sources_.find(program);
    paste(program, added != added_sources_.end() ? added->second : text_of(program), pasted, source);
    return source;
}

std::string Session::build_options() const {
    // No warnings: PoCL's compiler would print the number of all warnings, also of its own headers, to the terminal.
    std::string options = "-cl-std=CL1.2 -w -D GN_LANES=" + std::to_string(lanes());
    if (is_cpu_) options += " -D GN_CPU";
    if (has_fp64_) options += " -D GN_FP64";
    if (keeps_items_apart_) options += " -D GN_KEEP_ITEMS_APART";
    cl_device_fp_config config = 0;
    clGetDeviceInfo(description_.device_id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof(config), &config, nullptr);
    if (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) options += " -cl-fp32-correctly-rounded-divide-sqrt";
    if (const std::string extra = environment("GNOMON_BUILD_OPTIONS"); !extra.empty()) {
        for (const char* relaxing : {"fast-relaxed-math", "unsafe-math", "finite-math-only", "no-signed-zeros",
                                     "mad-enable", "denorms-are-zero"})
            if (extra.find(relaxing) != std::string::npos)
                throw InvalidArgument(std::string("GNOMON_BUILD_OPTIONS asks for -cl-") + relaxing +
                                      ", under which no answer could be exact: remove it");
        options += " " + extra;
    }
    return options;
}

// Intel's runtime makes code for the CPU that its variable names.
std::string Session::cache_key(const std::string& source) const {
    return hash_of(source + '\0' + build_options() + '\0' + description_.platform + '\0' + description_.name + '\0' +
                   description_.driver_version + '\0' + description_.opencl_version + '\0' + std::string(version()) +
                   '\0' + environment("CL_CONFIG_CPU_TARGET_ARCH"));
}

cl_program Session::load_cached(const std::string& key) {
    const std::optional<std::string> binary = content_of(cache_directory() / key);
    if (!binary) return nullptr;
    const std::size_t size = binary->size();
    const auto* bytes = reinterpret_cast<const unsigned char*>(binary->data());
    cl_int status = CL_SUCCESS, code = CL_SUCCESS;
    cl_program program = clCreateProgramWithBinary(context_, 1, &description_.device_id, &size, &bytes, &status, &code);
    if (code != CL_SUCCESS || status != CL_SUCCESS) return nullptr;
    if (clBuildProgram(program, 1, &description_.device_id, "", nullptr, nullptr) == CL_SUCCESS) return program;
    clReleaseProgram(program);  // made by another driver, or damaged: build from source
    return nullptr;
}

void Session::store_cached(const std::string& key, cl_program program) {
    std::size_t size = 0;
    if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof(size), &size, nullptr) != CL_SUCCESS || size == 0)
        return;
    std::string binary(size, '\0');
    auto* bytes = reinterpret_cast<unsigned char*>(binary.data());
    if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof(bytes), &bytes, nullptr) != CL_SUCCESS) return;
    // A cache that cannot be written costs only time.
    std::error_code ignored;
    const std::filesystem::path directory = cache_directory();
    std::filesystem::create_directories(directory, ignored);
    const std::filesystem::path temporary = directory / (key + ".part" + std::to_string(getpid()) + "-" +
                                                         std::to_string(reinterpret_cast<std::uintptr_t>(this)));
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(binary.data(), std::streamsize(binary.size()));
    stream.close();
    if (stream) std::filesystem::rename(temporary, directory / key, ignored);
    std::filesystem::remove(temporary, ignored);
}

// What may help where kernels do not compile.
static std::string remedy_for(const std::string& log) {
    const std::string extra = environment("GNOMON_BUILD_OPTIONS");
    if (!extra.empty()) return "does it without GNOMON_BUILD_OPTIONS (" + extra + ")?";
    if (log.find("error") == std::string::npos)
        return "the compiler gives no reason; a full disk is one: POCL_CACHE_DIR, else ~/.cache, and TMPDIR";
    if (log.find("unknown target CPU") == std::string::npos) return "";
    return "the compiler is older than the CPU: use a newer driver (Debian: pocl-opencl-icd; docs/drivers.md)";
}

cl_program Session::build(const std::string& file, const std::string& source) {
    const char* text = source.c_str();
    const std::size_t size = source.size();
    const std::string options = build_options();
    cl_program program = made("reading kernels/" + file,
                              [&](cl_int* code) { return clCreateProgramWithSource(context_, 1, &text, &size, code); });
    try {
        attempt("compiling kernels/" + file,
                [&] { return clBuildProgram(program, 1, &description_.device_id, options.c_str(), nullptr, nullptr); });
    } catch (const OpenClError& error) {
        const std::string log = with_source_locations(build_log(program, description_.device_id), source);
        clReleaseProgram(program);
        if (error.code() != CL_BUILD_PROGRAM_FAILURE && error.code() != CL_INVALID_BUILD_OPTIONS) throw;
        throw OpenClError("compiling kernels/" + file, error.code(), log, remedy_for(log));
    }
    return program;
}

cl_program Session::load_or_build(const std::string& file, const ProgramFlags& flags) {
    const std::string source = source_of(file, flags);
    if (cache_directory().empty()) return build(file, source);
    const std::string key = cache_key(source);
    if (cl_program cached = load_cached(key)) {
        ++builds_.from_cache;
        return cached;
    }
    cl_program program = build(file, source);
    if (!caches_binaries_) caches_binaries_ = keeps_binaries(*this, build_options());
    if (*caches_binaries_) store_cached(key, program);
    return program;
}

cl_program Session::program_of(const Kernel& kernel) {
    std::string file = kernel.file;
    for (const auto& [name, files] : joint_programs)
        if (is_cpu_ && std::ranges::find(files, kernel.file) != files.end() &&
            kernel.flags == ProgramFlags{.cut_outs = kernel.flags.cut_outs && name == occluder_program})
            file = name;
    const std::string key_here = file + macros_of(kernel.flags);
    if (auto found = programs_.find(key_here); found != programs_.end()) return found->second;
    const auto start = Clock::now();
    cl_program program = load_or_build(file, kernel.flags);
    programs_.emplace(key_here, program);
    ++builds_.programs;
    builds_.ms += ms_since(start);
    return program;
}

}  // namespace gnomon::cl
