// SPDX-License-Identifier: MIT
// Stage projection of the shadow maps: what every fit promises (each point is held by a view, whatever casts on it lies
// at the same place of the map and nearer), and what each family is known for, by formulas of the literature and
// geometry worked out here in double precision.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "support/map_fits.hpp"

namespace {

using namespace support;

/// Whether the direction from the point light lies within the face.
bool is_on_face(const Fitted& fitted, const MapView& view, const Double3& p) {
    if (view.face == NO_FACE) return true;
    const int axis = int(view.face / 2);
    Double3 d;
    for (int i = 0; i < 3; ++i) d[i] = p[i] - fitted.set.light[i];
    const double reach = (view.face % 2 == 1 ? -d[axis] : d[axis]) * (1 + FACE_RIM);
    return std::fabs(d[(axis + 1) % 3]) <= reach && std::fabs(d[(axis + 2) % 3]) <= reach;
}

/// As map_view.h selects, in double.
const MapView* view_of(const Fitted& fitted, const Scene& scene, const Double3& p) {
    for (const MapView& view : fitted.views) {
        const double depth = fitted.set.has_camera != 0 ? scene.depth(p) : 0;
        if (view.width == 0 || !is_on_face(fitted, view, p) || depth < view.select_near || depth >= view.select_far)
            continue;
        const SceneBox at = place(view, p);
        if (is_inside(at) && at.depth > view.front_depth) return &view;
    }
    return nullptr;
}

/// Towards the light from p, unit length.
Double3 towards(const gnomon::Light& light, const Double3& p) {
    Double3 d = loaded(light.xyzw.data());
    if (!light.is_directional()) d -= p;
    gnomon::make_unit(d);
    return d;
}

std::vector<std::pair<std::string, gnomon::Light>> lights() {
    return {{"noon", gnomon::Light::directional({0.1f, -1, 0.05f})},
            {"side", gnomon::Light::directional({-1, -0.4f, 0.1f})},
            {"from behind", gnomon::Light::directional({0.1f, -0.3f, -1})},
            {"from ahead", gnomon::Light::directional({0.05f, -0.3f, 1})},
            {"point light in view", gnomon::Light::point({1, 6, 4})},
            {"point light behind", gnomon::Light::point({-8, 9, 45})}};
}

std::vector<Settings> compositions() {
    std::vector<Settings> all;
    for (const char* projection : {"uniform", "psm", "lispsm", "logpsm"}) {
        for (const char* form : {"receivers", "frustum"})
            for (const char* partition : {"single", "depth", "faces"})
                all.push_back({{"projection", projection}, {"fit", form}, {"partition", partition}, {"cascades", "3"}});
        all.push_back({{"projection", projection}, {"cascades", "4"}, {"lambda", "1"}, {"overlap", "0"}});
        all.push_back({{"projection", projection}, {"cascades", "4"}, {"share-texels", "on"}});
    }
    for (const char* form : {"casters", "sphere", "quantised"})
        for (const char* cascades : {"1", "4"}) all.push_back({{"fit", form}, {"cascades", cascades}});
    all.push_back({{"projection", "logpsm"}, {"cascades", "3"}, {"self-similar", "on"}, {"fit", "frustum"}});
    all.push_back({{"cascades", "5"}, {"storage", "atlas"}});
    all.push_back({{"cascades", "4"}, {"depth-range", "planes"}, {"fit", "frustum"}});
    return all;
}

std::string named(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings) text += (text.empty() ? "" : " ") + name + "=" + value;
    return text;
}

// What the lookups rely on, for every composition and light.
TEST(Projection, HoldsEveryPointAndWhatCastsOnIt) {
    Scene scene;
    for (const auto& [name, light] : lights())
        for (const Settings& settings : compositions()) {
            SCOPED_TRACE(name + ", " + named(settings));
            const Fitted fitted = fit(scene, light, settings);
            std::size_t lost = 0;
            double astray = 0;
            for (std::size_t i = 0; i < scene.positions.size(); i += 3) {
                const Double3 p = to_double(&scene.positions[i]);
                const MapView* view = view_of(fitted, scene, p);
                if (view == nullptr) {
                    ++lost;
                    continue;
                }
                const SceneBox at = place(*view, p);
                EXPECT_TRUE(at.depth >= 0 && at.depth <= 1) << at.depth;
                // A caster 3 m nearer: same texel, smaller depth, and for a direction by the same for all points.
                const SceneBox nearer = place(*view, p + 3.0 * towards(light, p));
                EXPECT_LT(nearer.depth, at.depth);
                // Rows are floats: what they are off by is less than a twentieth of a texel, or a tenth of a
                // millimetre where a view of few points has texels finer than that.
                astray = std::max({astray,
                                   std::min(std::fabs(nearer.u - at.u) * view->width / 0.05,
                                            std::fabs(nearer.u - at.u) / slope(*view, view->row_u, at.u, p) / 1e-4),
                                   std::min(std::fabs(nearer.v - at.v) * view->height / 0.05,
                                            std::fabs(nearer.v - at.v) / slope(*view, view->row_v, at.v, p) / 1e-4)});
            }
            EXPECT_EQ(lost, 0u) << "of " << scene.positions.size() / 3;
            EXPECT_LT(astray, 1) << "a point and what shades it lie at different places";
        }
}

