// SPDX-License-Identifier: MIT
// Nothing grows: each public operation of C++ and of C, repeated. Heap, device memory, threads and file handles stay
// the same after the first rounds; bare OpenCL calls stand beside them. (Python: tests/python/test_nothing_grows.py.)
// GNOMON_ROUNDS=1000 repeats each a thousand times.
#include <gtest/gtest.h>
#include <malloc.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <gnomon.hpp>
#include <gnomon/rivals.hpp>
#include <gnomon/shading.hpp>
#include <random>
#include <thread>

#include "c/c_groups.h"
#include "cl/opencl.hpp"
#include "sight/height_grid.hpp"
#include "support/scene_makers.hpp"

namespace {

using gnomon::Device;
using gnomon::Points;
using gnomon::Triangles;
using gnomon::Visibility;
using support::Floats;

const Floats roof = {-1, 2, -1, 1, 2, -1, 1, 2, 1, -1, 2, -1, 1, 2, 1, -1, 2, 1};
const Floats ground = {0, 0, 0, 1, 0, 0, 1.001f, 0, 0};  // under the middle, under the edge, beside
const Floats truth = {0, 0, 1};
const gnomon::Light noon = gnomon::Light::directional({0, -1, 0});

/// What a process holds.
struct Held {
    double heap_bytes = 0;
    std::ptrdiff_t threads = 0, files = 0;
    std::uint64_t device_bytes = 0;
};

std::ptrdiff_t entries(const char* folder) {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

Held held(const Device* device) {
    const struct mallinfo2 info = mallinfo2();
    return {double(info.uordblks) + double(info.hblkhd), entries("/proc/self/task"), entries("/proc/self/fd"),
            device == nullptr ? 0 : device->memory_bytes()};
}

std::size_t rounds() {
    const char* const wanted = std::getenv("GNOMON_ROUNDS");
    return wanted == nullptr ? 30 : std::stoul(wanted);
}

/// What all operations share: a device that stays open.
struct Kept {
    Device device;
    Triangles triangles = Triangles::upload(device, roof);
    Points points = Points::upload(device, ground);
    Visibility visibility{device, 3};
    std::unique_ptr<gnomon::Technique> technique = gnomon::make_technique("frustum-traced", device);
};

void expect_answer(const Device& device) {
    const Triangles triangles = Triangles::upload(device, roof);
    const Points points = Points::upload(device, ground);
    const Visibility visibility(device, points.count());
    gnomon::make_technique("frustum-traced", device)->run(triangles, points, noon, visibility);
    ASSERT_EQ(visibility.read(), truth);
}

Floats soup(std::size_t triangle_count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-9, 9);
    Floats numbers(9 * triangle_count);
    for (float& number : numbers) number = place(random);
    return numbers;
}

struct Operation {
    const char* name;
    std::function<void(std::size_t round)> run;
};

/// Bytes of the heap that a round may add. A driver's pools grow by blocks, which few rounds share.
constexpr double nothing = 300;
/// While another context is open, PoCL 3.1's compiler (LLVM) keeps some 3 kB of each program, and a device builds
/// thirty. With all operators new watched, LLVM alone had called them.
constexpr double kept_by_pocl = 300'000;

gnomon::Camera above() { return gnomon::Camera::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 60); }

gnomon::DeviceDescription default_device() {
    for (const gnomon::DeviceDescription& device : gnomon::devices())
        if (device.is_default) return device;
    throw gnomon::Error("there is no device");
}

/// A context, and what `use` does with a queue of it.
void with_queue(const std::function<void(cl_context, cl_command_queue)>& use) {
    const cl_device_id id = default_device().device_id;
    cl_int error = CL_SUCCESS;
    const cl_context context = clCreateContext(nullptr, 1, &id, nullptr, nullptr, &error);
    ASSERT_EQ(error, CL_SUCCESS);
    const cl_command_queue queue = clCreateCommandQueue(context, id, 0, &error);
    ASSERT_EQ(error, CL_SUCCESS);
    use(context, queue);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
}

