// SPDX-License-Identifier: MIT
// The public functions: devices, techniques by their names (techniques/registered.hpp lists them), and their runs.
#include <gnomon.hpp>

#include <functional>

#include "api/inputs.hpp"
#include "cl/session.hpp"
#include "exact/self_check.hpp"
#include "lights/many_lights.hpp"
#include "receivers/given_sides.hpp"
#include "techniques/registered.hpp"

namespace gnomon {

#define GN_TEXT_OF(number) #number
#define GN_VERSION_TEXT(major, minor, patch) GN_TEXT_OF(major) "." GN_TEXT_OF(minor) "." GN_TEXT_OF(patch)
std::string_view version() { return GN_VERSION_TEXT(GNOMON_VERSION_MAJOR, GNOMON_VERSION_MINOR, GNOMON_VERSION_PATCH); }
#undef GN_TEXT_OF
#undef GN_VERSION_TEXT

Device::Device(std::string_view selector, const DeviceOptions& options)
    : session_(open_checked(options, [found = cl::select_device(selector)](const DeviceOptions& chosen) {
          return std::make_shared<cl::Session>(found, chosen);
      })) {}

Device::Device(cl_context context, cl_command_queue queue, const DeviceOptions& options)
    : session_(open_checked(options, [context, queue](const DeviceOptions& chosen) {
          return std::make_shared<cl::Session>(context, queue, chosen);
      })) {}

const DeviceDescription& Device::description() const { return session_->description(); }
cl_context Device::context() const { return session_->context(); }
cl_command_queue Device::queue() const { return session_->queue(); }
void Device::finish() const { session_->finish(); }
std::uint64_t Device::memory_bytes() const { return session_->memory_bytes(); }
std::uint64_t Device::peak_memory_bytes() const { return session_->peak_memory_bytes(); }
KernelBuilds Device::kernel_builds() const { return session_->kernel_builds(); }

std::uint64_t Statistics::count(std::string_view name) const {
    for (const auto& [key, value] : counts)
        if (key == name) return value;
    return 0;
}

namespace {

std::vector<Registered> all_registered() {
    std::vector<Registered> all{GN_TECHNIQUES};
    for (Registered& preset : shadow_map_presets()) all.push_back(std::move(preset));
    return all;
}

}  // namespace

Statistics Technique::prepare(const Triangles&, const Light& light) {
    require_light(light);
    return {};
}

namespace {

void report(const Device& device, const RunOptions& options, double done) {
    if (!options.progress) return;
    device.finish();
    if (!options.progress(done)) throw Cancelled("the run was cancelled");
}

}  // namespace

Statistics Technique::run(const Triangles& triangles, const Points& points, const Light& light,
                          const Visibility& visibility, const RunOptions& options) {
    const GivenSides sides = given_sides(device(), triangles, points, options.facing);
    require_apart(points, sides, visibility);
    const Points seen = Internals::seen_from(points, sides.eye);
    Statistics statistics = run_light(triangles, seen, light, visibility);
    darken_backfacing(device(), triangles, points, sides, light, visibility);
    report(device(), options, 1);
    return statistics;
}

std::vector<Statistics> Technique::run_each_light(const Triangles& triangles, const Points& points,
                                                  std::span<const Light> lights,
                                                  std::span<const Visibility> visibilities, const RunOptions& options) {
    const GivenSides sides = given_sides(device(), triangles, points, options.facing);
    const Points seen = Internals::seen_from(points, sides.eye);
    require_run_lights(triangles, seen, lights, visibilities);
    for (const Visibility& visibility : visibilities) require_apart(points, sides, visibility);
    return run_lights(triangles, seen, lights, visibilities, [&](std::size_t i) {
        darken_backfacing(device(), triangles, points, sides, lights[i], visibilities[i]);
        report(device(), options, double(i + 1) / double(lights.size()));
    });
}

// The ways of a table that are not one light at a time know the other sides, and no fans.
Statistics Technique::run_light_table(const Triangles& triangles, const Points& points, const Lights& lights,
                                      const LightsOutputs& outputs, const RunOptions& options) {
    const LightsOptions chosen{given_sides(device(), triangles, points, options.facing), outputs.cosines,
                               options.progress};
    const Points seen = Internals::seen_from(points, chosen.eye);
    if (chosen.fans != nullptr) return Technique::run_table(triangles, seen, lights, outputs, chosen);
    return run_table(triangles, seen, lights, outputs, chosen);
}

std::vector<Statistics> Technique::run_lights(const Triangles& triangles, const Points& points,
                                              std::span<const Light> lights, std::span<const Visibility> visibilities,
                                              const std::function<void(std::size_t)>& after_light) {
    std::vector<Statistics> statistics;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        statistics.push_back(run_light(triangles, points, lights[i], visibilities[i]));
        after_light(i);
    }
    return statistics;
}

std::vector<TechniqueDescription> techniques() {
    std::vector<TechniqueDescription> all;
    for (Registered& r : all_registered()) all.push_back(std::move(r.description));
    return all;
}

std::vector<std::uint8_t> Technique::diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                              const Light& light, const Facing& facing) {
    return draw_diagnostic(name, triangles, seen_from_eye(device(), points, facing), light);
}

// Presets have the diagnostics of their technique, which comes before them.
std::vector<std::uint8_t> Technique::draw_diagnostic(std::string_view name, const Triangles&, const Points&,
                                                     const Light&) {
    std::string known, names;
    for (const TechniqueDescription& technique : techniques()) {
        names.clear();
        for (const DiagnosticDescription& d : technique.diagnostics) names += (names.empty() ? "" : ", ") + d.name;
        if (names.empty() || known.find(names) != std::string::npos) continue;
        known.append(known.empty() ? "" : "; ").append(technique.name).append(" has ").append(names);
    }
    throw InvalidArgument("this technique has no diagnostic named \"" + std::string(name) + "\": " + known);
}

std::unique_ptr<Technique> make_technique(std::string_view name, const Device& device) {
    std::string names;
    for (const Registered& r : all_registered()) {
        if (r.description.name == name) return r.make(device);
        names += (names.empty() ? "" : ", ") + r.description.name;
    }
    throw InvalidArgument("no technique is named \"" + std::string(name) + "\": there are " + names);
}

}  // namespace gnomon
