// SPDX-License-Identifier: MIT
// The conservative map alone, as a lower bound of the shadow: never wrongly dark, less and less wrongly lit with more
// texels, at most what the exact technique's own count of the map says.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/floor_view.hpp"

namespace {

using namespace support;

class ConservativeMapAlone : public FloorView {
protected:
    Errors errors(const Floats& scene, const gnomon::Light& light, const Settings& settings) {
        return FloorView::errors(scene, light, "conservative-map", settings);
    }
};

TEST_F(ConservativeMapAlone, NothingIsWronglyInShadow) {
    for (const Floats& casters : {one_triangle, icosphere(2, 0.8f), soup(200, 0.5f, 5), slivers(50, 0.02f, 3)})
        for (const gnomon::Light& light : lights())
            for (const char* test : {"tight", "circle"})
                for (const char* size : {"16", "256", "2048"}) {
                    const Errors found =
                        errors(over_a_floor(casters), light, {{"map-size", size}, {"cover-test", test}});
                    EXPECT_EQ(found.wrongly_shadowed, 0u);
                    EXPECT_GT(found.lit, 100u);
                }
}

// What stays wrongly lit of one caster's shadow is the texels along its outline: their area falls as their side.
TEST_F(ConservativeMapAlone, MissesTheTexelsAlongTheOutline) {
    for (const gnomon::Light& light : lights()) {
        const auto wrongly_lit = [&](const char* size) {
            return double(errors(over_a_floor(one_triangle), light, {{"map-size", size}}).wrongly_lit);
        };
        const double coarse = wrongly_lit("32"), fine = wrongly_lit("256");
        EXPECT_GT(coarse, 100);
        EXPECT_LT(fine, coarse / 4);
    }
}

// Where Hertel's circle lies inside a triangle the texel does too; and more texels do.
TEST_F(ConservativeMapAlone, TightTestProvesMoreThanTheCircle) {
    for (const gnomon::Light& light : lights()) {
        const Floats scene = over_a_floor(soup(100, 0.8f, 5));
        const auto tight = run(scene, light, "conservative-map", {{"map-size", "128"}});
        const auto circle = run(scene, light, "conservative-map", {{"map-size", "128"}, {"cover-test", "circle"}});
        std::size_t more = 0;
        for (std::size_t i = 0; i < tight.size(); ++i) {
            EXPECT_LE(tight[i], circle[i]);
            more += tight[i] < circle[i];
        }
        EXPECT_GT(more, 10u);
    }
}

// The points that the exact technique's map decides, at the same size, are these.
TEST_F(ConservativeMapAlone, DecidesWhatTheExactTechniquesMapDecides) {
    for (const gnomon::Light& light : lights()) {
        const Floats scene = over_a_floor(soup(100, 0.8f, 5));
        const auto mask = run(scene, light, "conservative-map", {{"map-size", "128"}});
        const std::uint64_t decided = statistics_.count("points_decided_by_map");
        EXPECT_GT(decided, 100u);
        EXPECT_EQ(statistics_.count("points_in_shadow"), std::uint64_t(std::count(mask.begin(), mask.end(), 0.0f)));
        EXPECT_EQ(statistics_.count("points_facing_away") + decided, statistics_.count("points_in_shadow"));
        run(scene, light, "frustum-traced", {{"map-size", "128"}, {"conservative-map", "on"}});
        EXPECT_EQ(statistics_.count("points_decided_by_map"), decided);
    }
}

// A map does not say whose cover it holds: a point behind its own receiver must stay lit, one without must not.
TEST_F(ConservativeMapAlone, ReceiversNeverShadowTheirOwnPoints) {
    const auto triangles = gnomon::Triangles::upload(device_, Floats{-4, 0, -4, 4, 0, -4, 0, 0, 8});
    Floats below;
    for (int i = 0; i < 256; ++i) add(below, {0.05f * float(i % 16) - 0.4f, -0.01f, 0.05f * float(i / 16) - 0.4f});
    const auto technique = gnomon::make_technique("conservative-map", device_);
    technique->set("map-size", "16");
    const auto sun = gnomon::Light::directional({0.1f, -1, 0});
    const gnomon::Visibility visibility(device_, 256);
    technique->run(triangles, gnomon::Points::upload(device_, below), sun, visibility);
    EXPECT_EQ(visibility.read(), std::vector<float>(256, 0));
    technique->run(triangles, gnomon::Points::upload(device_, below, std::vector<std::uint32_t>(256, 0)), sun,
                   visibility);
    EXPECT_EQ(visibility.read(), std::vector<float>(256, 1));
}

TEST_F(ConservativeMapAlone, NothingToDo) {
    EXPECT_EQ(run({}, lights().front(), "conservative-map"), std::vector<float>(width * height, 1));
    const float nan = std::nanf("");
    const auto triangles = gnomon::Triangles::upload(device_, one_triangle);
    const auto points = gnomon::Points::upload(device_, Floats{nan, 0, 0, 5, -1, 0});
    const gnomon::Visibility visibility(device_, points.count());
    const auto technique = gnomon::make_technique("conservative-map", device_);
    technique->run(triangles, points, lights().front(), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 1}));
    technique->run(gnomon::Triangles::upload(device_, {}), points, lights().back(), visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 1}));
}

// Sheets over the whole grid are in many more tiles than there are triangles. Lists start longer where there are more
// cores, up to 64 of them.
TEST_F(ConservativeMapAlone, ListsThatAreTooShortGrow) {
    Floats sheets;
    const std::uint32_t sheet_count = 90 * std::clamp(device_.description().compute_units, 4u, 64u);
    for (std::uint32_t i = 0; i < sheet_count; ++i) {
        const float y = 2 + 0.001f * float(i);
        add(sheets, {-9, y, -9}, {-9, y, 9}, {9, y, 9});
    }
    const Errors found = errors(over_a_floor(sheets), lights().front(), {{"map-size", "512"}});
    EXPECT_EQ(found.wrongly_shadowed, 0u);
    EXPECT_LT(found.wrongly_lit, found.in_shadow / 20);
    EXPECT_GT(found.in_shadow, 100u);
    EXPECT_GT(statistics_.count("lists_grown"), 0u);
}

TEST_F(ConservativeMapAlone, SameBitsForEveryWorkGroupSize) {
    const Floats scene = over_a_floor(soup(300, 0.5f, 7));
    for (const gnomon::Light& light : {lights().front(), lights().back()}) {
        device_ = device_with();
        const auto expected = run(scene, light, "conservative-map", {{"map-size", "256"}});
        for (const std::uint32_t size : FEW_WORK_GROUP_SIZES) {
            device_ = device_with(size);
            EXPECT_EQ(run(scene, light, "conservative-map", {{"map-size", "256"}}), expected) << size;
        }
    }
}

TEST_F(ConservativeMapAlone, RefusesBadSettings) {
    const auto technique = gnomon::make_technique("conservative-map", device_);
    for (const auto& [key, value] : Settings{
             {"map-size", "8"}, {"map-size", "auto"}, {"map-size", "100000"}, {"cover-test", "loose"}, {"bias", "1"}})
        EXPECT_THROW(technique->set(key, value), gnomon::InvalidArgument) << key << " " << value;
}

}  // namespace
