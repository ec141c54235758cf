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
double rays_ms(const TreeRun& run, const LightBundles& plain, Statistics& statistics) {
    try {
        return estimated_packets_ms(run, plain, statistics);
    } catch (const OutOfDeviceMemory&) {
        return never;
    }
}

struct Choice {
    ManyLightsWay way;
    ShaftShape shape;
};

// Whether one light after the other takes less than the `ms` that a way through the tree may take for each. On a GPU a
// sample's longest work-group makes that way seem slower than it is, and a light's launches take some time whatever it
// meets.
bool is_one_by_one_faster(const OneLightMs& one_light_ms, double ms, bool is_cpu) {
    constexpr double launches_ms = 0.15, seeming = 1.2;
    if (!one_light_ms || (!is_cpu && ms < launches_ms)) return false;
    return one_light_ms(ms) * (is_cpu ? 1.0 : seeming) < ms;
}

Choice faster_way(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms, Statistics& statistics) {
    const std::size_t lights = run.lights.count();
    const bool is_cpu = session_of(run.device).is_cpu();
    if (run.points.count() * lights < pairs_worth_measuring) return {ManyLightsWay::shafts, ShaftShape::block};
    const ShaftEstimate shafts = estimated_shafts(run, bundles.coned, statistics);
    // On a GPU rays never took the least time (docs/many_lights.md).
    const double rays = is_cpu ? rays_ms(run, bundles.plain, statistics) : never;
    if (is_one_by_one_faster(one_light_ms, std::min(rays, shafts.ms) / double(lights), is_cpu))
        return {ManyLightsWay::one_by_one, {}};
    return {shafts.ms <= rays ? ManyLightsWay::shafts : ManyLightsWay::rays, shafts.shape};
}

}  // namespace

bool run_through_tree(const TreeRun& run, ManyLightsWay way, std::uint32_t bundle_lights,
                      const OneLightMs& one_light_ms, Statistics& statistics) {
    if (!(run.largest_coordinate() <= SHAFT_LARGEST_COORDINATE)) return false;
    auto coned = make_light_bundles(run.lights.lights(), bundle_lights);
    if (!coned) return false;
    auto plain = make_plain_bundles(run.lights.lights(), &*coned);
    const Bundled bundles{std::move(*plain), std::move(*coned)};
    Choice choice{way, way == ManyLightsWay::point_shafts ? ShaftShape::point : ShaftShape::block};
    if (way == ManyLightsWay::automatic) choice = faster_way(run, bundles, one_light_ms, statistics);
    if (choice.way == ManyLightsWay::one_by_one) return false;
    if (choice.way == ManyLightsWay::rays && session_of(run.device).is_cpu())
        ShaftPasses(run, bundles.plain, statistics).run(ShaftShape::packet);
    else if (choice.way == ManyLightsWay::rays)
        RayPasses(run, bundles.plain, statistics).run();
    else
        ShaftPasses(run, bundles.coned, statistics).run(choice.shape);
    merge_stages(statistics);
    return true;
}

}  // namespace gnomon
