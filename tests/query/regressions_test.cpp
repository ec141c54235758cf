// SPDX-License-Identifier: MIT
// Faults that a review found, each as a small scene that fails if its fix is undone. Every point and every pixel is
// compared with the oracle; for a fault of cost, the count is compared with a bound, and the reason stands beside it.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include <gnomon.hpp>
#include "reference/view.hpp"
#include "support/environment.hpp"
#include "support/expect_exact.hpp"

namespace {

using namespace support;
using gnomon::Device;

Device& device() {
    static Device opened;
    return opened;
}

/// A point on the light's ray through a point of a triangle, `past` times the triangle's distance beyond it.
Float3 behind(const Light& light, const Floats& triangles, std::size_t triangle, Random& random, float past) {
    const float a = random.between(0, 0.5f), b = random.between(0, 0.5f);
    Float3 p;
    for (int k = 0; k < 3; ++k) {
        const double u = triangles[9 * triangle + k], v = triangles[9 * triangle + 3 + k],
                     w = triangles[9 * triangle + 6 + k], q = u + a * (v - u) + b * (w - u);
        p[k] = float(light[k] + (q - light[k]) * (1.0 + past));
    }
    return p;
}

/// Triangles around a position, and points behind them and before them as seen from the point light.
LightScene soup_around(const Light& point_light, float scale, std::size_t triangles, std::size_t points,
                       Random& random) {
    LightScene question{"soup around a point light, " + std::to_string(std::log10(scale)), {}, {}, point_light};
    for (std::size_t t = 0; t < triangles; ++t) {
        const Float3 centre = random_vector(random, -1, 1);
        for (int v = 0; v < 3; ++v) {
            Float3 at_vertex = random_vector(random, -0.6f, 0.6f);
            for (int k = 0; k < 3; ++k) at_vertex[k] = point_light[k] + scale * (centre[k] + at_vertex[k]);
            add(question.triangles, at_vertex);
        }
    }
    for (std::size_t i = 0; i < points; ++i)
        if (i % 2 == 0)
            add(question.points, behind(point_light, question.triangles, random.below(std::uint32_t(triangles)), random,
                                        random.between(-0.9f, 3)));
        else  // anywhere, so also just beside a triangle
            add(question.points, random_vector(random, -3 * scale, 3 * scale));
    return question;
}

// Slopes of edges near a point light are so small that squares underflow; the map's circle test took its margin for 0.
TEST(Regressions, MapByCirclesNearAPointLightDrawsNoFalseShadows) {
    AnswerTally tally;
    Random random(1);
    for (const float scale : {1e-10f, 3e-11f, 1e-11f, 4e-12f, 1e-12f, 1e-13f, 1e-14f})
        for (int i = 0; i < 4; ++i)
            expect_exact(device(), soup_around(at(0, 0, 0), scale, 20, 800, random),
                         {{"conservative-map", "on"}, {"cover-test", "circle"}, {"map-size", "16"}}, tally);
    EXPECT_GT(tally.lit, 1000u);
    EXPECT_GT(tally.shadowed, 1000u);
}

/// Triangles and points a few denormals apart, around a point light; 24 scenes, the map on and off.
void expect_exact_within_denormals_of_a_point_light(const Device& on) {
    AnswerTally tally;
    Random random(2);
    const auto near = [&random](float from) { return from + std::ldexp(float(random.below(17)) - 8, -149); };
    for (int i = 0; i < 24; ++i) {
        const Light point_lights[] = {at(0, 0, 0), at(1e-40f, -3e-41f, 1e-44f), at(0x1p-126f, 0, 1e-43f)};
        LightScene question{"within denormals of a point light", {}, {}, point_lights[i % 3]};
        for (int v = 0; v < 12; ++v)
            for (int k = 0; k < 3; ++k) question.triangles.push_back(near(question.light[k]));
        for (int p = 0; p < 150; ++p)
            for (int k = 0; k < 3; ++k) question.points.push_back(near(question.light[k]));
        // Half of the time farther points too, so that the near ones are not the whole grid.
        for (int p = 0; p < (i % 2) * 50; ++p) add(question.points, random_vector(random, -1, 1));
        for (const char* map : {"on", "off"}) expect_exact(on, question, {{"conservative-map", map}}, tally);
    }
    EXPECT_GT(tally.lit, 1000u);
    EXPECT_GT(tally.shadowed, 200u);
}

TEST(Regressions, PointsWithinDenormalsOfAPointLight) { expect_exact_within_denormals_of_a_point_light(device()); }

/// A copy of the kernels in which one text is replaced; every Device opened in its lifetime uses it.
class ChangedKernels {
public:
    ChangedKernels(const std::string& file, const std::string& text, const std::string& replacement)
        : folder_(std::filesystem::path(testing::TempDir()) / ("gnomon_changed_kernels_" + std::to_string(getpid()))) {
        std::filesystem::copy(GNOMON_KERNELS, folder_, std::filesystem::copy_options::recursive);
        std::ifstream in(folder_ / file);
        std::string source{std::istreambuf_iterator<char>(in), {}};
        const std::size_t place = source.find(text);
        if (place == std::string::npos) throw std::runtime_error(file + " no longer has the text to change");
        std::ofstream(folder_ / file) << source.replace(place, text.size(), replacement);
    }
    ~ChangedKernels() { std::filesystem::remove_all(folder_); }
    ChangedKernels(const ChangedKernels&) = delete;
    ChangedKernels& operator=(const ChangedKernels&) = delete;

private:
    std::filesystem::path folder_;
    support::Environment folder_in_use_{"GNOMON_KERNELS_DIR", folder_.string()};
};

// A device may flush denormals. If a point's difference to the point light vanished there, the point belonged to no
// frame and stayed lit. This machine's devices flush nothing, so a copy of the kernels does.
TEST(Regressions, PointsWithinFlushedDenormalsOfAPointLight) {
    const std::string difference = "LaneFloat x = points.x - light_x, y = points.y - light_y, z = points.z - light_z;";
    std::string flush;
    for (const std::string v : {"x", "y", "z"})
        flush += " " + v + " = LANES_SELECT(" + v + ", (LaneFloat)(0.0f), LANE_COMPARE(fabs(" + v +
                 "), <, (LaneFloat)(FLT_MIN)));";
    const ChangedKernels kernels("receivers/light_frame.h", difference, difference + flush);
    expect_exact_within_denormals_of_a_point_light(Device());
}

/// Small triangles in a box above many points, as wide as the box, all times `scale`; the light is directional from
/// above or a point light. A pair is rarely within the float filter's error; else the filter decides it.
LightScene wide_scene(float scale, bool has_point_light, Random& random) {
    LightScene question{std::to_string(scale) + (has_point_light ? ", point light" : "")};
    question.light = has_point_light ? at(0.3f * scale, 0.2f * scale, 2 * scale) : along(0.1f, 0.2f, -1);
    const auto scaled = [scale](Float3 v) {
        for (float& x : v) x *= scale;
        return v;
    };
    for (int t = 0; t < 300; ++t) {
        const Float3 centre = {random.between(-1, 1), random.between(-1, 1), random.between(0, 1)};
        for (int v = 0; v < 3; ++v) {
            Float3 offset = random_vector(random, -0.08f, 0.08f);
            for (int k = 0; k < 3; ++k) offset[k] += centre[k];
            add(question.triangles, scaled(offset));
        }
    }
    for (int p = 0; p < 1000; ++p)
        add(question.points, scaled({random.between(-1, 1), random.between(-1, 1), random.between(-1, 0)}));
    return question;
}

// The filter errs by some hundred units in the last place, so it leaves far fewer than one in a thousand random pairs
// undecided, whatever the size of the scene.
TEST(Regressions, ScenesUpTo1e30DoNotLeaveEveryPairOpen) {
    Random random(3);
    for (const bool has_point_light : {false, true})
        for (const float scale : {1e10f, 1e16f, 1e22f, 2e29f}) {
            if (has_point_light && scale > 1e28f) continue;
            AnswerTally tally;
            expect_exact(device(), wide_scene(scale, has_point_light, random), {}, tally);
            EXPECT_LT(tally.uncertain, tally.pairs / 1000) << scale << (has_point_light ? ", point light" : "");
            EXPECT_GT(tally.shadowed, 50u);
        }
}

// One point a hundred times as far away as the others costs the filter two of its seven digits: at most one pair in a
// hundred is then undecided, not all pairs.
TEST(Regressions, OneStrayPointDoesNotLeaveEveryPairOpen) {
    Random random(4);
    for (const bool has_point_light : {false, true})
        for (const float scale : {1e14f, 1e20f, 1e25f}) {
            LightScene question = wide_scene(scale, has_point_light, random);
            add(question.points, {20 * scale, 10 * scale, -100 * scale});
            AnswerTally tally;
            expect_exact(device(), question, {}, tally);
            EXPECT_LT(tally.uncertain, tally.pairs / 100) << scale << (has_point_light ? ", point light" : "");
        }
}

// Floats give no direction to a vertex a few denormals from the eye; the camera missed such triangles.
TEST(Regressions, TrianglesThatTouchTheEyeButForDenormalsAreSeen) {
    Random random(5);
    std::uint64_t seen = 0, wrong = 0;
    for (int i = 0; i < 40; ++i) {
        reference::PinholeCamera camera;
        camera.target = random_vector(random, -1, 1);
        camera.up = random_vector(random, -1, 1);
        camera.width = camera.height = 40;
        Floats triangles;
        Float3 near;
        for (int k = 0; k < 3; ++k)
            near[k] = std::ldexp(std::copysign(float(1 + random.below(3)), camera.target[k]), -149);
        add(triangles, near);
        for (int v = 0; v < 2; ++v) {
            Float3 far = random_vector(random, -1, 1);
            for (int k = 0; k < 3; ++k) far[k] += 1.5f * camera.target[k];
            add(triangles, far);
        }
        const auto eye_view = gnomon::Camera::look_at(camera.eye, camera.target, camera.up, camera.fov_y_degrees);
        const auto uploaded = gnomon::Triangles::upload(device(), triangles);
        const gnomon::View view = gnomon::look(device(), uploaded, eye_view, camera.width, camera.height);
        const gnomon::ViewOnHost claim = view.read(device(), uploaded);
        const reference::ViewReport report =
            reference::judge_view(triangles, camera, std::nullopt, {claim.position, claim.normal, claim.receiver, {}});
        wrong += report.wrong();
        seen += report.pixels - report.sky;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(seen, 2000u);
}

/// The number of cells of a grid of `cells` x `cells` over one face of the cube around the point light that meet the
/// bounding box of a triangle's part in the face (clipped to the face's pyramid in double; corners are small integers).
std::uint64_t cells_on_face(const std::array<std::array<double, 3>, 3>& triangle, int axis, double sign, double cells) {
    std::vector<std::array<double, 3>> polygon;
    for (const auto& v : triangle) polygon.push_back({v[(axis + 1) % 3], v[(axis + 2) % 3], sign * v[axis]});
    for (int side = 0; side < 4; ++side) {
        const auto inside = [side](const std::array<double, 3>& v) {
            return v[2] + (side % 2 ? v[side / 2] : -v[side / 2]);
        };
        std::vector<std::array<double, 3>> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            const double at_a = inside(a), at_b = inside(b);
            if (at_a >= 0) kept.push_back(a);
            if ((at_a < 0) == (at_b < 0)) continue;
            const double t = at_a / (at_a - at_b);
            kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
        }
        polygon = kept;
    }
    if (polygon.empty()) return 0;
    std::uint64_t count = 1;
    for (int k = 0; k < 2; ++k) {
        double low = 1, high = -1;
        for (const auto& v : polygon) low = std::min(low, v[k] / v[2]), high = std::max(high, v[k] / v[2]);
        count *= std::uint64_t(std::floor((high + 1) / 2 * cells) - std::floor((low + 1) / 2 * cells)) + 1;
    }
    return count;
}

// Triangles with a vertex in the plane through the point light that ends a face's pyramid (W = 0), or behind it: each
// was given the whole grid.
TEST(Regressions, TrianglesThatReachBehindAPointLightCoverNoMoreThanTheyMust) {
    constexpr int reach = 10;
    const Float3 point_light = {3, 5, -2};
    LightScene question{"behind a point light", {}, {}, at(point_light[0], point_light[1], point_light[2])};
    // A floor and a wall, both through lattice points that share coordinates with the point light.
    for (int u = -reach; u < reach; ++u)
        for (int v = -reach; v < reach; ++v)
            for (const int axis : {0, 1}) {
                const auto corner = [&](int du, int dv) {
                    Float3 p = point_light;
                    p[axis] -= axis == 0 ? 3 : 2;
                    p[(axis + 1) % 3] += float(u + du);
                    p[(axis + 2) % 3] += float(v + dv);
                    return p;
                };
                add(question.triangles, corner(0, 0), corner(1, 0), corner(1, 1));
                add(question.triangles, corner(0, 0), corner(1, 1), corner(0, 1));
            }
    Random random(6);
    for (int p = 0; p < 4000; ++p) {
        Float3 point = random_vector(random, -12, 12);
        if (p % 4 == 0)  // on the lattice, where rays meet edges and corners
            for (float& x : point) x = std::round(x);
        for (int k = 0; k < 3; ++k) point[k] += point_light[k];
        add(question.points, point);
    }
    AnswerTally tally;
    const Answer found = expect_exact(device(), question, {{"map-size", "64"}}, tally);
    EXPECT_GT(tally.lit, 500u);
    EXPECT_GT(tally.shadowed, 500u);
    // A face sees a triangle if its pyramid contains a part of the triangle. A grid has at most 16 x 16 bins.
    std::uint64_t seen = 0, cells = 0;
    for (std::size_t t = 0; t < question.triangles.size() / 9; ++t) {
        std::array<std::array<double, 3>, 3> triangle;
        for (int v = 0; v < 3; ++v)
            for (int k = 0; k < 3; ++k) triangle[v][k] = question.triangles[9 * t + 3 * v + k] - point_light[k];
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                const std::uint64_t on_face = cells_on_face(triangle, axis, sign, 16);
                seen += on_face > 0;
                cells += on_face;
            }
    }
    EXPECT_LE(found.count("triangles_kept"), seen);
    EXPECT_LE(found.count("references"), cells);
}

// An eye is on one side of the receiver's plane, but the caller's point may be on the other: a point below its own
// receiver is not shadowed by it.
TEST(Regressions, PointBelowItsOwnReceiverWithAnEye) {
    LightScene question{"below its own receiver"};
    add(question.triangles, {-1, 0, -1}, {-1, 0, 1}, {1, 0, 0});
    for (int i = 0; i < 20; ++i) add(question.points, {-0.5f + 0.01f * float(i), -0.1f, 0});
    question.light = along(0, -1, 0);
    question.eye = {0, 3, 0};
    question.receivers.assign(20, 0);
    // More points without a receiver, many of them in shadow, so that the map has points to decide.
    for (int i = 0; i < 400; ++i) {
        add(question.points, {-1.2f + 0.12f * float(i % 20), -0.1f, -1.2f + 0.12f * float(i / 20)});
        question.receivers.push_back(gnomon::no_receiver);
    }
    for (const char* map : {"on", "off"}) {
        AnswerTally tally;
        expect_exact(device(), question, {{"conservative-map", map}}, tally);
        EXPECT_GT(tally.shadowed, 100u);
    }
}

}  // namespace
