// SPDX-License-Identifier: MIT
// Hours of sun: eleven suns of a day, three points beside a wall. The sun goes from the east (+x) over the zenith to
// the west; the wall stands on the line x = 0 and is 10 m high.
#include <gnomon.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

int main() try {
    const std::vector<float> wall{0, 0, -999, 0, 0, 999, 0, 10, 999, 0, 0, -999, 0, 10, 999, 0, 10, -999};
    const std::vector<float> ground{8, 0, 0, -8, 0, 0, 100, 0, 0};  // 8 m east of the wall, 8 m west, 100 m east
    const gnomon::Device device;
    const auto triangles = gnomon::Triangles::upload(device, wall);
    const auto points = gnomon::Points::upload(device, ground);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    // README begins
    std::vector<gnomon::Light> suns;
    for (int hour = 7; hour <= 17; ++hour) {  // 15 degrees an hour; at 12 o'clock the sun is in the zenith
        const double angle = (hour - 6) * std::acos(-1.0) / 12;
        suns.push_back(gnomon::Light::directional({-float(std::cos(angle)), -float(std::sin(angle)), 0}));
    }
    const gnomon::Lights table(suns, std::vector<float>(suns.size(), 1));  // each sun weighs one hour
    const gnomon::LightsOnHost found = gnomon::run_light_table_to_host(
        *technique, triangles, points, table, {.sums = true, .first_lit = true, .last_lit = true});
    for (std::size_t i = 0; i < points.count(); ++i)
        std::printf("point %zu: %g hours of sun, from %u to %u o'clock\n", i, found.sums[i], 7 + found.first_lit[i],
                    7 + found.last_lit[i]);
    // README ends
    // 8 m from the wall the sun is hidden while it is lower than atan(10 / 8) = 51 degrees on the wall's other side:
    // at 45, 30 and 15 degrees. 100 m away it would have to be lower than 6 degrees.
    const bool is_right = found.sums == std::vector<double>{8, 8, 11} &&
                          found.first_lit == std::vector<std::uint32_t>{0, 3, 0} &&
                          found.last_lit == std::vector<std::uint32_t>{7, 10, 10};
    return is_right ? 0 : 1;
} catch (const gnomon::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
