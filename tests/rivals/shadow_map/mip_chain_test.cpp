// SPDX-License-Identifier: MIT
// Mip chains: levels are means of the map, each in its place; footprints choose among them: the plain lookup where a
// pixel is no wider than a texel, the analytic mean where it is as wide as many edges.
#include <gtest/gtest.h>

#include <cmath>

#include <gnomon.hpp>
#include "kernels/rivals/shadow_map/moments.h"
#include "support/map_scenes.hpp"

namespace {

using namespace support;

constexpr std::uint32_t planes = 2;
constexpr float untouched = -7;

/// Levels of some views' maps; level 0 is `map`. Numbers are in planes, as in the kernels' contracts.
struct Chain {
    std::vector<ViewCase> views;
    std::uint32_t texels = 0;
    std::vector<double> map, mips;

    Chain(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& sizes, const std::function<float(int)>& number,
          bool half_bits) {
        const gnomon::Device device = device_with();
        gnomon::cl::Session& session = session_of(device);
        for (const auto& [width, height] : sizes) views.push_back(straight_view(width, height));
        const gnomon::MapViews uploaded_ones = uploaded_views(session, views);
        texels = uploaded_ones.set.texels;
        gnomon::StorePlan plan{};
        plan.planes = planes;
        plan.half_bits = half_bits;
        std::vector<float> numbers;
        for (std::uint32_t i = 0; i < texels * planes; ++i) numbers.push_back(number(int(i)));
        std::vector<std::uint16_t> words;
        for (const float n : numbers) words.push_back(std::uint16_t(std::lround(n * 65535)));
        const gnomon::cl::Buffer input = half_bits ? uploaded(session, words) : uploaded(session, numbers);
        const std::vector<float> blank(numbers.size(), untouched);
        const gnomon::cl::Buffer output = uploaded(session, blank);
        for (cl_uint level = 1; level <= 6; ++level)
            session.launch("rivals/shadow_map/prefilter.cl", "prefilter_mip", gnomon::cl::Range::items(texels), plan,
                           uploaded_ones.set, level, uploaded_ones.views, level == 1 ? input : output, output);
        if (half_bits) {
            map = in_units(words);
            mips = in_units(downloaded<std::uint16_t>(session, output.get(), numbers.size()));
        } else {
            const auto got = downloaded<float>(session, output.get(), numbers.size());
            map.assign(numbers.begin(), numbers.end());
            mips.assign(got.begin(), got.end());
        }
    }
    static std::vector<double> in_units(const std::vector<std::uint16_t>& words) {
        std::vector<double> numbers;
        for (const std::uint16_t word : words) numbers.push_back(word / 65535.0);
        return numbers;
    }

