// SPDX-License-Identifier: MIT
// Stage samples: the patterns against their published definitions; each sample's ray, receiver and point against exact
// rays; the mean against the oracle's visibility of every sample.
#include "samples/samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iostream>
#include <set>

#include "kernels/receivers/footprint.h"
#include "reference/predicates.hpp"
#include "reference/visibility.hpp"
#include "support/device.hpp"
#include "support/pixel_scenes.hpp"

namespace {

using namespace support;
using gnomon::SampleOffset;

/// Sample by sample, each pixel by pixel.
struct Samples {
    Floats position;
    std::vector<std::uint32_t> receiver;
    std::vector<float> mean;
    std::vector<std::uint32_t> pixel_receiver;
    gnomon::Statistics statistics;
};

constexpr std::size_t ALL_AT_ONCE = 1u << 20;

Samples sampled(const gnomon::Device& device, const CameraScene& scene, const gnomon::Light& light,
                std::uint32_t samples, std::size_t points_at_once = ALL_AT_ONCE) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
    const gnomon::Visibility mean(device, view.points.count());
    Samples result;
    const auto keep = [&](const gnomon::Points& points) {
        const std::size_t count = points.count();
        const Floats planes = downloaded<float>(session_of(device), points.positions(), 3 * count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) result.position.push_back(planes[i + c * count]);
        const auto ids = downloaded<std::uint32_t>(session_of(device), points.receivers(), count);
        result.receiver.insert(result.receiver.end(), ids.begin(), ids.end());
    };
    const auto technique = gnomon::make_technique("frustum-traced", device);
    result.statistics =
        gnomon::run_samples_in_batches(*technique, triangles, view, light, samples, mean, keep, points_at_once);
    result.mean = mean.read();
    result.pixel_receiver = downloaded<std::uint32_t>(session_of(device), view.points.receivers(), view.points.count());
    return result;
}

/// Small scenes with creases, silhouettes against the sky, ties and needles.
std::vector<CameraScene> scenes() {
    std::vector<CameraScene> chosen;
    for (const CameraScene& scene : camera_scenes())
        for (const char* name : {"ball", "inside a ball", "soup around the eye", "large soup", "needles", "tiny ball",
                                 "eye in a wall's plane", "one pixel"})
            if (scene.name == name) chosen.push_back(scene);
    return chosen;
}

constexpr std::uint32_t COUNTS[] = {1, 4, 8, 16, 32};

// D3D11_STANDARD_MULTISAMPLE_PATTERN as Microsoft documents it, in sixteenths; copied from there, not from gnomon.
TEST(Samples, PatternsAreDirect3ds) {
    const auto expect = [](std::uint32_t samples, const std::vector<std::array<int, 2>>& sixteenths) {
        const auto pattern = gnomon::sample_pattern(samples);
        ASSERT_EQ(pattern.size(), sixteenths.size());
        for (std::size_t i = 0; i < pattern.size(); ++i) {
            EXPECT_EQ(pattern[i].x, 4 * sixteenths[i][0]) << samples << " samples, number " << i;
            EXPECT_EQ(pattern[i].y, 4 * sixteenths[i][1]) << samples << " samples, number " << i;
        }
    };
    expect(1, {{0, 0}});
    expect(4, {{-2, -6}, {6, -2}, {-6, 2}, {2, 6}});
    expect(8, {{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}});
    expect(16, {{1, 1},
                {-1, -3},
                {-3, 2},
                {4, -1},
                {-5, -2},
                {2, 5},
                {5, 3},
                {3, -5},
                {-2, 6},
                {0, -7},
                {-4, -6},
                {-6, 4},
                {-8, 0},
                {7, -4},
                {6, 7},
                {-7, -8}});
    for (const std::uint32_t count : {0u, 2u, 3u, 31u, 33u, 64u})
        EXPECT_THROW(gnomon::sample_pattern(count), gnomon::InvalidArgument) << count;
}

