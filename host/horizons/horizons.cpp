// SPDX-License-Identifier: MIT
#include "horizons/horizons.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "lists/morton.hpp"

namespace gnomon {
namespace {

// The length of a step as a multiple of the strip's width, and its least length in half cells. Shorter steps leave
// fewer lights open.
constexpr double step_length = 0.5;
// A ray nearer to its point than this, in half cells, may be tested against single triangles.
constexpr double near_distance = 32;
// The half cells by which a region is wider than its strip: the rounding of coordinates, and FIELD_SNAP.
constexpr double region_slack = 0.03;

// The strip of a sector: middle + x across for |x| <= half_width, at a distance of 1.
struct Strip {
    glm::dvec2 middle, across;
    double half_width;

    glm::dvec2 at(double q, double x) const { return q * (middle + x * across); }
};

struct SectorTables {
    std::vector<HorizonSector> sectors;
    std::vector<HorizonStep> steps;
};

// Returns no value if the bundle is no sector.
std::optional<Strip> strip_of(const LightBundle& bundle, std::uint32_t axis, double slope_scale,
                              HorizonSector& sector) {
    const double x = bundle.ground[(axis + 1) % 3], y = bundle.ground[(axis + 2) % 3], length = std::hypot(x, y);
    if (length == 0) return {};
    Strip strip{{x / length, y / length}, {-y / length, x / length}, 0};
    for (std::uint32_t l = 0; l < bundle.light_count; ++l) {
        const auto coordinate = [&](std::uint32_t c) { return double(bundle.directions[(axis + c) % 3][l]); };
        const glm::dvec2 direction(coordinate(1), coordinate(2));
        const double q = dot(direction, strip.middle), across = dot(direction, strip.across);
        strip.half_width = std::max(strip.half_width, std::abs(across / q) + STRIP_MARGIN);
        sector.slopes[l] = float(coordinate(0) / q * slope_scale);
    }
    return strip;
}

// The part of a strip from q to `end`.
HorizonStep step_over(const Strip& strip, double q, double end, const std::vector<FieldLevel>& levels) {
    Rectangle region;
    for (const double distance : {q, end})
        for (const double side : {-strip.half_width, strip.half_width}) region.add(strip.at(distance, side));
    const double width = std::max(region.size().x, region.size().y) + 2 * region_slack;
    std::size_t level = 0;
    while (std::ldexp(1.0, int(level)) < width && level + 1 < levels.size()) ++level;
    return {.low = {float(region.low.x - region_slack), float(region.low.y - region_slack)},
            .q = float(q),
            .q_inverse = float(1 / q),
            .end = float(end),
            .size_inverse = std::ldexp(1.0f, -int(level)),
            .first = levels[level].first,
            .columns = levels[level].columns,
            .rows = levels[level].rows,
            .padding = {}};
}

void add_steps(SectorTables& made, HorizonSector& sector, const Strip& strip, const std::vector<FieldLevel>& levels) {
    sector.first_step = static_cast<std::uint32_t>(made.steps.size());
    const double farthest = std::hypot(levels[0].columns, levels[0].rows);
    for (double q = sector.near_reach; q < farthest; ++sector.stretch_count) {
        const std::size_t stretch = made.steps.size();
        const double first = q;
        made.steps.emplace_back();
        for (std::uint32_t k = 0; k < STEPS_OF_STRETCH; ++k) {
            const double end = q + std::max(step_length, 2 * strip.half_width * q * step_length);
            made.steps.push_back(step_over(strip, q, end, levels));
            q = end;
        }
        made.steps[stretch] = step_over(strip, first, q, levels);
        if (q < near_distance) ++sector.near_stretches;
    }
}

void set_major(HorizonSector& sector, const Strip& strip) {
    const int major = std::abs(strip.middle.x) >= std::abs(strip.middle.y) ? 0 : 1;
    sector.major = cl_uint(major);
    sector.forward = strip.middle[major] > 0 ? 1 : -1;
    Rectangle reach;  // across the major axis, and along it
    for (const double side : {-strip.half_width, strip.half_width}) {
        const glm::dvec2 at = strip.at(1, side);
        reach.add({at[1 - major] / std::abs(at[major]), std::abs(at[major]) / 2});
    }
    sector.min_minor = float(reach.low.x);
    sector.max_minor = float(reach.high.x);
    sector.min_major = float(reach.low.y);
    sector.max_major = float(reach.high.y);
}

void add_sector(SectorTables& made, const LightBundle& bundle, const BuiltHeightField& built) {
    const HeightField& field = built.field();
    HorizonSector sector{};
    sector.light_count = bundle.light_count;
    const auto strip = strip_of(bundle, field.axis, double(field.units) / field.halves, sector);
    if (strip) {
        sector.half_width = float(strip->half_width);
        Rectangle reach;
        for (const double side : {-strip->half_width, strip->half_width}) reach.add(strip->at(1, side));
        const glm::dvec2 fastest = max(abs(reach.low), abs(reach.high));
        for (int c = 0; c < 2; ++c) {
            sector.along[c] = float(strip->middle[c] * field.halves);
            sector.across[c] = float(strip->across[c] * field.halves);
            sector.least[c] = float(reach.low[c]);
            sector.most[c] = float(reach.high[c]);
        }
        set_major(sector, *strip);
        sector.near_reach = float((2 * NEAR_CELLS - 0.1) / std::max(fastest.x, fastest.y));
        add_steps(made, sector, *strip, built.levels());
    }
    made.sectors.push_back(sector);
}

}  // namespace

Horizons::Horizons(const LightsRun& run, const SortedPoints& sorted, const BuiltHeightField& field,
                   const LightBundles& bundles, Statistics& statistics)
    : run_(run), sorted_(sorted), field_(field), session_(session_of(run.device)), statistics_(statistics) {
    SectorTables tables;
    for (const LightBundle& bundle : bundles.bundles) add_sector(tables, bundle, field);
    session_.upload(sectors_, tables.sectors);
    session_.upload(steps_, tables.steps);
}

void Horizons::decide(const PointsLayout& points, const HorizonMasks& masks) {
    const cl::StageTimer timer(session_, statistics_, "horizons");
    const std::size_t tasks = std::size_t(points.count) * masks.bundle_count / session_.lanes() + 1;
    const HorizonParams params{.field = field_.field(),
                               .points = points,
                               .bundle_count = masks.bundle_count,
                               .mask_stride = masks.stride,
                               .padding = {}};
    session_.launch("horizons/horizons.cl", "horizons", session_.uneven_items(tasks, 1), params, sectors_, steps_,
                    field_.starts(), field_.list(), field_.pyramid(), triangle_inputs(run_.triangles).vertices,
                    sorted_.positions(), sorted_.receivers(), masks.masks, masks.lit, masks.begins);
}

}  // namespace gnomon
