// SPDX-License-Identifier: MIT
// The passes of each method that decides a table of lights through the BVH, and their times, measured on samples.
#pragma once

#include "light_tables/beam_trace.hpp"
#include "lights/lights_method.hpp"

namespace gnomon {

/// A run over lights that can be bundled, with the inputs of its methods.
struct TableRun {
    BvhRun run;
    const Triangles& given;  ///< the triangles, with clusters if the caller keeps them
    BundleTables& bundles;
    Technique& one_light;                     ///< decides single lights
    Statistics& statistics;                   ///< receives the stages
    const BuiltHeightField* field = nullptr;  ///< null: the triangles are no height field, or no field was searched for
    const BuiltRaster* raster = nullptr;      ///< null: they are no raster, or none was searched for
    RasterPoints at{};                        ///< with a raster, the vertices of the sorted points

    /// The points in the order in which `one_light` takes them; null for the order of the run's points.
    const SortedPoints* order_of_one_light() const { return run.points.camera() ? nullptr : &run.sorted; }
};

/// Calls `find`, which finds out something that makes a choice better; without memory the choice goes without it.
void if_there_is_memory(const auto& find) {
    try {
        find();
    } catch (const OutOfDeviceMemory&) {
    }
}

/// Runs the passes of beams, point_beams, rays (on a CPU) or horizons (with a field) over the table's points, or over a
/// sample of them, and over all of the method's bundles, or some.
BeamPasses passes_of(LightsMethod method, const TableRun& table, const BvhRun& run, const LightBundles* some = nullptr);

/// Decides the table by sweeps over its raster, as many lights at a time as their answers have room for.
void run_sweeps(const TableRun& table);

/// The times in ms that these methods (beams, point beams, rays and horizons on a CPU, beams on a GPU, one light after
/// the other) would take for the whole run, estimated from samples; infinite if there is not enough memory.
LightsCosts measured_costs(std::span<const LightsMethod> methods, const TableRun& table);

}  // namespace gnomon
