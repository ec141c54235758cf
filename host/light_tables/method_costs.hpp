// SPDX-License-Identifier: MIT
// The passes of each method that decides a table of lights through the tree, and what they take, measured on samples.
#pragma once

#include "light_tables/beam_trace.hpp"
#include "lights/lights_method.hpp"

namespace gnomon {

/// A run over lights that can be bundled, with what its methods read.
struct TableRun {
    BvhRun run;
    const Triangles& given;  ///< the triangles with the clusters that the caller keeps, if it does
    BundleTables& bundles;
    Technique& one_light;                     ///< decides single lights
    Statistics& statistics;                   ///< receives the stages
    const BuiltHeightField* field = nullptr;  ///< null: the triangles are none, or it was not searched for

    /// The points in the order in which `one_light` takes them; null for the order of the run's points.
    const SortedPoints* order_of_one_light() const { return run.points.camera() ? nullptr : &run.sorted; }
};

/// The passes of beams, point_beams, rays (on a CPU) or horizons (with a field) for the table's run, or for a sample
/// of it.
BeamPasses passes_of(LightsMethod method, const TableRun& table, const BvhRun& run);

/// What beams, rays, horizons (both on a CPU) or one light after the other would take for the whole run, in ms, as
/// measured on a sample; infinite if there is not enough memory.
double measured_ms(LightsMethod method, const TableRun& table);

}  // namespace gnomon
