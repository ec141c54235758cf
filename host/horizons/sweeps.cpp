// SPDX-License-Identifier: MIT
#include "horizons/sweeps.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/horizons/height_field.h"
#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "horizons/sweeps.cl";

// A light whose rays go less than this far along the ground, as a share of their way, has no sweep.
constexpr double least_along_ground = 1e-3;
constexpr double rounding = 0x1p-24;

// A light as it is seen along the lines of one of the raster's copies.
struct SeenLight {
    bool is_along_y, is_line_turned, is_row_turned;
    double slope;  // vertices to the side, from line to line
    double climb;  // from line to line
};

// Returns no value if the light has no sweep. `towards`: coordinates along the ground, and the height.
std::optional<SeenLight> seen(const double (&towards)[3], const BuiltRaster& raster) {
    const double length = std::hypot(towards[0], towards[1], towards[2]);
    if (!(towards[2] > 0) || std::hypot(towards[0], towards[1]) < least_along_ground * length) return {};
    const double x = towards[0] / raster.spacing(0), y = towards[1] / raster.spacing(1);
    const bool is_along_y = std::abs(y) > std::abs(x);
    const double ahead = is_along_y ? y : x, beside = is_along_y ? x : y;
    return SeenLight{is_along_y, ahead < 0, beside < 0, std::abs(beside / ahead), towards[2] / std::abs(ahead)};
}

struct SweepTables {
    std::vector<LightSweep> sweeps;
    std::vector<std::uint32_t> numbers;  // of the lights that have a sweep
    std::size_t answers = 0;
    std::uint32_t most_blocks = 0;
};

// The crossing at a distance of `lines`, of the edge from a vertex to another one, at a share of its length.
struct Edge {
    double lines;
    int line[2], row[2];
    double share;
};

// All edges that a ray from a vertex meets on its way over `near` lines, the nearest first.
std::vector<Edge> edges_met(double slope, int near, bool is_rising) {
    std::vector<Edge> edges;
    const auto whole = [](double value) { return int(std::floor(value)); };
    for (int line = 1; line <= near; ++line) {
        const int row = whole(slope * line);
        edges.push_back({double(line), {line, line}, {row, row + 1}, slope * line - row});
    }
    for (int row = 1; slope > 0 && row <= near * slope; ++row) {
        const double lines = row / slope;
        edges.push_back({lines, {whole(lines), whole(lines) + 1}, {row, row}, lines - whole(lines)});
    }
    const double nearing = is_rising ? 1 - slope : 1 + slope;
    for (int diagonal = 1; nearing > 0 && diagonal <= near * nearing; ++diagonal) {
        const double lines = diagonal / nearing;
        const int line = whole(lines), low = is_rising ? line - diagonal : diagonal - line;
        edges.push_back({lines, {line, line + 1}, {low, is_rising ? low + 1 : low - 1}, lines - line});
    }
    std::ranges::stable_sort(edges, {}, &Edge::lines);
    return edges;
}

void set_crossings(LightSweep& sweep, const SeenLight& light) {
    for (const Edge& edge : edges_met(light.slope, SWEEP_NEAR, sweep.is_rising != 0)) {
        SweepCrossing& crossing = sweep.crossings[sweep.crossing_count++];
        // An end that has no share need not be on the raster.
        const int high = edge.share == 0 ? 0 : 1;
        crossing = {.low = edge.line[0] * sweep.line_stride + edge.row[0],
                    .high = edge.line[high] * sweep.line_stride + edge.row[high],
                    .share_low = float(1 - edge.share),
                    .share_high = float(edge.share),
                    .climb = float(light.climb * edge.lines),
                    .lines = cl_uint(std::max(edge.line[0], edge.line[high])),
                    .rows = std::max(edge.row[0], edge.row[high]),
                    .padding = 0};
    }
}

