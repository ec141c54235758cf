// SPDX-License-Identifier: MIT
// See exact_path.hpp.
#include "exact_path.hpp"

#include <algorithm>

#include "gnomon.hpp"
#include "scenes.hpp"

namespace stress {
namespace {

constexpr int RUNS = 7;

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

std::string name_of(const Light& light) {
    char text[64];
    const float sign = light[3] == 0 ? -1.0f : 1.0f;
    std::snprintf(text, sizeof(text), "%s (%g, %g, %g)", light[3] == 0 ? "along" : "at", double(sign * light[0] + 0),
                  double(sign * light[1] + 0), double(sign * light[2] + 0));
    return text;
}

ExactPathRow measured(const gnomon::Device& device, const gnomon::Triangles& triangles, const Viewpoint& from,
                      const Light& light) {
    const auto camera = gnomon::Camera::look_at(from.eye, from.target, from.up, from.fov_y_degrees);
    const gnomon::View view = gnomon::look(device, triangles, camera, 1920, 1080);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Visibility visibility(device, view.points.count());
    std::vector<double> trace, exact, all;
    gnomon::Statistics statistics;
    for (int run = -2; run < RUNS; ++run) {
        statistics = technique->run(triangles, view.points, gnomon::Light{light}, visibility);
        if (run < 0) continue;
        double sum = 0, of_trace = 0, of_exact = 0;
        for (const auto& stage : statistics.stages) {
            sum += stage.device_ms;
            if (stage.name == "trace") of_trace = stage.device_ms;
            if (stage.name == "exact_trace") of_exact = stage.device_ms;
        }
        trace.push_back(of_trace), exact.push_back(of_exact), all.push_back(sum);
    }
    return {{},
            {},
            name_of(light),
            median(trace),
            median(exact),
            median(all),
            view.points.count(),
            statistics.count("uncertain_pairs"),
            statistics.count("decided_by_integers")};
}

}  // namespace

std::vector<ExactPathRow> exact_path_costs(std::string_view selector, const std::filesystem::path& shared_scenes) {
    gnomon::DeviceOptions options;
    options.profile = true;
    const gnomon::Device device(selector, options);
    std::vector<ExactPathRow> rows;
    for (const char* name : {"crytek_sponza", "lost_empire"}) {
        const auto file = shared_scenes / (std::string(name) + ".glb");
        if (!std::filesystem::exists(file)) continue;
        Subject subject = shared_scene(file);
        if (std::string_view(name) == "lost_empire")
            for (const Light& tie : {support::along(1, -1, 1), support::along(1, -1, 0), support::along(0, -1, 0),
                                     support::along(-1, 0, 0)})
                subject.lights.push_back(tie);
        const auto triangles = gnomon::Triangles::upload(device, *subject.triangles);
        for (std::size_t view = 0; view < subject.views.size(); ++view)
            for (const Light& light : subject.lights) {
                rows.push_back(measured(device, triangles, subject.views[view], light));
                rows.back().scene = name;
                rows.back().view = std::to_string(view + 1);
            }
    }
    return rows;
}

}  // namespace stress