// 32 well-spread points: each of the 32 equal rectangles of each shape contains one point.
TEST(Samples, ThirtyTwoFillEveryElementaryRectangle) {
    const auto pattern = gnomon::sample_pattern(32);
    ASSERT_EQ(pattern.size(), 32u);
    for (int columns = 1; columns <= 32; columns *= 2) {
        std::set<std::pair<int, int>> met;
        for (const SampleOffset& offset : pattern) {
            ASSERT_TRUE(offset.x >= -32 && offset.x < 32 && offset.y >= -32 && offset.y < 32);
            met.emplace((offset.x + 32) * columns / 64, (offset.y + 32) * (32 / columns) / 64);
        }
        EXPECT_EQ(met.size(), 32u) << columns << " columns";
    }
}

/// The ideal direction through a position in the picture, in pixels from its upper left corner.
std::array<long double, 3> ideal_direction(const gnomon::Camera& camera, double width, double height, long double x,
                                           long double y) {
    const long double pixel = std::tan(static_cast<long double>(camera.fov_y_radians) / 2) / (height / 2);
    std::array<long double, 3> direction{};
    for (std::size_t i = 0; i < 3; ++i)
        direction[i] =
            camera.forward[i] + (x - width / 2) * pixel * camera.right[i] + (height / 2 - y) * pixel * camera.up[i];
    return direction;
}

// Every ray of every sample is the ideal one up to 2^-46. Not vacuous: half a unit of an offset is 2^-7 of a pixel.
TEST(Samples, RaysPassThroughTheirPositions) {
    for (const CameraScene& scene : scenes())
        for (const std::uint32_t count : COUNTS)
            for (const SampleOffset& offset : gnomon::sample_pattern(count)) {
                const gnomon::Camera camera = scene.camera();
                const gnomon::CameraTables tables = gnomon::camera_tables(camera, scene.width, scene.height, offset);
                for (const std::uint32_t x : {0u, scene.width - 1})
                    for (const std::uint32_t y : {0u, scene.height - 1}) {
                        const auto ideal = ideal_direction(camera, scene.width, scene.height,
                                                           x + 0.5L + offset.x / 64.0L, y + 0.5L + offset.y / 64.0L);
                        const float* column = &tables.rays[6 * std::size_t(x)];
                        const float* row = &tables.rays[6 * (std::size_t(scene.width) + y)];
                        for (std::size_t i = 0; i < 3; ++i) {
                            const long double sum = static_cast<long double>(column[i]) + column[i + 3] +
                                                    static_cast<long double>(row[i]) + row[i + 3];
                            ASSERT_NEAR(static_cast<double>(sum - ideal[i]), 0, 0x1p-46 * 4) << scene.name;
                        }
                    }
            }
}

// The device makes the same tables as the host, to the bit.
TEST(Samples, RaysOfTheDeviceAreTheHosts) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    for (const CameraScene& scene : scenes())
        for (const std::uint32_t count : {4u, 32u}) {
            const gnomon::Camera camera = scene.camera();
            const gnomon::SamplePattern pattern = gnomon::pattern_of(gnomon::sample_pattern(count));
            // One entry for each sample of each column, then of each row.
            std::vector<float> expected(std::size_t(scene.width + scene.height) * count * RAY_FLOATS);
            std::size_t sample = 0;
            for (const SampleOffset& offset : gnomon::sample_pattern(count)) {
                const auto rays = gnomon::camera_tables(camera, scene.width, scene.height, offset).rays;
                for (std::size_t i = 0; i < rays.size(); ++i)
                    expected[(i / RAY_FLOATS * count + sample) * RAY_FLOATS + i % RAY_FLOATS] = rays[i];
                ++sample;
            }
            const auto patterns = uploaded(session, std::vector{pattern});
            const gnomon::cl::Buffer rays(session, expected.size() * sizeof(float));
            session.launch("samples/samples.cl", "samples_rays", gnomon::cl::Range::items(100),
                           gnomon::ray_axes(camera, scene.width, scene.height), patterns, rays);
            const auto seen = downloaded<float>(session, rays.get(), expected.size());
            EXPECT_EQ(std::memcmp(seen.data(), expected.data(), expected.size() * sizeof(float)), 0) << scene.name;
        }
}

