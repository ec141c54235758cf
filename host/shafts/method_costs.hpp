// SPDX-License-Identifier: MIT
// The passes of each method that decides a table of lights through the tree, and what they take, measured on samples.
#pragma once

#include "lights/lights_method.hpp"
#include "shafts/shaft_trace.hpp"

namespace gnomon {

/// A run over a table of lights that can be bundled, with what its methods read.
struct TableRun : TreeRun {
    const Triangles& given;  ///< the triangles with the clusters that the caller keeps, if it does
    BundleTables& bundles;
    Technique& one_light;                     ///< decides single lights
    Statistics& statistics;                   ///< receives the stages
    const BuiltHeightField* field = nullptr;  ///< null: the triangles are none, or it was not searched for

    /// The points in the order in which `one_light` takes them; null for the order of the run's points.
    const SortedPoints* order_of_one_light() const { return points.camera() ? nullptr : &sorted; }
};

/// The passes of shafts, point_shafts, rays (on a CPU) or horizons (with a field).
ShaftPasses passes_of(const TableRun& run, LightsMethod method);

/// What shafts, rays, horizons (both on a CPU) or one light after the other would take for the whole run, in ms, as
/// measured on a sample; infinite if there is not enough memory.
double measured_ms(const TableRun& run, LightsMethod method);

}  // namespace gnomon
