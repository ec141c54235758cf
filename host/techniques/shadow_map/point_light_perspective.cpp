// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/point_light_perspective.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "techniques/shadow_map/point_light_perspective.cl";

}  // namespace

void PointLightPerspective::run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs,
                                const cl::Buffer& planned, const cl::Buffer& bounds) {
    const cl_uint count = inputs.points.layout.count;
    WarpSampling sampling{};
    sampling.stride = count / WARP_SAMPLES | 1u;  // odd: not in step with the picture's rows
    sampling.sample_count = (count + sampling.stride - 1) / sampling.stride;
    const std::size_t choices = std::size_t(plan.view_count) * WARP_DIRECTIONS * WARP_CHOICES;
    samples_.reserve(session, sampling.sample_count * 3 * sizeof(float));
    faces_.reserve(session, sampling.sample_count * sizeof(cl_uint));
    costs_.reserve(session, choices * sizeof(float));
    session.launch(file, "point_light_perspective_samples", cl::Range::items(sampling.sample_count), plan, sampling,
                   inputs.points.layout, inputs.points.positions, inputs.visibility, planned, samples_, faces_);
    session.launch(file, "point_light_perspective_costs", cl::Range::items(choices), plan, sampling, samples_, faces_,
                   bounds, costs_);
    session.launch(file, "point_light_perspective_warp", cl::Range::items(plan.view_count), plan, costs_, bounds,
                   planned);
}

}  // namespace gnomon