    /// One level of one plane of a view, row by row; empty if there is none.
    std::vector<double> level(const gnomon::MapView& view, std::uint32_t plane, std::uint32_t level) const {
        std::size_t first = plane * texels + view.first_texel;
        for (std::uint32_t l = 1; l < level; ++l) first += view.width >> l;
        std::vector<double> numbers;
        for (std::uint32_t y = 0; y < view.height >> level; ++y)
            for (std::uint32_t x = 0; x < view.width >> level; ++x)
                numbers.push_back((level == 0 ? map : mips)[first + std::size_t(y) * view.row_stride + x]);
        return numbers;
    }
};

double mean(const std::vector<double>& numbers) {
    double sum = 0;
    for (const double number : numbers) sum += number;
    return sum / double(numbers.size());
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>> even_and_odd{{64, 64}, {37, 52}, {8, 33}, {1, 5}, {63, 31}};

float scattered(int i) { return float(i * 2654435761u % 65536u) / 65535; }

TEST(MipChain, AConstantStaysOneOnEveryLevel) {
    for (const bool half_bits : {false, true}) {
        const Chain chain(
            even_and_odd, [](int) { return 0.7f; }, half_bits);
        for (const ViewCase& c : chain.views)
            for (std::uint32_t plane = 0; plane < planes; ++plane)
                for (std::uint32_t level = 1; level <= 6; ++level)
                    for (const double number : chain.level(c.view, plane, level))
                        ASSERT_NEAR(number, 0.7, half_bits ? 0.5 / 65535 : 5e-7) << level;
    }
}

TEST(MipChain, EvenTexelsAreMeansOfBlocks) {
    const Chain chain({{64, 32}, {16, 16}}, scattered, false);
    for (const ViewCase& c : chain.views)
        for (std::uint32_t plane = 0; plane < planes; ++plane) {
            const auto map = chain.level(c.view, plane, 0);
            for (std::uint32_t level = 1; c.view.height >> level != 0; ++level) {
                const auto got = chain.level(c.view, plane, level);
                const std::uint32_t block = 1u << level, width = c.view.width >> level;
                for (std::uint32_t i = 0; i < got.size(); ++i) {
                    double sum = 0;
                    for (std::uint32_t y = 0; y < block; ++y)
                        for (std::uint32_t x = 0; x < block; ++x)
                            sum += map[(i / width * block + y) * c.view.width + i % width * block + x];
                    ASSERT_NEAR(got[i], sum / (block * block), 1e-6) << "level " << level << ", texel " << i;
                }
            }
        }
}

// Every texel of a level has its share in the next one, also along odd sides.
TEST(MipChain, NoLevelLosesAnything) {
    for (const bool half_bits : {false, true}) {
        const Chain chain(even_and_odd, scattered, half_bits);
        for (const ViewCase& c : chain.views)
            for (std::uint32_t plane = 0; plane < planes; ++plane) {
                const double whole = mean(chain.level(c.view, plane, 0));
                for (std::uint32_t level = 1; (std::min(c.view.width, c.view.height) >> level) != 0; ++level)
                    EXPECT_NEAR(mean(chain.level(c.view, plane, level)), whole, half_bits ? 2e-5 : 1e-6)
                        << c.view.width << " x " << c.view.height << ", level " << level;
            }
    }
}

TEST(MipChain, LevelsFillTheirPlacesAndNoOthers) {
    const Chain chain(even_and_odd, scattered, false);
    std::size_t expected = 0;
    for (const ViewCase& c : chain.views)
        for (std::uint32_t level = 1; (std::min(c.view.width, c.view.height) >> level) != 0; ++level)
            expected += planes * chain.level(c.view, 0, level).size();
    EXPECT_EQ(chain.mips.size() - std::size_t(std::count(chain.mips.begin(), chain.mips.end(), double(untouched))),
              expected);
}

// ---- As a prefilter of the technique -----------------------------------------------------------------------------

/// Light straight down on a floor, through stripes that cover a quarter of it.
struct Stripes {
    gnomon::Device device;
    gnomon::Triangles triangles = gnomon::Triangles::upload(device, floor_and_stripes());
    gnomon::Points points = points_on_floor();

    static Floats floor_and_stripes() {
        Floats triangles;
        add(triangles, {-80, 0, -80}, {80, 0, -80}, {0, 0, 160});
        constexpr float period = 0.1f, width = period / 4;
        for (int i = -120; i < 120; ++i) {
            const float x = period * float(i);
            add(triangles, {x, 1, -12}, {x + width, 1, -12}, {x + width, 1, 12});
            add(triangles, {x, 1, -12}, {x + width, 1, 12}, {x, 1, 12});
        }
        return triangles;
    }
    gnomon::Points points_on_floor() const {
        Floats floats;
        Random random(4);
        for (int i = 0; i < 4000; ++i) add(floats, {random.between(-10, 10), 0, random.between(-10, 10)});
        return gnomon::Points::upload(device, floats, std::vector<std::uint32_t>(4000, 0));
    }

    std::vector<float> visibility(const char* store, const char* prefilter) {
        const auto technique = gnomon::make_technique("shadow-map", device);
        for (const auto& [key, value] : {std::pair{"size", "1024"}, {"store", store}}) technique->set(key, value);
        technique->set("prefilter", prefilter);
        const gnomon::Visibility lit(device, points.count());
        statistics = technique->run(triangles, points, gnomon::Light::directional({0, -1, 0}), lit);
        return lit.read();
    }
    /// A camera this high above the floor.
    void look_from(float height) {
        points.set_camera(gnomon::Camera::look_at({0, height, 0.1f}, {0, 0, 0}, {0, 1, 0}, 60), 24, 16);
    }
    gnomon::Statistics statistics;
};

// Texels are about 0.02 wide, a pixel 0.07 times the height.
TEST(MipChain, SmallFootprintsAreThePlainLookup) {
    Stripes stripes;
    stripes.look_from(0.15f);
    // Seen at an angle footprints grow: of the points below the camera all are small.
    Floats below;
    for (int i = 0; i < 100; ++i) add(below, {0.001f * float(i % 10), 0, 0.1f + 0.001f * float(i / 10)});
    Floats frame{-10, 0, -10, 10, 0, 10};
    append(below, frame);
    stripes.points = gnomon::Points::upload(stripes.device, below, std::vector<std::uint32_t>(102, 0));
    stripes.look_from(0.15f);
    auto filtered = stripes.visibility("variance", "mip"), plain = stripes.visibility("variance", "none");
    filtered.resize(100);
    plain.resize(100);
    EXPECT_EQ(filtered, plain);
    stripes.look_from(5);
    auto far = stripes.visibility("variance", "mip");
    far.resize(100);
    EXPECT_NE(far, plain) << "the comparison above says nothing";
}

// A pixel over dozens of stripes sees three quarters of the light: the two depths below it, a quarter and three
// quarters, are what variance and moments tell apart exactly.
TEST(MipChain, LargeFootprintsAreTheMean) {
    Stripes stripes;
    stripes.look_from(60);
    for (const char* store : {"variance", "evsm4", "moments"}) {
        const auto filtered = stripes.visibility(store, "mip"), plain = stripes.visibility(store, "none");
        double largest = 0, off = 0;
        for (std::size_t i = 0; i < filtered.size(); ++i) {
            largest = std::max(largest, std::fabs(filtered[i] - 0.75));
            off += std::fabs(plain[i] - 0.75) / double(plain.size());
        }
        EXPECT_LT(largest, 0.02) << store;
        EXPECT_GT(off, 0.2) << store << ": unfiltered, points are lit or not";
    }
}

// Between two levels the estimate comes from both: as the camera rises by small steps no mask jumps.
TEST(MipChain, LevelsBlend) {
    Stripes stripes;
    std::vector<float> last;
    double largest = 0, whole = 0;
    for (int step = 0; step <= 40; ++step) {
        stripes.look_from(2 * std::exp2(0.05f * float(step)));
        const std::vector<float> lit = stripes.visibility("variance", "mip");
        double change = 0;
        for (std::size_t i = 0; i < last.size(); ++i) change += std::fabs(lit[i] - last[i]) / double(lit.size());
        largest = std::max(largest, change);
        whole += change;
        last = lit;
    }
    EXPECT_GT(whole, 0.05) << "nothing happened";
    EXPECT_LT(largest, 0.15 * whole) << "steps are 1/40 of the way";
}

TEST(MipChain, WithoutACameraThereAreNoFootprints) {
    Stripes stripes;
    EXPECT_EQ(stripes.visibility("variance", "mip"), stripes.visibility("variance", "none"));
    stripes.visibility("variance", "mip");
    bool said = false;
    for (const auto& stage : stripes.statistics.stages)
        said = said || (stage.name == "prefilter" && stage.skipped.find("mip needs points of a camera") == 0);
    EXPECT_TRUE(said);
}

}  // namespace
