// SPDX-License-Identifier: MIT
// Stage footprints: the shading point of every sample of a fragment lies in the fragment's footprint.
#include <gtest/gtest.h>

#include <iostream>

#include "support/device.hpp"
#include "support/fragment_stages.hpp"
#include "support/pixel_scenes.hpp"

namespace {

using namespace support;

struct Corner {
    long double a, b;
};

/// The part of a convex polygon where x a + y b <= most.
std::vector<Corner> clipped(const std::vector<Corner>& polygon, long double x, long double y, long double most) {
    std::vector<Corner> part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const long double at_from = x * from.a + y * from.b - most, at_to = x * to.a + y * to.b - most;
        if (at_from <= 0) part.push_back(from);
        if ((at_from < 0 && at_to > 0) || (at_from > 0 && at_to < 0)) {
            const long double t = at_from / (at_from - at_to);
            part.push_back({from.a + t * (to.a - from.a), from.b + t * (to.b - from.b)});
        }
    }
    return part;
}

/// Whether P = C + a U + b V + d for some |a|, |b| <= 1 and |d_i| <= spread (kernels/receivers/footprint.h). In long
/// double: its roundings are 2^-40 of the roundings that a spread allows for.
bool is_in_footprint(const ClassifiedFragments& of, std::size_t slot, const Float3& p) {
    const Float3 centre = of.centre(slot);
    const long double spread = of.shape(6, slot);
    std::vector<Corner> possible{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t c = 0; c < 3 && !possible.empty(); ++c) {
        const long double off = (long double)(p[c]) - centre[c], u = of.shape(c, slot), v = of.shape(3 + c, slot);
        possible = clipped(possible, u, v, off + spread);
        possible = clipped(possible, -u, -v, spread - off);
    }
    return !possible.empty();
}

struct Tally {
    std::size_t samples = 0, unbounded = 0, squares = 0, extra = 0;
};

void expect_samples_in_footprints(const RecordedSamples& recorded, Tally& tally) {
    for (const ClassifiedFragments& of : recorded.classified)
        for (std::size_t slot = 0; slot < of.used; ++slot) {
            if (of.masks[slot] == 0) continue;
            const bool is_bounded = std::isfinite(of.shape(6, slot));
            tally.extra += slot >= of.pixels;
            tally.squares += slot >= of.pixels && (of.extra_pixels[slot - of.pixels] & IS_SQUARE) != 0;
            recorded.for_samples(of, slot, [&](std::size_t place, std::uint32_t sample) {
                ++tally.samples;
                tally.unbounded += !is_bounded;
                if (is_bounded && !testing::Test::HasFailure()) {
                    EXPECT_TRUE(
                        is_in_footprint(of, slot, vertex(recorded.positions, sample * recorded.pixels() + place)))
                        << "sample " << sample << " of pixel " << place << ", fragment " << slot;
                }
            });
        }
}

// Far places, small ones and steep ones: where the roundings of footprints are largest.
std::vector<CameraScene> scenes() {
    auto chosen =
        named_camera_scenes({"ball", "inside a ball", "soup around the eye", "large soup", "ball at 100000.000000",
                             "tiny ball", "grazing needles", "fisheye", "telescope"});
    chosen.push_back(floor_scene("along the floor", squares_on_samples(40, 11), {-60, 0.25f, 0.5f}));
    for (const CameraScene& scene : hard_pixel_scenes()) chosen.push_back(scene);
    return chosen;
}

void expect_law(const gnomon::Device& device, std::uint32_t samples) {
    Tally tally;
    for (const CameraScene& scene : scenes())
        for (const bool is_directional : {true, false}) {
            SCOPED_TRACE(scene.name);
            const gnomon::Light light =
                is_directional ? gnomon::Light::directional({0.3f, -1, 0.2f}) : gnomon::Light::point({1.5f, 2, 1.25f});
            expect_samples_in_footprints(record_samples(device, scene, light, samples, Classify::nothing), tally);
            if (testing::Test::HasFailure()) return;
        }
    std::cout << tally.samples << " samples, " << tally.unbounded << " of unbounded footprints; " << tally.extra
              << " fragments beside the pixels' own, " << tally.squares << " squares\n";
    EXPECT_GT(tally.extra, 3000u);
    EXPECT_LT(tally.unbounded, tally.samples / 20);
    EXPECT_EQ(tally.squares > 100, session_of(device).is_cpu());
}

TEST(Footprints, HoldTheirSamples) { expect_law(device_with(), 8); }

TEST(Footprints, HoldTheirSamplesByKernelsForGpus) {
    gnomon::DeviceOptions options;
    options.gpu_kernels = true;
    options.work_group_size = 33;  // of which samples_test has the kernels
    expect_law(gnomon::Device({}, options), 8);
}

}  // namespace
