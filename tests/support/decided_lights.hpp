// SPDX-License-Identifier: MIT
// What horizons and sweeps decide of each pair of a point and a light, before beams decide the rest, compared with the
// oracle.
#pragma once

#include <gtest/gtest.h>

#include <ostream>

#include "light_scene.hpp"
#include "light_tables/light_masks.hpp"

namespace support {

struct Decided {
    std::size_t pairs = 0, lit = 0, dark = 0;
    void operator+=(const Decided& other) {
        pairs += other.pairs;
        lit += other.lit;
        dark += other.dark;
    }
    friend std::ostream& operator<<(std::ostream& to, const Decided& of) {
        return to << of.pairs << " pairs, " << of.lit << " lit, " << of.dark << " dark";
    }
};

/// Expects that each pair that `masks` have closed is lit or dark as the oracle says. `scene`: with the run's points.
inline Decided expect_truth(LightScene scene, const gnomon::LightsRun& run, const gnomon::SortedPoints& sorted,
                            const gnomon::LightBundles& bundles, gnomon::LightMasks& masks) {
    gnomon::cl::Session& session = gnomon::session_of(run.device);
    const std::size_t points = run.points.count(), words = masks.max_points() * bundles.bundles.size();
    const auto open = session.read_values<std::uint32_t>(masks.masks().get(), words);
    const auto lit = session.read_values<std::uint32_t>(masks.for_horizons().lit.get(), words);
    const auto order = session.read_values<std::uint32_t>(sorted.order().get(), points);
    Decided decided;
    for (std::size_t slot = 0; slot < bundles.lights.size(); ++slot) {
        const std::uint32_t light = bundles.lights[slot];
        if (light == gnomon::no_light) continue;
        scene.light = run.lights.lights()[light].xyzw;
        const std::vector<float> truth = truth_of(scene);
        for (std::size_t i = 0; i < points; ++i) {
            const std::size_t word = slot / 32 * masks.max_points() + i;
            const bool is_open = (open[word] >> slot % 32 & 1) != 0, is_lit = (lit[word] >> slot % 32 & 1) != 0;
            EXPECT_FALSE(is_open && is_lit);
            ++decided.pairs;
            if (is_open) continue;
            EXPECT_EQ(is_lit, truth[order[i]] != 0) << "point " << order[i] << ", light " << light << ": "
                                                    << scene.light[0] << "," << scene.light[1] << "," << scene.light[2];
            ++(is_lit ? decided.lit : decided.dark);
        }
        if (testing::Test::HasFailure()) break;
    }
    return decided;
}

}  // namespace support
