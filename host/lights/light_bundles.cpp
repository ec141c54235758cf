// SPDX-License-Identifier: MIT
#include "lights/light_bundles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>

#include "kernels/lists/morton.h"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

// The directions of one light: as the kernels compare it, and of length 1.
struct Direction {
    Float3 scaled;
    glm::dvec3 unit;
};

// Returns no value if a coordinate would lose bits.
std::optional<Direction> direction_of(const Light& light) {
    const float* d = light.xyzw.data();
    int exponent = 0;
    std::frexp(largest_coordinate(loaded(d)), &exponent);
    Direction made{};
    for (int c = 0; c < 3; ++c) {
        made.scaled[c] = std::ldexp(d[c], -exponent);
        if (std::ldexp(double(made.scaled[c]), exponent) != double(d[c])) return {};
        made.unit[c] = made.scaled[c];
    }
    make_unit(made.unit);
    return made;
}

// ---- Order ----------------------------------------------------------------------------------------------------------

// Directions of one hour on many days lie along thin curves, and bundles along a curve have thin cones. A chain that
// always continues at the nearest remaining light finds such curves in any table. Each step searches all remaining
// lights, so a large table is first cut into parts along a coarse curve.
constexpr std::size_t max_in_chain = 4096;

void sort_coarsely(std::vector<std::uint32_t>& order, const std::vector<Direction>& directions) {
    if (order.size() <= max_in_chain) return;
    std::vector<std::uint32_t> codes(directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i)
        for (int c = 0; c < 3; ++c)
            codes[i] |= spread_bits(static_cast<std::uint32_t>((directions[i].unit[c] + 1) * 511.5)) << c;
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return codes[i]; });
}

void chain(std::span<std::uint32_t> part, const std::vector<Direction>& directions) {
    for (std::size_t i = 0; i + 1 < part.size(); ++i) {
        std::size_t nearest = i + 1;
        double greatest = -2;
        for (std::size_t j = i + 1; j < part.size(); ++j) {
            const double cosine = dot(directions[part[i]].unit, directions[part[j]].unit);
            if (cosine > greatest) {
                greatest = cosine;
                nearest = j;
            }
        }
        std::swap(part[i + 1], part[nearest]);
    }
}

double chord(const Direction& a, const Direction& b) { return distance(a.unit, b.unit); }

// The longest chord of a bundle's chain. The suns of one hour move up to .007 a day in a year. With wide bundles, a sky
// of patches that lie .2 apart took 10 to 40 times as long (Sponza, lost_empire, 145 patches).
constexpr double max_chain = 0.25;

// The first light of each bundle: where a bundle is full, its chain too long, or a step far longer than most.
std::vector<std::size_t> cut(const std::vector<std::uint32_t>& order, const std::vector<Direction>& directions,
                             std::uint32_t most) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < order.size(); ++i)
        steps.push_back(chord(directions[order[i - 1]], directions[order[i]]));
    std::vector<double> sorted = steps;
    std::ranges::sort(sorted);
    const double longest = sorted.empty() ? 0 : 6 * sorted[sorted.size() / 2];
    std::vector<std::size_t> starts{0};
    double length = 0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        length += steps[i - 1];
        if (i - starts.back() < most && length <= max_chain && steps[i - 1] <= longest) continue;
        starts.push_back(i);
        length = 0;
    }
    return starts;
}

// ---- Cone -----------------------------------------------------------------------------------------------------------

struct Axes {
    glm::dvec3 middle, across, along;
};

// Unit axes with `along` where the directions spread most.
Axes axes_of(std::span<const std::uint32_t> part, const std::vector<Direction>& directions) {
    Axes axes{};
    std::vector<glm::dvec3> units;
    for (const std::uint32_t i : part) {
        units.push_back(directions[i].unit);
        axes.middle += units.back();
    }
    make_unit(axes.middle);
    axes.along = widest_across(axes.middle, units);
    axes.across = cross(axes.middle, axes.along);
    return axes;
}

// s D = middle + u across + v along with |u|, |v| <= 1 and s > 0, and D strictly inside of all planes.
bool contains(const LightCone& cone, const glm::dvec3& unit) {
    const glm::dvec3 middle = loaded(cone.middle), across = loaded(cone.across), along = loaded(cone.along);
    const double det = determinant(across, along, unit);
    const double u = -determinant(middle, along, unit) / det, v = -determinant(across, middle, unit) / det;
    if (!(std::abs(u) < 1 - 1e-6 && std::abs(v) < 1 - 1e-6 && dot(unit, middle) > 0.1)) return false;
    return std::ranges::all_of(cone.planes, [&](const auto& plane) { return dot(loaded(plane), unit) < -2e-7; });
}