// The receiver of each sample, by its exact ray: the pixel's receiver if the ray meets it, else the nearest triangle.
// The point: on the eye's side of its receiver, near the exact hit. Not vacuous: the test counts samples of both kinds,
// and samples of the sky beside pixels that show a triangle.
TEST(Samples, ReceiversAndPointsEqualReference) {
    const gnomon::Device device = device_with();
    constexpr long double SAME_DEPTH = 0x1p-28L;  // kernels/camera/camera.h
    std::size_t on_pixels = 0, hidden_but_kept = 0, on_own = 0, sky = 0, sky_beside = 0;
    for (const CameraScene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const std::size_t pixels = std::size_t(scene.width) * scene.height;
        const std::uint32_t count = scene.width > 30 ? 4 : 16;
        const Samples seen = sampled(device, scene, gnomon::Light::directional({0.3f, -1, 0.2f}), count);
        const auto pattern = gnomon::sample_pattern(count);
        for (std::size_t k = 0; k < pattern.size(); ++k) {
            const gnomon::CameraTables tables =
                gnomon::camera_tables(scene.camera(), scene.width, scene.height, pattern[k]);
            for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
                const std::size_t i = k * pixels + pixel;
                const auto ray =
                    exact_ray(tables, std::uint32_t(pixel % scene.width), std::uint32_t(pixel / scene.width));
                const auto met = reference::meetings(ray, scene.triangles);
                const std::uint32_t id = seen.receiver[i], of_pixel = seen.pixel_receiver[pixel];
                const Float3 p = vertex(seen.position, i);
                ASSERT_EQ(id == gnomon::no_receiver, met.empty());
                if (met.empty()) {
                    ASSERT_TRUE(std::isnan(p[0]));
                    ++sky;
                    sky_beside += of_pixel != gnomon::no_receiver;
                    continue;
                }
                const auto find = [&](std::uint32_t wanted) {
                    return std::find_if(met.begin(), met.end(), [&](const auto& m) { return m.id == wanted; });
                };
                const auto found = find(id);
                ASSERT_NE(found, met.end()) << "sample " << k << " of pixel " << pixel << " misses its receiver";
                if (find(of_pixel) != met.end()) {
                    ASSERT_EQ(id, of_pixel) << "sample " << k << " of pixel " << pixel;
                    ++on_pixels;
                    hidden_but_kept += met[0].id != id;
                } else {
                    ASSERT_LE(found->parameter, met[0].parameter * (1 + SAME_DEPTH));
                    ++on_own;
                }
                const reference::Triangle t = {vertex(scene.triangles, 3 * id), vertex(scene.triangles, 3 * id + 1),
                                               vertex(scene.triangles, 3 * id + 2)};
                reference::Effort effort;
                ASSERT_EQ(reference::side_of_point(p, t, effort), reference::side_of_point(scene.eye, t, effort));
                const auto direction =
                    ideal_direction(scene.camera(), scene.width, scene.height,
                                    std::uint32_t(pixel % scene.width) + 0.5L + pattern[k].x / 64.0L,
                                    std::uint32_t(pixel / scene.width) + 0.5L + pattern[k].y / 64.0L);
                long double squared = 0, size = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const long double hit = scene.eye[c] + found->parameter * direction[c];
                    squared += (p[c] - hit) * (p[c] - hit);
                    size = std::max({size, std::fabs(hit), std::fabs(static_cast<long double>(scene.eye[c]))});
                }
                const double ulp = std::ldexp(1.0, std::max(std::ilogb(size), -126) - 23);
                ASSERT_LE(std::sqrt(squared), 16 * ulp) << "sample " << k << " of pixel " << pixel;
            }
        }
    }
    std::cout << on_pixels << " samples on their pixel's receiver (" << hidden_but_kept
              << " of them with something before it), " << on_own << " on their own, " << sky << " of sky, "
              << sky_beside << " of them in pixels that see a triangle\n";
    EXPECT_GT(on_pixels, 2000u);
    EXPECT_GT(hidden_but_kept, 20u);
    EXPECT_GT(on_own, 500u);
    EXPECT_GT(sky_beside, 50u);
}

