// SPDX-License-Identifier: MIT
#include "horizons/height_field.hpp"

#include <algorithm>
#include <cmath>

#include "lists/scan.hpp"
#include "occluders/clusters.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "horizons/height_field.cl";
constexpr std::uint32_t max_borders = 1u << 18;

using Place = std::array<double, 2>;

// The sign of the area of a triangle over the ground; 0 if the sign is not certain. The double-precision value of
// products of differences of floats has three roundings.
int winding_of(const Place& a, const Place& b, const Place& c) {
    const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
    const double area = left - right, bound = 0x1p-48 * (std::abs(left) + std::abs(right));
    return int(area > bound) - int(area < -bound);
}

// Shrinks the rectangle (low x, low y, high x, high y) at one of its sides, so that an edge does not reach into it.
void cut_off(std::array<float, 4>& inside, const float4& edge) {
    const float low[2] = {std::min(edge.values[0], edge.values[2]), std::min(edge.values[1], edge.values[3])};
    const float high[2] = {std::max(edge.values[0], edge.values[2]), std::max(edge.values[1], edge.values[3])};
    double min_lost = HUGE_VAL;
    std::array<float, 4> best = inside;
    for (int c = 0; c < 2; ++c) {
        if (high[c] <= inside[c] || low[c] >= inside[2 + c]) return;
        const double width = double(inside[3 - c]) - inside[1 - c];
        for (const bool from_low : {true, false}) {
            const double lost = width * (from_low ? double(high[c]) - inside[c] : double(inside[2 + c]) - low[c]);
            if (lost >= min_lost) continue;
            min_lost = lost;
            best = inside;
            best[from_low ? c : 2 + c] = from_low ? high[c] : low[c];
        }
    }
    inside = best;
}

}  // namespace

BuiltHeightField::BuiltHeightField(const Device& device, const Triangles& triangles)
    : device_(device), triangles_(triangles) {
    if (triangles.count() == 0 || has_cut_outs(triangles)) return;
    field_.triangles = triangle_inputs(triangles);
    const auto box = box_of_triangles(session_of(device), triangle_inputs(triangles));
    if (box && box->finite == field_.triangles.count && box->largest() <= FIELD_LARGEST_COORDINATE && find_axis(*box) &&
        set_grid(*box) && make_lists() && find_inside())
        make_pyramid();
    else
        starts_ = {}, list_ = {};
}

// The axis along which the box is flattest, among those along which all triangles are seen from one side.
bool BuiltHeightField::find_axis(const CoordinateBounds& box) {
    cl::Session& session = session_of(device_);
    const cl::Buffer found(session, sizeof(cl_uint));
    session.fill(found, 0, sizeof(cl_uint));
    session.launch(file, "field_windings", each_triangle(), field_.triangles, triangle_inputs(triangles_).vertices,
                   found);
    const auto bits = session.read_value<cl_uint>(found);
    double flattest = HUGE_VAL;
    for (cl_uint axis = 0; axis < 3; ++axis)
        for (const cl_uint turned : {0u, 3u}) {
            const double height = box.high[axis] - box.low[axis];
            if ((bits >> (axis + turned) & 1u) != 0 || height >= flattest) continue;
            flattest = height;
            field_.axis = axis;
            field_.winding = turned == 0 ? 1.0f : -1.0f;
        }
    return flattest < HUGE_VAL;
}

// The grid has one cell for each pair of triangles.
bool BuiltHeightField::set_grid(const CoordinateBounds& box) {
    const std::uint32_t x = (field_.axis + 1) % 3, y = (field_.axis + 2) % 3, z = field_.axis;
    const double width = box.high[x] - box.low[x], depth = box.high[y] - box.low[y];
    const double cell = std::sqrt(width * depth / std::max(field_.triangles.count / 2, 1u));
    const double columns = std::ceil(width / cell - 1e-3), rows = std::ceil(depth / cell - 1e-3);
    if (!(cell >= FIELD_LEAST_CELL && std::max(columns, rows) <= MAX_FIELD_HALVES / 2)) return false;
    const double height = std::max(box.high[z] - box.low[z], 1e-6 * std::max(width, depth));
    field_.corner[0] = float(box.low[x]);
    field_.corner[1] = float(box.low[y]);
    field_.halves = float(2 / cell);
    field_.units = float((FIELD_UNITS - 2 * FIELD_LOWEST) / height);
    field_.lowest = float(box.low[z] - FIELD_LOWEST / field_.units);
    field_.columns = std::max(std::uint32_t(columns), 1u);
    field_.rows = std::max(std::uint32_t(rows), 1u);
    const float inside[4] = {float(box.low[x]), float(box.low[y]), float(box.high[x]), float(box.high[y])};
    std::ranges::copy(inside, field_.inside);
    return true;
}

bool BuiltHeightField::make_lists() {
    cl::Session& session = session_of(device_);
    const cl_mem vertices = triangle_inputs(triangles_).vertices;
    const auto cells = static_cast<std::uint32_t>(cell_count());
    const cl::Buffer counts(session, cells * sizeof(cl_uint)), counters(session, sizeof(FieldCounters));
    session.fill(counts, 0, cells * sizeof(cl_uint));
    session.fill(counters, 0, sizeof(FieldCounters));
    session.launch(file, "field_counts", each_triangle(), field_, vertices, counts, counters);
    if (session.read_value<FieldCounters>(counters).unfit != 0) return false;
    starts_.reserve(session, (cells + std::size_t(1)) * sizeof(cl_uint));
    Scan().run(session, cells, counts, starts_);
    std::uint32_t entries = 0;
    session.read(starts_.get(), &entries, sizeof(entries), cells * sizeof(cl_uint));
    // A sum that does not fit is 2^32 - 1 (kernels/lists/scan.cl).
    if (entries > std::min<std::uint64_t>(std::uint64_t(MAX_ENTRIES_OF_TRIANGLE) * field_.triangles.count, 0x7FFFFFFF))
        return false;
    list_.reserve(session, entries * sizeof(cl_uint));
    session.copy(starts_, 0, counts, 0, cells * sizeof(cl_uint));
    session.launch(file, "field_lists", each_triangle(), field_, vertices, counts, list_);
    return true;
}

