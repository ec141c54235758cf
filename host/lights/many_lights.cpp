// SPDX-License-Identifier: MIT
// A run over many lights, one light at a time, as every technique can do it; and the functions that all such runs
// share.
#include "lights/many_lights.hpp"

#include <algorithm>
#include <numeric>

#include "cl/opencl.hpp"
#include "query/statistics.hpp"
#include "receivers/backfacing.hpp"

namespace gnomon {
namespace {

struct Output {
    const char* name;
    cl_mem buffer;
    std::size_t bytes;
};

void require_own_memory(const Output& output, const Output& other) {
    if (other.bytes == 0) return;
    if (overlap(output.buffer, output.bytes / sizeof(float), other.buffer, other.bytes / sizeof(float)))
        throw InvalidArgument(std::string("the buffer of ") + output.name + " overlaps that of " + other.name +
                              ": give " + output.name + " memory of its own");
}

std::array<Output, 5> outputs_of(const LightsOutputs& outputs, std::size_t points, std::size_t lights) {
    return {{{"bits", outputs.bits, points * ((lights + 31) / 32) * 4},
             {"counts", outputs.counts, points * 4},
             {"sums", outputs.sums, points * 8},
             {"first_lit", outputs.first_lit, points * 4},
             {"last_lit", outputs.last_lit, points * 4}}};
}

void run_light(Technique& technique, const Triangles& triangles, const Points& points, const Light& light,
               const LightsOptions& options, const Visibility& visibility, Statistics& total) {
    add_stages(total, Internals::run_light(technique, triangles, points, light, visibility));
    darken_backfacing(technique.device(), triangles, points, options, light, visibility);
}

}  // namespace

void require_lights_run(const LightsRun& run) {
    const auto& [device, triangles, points, lights, outputs, options] = run;
    require_eye(points);
    std::vector<Output> written;
    for (const Output& output : outputs_of(outputs, points.count(), lights.count())) {
        if (output.buffer == nullptr || output.bytes == 0) continue;
        if (bytes_of(output.buffer) < output.bytes)
            throw InvalidArgument(std::string("the buffer of ") + output.name + " holds " +
                                  std::to_string(bytes_of(output.buffer)) + " bytes, and " +
                                  std::to_string(output.bytes) + " are needed");
        require_apart(triangles, points, output.buffer, output.bytes / sizeof(float), output.name);
        require_own_memory(output,
                           {"normals", options.normals, options.normals != nullptr ? bytes_of(options.normals) : 0});
        for (const Output& other : written) require_own_memory(output, other);
        written.push_back(output);
    }
    if (!options.cosines) return;
    if (options.normals == nullptr) throw InvalidArgument("cosines need points that face by normals");
    if (!std::ranges::all_of(lights.lights(), &Light::is_directional))
        throw InvalidArgument("cosines need directional lights");
}

Triangles with_clusters(const Device& device, const Triangles& triangles) {
    Triangles clustered = triangles;
    const bool has_none = Internals::clusters(triangles) == nullptr && Internals::raster(triangles) == nullptr;
    if (has_none && triangles.count() >= triangles_worth_clusters) clustered.keep_clusters(device);
    return clustered;
}

void report_progress(const LightsOptions& options, double done) {
    if (options.progress && !options.progress(done)) throw Cancelled("the run over many lights was cancelled");
}

void run_one_by_one(Technique& technique, const LightsRun& run, const SortedPoints* sorted, Statistics& statistics) {
    cl::Session& session = session_of(run.device);
    const std::size_t points = run.points.count(), lights = run.lights.count();
    std::vector<std::uint32_t> slots((lights + 31) / 32 * 32, no_light);
    std::iota(slots.begin(), slots.begin() + std::ptrdiff_t(lights), 0u);
    LightSums sums(run, slots, sorted);
    if (points == 0) return;
    const Points ordered = sorted != nullptr ? sorted->as_points(run.device, run.points) : run.points;
    LightsOptions in_order = run.options;
    if (sorted != nullptr && run.options.normals != nullptr) {
        in_order.normals = sorted->normals().get();
        in_order.normals_layout = {};
    }
    const Visibility visibility(run.device, points);
    const cl::Buffer masks(session, points * sizeof(cl_uint));
    LightSumsParams params{};
    params.point_count = static_cast<cl_uint>(points);
    for (std::size_t l = 0; l < lights; ++l) {
        run_light(technique, run.triangles, ordered, run.lights.lights()[l], in_order, visibility, statistics);
        session.launch("lights/light_sums.cl", "light_bits", cl::Range::items(points), params, visibility.buffer(),
                       static_cast<cl_uint>(l % 32), masks);
        if (l % 32 == 31 || l + 1 == lights) sums.add(masks, points, 0, points, static_cast<cl_uint>(l / 32), 1);
        if (run.options.progress) session.finish();
        report_progress(run.options, double(l + 1) / double(lights));
    }
    sums.finish();
    merge_stages(statistics);
}

// Points in any order are sorted once for all lights: a technique's blocks of neighbouring points are then neighbours
// in space (Sponza, a million points at random: 164 -> 76 ms of two cores per light). The points of a picture are
// in order, and some techniques need its camera; fans are in the order of the points.
Statistics Technique::run_table(const Triangles& triangles, const Points& points, const Lights& lights,
                                const LightsOutputs& outputs, const LightsOptions& options) {
    const bool are_many = lights.count() > 1 && points.count() != 0;
    std::uint64_t kept = 0;
    MeasuredRun measured(session_of(device()), kept);
    const Triangles clustered = are_many ? with_clusters(device(), triangles) : triangles;
    const LightsRun run{device(), clustered, points, lights, outputs, options};
    require_lights_run(run);
    std::optional<SortedPoints> sorted;
    if (are_many && !points.camera() && options.fans == nullptr) sorted.emplace(run);
    run_one_by_one(*this, run, sorted ? &*sorted : nullptr, measured.stages);
    return measured.finish({{"points", points.count()}, {"lights", lights.count()}});
}

Statistics run_mean(Technique& technique, const Triangles& triangles, const Points& points, const Lights& lights,
                    const Visibility& mean, const RunOptions& options) {
    require_run(triangles, points, Light::directional({0, -1, 0}), mean);
    cl::Session& session = session_of(technique.device());
    const cl::Buffer counts(session, points.count() * sizeof(cl_uint));
    const Statistics statistics =
        technique.run_light_table(triangles, points, lights, {.counts = counts.get()}, options);
    std::vector<float> shares(lights.count() + 1);
    for (std::size_t i = 1; i < shares.size(); ++i) shares[i] = static_cast<float>(double(i) / double(lights.count()));
    cl::Buffer shares_on_device;
    session.upload(shares_on_device, shares);
    if (points.count() != 0)
        session.launch("lights/light_sums.cl", "light_means", cl::Range::items(points.count()),
                       static_cast<cl_uint>(points.count()), counts, shares_on_device, mean.buffer());
    return statistics;
}

LightsOnHost run_light_table_to_host(Technique& technique, const Triangles& triangles, const Points& points,
                                     const Lights& lights, const LightsWanted& wanted, const RunOptions& options) {
    cl::Session& session = session_of(technique.device());
    const std::size_t count = points.count();
    std::array<cl::Buffer, 5> buffers;
    const bool wants[] = {wanted.bits, wanted.counts, wanted.sums, wanted.first_lit, wanted.last_lit};
    std::array<Output, 5> described = outputs_of({}, count, lights.count());
    for (std::size_t i = 0; i < buffers.size(); ++i)
        if (wants[i]) buffers[i].reserve(session, described[i].bytes);
    LightsOnHost made;
    made.statistics = technique.run_light_table(
        triangles, points, lights,
        {buffers[0].get(), buffers[1].get(), buffers[2].get(), buffers[3].get(), buffers[4].get(), wanted.cosines},
        options);
    const auto read = [&]<typename T>(std::size_t i, std::vector<T>& to) {
        if (!wants[i]) return;
        to.resize(described[i].bytes / sizeof(T));
        if (!to.empty()) session.read(buffers[i].get(), to.data(), described[i].bytes);
    };
    read(0, made.bits);
    read(1, made.counts);
    read(2, made.sums);
    read(3, made.first_lit);
    read(4, made.last_lit);
    return made;
}

}  // namespace gnomon