// The mean of the oracle's visibilities, bit for bit. Not vacuous: pixels that are partly lit are counted.
TEST(Samples, MeanEqualsOracle) {
    const gnomon::Device device = device_with();
    std::size_t partly = 0, whole = 0;
    for (const CameraScene& scene : scenes())
        for (const gnomon::Light& light :
             {gnomon::Light::directional({0.3f, -1, 0.2f}), gnomon::Light::point({1.5f, 2, 1.25f})})
            for (const std::uint32_t count : COUNTS) {
                SCOPED_TRACE(scene.name + ", " + std::to_string(count) + " samples");
                const Samples seen = sampled(device, scene, light, count);
                const auto shadow =
                    reference::shadowed(scene.triangles, seen.position, seen.receiver, light.xyzw, scene.eye);
                const std::size_t pixels = seen.mean.size();
                ASSERT_EQ(shadow.size(), pixels * count);
                for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
                    std::uint32_t lit = 0;
                    for (std::uint32_t k = 0; k < count; ++k) lit += shadow[k * pixels + pixel] == 0;
                    ASSERT_EQ(seen.mean[pixel], float(lit) / float(count)) << "pixel " << pixel;
                    ++(lit != 0 && lit != count ? partly : whole);
                }
            }
    std::cout << partly << " pixels partly lit, " << whole << " wholly or not at all\n";
    EXPECT_GT(partly, 1000u);
    EXPECT_GT(whole, 1000u);
}

/// A technique with the same visibility that cannot classify footprints: every sample of every pixel is a point.
class EverySample final : public gnomon::Technique {
public:
    explicit EverySample(const gnomon::Device& device) : technique_(gnomon::make_technique("frustum-traced", device)) {}
    const gnomon::Device& device() const override { return technique_->device(); }
    gnomon::Statistics run_light(const gnomon::Triangles& triangles, const gnomon::Points& points,
                                 const gnomon::Light& light, const gnomon::Visibility& visibility) override {
        return gnomon::Internals::run_light(*technique_, triangles, points, light, visibility);
    }
    void set(std::string_view name, std::string_view value) override { technique_->set(name, value); }

private:
    std::unique_ptr<gnomon::Technique> technique_;
};

/// The numbers of samples decided by footprints and traced, and of partly lit pixels, over several runs.
struct Settled {
    std::uint64_t in_shadow = 0, lit = 0, traced = 0, on_one = 0, on_several = 0, partly = 0;
};

void expect_same_means(const gnomon::Device& device, const CameraScene& scene, const gnomon::Light& light,
                       std::uint32_t samples, Settled& sum, const char* map_size = "auto") {
    SCOPED_TRACE(scene.name + ", " + std::to_string(samples) + " samples");
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
    const gnomon::Visibility by_fragments(device, view.points.count()), expected(device, view.points.count());
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("conservative-map", "on");  // auto means off for so few points; mean_equals_oracle uses auto
    technique->set("map-size", map_size);
    const gnomon::Statistics statistics =
        gnomon::run_samples(*technique, triangles, view, light, samples, by_fragments);
    EverySample every(device);
    gnomon::run_samples(every, triangles, view, light, samples, expected);
    const std::vector<float> got = by_fragments.read(), wanted = expected.read();
    for (std::size_t pixel = 0; pixel < got.size(); ++pixel) {
        ASSERT_EQ(got[pixel], wanted[pixel]) << "pixel " << pixel;
        sum.partly += got[pixel] != 0 && got[pixel] != 1;
    }
    const std::uint64_t decided_samples =
        statistics.count("samples_decided_in_shadow") + statistics.count("samples_decided_lit");
    ASSERT_EQ(decided_samples + statistics.count("samples_traced"), got.size() * samples);
    sum.in_shadow += statistics.count("samples_decided_in_shadow");
    sum.lit += statistics.count("samples_decided_lit");
    sum.traced += statistics.count("samples_traced");
    sum.on_one += statistics.count("pixels_on_one_receiver");
    sum.on_several += statistics.count("pixels_on_several");
}

void expect_not_vacuous(const Settled& sum) {
    std::cout << sum.in_shadow << " samples decided in shadow, " << sum.lit << " lit, " << sum.traced << " traced; "
              << sum.on_one << " pixels on one receiver, " << sum.on_several << " on several, " << sum.partly
              << " partly lit\n";
    for (const std::uint64_t count : {sum.in_shadow, sum.lit, sum.traced}) EXPECT_GT(count, 5000u);
    for (const std::uint64_t count : {sum.on_one, sum.on_several, sum.partly}) EXPECT_GT(count, 500u);
}

/// Lights of both kinds, one of them grazing, one an exact diagonal of the lattices.
std::vector<gnomon::Light> lights() {
    return {gnomon::Light::directional({0.3f, -1, 0.2f}), gnomon::Light::directional({1, -0.02f, 0.4f}),
            gnomon::Light::directional({1, 0, -1}), gnomon::Light::point({1.5f, 2, 1.25f})};
}

