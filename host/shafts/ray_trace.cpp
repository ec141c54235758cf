// SPDX-License-Identifier: MIT
#include "shafts/ray_trace.hpp"

namespace gnomon {

RayPasses::RayPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics)
    : run_(run),
      session_(session_of(run.device)),
      statistics_(statistics),
      masks_(run, bundles, statistics),
      tree_(session_, run.tree) {
    masks_.reserve(most_mask_bytes(session_) / masks_.bytes_per_point());
}

void RayPasses::run() {
    const std::size_t count = run_.points.count(), lights = run_.lights.count();
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        masks_.face(part);
        for (std::uint32_t slot = 0; slot < lights; ++slot) {
            trace(part, slot);
            const double done = double(part.first) + double(part.count) * (slot + 1) / double(lights);
            report_progress(run_.options, done / double(count));
        }
        masks_.add_to(sums, part);
    }
    sums.finish();
    masks_.describe(statistics_.counts);
}

// Of the light in one of the bundles' slots.
void RayPasses::trace(const PointPart& part, std::uint32_t slot) {
    const LightAxes axes = axes_of_light(run_.lights.lights()[masks_.slots()[slot]]);
    {
        const cl::StageTimer timer(session_, statistics_, "light_tree");
        tree_.turn_to(axes);
    }
    masks_.trace(part, "ray_trace", [&] {
        const ShaftParams of_part = masks_.params_of(part);
        const RayParams params{.points = of_part.points,
                               .axes = axes,
                               .bundle = slot / MOST_BUNDLE_LIGHTS,
                               .light = slot % MOST_BUNDLE_LIGHTS,
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