void store_planes(LightCone& cone) {
    const glm::dvec3 middle = loaded(cone.middle), across = loaded(cone.across), along = loaded(cone.along);
    glm::dvec3 normals[] = {cross(middle + across, along), cross(middle - across, along), cross(middle + along, across),
                            cross(middle - along, across), middle};
    for (int k = 0; k < 5; ++k) {
        make_unit(normals[k]);
        store(cone.planes[k], dot(normals[k], middle) > 0 ? -normals[k] : normals[k]);
    }
}

// Returns false if no cone of less than about 80 degrees contains the directions.
bool fit_cone(LightCone& cone, std::span<const std::uint32_t> part, const std::vector<Direction>& directions) {
    const Axes axes = axes_of(part, directions);
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    for (const std::uint32_t i : part) {
        const double height = dot(directions[i].unit, axes.middle);
        if (height < 0.3) return false;
        const double at[2] = {dot(directions[i].unit, axes.across) / height,
                              dot(directions[i].unit, axes.along) / height};
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], at[k]);
            high[k] = std::max(high[k], at[k]);
        }
    }
    const glm::dvec3 middle =
        axes.middle + (axes.across * ((low[0] + high[0]) / 2) + axes.along * ((low[1] + high[1]) / 2));
    const double length = glm::length(middle);
    for (double more = 3e-6; more < 0.1; more *= 4) {
        store(cone.middle, middle * (1 / length));
        store(cone.across, axes.across * (((high[0] - low[0]) / 2 * (1 + 1e-5) + more) / length));
        store(cone.along, axes.along * (((high[1] - low[1]) / 2 * (1 + 1e-5) + more) / length));
        store_planes(cone);
        if (std::ranges::all_of(part, [&](std::uint32_t i) { return contains(cone, directions[i].unit); })) return true;
    }
    return false;
}

LightAxes axes_along(const glm::dvec3& unit) {
    const glm::dvec3 u = perpendicular(unit);
    LightAxes axes{};
    store(axes.u, u);
    store(axes.v, cross(unit, u));
    store(axes.w, unit);
    return axes;
}

void add_lights(LightBundles& made, LightBundle& bundle, std::span<const std::uint32_t> part,
                const std::vector<Direction>& directions) {
    bundle.light_count = static_cast<std::uint32_t>(part.size());
    for (std::size_t l = 0; l < part.size(); ++l) {
        for (int c = 0; c < 3; ++c) bundle.directions[c][l] = directions[part[l]].scaled[c];
        glm::dvec3 unit = directions[part[l]].unit;
        make_unit(unit);
        bundle.axes[l] = axes_along(unit);
    }
    made.add(bundle, part);
}

void add_bundle(LightBundles& made, std::span<const std::uint32_t> part, const std::vector<Direction>& directions) {
    LightBundle bundle{};
    if (!fit_cone(bundle.cones[0], part, directions)) {
        add_bundle(made, part.first(part.size() / 2), directions);
        add_bundle(made, part.subspan(part.size() / 2), directions);
        return;
    }
    for (std::size_t k = 1; k < LIGHT_CONES; ++k) {
        const auto lights = lights_of_cone(part, k);
        if (!lights.empty() && !fit_cone(bundle.cones[k], lights, directions))
            bundle.cones[k] = bundle.cones[(k - 1) / 2];
    }
    add_lights(made, bundle, part, directions);
}

// Makes bundles of these lights along chains.
void add_chained(LightBundles& made, std::vector<std::uint32_t> order, const std::vector<Direction>& directions,
                 std::uint32_t most) {
    if (order.empty()) return;
    sort_coarsely(order, directions);
    for (std::size_t first = 0; first < order.size(); first += max_in_chain)
        chain(std::span(order).subspan(first, std::min(max_in_chain, order.size() - first)), directions);
    std::vector<std::size_t> starts = cut(order, directions, most);
    starts.push_back(order.size());
    for (std::size_t b = 0; b + 1 < starts.size(); ++b)
        add_bundle(made, std::span(order).subspan(starts[b], starts[b + 1] - starts[b]), directions);
}

// ---- Sectors --------------------------------------------------------------------------------------------------------

struct SectorLight {
    std::uint32_t light;
    double azimuth, slope;
};

// The azimuth that a sector may cover, about 8 degrees.
constexpr double widest_sector = 0.14;

void set_ground(LightBundle& bundle, std::uint32_t axis) {
    glm::dvec3 sum{};
    const int x = (int(axis) + 1) % 3, y = (int(axis) + 2) % 3;
    for (std::uint32_t l = 0; l < bundle.light_count; ++l) {
        const double length = std::hypot(bundle.directions[x][l], bundle.directions[y][l]);
        sum[x] += bundle.directions[x][l] / length;
        sum[y] += bundle.directions[y][l] / length;
    }
    make_unit(sum);
    store(bundle.ground, sum);
}