SweepEdges edges_at(double rate, std::uint32_t lines) {
    if (rate * lines < 1) return {};
    const double apart = 1 / rate, whole = std::floor(apart);
    return {static_cast<cl_uint>(whole), static_cast<cl_uint>(std::min(std::ldexp(apart - whole, 32), 4294967295.0)),
            float(rate)};
}

// Heights along a ray are wrong by what a ray is away from its place on a raster of even columns and rows: twice their
// unevenness, for the point and for the ground, and what the slope's last bit makes on the way. (The rounding of bounds
// is counted in docs/numerics.md, 16.)
void set_margins(LightSweep& sweep, const SeenLight& light, const BuiltRaster& raster) {
    const double away = 2 * raster.unevenness() + sweep.lines * 0x1p-31;
    const double uneven = away * (raster.steepest(0) + raster.steepest(1) + light.climb);
    const double heights = raster.highest(), plane = light.climb * sweep.lines;
    const double crossings = double(SWEEP_CROSSING_ERROR) * (heights + light.climb * (SWEEP_NEAR + 1));
    sweep.margin =
        float(1.01 * (uneven + rounding * (SWEEP_HEIGHT_ROUNDINGS * heights + SWEEP_CLIMB_ROUNDINGS * plane)) +
              double(SWEEP_LOST));
    sweep.near_margin = float(1.01 * (uneven + crossings) + double(SWEEP_LOST));
}

std::size_t words_of_lines(std::size_t lines, std::uint32_t lanes) {
    const std::uint32_t lines_of_word = sweep_lines_of_word(lanes);
    return (lines + lines_of_word - 1) / lines_of_word;
}

void add_sweep(SweepTables& made, const double (&towards)[3], const BuiltRaster& raster, std::uint32_t lanes) {
    LightSweep sweep{};
    const auto light = seen(towards, raster);
    if (!light) return made.sweeps.push_back(sweep);
    const RasterParams& params = raster.params();
    const std::size_t copy = 2 * std::size_t(light->is_along_y) + std::size_t(light->is_row_turned);
    const auto stride = int(raster.copies().stride[copy]);
    sweep.lines = light->is_along_y ? params.rows : params.columns;
    sweep.rows = light->is_along_y ? params.columns : params.rows;
    sweep.line_stride = light->is_line_turned ? -stride : stride;
    sweep.first = raster.copies().first[copy] +
                  (light->is_line_turned ? (sweep.lines - 1) * std::uint64_t(raster.copies().stride[copy]) : 0);
    sweep.slope = static_cast<cl_uint>(std::min(std::ldexp(light->slope, 32), 4294967295.0));
    sweep.share = float(light->slope);
    sweep.climb = float(light->climb);
    sweep.highest = float(raster.highest());
    sweep.is_rising = raster.is_rising() == (light->is_line_turned == light->is_row_turned) ? 1 : 0;
    sweep.is_along_y = light->is_along_y ? 1 : 0;
    sweep.is_line_turned = light->is_line_turned ? 1 : 0;
    sweep.is_row_turned = light->is_row_turned ? 1 : 0;
    sweep.shift = static_cast<cl_uint>(std::uint64_t(sweep.slope) * (sweep.lines - 1) >> 32) + 1;
    sweep.blocks = (sweep.rows + sweep.shift + lanes - 1) / lanes;
    sweep.first_answer = static_cast<cl_uint>(made.answers);
    made.answers += words_of_lines(sweep.lines, lanes) * sweep.blocks;
    made.most_blocks = std::max(made.most_blocks, sweep.blocks);
    sweep.has_holes = raster.copies().has_holes;
    sweep.first_top = raster.copies().first_top[copy];
    sweep.tops_of_line = raster.copies().tops_of_line[copy];
    sweep.edges[SWEEP_LINES] = edges_at(1, sweep.lines);
    sweep.edges[SWEEP_ROWS] = edges_at(light->slope, sweep.lines);
    sweep.edges[SWEEP_DIAGONALS] = edges_at(sweep.is_rising != 0 ? 1 - light->slope : 1 + light->slope, sweep.lines);
    set_crossings(sweep, *light);
    set_margins(sweep, *light, raster);
    made.numbers.push_back(static_cast<std::uint32_t>(made.sweeps.size()));
    made.sweeps.push_back(sweep);
}

}  // namespace