// ---- Partitions -----------------------------------------------------------------------------------------------------

const gnomon::Light noon = gnomon::Light::directional({0, -1, 0});

/// The point at this depth and these shares of the picture's half widths.
Double3 from_camera(const Scene& scene, double x, double y, double z) {
    return loaded(scene.camera.eye) + loaded(scene.camera.right) * (x * z * scene.tangent_right()) +
           loaded(scene.camera.up) * (y * z * scene.tangent_up()) + loaded(scene.camera.forward) * z;
}

/// Ends of the slices, from select_near and select_far.
std::vector<double> splits(const Fitted& fitted) {
    std::vector<double> ends;
    for (std::size_t i = 0; i + 1 < fitted.views.size(); ++i) {
        EXPECT_EQ(fitted.views[i].select_far, fitted.views[i + 1].select_near) << "a gap or an overlap";
        ends.push_back(fitted.views[i].select_far);
    }
    EXPECT_EQ(fitted.views.front().select_near, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(fitted.views.back().select_far, std::numeric_limits<float>::infinity());
    return ends;
}

TEST(Partition, ParallelSplitsAreEvenFor0AndAGeometricRowFor1) {
    Scene scene;
    const Settings planes{{"cascades", "4"}, {"depth-range", "planes"}, {"near", "2"}, {"far", "162"}};
    const auto with = [&](const char* lambda) {
        Settings settings = planes;
        settings.emplace_back("lambda", lambda);
        return splits(fit(scene, noon, settings));
    };
    const auto even = with("0"), logarithmic = with("1"), half = with("0.5");
    for (int i = 0; i < 3; ++i) {
        EXPECT_FLOAT_EQ(even[i], 2 + 40 * (i + 1));
        EXPECT_FLOAT_EQ(logarithmic[i], 2 * std::pow(3, i + 1));  // 162 / 2 = 3^4
        EXPECT_FLOAT_EQ(half[i], (even[i] + logarithmic[i]) / 2);
    }
}

// The reduction on the device finds the host's least and greatest depth: the middle of two slices tells both.
TEST(Partition, SampleDistributionReachesFromTheNearestPointToTheFarthest) {
    for (const std::uint32_t work_group_size : FEW_WORK_GROUP_SIZES) {
        Scene scene(device_with(work_group_size));
        double least = 1e30, greatest = 0;
        for (std::size_t i = 0; i < scene.positions.size(); i += 3) {
            least = std::min(least, scene.depth(to_double(&scene.positions[i])));
            greatest = std::max(greatest, scene.depth(to_double(&scene.positions[i])));
        }
        const double even = splits(fit(scene, noon, {{"cascades", "2"}, {"lambda", "0"}}))[0];
        const double logarithmic = splits(fit(scene, noon, {{"cascades", "2"}, {"lambda", "1"}}))[0];
        EXPECT_NEAR(even, (least + greatest) / 2, 2e-5 * greatest);
        EXPECT_NEAR(logarithmic, std::sqrt(least * greatest), 2e-5 * greatest);
    }
}

TEST(Partition, StorageMovesTexelsAndNothingElse) {
    Scene scene;
    const Fitted array = fit(scene, noon, {{"cascades", "5"}}),
                 atlas = fit(scene, noon, {{"cascades", "5"}, {"storage", "atlas"}});
    ASSERT_EQ(array.views.size(), 5u);
    std::vector<int> uses(std::max(array.set.texels, atlas.set.texels));
    for (const Fitted* fitted : {&array, &atlas}) {
        std::fill(uses.begin(), uses.end(), 0);
        for (const MapView& view : fitted->views)
            for (std::uint32_t y = 0; y < view.height; ++y)
                for (std::uint32_t x = 0; x < view.width; ++x) {
                    const std::size_t texel = view.first_texel + std::size_t(y) * view.row_stride + x;
                    ASSERT_LT(texel, fitted->set.texels);
                    ASSERT_EQ(++uses[texel], 1) << "two views share a texel";
                }
    }
    for (std::size_t i = 0; i < 5; ++i) {
        MapView moved = atlas.views[i];
        moved.first_texel = array.views[i].first_texel;
        moved.row_stride = array.views[i].row_stride;
        EXPECT_EQ(std::memcmp(&moved, &array.views[i], sizeof(MapView)), 0);
    }
}

// Moved and turned by less than its texels, a stabilised view stays the same to the bit or moves by whole texels: so
// every texel covers what it covered. Swimming is counted in texels of displacement, along an axis whose texels keep
// their size; the plain fit shows that it is there.
struct Swimming {
    double largest = 0;
    int kept = 0, resized = 0;  ///< axes of views, from one step to the next
};

Swimming swimming_of(const Settings& settings) {
    Swimming found;
    std::vector<MapView> before;
    for (int step = 0; step < 12; ++step) {
        const float t = 0.013f * static_cast<float>(step);
        Scene scene(gnomon::Camera::look_at({t, 3, 30 - 0.7f * t}, {2 + 1.5f * t, 1, 0}, {0, 1, 0}, 50));
        const auto views = fit(scene, gnomon::Light::directional({0.3f, -1, 0.2f}), settings).views;
        for (std::size_t i = 0; i < before.size(); ++i) {
            if (views[i].width == 0 || before[i].width == 0) continue;
            for (int axis = 0; axis < 2; ++axis) {
                const auto row = [&](const MapView& view) { return axis == 0 ? &view.row_u[0] : &view.row_v[0]; };
                const double now_size = length(loaded(row(views[i]))), then_size = length(loaded(row(before[i])));
                const bool is_kept = std::fabs(now_size / then_size - 1) < 1e-5;
                ++(is_kept ? found.kept : found.resized);
                for (const Double3 p : {Double3{0, 0, 0}, Double3{3, 0, 5}, Double3{-4, 2, -7}}) {
                    const SceneBox now = place(views[i], p), then = place(before[i], p);
                    const double moved = (axis == 0 ? now.u - then.u : now.v - then.v) * 256;
                    if (is_kept) found.largest = std::max(found.largest, std::fabs(moved - std::round(moved)));
                }
            }
        }
        before = views;
    }
    return found;
}

// Quantised views change their size where the slice's width along an axis passes a 64th of the scene's.
TEST(Partition, StabilisedViewsMoveByWholeTexels) {
    const Settings cascades{{"cascades", "3"}, {"near", "1"}, {"far", "120"}, {"depth-range", "planes"}};
    const auto with = [&](const char* form) {
        Settings settings = cascades;
        settings.emplace_back("fit", form);
        return swimming_of(settings);
    };
    // Rows are floats and a point lies up to a few hundred texels from the origin of the grid: 2^-24 of that, a few
    // times over, is what "whole" means.
    const Swimming sphere = with("sphere"), quantised = with("quantised"), plain = with("frustum");
    EXPECT_LT(sphere.largest, 2e-4);
    EXPECT_EQ(sphere.resized, 0);
    EXPECT_LT(quantised.largest, 2e-4);
    EXPECT_LT(quantised.resized, quantised.kept / 20);
    EXPECT_GT(plain.resized, plain.kept) << "the test would not see swimming";
    EXPECT_GT(quantised.kept, 60);
}

/// The width of what lies at these points along a direction.
double width_along(const Double3& direction, const std::vector<Double3>& points) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Double3& p : points) low = std::min(low, dot(direction, p)), high = std::max(high, dot(direction, p));
    return high - low;
}

