// SPDX-License-Identifier: MIT
// `gnomon devices --check`: one page of text that tells whether a device computes right, and how fast it is.
#include "options.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>

#include "device_cases.hpp"
#include "report.hpp"
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

/// What was asked, and whether the answers were right.
struct Finding {
    std::string what;
    std::uint64_t points = 0;
    bool is_right = false;
};
using Findings = std::vector<Finding>;

/// Medians, of a view of so many pixels.
struct Speed {
    std::uint32_t width = 1280, height = 720;
    std::uint64_t triangles = 0;
    double camera_ms = 0, shadows_ms = 0, prepared_ms = 0;
};

/// All of a check.
struct Check {
    DeviceDescription device;
    Findings findings;
    Speed speed;
    KernelBuilds builds;
    double seconds = 0;

    std::int64_t wrong() const { return std::ranges::count(findings, false, &Finding::is_right); }
    std::uint64_t points() const {
        std::uint64_t sum = 0;
        for (const Finding& finding : findings) sum += finding.points;
        return sum;
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
        findings.push_back({"camera" + std::string(way.name), host.receiver.size(),
                            hash_of(bytes_of(host.receiver), hash_of(bytes_of(host.position))) == known_camera});
        for (const KnownView& known : known_views(scene.lights.front().light)) {
            const auto technique = gnomon::make_technique("frustum-traced", device);
            if (way.prepares) technique->prepare(triangles, known.light);
            const Visibility visibility(device, view.points.count());
            technique->run(triangles, view.points, known.light, visibility);
            findings.push_back(
                {known.name + way.name, view.points.count(), hash_of(bytes_of(visibility.read())) == known.visibility});
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
        findings.push_back({hard.name, points.count() * hard.lights.size(), hash == hard.answers});
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

Speed speed_of(const Device& device, const scene::Scene& scene) {
    Speed speed;
    const Camera& camera = scene.cameras.front().camera;
    const Light& light = scene.lights.front().light;
    const Triangles triangles = Triangles::upload(device, scene.triangles);
    speed.triangles = triangles.count();
    const View view = look(device, triangles, camera, speed.width, speed.height);
    const Visibility visibility(device, view.points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    speed.camera_ms = median_ms(device, [&] { look(device, triangles, camera, speed.width, speed.height); });
    const auto run = [&] { technique->run(triangles, view.points, light, visibility); };
    speed.shadows_ms = median_ms(device, run);
    technique->prepare(triangles, light);
    speed.prepared_ms = median_ms(device, run);
    return speed;
}

std::string page_of(const Check& check) {
    std::string page =
        fmt::format("gnomon {}, check of a device\n\n{}\nself-check  passed{}\n\n", version(),
                    device_text(check.device), check.device.note.empty() ? "" : "; " + check.device.note);
    page += "answers known bit for bit\n";
    for (const Finding& finding : check.findings)
        page += fmt::format("  {:<47} {:>11} points  {}\n", finding.what, grouped(finding.points),
                            finding.is_right ? "right" : "WRONG");
    const Speed& speed = check.speed;
    page += fmt::format(
        "\nspeed\n  {}x{} pixels, {} triangles: camera {:.2f} ms, shadows {:.2f} ms, with a prepared light {:.2f} ms\n",
        speed.width, speed.height, grouped(speed.triangles), speed.camera_ms, speed.shadows_ms, speed.prepared_ms);
    page += fmt::format("  kernels {:.1f} s for {} programs, {} of them from gnomon's cache; all of this {:.1f} s\n\n",
                        check.builds.ms / 1000, check.builds.programs, check.builds.from_cache, check.seconds);
    if (check.wrong() == 0)
        page += fmt::format(
            "RIGHT: {} answers, none wrong. If docs/drivers.md does not name this driver, please send "
            "this page.\n",
            grouped(check.points()));
    return page;
}

nlohmann::ordered_json json_of(const Check& check) {
    nlohmann::ordered_json answers = nlohmann::ordered_json::array();
    for (const Finding& finding : check.findings)
        answers.push_back({{"what", finding.what}, {"points", finding.points}, {"right", finding.is_right}});
    const Speed& speed = check.speed;
    return {{"gnomon", std::string(version())},
            {"device", device_json(check.device)},
            {"wrong", check.wrong()},
            {"points", check.points()},
            {"answers", answers},
            {"speed",
             {{"width", speed.width},
              {"height", speed.height},
              {"triangles", speed.triangles},
              {"camera_ms", speed.camera_ms},
              {"shadows_ms", speed.shadows_ms},
              {"prepared_ms", speed.prepared_ms}}},
            {"kernels",
             {{"ms", check.builds.ms}, {"programs", check.builds.programs}, {"from_cache", check.builds.from_cache}}},
            {"seconds", check.seconds}};
}

}  // namespace

void check_device(const ListDevices& options) {
    const auto start = Clock::now();
    ViewOptions view_options;
    view_options.device = options.device;
    const Device device = open_device(view_options, false);
    Check check;
    check.device = device.description();
    const scene::Scene scene = scene::sundial();
    {
        const ProgressLine progress("checking " + check.device.name, true);
        check_views(device, scene, check.findings);
        check_hard_cases(device, check.findings);
        check.speed = speed_of(device, scene);
    }
    check.builds = device.kernel_builds();
    check.seconds = ms_since(start) / 1000;
    print_result(options.prints_json ? json_of(check).dump(2) + "\n" : page_of(check));
    if (check.wrong() != 0)
        throw Error(fmt::format("{} of the answers of the device ", check.wrong()) + check.device.name +
                    " are wrong: do not use it, and please send this page");
}

}  // namespace gnomon::app
