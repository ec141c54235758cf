// SPDX-License-Identifier: MIT
// The public header in an embedder's use: own context, queue and buffers; every wrong argument and its error; memory
// limits; kernels that do not compile; several devices and techniques alive at once; statistics with right sums. The
// shadows of the scene below are known by hand: a square roof of two triangles over a grid of points.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <thread>

#include <gnomon.hpp>
#include "cl/session.hpp"
#include "support/environment.hpp"
#include "support/scene_makers.hpp"
#include "support/srgb.hpp"
#include "support/temporary_folder.hpp"

namespace {

using gnomon::Device;
using gnomon::DeviceOptions;
using gnomon::Points;
using gnomon::Triangles;
using gnomon::Visibility;
using support::Environment;
using support::Floats;
using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

const Floats roof = {-1, 2, -1, 1, 2, -1, 1, 2, 1, -1, 2, -1, 1, 2, 1, -1, 2, 1};
const gnomon::Light noon = gnomon::Light::directional({0, -1, 0});

/// A grid of 9 x 9 points half a unit apart; the closed roof is above the points with both coordinates from -1 to 1.
Floats ground() {
    Floats points;
    for (int x = -4; x <= 4; ++x)
        for (int z = -4; z <= 4; ++z) support::add(points, {float(x) / 2, 0, float(z) / 2});
    return points;
}
std::vector<float> ground_truth() {
    std::vector<float> visibility;
    for (int x = -4; x <= 4; ++x)
        for (int z = -4; z <= 4; ++z) visibility.push_back(std::abs(x) <= 2 && std::abs(z) <= 2 ? 0.0f : 1.0f);
    return visibility;
}

std::vector<float> trace(const Device& device, const Triangles& triangles, const Points& points) {
    const Visibility visibility(device, points.count());
    gnomon::make_technique("frustum-traced", device)->run(triangles, points, noon, visibility);
    return visibility.read();
}

/// Runs `action`, which must throw exactly this kind of error with all these words in its sentence.
template <typename Wanted>
AssertionResult throws(const std::function<void()>& action, const std::vector<std::string>& words) {
    try {
        action();
    } catch (const Wanted& error) {
        if (typeid(error) != typeid(Wanted)) return AssertionFailure() << "a kind of its own: " << error.what();
        const std::string text = error.what();
        for (const std::string& word : words)
            if (text.find(word) == std::string::npos) return AssertionFailure() << "no \"" << word << "\" in: " << text;
        return AssertionSuccess();
    } catch (const std::exception& error) {
        return AssertionFailure() << "threw another error: " << error.what();
    }
    return AssertionFailure() << "threw nothing";
}

// ---- An embedder's own OpenCL ---------------------------------------------------------------------------------------

/// Plain OpenCL, made without gnomon except for the choice of device.
class Embedder : public testing::Test {
protected:
    void SetUp() override {
        const Device any;
        device_ = any.description().device_id;
        cl_int code;
        context_ = clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &code);
        ASSERT_EQ(code, CL_SUCCESS);
        queue_ = clCreateCommandQueue(context_, device_, 0, &code);
        ASSERT_EQ(code, CL_SUCCESS);
    }
    void TearDown() override {
        for (cl_mem buffer : buffers_) {
            EXPECT_TRUE(is_let_go(buffer)) << "a buffer is still held: " << references(buffer);
            clReleaseMemObject(buffer);
        }
        clReleaseCommandQueue(queue_);
        clReleaseContext(context_);
    }

    template <typename T>
    cl_mem buffer(const std::vector<T>& content) {
        cl_int code;
        cl_mem made = clCreateBuffer(context_, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, content.size() * sizeof(T),
                                     const_cast<T*>(content.data()), &code);
        EXPECT_EQ(code, CL_SUCCESS);
        buffers_.push_back(made);
        return made;
    }
    static cl_uint references(cl_mem memory) {
        cl_uint count = 0;
        clGetMemObjectInfo(memory, CL_MEM_REFERENCE_COUNT, sizeof(count), &count, nullptr);
        return count;
    }
    /// True once only the test has a reference to it. A runtime may release a finished command's arguments on a thread
    /// of its own, after clFinish has returned (PoCL does).
    static bool is_let_go(cl_mem memory) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (references(memory) != 1 && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return references(memory) == 1;
    }
    Floats content(cl_mem memory, std::size_t count) const {
        Floats floats(count);
        EXPECT_EQ(
            clEnqueueReadBuffer(queue_, memory, CL_TRUE, 0, count * sizeof(float), floats.data(), 0, nullptr, nullptr),
            CL_SUCCESS);
        return floats;
    }

    cl_device_id device_ = nullptr;
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
    std::vector<cl_mem> buffers_;
};

TEST_F(Embedder, OwnContextQueueAndBuffersWithoutATripThroughTheHost) {
    const Device device(context_, queue_);
    EXPECT_EQ(device.context(), context_);
    EXPECT_EQ(device.queue(), queue_);
    Floats padded = {7, 7, 7, 7, 7};  // the triangles begin at float 5
    padded.insert(padded.end(), roof.begin(), roof.end());
    const cl_mem result = buffer(Floats(100, 42));
    const auto triangles = Triangles::wrap(device, buffer(padded), 2, 5);
    const auto points = Points::wrap(device, buffer(ground()), {}, 81);
    const Visibility visibility = Visibility::wrap(device, result, 81);
    EXPECT_EQ(visibility.buffer(), result);
    gnomon::make_technique("frustum-traced", device)->run(triangles, points, noon, visibility);
    Floats wanted = ground_truth();
    wanted.resize(100, 42);  // floats behind the last point do not change
    EXPECT_EQ(content(result, 100), wanted);
}