/// The corners of the box around these points.
std::vector<Double3> corners_of_box(const Floats& vertices) {
    std::vector<Double3> corners(8);
    for (int axis = 0; axis < 3; ++axis) {
        double low = vertices[std::size_t(axis)], high = low;
        for (std::size_t i = std::size_t(axis); i < vertices.size(); i += 3)
            low = std::min<double>(low, vertices[i]), high = std::max<double>(high, vertices[i]);
        for (int i = 0; i < 8; ++i) corners[std::size_t(i)][axis] = (i >> axis & 1) != 0 ? high : low;
    }
    return corners;
}

// Zhang et al. 2009: along each axis by itself, a view is as many 64ths of the scene as its slice needs, not as many as
// the longer axis needs.
TEST(Partition, QuantisedViewsAreWhole64thsOfTheSceneAlongEachAxis) {
    // Without a camera's roll the slice is wide and short for a light from ahead.
    Scene scene(gnomon::Camera::look_at({0, 3, 30}, {2, 2, 0}, {0, 1, 0}, 30));
    const Settings settings{{"fit", "quantised"}, {"near", "1"}, {"far", "40"}, {"depth-range", "planes"}};
    std::vector<Double3> slice;
    for (int i = 0; i < 8; ++i) slice.push_back(from_camera(scene, i % 2 * 2 - 1, i / 2 % 2 * 2 - 1, i < 4 ? 1 : 40));
    const MapView view = fit(scene, gnomon::Light::directional({0.2f, -0.2f, -1}), settings).views.at(0);
    double levels[2];
    for (int axis = 0; axis < 2; ++axis) {
        const Double3 row = loaded(axis == 0 ? &view.row_u[0] : &view.row_v[0]);
        // All but the texel of room on either side. The scene's box has a margin of 1e-4 of its diagonal.
        const double width = (1 / length(row)) * 254 / 256,
                     scene_width = width_along(row / length(row), corners_of_box(scene.vertices));
        const double needed = width_along(row / length(row), slice) / scene_width * 64;
        levels[axis] = width / scene_width * 64;
        EXPECT_GT(levels[axis], needed * 0.999);
        EXPECT_LT(levels[axis], needed * 1.001 + 1);
        EXPECT_NEAR(levels[axis], std::round(levels[axis]), 0.004 * levels[axis]);
    }
    EXPECT_GT(std::fabs(levels[0] - levels[1]), 2) << "the test would not see one square for both axes";
}

