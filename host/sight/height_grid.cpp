// SPDX-License-Identifier: MIT
#include "sight/height_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "cl/embedded_files.hpp"
#include "cl/opencl.hpp"
#include "query/inputs.hpp"

namespace gnomon {
namespace {

constexpr const char* lines_file = "sight/sight_lines.cl";

/// A program that has a grid has its kernels before it makes its first program for a device.
[[maybe_unused]] const bool sight_is_embedded = add_embedded_kernels(embedded_kernels_of_sight());

void require(bool holds, const char* text) {
    if (!holds) throw InvalidArgument(text);
}

int floor_divided(int a, int b) { return a / b - int(a % b < 0); }

}  // namespace

void HeightGrid::Release::operator()(cl_mem memory) const { clReleaseMemObject(memory); }

HeightGrid::HeightGrid(const Device& device, std::span<const std::int32_t> heights, std::uint32_t columns)
    : device_(device) {
    require(columns >= 2 && columns <= MAX_GRID_SIDE && heights.size() % columns == 0 &&
                heights.size() / columns >= 2 && heights.size() / columns <= MAX_GRID_SIDE,
            "heights: a grid has 2 to 16384 rows and columns");
    grid_.columns = int(columns);
    grid_.rows = int(heights.size() / columns);
    grid_.patch_columns = (grid_.columns + SIGHT_PATCH - 1) / SIGHT_PATCH;
    grid_.patch_rows = (grid_.rows + SIGHT_PATCH - 1) / SIGHT_PATCH;
    cl::Session& session = session_of(device_);
    share(heights);
    const std::size_t patches = std::size_t(grid_.patch_columns) * std::size_t(grid_.patch_rows);
    patch_tops_.reserve(session, patches * sizeof(cl_int));
    cl::Buffer found;
    session.reserve_filled(found, 0, sizeof(cl_uint));
    session.launch(lines_file, "sight_patches", cl::Range::items(patches), grid_, heights_.get(), patch_tops_, found);
    const auto what = session.read_value<cl_uint>(found);
    require((what & FOUND_WRONG) == 0, "heights: must be below 2^25 steps");
    has_absent_ = (what & FOUND_ABSENT) != 0;
    targets_.reserve(session, has_absent_ ? heights.size() : 1);
    if (!has_absent_) return;
    session.launch(lines_file, "sight_targets", cl::Range::items(heights.size()), cl_ulong(heights.size()),
                   heights_.get(), targets_);
}

// A device that shares the host's memory reads the heights where they are.
void HeightGrid::share(std::span<const std::int32_t> heights) {
    cl::Session& session = session_of(device_);
    if (device_.description().shares_host_memory) {
        cl_int code;
        heights_.reset(clCreateBuffer(session.context(), CL_MEM_USE_HOST_PTR | CL_MEM_READ_ONLY, heights.size_bytes(),
                                      const_cast<std::int32_t*>(heights.data()), &code));
        if (code == CL_SUCCESS) return;
    }
    session.upload(copy_, heights);
    heights_.reset(copy_.get());
    clRetainMemObject(heights_.get());
}

// The box of the targets.
void HeightGrid::set_box(SightGrid& grid, Spans spans) const {
    const auto first = [&](int y) { return spans[2 * std::size_t(y - grid.band_first)]; };
    const auto last = [&](int y) { return spans[2 * std::size_t(y - grid.band_first) + 1]; };
    grid.first_row = grid.band_first;
    grid.last_row = grid.band_last;
    while (grid.first_row < grid.last_row && first(grid.first_row) >= last(grid.first_row)) ++grid.first_row;
    while (grid.last_row > grid.first_row && first(grid.last_row - 1) >= last(grid.last_row - 1)) --grid.last_row;
    grid.last_column = 0;
    grid.first_column = grid.columns;
    for (int y = grid.first_row; y < grid.last_row; ++y) {
        if (first(y) >= last(y)) continue;
        grid.first_column = std::clamp(first(y), 0, grid.first_column);
        grid.last_column = std::clamp(last(y), grid.last_column, grid.columns);
    }
    grid.has_spans = 0;
    for (int y = grid.first_row; y < grid.last_row; ++y)
        if (first(y) > grid.first_column || last(y) < grid.last_column) grid.has_spans = 1;
}

// The grid of an eye, and its targets' box.
SightGrid HeightGrid::grid_of(const Eye& eye, const Band& band, Spans spans) {
    const int width = (grid_.columns - 1) * SUBCELLS, depth = (grid_.rows - 1) * SUBCELLS;
    require(eye.x >= 0 && eye.x <= width && eye.y >= 0 && eye.y <= depth, "eye: must lie over the grid");
    require(std::abs(eye.height) < MAX_GRID_HEIGHT && eye.target_height >= 0 && eye.target_height < MAX_GRID_HEIGHT,
            "eye: heights must be below 2^25 steps");
    SightGrid grid = grid_;
    grid.eye_x = eye.x;
    grid.eye_y = eye.y;
    grid.eye_height = eye.height;
    grid.target_height = eye.target_height;
    grid.band_first = band.first_row;
    grid.band_last = band.last_row;
    set_box(grid, spans);
    session_of(device_).upload(spans_, spans);
    return grid;
}

// Opens the targets.
void HeightGrid::open(const SightGrid& grid, const Band& band) {
    cl::Session& session = session_of(device_);
    answers_.reserve(session, cells_of(band));
    hidden_ = 0;
    session.launch(lines_file, "sight_begin", cl::Range::items(cells_of(band) / 16 + 1), grid, cl_uint(has_absent_),
                   targets_, spans_, answers_);
}

// Opens the targets that the sweep leaves open, and decides the others.
void HeightGrid::sweep(const SightGrid& grid, const Band& band) {
    cl::Session& session = session_of(device_);
    if (hidden_ < cells_of(band)) session.reserve_filled(answers_, SIGHT_HIDDEN, (cells_of(band) + 3) / 4 * 4);
    hidden_ = 0;
    session.launch(lines_file, "sight_under_eye", cl::Range::items(1), grid, heights_.get(), spans_, answers_);
    turn();
    const int wedges_of_group = session.is_cpu() ? int(session.lanes()) - 1 : 1;
    SweepQuadrants quadrants{};
    int groups = 0;
    for (int i = 0; i < 4; ++i) {
        SweepQuadrant& of = quadrants.of[i] = quadrant(grid, i / 2 == 0, i % 2 != 0 ? -1 : 1);
        groups += (of.wedges + wedges_of_group - 1) / wedges_of_group;
        of.end_group = groups;
    }
    if (groups > 0)
        session.launch("sight/sight_sweep.cl", "sight_sweep", cl::Range::shares(std::size_t(groups)), grid, quadrants,
                       heights_.get(), has_columns_ ? by_columns_.get() : heights_.get(), patch_tops_, spans_,
                       answers_);
}

// The quadrant whose lines are rows (or columns) in one direction from the eye. Coordinates are mirrored where they
// fall with the distance, so that a + b is constant along diagonals.
SweepQuadrant HeightGrid::quadrant(const SightGrid& grid, bool is_along_y, int direction) const {
    const int eye_a = direction * (is_along_y ? grid.eye_y : grid.eye_x);
    const int eye_b = direction * (is_along_y ? grid.eye_x : grid.eye_y);
    const int line = floor_divided(eye_a, SUBCELLS), vertex = floor_divided(eye_b, SUBCELLS);
    const int vertices = is_along_y ? grid.columns : grid.rows;
    // From the eye's line or vertex on, the first and the last of a range of columns or rows.
    const auto from_eye = [&](int first, int last, int eye) {
        return direction > 0 ? std::pair(first - eye, last - 1 - eye) : std::pair(1 - last - eye, -first - eye);
    };
    SweepQuadrant of{};
    const int line_stride = is_along_y ? grid.columns : has_columns_ ? grid.rows : 1;
    const int vertex_stride = is_along_y || has_columns_ ? 1 : grid.columns;
    of.line_stride = direction * line_stride;
    of.vertex_stride = direction * vertex_stride;
    of.origin = std::int64_t(line) * of.line_stride + std::int64_t(vertex) * of.vertex_stride;
    std::tie(of.first_line, of.lines) = is_along_y ? from_eye(grid.first_row, grid.last_row, line)
                                                   : from_eye(grid.first_column, grid.last_column, line);
    std::tie(of.first_target_b, of.last_target_b) = is_along_y ? from_eye(grid.first_column, grid.last_column, vertex)
                                                               : from_eye(grid.first_row, grid.last_row, vertex);
    std::tie(of.first_b, of.last_b) = from_eye(0, vertices, vertex);
    of.eye_a = eye_a - line * SUBCELLS;
    of.eye_b = eye_b - vertex * SUBCELLS;
    of.nearest = direction * line;
    of.vertex_of_eye = direction * vertex;
    of.direction = direction;
    of.is_along_y = cl_int(is_along_y);
    of.has_strips = cl_int(session_of(device_).is_cpu() && vertex_stride == 1 && vertices >= STRIP_LENGTH);
    set_wedges(of);
    return of;
}

// The wedges that lie between u = -1 and 1, and of them those that have targets.
void HeightGrid::set_wedges(SweepQuadrant& of) {
    if (of.lines <= 0 || of.first_target_b > of.last_target_b) return;
    constexpr int whole = 1 << U_BITS;
    of.wedge_u = whole / std::max(of.lines, 32);  // so there are 64 wedges or more
    of.first_u = -of.wedge_u * 3 / 8 - whole;     // few rays meet vertices
    of.wedges = (whole - of.first_u - 1) / of.wedge_u + 1;
    of.last_u = of.is_along_y != 0 ? whole - 1 : whole;
    const double near = double(std::max(of.first_line, 1)) - double(of.eye_a) / SUBCELLS;
    const double far = double(of.lines) - double(of.eye_a) / SUBCELLS, eye_b = double(of.eye_b) / SUBCELLS;
    const double low = of.first_target_b - eye_b, high = of.last_target_b - eye_b;
    const double first_u = std::max(low / (low > 0 ? far : near), -1.0),
                 last_u = std::min(high / (high > 0 ? near : far), 1.0);
    const auto wedge_of = [&](double u) { return int(std::floor((u * whole - of.first_u) / of.wedge_u)); };
    constexpr int least = 15;  // a CPU's group has as many
    const int skipped = std::clamp(wedge_of(first_u) - 1, 0, of.wedges - least);
    of.wedges = std::clamp(wedge_of(last_u) + 2 - skipped, least, of.wedges - skipped);
    of.first_u += skipped * of.wedge_u;
}

// From the second sweep on a CPU reads the heights by columns where lines are columns.
void HeightGrid::turn() {
    cl::Session& session = session_of(device_);
    if (!session.is_cpu() || has_columns_ || !std::exchange(has_swept_, true)) return;
    by_columns_.reserve(session, std::size_t(grid_.rows) * std::size_t(grid_.columns) * sizeof(cl_int));
    session.launch(lines_file, "sight_columns",
                   cl::Range::items(std::size_t(grid_.patch_columns) * std::size_t(grid_.patch_rows)), grid_,
                   heights_.get(), by_columns_);
    has_columns_ = true;
}

void HeightGrid::decide(const SightGrid& grid, const Band& band, const SightSum& sum, const cl::Buffer& counts,
                        const cl::Buffer& words) {
    session_of(device_).launch(lines_file, "sight_decide", cl::Range::shares(cells_of(band)), grid, sum, heights_.get(),
                               patch_tops_, answers_, counts, words);
    hidden_ = sum.is_summed != 0 ? cells_of(band) : 0;
}

HeightGrid::Band HeightGrid::checked(const Band& band, Spans spans, std::size_t eyes) const {
    require(band.first_row >= 0 && band.first_row < band.last_row && band.last_row <= grid_.rows,
            "rows: must be some of the grid's");
    require(spans.size() == eyes * 2 * std::size_t(band.last_row - band.first_row),
            "spans: must be two columns for each row, of each eye");
    return band;
}

std::vector<std::uint8_t> HeightGrid::look(const Eye& eye, const Band& band, Spans spans, bool sweeps) {
    cl::Session& session = session_of(device_);
    const cl::Buffer none(session, sizeof(cl_uint));
    const SightGrid grid = grid_of(eye, checked(band, spans, 1), spans);
    sweeps ? sweep(grid, band) : open(grid, band);
    decide(grid, band, {}, none, none);
    return session.read_values<std::uint8_t>(answers_.get(), cells_of(band));
}

std::vector<std::int32_t> HeightGrid::least_heights(const Eye& eye, const Band& band, Spans spans) {
    const SightGrid grid = grid_of(eye, checked(band, spans, 1), spans);
    open(grid, band);
    cl::Session& session = session_of(device_);
    const std::size_t cells = cells_of(band);
    const cl::Buffer least(session, cells * sizeof(cl_int));
    session.launch(lines_file, "sight_heights", cl::Range::shares(cells), grid, heights_.get(), patch_tops_, answers_,
                   least);
    return session.read_values<std::int32_t>(least.get(), cells);
}

HeightGrid::Seen HeightGrid::look_from(std::span<const Eye> eyes, const Band& band, Spans spans, bool wants_words,
                                       const std::function<bool(double)>& progress) {
    checked(band, spans, eyes.size());
    const std::size_t each = 2 * std::size_t(band.last_row - band.first_row), cells = cells_of(band);
    cl::Session& session = session_of(device_);
    cl::Buffer counts, words;
    session.reserve_filled(counts, 0, cells * sizeof(cl_uint));
    if (!wants_words) words.reserve(session, sizeof(cl_uint));
    Seen seen;
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        if (wants_words && i % 32 == 0) session.reserve_filled(words, 0, cells * sizeof(cl_uint));
        const SightGrid grid = grid_of(eyes[i], band, spans.subspan(i * each, each));
        sweep(grid, band);
        decide(grid, band, {1, cl_uint(i % 32), cl_uint(wants_words)}, counts, words);
        if (wants_words && (i % 32 == 31 || i + 1 == eyes.size())) {
            const auto plane = session.read_values<std::uint32_t>(words.get(), cells);
            seen.words.insert(seen.words.end(), plane.begin(), plane.end());
        }
        session.finish();
        if (progress && !progress(double(i + 1) / double(eyes.size()))) throw Cancelled("cancelled");
    }
    seen.counts = session.read_values<std::uint32_t>(counts.get(), cells);
    return seen;
}

}  // namespace gnomon
