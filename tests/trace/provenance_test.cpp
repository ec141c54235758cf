// SPDX-License-Identifier: MIT
// The diagnostic "decided" of frustum-traced: points with a known provenance have its colour (legend in
// docs/techniques.md), and the counts of a run's statistics are the numbers of points of each colour.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "support/expect_exact.hpp"
#include "support/tie_points.hpp"

#include <gnomon.hpp>

namespace {

using namespace support;
using Color = std::array<int, 3>;

constexpr Color lit_by_filter{221, 230, 240}, shadowed_by_filter{70, 120, 175}, by_map{25, 50, 110},
    faces_away{20, 20, 20}, not_asked{255, 255, 255}, absent{96, 96, 96};
/// The exact predicate in float, in double and in integers, and the queue overflow.
constexpr std::array<Color, 4> lit_exactly{{{160, 220, 120}, {255, 215, 80}, {255, 110, 90}, {220, 150, 255}}},
    shadowed_exactly{{{60, 130, 40}, {200, 140, 0}, {190, 0, 30}, {130, 40, 220}}};

/// A run's visibility, and the colour of each point's provenance.
struct ColoredAnswer {
    Answer run;
    std::vector<Color> colors;

    std::size_t count(const Color& color) const { return std::size_t(std::count(colors.begin(), colors.end(), color)); }
    std::size_t count(std::span<const Color> some) const {
        std::size_t sum = 0;
        for (const Color& color : some) sum += count(color);
        return sum;
    }
};

ColoredAnswer answer_with_colors(const gnomon::Device& device, const LightScene& scene, const Settings& settings = {}) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const gnomon::Points points = upload_points(device, scene);
    const gnomon::Light light{scene.light};
    const auto watched = technique_with(device, settings);
    ColoredAnswer found{
        answer(device, *technique_with(device, settings), triangles, points, light, facing_of(scene.eye)), {}};
    const auto rgba = watched->diagnose("decided", triangles, points, light, facing_of(scene.eye));
    EXPECT_EQ(rgba.size(), 4 * points.count());
    for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
        found.colors.push_back({rgba[i], rgba[i + 1], rgba[i + 2]});
        EXPECT_EQ(rgba[i + 3], 255);
    }
    // The diagnostic changes no result of the run.
    EXPECT_EQ(answer(device, *watched, triangles, points, light, facing_of(scene.eye)).visibility,
              found.run.visibility);
    return found;
}

/// A square roof, 2 m wide and 2 m above the ground, under light from straight above.
LightScene roof() {
    return {"roof", {-1, 2, -1, 1, 2, -1, 1, 2, 1, -1, 2, -1, 1, 2, 1, -1, 2, 1}, {}, along(0, -1, 0)};
}

TEST(Provenance, ExactTiesAreDecidedByTheWiderLevels) {
    const gnomon::Device device;
    LightScene scene = roof();
    scene.triangles.resize(9);  // the half with the vertices (-1, -1), (1, -1), (1, 1) in x and z
    const float nan = std::numeric_limits<float>::quiet_NaN();
    // Below the roof, beside it, the sky; exactly below the slanted edge, and below the edge at x = 1.
    scene.points = {0.5f, 0, -0.25f, 3, 0, 0, nan, 0, 0, 0.25f, 0, 0.25f, 1, 0, 0.25f};
    // The slanted edge's determinant is the difference of two products that are equal and not 0: only integers prove
    // that it is 0. For the other edge, each product has a factor 0, which double proves (docs/numerics.md, 7).
    EXPECT_EQ(
        answer_with_colors(device, scene, {{"conservative-map", "off"}}).colors,
        (std::vector<Color>{shadowed_by_filter, lit_by_filter, absent, shadowed_exactly[2], shadowed_exactly[1]}));
}

TEST(Provenance, WhatIsNotTracedSaysWhy) {
    const gnomon::Device device;
    LightScene scene = roof();
    // The first point is on the roof's underside, seen from below; the second has no triangle above it.
    scene.points = {0, 2, 0.5f, 5, 0, 5};
    scene.receivers = {1, gnomon::no_receiver};
    scene.eye = Float3{0, 0, 0};
    EXPECT_EQ(answer_with_colors(device, scene).colors, (std::vector<Color>{faces_away, lit_by_filter}));
    scene.triangles.clear();
    EXPECT_EQ(answer_with_colors(device, scene).colors, (std::vector<Color>{not_asked, not_asked}));
    scene.points.clear();
    scene.receivers.clear();
    EXPECT_TRUE(answer_with_colors(device, scene).colors.empty());
}