/// Whether all of these are numbers.
bool are_finite(const float* values, int count) {
    return std::all_of(values, values + count, [](float value) { return std::isfinite(value); });
}

// A scene that is flat along an axis of the map has 64ths there all the same, of its box's margin. One in which no
// vertex is present has none: its view is the slice.
TEST(Partition, QuantisedViewsAreNumbersWhereTheSceneHasNoWidth) {
    const Settings settings{{"fit", "quantised"}, {"near", "1"}, {"far", "40"}, {"depth-range", "planes"}};
    Scene scene;
    const float absent = std::numeric_limits<float>::quiet_NaN();
    const Floats flat{-60, 0, -60, 60, 0, -60, 60, 0, 60}, nothing(9, absent), one_point{1, 2, 3, 1, 2, 3, 1, 2, 3};
    // From ahead: the floor is a line for it.
    const gnomon::Light light = gnomon::Light::directional({0, 0, -1});
    for (const Floats& vertices : {flat, nothing, one_point}) {
        scene.triangles = gnomon::Triangles::upload(scene.device, vertices);
        const MapView view = fit(scene, light, settings).views.at(0);
        SCOPED_TRACE(vertices[3]);
        for (const float* row : {&view.row_u[0], &view.row_v[0], &view.row_w[0], &view.row_depth[0]})
            EXPECT_TRUE(are_finite(row, 4));
        for (const double x : {-0.9, 0.9})
            for (const double z : {1.5, 39.0})
                EXPECT_TRUE(is_inside(place(view, from_camera(scene, x, x, z)))) << x << " " << z;
    }
}

// The masks themselves: the same points, seen by a camera that creeps by fractions of a texel.
TEST(Partition, StabilisedMasksStayAsTheyAre) {
    const Scene scene;
    const auto points = gnomon::Points::upload(scene.device, scene.positions);
    const auto changes = [&](const char* form) {
        const auto technique = gnomon::make_technique("shadow-map", scene.device);
        for (const auto& [name, value] :
             Settings{{"size", "64"}, {"fit", form}, {"near", "1"}, {"far", "120"}, {"depth-range", "planes"}})
            technique->set(name, value);
        std::vector<float> before;
        std::size_t changed = 0;
        for (int step = 0; step < 8; ++step) {
            const float t = 0.04f * static_cast<float>(step);
            gnomon::Points moving = points;
            moving.set_camera(gnomon::Camera::look_at({t, 3, 30}, {2, 1 + t, 0}, {0, 1, 0}, 50), 96, 64);
            const gnomon::Visibility visibility(scene.device, points.count());
            technique->run(scene.triangles, moving, gnomon::Light::directional({0.5f, -1, 0.3f}), visibility);
            const std::vector<float> now = visibility.read();
            for (std::size_t i = 0; i < before.size(); ++i) changed += now[i] != before[i];
            before = now;
        }
        return changed;
    };
    EXPECT_EQ(changes("sphere"), 0u);
    EXPECT_EQ(changes("quantised"), 0u);
    EXPECT_GT(changes("frustum"), 5u) << "the test would not see swimming";
}