void build_and_run(cl_context context, cl_command_queue queue) {
    const char* source = "kernel void f(global float* x) { x[0] = 1; }";
    const cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, nullptr);
    ASSERT_EQ(clBuildProgram(program, 0, nullptr, nullptr, nullptr, nullptr), CL_SUCCESS);
    const cl_kernel kernel = clCreateKernel(program, "f", nullptr);
    const cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE, 1024, nullptr, nullptr);
    clSetKernelArg(kernel, 0, sizeof(buffer), &buffer);
    const std::size_t size = 1;
    ASSERT_EQ(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &size, nullptr, 0, nullptr, nullptr), CL_SUCCESS);
    clFinish(queue);
    clReleaseMemObject(buffer);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
}

/// Its events, of the first launches and of all, are given back when their times are asked for.
void device_that_profiles() {
    const Device device(default_device().selector, {.profile = true});
    expect_answer(device);
    EXPECT_GE(device.kernel_builds().ms, 0);
}

void bare_buffer(Kept& kept) {
    float answer[3];
    const cl_mem buffer = clCreateBuffer(kept.device.context(), CL_MEM_READ_WRITE, sizeof(answer), nullptr, nullptr);
    clEnqueueWriteBuffer(kept.device.queue(), buffer, CL_TRUE, 0, sizeof(answer), ground.data(), 0, nullptr, nullptr);
    clEnqueueReadBuffer(kept.device.queue(), buffer, CL_TRUE, 0, sizeof(answer), answer, 0, nullptr, nullptr);
    clReleaseMemObject(buffer);
}

void expect_triangles(const Device& device) {
    EXPECT_EQ(Triangles::upload(device, roof).count(), 2u);
    device.finish();
}

void device_by_name(std::size_t round) {
    expect_triangles(Device(default_device().selector, {.memory_limit_bytes = 100'000'000 + round}));
}