TEST_F(Embedder, PointsInEveryLayout) {
    const Device device(context_, queue_);
    const auto triangles = Triangles::upload(device, roof);
    const Floats packed = ground();
    struct Case {
        const char* name;
        gnomon::PointLayout layout;
    };
    for (const Case& c : {Case{"packed", {}}, Case{"four floats each", {0, 4, 1}},
                          Case{"structure of arrays", {0, 1, 81}}, Case{"structure of arrays, aligned", {16, 1, 96}},
                          Case{"members of a larger struct", {3, 8, 2}}, Case{"offset", {11, 3, 1}}}) {
        const gnomon::PointLayout& layout = c.layout;
        // Floats beside the coordinates are NaN: reading one would show.
        Floats floats(layout.first + 80 * layout.point_stride + 2 * layout.coordinate_stride + 1, not_a_number);
        for (std::size_t i = 0; i < 81; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                floats[layout.first + i * layout.point_stride + k * layout.coordinate_stride] = packed[3 * i + k];
        const auto points = Points::wrap(device, buffer(floats), layout, 81);
        EXPECT_EQ(trace(device, triangles, points), ground_truth()) << c.name;
        // With one float less, the last coordinate is outside.
        floats.pop_back();
        const cl_mem small = buffer(floats);
        EXPECT_TRUE(throws<gnomon::InvalidArgument>([&] { Points::wrap(device, small, layout, 81); },
                                                    {"point buffer holds", "fewer than"}))
            << c.name;
    }
}

TEST_F(Embedder, WrappedReceiversExcludeTheirTriangle) {
    const Device device(context_, queue_);
    const auto triangles = Triangles::upload(device, roof);
    std::vector<std::uint32_t> receivers(81, gnomon::no_receiver);
    receivers[40] = 0;  // the middle, on the diagonal that both triangles share: the other one still blocks
    receivers[31] = 0;  // (-0.5, 0): covered by triangle 1 alone
    receivers[49] = 0;  // (0.5, 0): covered by triangle 0 alone
    const auto points = Points::wrap(device, buffer(ground()), {}, 81, buffer(receivers));
    Floats wanted = ground_truth();
    wanted[49] = 1;
    EXPECT_EQ(trace(device, triangles, points), wanted);
}

// Every light's answers in one buffer of the caller's: a part of it each, as far apart as the device's alignment asks.
TEST_F(Embedder, VisibilityInAPartOfABuffer) {
    const Device device(context_, queue_);
    cl_uint align_bits = 0;
    clGetDeviceInfo(device_, CL_DEVICE_MEM_BASE_ADDR_ALIGN, sizeof(align_bits), &align_bits, nullptr);
    const std::size_t step = std::max<std::size_t>(align_bits / 8 / sizeof(float), 128);
    const cl_mem whole = buffer(Floats(3 * step, 42));
    const std::vector<Visibility> parts{Visibility::wrap(device, whole, 81, step),
                                        Visibility::wrap(device, whole, 81, 2 * step)};
    const auto triangles = Triangles::upload(device, roof);
    const auto points = Points::upload(device, ground());
    const std::vector<gnomon::Light> lights{noon, gnomon::Light::directional({0, 1, 0})};
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->run_each_light(triangles, points, lights, parts);
    Floats wanted(3 * step, 42);
    const Floats truth = ground_truth();
    std::copy(truth.begin(), truth.end(), wanted.begin() + std::ptrdiff_t(step));
    std::fill_n(wanted.begin() + std::ptrdiff_t(2 * step), 81, 1.0f);
    EXPECT_EQ(content(whole, 3 * step), wanted);
    EXPECT_EQ(parts[0].read(), truth);

    using gnomon::InvalidArgument;
    EXPECT_TRUE(
        throws<InvalidArgument>([&] { Visibility::wrap(device, whole, 81, 1); }, {"first float 1", "multiple of"}));
    EXPECT_TRUE(
        throws<InvalidArgument>([&] { Visibility::wrap(device, whole, step + 1, 2 * step); }, {"buffer holds"}));
    const std::vector<Visibility> meeting{Visibility::wrap(device, whole, 2 * step, 0), parts[0]};
    EXPECT_NO_THROW(technique->run_each_light(triangles, points, lights, meeting)) << "81 of the first are written";
    const auto many = Points::upload(device, Floats(3 * (step + 1)));
    const std::vector<Visibility> both{meeting[0], Visibility::wrap(device, whole, 2 * step, step)};
    EXPECT_TRUE(throws<InvalidArgument>([&] { technique->run_each_light(triangles, many, lights, both); },
                                        {"lights 0 and 1", "its own"}));
}

TEST_F(Embedder, BuffersThatAreNullOrTooSmall) {
    const Device device(context_, queue_);
    const cl_mem small = buffer(Floats(17));
    using gnomon::InvalidArgument;
    EXPECT_TRUE(throws<InvalidArgument>([&] { Triangles::wrap(device, nullptr, 1); }, {"triangle buffer", "null"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::wrap(device, nullptr, {}, 1); }, {"point buffer", "null"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Visibility::wrap(device, nullptr, 1); }, {"visibility buffer", "null"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Triangles::wrap(device, small, 2); },
                                        {"triangle buffer holds 68 bytes", "the 72 its"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Triangles::wrap(device, small, 1, 9); }, {"triangle buffer"}));
    EXPECT_TRUE(throws<InvalidArgument>(
        [&] { Triangles::wrap(device, small, 1, std::numeric_limits<std::size_t>::max() - 4); }, {"triangle buffer"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::wrap(device, small, {}, 6); }, {"point buffer"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::wrap(device, small, {1ull << 32, 3, 1}, 1); }, {"32 bits"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::wrap(device, small, {}, 1ull << 32); }, {"too many"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Triangles::wrap(device, small, 1ull << 32); }, {"too many"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::wrap(device, small, {}, 5, buffer(std::vector<cl_uint>(4))); },
                                        {"receiver buffer"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Visibility::wrap(device, small, 18); }, {"visibility buffer"}));
    EXPECT_NO_THROW(Visibility::wrap(device, small, 17));
    EXPECT_NO_THROW(Points::wrap(device, small, {}, 5));
    EXPECT_NO_THROW(Triangles::wrap(device, small, 1, 8));
}

TEST_F(Embedder, ContextAndQueueMustBeThereAndInOrder) {
    using gnomon::InvalidArgument;
    EXPECT_TRUE(throws<InvalidArgument>([&] { Device(nullptr, queue_); }, {"context and queue", "null"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Device(context_, nullptr); }, {"context and queue", "null"}));
    cl_int code;
    cl_context other = clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &code);
    ASSERT_EQ(code, CL_SUCCESS);
    EXPECT_TRUE(throws<InvalidArgument>([&] { Device(other, queue_); }, {"queue", "another OpenCL context"}));
    clReleaseContext(other);
    cl_command_queue unordered = clCreateCommandQueue(context_, device_, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, &code);
    if (code != CL_SUCCESS) GTEST_SKIP() << "NOT TESTED: this device has no out-of-order queues";
    EXPECT_TRUE(throws<InvalidArgument>([&] { Device(context_, unordered); }, {"out of order", "in-order"}));
    clReleaseCommandQueue(unordered);
}

TEST_F(Embedder, ObjectsOutliveTheHandlesTheyWereMadeFrom) {
    std::optional<Triangles> triangles;
    std::optional<Points> points;
    std::optional<Visibility> visibility;
    std::unique_ptr<gnomon::Technique> technique;
    {
        const Device device(context_, queue_);
        triangles = Triangles::upload(device, roof);
        points = Points::upload(device, ground());
        visibility.emplace(device, 81);
        technique = gnomon::make_technique("frustum-traced", device);
    }
    technique->run(*triangles, *points, noon, *visibility);
    EXPECT_EQ(visibility->read(), ground_truth());
}

