// SPDX-License-Identifier: MIT
// See exact_path.hpp.
#include "exact_path.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <limits>

#include <gnomon.hpp>
#include "scenes.hpp"

namespace stress {
namespace {

constexpr int RUNS = 15;

std::string name_of(const Light& light) {
    const float sign = light[3] == 0 ? -1.0f : 1.0f;
    return fmt::format("{} ({:g}, {:g}, {:g})", light[3] == 0 ? "along" : "at", sign * light[0] + 0,
                       sign * light[1] + 0, sign * light[2] + 0);
}

ExactPathRow measured(const gnomon::Device& device, const gnomon::Triangles& triangles, const Viewpoint& from,
                      const Light& light) {
    const auto camera = gnomon::Camera::look_at(from.eye, from.target, from.up, from.fov_y_degrees);
    const gnomon::View view = gnomon::look(device, triangles, camera, 1920, 1080);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Visibility visibility(device, view.points.count());
    ExactPathRow row;
    row.light = name_of(light);
    row.points = view.points.count();
    row.trace_ms = row.exact_ms = row.all_ms = std::numeric_limits<double>::infinity();
    for (int run = 0; run < RUNS; ++run) {
        const auto statistics = technique->run(triangles, view.points, gnomon::Light{light}, visibility);
        double all = 0, trace = 0, exact = 0;
        for (const auto& stage : statistics.stages) {
            all += stage.device_ms;
            if (stage.name == "trace") trace = stage.device_ms;
            if (stage.name == "exact_trace") exact = stage.device_ms;
        }
        row.trace_ms = std::min(row.trace_ms, trace);
        row.exact_ms = std::min(row.exact_ms, exact);
        row.all_ms = std::min(row.all_ms, all);
        row.open_pairs = statistics.count("uncertain_pairs");
        row.by_integers = statistics.count("decided_by_integers");
    }
    return row;
}

}  // namespace

std::vector<ExactPathRow> exact_path_costs(std::string_view selector) {
    gnomon::DeviceOptions options;
    options.profile = true;
    const gnomon::Device device(selector, options);
    std::vector<ExactPathRow> rows;
    for (const std::string name : {"sponza", "lost_empire"}) {
        Subject subject = real_scene(name);
        if (name == "lost_empire")
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