void scene_of_20_000(Kept& kept) {
    static const Floats many = soup(20'000);
    Triangles triangles = Triangles::upload(kept.device, many);
    triangles.keep_clusters(kept.device);
    kept.technique->run(triangles, kept.points, noon, kept.visibility);
    kept.device.finish();
    kept.technique->release_prepared_light();
}

void technique_of_other_settings(Kept& kept, std::size_t round) {
    const auto technique = gnomon::make_technique("frustum-traced", kept.device);
    technique->set("map-size", std::to_string(64 << round % 3));
    technique->run(kept.triangles, kept.points, noon, kept.visibility);
    ASSERT_EQ(kept.visibility.read(), truth);
}

void shadow_map_of_other_settings(Kept& kept, std::size_t round) {
    const auto technique = gnomon::make_technique("pcf", kept.device);
    technique->set("size", std::to_string(64 + 8 * (round % 20)));
    technique->run(kept.triangles, kept.points, noon, kept.visibility);
    kept.device.finish();
}

void prepared_light(Kept& kept, std::size_t round) {
    const gnomon::Light light = gnomon::Light::directional({0.01f * float(round % 7), -1, 0});
    kept.technique->prepare(kept.triangles, light);
    kept.technique->run(kept.triangles, kept.points, light, kept.visibility);
    kept.technique->release_prepared_light();
}

void table_of_lights(Kept& kept) {
    const gnomon::Lights sky = gnomon::sky_patches({0, 1, 0}, {0, 0, -1});
    gnomon::run_light_table_to_host(*kept.technique, kept.triangles, kept.points, sky, {.bits = true, .sums = true});
    gnomon::run_mean(*kept.technique, kept.triangles, kept.points, sky, kept.visibility);
    kept.device.finish();
}

/// What observers see is what lamps at their eyes light: one above the roof sees no point, one below it sees all.
void what_observers_see(Kept& kept) {
    const gnomon::Lights eyes({gnomon::Light::point({0, 5, 0}), gnomon::Light::point({0, 1, 0})});
    const auto seen =
        gnomon::run_light_table_to_host(*kept.technique, kept.triangles, kept.points, eyes, {.bits = true});
    ASSERT_EQ(seen.bits, std::vector<std::uint32_t>(3, 2));
}

void viewsheds(Kept& kept, std::size_t round) {
    constexpr std::int32_t size = 40;
    std::vector<std::int32_t> heights(size * size), spans;
    for (std::int32_t i = 0; i < size * size; ++i) heights[std::size_t(i)] = i % 97 == 0 ? NO_HEIGHT : i * 7919 % 500;
    for (std::int32_t i = 0; i < size; ++i) spans.insert(spans.end(), {0, size});
    gnomon::HeightGrid grid(kept.device, heights, size);
    const gnomon::Eye eye{std::int32_t(round % 9) * SUBCELLS, 20 * SUBCELLS, 600, 0};
    ASSERT_EQ(grid.look(eye, {0, size}, spans).size(), heights.size());
    ASSERT_EQ(grid.least_heights(eye, {0, size}, spans).size(), heights.size());
    ASSERT_EQ(grid.look_from({&eye, 1}, {0, size}, spans, true).words.size(), heights.size());
}

void run_that_is_cancelled(Kept& kept) {
    const gnomon::RunOptions options{.progress = [](double) { return false; }};
    EXPECT_THROW(kept.technique->run(kept.triangles, kept.points, noon, kept.visibility, options), gnomon::Cancelled);
}

void view_and_samples(Kept& kept) {
    gnomon::CameraPass pass(kept.device);
    const gnomon::View view = pass.look(kept.triangles, above(), 32, 24);
    const Visibility mean(kept.device, view.points.count());
    gnomon::run_samples(*kept.technique, kept.triangles, view, noon, 4, mean);
    const gnomon::Appearance look = gnomon::Appearance::upload(kept.device, {{0, 0}, {{0.5f, 0.5f, 0.5f}}});
    EXPECT_EQ(gnomon::shade(look.surfaces(kept.triangles, view), {{mean}}, {{noon}}).rgba.size(), 4u * 32 * 24);
}

void explanation(Kept& kept) {
    EXPECT_EQ(gnomon::explain(kept.device, kept.triangles, kept.points, 0, noon).occluders.size(), 2u);
}

void errors(Kept& kept) {
    EXPECT_THROW(Triangles::upload(kept.device, Floats{1, 2, 3}), gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::make_technique("none", kept.device), gnomon::InvalidArgument);
    EXPECT_THROW(Device("abacus"), gnomon::DeviceNotFound);
    EXPECT_THROW(kept.technique->set("map-size", "many"), gnomon::InvalidArgument);
    const Visibility small(kept.device, 1);
    EXPECT_THROW(kept.technique->run(kept.triangles, kept.points, noon, small), gnomon::InvalidArgument);
}

/// Where no device is open: with the last context, PoCL's compiler gives back what it has kept of programs.
const std::vector<Operation> of_devices{
    {"bare OpenCL: a context and a queue", [](std::size_t) { with_queue([](cl_context, cl_command_queue) {}); }},
    {"bare OpenCL: a program", [](std::size_t) { with_queue(build_and_run); }},
    {"devices()", [](std::size_t) { ASSERT_FALSE(gnomon::devices().empty()); }},
    {"a device", [](std::size_t) { expect_answer(Device()); }},
    {"a device that profiles", [](std::size_t) { device_that_profiles(); }},
    {"a device by name, with a limit", device_by_name},
    {"a queue of the caller's",
     [](std::size_t) { with_queue([](cl_context c, cl_command_queue q) { expect_triangles(Device(c, q)); }); }},
};

std::vector<Operation> of_one_device(Kept& kept) {
    return {
        {"bare OpenCL: a buffer", [&](std::size_t) { bare_buffer(kept); }},
        {"a scene", [&](std::size_t) { expect_answer(kept.device); }},
        {"a scene of 20,000 triangles", [&](std::size_t) { scene_of_20_000(kept); }},
        {"a technique with other settings", [&](std::size_t round) { technique_of_other_settings(kept, round); }},
        {"a shadow map with other settings", [&](std::size_t round) { shadow_map_of_other_settings(kept, round); }},
        {"a prepared light", [&](std::size_t round) { prepared_light(kept, round); }},
        {"a table of lights", [&](std::size_t) { table_of_lights(kept); }},
        {"what observers see", [&](std::size_t) { what_observers_see(kept); }},
        {"viewsheds", [&](std::size_t round) { viewsheds(kept, round); }},
        {"a run that is cancelled", [&](std::size_t) { run_that_is_cancelled(kept); }},
        {"a view, its samples and its picture", [&](std::size_t) { view_and_samples(kept); }},
        {"an explanation", [&](std::size_t) { explanation(kept); }},
        {"errors", [&](std::size_t) { errors(kept); }},
        {"a thread's calls", [&](std::size_t) { std::thread([&] { expect_answer(kept.device); }).join(); }},
    };
}

/// A driver's threads end, and give back what they have used, when they come to it: waits up to a second for that.
Held settled(const Device* device, const Held& before, double more_bytes) {
    const auto grew = [&](const Held& now) {
        return now.threads > before.threads || now.heap_bytes > before.heap_bytes + more_bytes;
    };
    Held now = held(device);
    for (int i = 0; i < 100 && grew(now); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        now = held(device);
    }
    return now;
}

/// Runs the operation again and again; all that it holds after its first rounds it held before.
void expect_nothing_grows(const Operation& operation, double most_bytes = nothing, const Device* device = nullptr) {
    SCOPED_TRACE(operation.name);
    const std::size_t warm = 10, count = std::max<std::size_t>(rounds(), warm + 1);
    for (std::size_t i = 0; i < warm; ++i) operation.run(i);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const Held before = held(device);
    for (std::size_t i = warm; i < count; ++i) operation.run(i);
    const Held after = settled(device, before, most_bytes * double(count - warm));
    EXPECT_LE(after.threads, before.threads);
    EXPECT_LE(after.files, before.files);
    EXPECT_EQ(after.device_bytes, before.device_bytes);
    const double bytes = (after.heap_bytes - before.heap_bytes) / double(count - warm);
    EXPECT_LE(bytes, most_bytes);
    std::printf("%-36s %9.0f bytes of the heap a round\n", operation.name, bytes);
}

class NothingGrows : public testing::Test {
protected:
    void SetUp() override {
        const char* const tunables = std::getenv("GLIBC_TUNABLES");
        ASSERT_TRUE(tunables != nullptr && std::string_view(tunables).find("tcache_count=0") != std::string_view::npos)
            << "set GLIBC_TUNABLES=glibc.malloc.tcache_count=0: what threads' caches hold counts as held";
        gnomon::add_rivals();
    }
};

TEST_F(NothingGrows, OfDevices) {
    for (const Operation& operation : of_devices) expect_nothing_grows(operation);
}

TEST_F(NothingGrows, OfOneDevice) {
    Kept kept;
    for (const Operation& operation : of_one_device(kept)) expect_nothing_grows(operation, nothing, &kept.device);
}

/// C's own device stays open, so what another one built is kept by PoCL's compiler.
TEST_F(NothingGrows, InC) {
    c_inputs inputs;
    open_c_inputs(&inputs);
    for (std::size_t i = 0; i < c_group_count; ++i) {
        const c_group& group = c_groups[i];
        std::uint64_t bytes = 0, bytes_before = 0, peak = 0;
        group.run(&inputs);
        ASSERT_EQ(gnomon_device_memory(inputs.device, &bytes_before, &peak), GNOMON_SUCCESS);
        expect_nothing_grows({group.name, [&](std::size_t) { group.run(&inputs); }},
                             group.opens_a_device != 0 ? kept_by_pocl : nothing);
        ASSERT_EQ(gnomon_device_memory(inputs.device, &bytes, &peak), GNOMON_SUCCESS);
        EXPECT_EQ(bytes, bytes_before) << group.name;
    }
    close_c_inputs(&inputs);
    EXPECT_EQ(c_failures(), 0);
}

}  // namespace