TEST_F(Embedder, DeviceTimesComeFromTheCallersProfilingQueue) {
    cl_int code;
    cl_command_queue profiling = clCreateCommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE, &code);
    ASSERT_EQ(code, CL_SUCCESS);
    for (const bool profiles : {false, true}) {
        const Device device(context_, profiles ? profiling : queue_);
        const auto triangles = Triangles::upload(device, roof);
        const auto points = Points::upload(device, ground());
        const Visibility visibility(device, 81);
        double device_ms = 0;
        for (const auto& stage :
             gnomon::make_technique("frustum-traced", device)->run(triangles, points, noon, visibility).stages)
            device_ms += stage.device_ms;
        EXPECT_EQ(device_ms > 0, profiles);
    }
    clReleaseCommandQueue(profiling);
}

// ---- Arguments ------------------------------------------------------------------------------------------------------

// Where device and host share memory, a run neither writes nor reads as many bytes as the arrays have. The memory is
// aligned as drivers want it, and once as no driver does.
TEST(SharedMemory, IsUsedInPlaceWhereThereIsSome) {
    const Floats scene = support::soup(3000, 0.3f, 5), places = support::random_points(5000, -1, 1, 6);
    const gnomon::Light light = gnomon::Light::directional({0.2f, -1, 0.1f});
    const Device plain;
    Visibility copied(plain, 5000);
    gnomon::make_technique("frustum-traced", plain)
        ->run(Triangles::upload(plain, scene), Points::upload(plain, places), light, copied);
    const Floats wanted = copied.read();
    for (const std::size_t first : {0, 1}) {
        const auto aligned = [&](const Floats& from) {
            const std::size_t bytes = (from.size() * sizeof(float) / 4096 + 2) * 4096;
            std::unique_ptr<float, decltype(&std::free)> memory(static_cast<float*>(std::aligned_alloc(4096, bytes)),
                                                                &std::free);
            std::copy(from.begin(), from.end(), memory.get() + first);
            return memory;
        };
        const auto triangles = aligned(scene), points = aligned(places), values = aligned(Floats(5000, 42));
        const Environment trace("GNOMON_TRACE", "1");
        testing::internal::CaptureStderr();
        bool is_shared = false;
        {
            const Device device;
            is_shared = device.description().shares_host_memory;
            const auto visibility = Visibility::share(device, {values.get() + first, 5000});
            const auto technique = gnomon::make_technique("frustum-traced", device);
            technique->run(Triangles::share(device, {triangles.get() + first, scene.size()}),
                           Points::share(device, {points.get() + first, places.size()}), light, visibility);
            visibility.fetch();
        }
        const std::string traced = testing::internal::GetCapturedStderr();
        EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), values.get() + first));
        for (const std::size_t bytes : {scene.size() * 4, places.size() * 4, wanted.size() * 4})
            EXPECT_EQ(traced.find("ing " + std::to_string(bytes) + " bytes") == std::string::npos, is_shared) << bytes;
    }
    EXPECT_THROW(copied.fetch(), gnomon::InvalidArgument);
    EXPECT_THROW(Triangles::share(plain, Floats(8)), gnomon::InvalidArgument);
    EXPECT_THROW(Points::share(plain, Floats(4)), gnomon::InvalidArgument);
}

TEST(Arguments, SizesThatDoNotMatch) {
    const Device device;
    using gnomon::InvalidArgument;
    EXPECT_TRUE(throws<InvalidArgument>([&] { Triangles::upload(device, Floats(10)); }, {"9 floats", "10"}));
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::upload(device, Floats(4)); }, {"3 floats", "4"}));
    const std::vector<std::uint32_t> two = {0, 0};
    EXPECT_TRUE(throws<InvalidArgument>([&] { Points::upload(device, Floats(9), two); },
                                        {"2 receivers for 3 points", "none at all"}));
    const auto triangles = Triangles::upload(device, roof);
    const auto points = Points::upload(device, ground());
    const Visibility visibility(device, 80);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    EXPECT_TRUE(
        throws<InvalidArgument>([&] { technique->run(triangles, points, noon, visibility); }, {"80 of 81 points"}));
}

TEST(Arguments, LightsThatAreNone) {
    using gnomon::InvalidArgument;
    using gnomon::Light;
    EXPECT_TRUE(throws<InvalidArgument>([] { Light::directional({0, -0.0f, 0}); }, {"direction", "0,0,0"}));
    EXPECT_TRUE(throws<InvalidArgument>([] { Light::directional({0, not_a_number, 1}); }, {"direction", "finite"}));
    EXPECT_TRUE(throws<InvalidArgument>([] { Light::directional({0, 0, -infinity}); }, {"direction", "finite"}));
    EXPECT_TRUE(throws<InvalidArgument>([] { Light::point({infinity, 0, 0}); }, {"position", "finite"}));
    EXPECT_TRUE(throws<InvalidArgument>([] { Light::point({0, 0, not_a_number}); }, {"position", "finite"}));
    EXPECT_EQ(Light::directional({1, -2, 3}).xyzw, (std::array<float, 4>{-1, 2, -3, 0}));
    EXPECT_EQ(Light::point({1, -2, 3}).xyzw, (std::array<float, 4>{1, -2, 3, 1}));
    EXPECT_TRUE(Light::directional({1e-45f, 0, 0}).is_directional());
}

// xyzw is public: run() must refuse the same lights as the makers.
TEST(Arguments, LightsMadeByHand) {
    const Device device;
    const auto triangles = Triangles::upload(device, roof);
    const auto points = Points::upload(device, ground());
    const Visibility visibility(device, 81);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    for (const auto& xyzw :
         {std::array<float, 4>{0, 0, 0, 0}, {not_a_number, 0, 1, 0}, {0, infinity, 0, 1}, {0, 1, 0, 2}})
        EXPECT_TRUE(throws<gnomon::InvalidArgument>(
            [&] { technique->run(triangles, points, gnomon::Light{xyzw}, visibility); }, {"light"}));
}

TEST(Arguments, TechniquesAndTheirSettings) {
    using gnomon::InvalidArgument;
    const Device device;
    const auto all = gnomon::techniques();
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all[0].name, "frustum-traced");
    EXPECT_TRUE(all[0].exact);
    EXPECT_FALSE(all[0].summary.empty());
    for (const auto& description : all) {
        const auto technique = gnomon::make_technique(description.name, device);
        for (const auto& setting : description.settings) {
            EXPECT_NO_THROW(technique->set(setting.name, setting.default_value)) << setting.name;
            EXPECT_FALSE(setting.meaning.empty());
            EXPECT_TRUE(
                throws<InvalidArgument>([&] { technique->set(setting.name, "nonsense"); }, {setting.name, "nonsense"}));
            EXPECT_TRUE(throws<InvalidArgument>([&] { technique->set(setting.name, ""); }, {setting.name}));
        }
        EXPECT_TRUE(throws<InvalidArgument>([&] { technique->set("colour", "red"); }, {"colour", description.name}));
    }
    EXPECT_TRUE(
        throws<InvalidArgument>([&] { gnomon::make_technique("fristum", device); }, {"\"fristum\"", "frustum-traced"}));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    for (const char* size : {"15", "8193", "-64", "64x", " 64", "64.0", "99999999999"})
        EXPECT_TRUE(throws<InvalidArgument>([&] { technique->set("map-size", size); }, {"16 to 8192", size}));
    for (const char* size : {"16", "8192", "auto", "100"}) EXPECT_NO_THROW(technique->set("map-size", size));
    EXPECT_TRUE(throws<InvalidArgument>([&] { technique->set("first-capacity", "0"); }, {"from 1"}));
}