void add_sectors(LightBundles& made, std::vector<SectorLight> lights, const std::vector<Direction>& directions,
                 std::uint32_t most, std::uint32_t axis) {
    std::ranges::stable_sort(lights, {}, &SectorLight::azimuth);
    for (std::size_t first = 0, end = 0; first < lights.size(); first = end) {
        while (end < lights.size() && end - first < most &&
               lights[end].azimuth - lights[first].azimuth <= widest_sector)
            ++end;
        const auto sector = std::span(lights).subspan(first, end - first);
        std::ranges::stable_sort(sector, {}, &SectorLight::slope);
        std::vector<std::uint32_t> order;
        for (const SectorLight& light : sector) order.push_back(light.light);
        const std::size_t before = made.bundles.size();
        add_bundle(made, order, directions);
        for (std::size_t b = before; b < made.bundles.size(); ++b) set_ground(made.bundles[b], axis);
    }
}

std::optional<std::vector<Direction>> directions_of(std::span<const Light> lights) {
    std::vector<Direction> directions;
    for (const Light& light : lights) {
        if (!light.is_directional()) return {};
        const auto direction = direction_of(light);
        if (!direction) return {};
        directions.push_back(*direction);
    }
    return directions;
}

}  // namespace

std::span<const std::uint32_t> lights_of_cone(std::span<const std::uint32_t> bundle, std::size_t cone) {
    const std::size_t level = std::bit_width(cone + 1) - 1, size = MAX_BUNDLE_LIGHTS >> level;
    const std::size_t first = std::min((cone + 1 - (std::size_t(1) << level)) * size, bundle.size());
    return bundle.subspan(first, std::min(size, bundle.size() - first));
}

void LightBundles::add(const LightBundle& bundle, std::span<const std::uint32_t> of_slots) {
    bundles.push_back(bundle);
    for (std::size_t l = 0; l < MAX_BUNDLE_LIGHTS; ++l) lights.push_back(l < of_slots.size() ? of_slots[l] : no_light);
}

std::size_t LightBundles::light_count() const {
    return std::size_t(std::ranges::count_if(lights, [](std::uint32_t light) { return light != no_light; }));
}

LightBundles make_plain_bundles(const LightBundles& coned) {
    if (coned.are_positions) return coned;
    LightBundles made;
    for (std::size_t i = 0, count = 0; i < coned.lights.size(); ++i) {
        if (coned.lights[i] == no_light) continue;
        const std::size_t from = i % MAX_BUNDLE_LIGHTS, slot = count++ % MAX_BUNDLE_LIGHTS;
        if (slot == 0) made.add({}, {});
        LightBundle& bundle = made.bundles.back();
        const LightBundle& given = coned.bundles[i / MAX_BUNDLE_LIGHTS];
        for (int c = 0; c < 3; ++c) bundle.directions[c][slot] = given.directions[c][from];
        bundle.axes[slot] = given.axes[from];
        bundle.light_count = static_cast<std::uint32_t>(slot + 1);
        made.lights[count - 1] = coned.lights[i];
    }
    return made;
}

bool can_be_bundled(std::span<const Light> lights) {
    return std::ranges::none_of(lights, &Light::is_directional) || std::ranges::all_of(lights, [](const Light& light) {
               return light.is_directional() && direction_of(light);
           });
}

std::optional<LightBundles> make_light_bundles(std::span<const Light> lights, std::uint32_t most) {
    if (std::ranges::none_of(lights, &Light::is_directional)) return make_position_bundles(lights, most);
    const auto directions = directions_of(lights);
    if (!directions) return {};
    std::vector<std::uint32_t> order(lights.size());
    std::iota(order.begin(), order.end(), 0u);
    LightBundles made;
    add_chained(made, std::move(order), *directions, most);
    return made;
}

std::optional<LightBundles> make_sector_bundles(std::span<const Light> lights, std::uint32_t most, std::uint32_t axis) {
    const auto directions = directions_of(lights);
    if (!directions) return {};
    std::vector<std::uint32_t> others;
    std::vector<SectorLight> sectors;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const glm::dvec3& d = (*directions)[i].unit;
        const double x = d[(int(axis) + 1) % 3], y = d[(int(axis) + 2) % 3], height = d[int(axis)];
        const double across = std::hypot(x, y);
        if (height > SECTOR_LEAST_RISE && across > 0.05)
            sectors.push_back({i, std::atan2(y, x), height / across});
        else
            others.push_back(i);
    }
    LightBundles made;
    add_sectors(made, std::move(sectors), *directions, most, axis);
    add_chained(made, std::move(others), *directions, most);
    return made;
}

}  // namespace gnomon
