// SPDX-License-Identifier: MIT
#include "sight/height_grid.hpp"

#include <algorithm>

#include "kernels/sight/sight_sweep.h"
#include "query/inputs.hpp"

namespace gnomon {
namespace {

constexpr const char* lines_file = "sight/sight_lines.cl";

void require(bool holds, const char* text) {
    if (!holds) throw InvalidArgument(text);
}

int floor_divided(int a, int b) { return a / b - int(a % b < 0); }

}  // namespace

HeightGrid::HeightGrid(const Device& device, std::span<const std::int32_t> heights, std::uint32_t columns)
    : device_(device) {
    require(columns >= 2 && columns <= MAX_GRID_SIDE && heights.size() % columns == 0 &&
                heights.size() / columns >= 2 && heights.size() / columns <= MAX_GRID_SIDE,
            "heights: a grid has 2 to 16384 rows and columns");
    require(std::ranges::all_of(heights, [](int h) { return h == NO_HEIGHT || std::abs(h) < MAX_GRID_HEIGHT; }),
            "heights: must be below 2^25 steps");
    grid_.columns = int(columns);
    grid_.rows = int(heights.size() / columns);
    grid_.patch_columns = (grid_.columns + SIGHT_PATCH - 1) / SIGHT_PATCH;
    grid_.patch_rows = (grid_.rows + SIGHT_PATCH - 1) / SIGHT_PATCH;
    cl::Session& session = session_of(device_);
    session.upload(heights_, heights);
    const std::size_t patches = std::size_t(grid_.patch_columns) * std::size_t(grid_.patch_rows);
    patch_tops_.reserve(session, patches * sizeof(cl_int));
    session.launch(lines_file, "sight_patches", cl::Range::items(patches), grid_, heights_, patch_tops_);
}

// Opens the targets.
SightGrid HeightGrid::begin(const Eye& eye, Spans spans) {
    const int width = (grid_.columns - 1) * SUBCELLS, depth = (grid_.rows - 1) * SUBCELLS;
    require(eye.x >= 0 && eye.x <= width && eye.y >= 0 && eye.y <= depth, "eye: must lie over the grid");
    require(std::abs(eye.height) < MAX_GRID_HEIGHT && eye.target_height >= 0 && eye.target_height < MAX_GRID_HEIGHT,
            "eye: heights must be below 2^25 steps");
    require(spans.size() == 2 * std::size_t(grid_.rows), "spans: must be two columns for each row");
    SightGrid grid = grid_;
    grid.eye_x = eye.x;
    grid.eye_y = eye.y;
    grid.eye_height = eye.height;
    grid.target_height = eye.target_height;
    const auto is_target_row = [&](int y) { return spans[2 * std::size_t(y)] < spans[2 * std::size_t(y) + 1]; };
    grid.last_row = grid.rows;
    while (grid.first_row < grid.rows && !is_target_row(grid.first_row)) ++grid.first_row;
    while (grid.last_row > grid.first_row && !is_target_row(grid.last_row - 1)) --grid.last_row;
    grid.last_column = 0;
    grid.first_column = grid.columns;
    for (int y = grid.first_row; y < grid.last_row; ++y) {
        if (!is_target_row(y)) continue;
        grid.first_column = std::clamp(spans[2 * std::size_t(y)], 0, grid.first_column);
        grid.last_column = std::clamp(spans[2 * std::size_t(y) + 1], grid.last_column, grid.columns);
    }
    cl::Session& session = session_of(device_);
    session.upload(spans_, spans);
    answers_.reserve(session, cells());
    session.launch(lines_file, "sight_begin", cl::Range::items(cells()), grid, heights_, spans_, answers_);
    return grid;
}

// The quadrant whose lines are rows (or columns) in one direction from the eye. Coordinates are mirrored where they
// fall with the distance, so that a + b is constant along diagonals.
void HeightGrid::sweep(const SightGrid& grid, bool is_along_y, int direction) {
    const int eye_a = direction * (is_along_y ? grid.eye_y : grid.eye_x);
    const int eye_b = direction * (is_along_y ? grid.eye_x : grid.eye_y);
    const int line = floor_divided(eye_a, SUBCELLS), vertex = floor_divided(eye_b, SUBCELLS);
    const int last_vertex = (is_along_y ? grid.columns : grid.rows) - 1;
    const int first_target = is_along_y ? grid.first_row : grid.first_column;
    const int last_target = (is_along_y ? grid.last_row : grid.last_column) - 1;
    SweepQuadrant of{};
    of.line_stride = direction * (is_along_y ? grid.columns : 1);
    of.vertex_stride = direction * (is_along_y ? 1 : grid.columns);
    of.origin = line * of.line_stride + vertex * of.vertex_stride;
    of.lines = (direction > 0 ? last_target : -first_target) - line;
    if (of.lines <= 0) return;
    of.first_b = (direction > 0 ? 0 : -last_vertex) - vertex;
    of.last_b = (direction > 0 ? last_vertex : 0) - vertex;
    of.wedges = std::max(2 * of.lines, 64);
    of.eye_a = float(eye_a - line * SUBCELLS) / SUBCELLS;
    of.eye_b = float(eye_b - vertex * SUBCELLS) / SUBCELLS;
    of.wedge_u = 2.0f / float(of.wedges);
    of.first_u = -1.0f + 0.63f * of.wedge_u;  // simple quotients, which many targets have, lie inside wedges
    of.wedges -= 1;  // the last one ends below 1: a ray crosses one edge of constant b per line
    of.nearest = direction * line;
    of.vertex_of_eye = direction * vertex;
    of.direction = direction;
    const std::size_t groups = (std::size_t(of.wedges) + SWEEP_WEDGES - 1) / SWEEP_WEDGES;
    session_of(device_).launch("sight/sight_sweep.cl", "sight_sweep", cl::Range::shares(groups), grid, of, heights_,
                               patch_tops_, answers_);
}

void HeightGrid::decide(const SightGrid& grid, bool sweeps) {
    if (sweeps)
        for (const bool is_along_y : {false, true})
            for (const int direction : {1, -1}) sweep(grid, is_along_y, direction);
    const std::size_t targets = std::size_t(grid.last_row - grid.first_row) * std::size_t(grid.columns);
    session_of(device_).launch(lines_file, "sight_decide", cl::Range::shares(targets), grid, heights_, patch_tops_,
                               answers_);
}

std::vector<std::uint8_t> HeightGrid::look(const Eye& eye, Spans spans, bool sweeps) {
    decide(begin(eye, spans), sweeps);
    return session_of(device_).read_values<std::uint8_t>(answers_.get(), cells());
}

std::vector<std::int32_t> HeightGrid::least_heights(const Eye& eye, Spans spans) {
    const SightGrid grid = begin(eye, spans);
    cl::Session& session = session_of(device_);
    const cl::Buffer least(session, cells() * sizeof(cl_int));
    session.launch(lines_file, "sight_heights", cl::Range::shares(cells()), grid, heights_, patch_tops_, answers_,
                   least);
    return session.read_values<std::int32_t>(least.get(), cells());
}

HeightGrid::Seen HeightGrid::look_from(std::span<const Eye> eyes, Spans spans, bool wants_words,
                                       const std::function<bool(double)>& progress) {
    const std::size_t each = 2 * std::size_t(grid_.rows);
    require(spans.size() == each * eyes.size(), "spans: must be those of each eye");
    cl::Session& session = session_of(device_);
    cl::Buffer counts, words;
    session.reserve_filled(counts, 0, cells() * sizeof(cl_uint));
    if (!wants_words) words.reserve(session, sizeof(cl_uint));
    Seen seen;
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        if (wants_words && i % 32 == 0) session.reserve_filled(words, 0, cells() * sizeof(cl_uint));
        decide(begin(eyes[i], spans.subspan(i * each, each)), true);
        session.launch(lines_file, "sight_add", cl::Range::items(cells()), cl_ulong(cells()), cl_uint(i % 32),
                       cl_uint(wants_words), answers_, counts, words);
        if (wants_words && (i % 32 == 31 || i + 1 == eyes.size())) {
            const auto plane = session.read_values<std::uint32_t>(words.get(), cells());
            seen.words.insert(seen.words.end(), plane.begin(), plane.end());
        }
        session.finish();
        if (progress && !progress(double(i + 1) / double(eyes.size()))) throw Cancelled("cancelled");
    }
    seen.counts = session.read_values<std::uint32_t>(counts.get(), cells());
    return seen;
}

}  // namespace gnomon