// Sums of nothing, minima and maxima alone: the same bits for every work-group size.
TEST(Partition, IsTheSameForEveryWorkGroupSize) {
    std::vector<Fitted> first;
    for (const std::uint32_t work_group_size : FEW_WORK_GROUP_SIZES) {
        Scene scene(device_with(work_group_size));
        std::vector<Fitted> all;
        for (const Settings& settings : {Settings{{"cascades", "4"}, {"share-texels", "on"}, {"projection", "lispsm"}},
                                         Settings{{"warp", "hybrid"}}})
            all.push_back(fit(scene, gnomon::Light::directional({0.5f, -1, 0.3f}), settings));
        for (std::size_t i = 0; i < first.size(); ++i) {
            ASSERT_EQ(all[i].views.size(), first[i].views.size());
            for (std::size_t v = 0; v < all[i].views.size(); ++v)
                EXPECT_EQ(std::memcmp(&all[i].views[v], &first[i].views[v], sizeof(MapView)), 0) << i << " " << v;
            const MapView& view = all[i].views[0];
            for (std::uint32_t k = 0; k < view.width + view.height; ++k)
                ASSERT_EQ(all[i].tables[view.centres_first + k], first[i].tables[view.centres_first + k]);
        }
        if (first.empty()) first = std::move(all);
    }
}

// ---- Projections ----------------------------------------------------------------------------------------------------

/// The camera's post-perspective place of p, for planes n and f.
Double3 post_perspective(const Scene& scene, const Double3& p, double n, double f) {
    const Double3 q = p - loaded(scene.camera.eye);
    const double z = dot(q, loaded(scene.camera.forward));
    return {dot(q, loaded(scene.camera.right)) / (z * scene.tangent_right()),
            dot(q, loaded(scene.camera.up)) / (z * scene.tangent_up()), (f + n) / (f - n) - 2 * f * n / ((f - n) * z)};
}

/// The world point at a post-perspective place.
Double3 from_post_perspective(const Scene& scene, const Double3& c, double n, double f) {
    return from_camera(scene, c[0], c[1], 2 * f * n / (f + n - c[2] * (f - n)));
}

const Settings whole_frustum{{"fit", "frustum"}, {"depth-range", "planes"}, {"near", "4"}, {"far", "100"}};

Settings whole_frustum_of(const char* projection) {
    Settings settings = whole_frustum;
    settings.emplace_back("projection", projection);
    return settings;
}

// With the light straight across the view its rays are parallel after the perspective too (at L.w = 0): the map is a
// parallel projection of the post-perspective cube, and keeps the middle of any two places in the middle.
TEST(Projection, PsmSeesThePostPerspectiveCubeInParallelIfTheLightIsAcross) {
    Scene scene;
    const Double3 up = loaded(scene.camera.up);
    const auto across = gnomon::Light::directional({float(-up[0]), float(-up[1]), float(-up[2])});
    const MapView view = fit(scene, across, whole_frustum_of("psm")).views.at(0);
    Random random(3);
    double spread = 0;
    for (int i = 0; i < 100; ++i) {
        Double3 a, b, middle;
        for (int c = 0; c < 3; ++c) {
            a[c] = random.between(-1, 1), b[c] = random.between(-1, 1);
            middle[c] = (a[c] + b[c]) / 2;
        }
        const SceneBox at_a = place(view, from_post_perspective(scene, a, 4, 100)),
                       at_b = place(view, from_post_perspective(scene, b, 4, 100)),
                       at_middle = place(view, from_post_perspective(scene, middle, 4, 100));
        EXPECT_NEAR(at_middle.u, (at_a.u + at_b.u) / 2, 1e-4);
        EXPECT_NEAR(at_middle.v, (at_a.v + at_b.v) / 2, 1e-4);
        spread = std::max({spread, std::fabs(at_a.u - at_b.u), std::fabs(at_a.v - at_b.v)});
    }
    EXPECT_GT(spread, 0.3) << "all points at one place would pass";
    // The world is not seen in parallel: that would pass as well.
    const SceneBox near_end = place(view, from_camera(scene, 0, 0, 5)),
                   far_end = place(view, from_camera(scene, 0, 0, 95)),
                   middle = place(view, from_camera(scene, 0, 0, 50));
    EXPECT_GT(std::hypot(middle.u - (near_end.u + far_end.u) / 2, middle.v - (near_end.v + far_end.v) / 2), 0.1);
}

/// Length along the view that a texel covers, over the depth there (that of a pixel), at a place on the view's axis.
double texel_per_pixel(const Scene& scene, const MapView& view, double z) {
    const auto v = [&](double depth) {
        const double at = place(view, from_camera(scene, 0, 0, depth)).v;
        return view.warp == WARP_LOGARITHMIC ? std::log1p(view.log_strength * at) / std::log1p(view.log_strength) : at;
    };
    const double step = 1e-3 * z;
    return 2 * step / (std::fabs(v(z + step) - v(z - step)) * z);
}