TEST(Samples, MeansByFragmentsEqualEverySample) {
    const gnomon::Device device = device_with();
    Settled sum;
    for (const CameraScene& scene : camera_scenes())
        for (const gnomon::Light& light : lights()) expect_same_means(device, scene, light, 16, sum);
    for (const CameraScene& scene : scenes())
        for (const std::uint32_t samples : {4u, 8u, 32u}) expect_same_means(device, scene, lights()[0], samples, sum);
    expect_not_vacuous(sum);
    const gnomon::Device without({}, {.hide_fp64 = true});
    Settled soft;
    expect_same_means(without, scenes().front(), lights()[0], 16, soft);
    EXPECT_GT(soft.in_shadow + soft.lit, soft.traced);
}

// A prepared light's lists serve samples: the same means as by every sample of its own, and nothing of the lists is
// made anew. Not vacuous: classes of both kinds and traced samples are counted, and partly lit pixels.
TEST(Samples, PreparedLightsGiveTheSameMeans) {
    const gnomon::Device device = device_with();
    std::uint64_t in_shadow = 0, lit = 0, traced = 0, partly = 0;
    for (const CameraScene& scene : scenes())
        for (const gnomon::Light& light : lights())
            for (const char* map : {"on", "off"}) {
                SCOPED_TRACE(scene.name + ", map " + map);
                auto triangles = gnomon::Triangles::upload(device, scene.triangles);
                triangles.keep_clusters(device);
                const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
                const gnomon::Visibility prepared(device, view.points.count()), expected(device, view.points.count());
                const auto technique = gnomon::make_technique("frustum-traced", device);
                technique->set("conservative-map", map);
                technique->prepare(triangles, light);
                EverySample every(device);
                gnomon::run_samples(every, triangles, view, light, 8, expected);
                for (int run = 0; run < 2; ++run) {
                    const auto found = gnomon::run_samples(*technique, triangles, view, light, 8, prepared);
                    ASSERT_EQ(prepared.read(), expected.read()) << "run " << run;
                    ASSERT_EQ(found.count("prepared"), 1u);
                    const auto bins = std::ranges::find(found.stages, "bins", &gnomon::StageStatistics::name);
                    ASSERT_NE(bins, found.stages.end());
                    ASSERT_EQ(bins->skipped, "prepared");
                    in_shadow += found.count("samples_decided_in_shadow");
                    lit += found.count("samples_decided_lit");
                    traced += found.count("samples_traced");
                }
                for (const float mean : prepared.read()) partly += mean != 0 && mean != 1;
            }
    std::cout << in_shadow << " samples decided in shadow, " << lit << " lit, " << traced << " traced, " << partly
              << " pixels partly lit\n";
    for (const std::uint64_t count : {in_shadow, lit, traced}) EXPECT_GT(count, 5000u);
    EXPECT_GT(partly, 500u);
}

/// Calls every footprint mixed, so that every sample of every fragment becomes a point, and keeps these points.
class EveryFragmentMixed final : public gnomon::FootprintSession {
public:
    explicit EveryFragmentMixed(const gnomon::Device& device) : device_(device) {}

    std::vector<std::array<std::uint32_t, 4>> points;  ///< the bits of x, y and z, and the receiver

private:
    gnomon::Statistics classify(const gnomon::Footprints& footprints) override {
        const std::vector<float> mixed(footprints.classes.count(), VISIBILITY_MIXED);
        session_of(device_).write(footprints.classes.buffer(), mixed.data(), mixed.size() * sizeof(float));
        return {};
    }
    gnomon::Statistics classify_parts(const gnomon::Footprints& footprints) override { return classify(footprints); }
    gnomon::Statistics trace(const gnomon::Points& samples, const gnomon::Visibility&) override {
        const std::size_t stride = samples.layout().coordinate_stride, count = samples.count();
        const auto planes = downloaded<std::uint32_t>(session_of(device_), samples.positions(), 2 * stride + count);
        const auto ids = downloaded<std::uint32_t>(session_of(device_), samples.receivers(), count);
        for (std::size_t i = 0; i < count; ++i)
            points.push_back({planes[i], planes[stride + i], planes[2 * stride + i], ids[i]});
        return {};
    }

