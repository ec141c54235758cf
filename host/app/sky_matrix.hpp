// SPDX-License-Identifier: MIT
// The sky of a weather file's hours, by Radiance's program gendaymtx.
#pragma once

#include "weather_file.hpp"

namespace gnomon::app {

/// Perez' sky over all hours: each of Tregenza's 145 patches in four parts, from whose middle its light comes; weights
/// are Wh/m2 on what looks at a part. `weather` must have diffuse irradiance. Throws Error if gendaymtx is not on the
/// PATH, or fails.
SunTable sky_of_weather(const WeatherFile& weather, double north_degrees);

}  // namespace gnomon::app