// No edge without a neighbour reaches into the rectangle, which must be a large part of the grid.
bool BuiltHeightField::find_inside() {
    cl::Session& session = session_of(device_);
    const cl::Buffer counters(session, sizeof(FieldCounters)), borders(session, max_borders * sizeof(float4));
    session.fill(counters, 0, sizeof(FieldCounters));
    session.launch(file, "field_borders", each_triangle(), field_, triangle_inputs(triangles_).vertices, starts_, list_,
                   max_borders, borders, counters);
    const std::uint32_t count = session.read_value<FieldCounters>(counters).borders;
    if (count > max_borders) return false;
    std::array<float, 4> inside;
    std::ranges::copy(field_.inside, inside.begin());
    const auto area_of = [](const auto& r) { return (double(r[2]) - r[0]) * (double(r[3]) - r[1]); };
    const double whole = area_of(inside);
    for (const float4& edge : session.read_values<float4>(borders.get(), count)) cut_off(inside, edge);
    if (!(area_of(inside) > whole / 2)) return false;
    std::ranges::copy(inside, field_.inside);
    return is_covered_once();
}

// True if a position in the rectangle is under one triangle: the middle of a cell, or a position beside it if the
// middle lies too near to an edge to tell.
bool BuiltHeightField::is_covered_once() const {
    cl::Session& session = session_of(device_);
    const TriangleInputs triangles = triangle_inputs(triangles_);
    const double per_length = field_.halves / 2;
    const auto cell_at = [&](int c, std::uint32_t count) {
        const double middle = (double(field_.inside[c]) + field_.inside[2 + c]) / 2 - field_.corner[c];
        return std::min(static_cast<std::uint32_t>(middle * per_length), count - 1);
    };
    const std::uint32_t cell[2] = {cell_at(0, field_.columns), cell_at(1, field_.rows)};
    std::uint32_t range[2];
    const std::size_t at = cell[1] * std::size_t(field_.columns) + cell[0];
    session.read(starts_.get(), range, sizeof(range), at * sizeof(cl_uint));
    std::vector<std::uint32_t> listed(range[1] - range[0]);
    if (listed.empty()) return false;
    session.read(list_.get(), listed.data(), listed.size() * sizeof(cl_uint), range[0] * sizeof(cl_uint));
    std::vector<std::array<Place, 3>> places;
    for (const std::uint32_t id : listed) {
        float v[9];
        session.read(triangles.vertices, v, sizeof(v), (triangles.first_float + 9 * std::size_t(id)) * sizeof(float));
        const std::uint32_t x = (field_.axis + 1) % 3, y = (field_.axis + 2) % 3;
        places.push_back({Place{v[x], v[y]}, Place{v[3 + x], v[3 + y]}, Place{v[6 + x], v[6 + y]}});
    }
    for (int attempt = 0; attempt < 8; ++attempt) {
        const Place place = {field_.corner[0] + (cell[0] + 0.5 + 0.037 * attempt) / per_length,
                             field_.corner[1] + (cell[1] + 0.5 - 0.041 * attempt) / per_length};
        int around = 0;
        bool is_certain = place[0] > field_.inside[0] && place[0] < field_.inside[2] && place[1] > field_.inside[1] &&
                          place[1] < field_.inside[3];
        for (const auto& [a, b, c] : places) {
            const int signs[3] = {winding_of(place, a, b), winding_of(place, b, c), winding_of(place, c, a)};
            const int turn = field_.winding > 0 ? 1 : -1;
            if (std::ranges::any_of(signs, [=](int sign) { return sign == -turn; })) continue;
            is_certain = is_certain && std::ranges::all_of(signs, [=](int sign) { return sign == turn; });
            ++around;
        }
        if (is_certain) return around == 1;
    }
    return false;
}

void BuiltHeightField::make_pyramid() {
    cl::Session& session = session_of(device_);
    std::uint32_t columns = 2 * field_.columns, rows = 2 * field_.rows, first = 0;
    for (;;) {
        levels_.push_back({first, columns, rows, 0});
        first += columns * rows;
        if (columns == 1 && rows == 1) break;
        columns = (columns + 1) / 2, rows = (rows + 1) / 2;
    }
    pyramid_.reserve(session, first * sizeof(cl_uint));
    const std::size_t halves = std::size_t(levels_[0].columns) * levels_[0].rows;
    cl::Buffer least, greatest;
    session.reserve_filled(least, 0xFFFFu, halves * sizeof(cl_uint));
    session.reserve_filled(greatest, 0, halves * sizeof(cl_uint));
    session.launch(file, "field_heights", each_triangle(), field_, triangle_inputs(triangles_).vertices, least,
                   greatest);
    session.launch(file, "field_lowest_level", cl::Range::items(halves), levels_[0], least, greatest, pyramid_);
    for (std::size_t l = 1; l < levels_.size(); ++l)
        session.launch(file, "field_level", cl::Range::items(levels_[l].columns * std::size_t(levels_[l].rows)),
                       levels_[l - 1], levels_[l], pyramid_);
    session.finish();
}

}  // namespace gnomon