// Wimmer et al. 2004: n = z_n + sqrt(z_n z_f) makes the error at both ends the same, and smaller than any other does.
TEST(Projection, LispsmHasTheOptimalDistance) {
    // The light straight down on a camera that looks straight ahead; the floor and its posts are cut by the frustum, so
    // let a box around everything leave the whole of it.
    Scene scene(gnomon::Camera::look_at({0, 3, 30}, {0, 3, 0}, {0, 1, 0}, 40));
    Floats vertices = yard();
    add(vertices, {-300, -300, -300}, {300, 300, 300}, {301, 300, 300});
    scene.triangles = gnomon::Triangles::upload(scene.device, vertices);
    const double n = 4, f = 100;
    const MapView view = fit(scene, noon, whole_frustum_of("lispsm"), 4096).views.at(0);
    // w is 0 on the line y = y_c: find it on the view's axis (w is linear along it).
    const auto w = [&](double z) { return place(view, from_camera(scene, 0, 0, z)).w; };
    const double w_near = w(n), w_far = w(f), zero = n - w_near * (f - n) / (w_far - w_near);
    const double distance = n - zero, optimal = n + std::sqrt(n * f);
    EXPECT_NEAR(distance, optimal, 0.01 * optimal);
    EXPECT_NEAR(texel_per_pixel(scene, view, n * 1.01) / texel_per_pixel(scene, view, f * 0.99), 1, 0.02);
    // w^2 / z at both ends, the integral of 1 / w^2 being the map's height: the greater of the two, by distance.
    const auto error = [&](double d) {
        const double scale = 1 / d - 1 / (d + f - n);
        return scale * std::max(d * d / n, (d + f - n) * (d + f - n) / f);
    };
    for (const double factor : {0.5, 0.9, 1.1, 2.0}) EXPECT_GT(error(optimal * factor), error(distance));
}

// Lloyd et al. 2008: with the light across the view, a logarithmic map whose w is the depth has the same error
// everywhere. No linear map has: LiSPSM's varies by sqrt(f / n) / 2 and more.
TEST(Projection, LogpsmHasTheSameErrorEverywhereIfTheLightIsAcross) {
    Scene scene(gnomon::Camera::look_at({0, 3, 30}, {0, 3, 0}, {0, 1, 0}, 40));
    Floats vertices = yard();
    add(vertices, {-300, -300, -300}, {300, 300, 300}, {301, 300, 300});
    scene.triangles = gnomon::Triangles::upload(scene.device, vertices);
    const auto variation = [&](const char* projection) {
        const MapView view = fit(scene, noon, whole_frustum_of(projection), 4096).views.at(0);
        double least = 1e30, greatest = 0;
        for (double z = 4.1; z < 99; z *= 1.1) {
            const double error = texel_per_pixel(scene, view, z);
            least = std::min(least, error), greatest = std::max(greatest, error);
        }
        return greatest / least;
    };
    EXPECT_LT(variation("logpsm"), 1.05);
    EXPECT_GT(variation("lispsm"), 1.4);
    EXPECT_GT(variation("psm"), 10);
    EXPECT_GT(variation("uniform"), 20);
}

// Seen along the light the view has no direction, and all warps are the uniform map.
TEST(Projection, WarpsEndWhereTheLightIsAlongTheView) {
    Scene scene;
    const auto& d = scene.camera.forward;
    const auto along = gnomon::Light::directional({float(d[0]), float(d[1]), float(d[2])});
    const MapView uniform = fit(scene, along, {}).views.at(0);
    for (const char* projection : {"lispsm", "logpsm"}) {
        const MapView view = fit(scene, along, {{"projection", projection}}).views.at(0);
        EXPECT_EQ(std::memcmp(&view, &uniform, sizeof(view)), 0) << projection;
    }
}