    gnomon::Device device_;
};

// The masks of fragments name the receivers that each sample finds by itself: the same points on the same receivers,
// bit for bit, none twice and none missing.
TEST(Samples, FragmentsHoldEverySampleOnce) {
    const gnomon::Device device = device_with();
    std::size_t points = 0, on_others = 0;
    for (const CameraScene& scene : camera_scenes())
        for (const std::uint32_t samples : {8u, 32u}) {
            SCOPED_TRACE(scene.name);
            const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
            const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
            const gnomon::Visibility mean(device, view.points.count());
            std::vector<std::array<std::uint32_t, 4>> expected;
            const auto own =
                downloaded<std::uint32_t>(session_of(device), view.points.receivers(), view.points.count());
            gnomon::SampleViews views(device, triangles, view, samples);
            for (std::size_t sample = 0; sample < samples; ++sample) {
                const gnomon::Points of_samples = views.at(sample).points;
                const std::size_t count = of_samples.count(), stride = of_samples.layout().coordinate_stride;
                const auto planes =
                    downloaded<std::uint32_t>(session_of(device), of_samples.positions(), 2 * stride + count);
                const auto ids = downloaded<std::uint32_t>(session_of(device), of_samples.receivers(), count);
                for (std::size_t i = 0; i < count; ++i) {
                    if (ids[i] == gnomon::no_receiver) continue;
                    expected.push_back({planes[i], planes[stride + i], planes[2 * stride + i], ids[i]});
                    on_others += ids[i] != own[i];
                }
            }
            EveryFragmentMixed by_fragments(device);
            std::shared_ptr<void> kept;
            gnomon::run_fragments(
                by_fragments, kept,
                {device, triangles, view, lights()[0], gnomon::sample_pattern(samples), mean, std::size_t{1} << 23});
            std::ranges::sort(expected);
            std::ranges::sort(by_fragments.points);
            ASSERT_EQ(by_fragments.points, expected);
            points += expected.size();
        }
    std::cout << points << " samples, " << on_others << " of them not on their pixel's receiver\n";
    EXPECT_GT(points, 50000u);
    EXPECT_GT(on_others, 5000u);
}

// Scenes that may make a pixel's mean wrong: occluders between a pixel's corners, edges exactly through its corners and
// samples, occluders that nearly touch the receiver, and lights along the receiver.
TEST(Samples, MeansSurviveWhatHidesInAPixel) {
    const gnomon::Device device = device_with();
    Settled sum;
    const gnomon::Light lights[] = {gnomon::Light::directional({1, 0, -1}),
                                    gnomon::Light::directional({0.3f, 0.2f, -1}),
                                    gnomon::Light::directional({1, 0.3f, -0.01f}), gnomon::Light::point({3, -2, 9}),
                                    gnomon::Light::point({-9, 4, 0.25f})};
    for (const CameraScene& scene : hard_pixel_scenes())
        for (const gnomon::Light& light : lights) expect_same_means(device, scene, light, 32, sum);
    expect_not_vacuous(sum);
}

// In a view along the floor, a pixel below the horizon contains most of the floor: its footprint has more bins than the
// stage stores, so its samples need lists of their own.
TEST(Samples, MeansSurvivePixelsOfManyBins) {
    const CameraScene scene = floor_scene("along the floor", squares_on_samples(40, 11), {-60, 0.25f, 0.5f});
    Settled sum;
    for (const gnomon::Light& light :
         {gnomon::Light::directional({0.3f, 0.2f, -1}), gnomon::Light::directional({1, 0.3f, -0.2f})})
        expect_same_means(device_with(), scene, light, 32, sum, "1024");
    EXPECT_GT(sum.traced, 500u);
    EXPECT_GT(sum.partly, 10u);
}

/// Squares of two triangles each, `side` x `side` of them from `low` to `high` in x and y, moved and at heights by
/// `place`.
template <typename Place>
Floats squares_in_a_row(int side, float low, float high, const Place& place) {
    Floats triangles;
    const auto at = [&](int x, int y) {
        const float step = (high - low) / float(side);
        return place(low + step * float(x), low + step * float(y));
    };
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            add(triangles, at(x, y), at(x + 1, y), at(x + 1, y + 1));
            add(triangles, at(x, y), at(x + 1, y + 1), at(x, y + 1));
        }
    return triangles;
}

