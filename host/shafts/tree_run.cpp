// SPDX-License-Identifier: MIT
#include "shafts/tree_run.hpp"

#include <limits>

#include "api/statistics.hpp"
#include "shafts/ray_trace.hpp"
#include "shafts/shaft_trace.hpp"

namespace gnomon {
namespace {

// Where a run takes less than some milliseconds, a sample of it takes as long.
constexpr std::size_t pairs_worth_measuring = std::size_t(1) << 20;
constexpr double never = std::numeric_limits<double>::infinity();

struct Bundled {
    LightBundles plain, coned;
};

// A way that has no room takes for ever.
double rays_ms(const TreeRun& run, double limit_ms, Statistics& statistics) {
    try {
        return estimated_rays_ms(run, limit_ms, statistics);
    } catch (const OutOfDeviceMemory&) {
        return never;
    }
}

struct Choice {
    ManyLightsWay way;
    ShaftShape shape;
};

Choice faster_way(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms, Statistics& statistics) {
    const std::size_t lights = run.lights.count();
    if (run.points.count() * lights < pairs_worth_measuring) return {ManyLightsWay::shafts, ShaftShape::block};
    const ShaftEstimate shafts = estimated_shafts(run, bundles.coned, statistics);
    const double rays = rays_ms(run, shafts.ms, statistics);
    const double least = std::min(rays, shafts.ms);
    if (one_light_ms && one_light_ms(least / double(lights)) * double(lights) < least)
        return {ManyLightsWay::one_by_one, {}};
    return {shafts.ms <= rays ? ManyLightsWay::shafts : ManyLightsWay::rays, shafts.shape};
}

}  // namespace

bool run_through_tree(const TreeRun& run, ManyLightsWay way, std::uint32_t bundle_lights,
                      const OneLightMs& one_light_ms, Statistics& statistics) {
    if (!(run.largest_coordinate() <= SHAFT_LARGEST_COORDINATE)) return false;
    auto plain = make_plain_bundles(run.lights.lights());
    auto coned = make_light_bundles(run.lights.lights(), bundle_lights);
    if (!plain || !coned) return false;
    const Bundled bundles{std::move(*plain), std::move(*coned)};
    Choice choice{way, way == ManyLightsWay::point_shafts ? ShaftShape::point : ShaftShape::block};
    if (way == ManyLightsWay::automatic) choice = faster_way(run, bundles, one_light_ms, statistics);
    if (choice.way == ManyLightsWay::one_by_one) return false;
    if (choice.way == ManyLightsWay::rays)
        RayPasses(run, bundles.plain, statistics).run();
    else
        ShaftPasses(run, bundles.coned, statistics).run(choice.shape);
    merge_stages(statistics);
    return true;
}

}  // namespace gnomon
