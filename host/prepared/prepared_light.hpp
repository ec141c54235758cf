// SPDX-License-Identifier: MIT
// Prepared light: the data that depend on the triangles and the light alone, kept while the points change
// (kernels/prepared/prepared_light.h).
#pragma once

#include "kernels/prepared/prepared_light.h"
#include "occluders/occluder_lists.hpp"
#include "trace/trace.hpp"

namespace gnomon {

class PreparedLight {
public:
    /// Makes all tables. `grid` and `settings` as for a run; `first_capacity`: of growing lists, 0: their default.
    /// Throws as a run does; the object is then unusable.
    PreparedLight(cl::Session& session, Statistics& statistics, const Triangles& triangles, const Light& light,
                  const FrameGrid& grid, const ListSettings& settings, std::uint32_t first_capacity);

    /// False if the grid cannot separate these triangles: then no lists are kept, and every run makes its own lists.
    bool is_usable() const { return is_usable_; }
    bool is_of(const Triangles& triangles, const Light& light) const;

    const LightFrame& light_frame() const { return light_frame_; }
    const cl::Buffer& projections() const { return light_frame_fit_.projections(); }
    const cl::Buffer* map() const { return draws_map_ ? &map_ : nullptr; }
    ListBuffers lists() const { return {tables_, entries_, records_, bounds_, offsets_}; }
    /// On a GPU: the bits of the unshadowed triangles (kernels/prepared/unshadowed_triangles.h).
    std::vector<cl_uint> unshadowed_bits(cl::Session& session) const;
    std::uint64_t bytes() const;
    const FrameCounters& counted() const { return counted_; }  ///< summed over the frames

private:
    void reserve_tables(cl::Session& session, cl_uint triangle_count);
    bool fit(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles);
    PreparedParams params(const TriangleInputs& triangles) const;
    void keep_planes(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles);
    void seek_unshadowed_triangles(cl::Session& session, const TriangleInputs& triangles, cl_uint step);
    void find_unshadowed_triangles(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles);
    void keep(cl::Session& session, Statistics& statistics, const OccluderLists& lists, const FrameCounters& counted,
              cl_uint frame);

    Triangles triangles_;  ///< kept, so that no other buffer can get the same handle
    Light light_;
    LightFrame light_frame_;
    bool draws_map_, is_usable_ = false;
    LightFrameFit light_frame_fit_;
    cl::Buffer tables_;  ///< the ranges of the bins, then the tables
    PreparedTables offsets_{};
    cl::Buffer map_, entries_, records_, bounds_;
    cl_uint entries_kept_ = 0, records_kept_ = 0;  ///< entries in units of BinEntries
    FrameCounters counted_{};
};

}  // namespace gnomon
