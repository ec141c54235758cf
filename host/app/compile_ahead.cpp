// SPDX-License-Identifier: MIT
#include "compile_ahead.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <thread>
#include <utility>

#include "cl/environment.hpp"
#include "picture.hpp"
#include "query/inputs.hpp"
#include "setup.hpp"

namespace gnomon::app {
namespace {

/// Of the picture that is never shown: enough points for each kernel to be launched.
constexpr std::uint32_t side = 64;
/// A copy of more triangles would take longer than it saves, and memory.
constexpr std::size_t largest_triangle_count = 1'000'000;

/// The file that says that kernels are compiled; empty if there is no folder for it.
std::filesystem::path note_of(const RenderOptions& options, const scene::Scene& scene) {
    const std::filesystem::path folder = cl::cache_directory();
    if (folder.empty()) return {};
    std::string name = "compiled-" + std::string(version()) + "-" + options.device;
    name += scene.cut_outs.empty() ? "-opaque" : "-cut-outs";
    name += scene.texture_coordinates.empty() ? "-plain" : "-textured";
    std::ranges::replace_if(
        name, [](unsigned char c) { return !std::isalnum(c) && c != '.'; }, '-');
    return folder / name;
}

/// A view that no camera made: the triangles' centres, one after the other.
View view_without_camera(const Device& device, const Triangles& triangles, const scene::Scene& scene,
                         const Camera& camera) {
    constexpr std::size_t pixels = std::size_t(side) * side;
    std::vector<float> positions(3 * pixels);  // one axis after the other, as a camera's
    std::vector<cl_uint> receivers(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t id = i * scene.triangle_count() / pixels;
        receivers[i] = cl_uint(id);
        for (std::size_t k = 0; k < 9; ++k) positions[k % 3 * pixels + i] += scene.triangles[9 * id + k] / 3;
    }
    cl::Buffer on_device[2];
    cl::Session& session = session_of(device);
    session.upload(on_device[0], positions);
    session.upload(on_device[1], receivers);
    View view;
    view.width = view.height = side;
    view.points = Points::wrap(device, on_device[0].get(), {0, 1, pixels}, pixels, on_device[1].get());
    view.points.set_camera(camera, side, side);
    // This holds of a camera's points only, and chooses the kernels that are made for them.
    view.points.set_lifted_off(triangles, {float(camera.eye[0]), float(camera.eye[1]), float(camera.eye[2])});
    return view;
}

/// Launches the kernels of a picture that come after the camera's, its last ones first. `built`: see CompileAhead.
void compile(const RenderOptions& options, const scene::Scene& scene, int built) {
    const Device device = open_device(options, false);
    const Triangles triangles = scene::upload(device, scene);
    const View view = view_without_camera(device, triangles, scene, choose_camera(options, scene).camera);
    view.read(device, triangles);  // its normals' kernel is in the camera's program
    ::close(built);
    const std::vector<Light> light{choose_lights(options, scene).front().light};
    std::vector<float> lit(view.points.count(), 1.0f);
    const std::vector<Visibility> visibility{Visibility::share(device, lit)};
    shade(SceneSurfaces(device, scene, nullptr).of(triangles, view), visibility, light, {.exposure_ev = 0});
    const auto technique = make_technique(device, options.technique, options.settings);
    technique->run(triangles, view.points, light.front(), visibility.front());
    device.finish();
}

/// The process: silent, and without a part in the temporary files of the first one.
[[noreturn]] void run_process(const RenderOptions& options, const scene::Scene& scene, int built) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::signal(number, SIG_DFL);
#ifdef __linux__
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
    const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
    try {
        compile(options, scene, built);
    } catch (...) {  // the first process meets the same cause, and says it
    }
    ::_exit(0);
}

}  // namespace

CompileAhead::CompileAhead(const RenderOptions& options, const scene::Scene& scene) : note_(note_of(options, scene)) {
    std::error_code unknown;
    if (note_.empty() || std::filesystem::exists(note_, unknown)) return;
    std::filesystem::create_directories(note_.parent_path(), unknown);
    const bool can_note = ::access(note_.parent_path().c_str(), W_OK) == 0;  // else each start would be a first one
    const bool is_worth_it = scene.triangle_count() > 0 && scene.triangle_count() <= largest_triangle_count &&
                             std::thread::hardware_concurrency() > 1;
    int ends[2];
    if (!can_note || !is_worth_it || ::pipe(ends) != 0) return;
    built_ = ends[0];
    process_ = ::fork();
    if (process_ == 0) {
        ::close(ends[0]);
        run_process(options, scene, ends[1]);
    }
    ::close(ends[1]);
    if (process_ < 0) process_ = 0;
}

CompileAhead::~CompileAhead() {
    if (built_ >= 0) ::close(built_);
    if (process_ == 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
}

void CompileAhead::wait_for_program_of_camera() {
    const int built = std::exchange(built_, -1);
    if (built < 0) return;
    char nothing;
    while (::read(built, &nothing, 1) < 0 && errno == EINTR) continue;
    ::close(built);
}

void CompileAhead::note_picture() const {
    if (!note_.empty()) std::ofstream(note_).flush();
}

}  // namespace gnomon::app
