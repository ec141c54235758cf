// SPDX-License-Identifier: MIT
// The choice among the methods that decide a table of lights: each rule at its limit, and what measured costs do. The
// functions are pure, so no test here needs a device.
#include "lights/lights_method.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <random>
#include <utility>

namespace {

using gnomon::choose_method;
using gnomon::lights_tuning;
using gnomon::LightsCosts;
using gnomon::LightsTraits;
using gnomon::methods_to_measure;
using Method = gnomon::LightsMethod;
using Methods = std::vector<Method>;

/// A run that is worth measuring, of 2^25 pairs.
LightsTraits large_run(bool is_cpu) {
    return {.is_cpu = is_cpu, .points = std::size_t(1) << 21, .lights = 16, .triangles = std::size_t(1) << 23};
}

LightsCosts costs_of(std::initializer_list<std::pair<Method, double>> measured) {
    LightsCosts costs;
    for (const auto& [method, ms] : measured) costs[method] = ms;
    return costs;
}

/// By rule: nothing is measured, and no cost changes the choice.
void expect_by_rule(const LightsTraits& traits, Method expected) {
    EXPECT_EQ(methods_to_measure(traits), Methods{});
    EXPECT_EQ(choose_method(traits, {}), expected);
    for (const Method fastest : {Method::one_by_one, Method::beams, Method::rays, Method::horizons})
        EXPECT_EQ(choose_method(traits, costs_of({{fastest, 1}})), expected);
}

TEST(LightsMethod, FewLightsAndLightsThatCannotBeBundledGoOneByOne) {
    for (const bool is_cpu : {false, true}) {
        LightsTraits few = large_run(is_cpu), mixed = few, enough = few;
        few.lights = lights_tuning.min_shared_lights - 1;
        few.points = std::size_t(1) << 30;
        expect_by_rule(few, Method::one_by_one);
        mixed.can_be_bundled = false;
        expect_by_rule(mixed, Method::one_by_one);
        EXPECT_FALSE(gnomon::wants_height_field(mixed));
        EXPECT_FALSE(gnomon::wants_bundles(mixed));
        enough.lights = lights_tuning.min_shared_lights;
        EXPECT_NE(choose_method(enough, {}), Method::one_by_one);
    }
}

TEST(LightsMethod, SmallRunsTakeBeamsUnmeasured) {
    for (const bool is_cpu : {false, true}) {
        LightsTraits traits = large_run(is_cpu);
        traits.triangles = 1;
        traits.is_height_field = true;
        traits.points = lights_tuning.min_measured_pairs / traits.lights - 1;
        expect_by_rule(traits, Method::beams);
        EXPECT_FALSE(gnomon::wants_height_field(traits));
        EXPECT_EQ(gnomon::wants_bundles(traits), is_cpu);
        ++traits.points;
        EXPECT_TRUE(gnomon::wants_height_field(traits));
        EXPECT_TRUE(is_cpu ? !methods_to_measure(traits).empty() : choose_method(traits, {}) == Method::horizons);
    }
}

TEST(LightsMethod, AHeightFieldIsSearchedForWhereItMayServe) {
    for (const bool is_cpu : {false, true}) {
        LightsTraits traits = large_run(is_cpu);
        traits.triangles = traits.points * traits.lights / lights_tuning.min_field_pairs_per_triangle;
        EXPECT_TRUE(gnomon::wants_height_field(traits));
        ++traits.triangles;
        EXPECT_FALSE(gnomon::wants_height_field(traits));
        traits.triangles = 1;
        traits.is_picture = true;
        EXPECT_EQ(gnomon::wants_height_field(traits), is_cpu);
        traits.is_picture = false;
        traits.are_point_lights = true;
        EXPECT_FALSE(gnomon::wants_height_field(traits));
    }
}

TEST(LightsMethod, ACpuTakesRaysToScatteredLightsUnmeasured) {
    for (const bool are_point_lights : {false, true}) {
        LightsTraits traits = large_run(true);
        traits.are_point_lights = are_point_lights;
        traits.lights_per_bundle = lights_tuning.cpu_scattered_lights * 0.999;
        traits.widest_bundle = lights_tuning.cpu_scattered_box;
        EXPECT_TRUE(gnomon::wants_bundles(traits));
        expect_by_rule(traits, Method::rays);
        traits.points = 1;
        expect_by_rule(traits, Method::rays);
        LightsTraits few = traits, dense = traits, picture = traits, gpu = traits;
        few.lights = lights_tuning.min_shared_lights - 1;
        expect_by_rule(few, Method::one_by_one);
        dense.points = std::size_t(1) << 21;
        dense.lights_per_bundle = lights_tuning.cpu_scattered_lights;
        dense.widest_bundle = lights_tuning.cpu_scattered_box * 0.999;
        EXPECT_EQ(methods_to_measure(dense), (Methods{Method::beams, Method::point_beams, Method::rays}));
        picture.is_picture = true;
        EXPECT_FALSE(gnomon::wants_bundles(picture));
        expect_by_rule(picture, Method::beams);
        gpu.is_cpu = false;
        expect_by_rule(gpu, Method::beams);
    }
}

TEST(LightsMethod, AKeptTreeServesOneLight) {
    LightsTraits traits = large_run(true);
    traits.keeps_clusters = true;
    traits.lights = 1;
    traits.triangles = traits.points * lights_tuning.cpu_triangles_per_pair;
    EXPECT_TRUE(gnomon::wants_tree(traits));
    expect_by_rule(traits, Method::rays);
    traits.are_point_lights = true;
    traits.widest_bundle = 0;
    expect_by_rule(traits, Method::rays);
    const auto expect_no_tree = [&](auto&& change) {
        LightsTraits other = traits;
        change(other);
        EXPECT_FALSE(gnomon::wants_tree(other));
        expect_by_rule(other, Method::one_by_one);
        other.lights = lights_tuning.min_shared_lights;
        EXPECT_TRUE(gnomon::wants_tree(other));
    };
    expect_no_tree([](LightsTraits& other) { other.triangles += lights_tuning.cpu_triangles_per_pair; });
    expect_no_tree([](LightsTraits& other) { other.keeps_clusters = false; });
    expect_no_tree([](LightsTraits& other) { other.is_picture = true; });
    expect_no_tree([](LightsTraits& other) { other.is_cpu = false; });
}

TEST(LightsMethod, ACpuSearchesNoFieldForAFewScatteredLights) {
    LightsTraits traits = large_run(true);
    traits.triangles = 1;
    traits.lights_per_bundle = 1;
    traits.lights = lights_tuning.cpu_sector_lights - 1;
    EXPECT_FALSE(gnomon::wants_height_field(traits));
    ++traits.lights;
    EXPECT_TRUE(gnomon::wants_height_field(traits));
    traits.is_height_field = true;
    EXPECT_EQ(methods_to_measure(traits),
              (Methods{Method::beams, Method::point_beams, Method::rays, Method::horizons}));
    traits.lights_per_bundle = lights_tuning.cpu_scattered_lights;
    traits.lights = lights_tuning.min_shared_lights;
    EXPECT_TRUE(gnomon::wants_height_field(traits));
}

TEST(LightsMethod, ACpuTakesSweepsForTheVerticesOfARaster) {
    LightsTraits traits = large_run(true);
    traits.points_at_vertices = traits.points / 8 * 7;
    LightsTraits dense = traits, scattered = traits, few = traits;
    dense.lights_per_bundle = lights_tuning.cpu_vertices_times_bundle / 5;
    dense.raster_vertices = dense.points * 5;
    scattered.lights_per_bundle = 1;
    scattered.raster_vertices = scattered.points * lights_tuning.cpu_vertices_of_point;
    few.lights = 1, few.keeps_clusters = true;
    few.raster_vertices = few.points * lights_tuning.cpu_vertices_of_point_few_lights;
    for (const LightsTraits& run : {dense, scattered, few}) {
        EXPECT_TRUE(gnomon::wants_raster(run));
        EXPECT_FALSE(gnomon::wants_height_field(run));
        expect_by_rule(run, Method::sweeps);
        LightsTraits beside = run, sparse = run;
        --beside.points_at_vertices;
        ++sparse.raster_vertices;
        for (const LightsTraits& other : {beside, sparse}) EXPECT_NE(choose_method(other, {}), Method::sweeps);
    }
}

TEST(LightsMethod, AGpuTakesSweepsForTheVerticesOfARaster) {
    LightsTraits traits = large_run(false);
    traits.points_at_vertices = traits.points;
    traits.raster_vertices = traits.points * lights_tuning.gpu_vertices_of_point;
    EXPECT_TRUE(gnomon::wants_raster(traits));
    EXPECT_FALSE(gnomon::wants_height_field(traits));
    expect_by_rule(traits, Method::sweeps);
    ++traits.raster_vertices;
    EXPECT_NE(choose_method(traits, {}), Method::sweeps);
    traits.triangles = traits.points * traits.lights / lights_tuning.min_field_pairs_per_triangle;
    EXPECT_TRUE(gnomon::wants_height_field(traits));
}

TEST(LightsMethod, ARasterIsSearchedForWhereItMayServe) {
    const auto wants = [](auto&& change) {
        LightsTraits traits = large_run(true);
        change(traits);
        return gnomon::wants_raster(traits);
    };
    constexpr std::size_t most = lights_tuning.cpu_triangles_per_pair;
    EXPECT_TRUE(wants([](LightsTraits& t) { t.triangles = most * t.points * t.lights; }));
    EXPECT_FALSE(wants([](LightsTraits& t) { t.triangles = most * (t.points * t.lights + 1); }));
    EXPECT_FALSE(wants([](LightsTraits& t) { t.is_picture = true; }));
    EXPECT_FALSE(wants([](LightsTraits& t) { t.are_point_lights = true; }));
    EXPECT_FALSE(wants([](LightsTraits& t) { t.can_be_bundled = false; }));
    EXPECT_FALSE(wants([](LightsTraits& t) { t.lights = 1; }));
    EXPECT_TRUE(wants([](LightsTraits& t) { t.lights = 1, t.keeps_clusters = true; }));
    for (const bool is_cpu : {true, false}) {
        const auto pairs = [&](std::size_t count) {
            return wants([&](LightsTraits& t) { t.is_cpu = is_cpu, t.points = count / t.lights, t.triangles = 2; });
        };
        const std::size_t least = is_cpu ? lights_tuning.cpu_min_raster_pairs : lights_tuning.gpu_min_raster_pairs;
        EXPECT_TRUE(pairs(least));
        EXPECT_FALSE(pairs(least - 16));
    }
}

TEST(LightsMethod, ACpuMeasuresWhatMayBeTheFastest) {
    LightsTraits traits = large_run(true);
    EXPECT_EQ(methods_to_measure(traits), (Methods{Method::beams, Method::point_beams, Method::rays}));
    traits.is_height_field = true;
    EXPECT_EQ(methods_to_measure(traits),
              (Methods{Method::beams, Method::point_beams, Method::rays, Method::horizons}));
    traits.is_height_field = false;
    traits.keeps_clusters = true;  // does not matter on a CPU
    EXPECT_EQ(methods_to_measure(traits), (Methods{Method::beams, Method::point_beams, Method::rays}));
    traits.is_picture = true;
    EXPECT_EQ(methods_to_measure(traits),
              (Methods{Method::beams, Method::point_beams, Method::rays, Method::one_by_one}));
    --traits.points;  // fewer than 2^25 pairs
    EXPECT_EQ(methods_to_measure(traits), (Methods{Method::beams, Method::point_beams, Method::rays}));
    traits.points *= 8;
    traits.lights = lights_tuning.cpu_many_lights - 1;
    EXPECT_EQ(methods_to_measure(traits),
              (Methods{Method::beams, Method::point_beams, Method::rays, Method::one_by_one}));
    ++traits.lights;
    EXPECT_EQ(methods_to_measure(traits), (Methods{Method::beams, Method::point_beams, Method::rays}));
}

TEST(LightsMethod, ASlowMethodIsLeft) {
    LightsTraits traits = large_run(true);
    traits.is_picture = traits.is_height_field = true;
    const Methods measured = methods_to_measure(traits);
    ASSERT_EQ(measured.size(), 5u);
    for (const Method slow : measured)
        for (const Method fast : measured) {
            if (slow == fast) continue;
            LightsCosts costs = costs_of({{slow, 1e6}});
            for (const Method other : measured)
                if (other != slow) costs[other] = other == fast ? 10 : 11;
            EXPECT_EQ(choose_method(traits, costs), fast);
            costs[fast] = 1e7;
            EXPECT_NE(choose_method(traits, costs), fast);
        }
}

TEST(LightsMethod, AMethodOutOfMemoryIsInfinitelySlow) {
    LightsTraits traits = large_run(true);
    EXPECT_EQ(choose_method(traits, costs_of({{Method::rays, 1e12}})), Method::rays);
    EXPECT_EQ(choose_method(traits, costs_of({{Method::beams, 1e12}})), Method::beams);
    EXPECT_EQ(choose_method(traits, {}), Method::beams);  // no memory for either: the one that takes the least
    traits = large_run(false);
    traits.is_picture = true;
    EXPECT_EQ(choose_method(traits, costs_of({{Method::one_by_one, 1e12}})), Method::one_by_one);
    EXPECT_EQ(choose_method(traits, costs_of({{Method::beams, 1e12}})), Method::beams);
    EXPECT_EQ(choose_method(traits, {}), Method::beams);
}

TEST(LightsMethod, AGpuTakesHorizonsOfAHeightFieldUnmeasured) {
    LightsTraits traits = large_run(false);
    traits.keeps_clusters = traits.is_height_field = true;
    expect_by_rule(traits, Method::horizons);
    EXPECT_FALSE(gnomon::wants_bundles(traits));
}

TEST(LightsMethod, AGpuTakesBeamsOfThinBundlesUnmeasured) {
    for (const bool are_point_lights : {false, true}) {
        LightsTraits traits = large_run(false);
        traits.is_picture = true;
        traits.are_point_lights = are_point_lights;
        EXPECT_TRUE(gnomon::wants_bundles(traits));
        const double limit = are_point_lights ? lights_tuning.thin_box : lights_tuning.thin_cone;
        traits.widest_bundle = limit * 0.999;
        expect_by_rule(traits, Method::beams);
        traits.widest_bundle = limit;
        EXPECT_TRUE(are_point_lights || !methods_to_measure(traits).empty());
        EXPECT_NE(choose_method(traits, costs_of({{Method::one_by_one, 1}})), Method::beams);
    }
}

TEST(LightsMethod, AGpuTakesScatteredPointLightsOneByOneForManyPoints) {
    LightsTraits traits = large_run(false);
    traits.are_point_lights = true;
    traits.points = lights_tuning.gpu_points_of_single_lights;
    expect_by_rule(traits, Method::one_by_one);
    --traits.points;
    expect_by_rule(traits, Method::beams);
}

TEST(LightsMethod, AGpuMeasuresSingleLightsWhereItPays) {
    const Methods both{Method::beams, Method::one_by_one};
    LightsTraits traits = large_run(false);
    expect_by_rule(traits, Method::beams);  // no picture, and no later run can use the choice
    traits.keeps_clusters = true;
    EXPECT_EQ(methods_to_measure(traits), both);
    traits.keeps_clusters = false;
    traits.is_picture = true;
    EXPECT_EQ(methods_to_measure(traits), both);
    --traits.points;
    expect_by_rule(traits, Method::beams);  // fewer than 2^25 pairs
    traits = large_run(false);
    traits.is_picture = true;
    traits.lights = lights_tuning.gpu_many_lights - 1;
    EXPECT_EQ(methods_to_measure(traits), both);
    ++traits.lights;
    expect_by_rule(traits, Method::beams);
}

TEST(LightsMethod, AGpuTakesSingleLightsWithinATenthOfBeams) {
    LightsTraits traits = large_run(false);
    traits.is_picture = true;
    const auto chosen = [&](double beams, double one_by_one) {
        return choose_method(traits, costs_of({{Method::beams, beams}, {Method::one_by_one, one_by_one}}));
    };
    EXPECT_EQ(chosen(206, 216), Method::one_by_one);  // the city's 256 suns: 263 and 229 ms in truth
    EXPECT_EQ(chosen(100, 109.9), Method::one_by_one);
    EXPECT_EQ(chosen(100, 110.1), Method::beams);
    EXPECT_EQ(chosen(100, 90), Method::one_by_one);
    traits.is_cpu = true;  // its estimates are taken as they are
    EXPECT_EQ(chosen(100, 100.1), Method::beams);
}

// Whatever the traits: a choice by costs is one of the measured methods, and a rule measures nothing.
TEST(LightsMethod, TheChoiceIsMeasuredOrByRule) {
    std::mt19937 random(1);
    const auto flip = [&] { return random() % 2 == 0; };
    std::size_t measured_runs = 0, chosen[std::size(gnomon::lights_method_names)] = {};
    for (int i = 0; i < 20000; ++i) {
        const LightsTraits traits{.is_cpu = flip(),
                                  .points = std::size_t(1) << random() % 26,
                                  .lights = std::size_t(1) << random() % 13,
                                  .triangles = std::size_t(1) << random() % 24,
                                  .is_picture = flip(),
                                  .keeps_clusters = flip(),
                                  .can_be_bundled = random() % 8 != 0,
                                  .are_point_lights = flip(),
                                  .is_height_field = flip(),
                                  .raster_vertices = random() % 8 == 0 ? std::size_t(1) << random() % 24 : 0,
                                  .points_at_vertices = std::size_t(1) << random() % 26,
                                  .lights_per_bundle = 1 + double(random() % 32),
                                  .widest_bundle = double(random() % 100) / 1000};
        const Methods measured = methods_to_measure(traits);
        LightsCosts costs;
        for (const Method method : measured) costs[method] = 1 + double(random() % 1000);
        const Method method = choose_method(traits, costs);
        ++chosen[std::size_t(method)];
        measured_runs += !measured.empty();
        if (measured.empty())
            EXPECT_EQ(method, choose_method(traits, {}));
        else
            EXPECT_TRUE(std::ranges::find(measured, method) != measured.end());
    }
    EXPECT_GT(measured_runs, 1000u);
    for (const Method method :
         {Method::one_by_one, Method::beams, Method::point_beams, Method::rays, Method::horizons, Method::sweeps})
        EXPECT_GT(chosen[std::size_t(method)], 100u) << std::size_t(method);
    EXPECT_EQ(chosen[std::size_t(Method::automatic)], 0u);
}

const gnomon::MethodCache::Key two_suns{{{0, 1, 0, 0}, {1, 1, 0, 0}}, 1000, false};

TEST(MethodCache, AChoiceExpiresAfterItsRuns) {
    gnomon::MethodCache cache;
    EXPECT_EQ(cache.find(two_suns), std::nullopt);
    cache.keep(two_suns, Method::rays);
    for (std::uint32_t run = 0; run < lights_tuning.runs_of_choice; ++run)
        EXPECT_EQ(cache.find(two_suns), Method::rays) << run;
    EXPECT_EQ(cache.find(two_suns), std::nullopt);
    EXPECT_EQ(cache.find(two_suns), std::nullopt);
    cache.keep(two_suns, Method::beams);
    EXPECT_EQ(cache.find(two_suns), Method::beams);
}

TEST(MethodCache, AChoiceServesTheSameRunAlone) {
    gnomon::MethodCache::Key other_light = two_suns, one_light = two_suns, more_points = two_suns, picture = two_suns;
    other_light.lights[1][2] = 0x1p-149f;
    one_light.lights.pop_back();
    ++more_points.points;
    picture.is_picture = true;
    for (const auto& other : {other_light, one_light, more_points, picture}) {
        gnomon::MethodCache cache;
        cache.keep(two_suns, Method::rays);
        EXPECT_EQ(cache.find(other), std::nullopt);
        EXPECT_EQ(cache.find(two_suns), std::nullopt);  // forgotten
    }
    gnomon::MethodCache cache;
    cache.keep(two_suns, Method::rays);
    cache.clear();
    EXPECT_EQ(cache.find(two_suns), std::nullopt);
}

}  // namespace