RasterPoints points_on(const BuiltRaster& raster, const LightsRun& run, const SortedPoints& sorted) {
    cl::Session& session = session_of(run.device);
    RasterPoints at;
    const std::size_t count = run.points.count();
    at.vertices.reserve(session, (count + 16) * sizeof(cl_uint));
    cl::Buffer found;
    session.reserve_filled(found, 0, sizeof(cl_uint));
    const TriangleInputs triangles = implicit_inputs(run.triangles);
    const bool reads_raster = triangles.is_raster && run.points.receivers() != nullptr;
    session.launch({file, "sweep_vertices", {.raster = reads_raster}}, cl::Range::items(count), raster.params(),
                   sorted.part(0, count), triangles.vertices, raster.x(), raster.y(), raster.heights(),
                   sorted.positions(), sorted.receivers(), at.vertices, found);
    at.count = session.read_value<cl_uint>(found);
    return at;
}

std::size_t Sweeps::bytes_of_light(const BuiltRaster& raster, const cl::Session& session) {
    const std::size_t sides = std::size_t(raster.params().columns) + raster.params().rows;
    const std::size_t lines = std::max(raster.params().columns, raster.params().rows);
    return words_of_lines(lines, session.lanes()) * ((sides + 1) / session.lanes() + 1) * sizeof(cl_uint);
}

Sweeps::Sweeps(const LightsRun& run, const BuiltRaster& raster, const RasterPoints& at, Statistics& statistics)
    : session_(session_of(run.device)), raster_(raster), at_(at), statistics_(statistics) {}

void Sweeps::sweep(const LightBundles& bundles) {
    const cl::StageTimer timer(session_, statistics_, "sweeps");
    SweepTables made;
    const std::uint32_t axis = raster_.params().axis;
    for (const LightBundle& bundle : bundles.bundles)
        for (std::uint32_t l = 0; l < MAX_BUNDLE_LIGHTS; ++l) {
            const double towards[3] = {bundle.directions[(axis + 1) % 3][l], bundle.directions[(axis + 2) % 3][l],
                                       bundle.directions[axis][l]};
            add_sweep(made, towards, raster_, session_.lanes());
        }
    session_.upload(sweeps_, made.sweeps);
    answers_.reserve(session_, std::max<std::size_t>(made.answers, 1) * sizeof(cl_uint));
    if (made.numbers.empty()) return;
    session_.upload(numbers_, made.numbers);
    SweepParams params{};
    params.sweep_count = static_cast<cl_uint>(made.numbers.size());
    params.most_blocks = made.most_blocks;
    session_.launch(file, "sweeps", cl::Range::shares(made.numbers.size() * made.most_blocks), params, sweeps_,
                    numbers_, raster_.copied_heights(), raster_.tops(), answers_);
}

void Sweeps::decide(const PointsLayout& points, const HorizonMasks& masks) {
    const cl::StageTimer timer(session_, statistics_, "sweeps_decide");
    const SweepParams params{.points = points,
                             .bundle_count = masks.bundle_count,
                             .mask_stride = masks.stride,
                             .sweep_count = 0,
                             .most_blocks = 0};
    const std::size_t words = std::size_t(points.count) * masks.bundle_count;
    session_.launch(file, "sweeps_decide", session_.blocks(words), params, sweeps_, at_.vertices, answers_, masks.masks,
                    masks.lit);
    const std::size_t listed = session_.is_cpu() ? 1 : WALK_WORDS * session_.work_group_size() + 2;
    session_.launch(file, "sweeps_walk", cl::Range::shares(words), params, sweeps_, at_.vertices,
                    raster_.copied_heights(), raster_.tops(), masks.masks, masks.lit,
                    cl::LocalBytes{listed * sizeof(cl_uint)});
}

}  // namespace gnomon