std::uint64_t traced_samples(const CameraScene& scene, const gnomon::Light& light) {
    Settled sum;
    expect_same_means(device_with(), scene, light, 32, sum);
    return sum.traced;
}

// Under a roof without holes, with the shadow of the outline outside the picture, only footprints around one of its
// nine inner vertices may be left to the trace. A pixel's footprint is not larger than the pixel, so each vertex
// touches four at most. Two triangles that share an edge decide the footprint below that edge. Not vacuous: edges run
// through hundreds of pixels.
TEST(Samples, FootprintsBelowAnEdgeAreInShadow) {
    if (session_of(device_with()).lanes() == 1) GTEST_SKIP() << "a GPU traces undecided footprints";
    const auto roof = squares_in_a_row(4, -44, 49, [](float x, float y) {
        return Float3{x - y * 0.36f, y + x * 0.36f, 5};
    });
    const CameraScene scene = floor_scene("roof", roof, {0.5f, 0.5f, 4});
    CameraScene from_above = scene;
    from_above.fov_y_degrees = 2 * std::atan(4.0) * 180 / 3.14159265358979;  // as wide as from 32 units above
    for (const gnomon::Light& light :
         {gnomon::Light::directional({0.11f, 0.05f, -1}), gnomon::Light::point({1.3f, 2.1f, 90})})
        EXPECT_LE(traced_samples(from_above, light), 4u * 9u * 32u);
}

// A flat floor in the light: its triangles' rounded vertices are at most 1.8 ulp of the largest coordinate apart from
// one plane (camera.h), and the camera lifts points by 4, so no neighbour makes a trace necessary.
TEST(Samples, NeighboursInAPlaneLeaveFootprintsLit) {
    if (session_of(device_with()).lanes() == 1) GTEST_SKIP() << "a GPU traces undecided footprints";
    const auto tilted = squares_in_a_row(24, -40, 40, [](float x, float y) {
        return Float3{x, y, x * 0.3f - y * 0.17f};
    });
    CameraScene scene = floor_scene("tilted", tilted, {-20, 5, 34});
    scene.triangles.resize(tilted.size());  // no other floor
    for (const gnomon::Light& light :
         {gnomon::Light::directional({0.11f, 0.05f, -1}), gnomon::Light::point({3, -2, 39})})
        EXPECT_EQ(traced_samples(scene, light), 0u);
}

// Not vacuous: a band of tiles per batch, and batches that do not divide the samples.
TEST(Samples, ShapeFreeExhaustive) {
    const gnomon::Light light = gnomon::Light::directional({0.3f, -1, 0.2f});
    const CameraScene scene = scenes().front();
    const std::size_t pixels = std::size_t(scene.width) * scene.height;
    const auto same = [](const Floats& a, const Floats& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
    };
    const Samples expected = sampled(device_with(), scene, light, 16);
    for (const std::size_t at_once : {std::size_t{1}, 3 * pixels, 5 * pixels + 1})
        for (const std::uint32_t group : {0u, 33u}) {
            const Samples seen = sampled(device_with(group), scene, light, 16, at_once);
            EXPECT_TRUE(same(seen.position, expected.position)) << at_once << " points at once";
            EXPECT_EQ(seen.receiver, expected.receiver);
            EXPECT_EQ(seen.mean, expected.mean);
            EXPECT_EQ(seen.statistics.count("points"), 16 * pixels);
        }
    const gnomon::Device without({}, {.hide_fp64 = true});
    EXPECT_TRUE(same(sampled(without, scene, light, 16).position, expected.position)) << "without double precision";
}

// A GPU's groups divide a pixel: groups of any size, with fragments that find room at once or only in a second attempt.
TEST(Samples, TheShapeForGpusGivesTheSameBitsExhaustive) {
    const gnomon::Light light = gnomon::Light::directional({0.3f, -1, 0.2f});
    for (const CameraScene& scene : scenes()) {
        if (scene.name != "large soup" && scene.name != "needles") continue;
        for (const std::uint32_t samples : {4u, 32u}) {
            const Samples expected = sampled(device_with(), scene, light, samples);
            for (const std::uint32_t group : {3u, 33u}) {
                gnomon::DeviceOptions options;
                options.gpu_kernels = true;
                options.work_group_size = group;
                const Samples seen = sampled(gnomon::Device({}, options), scene, light, samples);
                EXPECT_EQ(seen.mean, expected.mean) << scene.name << ", " << samples << " samples, groups of " << group;
                for (const char* count : {"pixels_on_several", "fragments"})
                    EXPECT_EQ(seen.statistics.count(count), expected.statistics.count(count)) << scene.name;
            }
        }
    }
}

