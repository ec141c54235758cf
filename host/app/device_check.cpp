// SPDX-License-Identifier: MIT
// `gnomon devices --check`: one page of text that tells whether a device computes right, and how fast it is.
#include "options.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>
#include <sstream>

#include "device_cases.hpp"
#include "scene/scene.hpp"
#include "setup.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

template <typename Value>
std::span<const std::byte> bytes_of(const std::vector<Value>& values) {
    return std::as_bytes(std::span(values));
}

/// What was asked, and how many questions had a wrong answer.
struct Findings {
    std::ostringstream text;
    std::uint64_t points = 0;
    int wrong = 0;

    void add(const std::string& what, std::uint64_t count, bool is_right) {
        text << "  " << what << std::string(what.size() < 48 ? 48 - what.size() : 1, ' ')
             << fmt::format("{:>11} points  ", grouped(count)) << (is_right ? "right" : "WRONG") << '\n';
        points += count;
        wrong += is_right ? 0 : 1;
    }
};

struct Way {
    const char* name;
    bool prepares, has_clusters;
};
constexpr Way ways[] = {{"", false, false}, {", clusters", false, true}, {", prepared", true, false}};

void check_views(const Device& device, const scene::Scene& scene, Findings& findings) {
    for (const Way& way : ways) {
        Triangles triangles = Triangles::upload(device, scene.triangles);
        if (way.has_clusters) triangles.keep_clusters(device);
        const View view = look(device, triangles, scene.cameras.front().camera, known_width, known_height);
        const ViewOnHost host = view.read(device, triangles);
        findings.add("camera" + std::string(way.name), host.receiver.size(),
                     hash_of(bytes_of(host.receiver), hash_of(bytes_of(host.position))) == known_camera);
        for (const KnownView& known : known_views(scene.lights.front().light)) {
            const auto technique = gnomon::make_technique("frustum-traced", device);
            if (way.prepares) technique->prepare(triangles, known.light);
            const Visibility visibility(device, view.points.count());
            technique->run(triangles, view.points, known.light, visibility);
            findings.add(known.name + way.name, view.points.count(),
                         hash_of(bytes_of(visibility.read())) == known.visibility);
        }
    }
}

void check_hard_cases(const Device& device, Findings& findings) {
    for (const HardCase& hard : hard_cases()) {
        const Triangles triangles = Triangles::upload(device, hard.triangles);
        const Points points = Points::upload(device, hard.points);
        const auto technique = gnomon::make_technique("frustum-traced", device);
        std::uint64_t hash = hash_start;
        for (const Light& light : hard.lights) {
            const Visibility visibility(device, points.count());
            technique->run(triangles, points, light, visibility);
            hash = hash_of(bytes_of(visibility.read()), hash);
        }
        findings.add(hard.name, points.count() * hard.lights.size(), hash == hard.answers);
    }
}

/// The median of some repetitions in half a second or so.
template <typename Work>
double median_ms(const Device& device, Work work) {
    work();
    device.finish();
    std::vector<double> times;
    const auto start = Clock::now();
    while (times.size() < 3 || (times.size() < 31 && ms_since(start) < 500)) {
        const auto once = Clock::now();
        work();
        device.finish();
        times.push_back(ms_since(once));
    }
    std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
    return times[times.size() / 2];
}

std::string speed_of(const Device& device, const scene::Scene& scene) {
    constexpr std::uint32_t width = 1280, height = 720;
    const Camera& camera = scene.cameras.front().camera;
    const Light& light = scene.lights.front().light;
    const Triangles triangles = Triangles::upload(device, scene.triangles);
    const View view = look(device, triangles, camera, width, height);
    const Visibility visibility(device, view.points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const double look_ms = median_ms(device, [&] { look(device, triangles, camera, width, height); });
    const auto run = [&] { technique->run(triangles, view.points, light, visibility); };
    const double animated_ms = median_ms(device, run);
    technique->prepare(triangles, light);
    const double prepared_ms = median_ms(device, run);
    return fmt::format(
        "  {}x{} pixels, {} triangles: camera {:.2f} ms, shadows {:.2f} ms, with a prepared light {:.2f} ms\n", width,
        height, grouped(scene.triangle_count()), look_ms, animated_ms, prepared_ms);
}

}  // namespace

void check_device(const ListDevices& options) {
    const auto start = Clock::now();
    ViewOptions view_options;
    view_options.device = options.device;
    const Device device = open_device(view_options, false);
    const DeviceDescription& description = device.description();
    std::ostringstream page;
    page << "gnomon " << version() << ", check of a device\n\n" << device_text(description) << '\n';
    page << "self-check  passed" << (description.note.empty() ? "" : "; " + description.note) << "\n\n";
    const scene::Scene scene = scene::sundial();
    Findings findings;
    {
        const ProgressLine progress("checking " + description.name, true);
        check_views(device, scene, findings);
        check_hard_cases(device, findings);
        page << "answers known bit for bit\n" << findings.text.str() << "\nspeed\n" << speed_of(device, scene);
    }
    const KernelBuilds builds = device.kernel_builds();
    page << fmt::format("  kernels {:.1f} s for {} programs, {} of them from gnomon's cache; all of this {:.1f} s\n\n",
                        builds.ms / 1000, int(builds.programs), int(builds.from_cache), ms_since(start) / 1000);
    if (findings.wrong == 0)
        page << "RIGHT: " << grouped(findings.points) << " answers, none wrong. If docs/drivers.md does not name this "
             << "driver, please send this page.\n";
    print_result(page.str());
    if (findings.wrong != 0)
        throw Error(fmt::format("{} of the answers of the device ", findings.wrong) + description.name +
                    " are wrong: do not use it, and please send this page");
}

}  // namespace gnomon::app
