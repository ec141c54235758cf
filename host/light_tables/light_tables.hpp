// SPDX-License-Identifier: MIT
// Runs over tables of lights through a tree over the triangles, by the method that takes the least time.
#pragma once

#include "light_tables/method_costs.hpp"

namespace gnomon {

class LightTables {
public:
    /// `kept_bytes`: of the buffers that are kept from run to run, here and by others of the same technique.
    LightTables(const Device& device, std::uint64_t& kept_bytes)
        : device_(device), session_(session_of(device)), kept_bytes_(kept_bytes) {}

    /// Decides a table for points and triangles of which there are some. `method`: not one_by_one. `automatic` takes
    /// one light at a time where the tree's methods cannot serve; another method then throws InvalidArgument.
    /// `bundle_lights`: the most lights of a bundle. `one_light`: decides single lights.
    Statistics run(Technique& one_light, const LightsRun& given, LightsMethod method, std::uint32_t bundle_lights);
    /// Frees what is kept.
    void release();

private:
    const SortedPoints& sort_points(const LightsRun& run);
    template <typename Built>
    const Built& kept_of(std::unique_ptr<Built>& kept, const Triangles& triangles);
    void find_field(TableRun& table);
    LightsMethod automatic_method(TableRun& table, bool can_be_bundled);
    void decide(TableRun& table, LightsMethod method, bool is_automatic);

    Device device_;
    cl::Session& session_;
    std::uint64_t& kept_bytes_;
    std::unique_ptr<WideBvh> tree_;
    std::unique_ptr<BuiltHeightField> field_;
    SortedPoints sorted_points_;  ///< of the last run, for their memory
    MethodCache methods_;         ///< as long as the tree is kept
};

}  // namespace gnomon
