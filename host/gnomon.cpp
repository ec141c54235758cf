// SPDX-License-Identifier: MIT
// The public functions: devices, and techniques by their names (techniques/registered.hpp lists them).
#include <gnomon.hpp>

#include <functional>

#include "api/inputs.hpp"
#include "cl/session.hpp"
#include "exact/self_check.hpp"
#include "techniques/registered.hpp"

namespace gnomon {

std::string_view version() { return GNOMON_VERSION; }

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

std::vector<Statistics> Technique::run_lights(const Triangles& triangles, const Points& points,
                                              std::span<const Light> lights, std::span<const Visibility> visibilities) {
    require_run_lights(triangles, points, lights, visibilities);
    std::vector<Statistics> statistics;
    for (std::size_t i = 0; i < lights.size(); ++i)
        statistics.push_back(run(triangles, points, lights[i], visibilities[i]));
    return statistics;
}

std::vector<TechniqueDescription> techniques() {
    std::vector<TechniqueDescription> all;
    for (Registered& r : all_registered()) all.push_back(std::move(r.description));
    return all;
}

// Presets have the diagnostics of their technique, which comes before them.
std::vector<std::uint8_t> Technique::diagnose(std::string_view name, const Triangles&, const Points&, const Light&) {
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
