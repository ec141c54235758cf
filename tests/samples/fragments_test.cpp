// SPDX-License-Identifier: MIT
// Stage fragments, by coverage masks on a CPU and by the kernels for GPUs: each sample is in one fragment or sees the
// sky, and its fragment's receiver is the one that the sample's exact ray gives it.
#include <gtest/gtest.h>

#include <iostream>

#include "support/device.hpp"
#include "support/fragment_stages.hpp"
#include "support/pixel_scenes.hpp"

namespace {

using namespace support;

constexpr std::uint32_t SKY = gnomon::no_receiver, NONE = gnomon::no_receiver - 1;

/// The receiver that its fragment gives to each sample, sample by sample.
std::vector<std::uint32_t> receivers_of_fragments(const RecordedSamples& recorded) {
    const ClassifiedFragments& of = recorded.classified.front();
    std::vector<std::uint32_t> receivers(recorded.samples * recorded.pixels(), NONE);
    for (std::size_t slot = 0; slot < of.used; ++slot)
        recorded.for_samples(of, slot, [&](std::size_t place, std::uint32_t sample) {
            std::uint32_t& receiver = receivers[sample * recorded.pixels() + place];
            EXPECT_EQ(receiver, NONE) << "sample " << sample << " of pixel " << place << " is in two fragments";
            receiver = of.receivers[slot];
        });
    return receivers;
}

/// Samples that see the sky are lit already. `receivers` of them becomes SKY.
void expect_sky_counted(const RecordedSamples& recorded, std::vector<std::uint32_t>& receivers) {
    const ClassifiedFragments& of = recorded.classified.front();
    for (std::uint32_t pixel = 0; pixel < of.pixels; ++pixel) {
        const auto place = recorded.place_of(pixel);
        if (!place) continue;
        std::uint32_t sky = 0;
        for (std::uint32_t sample = 0; sample < recorded.samples; ++sample) {
            std::uint32_t& receiver = receivers[sample * recorded.pixels() + *place];
            if (receiver != NONE) continue;
            receiver = SKY;
            ++sky;
        }
        ASSERT_EQ(of.lit[pixel], sky) << "pixel " << *place;
    }
}

struct Tally {
    std::size_t on_own = 0, on_others = 0, sky = 0, ties = 0;
};

/// The first triangle with the same corners in the same order.
std::uint32_t first_copy(const Floats& triangles, std::uint32_t id) {
    const auto corners = triangles.begin() + 9 * std::ptrdiff_t(id);
    auto first = triangles.begin();
    while (!std::equal(first, first + 9, corners)) first += 9;
    return std::uint32_t((first - triangles.begin()) / 9);
}

/// A pixel's own receiver has all samples whose rays meet it; else the nearest triangle has the sample, where two that
/// are nearer to each other than 2^-28 of their depth count as equally near (kernels/camera/camera.h).
void expect_receivers(const RecordedSamples& recorded, const CameraScene& scene,
                      const std::vector<std::uint32_t>& receivers, Tally& tally) {
    constexpr long double SAME_DEPTH = 0x1p-28L;
    const auto pattern = gnomon::sample_pattern(recorded.samples);
    for (std::uint32_t sample = 0; sample < recorded.samples; ++sample) {
        const auto tables = gnomon::camera_tables(scene.camera(), scene.width, scene.height, pattern[sample]);
        for (std::size_t place = 0; place < recorded.pixels(); ++place) {
            const auto ray = exact_ray(tables, std::uint32_t(place % scene.width), std::uint32_t(place / scene.width));
            const std::uint32_t found = receivers[sample * recorded.pixels() + place],
                                own = recorded.pixel_receivers[place];
            const auto met = reference::meetings(ray, scene.triangles);
            const auto meets = [&](std::uint32_t id) { return std::ranges::find(met, id, &reference::Meeting::id); };
            SCOPED_TRACE("sample " + std::to_string(sample) + " of pixel " + std::to_string(place));
            ASSERT_EQ(found == SKY, met.empty());
            if (met.empty()) {
                ++tally.sky;
            } else if (meets(own) != met.end()) {
                ASSERT_EQ(found, own);
                ++tally.on_own;
            } else {
                ASSERT_NE(meets(found), met.end());
                ASSERT_LE(meets(found)->parameter, met[0].parameter * (1 + SAME_DEPTH));
                ASSERT_EQ(found, first_copy(scene.triangles, found)) << "of copies the first";
                ++tally.on_others;
                tally.ties += met.size() > 1 && met[1].parameter == met[0].parameter;
            }
        }
    }
}

/// Many triangles with the same corners over the floor: at every sample on them there is a tie.
CameraScene copies() {
    Floats triangles;
    for (int i = 0; i < 60; ++i) {
        add(triangles, {-5.3f, -3.1f, 2}, {6.2f, -4.7f, 2}, {0.4f, 7.9f, 2});
        add(triangles, {-7, 5 - 0.25f * float(i), 1}, {-2, 5, 1}, {-7, 9, 1});
    }
    return floor_scene("copies", triangles, {0.5f, 0.5f, 32});
}

void expect_law(const gnomon::Device& device, Tally& tally, std::vector<std::string>& stages) {
    std::vector<CameraScene> scenes =
        named_camera_scenes({"soup around the eye", "large soup", "eye in a wall's plane"});
    for (const CameraScene& scene : hard_pixel_scenes())
        if (scene.name == "dust" || scene.name == "squares" || scene.name == "slivers") scenes.push_back(scene);
    scenes.push_back(copies());
    for (const CameraScene& scene : scenes) {
        SCOPED_TRACE(scene.name);
        const std::uint32_t samples = scene.name == "copies" ? 32 : 8;
        const gnomon::Light light = gnomon::Light::directional({0.3f, -1, 0.2f});
        const RecordedSamples recorded = record_samples(device, scene, light, samples, Classify::nothing);
        std::vector<std::uint32_t> receivers = receivers_of_fragments(recorded);
        expect_sky_counted(recorded, receivers);
        expect_receivers(recorded, scene, receivers, tally);
        for (const auto& stage : recorded.statistics.stages) stages.push_back(stage.name);
        if (testing::Test::HasFailure()) return;
    }
    std::cout << tally.on_own << " samples on their pixel's receiver, " << tally.on_others << " on others, "
              << tally.ties << " of them ties, " << tally.sky << " of sky\n";
    EXPECT_GT(tally.on_own, 10000u);
    EXPECT_GT(tally.on_others, 1000u);
    EXPECT_GT(tally.ties, 100u);
    EXPECT_GT(tally.sky, 1000u);
}

TEST(Fragments, ReceiversEqualReferenceByCoverageMasks) {
    Tally tally;
    std::vector<std::string> stages;
    expect_law(device_with(), tally, stages);
}

// Not vacuous: pixels go all the ways that there are, by masks alone, by open pairs, and by an item for each sample.
TEST(Fragments, ReceiversEqualReferenceByKernelsForGpus) {
    gnomon::DeviceOptions options;
    options.gpu_kernels = true;
    options.work_group_size = 33;  // of which samples_test has the kernels
    Tally tally;
    std::vector<std::string> stages;
    expect_law(gnomon::Device({}, options), tally, stages);
    for (const char* stage : {"samples_masks_gpu", "samples_filter", "samples_open_pairs", "samples_fragments"})
        EXPECT_NE(std::ranges::find(stages, stage), stages.end()) << stage;
}

}  // namespace