TEST(Arguments, ViewsWithoutPixelsOrWithTooMany) {
    using gnomon::InvalidArgument;
    const Device device;
    const auto triangles = Triangles::upload(device, roof);
    const auto camera = gnomon::Camera::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 50);
    for (const auto& [width, height] : {std::pair{0u, 10u}, {10u, 0u}, {16385u, 1u}, {1u, 16385u}})
        EXPECT_TRUE(throws<InvalidArgument>([&, w = width, h = height] { look(device, triangles, camera, w, h); },
                                            {std::to_string(width) + "x" + std::to_string(height), "16384"}));
    const auto look_at = [](gnomon::Float3 eye, gnomon::Float3 target, gnomon::Float3 up, double fov) {
        return [=] { gnomon::Camera::look_at(eye, target, up, fov); };
    };
    EXPECT_TRUE(throws<InvalidArgument>(look_at({1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 50), {"eye", "target"}));
    EXPECT_TRUE(throws<InvalidArgument>(look_at({0, 0, 0}, {0, 2, 0}, {0, 1, 0}, 50), {"up"}));
    EXPECT_TRUE(throws<InvalidArgument>(look_at({0, 0, 0}, {0, 2, 0}, {1, not_a_number, 0}, 50), {"up"}));
    for (const double fov : {0.0, 180.0, -1.0, double(not_a_number)})
        EXPECT_TRUE(throws<InvalidArgument>(look_at({0, 0, 0}, {0, 2, 0}, {1, 0, 0}, fov), {"180"}));
}

TEST(Arguments, PicturesOfWhatDoesNotFitTogether) {
    using gnomon::InvalidArgument;
    const Device device;
    const auto triangles = Triangles::upload(device, roof);
    const auto camera = gnomon::Camera::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 50);
    const gnomon::View view = look(device, triangles, camera, 8, 8);
    const Visibility visibility(device, 64), too_short(device, 63);
    gnomon::make_technique("frustum-traced", device)->run(triangles, view.points, noon, visibility);
    const gnomon::Materials good{{0, 0}, {{1, 1, 1}}};
    EXPECT_EQ(shade(device, triangles, view, visibility, good, noon).size(), 8u * 8 * 4);
    EXPECT_TRUE(throws<InvalidArgument>([&] { shade(device, triangles, view, too_short, good, noon); }, {"fewer"}));
    EXPECT_TRUE(throws<InvalidArgument>(
        [&] {
            shade(device, triangles, view, visibility, {{0}, {{1, 1, 1}}}, noon);
        },
        {"1 material ids for 2 triangles"}));
    EXPECT_TRUE(throws<InvalidArgument>(
        [&] {
            shade(device, triangles, view, visibility, {{0, 1}, {{1, 1, 1}}}, noon);
        },
        {"material 1 of 1"}));
}

// ---- Devices --------------------------------------------------------------------------------------------------------

// ---- Several lights -------------------------------------------------------------------------------------------------

TEST(Lights, RunTogetherGiveWhatEachGivesAlone) {
    const Device device;
    const Floats soup = support::soup(200, 0.5f, 3), places = support::random_points(500, -2, 2, 4);
    const auto triangles = Triangles::upload(device, soup);
    const auto points = Points::upload(device, places);
    const std::vector<gnomon::Light> lights{noon, gnomon::Light::point({0.1f, 3, 0.2f}),
                                            gnomon::Light::directional({1, -1, 0.5f})};
    for (const char* name : {"frustum-traced", "virtual-shadow-map", "shadow-map"}) {
        SCOPED_TRACE(name);
        const auto technique = gnomon::make_technique(name, device);
        std::vector<Visibility> together;
        for (std::size_t i = 0; i < lights.size(); ++i) together.emplace_back(device, points.count());
        const auto statistics = technique->run_each_light(triangles, points, lights, together);
        ASSERT_EQ(statistics.size(), lights.size());
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const Visibility alone(device, points.count());
            gnomon::make_technique(name, device)->run(triangles, points, lights[i], alone);
            EXPECT_EQ(together[i].read(), alone.read()) << "light " << i;
            EXPECT_EQ(statistics[i].count("points"), points.count());
        }
        EXPECT_NE(together[0].read(), together[1].read());
        EXPECT_TRUE(technique->run_each_light(triangles, points, {}, {}).empty());
        EXPECT_TRUE(throws<gnomon::InvalidArgument>(
            [&] { technique->run_each_light(triangles, points, lights, std::span(together).first(2)); },
            {"3 lights", "2 visibilities"}));
        together[2] = together[0];
        EXPECT_TRUE(throws<gnomon::InvalidArgument>(
            [&] { technique->run_each_light(triangles, points, lights, together); }, {"lights 0 and 2", "its own"}));
    }
}

TEST(Lights, PicturesAddUpTheirLambertTerms) {
    const Device device;
    const auto triangles = Triangles::upload(device, roof);
    const auto view =
        gnomon::look(device, triangles, gnomon::Camera::look_at({0, 5, 3}, {0, 2, 0}, {0, 1, 0}, 40), 32, 24);
    const gnomon::Materials grey{{0, 0}, {{0.3f, 0.2f, 0.1f}}};
    const std::vector<gnomon::Light> lights{noon, gnomon::Light::directional({0, -1, -1})};
    const Visibility lit(device, view.points.count()), dark(device, view.points.count());
    for (const auto& [visibility, value] : {std::pair{&lit, 1.0f}, std::pair{&dark, 0.0f}})
        ASSERT_EQ(clEnqueueFillBuffer(device.queue(), visibility->buffer(), &value, sizeof(value), 0,
                                      view.points.count() * sizeof(value), 0, nullptr, nullptr),
                  CL_SUCCESS);
    const auto shaded = [&](const Visibility& first, const Visibility& second) {
        const std::vector<Visibility> both{first, second};
        return gnomon::shade(device, triangles, view, both, grey, lights);
    };
    const auto none = shaded(dark, dark), first = shaded(lit, dark), second = shaded(dark, lit),
               both = shaded(lit, lit);
    EXPECT_EQ(first, gnomon::shade(device, triangles, view, lit, grey, lights[0]));
    EXPECT_EQ(second, gnomon::shade(device, triangles, view, lit, grey, lights[1]));
    EXPECT_NE(first, second);
    std::size_t brighter = 0;
    for (std::size_t i = 0; i < both.size(); ++i) {
        if (i % 4 == 3) continue;
        // Each of the four bytes is off by half a step, which is at most 0.0045 of linear light here.
        EXPECT_NEAR(support::linear_of_srgb(both[i]) + support::linear_of_srgb(none[i]),
                    support::linear_of_srgb(first[i]) + support::linear_of_srgb(second[i]), 0.01);
        brighter += support::linear_of_srgb(both[i]) > support::linear_of_srgb(first[i]) + 0.02;
    }
    EXPECT_GT(brighter, 100u);
    EXPECT_TRUE(throws<gnomon::InvalidArgument>(
        [&] { gnomon::shade(device, triangles, view, std::span(&lit, 1), grey, lights); },
        {"1 visibilities", "2 lights"}));
}

