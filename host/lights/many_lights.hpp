// SPDX-License-Identifier: MIT
// A run over many lights: the check of its inputs, its outputs, and one light at a time.
#pragma once

#include "kernels/lights/light_sums.h"
#include "lights/light_bundles.hpp"
#include "lights/point_order.hpp"
#include "query/inputs.hpp"

namespace gnomon {

/// The options of a run over many lights, as a technique takes them.
struct LightsOptions : FacingInputs {
    bool cosines = false;  ///< as in LightsOutputs
    std::function<bool(double)> progress{};
};

struct LightsRun {
    const Device& device;
    const Triangles& triangles;
    const Points& points;
    const Lights& lights;
    const LightsOutputs& outputs;
    const LightsOptions& options;
};

/// Throws InvalidArgument unless a run can read these inputs, use these options and write these outputs.
void require_lights_run(const LightsRun& run);

/// The outputs of a run while masks are added to them.
class LightSums {
public:
    /// Clears the outputs. `slots`: MAX_BUNDLE_LIGHTS per bundle, the index of each slot's light, or no_light.
    /// `sorted`: the points in the order of the masks, null if that is the order of the run's points.
    LightSums(const LightsRun& run, std::span<const std::uint32_t> slots, const SortedPoints* sorted);
    /// Adds masks of the points [first_point, first_point + point_count).
    void add(const cl::Buffer& masks, std::size_t mask_stride, std::size_t first_point, std::size_t point_count,
             std::uint32_t first_bundle, std::uint32_t bundle_count);
    void finish();

private:
    void want(cl_mem output, std::uint32_t flag, std::uint32_t cleared, std::size_t words);

    cl::Session& session_;
    LightsOutputs outputs_;
    LightSumsParams params_{};
    std::size_t point_count_;
    cl_mem order_, normals_;
    cl::Buffer slots_, tables_, none_;
};

/// Returns `triangles` with clusters, if a run over many lights gains by them and the caller keeps none.
Triangles with_clusters(const Device& device, const Triangles& triangles);

/// Decides one light at a time. `sorted`: the points in the order in which the technique takes them; null for the order
/// of the run's points. Adds its stages to `statistics`.
void run_one_by_one(Technique& technique, const LightsRun& run, const SortedPoints* sorted, Statistics& statistics);

/// Calls the progress function, if there is one; throws Cancelled if it returns false.
void report_progress(const LightsOptions& options, double done);

}  // namespace gnomon