TEST(Samples, OneSampleIsTheOrdinaryView) {
    const gnomon::Device device = device_with();
    const gnomon::Light light = gnomon::Light::directional({0.3f, -1, 0.2f});
    for (const CameraScene& scene : scenes()) {
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
        const gnomon::Visibility visibility(device, view.points.count());
        gnomon::make_technique("frustum-traced", device)->run(triangles, view.points, light, visibility);
        EXPECT_EQ(sampled(device, scene, light, 1).mean, visibility.read()) << scene.name;
    }
}

TEST(Samples, ViewsHaveTheSamplesPoints) {
    const gnomon::Device device = device_with();
    const gnomon::Light light = gnomon::Light::directional({0.3f, -1, 0.2f});
    for (const CameraScene& scene : scenes()) {
        const Samples seen = sampled(device, scene, light, 8);
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
        gnomon::SampleViews views(device, triangles, view, 8);
        Samples by_views;
        for (std::size_t i = 0; i < views.count(); ++i) {
            const gnomon::PointsOnHost points = views.at(i).points.read(device);
            append(by_views.position, points.position);
            by_views.receiver.insert(by_views.receiver.end(), points.receiver.begin(), points.receiver.end());
        }
        EXPECT_EQ(by_views.receiver, seen.receiver) << scene.name;
        ASSERT_EQ(by_views.position.size(), seen.position.size());
        EXPECT_EQ(std::memcmp(by_views.position.data(), seen.position.data(), 4 * seen.position.size()), 0);
    }
}

/// The share of the lights at each sample is their mean over single lights, of which each has the mean of its samples.
TEST(Samples, SoftMeansAreThoseOfTheirLights) {
    const gnomon::Device device = device_with();
    const gnomon::Lights lights = gnomon::sun_disk({0.3f, -1, 0.2f}, 20, 4);
    std::size_t partly = 0;
    for (const CameraScene& scene : scenes()) {
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
        const gnomon::Visibility mean(device, view.points.count());
        const auto technique = gnomon::make_technique("frustum-traced", device);
        gnomon::run_samples_mean(*technique, triangles, view, lights, 4, mean);
        const std::vector<float> soft = mean.read();
        std::vector<float> sum(soft.size());
        for (const gnomon::Light& light : lights.lights()) {
            gnomon::run_samples(*technique, triangles, view, light, 4, mean);
            const std::vector<float> hard = mean.read();
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += hard[i] / 4;  // sixteenths are exact
        }
        EXPECT_EQ(soft, sum) << scene.name;
        partly += std::size_t(std::ranges::count_if(soft, [](float v) { return v != 0 && v != 1; }));
    }
    EXPECT_GT(partly, 100u);
}

TEST(Samples, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    CameraScene scene = scenes().front();
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Light light = gnomon::Light::directional({0, -1, 0});
    scene.triangles.clear();
    EXPECT_EQ(sampled(device, scene, light, 8).mean, std::vector<float>(std::size_t(scene.width) * scene.height, 1.0f));
    const auto nothing = gnomon::Triangles::upload(device, {});
    const gnomon::View view = gnomon::look(device, nothing, scene.camera(), 4, 4);
    EXPECT_THROW(gnomon::run_samples(*technique, nothing, view, light, 4, gnomon::Visibility(device, 15)),
                 gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::run_samples(*technique, nothing, view, light, 5, gnomon::Visibility(device, 16)),
                 gnomon::InvalidArgument);
    gnomon::View by_hand;
    by_hand.points = gnomon::Points::upload(device, Floats{0, 0, 0});
    EXPECT_THROW(gnomon::run_samples(*technique, nothing, by_hand, light, 4, gnomon::Visibility(device, 16)),
                 gnomon::InvalidArgument);
}

}  // namespace