TEST(Devices, ChosenByIndexByNameByEnvironment) {
    const Environment none("GNOMON_DEVICE", "");
    const auto all = gnomon::devices();
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const auto& d) { return d.is_default; }), 1);
    for (const auto& description : all) {
        if (!description.lacks.empty()) continue;
        EXPECT_EQ(Device(description.selector).description().device_id, description.device_id);
        if (description.is_default) {
            EXPECT_EQ(Device().description().device_id, description.device_id);
            EXPECT_FALSE(description.why_default.empty());
        }
        // The first word of its name in the wrong case finds a device of that name.
        std::string part = description.name.substr(0, 6);
        for (char& c : part) c = static_cast<char>(std::isupper(c) ? std::tolower(c) : std::toupper(c));
        EXPECT_EQ(Device(part).description().name.substr(0, 6), description.name.substr(0, 6));
        EXPECT_EQ(Device(description.platform).description().platform, description.platform);
        const Environment chosen("GNOMON_DEVICE", description.selector);
        EXPECT_EQ(Device().description().device_id, description.device_id);
    }
    EXPECT_TRUE(throws<gnomon::DeviceNotFound>([] { Device("9:9"); }, {"\"9:9\"", "--device", all[0].name}));
    EXPECT_TRUE(throws<gnomon::DeviceNotFound>([] { Device("abacus"); }, {"\"abacus\"", all[0].selector}));
    const Environment unknown("GNOMON_DEVICE", "astrolabe");
    EXPECT_TRUE(throws<gnomon::DeviceNotFound>([] { Device device; }, {"\"astrolabe\"", "GNOMON_DEVICE"}));
    EXPECT_EQ(Device(all[0].selector).description().device_id, all[0].device_id) << "an argument goes first";
}

// A layer cuts the list, as Khronos' loader does (tests/drivers/drivers.cmake).
TEST(Devices, AListOfDriversStaysWhole) {
    const Environment list("OCL_ICD_FILENAMES", "libnot-there.so:libneither.so");
    (void)gnomon::devices();
    EXPECT_STREQ(std::getenv("OCL_ICD_FILENAMES"), "libnot-there.so:libneither.so");
}

TEST(Devices, NeitherCameraNorShadowsNeedDoublePrecision) {
    DeviceOptions options;
    options.hide_fp64 = true;
    const Device device({}, options);
    const auto triangles = Triangles::upload(device, roof);
    const auto camera = gnomon::Camera::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 50);
    const Device full;
    EXPECT_EQ(
        look(device, triangles, camera, 8, 8).read(device, triangles).position,
        look(full, Triangles::upload(full, roof), camera, 8, 8).read(full, Triangles::upload(full, roof)).position);
    EXPECT_EQ(trace(device, triangles, Points::upload(device, ground())), ground_truth());
}

/// The visibility of these points, and of the same points as a list without a picture.
std::pair<std::vector<float>, std::vector<float>> with_and_without_picture(const Device& device,
                                                                           const Triangles& triangles,
                                                                           const Points& points,
                                                                           gnomon::Technique& technique) {
    const auto positions = static_cast<cl_mem>(points.positions());
    const Points list = Points::wrap(device, positions, points.layout(), points.count(), points.receivers());
    const Visibility picture(device, points.count()), plain(device, points.count());
    const gnomon::Light slanted = gnomon::Light::directional({0.3f, -1, 0.2f});
    technique.run(triangles, points, slanted, picture);
    technique.run(triangles, list, slanted, plain, {.facing = gnomon::Facing::eye(points.camera()->camera.eye)});
    return {picture.read(), plain.read()};
}

// A CPU takes a picture's points in blocks of 4 x 4 pixels if its sides allow it. Not vacuous: every picture has points
// in light and in shadow, and the soup's triangles are smaller than a block.
TEST(Pictures, HaveTheAnswersOfTheirPointsInAnyOrderOfWork) {
    const Device device;
    const auto triangles = Triangles::upload(device, support::soup(2000, 0.3f, 7));
    const gnomon::Camera camera = gnomon::Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 50);
    for (const std::string name : {"frustum-traced", "izb", "sub-pixel"}) {
        const auto technique = gnomon::make_technique(name, device);
        for (const auto& [width, height] : std::vector<std::pair<int, int>>{{64, 48}, {44, 36}, {61, 48}, {64, 47}}) {
            SCOPED_TRACE(name + " " + std::to_string(width) + "x" + std::to_string(height));
            const gnomon::View view =
                gnomon::look(device, triangles, camera, std::uint32_t(width), std::uint32_t(height));
            const auto [picture, plain] = with_and_without_picture(device, triangles, view.points, *technique);
            EXPECT_EQ(picture, plain);
            EXPECT_GT(std::count(plain.begin(), plain.end(), 0.0f), 100);
            EXPECT_GT(std::count(plain.begin(), plain.end(), 1.0f), 100);
        }
    }
}

TEST(Devices, SeveralDevicesAndTechniquesAliveAtOnce) {
    DeviceOptions groups_of_three;
    groups_of_three.work_group_size = 3;
    const Device first, second({}, groups_of_three);
    const auto triangles_1 = Triangles::upload(first, roof), triangles_2 = Triangles::upload(second, roof);
    const auto points_1 = Points::upload(first, ground()), points_2 = Points::upload(second, ground());
    const Visibility visibility_1(first, 81), visibility_2(second, 81), visibility_3(first, 81);
    const auto technique_1 = gnomon::make_technique("frustum-traced", first),
               technique_2 = gnomon::make_technique("frustum-traced", second),
               technique_3 = gnomon::make_technique("frustum-traced", first);
    technique_3->set("map-size", "64");
    technique_3->set("conservative-map", "on");
    for (int i = 0; i < 3; ++i) {
        technique_1->run(triangles_1, points_1, noon, visibility_1);
        technique_2->run(triangles_2, points_2, noon, visibility_2);
        technique_3->run(triangles_1, points_1, noon, visibility_3);
    }
    EXPECT_EQ(visibility_1.read(), ground_truth());
    EXPECT_EQ(visibility_2.read(), ground_truth());
    EXPECT_EQ(visibility_3.read(), ground_truth());
}

// ---- One technique, many scenes -------------------------------------------------------------------------------------

