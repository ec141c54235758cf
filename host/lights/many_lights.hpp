// SPDX-License-Identifier: MIT
// A run over many lights: its inputs checked, its outputs, and the ways to decide the masks of bundles.
#pragma once

#include "api/inputs.hpp"
#include "kernels/lights/light_sums.h"
#include "lights/light_bundles.hpp"
#include "lights/shaft_tree.hpp"

namespace gnomon {

/// Throws InvalidArgument unless a run can read these inputs, use these options and write these outputs.
void require_lights_run(const Device& device, const Triangles& triangles, const Points& points, const Lights& lights,
                        const LightsOutputs& outputs, const LightsOptions& options);

/// The outputs of a run while masks are added to them.
class LightSums {
public:
    /// `slots`: MOST_BUNDLE_LIGHTS per bundle, the index of each slot's light, or no_light.
    LightSums(cl::Session& session, const Lights& lights, std::span<const std::uint32_t> slots,
              const LightsOutputs& outputs, const LightsOptions& options, std::size_t point_count);
    /// Masks of a part of the points and of some bundles. `order`: the points' numbers, null if a point's index is its
    /// number. `normals`: of all points in the same order, null if no cosines are wanted.
    void add(const cl::Buffer& masks, std::size_t mask_stride, std::size_t first_point, std::size_t point_count,
             std::uint32_t first_bundle, std::uint32_t bundle_count, const cl::Buffer* order, cl_mem normals,
             const PointLayout& normals_at = {});
    void finish();
    bool wants_cosines() const { return (params_.wants & WANTS_COSINES) != 0; }

private:
    cl::Session& session_;
    LightsOutputs outputs_;
    LightSumsParams params_{};
    std::size_t point_count_;
    cl::Buffer slots_, tables_, none_;
};

/// The time of one light of the table, for all points, in ms: the second of two runs, since the first may wait for
/// kernels' builds.
double time_of_one_light(Technique& technique, const Triangles& triangles, const Points& points, const Lights& lights);

/// `triangles` with clusters, if they are worth it for a run over many lights and the caller keeps none.
Triangles with_clusters(const Device& device, const Triangles& triangles);

/// Calls the progress function, if there is one; throws Cancelled if it returns false.
void report_progress(const LightsOptions& options, double done);

/// A run by shafts (kernels/lights/shaft.h).
struct ShaftRun {
    const Device& device;
    const Triangles& triangles;
    const Points& points;
    const Lights& lights;
    const LightsOutputs& outputs;
    const LightsOptions& options;
    const BuiltShaftTree& tree;
    std::uint32_t bundle_lights;
    std::optional<double> one_light_ms{};  ///< if given, the run is refused where one light at a time takes less time
};
/// False, and no output is written, if shafts cannot decide these lights (a point light among them, or coordinates out
/// of the filter's range), or would take longer than one light at a time. Adds its stages and counts to `statistics`.
bool run_shafts(const ShaftRun& run, Statistics& statistics);

}  // namespace gnomon
