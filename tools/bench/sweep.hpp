// SPDX-License-Identifier: MIT
// Which settings of which technique the scatter of run time against error shows.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "row.hpp"

namespace gnomon::bench {

struct Configuration {
    std::string technique;
    Settings settings;
    std::string mode =
        "animated";             ///< nothing is kept between runs; moving: clusters are; static: the light is prepared
    std::uint32_t samples = 1;  ///< per pixel; several are found, and decided, by run_samples()
    /// Lights on the sun's disk, each decided; none: the directional light.
    std::uint32_t sun_samples = 0;
    /// Of a comparison on equal terms (put_on_equal_terms()): the settings before, and the terms. Else empty.
    Settings asked{};
    std::string terms{};
};

/// Every registered technique with its defaults. The first is exact.
std::vector<Configuration> default_configurations();

/// The same, and after each technique the settings that the table in sweep.cpp has for it; of maps, those of at most so
/// many texels per side.
std::vector<Configuration> swept_configurations(std::uint32_t largest_map = 8192);

/// Gives what is compared the same texels and the same fit, and says both in `terms`. A size, the usual one where none
/// is asked for, is that of one map: where a technique has several (cascades, sides of the view, a point light's six
/// faces), they share its texels evenly. A map fits the receivers, where the technique doesn't define a fit of its own
/// (stabilised and quantised cascades) and no setting was asked for. What takes texels as it needs them, or none, keeps
/// its own.
void put_on_equal_terms(Configuration& configuration, std::uint32_t usual_size, bool is_point_light);

/// Every way to so many lights (`many-lights` of the exact technique), the automatic choice first. Thousands of lights
/// one by one would take minutes, so that way is among them for 1,024 lights at most; horizons for a height field.
std::vector<Configuration> many_lights_configurations(std::size_t lights, bool is_height_field);

/// Shadow maps with constant, slope-scaled, adaptive and dual-layer bias of several strengths.
std::vector<Configuration> bias_configurations();

/// The exact truth with so many lights on a disk of this angle, the hard shadow, and what blurs a map's edges: pcss
/// with this disk, and each filter.
std::vector<Configuration> soft_configurations(double sun_angle_degrees, std::uint32_t sun_samples);

/// The technique whose answer the others are measured against, with its defaults.
Configuration truth_configuration();

/// What a mark's colour says.
struct Family {
    std::string name;
    std::vector<std::string> techniques;
};
/// Each technique, gnomon's or a rival's, is in one of these.
const std::vector<Family>& families();

}  // namespace gnomon::bench
