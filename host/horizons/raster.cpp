// SPDX-License-Identifier: MIT
#include "horizons/raster.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/horizons/height_field.h"
#include "lists/morton.hpp"
#include "occluders/clusters.hpp"
#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "horizons/raster.cl";
// Columns that are farther than this from even ones, in spacings, make no raster.
constexpr double largest_unevenness = 0.01;

double side_of(const std::array<float, 9>& triangle, std::uint32_t axis) {
    const auto [low, high] = std::minmax({triangle[axis], triangle[3 + axis], triangle[6 + axis]});
    return double(high) - low;
}

// Half of a rectangle: its corners have two places along the axis.
bool has_two_places(const std::array<float, 9>& triangle, std::uint32_t axis) {
    const float a = triangle[axis], b = triangle[3 + axis], c = triangle[6 + axis];
    return (a == b) + (b == c) + (c == a) == 1;
}

// At most three of four squares are holes: else a raster takes much more memory than its triangles.
constexpr std::size_t squares_of_one = 4;

// The numbers of squares along both axes, near the wanted ones: those whose product is `squares` if there are some.
std::array<std::uint32_t, 2> sides_near(double wanted_columns, double wanted_rows, std::uint32_t squares) {
    const auto near = static_cast<std::int64_t>(std::llround(wanted_columns));
    for (const std::int64_t away : {0, 1, -1, 2, -2}) {
        const std::int64_t columns = near + away;
        if (columns < 1 || squares % columns != 0) continue;
        const std::uint32_t rows = squares / static_cast<std::uint32_t>(columns);
        if (std::abs(rows - wanted_rows) < 2.5) return {static_cast<std::uint32_t>(columns), rows};
    }
    return {static_cast<std::uint32_t>(near), static_cast<std::uint32_t>(std::llround(wanted_rows))};
}

}  // namespace

BuiltRaster::BuiltRaster(const Device& device, const Triangles& triangles) : device_(device), triangles_(triangles) {
    if (triangles.count() < 2 || has_cut_outs(triangles)) return;
    params_.triangles = implicit_inputs(triangles);
    const ImplicitRaster* implicit = Internals::raster(triangles);
    if (implicit != nullptr ? take(*implicit) : set_places() && find_vertices()) measure();
    if (is_raster() && unevenness_ <= largest_unevenness) {
        copy_heights();
    } else {
        diagonals_ = 0;
        x_ = {}, y_ = {}, heights_ = {};
    }
    squares_ = {};
}

// Rows and columns, by the box of all triangles and the sides of the first one.
bool BuiltRaster::set_places() {
    cl::Session& session = session_of(device_);
    const TriangleInputs inputs = triangle_inputs(triangles_);
    const auto box = box_of_triangles(session, inputs);
    if (!box || box->finite != params_.triangles.count || !(box->largest() <= FIELD_LARGEST_COORDINATE)) return false;
    std::array<float, 9> first;
    session.read(inputs.vertices, first.data(), sizeof(first), inputs.first_float * sizeof(float));
    double flattest = HUGE_VAL;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t x = (axis + 1) % 3, y = (axis + 2) % 3;
        const double height = box->high[axis] - box->low[axis];
        if (height >= flattest || !has_two_places(first, x) || !has_two_places(first, y)) continue;
        const double width = box->high[x] - box->low[x], depth = box->high[y] - box->low[y];
        const double wanted[2] = {width / side_of(first, x), depth / side_of(first, y)};
        if (!(std::max(wanted[0], wanted[1]) < MAX_RASTER_SIDE - 2)) continue;
        const auto [columns, rows] = sides_near(wanted[0], wanted[1], params_.triangles.count / 2);
        const std::size_t squares = std::size_t(columns) * rows;
        if (params_.triangles.count > 2 * squares || params_.triangles.count * squares_of_one < 2 * squares) continue;
        flattest = height;
        params_.axis = axis;
        params_.columns = columns + 1;
        params_.rows = rows + 1;
        params_.corner[0] = float(box->low[x]);
        params_.corner[1] = float(box->low[y]);
        spacing_[0] = width / columns;
        spacing_[1] = depth / rows;
        for (int c = 0; c < 2; ++c) params_.per_length[c] = float(1 / spacing_[c]);
        copies_.lowest = float(box->low[axis]);
        highest_ = height;
    }
    return flattest < HUGE_VAL;
}

bool BuiltRaster::find_vertices() {
    cl::Session& session = session_of(device_);
    const cl_mem vertices = triangle_inputs(triangles_).vertices;
    constexpr cl_uint nan = 0xFFFFFFFFu;
    session.reserve_filled(x_, nan, params_.columns * sizeof(float));
    session.reserve_filled(y_, nan, params_.rows * sizeof(float));
    session.reserve_filled(heights_, nan, vertex_count() * sizeof(float));
    cl::Buffer found;
    session.reserve_filled(squares_, 0, vertex_count() * sizeof(cl_uint));
    session.reserve_filled(found, 0, sizeof(cl_uint));
    session.launch(file, "raster_corners", cl::Range::items(3 * std::size_t(params_.triangles.count)), params_,
                   vertices, x_, y_, heights_);
    session.launch(file, "raster_check", cl::Range::items(params_.triangles.count), params_, vertices, x_, y_, heights_,
                   squares_, found);
    const auto what = session.read_value<cl_uint>(found);
    if (what == RASTER_RISES || what == RASTER_FALLS) diagonals_ = what;
    const std::size_t squares = std::size_t(params_.columns - 1) * (params_.rows - 1);
    copies_.has_holes = params_.triangles.count != 2 * squares ? 1 : 0;
    if (is_raster() && copies_.has_holes != 0)
        session.launch(file, "raster_fill", cl::Range::items(params_.columns), params_, heights_);
    return is_raster();
}

