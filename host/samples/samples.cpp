// SPDX-License-Identifier: MIT
// Several samples per pixel: patterns, batches, and the mean.
#include "samples/samples.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "query/statistics.hpp"
#include "technique/lent_stages.hpp"

namespace gnomon {
namespace {

// The buffers of this number of points, with visibility and the trace's buffers, take about half a gigabyte.
constexpr std::size_t largest_batch = std::size_t{1} << 23;

// Direct3D's standard patterns: x and y of each sample, in its sixteenths of a pixel.
constexpr std::array direct3d_4 = {-2, -6, 6, -2, -6, 2, 2, 6};
constexpr std::array direct3d_8 = {1, -3, -1, 3, 5, 1, -3, -5, -5, 5, -7, -1, 3, 7, 7, -7};
constexpr std::array direct3d_16 = {1,  1, -1, -3, -3, 2,  4,  -1, -5, -2, 2, 5,  5, 3, 3,  -5,
                                    -2, 6, 0,  -7, -4, -6, -6, 4,  -8, 0,  7, -4, 6, 7, -7, -8};

template <std::size_t N>
constexpr std::array<SampleOffset, N / 2> from_sixteenths(const std::array<int, N>& sixteenths) {
    std::array<SampleOffset, N / 2> pattern{};
    for (std::size_t i = 0; i < N / 2; ++i)
        pattern[i] = {sixteenths[2 * i] * SAMPLE_UNITS / 16, sixteenths[2 * i + 1] * SAMPLE_UNITS / 16};
    return pattern;
}

// Hammersley's points in base 2, in the middle of their strata: ((i + 1/2) / 32, (reversed bits of i + 1/2) / 32).
constexpr std::array<SampleOffset, 32> hammersley_32() {
    std::array<SampleOffset, 32> pattern{};
    for (int i = 0; i < 32; ++i) {
        int reversed = 0;
        for (int bit = 0; bit < 5; ++bit) reversed |= (i >> bit & 1) << (4 - bit);
        pattern[static_cast<std::size_t>(i)] = {2 * i + 1 - 32, 2 * reversed + 1 - 32};
    }
    return pattern;
}

constexpr std::array<SampleOffset, 1> pattern_1{};
constexpr auto pattern_4 = from_sixteenths(direct3d_4);
constexpr auto pattern_8 = from_sixteenths(direct3d_8);
constexpr auto pattern_16 = from_sixteenths(direct3d_16);
constexpr auto pattern_32 = hammersley_32();
constexpr std::span<const SampleOffset> patterns[] = {pattern_1, pattern_4, pattern_8, pattern_16, pattern_32};

void add_counts(Statistics& total, const Statistics& batch) {
    for (const auto& [name, count] : batch.counts) {
        const auto found = std::find_if(total.counts.begin(), total.counts.end(),
                                        [&name = name](const auto& entry) { return entry.first == name; });
        if (found == total.counts.end())
            total.counts.emplace_back(name, count);
        else
            found->second += count;
    }
}

// Writes the visibility of some samples' points.
using DecideSamples = std::function<Statistics(const Points& points, const Visibility& visibility)>;

// Makes every sample of every pixel a point: for techniques without fragments, or for `sink` alone (decide empty).
Statistics run_every_sample(const Device& device, const Triangles& triangles, const View& view,
                            std::span<const SampleOffset> pattern, const DecideSamples& decide, const Visibility& mean,
                            std::size_t points_at_once, const SampleSink& sink) {
    cl::Session& session = session_of(device);
    const std::uint64_t before = session.memory_bytes();
    const std::size_t pixels = view.points.count();
    const Camera& camera = view.points.camera()->camera;
    const std::size_t batch = std::clamp<std::size_t>(points_at_once / pixels, 1, pattern.size());
    CameraStage stage(device);
    stage.aim(triangles, camera, view.width, view.height, pattern);
    const cl::Buffer positions(session, batch * pixels * 3 * sizeof(float)),
        receivers(session, batch * pixels * sizeof(cl_uint));
    const Visibility visibility(device, batch * pixels);

    Statistics total;
    for (std::size_t first = 0; first < pattern.size(); first += batch) {
        const std::size_t count = std::min(batch, pattern.size() - first), points_count = count * pixels;
        Statistics part;
        for (std::size_t i = 0; i < count; ++i)
            stage.run(pattern[first + i], view.points.receivers(),
                      {positions.get(), receivers.get(), i * pixels, points_count}, part);
        add_stages(total, part);
        Points points = Points::wrap(device, positions.get(), {0, 1, points_count}, points_count, receivers.get());
        points.set_camera(camera, view.width, view.height);
        if (sink) sink(points);
        if (!decide) continue;
        const Statistics shadow = decide(points, visibility);
        add_stages(total, shadow);
        add_counts(total, shadow);
        const bool is_last = first + count == pattern.size();
        cl::StageTimer timer(session, total, "samples_mean");
        session.launch("samples/samples.cl", "samples_mean", cl::Range::items(pixels),
                       MeanParams{.pixels = cl_uint(pixels),
                                  .samples = cl_uint(count),
                                  .is_first = first == 0,
                                  .scale = is_last ? 1.0f / static_cast<float>(pattern.size()) : 1.0f},
                       visibility.buffer(), mean.buffer());
        total.device_memory_bytes =
            std::max(total.device_memory_bytes, session.memory_bytes() - before + shadow.device_memory_bytes);
    }
    return total;
}

void require_camera(const View& view) {
    if (!view.points.camera()) throw InvalidArgument("samples need a view that a camera has made");
}

std::span<const SampleOffset> require_samples(const View& view, std::uint32_t samples, const Visibility& mean) {
    const std::span<const SampleOffset> pattern = sample_pattern(samples);
    require_camera(view);
    const std::size_t pixels = view.points.count();
    if (mean.count() < pixels)
        throw InvalidArgument("the visibility buffer holds " + std::to_string(mean.count()) + " of " +
                              std::to_string(pixels) + " pixels");
    return pattern;
}

void finish_samples(const Device& device, cl::Clock::time_point start, Statistics& total) {
    session_of(device).finish();
    merge_stages(total);
    total.total_wall_ms = cl::ms_since(start);
}

}  // namespace

std::span<const SampleOffset> sample_pattern(std::uint32_t samples) {
    for (const std::span<const SampleOffset> pattern : patterns)
        if (pattern.size() == samples) return pattern;
    throw InvalidArgument("a pixel has 1, 4, 8, 16 or 32 samples, not " + std::to_string(samples));
}

Statistics run_samples_in_batches(Technique& technique, const Triangles& triangles, const View& view,
                                  const Light& light, std::uint32_t samples, const Visibility& mean,
                                  const SampleSink& sink, std::size_t points_at_once) {
    const std::span<const SampleOffset> pattern = require_samples(view, samples, mean);
    const auto start = cl::Clock::now();
    const Device& device = technique.device();
    const auto run_every = [&](const DecideSamples& decide) {
        return run_every_sample(device, triangles, view, pattern, decide, mean, points_at_once, sink);
    };
    Statistics total;
    auto* lender = dynamic_cast<LendsStages*>(&technique);
    if (lender != nullptr && samples > 1 && triangles.count() != 0) {
        if (sink) run_every({});
        const LentStages stages = lender->lent_stages();
        TracedFootprints footprints(stages.tracer, stages.prepared, triangles, light);
        total = run_fragments(footprints, stages.kept, {device, triangles, view, light, pattern, mean, points_at_once});
    } else {
        total = run_every([&](const Points& points, const Visibility& visibility) {
            return technique.run(triangles, points, light, visibility);
        });
    }
    finish_samples(device, start, total);
    return total;
}

Statistics run_samples(Technique& technique, const Triangles& triangles, const View& view, const Light& light,
                       std::uint32_t samples, const Visibility& mean, const SampleSink& sink) {
    return run_samples_in_batches(technique, triangles, view, light, samples, mean, sink, largest_batch);
}

Statistics run_samples_mean(Technique& technique, const Triangles& triangles, const View& view, const Lights& lights,
                            std::uint32_t samples, const Visibility& mean, const SampleSink& sink) {
    const std::span<const SampleOffset> pattern = require_samples(view, samples, mean);
    const auto start = cl::Clock::now();
    const auto decide = [&](const Points& points, const Visibility& visibility) {
        return run_mean(technique, triangles, points, lights, visibility);
    };
    Statistics total =
        run_every_sample(technique.device(), triangles, view, pattern, decide, mean, view.points.count(), sink);
    finish_samples(technique.device(), start, total);
    return total;
}

struct SampleViews::State {
    Device device;
    View view;
    std::span<const SampleOffset> pattern;
    CameraStage stage;
    cl::Buffer positions, receivers;
};

SampleViews::SampleViews(const Device& device, const Triangles& triangles, const View& view, std::uint32_t samples) {
    const std::span<const SampleOffset> pattern = sample_pattern(samples);
    require_camera(view);
    const std::size_t pixels = view.points.count();
    cl::Session& session = session_of(device);
    state_ = std::make_unique<State>(State{device, view, pattern, CameraStage(device),
                                           cl::Buffer(session, pixels * 3 * sizeof(float)),
                                           cl::Buffer(session, pixels * sizeof(cl_uint))});
    state_->stage.aim(triangles, view.points.camera()->camera, view.width, view.height, pattern);
}

SampleViews::~SampleViews() = default;

std::size_t SampleViews::count() const { return state_->pattern.size(); }

View SampleViews::at(std::size_t i) {
    auto& [device, of, pattern, stage, positions, receivers] = *state_;
    const std::size_t pixels = of.points.count();
    View view;
    view.width = of.width;
    view.height = of.height;
    view.offset = pattern[i];
    view.pixel_share = static_cast<float>(1 / std::sqrt(double(pattern.size())));
    stage.run(view.offset, of.points.receivers(), {positions.get(), receivers.get(), 0, pixels}, view.statistics);
    view.points = Points::wrap(device, positions.get(), {0, 1, pixels}, pixels, receivers.get());
    view.points.set_camera(of.points.camera()->camera, of.width, of.height);
    return view;
}

}  // namespace gnomon
