// SPDX-License-Identifier: MIT
// Forks. This program itself uses no OpenCL: each test forks a parent, which brings OpenCL into a state and forks a
// child. The child must answer, or fail at once with a sentence that names "spawn", and must then be able to drop
// everything that it inherited. An alarm ends a child that hangs.
#include <gnomon.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <gnomon.hpp>
#include <optional>
#include <string_view>
#include <thread>

namespace {

using namespace gnomon;

constexpr int answered = 10, refused = 11, is_wrong = 12;

/// The exit code of a process of its own that runs this function; minus the signal that ended it.
int in_a_fork(const std::function<int()>& run, unsigned seconds) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(seconds);
        int code = is_wrong;
        try {
            code = run();
        } catch (const OpenClError&) {
        } catch (const Error& error) {
            if (std::string_view(error.what()).find("spawn") != std::string_view::npos) code = refused;
        }
        _exit(code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

constexpr std::array roof = {-1.f, -1.f, 2.f, 1.f, -1.f, 2.f, 1.f, 1.f, 2.f};
constexpr std::array points = {.5f, 0.f, 0.f, 5.f, 0.f, 0.f};
const Light down = Light::directional({0, 0, -1});

/// Everything that a program holds.
struct Held {
    Device device;
    Triangles triangles = Triangles::upload(device, roof);
    Points receivers = Points::upload(device, points);
    Visibility visibility{device, 2};
    std::unique_ptr<Technique> technique = make_technique("frustum-traced", device);

    int run() {
        technique->run(triangles, receivers, down, visibility);
        return visibility.read() == std::vector{0.f, 1.f} ? answered : is_wrong;
    }
};

/// The parent does `before`, then forks a child, which does `after`.
int child_of(const std::function<void()>& before, const std::function<int()>& after) {
    return in_a_fork([&] { return before(), in_a_fork(after, 20); }, 120);
}

int run_anew() { return Held().run(); }

TEST(Forks, AnUnusedParentLeavesTheChildFree) {
    EXPECT_EQ(child_of([] { techniques(); }, run_anew), answered);
}

TEST(Forks, AUsedParentIsNamedAtOnce) {
    EXPECT_EQ(child_of([] { load_opencl(); }, run_anew), refused);
    EXPECT_EQ(child_of([] { devices(); }, run_anew), refused);
    EXPECT_EQ(child_of([] { devices(); }, [] { return devices(), answered; }), refused);
    EXPECT_EQ(child_of([] { Held().run(); }, run_anew), refused);
}

TEST(Forks, AnOpeningOrRunInAnotherThreadHoldsNoLockAgainstTheChild) {
    for (const int milliseconds : {1, 20, 100, 300}) {
        std::atomic<bool> is_loaded = false;
        const auto before = [&] {
            std::thread([&] {
                load_opencl();
                is_loaded = true;
                for (Held held;;) held.run();
            }).detach();
            std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        };
        // Where the fork came before the thread did anything, the child is free.
        const auto after = [&] { return run_anew() == answered && !is_loaded ? refused : is_wrong; };
        EXPECT_EQ(child_of(before, after), refused) << milliseconds;
    }
}

TEST(Forks, APlatformThatTheProgramItselfAskedForIsKnown) {
    const auto before = [] {
        cl_uint count = 0;
        cl_platform_id platform = nullptr;
        clGetPlatformIDs(1, &platform, &count);
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count);
    };
    EXPECT_EQ(child_of(before, run_anew), refused);
}

TEST(Forks, InheritedObjectsRefuseAndAreDropped) {
    std::optional<Held> held;
    std::optional<View> view;
    const auto before = [&] {
        held.emplace();
        held->run();
        view = look(held->device, held->triangles, Camera::look_at({0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 40), 8, 8);
    };
    const auto refuses = [&](const std::function<void()>& call) {
        const auto after = [&] {
            bool is_refused = false;
            try {
                call();
            } catch (const Error& error) {
                is_refused = std::string_view(error.what()).find("spawn") != std::string_view::npos;
            }
            view.reset();
            held.reset();  // releases nothing: the driver's locks may be held by a thread that does not exist here
            return is_refused ? refused : answered;
        };
        return child_of(before, after);
    };
    EXPECT_EQ(refuses([&] { held->run(); }), refused);
    EXPECT_EQ(refuses([&] { held->technique->prepare(held->triangles, down); }), refused);
    EXPECT_EQ(refuses([&] { held->visibility.read(); }), refused);
    EXPECT_EQ(refuses([&] { held->device.finish(); }), refused);
    EXPECT_EQ(refuses([&] { Triangles::upload(held->device, roof); }), refused);
    EXPECT_EQ(refuses([&] { Triangles::wrap(held->device, held->triangles.buffer(), 1); }), refused);
    EXPECT_EQ(refuses([&] { Visibility::wrap(held->device, held->visibility.buffer(), 2); }), refused);
    EXPECT_EQ(refuses([&] { view->read(held->device, held->triangles); }), refused);
    EXPECT_EQ(refuses([&] { VertexFans::find(held->device, roof, roof); }), refused);
    EXPECT_EQ(refuses([&] { Device(held->device.context(), held->device.queue()); }), refused);
    EXPECT_EQ(refuses([&] {
                  make_technique("frustum-traced", held->device)
                      ->run(held->triangles, held->receivers, down, held->visibility);
              }),
              refused);
    EXPECT_EQ(refuses([] {}), answered);  // it only drops them
}

TEST(Forks, TheParentGoesOn) {
    const auto parent = [] {
        Held held;
        if (held.run() != answered) return is_wrong;
        if (in_a_fork([&] { return held.run(); }, 20) != refused) return is_wrong;
        return held.run();
    };
    EXPECT_EQ(in_a_fork(parent, 120), answered);
}

TEST(Forks, TheCInterfaceReturnsAStatus) {
    gnomon_device* device = nullptr;
    gnomon_triangles* triangles = nullptr;
    gnomon_visibility* visibility = nullptr;
    gnomon_technique* technique = nullptr;
    const auto before = [&] {
        gnomon_device_open("", nullptr, &device);
        gnomon_triangles_upload(device, roof.data(), 1, &triangles);
        gnomon_visibility_create(device, 2, &visibility);
        gnomon_technique_create(device, "frustum-traced", &technique);
    };
    const auto after = [&] {
        const auto is_refused = [](gnomon_status status) {
            return status == GNOMON_UNEXPECTED_ERROR &&
                   std::string_view(gnomon_last_error()).find("spawn") != std::string_view::npos;
        };
        gnomon_device* other = nullptr;
        gnomon_triangles* more = nullptr;
        const gnomon_device_list* list = nullptr;
        std::array<float, 2> values{};
        const bool all = is_refused(gnomon_device_open("", nullptr, &other)) && other == nullptr &&
                         is_refused(gnomon_triangles_upload(device, roof.data(), 1, &more)) && more == nullptr &&
                         is_refused(gnomon_visibility_read(visibility, values.data())) &&
                         is_refused(gnomon_devices_list(&list));
        gnomon_technique_destroy(technique);
        gnomon_visibility_destroy(visibility);
        gnomon_triangles_destroy(triangles);
        gnomon_device_destroy(device);
        return all ? refused : is_wrong;
    };
    EXPECT_EQ(child_of(before, after), refused);
}

TEST(Threads, OpenTheirDevicesAtOnce) {
    EXPECT_EQ(answered, in_a_fork(
                            [] {
                                std::atomic<int> right = 0;
                                std::vector<std::thread> threads;
                                for (int i = 0; i < 4; ++i)
                                    threads.emplace_back([&] { right += Held().run() == answered; });
                                for (std::thread& thread : threads) thread.join();
                                return right == 4 ? answered : is_wrong;
                            },
                            60));
}

}  // namespace
