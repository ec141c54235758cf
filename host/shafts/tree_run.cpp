// SPDX-License-Identifier: MIT
#include "shafts/tree_run.hpp"

#include <algorithm>
#include <limits>

#include "api/statistics.hpp"
#include "shafts/shaft_trace.hpp"

namespace gnomon {
namespace {

// Where a run takes less than some milliseconds, a sample of it takes as long.
constexpr std::size_t pairs_worth_measuring = std::size_t(1) << 20;
constexpr double never = std::numeric_limits<double>::infinity();

struct Bundled {
    LightBundles coned;
    LightBundles plain;  // for packets; empty on a GPU
};

// A way that has no room takes for ever.
double rays_ms(const TreeRun& run, const LightBundles& plain, Statistics& statistics) {
    try {
        return estimated_packets_ms(run, plain, statistics);
    } catch (const OutOfDeviceMemory&) {
        return never;
    }
}

// Whether no bundle's cone is wider than some 2 degrees.
bool are_thin(const LightBundles& coned) {
    return std::ranges::all_of(coned.bundles, [](const LightBundle& bundle) {
        const LightCone& cone = bundle.cones[0];
        double square = 0;
        for (int c = 0; c < 3; ++c)
            square += double(cone.across[c]) * cone.across[c] + double(cone.along[c]) * cone.along[c];
        return square < 0.02 * 0.02;
    });
}

// On a CPU single lights were never faster from some 32 lights on.
ManyLightsWay faster_way_on_cpu(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms,
                                Statistics& statistics) {
    constexpr std::size_t many_lights = 32;
    const std::size_t lights = run.lights.count();
    if (are_thin(bundles.coned)) return ManyLightsWay::shafts;
    const double shafts = estimated_shafts_ms(run, bundles.coned, statistics);
    const double rays = rays_ms(run, bundles.plain, statistics), each = std::min(rays, shafts) / double(lights);
    if (one_light_ms && lights < many_lights && one_light_ms() < each) return ManyLightsWay::one_by_one;
    return shafts <= rays ? ManyLightsWay::shafts : ManyLightsWay::rays;
}

// On a GPU single lights took the least time only for the points of pictures and where bundles are wide
// (docs/many_lights.md). Thousands of lights are dense.
ManyLightsWay faster_way_on_gpu(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms,
                                Statistics& statistics) {
    constexpr std::size_t dense_lights = 2048;
    const std::size_t lights = run.lights.count();
    if (!one_light_ms || lights >= dense_lights || are_thin(bundles.coned)) return ManyLightsWay::shafts;
    const double each = estimated_shafts_ms(run, bundles.coned, statistics) / double(lights);
    return one_light_ms() < each ? ManyLightsWay::one_by_one : ManyLightsWay::shafts;
}

ManyLightsWay faster_way(const TreeRun& run, const Bundled& bundles, const OneLightMs& one_light_ms,
                         Statistics& statistics) {
    if (run.points.count() * run.lights.count() < pairs_worth_measuring) return ManyLightsWay::shafts;
    const bool is_cpu = session_of(run.device).is_cpu();
    return (is_cpu ? faster_way_on_cpu : faster_way_on_gpu)(run, bundles, one_light_ms, statistics);
}

}  // namespace

bool run_through_tree(const TreeRun& run, ManyLightsWay way, std::uint32_t bundle_lights,
                      const OneLightMs& one_light_ms, Statistics& statistics) {
    if (!(run.largest_coordinate() <= SHAFT_LARGEST_COORDINATE)) return false;
    auto coned = make_light_bundles(run.lights.lights(), bundle_lights);
    if (!coned) return false;
    const bool is_cpu = session_of(run.device).is_cpu();
    if (way == ManyLightsWay::rays && !is_cpu) way = ManyLightsWay::point_shafts;
    Bundled bundles{std::move(*coned), {}};
    if (is_cpu) bundles.plain = *make_plain_bundles(run.lights.lights(), &bundles.coned);
    if (way == ManyLightsWay::automatic) way = faster_way(run, bundles, one_light_ms, statistics);
    if (way == ManyLightsWay::one_by_one) return false;
    if (way == ManyLightsWay::rays)
        ShaftPasses(run, bundles.plain, statistics).run(ShaftShape::packet);
    else
        ShaftPasses(run, bundles.coned, statistics)
            .run(way == ManyLightsWay::point_shafts ? ShaftShape::point : ShaftShape::block);
    merge_stages(statistics);
    return true;
}

}  // namespace gnomon
