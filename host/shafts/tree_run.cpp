// SPDX-License-Identifier: MIT
#include "shafts/tree_run.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "api/statistics.hpp"
#include "shafts/shaft_trace.hpp"

namespace gnomon {
namespace {

// Where a run takes less than some milliseconds, a sample of it takes as long.
constexpr std::size_t pairs_worth_measuring = std::size_t(1) << 20;
// For each triangle. A height field takes as long to make as some of them to decide.
constexpr std::size_t pairs_worth_field = 8;
constexpr double never = std::numeric_limits<double>::infinity();

struct Bundled {
    LightBundles coned;
    LightBundles plain;    // for packets; empty on a GPU
    LightBundles sectors;  // for horizons; empty where the triangles are no height field
    const BuiltHeightField* field = nullptr;
};

// A way that has no room takes for ever.
template <typename Estimate>
double ms_or_never(Estimate&& estimate) {
    try {
        return estimate();
    } catch (const OutOfDeviceMemory&) {
        return never;
    }
}

void find_field(Bundled& bundles, const TreeRun& run, std::uint32_t bundle_lights,
                const HeightFieldOfRun& height_field) {
    bundles.field = height_field();
    if (bundles.field != nullptr)
        bundles.sectors = *make_sector_bundles(run.lights.lights(), bundle_lights, bundles.field->field().axis);
}

void find_field_if_there_is_room(Bundled& bundles, const TreeRun& run, std::uint32_t bundle_lights,
                                 const HeightFieldOfRun& height_field) {
    try {
        find_field(bundles, run, bundle_lights, height_field);
    } catch (const OutOfDeviceMemory&) {
        bundles.field = nullptr;
    }
}

// Whether no bundle's cone is wider than some 2 degrees, or no box of point lights than a small part of the scene.
bool are_thin(const TreeRun& run, const LightBundles& coned) {
    const double widest = coned.are_positions ? run.largest_coordinate() / 16.0 : 0.02;
    return std::ranges::all_of(coned.bundles, [&](const LightBundle& bundle) {
        const LightCone& cone = bundle.cones[0];
        double square = 0;
        for (int c = 0; c < 3; ++c)
            square += double(cone.across[c]) * cone.across[c] + double(cone.along[c]) * cone.along[c];
        return square < widest * widest;
    });
}

// On a CPU single lights were never faster from some 32 lights on.
ManyLightsWay faster_way_on_cpu(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms,
                                Statistics& statistics) {
    constexpr std::size_t many_lights = 32;
    const std::size_t lights = run.lights.count();
    std::pair<double, ManyLightsWay> best = {estimated_shafts_ms(run, bundles.coned, statistics),
                                             ManyLightsWay::shafts};
    const double rays = ms_or_never([&] { return estimated_packets_ms(run, bundles.plain, statistics); });
    best = std::min(best, {rays, ManyLightsWay::rays});
    if (bundles.field != nullptr) {
        const double horizons =
            ms_or_never([&] { return estimated_horizons_ms(run, bundles.sectors, *bundles.field, statistics); });
        best = std::min(best, {horizons, ManyLightsWay::horizons});
    }
    if (one_light_ms && lights < many_lights && one_light_ms() < best.first / double(lights))
        return ManyLightsWay::one_by_one;
    return best.second;
}

// On a GPU horizons took the least time but for the points of pictures, and single lights for these where bundles are
// wide, seldom for others (docs/many_lights.md). Thousands of lights are dense. A scattered lamp takes a millisecond,
// and shafts as long for a quarter of a million points.
ManyLightsWay faster_way_on_gpu(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms,
                                Statistics& statistics) {
    constexpr std::size_t dense_lights = 2048, points_worth_a_lamp = std::size_t(1) << 18;
    // Where the estimates were close (256 suns on a city, H200: 206 and 216 ms), shafts took 263, single lights 229.
    constexpr double shafts_over_estimate = 1.1;
    const std::size_t lights = run.lights.count();
    if (bundles.field != nullptr) return ManyLightsWay::horizons;
    if (bundles.coned.are_positions)
        return run.points.count() < points_worth_a_lamp ? ManyLightsWay::shafts : ManyLightsWay::one_by_one;
    if (!one_light_ms || lights >= dense_lights) return ManyLightsWay::shafts;
    const double shafts = ms_or_never([&] { return estimated_shafts_ms(run, bundles.coned, statistics); });
    const double one_by_one = ms_or_never(one_light_ms) * double(lights);
    return one_by_one < shafts_over_estimate * shafts ? ManyLightsWay::one_by_one : ManyLightsWay::shafts;
}

ManyLightsWay faster_way(const TreeRun& run, Bundled& bundles, std::uint32_t bundle_lights,
                         const HeightFieldOfRun& height_field, const OneLightMs& one_light_ms, Statistics& statistics) {
    const std::size_t pairs = run.points.count() * run.lights.count();
    const bool is_cpu = session_of(run.device).is_cpu();
    if (pairs < pairs_worth_measuring) return ManyLightsWay::shafts;
    const bool are_positions = bundles.coned.are_positions;
    if (!are_positions && pairs >= pairs_worth_field * run.triangles.count() && (is_cpu || !run.points.camera()))
        find_field_if_there_is_room(bundles, run, bundle_lights, height_field);
    if (!is_cpu && bundles.field == nullptr && are_thin(run, bundles.coned)) return ManyLightsWay::shafts;
    return (is_cpu ? faster_way_on_cpu : faster_way_on_gpu)(run, bundles, one_light_ms, statistics);
}

// False where there is no room and the choice was not the caller's: shafts take less.
bool run_by_horizons(const TreeRun& run, const Bundled& bundles, bool may_fall_back, Statistics& statistics) {
    try {
        ShaftPasses(run, bundles.sectors, statistics, bundles.field).run(ShaftShape::point);
        return true;
    } catch (const OutOfDeviceMemory&) {
        if (!may_fall_back) throw;
        return false;
    }
}

}  // namespace

std::optional<ManyLightsWay> run_through_tree(const TreeRun& run, ManyLightsWay way, bool may_fall_back,
                                              std::uint32_t bundle_lights, const HeightFieldOfRun& height_field,
                                              const OneLightMs& one_light_ms, Statistics& statistics) {
    if (!(run.largest_coordinate() <= SHAFT_LARGEST_COORDINATE)) return {};
    auto coned = make_light_bundles(run.lights.lights(), bundle_lights);
    if (!coned) return {};
    const bool is_cpu = session_of(run.device).is_cpu();
    if (way == ManyLightsWay::rays && !is_cpu) way = ManyLightsWay::point_shafts;
    if (way == ManyLightsWay::horizons && coned->are_positions) return {};
    Bundled bundles{std::move(*coned), {}, {}};
    if (is_cpu) bundles.plain = *make_plain_bundles(run.lights.lights(), &bundles.coned);
    if (way == ManyLightsWay::horizons) find_field(bundles, run, bundle_lights, height_field);
    if (way == ManyLightsWay::automatic)
        way = faster_way(run, bundles, bundle_lights, height_field, one_light_ms, statistics);
    if (way == ManyLightsWay::horizons && bundles.field == nullptr) return {};
    if (way == ManyLightsWay::one_by_one) return way;
    if (way == ManyLightsWay::horizons && !run_by_horizons(run, bundles, may_fall_back, statistics))
        way = ManyLightsWay::shafts;
    if (way == ManyLightsWay::rays)
        ShaftPasses(run, bundles.plain, statistics).run(ShaftShape::packet);
    else if (way != ManyLightsWay::horizons)
        ShaftPasses(run, bundles.coned, statistics)
            .run(way == ManyLightsWay::shafts ? ShaftShape::block : ShaftShape::point);
    merge_stages(statistics);
    return way;
}

}  // namespace gnomon
