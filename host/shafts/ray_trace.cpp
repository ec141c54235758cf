// SPDX-License-Identifier: MIT
#include "shafts/ray_trace.hpp"

#include <cmath>

namespace gnomon {

RayPasses::RayPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics)
    : run_(run),
      session_(session_of(run.device)),
      statistics_(statistics),
      masks_(run, bundles, statistics),
      tree_(session_, run.tree) {
    masks_.reserve(most_mask_bytes(session_) / masks_.bytes_per_point());
}

RayPasses::Times RayPasses::timed(std::uint32_t light) {
    const auto timed = [&](auto&& work) {
        const double builds_ms = session_.build_ms();
        session_.finish();
        const auto start = cl::Clock::now();
        work();
        session_.finish();
        return cl::ms_since(start) - (session_.build_ms() - builds_ms);
    };
    Times times{timed([&] { turn_tree(light); }), 0};
    for (PointPart part{0, 0}; part.first < run_.points.count(); part.first += part.count) {
        part.count = std::min(masks_.most_points(), run_.points.count() - part.first);
        masks_.face(part);
        times.trace_ms += timed([&] { trace(part, light); });
    }
    return times;
}

double estimated_rays_ms(const TreeRun& run, double limit_ms, Statistics& statistics) {
    const cl::Session& session = session_of(run.device);
    // A GPU takes as long for a few points as for many.
    const std::size_t count = run.points.count(), lights = run.lights.count(), share = session.is_cpu() ? 16 : 1;
    const SampledRun sample(run, share, sampled_lights(lights));
    const auto bundles = make_plain_bundles(sample.run().lights.lights());
    RayPasses passes(sample.run(), *bundles, statistics);
    const std::size_t most_points = most_mask_bytes(session) / ((lights + 31) / 32 * sizeof(cl_uint));
    const double parts = std::ceil(double(count) / double(most_points)), whole = double(count) / double(sample.count());
    double ms = 0, measured = 0;
    for (std::uint32_t light = 0; light < sample.run().lights.count(); ++light) {
        const RayPasses::Times times = passes.timed(light);
        ms += (times.turn_ms * parts + times.trace_ms * whole) * double(lights);
        if (ms > 2 * limit_ms * ++measured) break;
    }
    return ms / measured;
}

void RayPasses::run() {
    const std::size_t count = run_.points.count(), lights = run_.lights.count();
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        masks_.face(part);
        for (std::uint32_t light = 0; light < lights; ++light) {
            turn_tree(light);
            trace(part, light);
            const double done = double(part.first) + double(part.count) * (light + 1) / double(lights);
            report_progress(run_.options, done / double(count));
        }
        masks_.add_to(sums, part);
    }
    sums.finish();
    masks_.describe(statistics_.counts);
}

void RayPasses::turn_tree(std::uint32_t light) {
    const cl::StageTimer timer(session_, statistics_, "light_tree");
    tree_.turn_to(axes_of_light(run_.lights.lights()[light]));
}

// Of the light to which the tree is turned.
void RayPasses::trace(const PointPart& part, std::uint32_t light) {
    masks_.trace(part, "ray_trace", [&] {
        const ShaftParams of_part = masks_.params_of(part);
        const RayParams params{.points = of_part.points,
                               .axes = axes_of_light(run_.lights.lights()[light]),
                               .bundle = light / MOST_BUNDLE_LIGHTS,
                               .light = light % MOST_BUNDLE_LIGHTS,
                               .mask_stride = of_part.mask_stride,
                               .queue_capacity = of_part.queue_capacity,
                               .rounding = of_part.rounding,
                               .padding = 0};
        const std::size_t tasks = (part.count + RAYS_OF_TASK - 1) / RAYS_OF_TASK;
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        session_.launch(triangles.kernel("shafts/ray_trace.cl", "ray_trace"), shaft_range(session_, tasks), params,
                        masks_.bundles(), tree_.nodes(), tree_.leaves(), run_.tree.leaves(), run_.tree.ids(),
                        run_.sorted.positions(), run_.sorted.receivers(), masks_.masks(), masks_.queue(),
                        masks_.counters(), cl::LocalBytes{SHAFT_LOCAL_WORDS * sizeof(cl_uint)});
    });
}

}  // namespace gnomon