// Points belong to the side their ray leaves through, found here by the ray itself; on a long side u is the picture's
// own coordinate of that place, and v its depth's logarithm.
TEST(Projection, FrustumSidesHoldTheRaysThatLeaveThroughThem) {
    Scene scene;
    const double n = 4, f = 100;
    for (const auto& [name, light] : lights()) {
        SCOPED_TRACE(name);
        Settings settings = whole_frustum_of("logpsm");
        settings.emplace_back("partition", "faces");
        const Fitted fitted = fit(scene, light, settings);
        Random random(7);
        for (int i = 0; i < 200; ++i) {
            const double z = random.between(4.1f, 99);
            const Double3 p = from_camera(scene, random.between(-1, 1) * 0.999, random.between(-1, 1) * 0.999, z);
            const Double3 away = -towards(light, p);
            // Values of the six planes at p and along the ray, in the order of the views.
            const auto planes = [&](const Double3& q) {
                const double x = dot(q, loaded(scene.camera.right)), y = dot(q, loaded(scene.camera.up)),
                             depth = dot(q, loaded(scene.camera.forward));
                const double s = depth * scene.tangent_right(), t = depth * scene.tangent_up();
                return std::array<double, 6>{x - s, -x - s, y - t, -y - t, depth, -depth};
            };
            const Double3 from_eye = p - loaded(scene.camera.eye);
            std::array<double, 6> at = planes(from_eye), along = planes(away);
            at[4] -= f, at[5] += n;
            int exit = -1;
            double reach = 1e30;
            for (int side = 0; side < 6; ++side)
                if (along[side] > 0 && -at[side] / along[side] < reach) reach = -at[side] / along[side], exit = side;
            const MapView& view = fitted.views[exit];
            if (view.width == 0) continue;  // no shading point needs that side
            const Double3 left_at = p + away * reach;
            const Double3 c = post_perspective(scene, left_at, n, f);
            if (std::max(std::fabs(c[0]), std::fabs(c[1])) > 1.0005) continue;
            const SceneBox found = place(view, p);
            EXPECT_TRUE(is_inside(found)) << exit << " " << found.u << " " << found.v;
            if (exit < 4) {
                EXPECT_NEAR(found.u, (c[1 - exit / 2] + 1) / 2, 2e-3);
                const double v = std::log1p(view.log_strength * found.v) / std::log1p(view.log_strength);
                const double depth = dot(loaded(scene.camera.forward), from_eye + away * reach);
                EXPECT_NEAR(v, std::log(f / depth) / std::log(f / n), 2e-3);
            }
            for (int side = 0; side < 6; ++side) {
                if (side == exit || fitted.views[side].width == 0) continue;
                const SceneBox other = place(fitted.views[side], p);
                const double rim = 2e-3;
                EXPECT_FALSE(other.u > rim && other.u < 1 - rim && other.v > rim && other.v < 1 - rim &&
                             other.depth > fitted.views[side].front_depth)
                    << "left through " << exit << ", held by " << side;
            }
        }
    }
}

// Thesis, eq. 6.2 and 6.3: what the slices of a logarithmic split look like under their own maps is the same for all.
TEST(Projection, SelfSimilarSlicesRepeatTheFirst) {
    Scene scene;
    for (const char* projection : {"uniform", "lispsm", "logpsm"}) {
        SCOPED_TRACE(projection);
        const Settings settings{
            {"projection", projection}, {"fit", "frustum"},       {"cascades", "3"}, {"near", "2"}, {"far", "128"},
            {"self-similar", "on"},     {"depth-range", "planes"}};
        const auto views = fit(scene, gnomon::Light::directional({-1, -1, 0.2f}), settings).views;
        for (const auto& [x, y] : {std::pair{0.5, -0.3}, {-0.9, 0.1}, {0.0, 0.0}})
            for (const double z : {2.1, 4.0, 7.5}) {
                const SceneBox first = place(views[0], from_camera(scene, x, y, z));
                for (int i = 1; i < 3; ++i) {
                    const SceneBox other = place(views[i], from_camera(scene, x, y, z * std::pow(4, i)));
                    EXPECT_NEAR(other.u, first.u, 2e-3);
                    EXPECT_NEAR(other.v, first.v, 2e-3);
                }
            }
    }
}

// Thesis 6.4: texels are shared out so that the largest error of a view is the same for all and along both axes.
TEST(Projection, SharedTexelsEvenTheErrorsOut) {
    Scene scene;
    for (const char* projection : {"uniform", "lispsm", "logpsm"}) {
        SCOPED_TRACE(projection);
        Settings settings{
            {"projection", projection}, {"cascades", "3"},         {"lambda", "1"},   {"near", "4"}, {"far", "100"},
            {"overlap", "0"},           {"depth-range", "planes"}, {"fit", "frustum"}};
        settings.emplace_back("self-similar", "on");  // views of whole slices, so that their corners are known here
        settings.emplace_back("share-texels", "on");
        const Fitted fitted = fit(scene, gnomon::Light::directional({-1, -1, 0.2f}), settings, 1024);
        std::vector<double> errors;
        double texels = 0;
        for (int i = 0; i < 3; ++i) {
            const MapView& view = fitted.views[i];
            texels += double(view.width) * view.height;
            double worst_u = 0, worst_v = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const double z = 4 * std::pow(25, (i + corner / 4) / 3.0);
                const Double3 p = from_camera(scene, corner % 2 * 2 - 1, corner / 2 % 2 * 2 - 1, z);
                const SceneBox at = place(view, p);
                const double k = view.log_strength;
                const double warp = view.warp == WARP_LOGARITHMIC ? k / ((1 + k * at.v) * std::log1p(k)) : 1;
                worst_u = std::max(worst_u, 1 / (slope(view, view.row_u, at.u, p) * view.width * z));
                worst_v = std::max(worst_v, 1 / (slope(view, view.row_v, at.v, p) * warp * view.height * z));
            }
            errors.push_back(worst_u);
            errors.push_back(worst_v);
        }
        EXPECT_NEAR(texels, 3 * 1024.0 * 1024, 0.01 * 3 * 1024 * 1024);
        const auto [least, greatest] = std::minmax_element(errors.begin(), errors.end());
        EXPECT_LT(*greatest / *least, 1.03);
    }
}