/// The number of each colour's points equals the same run's count, and each colour agrees with visibility.
void expect_counts(const LightScene& scene, const Settings& settings, std::map<std::string, std::size_t>& seen) {
    static const gnomon::Device device;
    const char* const levels[] = {"decided_by_float", "decided_by_double", "decided_by_integers"};
    SCOPED_TRACE(scene.name + " " + text_of(settings));
    const ColoredAnswer answer = answer_with_colors(device, scene, settings);
    const gnomon::Statistics& s = answer.run.statistics;
    ASSERT_EQ(answer.colors.size(), s.count("points"));
    EXPECT_EQ(answer.count(absent), s.count("points_absent"));
    EXPECT_EQ(answer.count(faces_away), s.count("points_facing_away"));
    EXPECT_EQ(answer.count(by_map), s.count("points_decided_by_map"));
    const std::size_t exact_first = answer.count(std::span(shadowed_exactly).first(3)),
                      second = answer.count(shadowed_exactly[3]);
    EXPECT_EQ(s.count("points_decided_by_trace") + s.count("points_decided_by_exact"),
              answer.count(shadowed_by_filter) + exact_first + second);
    std::size_t by_levels = 0, asked_by_levels = 0;
    for (int level = 0; level < 3; ++level) {
        // For a lit point all pairs were decided, in both runs; for a dark point the decided pairs may differ.
        EXPECT_LE(answer.count(lit_exactly[level]), s.count(levels[level]));
        by_levels += answer.count(lit_exactly[level]) + answer.count(shadowed_exactly[level]);
        asked_by_levels += s.count(levels[level]);
    }
    // Which pairs find room in a queue that is too short depends on the order of the work-items, and these are two
    // runs: a postponed point may then be decided by another of its triangles.
    const bool has_room = std::none_of(settings.begin(), settings.end(),
                                       [](const auto& setting) { return setting.first == "first-capacity"; });
    if (has_room) {
        EXPECT_EQ(second, 0u);
        EXPECT_EQ(s.count("points_decided_by_trace"), answer.count(shadowed_by_filter));
        EXPECT_EQ(s.count("points_decided_by_exact"), exact_first);
        EXPECT_LE(by_levels, asked_by_levels);
    }
    std::size_t dark = answer.count(shadowed_by_filter) + answer.count(by_map) + answer.count(faces_away) +
                       answer.count(shadowed_exactly);
    EXPECT_EQ(dark, s.count("points_in_shadow"));
    EXPECT_EQ(dark + answer.count(lit_by_filter) + answer.count(lit_exactly) + answer.count(absent),
              answer.colors.size());
    for (std::size_t i = 0; i < answer.colors.size(); ++i) {
        const bool is_lit = answer.colors[i] == lit_by_filter || answer.colors[i] == absent ||
                            std::find(lit_exactly.begin(), lit_exactly.end(), answer.colors[i]) != lit_exactly.end();
        ASSERT_EQ(is_lit, answer.run.visibility[i] == 1) << "point " << i;
    }
    seen["map"] += answer.count(by_map);
    seen["queue overflow"] += second + answer.count(lit_exactly[3]);
    for (int level = 0; level < 3; ++level) {
        seen[std::string(levels[level]) + ", lit"] += answer.count(lit_exactly[level]);
        seen[std::string(levels[level]) + ", shadowed"] += answer.count(shadowed_exactly[level]);
    }
}

TEST(Provenance, IsTheSameInEveryRun) {
    // A CPU's items take runs of points as they come: no float of a record may depend on which item took which points.
    const gnomon::Device device;
    const Floats triangles = soup(300, 0.4f, 2);
    for (const auto& [name, light] : lights_of_every_kind()) {
        const LightScene scene{"soup, " + name, triangles, points_behind(triangles, light, 3000, 3, 7), light};
        const Settings off{{"conservative-map", "off"}};
        const std::vector<Color> first = answer_with_colors(device, scene, off).colors;
        for (int i = 0; i < 30; ++i) ASSERT_EQ(answer_with_colors(device, scene, off).colors, first) << name;
    }
}

TEST(Provenance, CountWhatTheStatisticsCount) {
    const Floats blocks = lattice_blocks(3, 6, 1), triangles = soup(300, 0.4f, 2);
    std::map<std::string, std::size_t> seen;
    for (const Settings& settings :
         {Settings{{"conservative-map", "on"}, {"map-size", "64"}}, Settings{{"conservative-map", "off"}},
          Settings{{"conservative-map", "on"}, {"first-capacity", "5"}}})
        for (const auto& [name, light] : lights_of_every_kind()) {
            const Floats points = points_behind(triangles, light, 3000, 3, 7);
            expect_counts({"soup, " + name, triangles, points, light}, settings, seen);
            LightScene ties{"lattice, " + name, blocks, lattice_points(3000, 6, 3), moved(light, 3, {3.5, 3.5, 3.5})};
            for (std::uint32_t i = 0; i < 3000; ++i) ties.receivers.push_back(i % std::uint32_t(blocks.size() / 9));
            ties.eye = Float3{20, 30, 40};
            expect_counts(ties, settings, seen);
            const Floats fine = on_grid(triangles);
            expect_counts({"middles of edges, " + name, fine, edge_middles(fine), light}, settings, seen);
        }
    for (const char* const what :
         {"map", "queue overflow", "decided_by_float, lit", "decided_by_float, shadowed", "decided_by_integers, lit",
          "decided_by_integers, shadowed", "decided_by_double, lit", "decided_by_double, shadowed"})
        EXPECT_GT(seen[what], 0u) << what << " never happened";
}

TEST(Provenance, OtherNamesAreRefused) {
    const gnomon::Device device;
    const LightScene scene = roof();
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const auto points = gnomon::Points::upload(device, std::vector<float>{0, 0, 0});
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Light light{scene.light};
    EXPECT_THROW(technique->diagnose("grid", triangles, points, light), gnomon::InvalidArgument);
}

}  // namespace
