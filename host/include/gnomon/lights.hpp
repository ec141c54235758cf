// SPDX-License-Identifier: MIT
// One light (stable), and tables of many (experimental): the sun's disk, a shining parallelogram, the sky.
#pragma once

#include <span>

#include <gnomon/device.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

/// A directional light or a point light. Float32 as given, never normalised.
struct Light {
    std::array<float, 4> xyzw{};  ///< w = 0: minus the direction of travel; w = 1: the position
    bool is_directional() const { return xyzw[3] == 0.0f; }  ///< else it is a point light

    /// A directional light that travels along `direction`. Throws InvalidArgument if zero or not finite.
    static Light directional(const Float3& direction);
    /// A point light at `position`, in the scene's unit. Throws InvalidArgument if not finite.
    static Light point(const Float3& position);
};

/// Index of no light.
inline constexpr std::uint32_t no_light = 0xFFFFFFFFu;

/// A table of lights, each with a weight. Sums of weights are exact: each weight is rounded once to a whole number
/// times 2^exponent(), where the exponent depends on the largest weight and the number of lights alone, and whole
/// numbers are added. So a sum does not depend on the order of the lights, on the device, or on how the work was
/// divided.
class Lights {
public:
    Lights() = default;
    /// `weights`: one per light, negative ones too, or none at all: 1 each. Throws InvalidArgument with the index of
    /// the first light that no maker of Light could have made, or of the first weight that is NaN or infinite, or if
    /// the numbers differ.
    explicit Lights(std::vector<Light> lights, std::vector<float> weights = {});

    std::size_t count() const { return lights_.size(); }                    ///< of lights
    std::span<const Light> lights() const { return lights_; }               ///< in the order in which they were given
    std::span<const float> weights() const { return weights_; }             ///< one per light, as given or 1
    std::span<const std::int64_t> whole_weights() const { return whole_; }  ///< one per light, in units of 2^exponent()
    int exponent() const { return exponent_; }                              ///< of whole_weights()
    /// The most by which a weight was rounded.
    double largest_rounding() const { return largest_rounding_; }

private:
    std::vector<Light> lights_;
    std::vector<float> weights_;
    std::vector<std::int64_t> whole_;
    int exponent_ = 0;
    double largest_rounding_ = 0;
};

/// A disk in the sky, such as the sun's (0.533 degrees across): directional lights around the one that travels along
/// `direction`, weight 1 each. Light i of n lies at sqrt((i + 1/2) / n) of the disk's radius, i golden angles around
/// its centre (Vogel, "A better way to construct the sunflower head", 1979). Throws InvalidArgument if the direction is
/// zero or not finite, the angle not between 0 and 90 degrees (exclusive), or `samples` 0.
Lights sun_disk(const Float3& direction, double angle_degrees, std::uint32_t samples);
/// A parallelogram that shines: point lights at corner + a edge_a + b edge_b, weight 1 each, where (a, b) for light i
/// of n is ((i + 1/2) / n, the i-th number of van der Corput's sequence in base 2) (Hammersley's points). Throws
/// InvalidArgument if a coordinate is not finite, or `samples` 0.
Lights area_light(const Float3& corner, const Float3& edge_a, const Float3& edge_b, std::uint32_t samples);
/// The sky's hemisphere around `up` in `division`^2 times as many patches as Tregenza's 145 ("Subdivision of the sky
/// hemisphere for luminance measurements", 1987), as Reinhart divides each: 145, 577, 1297 ... directional lights from
/// the patches' centres. A weight is the patch's solid angle times the cosine of its angle to `up`, over pi: the
/// weights' sum is nearly 1. The first patch of each row lies at the azimuth of `north`. Throws InvalidArgument if `up`
/// or `north` is zero or not finite, the two are parallel, or the division is not from 1 to 16.
Lights sky_patches(const Float3& up, const Float3& north, std::uint32_t division = 1);

}  // namespace gnomon

#pragma GCC visibility pop