TEST(Reuse, ScenesOfEverySizeInAnyOrderGiveWhatAFreshObjectGives) {
    const Device device;
    const auto reused = gnomon::make_technique("frustum-traced", device);
    reused->set("first-capacity", "2");
    for (const std::size_t size : {3u, 400u, 0u, 1u, 2000u, 5u, 2000u})
        for (const std::size_t count : {1u, 5000u, 0u, 100u}) {
            const auto triangles = Triangles::upload(device, support::soup(size, 0.3f, size));
            const auto points = Points::upload(device, support::random_points(count, -1, 1, count));
            for (const gnomon::Light& light : {noon, gnomon::Light::point({0, 2, 0})}) {
                const Visibility visibility(device, count), fresh(device, count);
                reused->run(triangles, points, light, visibility);
                gnomon::make_technique("frustum-traced", device)->run(triangles, points, light, fresh);
                EXPECT_EQ(visibility.read(), fresh.read()) << size << " triangles, " << count << " points";
            }
        }
}

// ---- Memory ---------------------------------------------------------------------------------------------------------

TEST(Memory, WhatWasTakenIsGivenBack) {
    const Device device;
    EXPECT_EQ(device.memory_bytes(), 0u);
    {
        const auto triangles = Triangles::upload(device, roof);
        EXPECT_EQ(device.memory_bytes(), roof.size() * sizeof(float));
        const auto points = Points::upload(device, ground());
        EXPECT_EQ(trace(device, triangles, points), ground_truth());
        const auto camera = gnomon::Camera::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 50);
        const std::uint64_t before = device.memory_bytes();
        std::optional<gnomon::View> view = look(device, triangles, camera, 16, 16);
        EXPECT_EQ(device.memory_bytes(), before + 16 * 16 * 16) << "12 bytes of position, 4 of receiver";
        std::optional<Points> lifted = lift(device, triangles, view->points, camera.eye);
        EXPECT_EQ(device.memory_bytes(), before + 16 * 16 * (16 + 12));
        view.reset();
        EXPECT_EQ(device.memory_bytes(), before + 16 * 16 * 16) << "the lifted points hold the receivers";
        lifted.reset();
        EXPECT_EQ(device.memory_bytes(), before);
        const std::uint64_t peak = device.peak_memory_bytes();
        const auto few = Points::upload(device, {});
        EXPECT_TRUE(trace(device, triangles, few).empty());
        EXPECT_GE(device.peak_memory_bytes(), peak) << "the most ever held, not the most of the last run";
    }
    EXPECT_EQ(device.memory_bytes(), 0u);
}

// The limit is raised step by step. If a run ends for want of memory, the error is clear, no memory is lost, and the
// same objects work as soon as there is enough. The needed memory differs from run to run: a list that was too small
// grows by the counted entries, and their number depends on how the threads divided the work (2 % were seen). Twice as
// much is enough.
TEST(Memory, ALimitGivesAClearErrorAndLeavesTheObjectsUsable) {
    const Floats scene = support::soup(2000, 0.3f, 5), places = support::random_points(6000, -1, 1, 6);
    const gnomon::Light point_light = gnomon::Light::point({0.1f, 1.5f, 0.2f});
    const auto technique_with_map = [](const Device& device) {
        auto technique = gnomon::make_technique("frustum-traced", device);
        technique->set("map-size", "1024");
        technique->set("conservative-map", "on");
        technique->set("first-capacity", "1000");  // so that the memory is not one single list
        return technique;
    };
    Floats wanted;
    std::uint64_t needed = 0;
    {
        const Device plenty;
        const auto triangles = Triangles::upload(plenty, scene);
        const auto points = Points::upload(plenty, places);
        const Visibility visibility(plenty, points.count());
        technique_with_map(plenty)->run(triangles, points, point_light, visibility);
        needed = plenty.peak_memory_bytes();
        wanted = visibility.read();
    }
    int failures = 0, successes = 0;
    for (int step = 1; step <= 12; ++step) {
        const std::uint64_t limit = step == 12 ? 2 * needed : step * needed / 12;
        DeviceOptions options;
        options.memory_limit_bytes = limit;
        const Device device({}, options);
        try {
            const auto triangles = Triangles::upload(device, scene);
            const auto points = Points::upload(device, places);
            const Visibility visibility(device, points.count());
            const std::uint64_t before = device.memory_bytes();
            {
                const auto technique = technique_with_map(device);
                bool has_failed = false;
                try {
                    technique->run(triangles, points, point_light, visibility);
                } catch (const gnomon::OutOfDeviceMemory& error) {
                    has_failed = true;
                    EXPECT_NE(std::string(error.what()).find("limit of " + std::to_string(limit)), std::string::npos)
                        << error.what();
                    EXPECT_EQ(error.code(), CL_MEM_OBJECT_ALLOCATION_FAILURE);
                }
                EXPECT_LE(device.peak_memory_bytes(), limit);
                // A smaller run with the same object, after the failure.
                technique->set("map-size", "16");
                technique->set("first-capacity", "16");
                const auto small = Triangles::upload(device, roof);
                const auto few = Points::upload(device, ground());
                const Visibility small_visibility(device, 81);
                try {
                    technique->run(small, few, noon, small_visibility);
                    EXPECT_EQ(small_visibility.read(), ground_truth());
                } catch (const gnomon::OutOfDeviceMemory&) {
                }
                if (!has_failed) {
                    ++successes;
                    EXPECT_EQ(visibility.read(), wanted);
                }
                failures += has_failed;
            }
            EXPECT_EQ(device.memory_bytes(), before) << "a leak";
        } catch (const gnomon::OutOfDeviceMemory&) {
            ++failures;  // the inputs themselves did not fit
        }
        EXPECT_EQ(device.memory_bytes(), 0u) << "a leak at " << limit;
    }
    EXPECT_GT(failures, 5);
    EXPECT_GT(successes, 0);
}

TEST(Memory, AllocationsBeyondTheDeviceAreRefusedBeforeTheyAreTried) {
    const Device device;
    const std::uint64_t largest = device.description().largest_allocation_bytes;
    EXPECT_TRUE(throws<gnomon::OutOfDeviceMemory>([&] { Visibility(device, std::size_t(largest)); },
                                                  {"largest allocation of " + std::to_string(largest)}));
    EXPECT_EQ(device.memory_bytes(), 0u);
}

// ---- Kernels from elsewhere -----------------------------------------------------------------------------------------

/// A copy of kernels/ to be broken.
class OnDiskKernels : public testing::Test {
protected:
    void SetUp() override { std::filesystem::copy(GNOMON_KERNELS, folder_, std::filesystem::copy_options::recursive); }
    static void run_something() {
        const Device device;
        EXPECT_EQ(trace(device, Triangles::upload(device, roof), Points::upload(device, ground())), ground_truth());
    }

    const support::TemporaryFolder made_;
    const std::filesystem::path folder_ = made_.path();
};

TEST_F(OnDiskKernels, AFolderOfTheSameKernelsWorks) {
    const Environment kernels("GNOMON_KERNELS_DIR", folder_.string());
    run_something();
}

