// SPDX-License-Identifier: MIT
// Runs over tables of lights through a BVH over the triangles, by the method that takes the least time.
#pragma once

#include "light_tables/method_costs.hpp"

namespace gnomon {

class LightTables {
public:
    /// `kept_bytes`: the bytes of all buffers that the technique keeps from run to run; this object adds its own.
    LightTables(const Device& device, std::uint64_t& kept_bytes)
        : device_(device), session_(session_of(device)), kept_bytes_(kept_bytes) {}

    /// Decides a table of lights; points, triangles and lights must not be empty. `method`: not one_by_one. Where the
    /// BVH's methods cannot decide the table, `automatic` decides one light at a time, and another method throws
    /// InvalidArgument. `bundle_lights`: the largest number of lights in a bundle. `one_light`: decides single lights.
    Statistics run(Technique& one_light, const LightsRun& given, LightsMethod method, std::uint32_t bundle_lights);
    /// Whether run() by `automatic` needs the BVH; else the technique decides this run one light at a time at once.
    static bool wants_tree(const LightsRun& given);
    /// Frees the BVH, the height field, the raster and the memory of the sorted points.
    void release();

private:
    const SortedPoints& sort_points(const LightsRun& run);
    template <typename Built>
    const Built& kept_of(std::unique_ptr<Built>& kept, const Triangles& triangles);
    void find_field(TableRun& table);
    void find_raster(TableRun& table);
    void require_raster(TableRun& table);
    void release_raster(TableRun& table);
    LightsMethod automatic_method(TableRun& table, bool can_be_bundled);
    void decide(TableRun& table, LightsMethod method, bool is_automatic);

    Device device_;
    cl::Session& session_;
    std::uint64_t& kept_bytes_;
    std::unique_ptr<WideBvh> tree_;
    std::unique_ptr<BuiltHeightField> field_;
    std::unique_ptr<BuiltRaster> raster_;
    SortedPoints sorted_points_;  ///< the last run's, whose memory the next run uses
    MethodCache methods_;         ///< valid as long as the BVH is kept
};

}  // namespace gnomon