/// A place on a long side of the view frustum, `across` in [-1, 1] from its one edge to the other and `z` far away.
/// Sides as in frustum_side: right, left, up, down.
Double3 on_long_side(const Scene& scene, int side, double across, double z) {
    const double end = side % 2 == 0 ? 1 : -1;
    return side / 2 == 0 ? from_camera(scene, end, across, z) : from_camera(scene, across, end, z);
}

// Thesis 6.4: for a point light the error of a side is that of its place nearest to the light, and for one inside the
// view texels are measured along the side. The place is found by trying many, the texels' size by steps along the side.
TEST(Projection, PointLightsShareTexelsByTheNearestPlaces) {
    Scene scene;
    for (const auto& [is_inside_view, light] :
         {std::pair{true, gnomon::Light::point({3, 6, 4})}, {false, gnomon::Light::point({-40, 9, 10})}}) {
        SCOPED_TRACE(is_inside_view ? "inside the view" : "outside");
        Settings settings = whole_frustum_of("logpsm");
        settings.emplace_back("partition", "faces");
        settings.emplace_back("share-texels", "on");
        const Fitted fitted = fit(scene, light, settings, 1024);
        const Double3 at_light = loaded(light.xyzw.data());
        std::vector<double> errors;
        for (int side = 0; side < 4; ++side) {
            const MapView& view = fitted.views[side];
            if (view.width == 0) continue;
            double across = 0, z = 0, least = 1e30;
            for (int i = 0; i <= 1000; ++i)
                for (int k = 0; k <= 1000; ++k) {
                    const double x = 0.002 * i - 1, depth = 4 + 0.096 * k;
                    const double far = length(on_long_side(scene, side, x, depth) - at_light);
                    if (far < least) least = far, across = x, z = depth;
                }
            const Double3 p = on_long_side(scene, side, across, z);
            Double3 first = on_long_side(scene, side, across + 0.1, z) - p,
                    second = on_long_side(scene, side, across, z + 1) - p;
            gnomon::make_unit(first);
            second -= first * dot(first, second);
            gnomon::make_unit(second);
            const double k = view.log_strength, v = place(view, p).v;
            const double warp = view.warp == WARP_LOGARITHMIC ? k / ((1 + k * v) * std::log1p(k)) : 1;
            const auto steepness = [&](double SceneBox::*value) {
                const double step = 1e-3;
                const auto along = [&](const Double3& d) {
                    return (place(view, p + d * step).*value - place(view, p - d * step).*value) / (2 * step);
                };
                const double a = along(first), b = along(second), c = along(cross(first, second));
                return std::sqrt(a * a + b * b + (is_inside_view ? 0 : c * c));
            };
            errors.push_back(1 / (steepness(&SceneBox::u) * view.width * z));
            errors.push_back(1 / (steepness(&SceneBox::v) * warp * view.height * z));
        }
        ASSERT_GE(errors.size(), 4u) << "the test would compare nothing";
        const auto [lowest, greatest] = std::minmax_element(errors.begin(), errors.end());
        EXPECT_LT(*greatest / *lowest, 1.03);
    }
}

TEST(Projection, BadSettingsAreOneClearSentence) {
    gnomon::ViewFit stage;
    for (const auto& [name, value] : Settings{{"cascades", "0"},
                                              {"cascades", "9"},
                                              {"lambda", "1.5"},
                                              {"lambda", "nan"},
                                              {"projection", "tetrahedral"},
                                              {"far", "-1"},
                                              {"partition", ""}})
        EXPECT_THROW(stage.set(name, value), gnomon::InvalidArgument) << name << "=" << value;
    EXPECT_FALSE(stage.set("colour", "red"));
}

}  // namespace