TEST_F(OnDiskKernels, CompileErrorsNameTheTrueFileAndLine) {
    const Environment kernels("GNOMON_KERNELS_DIR", folder_.string());
    for (const std::string broken : {"trace/trace.cl", "simd/points.h", "exact/det3.clh"}) {
        std::ifstream original(folder_ / broken, std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(original), {}};
        const auto line = std::to_string(std::count(text.begin(), text.end(), '\n') + 1);
        std::ofstream(folder_ / broken, std::ios::app) << "this is no_kernel_code;\n";
        try {
            run_something();
            ADD_FAILURE() << broken << " was compiled";
        } catch (const gnomon::OpenClError& error) {
            EXPECT_EQ(error.code(), CL_BUILD_PROGRAM_FAILURE);
            EXPECT_NE(error.build_log().find("kernels/" + broken + ":" + line), std::string::npos) << error.build_log();
            EXPECT_NE(std::string(error.what()).find(error.build_log()), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("compiling kernels/"), std::string::npos) << error.what();
        }
        std::ofstream(folder_ / broken, std::ios::binary) << text;
        run_something();  // and the repaired kernel is compiled again
    }
}

// NVIDIA's compiler counts the lines of the whole text.
TEST(SourceLocations, OfCompilersThatIgnoreLineDirectives) {
    const std::string source =
        "#line 1 \"kernels/a.cl\"\n"
        "first of a\n"
        "#line 1 \"kernels/b.h\"\n"
        "first of b\n"
        "second of b\n"
        "#line 3 \"kernels/a.cl\"\n"
        "third of a\n";
    const auto place = [&](const std::string& log) { return gnomon::cl::with_source_locations(log, source); };
    EXPECT_EQ(place("<kernel>:2:7: error"), "kernels/a.cl:1:7: error");
    EXPECT_EQ(place("<kernel>:4:1: error"), "kernels/b.h:1:1: error");
    EXPECT_EQ(place("x <kernel>:5:9 y\n<kernel>:7:2 z"), "x kernels/b.h:2:9 y\nkernels/a.cl:3:2 z");
    // A name without a source location stays unchanged.
    for (const std::string log : {"", "kernels/b.h:2:9: error", "<kernel>:", "<kernel>:0:1", "<kernel>: 5"})
        EXPECT_EQ(place(log), log);
    EXPECT_EQ(gnomon::cl::with_source_locations("<kernel>:1:1", "no directive"), "<kernel>:1:1");
}

TEST_F(OnDiskKernels, AMissingFileIsNamed) {
    const Environment kernels("GNOMON_KERNELS_DIR", folder_.string());
    std::filesystem::remove(folder_ / "trace/trace.cl");
    EXPECT_TRUE(throws<gnomon::Error>(run_something, {"trace/trace.cl", folder_.string()}));
}

TEST_F(OnDiskKernels, AChangedKernelIsTheOneThatRuns) {
    // Proof that the folder is read: without the trace's decision, no point is in shadow.
    const Environment kernels("GNOMON_KERNELS_DIR", folder_.string());
    std::ofstream(folder_ / "receivers/facing.h", std::ios::app) << "#error changed on purpose\n";
    EXPECT_TRUE(throws<gnomon::OpenClError>(run_something, {"changed on purpose"}));
}

// PoCL 3.0 on Zen 5: docs/drivers.md.
TEST_F(OnDiskKernels, ACompilerThatDoesNotKnowTheCpuIsSaidToBeOld) {
    const Environment kernels("GNOMON_KERNELS_DIR", folder_.string());
    std::ofstream(folder_ / "receivers/facing.h", std::ios::app) << "#error unknown target CPU 'generic'\n";
    EXPECT_TRUE(throws<gnomon::OpenClError>(run_something, {"older than the CPU", "newer driver"}));
}

// Without triangles only one kernel has to be compiled.
void compile_something() {
    const Device device;
    trace(device, Triangles::upload(device, {}), Points::upload(device, ground()));
}

// PoCL builds kernels at their first launch and keeps them. It builds all kernels of a program once more before it
// gives the program's binary, so that a first start takes two to three times as long. Asked three times, since time
// tells.
TEST(KernelCache, HoldsNoBinariesOfADriverThatKeepsItsOwn) {
    if (Device().description().platform != "Portable Computing Language") GTEST_SKIP() << "for PoCL";
    for (int i = 0; i < 3; ++i) {
        const support::TemporaryFolder made;
        const Environment cache("GNOMON_CACHE_DIR", made.path().string());
        compile_something();
        for (const auto& entry : std::filesystem::directory_iterator(made.path()))
            EXPECT_TRUE(entry.path().filename().string().starts_with("keeps-binaries-")) << entry.path();
    }
}

TEST(BuildOptions, ThatWouldRelaxTheArithmeticAreRefused) {
    // Without their prefix: tools/check_layout.sh bans the full words from every file, this one included.
    for (const std::string option : {"fast-relaxed-math", "unsafe-math-optimizations", "finite-math-only",
                                     "no-signed-zeros", "mad-enable", "denorms-are-zero"}) {
        const Environment options("GNOMON_BUILD_OPTIONS", "-DHARMLESS -cl-" + option);
        EXPECT_TRUE(throws<gnomon::InvalidArgument>(compile_something,
                                                    {"GNOMON_BUILD_OPTIONS", option.substr(0, 11), "remove"}));
    }
    const Environment options("GNOMON_BUILD_OPTIONS", "-DHARMLESS=1");
    EXPECT_NO_THROW(compile_something());
}

TEST(BuildOptions, ThatTheCompilerRefusesAreNamed) {
    const Environment options("GNOMON_BUILD_OPTIONS", "--no-such-option");
    EXPECT_TRUE(throws<gnomon::OpenClError>(compile_something,
                                            {"compiling kernels/", "without GNOMON_BUILD_OPTIONS (--no-such-option)"}));
}

// ---- Statistics -----------------------------------------------------------------------------------------------------

