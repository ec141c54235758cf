// SPDX-License-Identifier: MIT
// Stage classify_footprints: a footprint that is called lit, or in shadow, is so at every sample of its fragment, by
// the oracle.
#include <gtest/gtest.h>

#include <iostream>

#include "reference/bvh.hpp"
#include "reference/visibility.hpp"
#include "support/device.hpp"
#include "support/fragment_stages.hpp"
#include "support/pixel_scenes.hpp"

namespace {

using namespace support;

struct Tally {
    std::size_t shadowed = 0, lit = 0, mixed = 0;  ///< samples, by the classes of their footprints
};

/// `truth`: 1 for each sample in shadow.
void expect_classes_true(const RecordedSamples& recorded, const std::vector<std::uint8_t>& truth, Tally& tally) {
    for (const ClassifiedFragments& of : recorded.classified)
        for (std::size_t slot = 0; slot < of.used; ++slot) {
            if (of.masks[slot] == 0) continue;
            const float found = of.classes[slot];
            ASSERT_TRUE(found == 0 || found == 1 || found == VISIBILITY_MIXED) << "fragment " << slot << ": " << found;
            recorded.for_samples(of, slot, [&](std::size_t place, std::uint32_t sample) {
                ++(found == 0 ? tally.shadowed : found == 1 ? tally.lit : tally.mixed);
                const bool is_dark = truth[sample * recorded.pixels() + place] != 0;
                if ((found == 0 && !is_dark) || (found == 1 && is_dark)) {
                    ADD_FAILURE() << "sample " << sample << " of pixel " << place << ", fragment " << slot << " on "
                                  << of.receivers[slot]
                                  << (found == 0 ? ", called dark, is lit" : ", called lit, is dark");
                }
            });
            if (testing::Test::HasFailure()) return;
        }
}

/// A fan whose triangles are one another's neighbours at a corner, and what hangs over that corner.
CameraScene crowded_corner() {
    Floats triangles = dust(40, 3);
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        triangles[i] /= 6, triangles[i + 1] /= 6;
        triangles[i + 2] += 0.01f;
    }
    for (const Float3& at : {Float3{0, 0, 0}, Float3{4.3f, -3.1f, 0}, Float3{-5, 2.2f, 0}}) {
        Floats fan = needle_fan(24, 3);  // in the plane y = 0
        for (std::size_t i = 0; i < fan.size(); i += 3) std::swap(fan[i + 1], fan[i + 2]);
        append(triangles, placed(fan, 1, {at[0], at[1], at[2]}));
    }
    CameraScene scene = floor_scene("crowded corner", triangles, {0.5f, 0.5f, 12});
    scene.triangles.resize(triangles.size());  // no floor
    return scene;
}

/// A floor under a roof of the same outline, seen from aside: footprints reach over the border of all triangles.
CameraScene roofed() {
    Floats triangles;
    for (const float z : {0.0f, 6.0f}) {
        add(triangles, {-8.3f, -8.1f, z}, {8.2f, -8.1f, z}, {8.2f, 8.4f, z});
        add(triangles, {-8.3f, -8.1f, z}, {8.2f, 8.4f, z}, {-8.3f, 8.4f, z});
    }
    CameraScene scene = floor_scene("roofed", triangles, {-24, 6, 5});
    scene.triangles.resize(triangles.size());  // no other floor
    return scene;
}

std::vector<CameraScene> scenes() {
    auto chosen = named_camera_scenes({"ball", "inside a ball", "soup around the eye", "needles", "tiny ball"});
    for (const CameraScene& scene : hard_pixel_scenes()) chosen.push_back(scene);
    chosen.push_back(crowded_corner());
    chosen.push_back(roofed());
    return chosen;
}

std::vector<gnomon::Light> lights() {
    return {gnomon::Light::directional({0, 0, -1}),          // straight down
            gnomon::Light::point({0.2f, 0.3f, 0.5f}),        // among the triangles
            gnomon::Light::point({3, -2, 9}),                // above them
            gnomon::Light::directional({0.3f, 0.2f, -1}),    //
            gnomon::Light::directional({1, 0, -1}),          // along the squares' lattice
            gnomon::Light::directional({1, 0.3f, -0.01f})};  // grazing
}

void expect_law(const gnomon::Device& device, Classify classify, std::uint32_t map_size,
                const std::vector<std::size_t>& of_lights) {
    Tally tally;
    for (const CameraScene& scene : scenes())
        for (const std::size_t i : of_lights) {
            SCOPED_TRACE(scene.name + ", light " + std::to_string(i));
            const gnomon::Light light = lights()[i];
            const RecordedSamples recorded = record_samples(device, scene, light, 8, classify, map_size);
            const auto truth =
                reference::shadowed(scene.triangles, recorded.positions, recorded.receivers, light.xyzw, scene.eye);
            expect_classes_true(recorded, truth, tally);
            if (testing::Test::HasFailure()) return;
        }
    std::cout << tally.shadowed << " samples called dark, " << tally.lit << " lit, " << tally.mixed << " mixed\n";
    // Each class occurs. How often each does is the device's: an H100 calls a third as many lit below the map as a CPU.
    for (const std::size_t count : {tally.shadowed, tally.lit, tally.mixed}) EXPECT_GT(count, 1000u);
}

TEST(ClassifyFootprints, EqualsReferenceAtEverySample) {
    expect_law(device_with(), Classify::by_frustum_traced, 0, {0, 1, 2, 3, 4, 5});
}
// Texels that are smaller than most triangles, so that many footprints lie below several of them.
TEST(ClassifyFootprints, EqualsReferenceBelowTheMap) {
    expect_law(device_with(), Classify::by_frustum_traced, 256, {0, 3});
}
TEST(ClassifyFootprints, EqualsReferenceOverPreparedLists) {
    expect_law(device_with(), Classify::prepared, 128, {0, 2, 3});
}
TEST(ClassifyFootprints, EqualsReferenceByKernelsForGpus) {
    gnomon::DeviceOptions options;
    options.gpu_kernels = true;
    options.work_group_size = 33;  // of which samples_test has the kernels
    expect_law(gnomon::Device({}, options), Classify::by_frustum_traced, 0, {1, 2, 3});
}

}  // namespace