// What set_places() and find_vertices() find.
bool BuiltRaster::take(const ImplicitRaster& implicit) {
    const bool is_small = std::max(implicit.columns(), implicit.rows()) < MAX_RASTER_SIDE;
    if (!is_small || !(implicit.largest_coordinate() <= FIELD_LARGEST_COORDINATE)) return false;
    params_.axis = 2;
    params_.columns = implicit.columns();
    params_.rows = implicit.rows();
    const std::size_t counts[2] = {params_.columns, params_.rows};
    for (int c = 0; c < 2; ++c) {
        params_.corner[c] = implicit.low()[c];
        spacing_[c] = (double(implicit.high()[c]) - double(implicit.low()[c])) / double(counts[c] - 1);
        params_.per_length[c] = float(1 / spacing_[c]);
    }
    copies_.lowest = implicit.low()[2];
    highest_ = double(implicit.high()[2]) - double(implicit.low()[2]);
    copies_.has_holes = implicit.has_holes() ? 1 : 0;
    if (!(highest_ >= 0)) return false;
    diagonals_ = implicit.is_rising() ? RASTER_RISES : RASTER_FALLS;
    cl::Session& session = session_of(device_);
    x_.reserve(session, params_.columns * sizeof(float));
    y_.reserve(session, params_.rows * sizeof(float));
    heights_.reserve(session, vertex_count() * sizeof(float));
    session.reserve_filled(squares_, 0, vertex_count() * sizeof(cl_uint));
    session.launch(file, "raster_of_implicit", cl::Range::items(vertex_count()), params_, implicit.memory(), x_, y_,
                   heights_, squares_);
    if (copies_.has_holes != 0)
        session.launch(file, "raster_fill", cl::Range::items(params_.columns), params_, heights_);
    return true;
}

void BuiltRaster::measure() {
    cl::Session& session = session_of(device_);
    const std::size_t counts[2] = {params_.columns, params_.rows};
    for (std::size_t c = 0; c < 2; ++c) {
        const auto places = session.read_values<float>((c == 0 ? x_ : y_).get(), counts[c]);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double even = params_.corner[c] + double(i) * spacing_[c];
            const double away = std::abs(places[i] - even) / spacing_[c];
            unevenness_ = std::max(unevenness_, std::isnan(away) ? HUGE_VAL : away);  // no triangle is there
        }
    }
    const auto heights = session.read_values<float>(heights_.get(), vertex_count());
    float steepest[2] = {0, 0};
    for (std::size_t column = 0; column < counts[0]; ++column) {
        const float* at = heights.data() + column * counts[1];
        for (std::size_t row = 1; row < counts[1]; ++row)
            steepest[1] = std::max(steepest[1], std::abs(at[row] - at[row - 1]));
        for (std::size_t row = 0; column > 0 && row < counts[1]; ++row)
            steepest[0] = std::max(steepest[0], std::abs(at[row] - (at - counts[1])[row]));
    }
    std::ranges::copy(steepest, steepest_);
}

void BuiltRaster::copy_heights() {
    cl::Session& session = session_of(device_);
    copies_.columns = params_.columns;
    copies_.rows = params_.rows;
    std::size_t floats = 0, most = 0, tiles = 0;
    for (int copy = 0; copy < 4; ++copy) {
        const std::size_t lines = copy < 2 ? params_.columns : params_.rows;
        const std::size_t rows = copy < 2 ? params_.rows : params_.columns;
        // Not a multiple of 4 KiB, so that neighbouring lines do not share a set of the cache.
        copies_.stride[copy] = static_cast<cl_uint>((rows + 2 * RASTER_PAD) | 17);
        copies_.first[copy] = floats + RASTER_PAD;
        floats += lines * copies_.stride[copy];
        copies_.first_top[copy] = static_cast<cl_uint>(tiles);
        copies_.tops_of_line[copy] = static_cast<cl_uint>((rows - 1) / RASTER_TILE + 1);
        tiles += ((lines - 1) / RASTER_TILE + 1) * copies_.tops_of_line[copy];
        most = std::max(most, lines * copies_.stride[copy]);
    }
    copied_.reserve(session, (floats + RASTER_PAD) * sizeof(float));
    session.launch(file, "raster_copies", cl::Range::items(most), copies_, heights_, copied_);
    tops_.reserve(session, tiles * sizeof(float));
    session.launch(file, "raster_tops", cl::Range::items(tiles), copies_, copied_, tops_);
    if (copies_.has_holes != 0) {
        const cl::Buffer holes(session, tiles * sizeof(cl_uint));
        session.launch(file, "raster_holes", cl::Range::items(tiles), copies_, squares_, holes);
        session.launch(file, "raster_mark_holes", cl::Range::items(tiles), copies_, holes, tops_);
    }
    session.finish();
}

}  // namespace gnomon