TEST(Statistics, CountEveryPointOnce) {
    DeviceOptions options;
    options.profile = true;
    const Device device({}, options);
    Floats scene = support::soup(300, 0.4f, 1), places = support::random_points(6000, -1, 1, 2);
    support::append(scene, support::lattice_blocks(10, 3, 3));
    support::append(places, support::lattice_points(500, 3, 4));
    scene[9 * 7] = not_a_number;
    std::vector<std::uint32_t> receivers(places.size() / 3, gnomon::no_receiver);
    for (std::size_t i = 0; i < receivers.size(); i += 3) receivers[i] = static_cast<std::uint32_t>(i % 420);
    for (std::size_t i = 0; i < places.size(); i += 300) places[i] = infinity;
    const auto triangles = Triangles::upload(device, scene);
    const Points points = Points::upload(device, places, receivers);
    const gnomon::RunOptions options_of_run{.facing = gnomon::Facing::eye({0.3f, 5, 0.4f})};
    for (const gnomon::Light& light : {noon, gnomon::Light::point({0.2f, 0.3f, 0.1f})})
        for (const char* map : {"on", "off"})
            for (const char* capacity : {"262144", "1"}) {
                const auto technique = gnomon::make_technique("frustum-traced", device);
                technique->set("conservative-map", map);
                technique->set("first-capacity", capacity);
                const Visibility visibility(device, points.count());
                const gnomon::Statistics s = technique->run(triangles, points, light, visibility, options_of_run);
                const Floats values = visibility.read();
                const auto in_shadow = std::uint64_t(std::count(values.begin(), values.end(), 0.0f));
                const std::string what = std::string(map) + " " + capacity;
                EXPECT_EQ(in_shadow + std::uint64_t(std::count(values.begin(), values.end(), 1.0f)), values.size());
                EXPECT_EQ(s.count("points"), values.size()) << what;
                EXPECT_EQ(s.count("points_absent"), 65u) << what;
                EXPECT_EQ(s.count("points_in_shadow"), in_shadow) << what;
                EXPECT_EQ(s.count("points_facing_away") + s.count("points_decided_by_map") +
                              s.count("points_decided_by_trace") + s.count("points_decided_by_exact"),
                          in_shadow)
                    << what;
                EXPECT_GT(s.count("points_facing_away"), 100u) << what;
                EXPECT_EQ(s.count("points_decided_by_map") > 0, std::string(map) == "on") << what;
                EXPECT_EQ(s.count("triangles"), triangles.count());
                EXPECT_GT(s.count("triangles_kept"), 0u);
                EXPECT_GT(s.count("tests"), s.count("points_decided_by_trace"));
                EXPECT_TRUE(s.count("lists_grown") > 0 || std::string(capacity) != "1") << what;
                EXPECT_EQ(s.count("no such count"), 0u);
                EXPECT_GT(s.device_memory_bytes, 0u);
                std::vector<std::string> names;
                double stages_ms = 0;
                for (const auto& stage : s.stages) {
                    names.push_back(stage.name);
                    stages_ms += stage.wall_ms;
                    EXPECT_EQ(stage.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos);
                    EXPECT_LE(stage.device_ms, stage.wall_ms * 1.5 + 1) << stage.name;
                }
                EXPECT_LE(stages_ms, s.total_wall_ms);
                std::sort(names.begin(), names.end());
                EXPECT_EQ(std::unique(names.begin(), names.end()), names.end()) << "a stage is listed twice";
                for (const char* stage : {"facing", "light_frame", "conservative_map", "bins", "trace"})
                    EXPECT_TRUE(std::binary_search(names.begin(), names.end(), stage)) << stage;

                // The first run's room depends on the device; lists then keep their length.
                gnomon::Statistics roomy = s;
                for (int run = 0; run < 5 && roomy.count("lists_grown") != 0; ++run)
                    roomy = technique->run(triangles, points, light, visibility, options_of_run);
                EXPECT_EQ(roomy.count("lists_grown"), 0u) << what;
                EXPECT_EQ(roomy.count("points_in_shadow"), in_shadow) << what;
                if (light.is_directional()) {
                    EXPECT_EQ(s.count("triangles_not_finite"), 1u) << what;
                    EXPECT_EQ(roomy.count("triangles_not_finite") + roomy.count("triangles_edge_on") +
                                  roomy.count("triangles_outside") + roomy.count("triangles_kept"),
                              roomy.count("triangles"))
                        << what;
                }
            }
}

TEST(Statistics, StagesWithNothingToDoSayWhy) {
    const Device device;
    const auto points = Points::upload(device, ground());
    const Visibility visibility(device, 81);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const auto why = [&](const Triangles& triangles, const char* name) {
        for (const auto& stage : technique->run(triangles, points, noon, visibility).stages)
            if (stage.name == name) return stage.skipped;
        return std::string("not listed");
    };
    const auto some = Triangles::upload(device, roof), none = Triangles::upload(device, {});
    EXPECT_EQ(why(some, "conservative_map"), "few points");
    EXPECT_EQ(why(some, "trace"), "");
    EXPECT_NE(why(none, "trace").find("no triangles"), std::string::npos);
    technique->set("conservative-map", "off");
    EXPECT_EQ(why(some, "conservative_map"), "switched off");
}

// ---- Cameras filled by hand -----------------------------------------------------------------------------------------

using Double3 = std::array<double, 3>;

Double3 crossed(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dotted(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Not vacuous: with the rows taken as if the axes were orthogonal, 390 of these pixels were wrong.
TEST(HandMadeCamera, NeedNotBeOrthogonal) {
    const gnomon::Device device;
    gnomon::Camera camera;
    camera.up = {0.3, 1, 0};
    constexpr int side = 64;
    const std::vector<float> t{-0.3f, -0.3f, -1, 0.4f, -0.2f, -1, 0.1f, 0.45f, -1};
    const auto triangles = gnomon::Triangles::upload(device, t);
    const auto host = gnomon::look(device, triangles, camera, side, side).read(device, triangles);
    const Double3 a{t[0], t[1], t[2]}, b{t[3], t[4], t[5]}, c{t[6], t[7], t[8]};
    const double pixel = std::tan(camera.fov_y_radians / 2) / (side / 2.0);
    int covered = 0, wrong = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            Double3 ray;
            for (int i = 0; i < 3; ++i)
                ray[i] = camera.forward[i] + (x + 0.5 - side / 2.0) * pixel * camera.right[i] +
                         (side / 2.0 - y - 0.5) * pixel * camera.up[i];
            const double side_of_eye = dotted(a, crossed(b, c));
            const bool inside = dotted(ray, crossed(a, b)) * side_of_eye >= 0 &&
                                dotted(ray, crossed(b, c)) * side_of_eye >= 0 &&
                                dotted(ray, crossed(c, a)) * side_of_eye >= 0;
            covered += inside;
            wrong += inside != (host.receiver[std::size_t(y) * side + x] == 0);
        }
    EXPECT_GT(covered, 500);
    EXPECT_EQ(wrong, 0);
}

TEST(HandMadeCamera, IsRefusedIfItIsNone) {
    const gnomon::Device device;
    const auto triangles = gnomon::Triangles::upload(device, {});
    const auto refused = [&](auto change) {
        gnomon::Camera camera;
        change(camera);
        EXPECT_THROW(gnomon::look(device, triangles, camera, 8, 8), gnomon::InvalidArgument);
    };
    refused([](gnomon::Camera& c) { c.up = {0, 0, -1}; });
    refused([](gnomon::Camera& c) { c.right = {0, 0, 0}; });
    refused([](gnomon::Camera& c) { c.forward = {0, 0, std::nan("")}; });
    refused([](gnomon::Camera& c) { c.eye[1] = INFINITY; });
    refused([](gnomon::Camera& c) { c.fov_y_radians = 4; });
    refused([](gnomon::Camera& c) { c.fov_y_radians = std::nan(""); });
}

}  // namespace
