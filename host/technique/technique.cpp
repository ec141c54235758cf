// SPDX-License-Identifier: MIT
// The public functions: techniques by their names (technique/registered.hpp), and their runs.
#include <gnomon.hpp>

#include <functional>
#include <iterator>
#include <mutex>

#include "lights/many_lights.hpp"
#include "query/inputs.hpp"
#include "receivers/backfacing.hpp"
#include "technique/registered.hpp"

namespace gnomon {
namespace {

struct Register {
    std::mutex mutex;
    std::vector<Registered> techniques{frustum_traced_technique()};
};

Register& the_register() {
    static Register all;
    return all;
}

std::vector<Registered> all_registered() {
    Register& all = the_register();
    const std::lock_guard lock(all.mutex);
    return all.techniques;
}

}  // namespace

void register_techniques(std::vector<Registered> techniques) {
    Register& all = the_register();
    const std::lock_guard lock(all.mutex);
    std::move(techniques.begin(), techniques.end(), std::back_inserter(all.techniques));
}

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
    const FacingInputs sides = facing_inputs(device(), triangles, points, options.facing);
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
    const FacingInputs sides = facing_inputs(device(), triangles, points, options.facing);
    const Points seen = Internals::seen_from(points, sides.eye);
    require_run_lights(triangles, seen, lights, visibilities);
    for (const Visibility& visibility : visibilities) require_apart(points, sides, visibility);
    return run_lights(triangles, seen, lights, visibilities, [&](std::size_t i) {
        darken_backfacing(device(), triangles, points, sides, lights[i], visibilities[i]);
        report(device(), options, double(i + 1) / double(lights.size()));
    });
}

// Only one light at a time decides facing by fans; all methods decide it by the other sides.
Statistics Technique::run_light_table(const Triangles& triangles, const Points& points, const Lights& lights,
                                      const LightsOutputs& outputs, const RunOptions& options) {
    const LightsOptions chosen{facing_inputs(device(), triangles, points, options.facing), outputs.cosines,
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
    const std::vector<Registered> all = all_registered();
    std::string names;
    for (const Registered& r : all) {
        if (r.description.name == name) return r.make(device);
        names += (names.empty() ? "" : ", ") + r.description.name;
    }
    if (all.size() == 1) names += ", and after gnomon::add_rivals() the classic ones";
    throw InvalidArgument("no technique is named \"" + std::string(name) + "\": there are " + names);
}

}  // namespace gnomon
