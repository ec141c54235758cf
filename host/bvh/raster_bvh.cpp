// SPDX-License-Identifier: MIT
// Stage raster_bvh: the BVH over an implicit raster, whose leaves are patches of squares (kernels/bvh/raster_bvh.h).
#include "kernels/bvh/raster_bvh.h"

#include "bvh/wide_bvh.hpp"
#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

std::uint32_t over(std::uint32_t count, std::uint32_t each) { return (count + each - 1) / each; }

// The levels from the lowest one up. On a GPU children lie 8 x 4, then 4 x 8, so that boxes are about square.
std::vector<RasterBvhParams> levels_over(const ImplicitRaster& raster, bool is_cpu) {
    std::vector<RasterBvhParams> levels;
    std::uint32_t columns = over(raster.columns() - 1, PATCH_COLUMNS);
    std::uint32_t rows = over(raster.rows() - 1, is_cpu ? PATCH_ROWS_ON_CPU : PATCH_ROWS_ON_GPU);
    do {
        const bool is_even = levels.size() % 2 == 0;
        RasterBvhParams level{};
        level.are_leaves = levels.empty() ? 1 : 0;
        level.children_across = is_cpu || !is_even ? 4 : 8;
        level.children_down = is_cpu || is_even ? 4 : 8;
        level.child_columns = columns;
        level.child_rows = rows;
        level.columns = columns = over(columns, level.children_across);
        level.rows = rows = over(rows, level.children_down);
        levels.push_back(level);
    } while (columns * rows != 1);
    return levels;
}

}  // namespace

void WideBvh::build_over(const ImplicitRaster& raster) {
    cl::Session& session = session_of(device_);
    largest_coordinate_ = raster.largest_coordinate();
    if (!(largest_coordinate_ <= BVH_MAX_COORDINATE)) return;
    const std::uint32_t width = bvh_width(session);
    std::vector<RasterBvhParams> levels = levels_over(raster, session.is_cpu());
    leaf_count_ = levels.front().child_columns * levels.front().child_rows;
    levels_ = {0};
    for (std::size_t i = levels.size(); i-- != 0;) {
        levels[i].first = levels_.back();
        levels_.push_back(levels_.back() + levels[i].columns * levels[i].rows);
        if (i != 0) levels[i].child_first = levels_.back();
    }
    nodes_.reserve(session, levels_.back() * std::size_t(BVH_NODE_ROWS * width) * sizeof(float));
    for (const RasterBvhParams& level : levels)
        session.launch("bvh/raster_bvh.cl", "raster_nodes", cl::Range::items(std::size_t(level.columns) * level.rows),
                       level, raster.memory(), nodes_);
    max_groups_ = session.many_groups();
    const std::size_t slots =
        session.is_cpu() ? session.compute_units() * session.work_group_size() : session.many_groups();
    leaves_.reserve(session, slots * RASTER_SLOT_ROWS * width * sizeof(float));
}

}  // namespace gnomon
