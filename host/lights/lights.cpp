// SPDX-License-Identifier: MIT
// Tables of lights: weights as whole numbers, and the sets of lights that gnomon makes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gnomon.hpp>
#include "query/inputs.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

Double3 unit_of(const Float3& v, const char* what) {
    Double3 unit{v[0], v[1], v[2]};
    if (!is_finite(v) || !normalize(unit))
        throw InvalidArgument(std::string(what) + " must be finite numbers, not all 0");
    return unit;
}

Double3 combined(const Double3& a, double by_a, const Double3& b, double by_b, const Double3& c, double by_c) {
    Double3 made{};
    for (int i = 0; i < 3; ++i) made[i] = a[i] * by_a + b[i] * by_b + c[i] * by_c;
    return made;
}

Light towards(const Double3& direction) {
    return Light::directional({float(-direction[0]), float(-direction[1]), float(-direction[2])});
}

void require_samples(std::uint32_t samples) {
    if (samples == 0) throw InvalidArgument("an extended light takes at least 1 sample");
}

// The radical inverse of i in base 2: its bits in reverse order behind the binary point (van der Corput).
double van_der_corput(std::uint32_t i) {
    double value = 0, bit = 0.5;
    for (; i != 0; i >>= 1, bit /= 2) value += (i & 1u) * bit;
    return value;
}

}  // namespace

Lights::Lights(std::vector<Light> lights, std::vector<float> weights)
    : lights_(std::move(lights)), weights_(std::move(weights)) {
    if (weights_.empty()) weights_.assign(lights_.size(), 1.0f);
    if (weights_.size() != lights_.size())
        throw InvalidArgument("there are " + std::to_string(weights_.size()) + " weights for " +
                              std::to_string(lights_.size()) + " lights");
    double largest = 0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        try {
            require_light(lights_[i]);
        } catch (const InvalidArgument& error) {
            throw InvalidArgument("light " + std::to_string(i) + ": " + error.what());
        }
        if (!std::isfinite(weights_[i]))
            throw InvalidArgument("the weight of light " + std::to_string(i) + " is not a finite number");
        largest = std::max(largest, std::abs(double(weights_[i])));
    }
    // Each whole weight is below 2^(62 - bits of the number of lights), so all of them add up to less than 2^62.
    int bits = 0;
    while (bits < 62 && (std::size_t(1) << bits) < lights_.size()) ++bits;
    if (largest != 0) exponent_ = std::ilogb(largest) + 1 + bits - 62;
    for (const float weight : weights_) {
        const double scaled = std::ldexp(double(weight), -exponent_);
        whole_.push_back(static_cast<std::int64_t>(std::nearbyint(scaled)));
        const double rounding = std::abs(scaled - double(whole_.back()));
        largest_rounding_ = std::max(largest_rounding_, std::ldexp(rounding, exponent_));
    }
}

Lights sun_disk(const Float3& direction, double angle_degrees, std::uint32_t samples) {
    const Double3 axis = unit_of(direction, "the direction of a disk");
    if (!(angle_degrees > 0 && angle_degrees < 90))
        throw InvalidArgument("the angle of a disk must lie between 0 and 90 degrees");
    require_samples(samples);
    const Double3 u = perpendicular(axis), v = cross(axis, u);
    const double radius = std::tan(angle_degrees / 2 * (std::numbers::pi / 180));
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<Light> lights;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const double r = radius * std::sqrt((i + 0.5) / samples), angle = golden * i;
        lights.push_back(towards(combined(axis, -1, u, r * std::cos(angle), v, r * std::sin(angle))));
    }
    return Lights(std::move(lights));
}

Lights area_light(const Float3& corner, const Float3& edge_a, const Float3& edge_b, std::uint32_t samples) {
    if (!is_finite(corner) || !is_finite(edge_a) || !is_finite(edge_b))
        throw InvalidArgument("an area light's corner and edges must be finite numbers");
    require_samples(samples);
    std::vector<Light> lights;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const double a = (i + 0.5) / samples, b = van_der_corput(i);
        Float3 at{};
        for (int c = 0; c < 3; ++c) at[c] = static_cast<float>(corner[c] + a * edge_a[c] + b * edge_b[c]);
        lights.push_back(Light::point(at));
    }
    return Lights(std::move(lights));
}

Lights sky_patches(const Float3& up, const Float3& north, std::uint32_t division) {
    const Double3 zenith = unit_of(up, "the sky's up");
    Double3 east = cross(unit_of(north, "the sky's north"), zenith);
    if (std::hypot(east[0], east[1], east[2]) < 1e-9 || !normalize(east))
        throw InvalidArgument("the sky's north must not be parallel to its up");
    if (division < 1 || division > 16) throw InvalidArgument("the sky's division must be from 1 to 16");
    const Double3 ahead = cross(zenith, east);
    // Tregenza's rows have 12 degrees each from the horizon to 84 degrees; the last patch is the cap around the zenith.
    constexpr std::uint32_t patches[] = {30, 30, 24, 24, 18, 12, 6};
    const double row_height = 90.0 / (7 * division + 0.5) * (std::numbers::pi / 180);
    std::vector<Light> lights;
    std::vector<float> weights;
    for (std::uint32_t row = 0; row < 7 * division; ++row) {
        const std::uint32_t count = patches[row / division] * division;
        const double low = row * row_height, high = (row + 1) * row_height, elevation = (low + high) / 2;
        // The integral of sin over the row's solid angle, over pi, for one patch.
        const double share = (std::pow(std::sin(high), 2) - std::pow(std::sin(low), 2)) / count;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double azimuth = 2 * std::numbers::pi * i / count;
            lights.push_back(
                towards(combined(zenith, std::sin(elevation), ahead, std::cos(elevation) * std::cos(azimuth), east,
                                 std::cos(elevation) * std::sin(azimuth))));
            weights.push_back(static_cast<float>(share));
        }
    }
    lights.push_back(towards(zenith));
    weights.push_back(static_cast<float>(1 - std::pow(std::sin(7 * division * row_height), 2)));
    return Lights(std::move(lights), std::move(weights));
}

}  // namespace gnomon
