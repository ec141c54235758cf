// SPDX-License-Identifier: MIT
// The C interface beside the C++ library: the same bits and counts from every function, every status with its sentence,
// references of the caller's objects, and what a failed call leaves. (c_interface_in_c.c is the same from C.)
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <thread>

#include <gnomon.h>
#include <gnomon.hpp>
#include "support/cut_out_scenes.hpp"
#include "support/environment.hpp"
#include "support/scene_makers.hpp"

namespace {

using support::Environment;
using support::Floats;
using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

#define ASSERT_DONE(call) ASSERT_EQ(call, GNOMON_SUCCESS) << gnomon_last_error()
#define EXPECT_DONE(call) EXPECT_EQ(call, GNOMON_SUCCESS) << gnomon_last_error()

/// Frees what a C function made.
struct Destroy {
    void operator()(cl_mem m) const { clReleaseMemObject(m); }
    void operator()(gnomon_device* d) const { gnomon_device_destroy(d); }
    void operator()(gnomon_triangles* t) const { gnomon_triangles_destroy(t); }
    void operator()(gnomon_points* p) const { gnomon_points_destroy(p); }
    void operator()(gnomon_visibility* v) const { gnomon_visibility_destroy(v); }
    void operator()(gnomon_vertex_fans* f) const { gnomon_vertex_fans_destroy(f); }
    void operator()(gnomon_lights* l) const { gnomon_lights_destroy(l); }
    void operator()(gnomon_technique* t) const { gnomon_technique_destroy(t); }
    void operator()(gnomon_view* v) const { gnomon_view_destroy(v); }
    void operator()(gnomon_camera_pass* p) const { gnomon_camera_pass_destroy(p); }
    void operator()(const gnomon_statistics* s) const { gnomon_statistics_destroy(s); }
    void operator()(const gnomon_explanation* e) const { gnomon_explanation_destroy(e); }
    void operator()(const gnomon_view_of_parts* v) const { gnomon_view_of_parts_destroy(v); }
    void operator()(const gnomon_device_list* l) const { gnomon_device_list_destroy(l); }
    void operator()(const gnomon_technique_list* l) const { gnomon_technique_list_destroy(l); }
};
template <typename T>
using Owned = std::unique_ptr<T, Destroy>;

/// What a function writes through its last argument. A failure is the test's.
template <typename T, typename Call>
Owned<T> made(const Call& call) {
    T* result = nullptr;
    EXPECT_DONE(call(&result));
    return Owned<T>(result);
}

constexpr std::uint32_t width = 24, height = 16, pixels = width * height;
constexpr std::size_t points_count = 700;
const Floats vertices = support::soup(400, 0.5f, 3);
const std::size_t triangle_count = vertices.size() / 9;
const Floats positions = support::random_points(points_count, -1.5f, 1.5f, 4);
const gnomon::Float3 direction = {0.3f, -1, 0.2f}, lamp = {0.2f, 2, 0.1f}, eye = {0, 1, 4}, origin = {0, 0, 0},
                     up = {0, 1, 0};

std::vector<std::uint32_t> receivers() {
    std::vector<std::uint32_t> ids(points_count);
    for (std::size_t i = 0; i < points_count; ++i)
        ids[i] = i % 5 == 0 ? gnomon::no_receiver : std::uint32_t(i * 7 % triangle_count);
    return ids;
}

/// The same facing for C and for C++.
gnomon_run_options options_by(gnomon_facing_kind kind) {
    gnomon_run_options options = GNOMON_RUN_OPTIONS_INIT;
    options.facing.kind = kind;
    std::copy(eye.begin(), eye.end(), options.facing.eye);
    return options;
}
const gnomon_run_options by_eye = options_by(GNOMON_FACING_EYE);
const gnomon::RunOptions cpp_by_eye{.facing = gnomon::Facing::eye(eye)};

/// The scene twice: from C++ and from C, on two devices.
class BesideCpp : public testing::Test {
protected:
    void SetUp() override {
        device = made<gnomon_device>([](auto out) { return gnomon_device_open(nullptr, nullptr, out); });
        triangles = made<gnomon_triangles>(
            [&](auto out) { return gnomon_triangles_upload(device.get(), vertices.data(), triangle_count, out); });
        points = made<gnomon_points>([&](auto out) {
            return gnomon_points_upload(device.get(), positions.data(), points_count, receivers().data(), out);
        });
        EXPECT_DONE(gnomon_light_directional(direction.data(), &lights[0]));
        EXPECT_DONE(gnomon_light_point(lamp.data(), &lights[1]));
        EXPECT_DONE(gnomon_camera_look_at(eye.data(), origin.data(), up.data(), 40, &camera));
    }

    Owned<gnomon_technique> technique(const char* name) const {
        return made<gnomon_technique>([&](auto out) { return gnomon_technique_create(device.get(), name, out); });
    }
    Owned<gnomon_visibility> visibility(std::size_t count) const {
        return made<gnomon_visibility>([&](auto out) { return gnomon_visibility_create(device.get(), count, out); });
    }
    static Floats values(const gnomon_visibility* of) {
        std::size_t count = 0;
        EXPECT_DONE(gnomon_visibility_count(of, &count));
        Floats values(count, 42);
        EXPECT_DONE(gnomon_visibility_read(of, values.data()));
        return values;
    }
    Floats run(gnomon_technique* with, const gnomon_light& light) const {
        const auto result = visibility(points_count);
        EXPECT_DONE(
            gnomon_technique_run(with, triangles.get(), points.get(), light, result.get(), &by_eye, nullptr, nullptr));
        return values(result.get());
    }
    Floats cpp_run(const char* name, const gnomon::Light& light) const {
        const gnomon::Visibility result(cpp_device, points_count);
        gnomon::make_technique(name, cpp_device)->run(cpp_triangles, cpp_points, light, result, cpp_by_eye);
        return result.read();
    }

    Owned<gnomon_device> device;
    Owned<gnomon_triangles> triangles;
    Owned<gnomon_points> points;
    gnomon_light lights[2];
    gnomon_camera camera;
    gnomon::Device cpp_device;
    gnomon::Triangles cpp_triangles = gnomon::Triangles::upload(cpp_device, vertices);
    gnomon::Points cpp_points = gnomon::Points::upload(cpp_device, positions, receivers());
    const std::array<gnomon::Light, 2> cpp_lights = {gnomon::Light::directional(direction), gnomon::Light::point(lamp)};
    const gnomon::Camera cpp_camera = gnomon::Camera::look_at(eye, origin, up, 40);
};

// ---- The same answers -----------------------------------------------------------------------------------------------

// Not vacuous: both values are frequent.
TEST_F(BesideCpp, ShadowsOfBothKindsOfLight) {
    for (const char* name : {"frustum-traced", "izb", "shadow-map"})
        for (int i = 0; i < 2; ++i) {
            SCOPED_TRACE(name + std::string(i == 0 ? ", directional" : ", point light"));
            const auto with = technique(name);
            const Floats wanted = cpp_run(name, cpp_lights[i]);
            EXPECT_EQ(run(with.get(), lights[i]), wanted);
            EXPECT_GT(std::count(wanted.begin(), wanted.end(), 0.0f), 50);
            EXPECT_GT(std::count(wanted.begin(), wanted.end(), 1.0f), 50);
            EXPECT_DONE(gnomon_technique_prepare(with.get(), triangles.get(), lights[i], nullptr, nullptr));
            EXPECT_EQ(run(with.get(), lights[i]), wanted) << "prepared";
        }
}

TEST_F(BesideCpp, SettingsReceiversAndClusters) {
    const auto with = technique("shadow-map");
    EXPECT_DONE(gnomon_technique_set(with.get(), "size", "64"));
    const auto cpp_with = gnomon::make_technique("shadow-map", cpp_device);
    cpp_with->set("size", "64");
    const gnomon::Visibility wanted(cpp_device, points_count);
    cpp_with->run(cpp_triangles, cpp_points, cpp_lights[0], wanted, cpp_by_eye);
    EXPECT_EQ(run(with.get(), lights[0]), wanted.read());
    EXPECT_NE(wanted.read(), cpp_run("shadow-map", cpp_lights[0])) << "the setting has no effect";
    EXPECT_DONE(gnomon_triangles_keep_clusters(triangles.get(), nullptr));
    EXPECT_EQ(run(technique("frustum-traced").get(), lights[0]), cpp_run("frustum-traced", cpp_lights[0]));
    std::vector<std::uint32_t> ids(points_count);
    EXPECT_DONE(gnomon_points_read(points.get(), nullptr, ids.data()));
    EXPECT_EQ(ids, receivers());
}

TEST_F(BesideCpp, SeveralLightsAndTheirStatistics) {
    const auto first = visibility(points_count), second = visibility(points_count);
    const gnomon_light_visibility results[2] = {{lights[0], first.get()}, {lights[1], second.get()}};
    const gnomon_statistics* statistics[2];
    const auto with = technique("frustum-traced");
    ASSERT_DONE(gnomon_technique_run_each_light(with.get(), triangles.get(), points.get(), results, 2, &by_eye, nullptr,
                                                statistics));
    const gnomon::Visibility cpp_first(cpp_device, points_count), cpp_second(cpp_device, points_count);
    const auto wanted =
        gnomon::make_technique("frustum-traced", cpp_device)
            ->run_each_light(cpp_triangles, cpp_points, cpp_lights, std::array{cpp_first, cpp_second}, cpp_by_eye);
    EXPECT_EQ(values(first.get()), cpp_first.read());
    EXPECT_EQ(values(second.get()), cpp_second.read());
    EXPECT_NE(cpp_first.read(), cpp_second.read());
    for (int i = 0; i < 2; ++i) {
        const Owned<const gnomon_statistics> of(statistics[i]);
        ASSERT_EQ(of->count_count, wanted[i].counts.size());
        for (std::size_t k = 0; k < of->count_count; ++k) EXPECT_EQ(of->counts[k].name, wanted[i].counts[k].first);
        EXPECT_EQ(of->counts[0].value, wanted[i].counts[0].second);
        ASSERT_EQ(of->stage_count, wanted[i].stages.size());
        for (std::size_t k = 0; k < of->stage_count; ++k) {
            EXPECT_EQ(of->stages[k].name, wanted[i].stages[k].name);
            EXPECT_EQ(of->stages[k].skipped, wanted[i].stages[k].skipped);
        }
        EXPECT_GT(of->total_wall_ms, 0);
        EXPECT_GT(of->device_memory_bytes, 0u);
    }
}

// By an eye, by normals of the host and of a buffer, by winding and by fans. Not vacuous: each differs from no facing.
TEST_F(BesideCpp, EveryFacing) {
    const Floats normals = support::random_points(points_count, -1, 1, 9);
    const auto with = technique("frustum-traced");
    const auto vectors = made<gnomon_points>(
        [&](auto out) { return gnomon_points_upload(device.get(), normals.data(), points_count, nullptr, out); });
    gnomon_point_layout layout;
    gnomon_run_options by_normals = options_by(GNOMON_FACING_NORMALS), by_buffer = by_normals;
    by_normals.facing.normals = normals.data();
    ASSERT_DONE(gnomon_points_positions(vectors.get(), &by_buffer.facing.normals_buffer, &layout));
    by_buffer.facing.normals_layout = &layout;
    // All points are at the first triangle's first corner.
    Floats corners;
    for (std::size_t i = 0; i < points_count; ++i) support::append(corners, {vertices[0], vertices[1], vertices[2]});
    const auto cpp_corners = gnomon::Points::upload(cpp_device, corners);
    const auto cpp_fans = gnomon::VertexFans::find(cpp_device, vertices, corners);
    const auto at_corners = made<gnomon_points>(
        [&](auto out) { return gnomon_points_upload(device.get(), corners.data(), points_count, nullptr, out); });
    const auto fans = made<gnomon_vertex_fans>([&](auto out) {
        return gnomon_vertex_fans_find(device.get(), vertices.data(), triangle_count, corners.data(), points_count,
                                       out);
    });
    const gnomon::Float3 upwards{0, 1, 0}, downwards{0, -1, 0};
    gnomon_run_options by_fans = options_by(GNOMON_FACING_FANS);
    by_fans.facing.fans = fans.get();
    for (int i = 0; i < 2; ++i) {
        const auto c = [&](const gnomon_points* of, const gnomon_run_options* options) {
            const auto result = visibility(points_count);
            EXPECT_DONE(gnomon_technique_run(with.get(), triangles.get(), of, lights[i], result.get(), options, nullptr,
                                             nullptr));
            return values(result.get());
        };
        const auto cpp = [&](const gnomon::Points& of, const gnomon::Facing& facing) {
            const gnomon::Visibility result(cpp_device, points_count);
            gnomon::make_technique("frustum-traced", cpp_device)
                ->run(cpp_triangles, of, cpp_lights[i], result, {.facing = facing});
            return result.read();
        };
        const Floats none = cpp(cpp_points, gnomon::Facing::none());
        EXPECT_EQ(none, c(points.get(), nullptr)) << "points without a camera";
        const gnomon_run_options by_none = options_by(GNOMON_FACING_NONE),
                                 by_winding = options_by(GNOMON_FACING_WINDING);
        EXPECT_EQ(none, c(points.get(), &by_none));
        const auto differs = [&](const Floats& wanted, const gnomon_run_options& options) {
            EXPECT_NE(wanted, none);
            EXPECT_EQ(wanted, c(points.get(), &options));
        };
        differs(cpp(cpp_points, gnomon::Facing::eye(eye)), by_eye);
        differs(cpp(cpp_points, gnomon::Facing::normals(normals)), by_normals);
        differs(cpp(cpp_points, gnomon::Facing::normals(normals)), by_buffer);
        differs(cpp(cpp_points, gnomon::Facing::winding()), by_winding);
        for (const gnomon::Float3* way : {&upwards, &downwards}) {
            by_fans.facing.up = way->data();
            EXPECT_EQ(cpp(cpp_corners, gnomon::Facing::fans(cpp_fans, *way)), c(at_corners.get(), &by_fans));
            std::uint64_t extended = 99;
            EXPECT_DONE(gnomon_vertex_fans_extended(fans.get(), &extended));
            EXPECT_EQ(extended, cpp_fans.extended());
        }
    }
}

TEST_F(BesideCpp, ManyLightsInOneRun) {
    const auto with = technique("frustum-traced");
    const auto cpp_with = gnomon::make_technique("frustum-traced", cpp_device);
    const auto both = made<gnomon_lights>([&](auto out) {
        return gnomon_lights_create(lights, std::array{0.3f, -2.0f}.data(), 2, out);
    });
    const auto disk =
        made<gnomon_lights>([&](auto out) { return gnomon_lights_sun_disk(direction.data(), 20, 40, out); });
    const auto area = made<gnomon_lights>(
        [&](auto out) { return gnomon_lights_area(lamp.data(), up.data(), direction.data(), 5, out); });
    const auto sky =
        made<gnomon_lights>([&](auto out) { return gnomon_lights_sky(up.data(), direction.data(), 1, out); });
    const gnomon::Lights cpp_tables[] = {
        gnomon::Lights({cpp_lights[0], cpp_lights[1]}, {0.3f, -2.0f}), gnomon::sun_disk(direction, 20, 40),
        gnomon::area_light(lamp, up, direction, 5), gnomon::sky_patches(up, direction, 1)};
    const gnomon_lights* tables[] = {both.get(), disk.get(), area.get(), sky.get()};
    for (int i = 0; i < 4; ++i) {
        const gnomon::Lights& cpp = cpp_tables[i];
        std::size_t count = 0;
        ASSERT_DONE(gnomon_lights_count(tables[i], &count));
        ASSERT_EQ(count, cpp.count());
        std::vector<gnomon_light> copied(count);
        Floats weights(count);
        std::int32_t exponent = 0;
        double rounded = -1;
        EXPECT_DONE(gnomon_lights_read(tables[i], copied.data(), weights.data()));
        EXPECT_DONE(gnomon_lights_rounding(tables[i], &exponent, &rounded));
        EXPECT_EQ(weights, Floats(cpp.weights().begin(), cpp.weights().end()));
        EXPECT_EQ(std::memcmp(copied.data(), cpp.lights().data(), count * sizeof(gnomon_light)), 0);
        EXPECT_EQ(exponent, cpp.exponent());
        EXPECT_EQ(rounded, cpp.largest_rounding());
        const auto wanted = gnomon::run_light_table_to_host(*cpp_with, cpp_triangles, cpp_points, cpp,
                                                            {true, true, true, true, true}, cpp_by_eye);
        std::vector<std::uint32_t> bits(wanted.bits.size(), 7), counts(points_count, 7), first(points_count, 7),
            last(points_count, 7);
        std::vector<double> sums(points_count, 7);
        gnomon_light_table_arrays to = GNOMON_LIGHT_TABLE_ARRAYS_INIT;
        to.bits = bits.data(), to.counts = counts.data(), to.sums = sums.data();
        to.first_lit = first.data(), to.last_lit = last.data();
        const gnomon_statistics* statistics = nullptr;
        ASSERT_DONE(gnomon_technique_run_light_table_to_host(with.get(), triangles.get(), points.get(), tables[i], &to,
                                                             &by_eye, &statistics));
        gnomon_statistics_destroy(statistics);
        EXPECT_TRUE(bits == wanted.bits && counts == wanted.counts && sums == wanted.sums);
        EXPECT_TRUE(first == wanted.first_lit && last == wanted.last_lit);
        EXPECT_GT(std::ranges::count_if(counts, [](auto c) { return c != 0; }), 50);
        const auto mean = visibility(points_count);
        ASSERT_DONE(gnomon_technique_run_mean(with.get(), triangles.get(), points.get(), tables[i], mean.get(), &by_eye,
                                              nullptr, nullptr));
        for (std::size_t p = 0; p < points_count; ++p)
            ASSERT_EQ(values(mean.get())[p], float(double(counts[p]) / double(count))) << p;
    }
}

TEST_F(BesideCpp, ViewsPicturesAndSamples) {
    const auto view = made<gnomon_view>([&](auto out) {
        return gnomon_view_look(device.get(), triangles.get(), &camera, width, height, out, nullptr, nullptr);
    });
    const auto cpp_view = gnomon::look(cpp_device, cpp_triangles, cpp_camera, width, height);
    const auto wanted = cpp_view.read(cpp_device, cpp_triangles);
    Floats position(3 * pixels), normal(3 * pixels);
    std::vector<std::uint32_t> receiver(pixels);
    EXPECT_DONE(gnomon_view_read(view.get(), triangles.get(), position.data(), normal.data(), receiver.data()));
    EXPECT_EQ(position, wanted.position);
    EXPECT_EQ(normal, wanted.normal);
    EXPECT_EQ(receiver, wanted.receiver);

    const auto with = technique("frustum-traced");
    const auto mean = visibility(pixels);
    std::size_t seen = 0;
    const auto sink = [](const gnomon_points* of, void* sum) {
        std::size_t count = 0;
        EXPECT_DONE(gnomon_points_count(of, &count));
        *static_cast<std::size_t*>(sum) += count;
        return 0;
    };
    gnomon_samples_options options = GNOMON_SAMPLES_OPTIONS_INIT;
    options.sink = sink;
    options.user_data = &seen;
    EXPECT_DONE(gnomon_technique_run_samples(with.get(), triangles.get(), view.get(), lights[0], mean.get(), &options,
                                             nullptr, nullptr));
    EXPECT_EQ(seen, 4u * pixels);
    const gnomon::Visibility cpp_mean(cpp_device, pixels);
    gnomon::run_samples(*gnomon::make_technique("frustum-traced", cpp_device), cpp_triangles, cpp_view, cpp_lights[0],
                        4, cpp_mean);
    EXPECT_EQ(values(mean.get()), cpp_mean.read());

    const std::vector<std::uint32_t> material(triangle_count, 1);
    const Floats colors = {1, 0, 0, 0.25f, 0.5f, 0.75f};
    const gnomon_materials materials{sizeof(gnomon_materials), material.data(), material.size(), colors.data(), 2};
    const gnomon_light_visibility means[1] = {{lights[0], mean.get()}};
    std::vector<std::uint8_t> picture(4 * pixels);
    EXPECT_DONE(gnomon_view_shade(view.get(), triangles.get(), means, 1, &materials, picture.data()));
    EXPECT_EQ(picture, gnomon::shade(cpp_device, cpp_triangles, cpp_view, cpp_mean,
                                     {material, {{1, 0, 0}, {0.25f, 0.5f, 0.75f}}}, cpp_lights[0]));
}

TEST_F(BesideCpp, CameraPassLiftAndDiagnostics) {
    const auto pass = made<gnomon_camera_pass>([&](auto out) { return gnomon_camera_pass_create(device.get(), out); });
    const auto cpp_view = gnomon::look(cpp_device, cpp_triangles, cpp_camera, width, height);
    for (int picture = 0; picture < 2; ++picture) {
        const gnomon_statistics* statistics = nullptr;
        const auto view = made<gnomon_view>([&](auto out) {
            return gnomon_camera_pass_look(pass.get(), triangles.get(), &camera, width, height, out, nullptr,
                                           &statistics);
        });
        const Owned<const gnomon_statistics> of(statistics);
        EXPECT_EQ(of->stages[0].name, cpp_view.statistics.stages[0].name);
        const gnomon_points* seen = nullptr;
        ASSERT_DONE(gnomon_view_points(view.get(), &seen));
        Floats position(3 * pixels);
        EXPECT_DONE(gnomon_points_read(seen, position.data(), nullptr));
        const Floats wanted = cpp_view.points.read(cpp_device).position;
        EXPECT_EQ(0, std::memcmp(position.data(), wanted.data(), wanted.size() * sizeof(float)));

        std::vector<std::uint8_t> drawn(4 * pixels);
        const auto with = technique("shadow-map");
        EXPECT_DONE(
            gnomon_technique_diagnose(with.get(), "aliasing", triangles.get(), seen, lights[0], nullptr, drawn.data()));
        EXPECT_EQ(drawn, gnomon::make_technique("shadow-map", cpp_device)
                             ->diagnose("aliasing", cpp_triangles, cpp_view.points, cpp_lights[0]));
    }
    EXPECT_DONE(gnomon_points_set_camera(points.get(), &camera, width, height));
    const auto lifted = made<gnomon_points>(
        [&](auto out) { return gnomon_points_lift(points.get(), triangles.get(), eye.data(), out, nullptr); });
    Floats position(3 * points_count);
    EXPECT_DONE(gnomon_points_read(lifted.get(), position.data(), nullptr));
    EXPECT_EQ(position, lift(cpp_device, cpp_triangles, cpp_points, eye).read(cpp_device).position);
    EXPECT_NE(position, positions);
}

TEST_F(BesideCpp, ExplanationsAndParts) {
    std::size_t blocked = 0;
    for (const std::size_t index : {0u, 11u, 500u}) {
        const auto why = made<const gnomon_explanation>([&](auto out) {
            return gnomon_points_explain(points.get(), triangles.get(), index, lights[1], &by_eye, out);
        });
        const auto wanted =
            gnomon::explain(cpp_device, cpp_triangles, cpp_points, index, cpp_lights[1], cpp_by_eye.facing);
        EXPECT_EQ(why->receiver, wanted.receiver);
        EXPECT_EQ(why->stage, wanted.stage);
        EXPECT_EQ(why->arithmetic, wanted.arithmetic);
        EXPECT_EQ(why->on_receiver.light_side, wanted.on_receiver.light_side);
        EXPECT_EQ(why->is_backfacing, wanted.is_backfacing);
        EXPECT_EQ(why->near_miss_count, wanted.near_misses.size());
        ASSERT_EQ(why->occluder_count, wanted.occluders.size());
        for (std::size_t i = 0; i < why->occluder_count; ++i) {
            EXPECT_EQ(why->occluders[i].triangle, wanted.occluders[i].triangle);
            EXPECT_EQ(why->occluders[i].distance, wanted.occluders[i].distance);
            EXPECT_EQ(why->occluders[i].edges[2], wanted.occluders[i].edges[2]);
        }
        blocked += why->occluder_count;
    }
    EXPECT_GT(blocked, 0u);

    const gnomon_setting settings[] = {{"map-size", "64"}};
    const auto result = visibility(points_count);
    const gnomon_host_scene scene{sizeof(gnomon_host_scene), vertices.data(), triangle_count, nullptr};
    gnomon_host_scene_options options = GNOMON_HOST_SCENE_OPTIONS_INIT;
    options.settings = settings;
    options.setting_count = 1;
    options.run = &by_eye;
    EXPECT_DONE(gnomon_host_scene_run(device.get(), &scene, points.get(), lights[0], result.get(), &options, nullptr));
    EXPECT_EQ(values(result.get()), cpp_run("frustum-traced", cpp_lights[0]));

    const auto view = made<const gnomon_view_of_parts>(
        [&](auto out) { return gnomon_host_scene_look(device.get(), &scene, &camera, width, height, out); });
    std::vector<std::uint32_t> receiver(pixels);
    EXPECT_DONE(gnomon_view_read(view->view, view->triangles, nullptr, nullptr, receiver.data()));
    for (std::uint32_t& id : receiver)
        if (id != GNOMON_NO_RECEIVER) id = view->ids[id];
    const auto whole = gnomon::look(cpp_device, cpp_triangles, cpp_camera, width, height);
    EXPECT_EQ(receiver, whole.read(cpp_device, cpp_triangles).receiver);
}

TEST_F(BesideCpp, ListsOfDevicesAndTechniques) {
    const auto devices = made<const gnomon_device_list>(gnomon_devices_list);
    const auto wanted = gnomon::devices();
    ASSERT_EQ(devices->count, wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_EQ(devices->devices[i].device_id, wanted[i].device_id);
        EXPECT_EQ(devices->devices[i].name, wanted[i].name);
        EXPECT_EQ(devices->devices[i].why_default, wanted[i].why_default);
        EXPECT_EQ(devices->devices[i].global_memory_bytes, wanted[i].global_memory_bytes);
        EXPECT_EQ(devices->devices[i].has_fp64, wanted[i].has_fp64);
        EXPECT_EQ(devices->devices[i].is_default, wanted[i].is_default);
    }
    const auto list = made<const gnomon_technique_list>(gnomon_techniques_list);
    const auto all = gnomon::techniques();
    ASSERT_EQ(list->count, all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(list->techniques[i].name, all[i].name);
        EXPECT_EQ(list->techniques[i].summary, all[i].summary);
        EXPECT_EQ(list->techniques[i].exact, all[i].exact);
        ASSERT_EQ(list->techniques[i].setting_count, all[i].settings.size());
        for (std::size_t k = 0; k < all[i].settings.size(); ++k) {
            EXPECT_EQ(list->techniques[i].settings[k].name, all[i].settings[k].name);
            EXPECT_EQ(list->techniques[i].settings[k].default_value, all[i].settings[k].default_value);
            EXPECT_EQ(list->techniques[i].settings[k].meaning, all[i].settings[k].meaning);
        }
        ASSERT_EQ(list->techniques[i].diagnostic_count, all[i].diagnostics.size());
        for (std::size_t k = 0; k < all[i].diagnostics.size(); ++k)
            EXPECT_EQ(list->techniques[i].diagnostics[k].name, all[i].diagnostics[k].name);
    }
    const gnomon_device_description* open = nullptr;
    ASSERT_DONE(gnomon_device_describe(device.get(), &open));
    EXPECT_EQ(open->device_id, cpp_device.description().device_id);
    EXPECT_EQ(open->driver_version, cpp_device.description().driver_version);
}

// ---- The caller's own OpenCL objects --------------------------------------------------------------------------------

cl_uint references(cl_mem memory) {
    cl_uint count = 0;
    clGetMemObjectInfo(memory, CL_MEM_REFERENCE_COUNT, sizeof(count), &count, nullptr);
    return count;
}

TEST_F(BesideCpp, OwnBuffersWithOffsetsAreRetainedAndGivenBack) {
    const cl_context context = cpp_device.context();
    const cl_command_queue queue = cpp_device.queue();
    const auto own = made<gnomon_device>([&](auto out) { return gnomon_device_wrap(context, queue, nullptr, out); });
    cl_context kept = nullptr;
    cl_command_queue kept_queue = nullptr;
    EXPECT_DONE(gnomon_device_context(own.get(), &kept));
    EXPECT_DONE(gnomon_device_queue(own.get(), &kept_queue));
    EXPECT_EQ(kept, context);
    EXPECT_EQ(kept_queue, queue);

    constexpr std::size_t first = 5, answers_first = 1024;
    Floats all(first, 7);
    support::append(all, vertices);
    const std::size_t points_first = all.size();
    for (std::size_t c = 0; c < 3; ++c)  // a structure of arrays
        for (std::size_t i = 0; i < points_count; ++i) all.push_back(positions[3 * i + c]);
    cl_int code;
    const cl_mem inputs = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, all.size() * sizeof(float),
                                         all.data(), &code);
    Floats answers(answers_first + points_count + 3, 42);
    const cl_mem output = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
                                         answers.size() * sizeof(float), answers.data(), &code);
    const gnomon_point_layout layout{points_first, 1, points_count};
    auto t = made<gnomon_triangles>(
        [&](auto out) { return gnomon_triangles_wrap(own.get(), inputs, triangle_count, first, out); });
    auto p = made<gnomon_points>(
        [&](auto out) { return gnomon_points_wrap(own.get(), inputs, &layout, points_count, nullptr, out); });
    auto v = made<gnomon_visibility>(
        [&](auto out) { return gnomon_visibility_wrap(own.get(), output, points_count, answers_first, out); });
    EXPECT_EQ(references(inputs), 3u) << "the test's, the triangles' and the points'";
    std::size_t first_float = 0;
    cl_mem buffer = nullptr;
    EXPECT_DONE(gnomon_triangles_buffer(t.get(), &buffer, &first_float));
    EXPECT_EQ(buffer, inputs);
    EXPECT_EQ(first_float, first);

    cl_event event = nullptr;
    const auto with =
        made<gnomon_technique>([&](auto out) { return gnomon_technique_create(own.get(), "frustum-traced", out); });
    ASSERT_DONE(gnomon_technique_run(with.get(), t.get(), p.get(), lights[0], v.get(), &by_eye, &event, nullptr));
    cl_command_queue of_event = nullptr;
    EXPECT_EQ(clGetEventInfo(event, CL_EVENT_COMMAND_QUEUE, sizeof(of_event), &of_event, nullptr), CL_SUCCESS);
    EXPECT_EQ(of_event, queue);
    EXPECT_EQ(clWaitForEvents(1, &event), CL_SUCCESS);
    EXPECT_EQ(clReleaseEvent(event), CL_SUCCESS);
    clEnqueueReadBuffer(queue, output, CL_TRUE, 0, answers.size() * sizeof(float), answers.data(), 0, nullptr, nullptr);

    const gnomon::Points plain = gnomon::Points::upload(cpp_device, positions);
    const gnomon::Visibility wanted(cpp_device, points_count);
    gnomon::make_technique("frustum-traced", cpp_device)->run(cpp_triangles, plain, cpp_lights[0], wanted);
    Floats expected(answers_first, 42);
    support::append(expected, wanted.read());
    expected.resize(answers.size(), 42);
    EXPECT_EQ(answers, expected);
    t.reset();
    p.reset();
    v.reset();
    clFinish(queue);
    EXPECT_EQ(references(inputs), 1u);
    clReleaseMemObject(inputs);
    clReleaseMemObject(output);
}

// ---- Failures -------------------------------------------------------------------------------------------------------

/// The status is the wanted one, and the thread's sentence has these words.
AssertionResult fails(gnomon_status status, gnomon_status wanted, const std::vector<std::string>& words) {
    const std::string text = gnomon_last_error();
    if (status != wanted) return AssertionFailure() << gnomon_status_name(status) << ": " << text;
    if (text.empty()) return AssertionFailure() << "no text";
    for (const std::string& word : words)
        if (text.find(word) == std::string::npos) return AssertionFailure() << "no \"" << word << "\" in: " << text;
    return AssertionSuccess();
}

TEST_F(BesideCpp, EveryStatusWithItsSentence) {
    // Not null, so that a failed call must make them so.
    auto device_out = reinterpret_cast<gnomon_device*>(&lights);
    auto technique_out = reinterpret_cast<gnomon_technique*>(&lights);
    auto triangles_out = reinterpret_cast<gnomon_triangles*>(&lights);
    EXPECT_TRUE(fails(gnomon_technique_create(device.get(), "fristum", &technique_out), GNOMON_INVALID_ARGUMENT,
                      {"\"fristum\"", "frustum-traced"}));
    EXPECT_EQ(technique_out, nullptr);
    EXPECT_EQ(gnomon_last_opencl_error(), CL_SUCCESS);
    const auto with = technique("frustum-traced");
    EXPECT_TRUE(fails(gnomon_technique_set(with.get(), "map-size", "15"), GNOMON_INVALID_ARGUMENT, {"16 to 8192"}));
    EXPECT_TRUE(fails(gnomon_device_open("abacus", nullptr, &device_out), GNOMON_DEVICE_NOT_FOUND, {"\"abacus\""}));
    EXPECT_EQ(device_out, nullptr);

    gnomon_device_options options = GNOMON_DEVICE_OPTIONS_INIT;
    options.memory_limit_bytes = 64;
    const auto small = made<gnomon_device>([&](auto out) { return gnomon_device_open(nullptr, &options, out); });
    EXPECT_TRUE(fails(gnomon_triangles_upload(small.get(), vertices.data(), triangle_count, &triangles_out),
                      GNOMON_OUT_OF_DEVICE_MEMORY, {"limit of 64"}));
    EXPECT_EQ(gnomon_last_opencl_error(), CL_MEM_OBJECT_ALLOCATION_FAILURE);
    EXPECT_EQ(triangles_out, nullptr);

    {
        const Environment broken("GNOMON_BUILD_OPTIONS", "-no-such-option");
        EXPECT_TRUE(fails(gnomon_device_open(nullptr, nullptr, &device_out), GNOMON_OPENCL_ERROR, {"failed with CL_"}));
        EXPECT_NE(gnomon_last_opencl_error(), CL_SUCCESS);
    }
    {
        const Environment nowhere("GNOMON_KERNELS_DIR", "/no/such/folder");
        EXPECT_TRUE(fails(gnomon_device_open(nullptr, nullptr, &device_out), GNOMON_UNEXPECTED_ERROR, {"/no/such"}));
    }
    options = GNOMON_DEVICE_OPTIONS_INIT;
    options.struct_size = 8;
    EXPECT_TRUE(fails(gnomon_device_open(nullptr, &options, &device_out), GNOMON_INVALID_ARGUMENT, {"struct_size"}));
    EXPECT_EQ(device_out, nullptr);
    EXPECT_STREQ(gnomon_status_name(GNOMON_OUT_OF_HOST_MEMORY), "GNOMON_OUT_OF_HOST_MEMORY");
    EXPECT_STREQ(gnomon_status_name(static_cast<gnomon_status>(99)), "an unknown status");
}

// Each struct that begins with its size, with another size.
TEST_F(BesideCpp, StructsOfAnotherSizeAreRefused) {
    const auto with = technique("frustum-traced");
    const auto result = visibility(pixels);
    const auto view = made<gnomon_view>([&](auto out) {
        return gnomon_view_look(device.get(), triangles.get(), &camera, width, height, out, nullptr, nullptr);
    });
    const auto table = made<gnomon_lights>([&](auto out) { return gnomon_lights_create(lights, nullptr, 1, out); });
    gnomon_triangles* made_triangles = nullptr;
    const gnomon_view_of_parts* parts = nullptr;
    gnomon_run_options run = GNOMON_RUN_OPTIONS_INIT;
    gnomon_light_table_buffers buffers = GNOMON_LIGHT_TABLE_BUFFERS_INIT;
    gnomon_light_table_arrays arrays = GNOMON_LIGHT_TABLE_ARRAYS_INIT;
    gnomon_samples_options samples = GNOMON_SAMPLES_OPTIONS_INIT;
    gnomon_materials materials = GNOMON_MATERIALS_INIT;
    gnomon_cut_out_material material = GNOMON_CUT_OUT_MATERIAL_INIT;
    gnomon_cut_outs cut_outs = GNOMON_CUT_OUTS_INIT, with_material = GNOMON_CUT_OUTS_INIT;
    with_material.materials = &material;
    with_material.material_count = 1;
    gnomon_cut_out_buffers cut_out_buffers = GNOMON_CUT_OUT_BUFFERS_INIT;
    gnomon_host_scene scene = GNOMON_HOST_SCENE_INIT, no_triangles = GNOMON_HOST_SCENE_INIT;
    gnomon_host_scene_options scene_options = GNOMON_HOST_SCENE_OPTIONS_INIT;
    cl_mem buffer = nullptr;
    EXPECT_DONE(gnomon_triangles_buffer(triangles.get(), &buffer, nullptr));
    const auto t = triangles.get();
    const gnomon_points* seen = nullptr;
    EXPECT_DONE(gnomon_view_points(view.get(), &seen));
    const auto expect_refused = [](std::size_t& struct_size, const auto& call) {
        const std::size_t own = struct_size;
        EXPECT_DONE(call());
        for (const std::size_t size : {std::size_t{0}, own - 8, own + 8}) {
            struct_size = size;
            EXPECT_TRUE(fails(call(), GNOMON_INVALID_ARGUMENT,
                              {"struct_size is " + std::to_string(size), "library's is " + std::to_string(own)}));
        }
        struct_size = own;
    };
    expect_refused(run.struct_size, [&] {
        return gnomon_technique_run(with.get(), t, seen, lights[0], result.get(), &run, nullptr, nullptr);
    });
    expect_refused(buffers.struct_size, [&] {
        return gnomon_technique_run_light_table(with.get(), t, seen, table.get(), &buffers, nullptr, nullptr);
    });
    expect_refused(arrays.struct_size, [&] {
        return gnomon_technique_run_light_table_to_host(with.get(), t, seen, table.get(), &arrays, nullptr, nullptr);
    });
    expect_refused(samples.struct_size, [&] {
        return gnomon_technique_run_samples(with.get(), t, view.get(), lights[0], result.get(), &samples, nullptr,
                                            nullptr);
    });
    const std::vector<std::uint32_t> grey(triangle_count, 0);
    const Floats color(3, 0.5f);
    materials = {sizeof(materials), grey.data(), grey.size(), color.data(), 1};
    const gnomon_light_visibility lit{lights[0], result.get()};
    std::vector<std::uint8_t> picture(4 * pixels);
    expect_refused(materials.struct_size,
                   [&] { return gnomon_view_shade(view.get(), t, &lit, 1, &materials, picture.data()); });
    const auto upload = [&](const gnomon_cut_outs* of) {
        const gnomon_status status = gnomon_triangles_upload_cut_outs(device.get(), nullptr, 0, of, &made_triangles);
        gnomon_triangles_destroy(made_triangles);
        return status;
    };
    expect_refused(cut_outs.struct_size, [&] { return upload(&cut_outs); });
    expect_refused(material.struct_size, [&] { return upload(&with_material); });
    expect_refused(cut_out_buffers.struct_size, [&] {
        const gnomon_status status =
            gnomon_triangles_copy_cut_outs(device.get(), buffer, 0, 0, &cut_out_buffers, &made_triangles);
        gnomon_triangles_destroy(made_triangles);
        return status;
    });
    expect_refused(scene.struct_size, [&] {
        const gnomon_status status = gnomon_host_scene_look(device.get(), &scene, &camera, 4, 3, &parts);
        gnomon_view_of_parts_destroy(parts);
        return status;
    });
    expect_refused(scene_options.struct_size, [&] {
        return gnomon_host_scene_run(device.get(), &no_triangles, seen, lights[0], result.get(), &scene_options,
                                     nullptr);
    });
    gnomon_device_options device_options = GNOMON_DEVICE_OPTIONS_INIT;
    expect_refused(device_options.struct_size, [&] {
        gnomon_device* opened = nullptr;
        const gnomon_status status = gnomon_device_open(nullptr, &device_options, &opened);
        gnomon_device_destroy(opened);
        return status;
    });
}

// A sink is the caller's code: it stops the run by a number, and an exception of C++ goes no further than gnomon.
TEST_F(BesideCpp, ManyLightsWithNormalsBuffersAndProgress) {
    const auto with = technique("frustum-traced");
    const auto sky =
        made<gnomon_lights>([&](auto out) { return gnomon_lights_sky(up.data(), direction.data(), 1, out); });
    const Floats normals = support::random_points(points_count, -1, 1, 9);
    const auto upload = [&](const Floats& from) {
        return made<gnomon_points>(
            [&](auto out) { return gnomon_points_upload(device.get(), from.data(), points_count, nullptr, out); });
    };
    const auto bare = upload(positions), vectors = upload(normals);
    gnomon_run_options options = options_by(GNOMON_FACING_NORMALS);
    gnomon_point_layout layout;
    EXPECT_DONE(gnomon_points_positions(vectors.get(), &options.facing.normals_buffer, &layout));
    options.facing.normals_layout = &layout;
    std::vector<double> done_parts;
    options.user_data = &done_parts;
    options.progress = [](double done, void* user_data) {
        static_cast<std::vector<double>*>(user_data)->push_back(done);
        return 0;
    };
    const auto output = visibility(2 * points_count);  // as many bytes as doubles for all points
    gnomon_light_table_buffers to = GNOMON_LIGHT_TABLE_BUFFERS_INIT;
    to.cosines = true;
    EXPECT_DONE(gnomon_visibility_buffer(output.get(), &to.sums));
    const auto run = [&] {
        return gnomon_technique_run_light_table(with.get(), triangles.get(), bare.get(), sky.get(), &to, &options,
                                                nullptr);
    };
    ASSERT_DONE(run());
    ASSERT_FALSE(done_parts.empty());
    EXPECT_EQ(done_parts.back(), 1);
    const auto cpp_bare = gnomon::Points::upload(cpp_device, positions);
    const auto cpp_normals = gnomon::Points::upload(cpp_device, normals);
    const auto wanted =
        gnomon::run_light_table_to_host(*gnomon::make_technique("frustum-traced", cpp_device), cpp_triangles, cpp_bare,
                                        gnomon::sky_patches(up, direction, 1), {.sums = true, .cosines = true},
                                        {.facing = gnomon::Facing::normals(cpp_normals.positions())});
    const Floats words = values(output.get());
    EXPECT_EQ(std::memcmp(words.data(), wanted.sums.data(), points_count * sizeof(double)), 0);

    options.progress = [](double, void*) { return 1; };
    EXPECT_TRUE(fails(run(), GNOMON_STOPPED, {"progress function stopped"}));
    options.progress = nullptr;
    options.facing.kind = GNOMON_FACING_WINDING;
    EXPECT_TRUE(fails(run(), GNOMON_INVALID_ARGUMENT, {"cosines", "normals"}));
    options.facing.kind = 6;
    EXPECT_TRUE(fails(run(), GNOMON_INVALID_ARGUMENT, {"facing.kind", "6"}));
    options.facing.kind = GNOMON_FACING_NORMALS;
    to.counts = options.facing.normals_buffer;
    EXPECT_TRUE(fails(run(), GNOMON_INVALID_ARGUMENT, {"counts", "overlaps", "normals"}));
    to.counts = to.sums;
    EXPECT_TRUE(fails(run(), GNOMON_INVALID_ARGUMENT, {"overlaps that of counts"}));
    EXPECT_DONE(gnomon_points_positions(bare.get(), &to.counts, &layout));
    EXPECT_TRUE(fails(run(), GNOMON_INVALID_ARGUMENT, {"counts", "overlaps", "positions"}));
    gnomon_lights* none = sky.get();
    EXPECT_TRUE(fails(gnomon_lights_create(lights, std::array{1.0f, NAN}.data(), 2, &none), GNOMON_INVALID_ARGUMENT,
                      {"weight", "1"}));
    EXPECT_EQ(none, nullptr);
}

TEST_F(BesideCpp, SinksThatStopOrThrow) {
    const auto view = made<gnomon_view>([&](auto out) {
        return gnomon_view_look(device.get(), triangles.get(), &camera, width, height, out, nullptr, nullptr);
    });
    const auto with = technique("frustum-traced");
    const auto mean = visibility(pixels);
    const auto sampled = [&](gnomon_sample_sink sink, cl_event* event, const gnomon_statistics** statistics) {
        gnomon_samples_options options = GNOMON_SAMPLES_OPTIONS_INIT;
        options.sink = sink;
        return gnomon_technique_run_samples(with.get(), triangles.get(), view.get(), lights[0], mean.get(), &options,
                                            event, statistics);
    };
    cl_event event = reinterpret_cast<cl_event>(&event);
    auto statistics = reinterpret_cast<const gnomon_statistics*>(&event);
    EXPECT_TRUE(fails(sampled([](auto, auto) { return 1; }, &event, &statistics), GNOMON_STOPPED, {"stopped"}));
    EXPECT_EQ(event, nullptr);
    EXPECT_EQ(statistics, nullptr);
    EXPECT_TRUE(fails(sampled([](auto, auto) -> int { throw std::bad_alloc(); }, nullptr, nullptr),
                      GNOMON_OUT_OF_HOST_MEMORY, {"memory"}));
    EXPECT_TRUE(
        fails(sampled([](auto, auto) -> int { throw 7; }, nullptr, nullptr), GNOMON_UNEXPECTED_ERROR, {"exception"}));
    EXPECT_DONE(sampled(nullptr, nullptr, nullptr));
    const gnomon::Visibility cpp_mean(cpp_device, pixels);
    gnomon::run_samples(*gnomon::make_technique("frustum-traced", cpp_device), cpp_triangles,
                        gnomon::look(cpp_device, cpp_triangles, cpp_camera, width, height), cpp_lights[0], 4, cpp_mean);
    EXPECT_EQ(values(mean.get()), cpp_mean.read()) << "after the failures";
}

TEST_F(BesideCpp, EachThreadHasItsOwnSentence) {
    gnomon_light light;
    const float zero[3] = {0, 0, 0};
    EXPECT_TRUE(fails(gnomon_light_directional(zero, &light), GNOMON_INVALID_ARGUMENT, {"0,0,0"}));
    std::string before, after;
    std::thread([&] {
        before = gnomon_last_error();
        EXPECT_EQ(gnomon_light_directional(nullptr, &light), GNOMON_INVALID_ARGUMENT);
        after = gnomon_last_error();
    }).join();
    EXPECT_EQ(before, "");
    EXPECT_EQ(after, "the argument direction must not be null");
    EXPECT_NE(std::string(gnomon_last_error()).find("0,0,0"), std::string::npos);
    EXPECT_DONE(gnomon_light_directional(direction.data(), &light));
    EXPECT_STRNE(gnomon_last_error(), "") << "a success keeps the last failure";
}

// Each thread opens a device of its own and casts shadows, while the others do.
TEST_F(BesideCpp, ThreadsWithADeviceEach) {
    const Floats wanted[2] = {cpp_run("frustum-traced", cpp_lights[0]), cpp_run("frustum-traced", cpp_lights[1])};
    const auto work = [&](int which) {
        const auto own = made<gnomon_device>([](auto out) { return gnomon_device_open(nullptr, nullptr, out); });
        const auto t = made<gnomon_triangles>(
            [&](auto out) { return gnomon_triangles_upload(own.get(), vertices.data(), triangle_count, out); });
        const auto p = made<gnomon_points>([&](auto out) {
            return gnomon_points_upload(own.get(), positions.data(), points_count, receivers().data(), out);
        });
        const auto v =
            made<gnomon_visibility>([&](auto out) { return gnomon_visibility_create(own.get(), points_count, out); });
        const auto with =
            made<gnomon_technique>([&](auto out) { return gnomon_technique_create(own.get(), "frustum-traced", out); });
        for (int repeat = 0; repeat < 5; ++repeat) {
            EXPECT_DONE(
                gnomon_technique_run(with.get(), t.get(), p.get(), lights[which], v.get(), &by_eye, nullptr, nullptr));
            EXPECT_EQ(values(v.get()), wanted[which]);
        }
    };
    std::thread others[] = {std::thread(work, 0), std::thread(work, 1), std::thread(work, 0)};
    for (std::thread& other : others) other.join();
}

TEST_F(BesideCpp, WrongSizesOffsetsAndBuffers) {
    gnomon_triangles* t = nullptr;
    gnomon_points* p = nullptr;
    gnomon_visibility* v = nullptr;
    gnomon_cut_out_material material = GNOMON_CUT_OUT_MATERIAL_INIT;
    material.wrap_v = 3;
    gnomon_cut_outs cut_outs = GNOMON_CUT_OUTS_INIT;
    cut_outs.materials = &material;
    cut_outs.material_count = 1;
    EXPECT_TRUE(fails(gnomon_triangles_upload_cut_outs(device.get(), nullptr, 0, &cut_outs, &t),
                      GNOMON_INVALID_ARGUMENT, {"materials[0]", "wrap"}));
    constexpr std::size_t huge = std::numeric_limits<std::size_t>::max();
    constexpr auto invalid = GNOMON_INVALID_ARGUMENT;
    const gnomon_device* on = device.get();
    EXPECT_TRUE(
        fails(gnomon_triangles_upload(on, vertices.data(), huge / 9 + 2, &t), invalid, {"vertices", "32 bits"}));
    EXPECT_TRUE(fails(gnomon_points_upload(on, positions.data(), huge, nullptr, &p), invalid, {"positions"}));
    cl_mem buffer = nullptr;
    EXPECT_DONE(gnomon_points_positions(points.get(), &buffer, nullptr));
    EXPECT_TRUE(fails(gnomon_triangles_wrap(on, buffer, points_count / 3, 4, &t), invalid, {"triangle buffer holds"}));
    EXPECT_TRUE(fails(gnomon_visibility_wrap(on, buffer, 3, 1, &v), invalid, {"first float 1", "multiple of"}));
    EXPECT_TRUE(fails(gnomon_visibility_wrap(on, buffer, huge, 1024, &v), invalid, {"visibility buffer holds"}));
    const gnomon_point_layout wide{0, huge, 1};
    EXPECT_TRUE(fails(gnomon_points_wrap(on, buffer, &wide, 1, nullptr, &p), invalid, {"32 bits"}));
    buffer = nullptr;
    EXPECT_DONE(gnomon_triangles_buffer(triangles.get(), &buffer, nullptr));
    Owned<gnomon_visibility> inside =
        made<gnomon_visibility>([&](auto out) { return gnomon_visibility_wrap(on, buffer, points_count, 1024, out); });
    EXPECT_TRUE(fails(gnomon_technique_run(technique("frustum-traced").get(), triangles.get(), points.get(), lights[0],
                                           inside.get(), &by_eye, nullptr, nullptr),
                      invalid, {"overlaps the triangles"}));
    const gnomon_light_visibility twice[2] = {{lights[0], inside.get()}, {lights[1], inside.get()}};
    const auto not_null = reinterpret_cast<const gnomon_statistics*>(&lights);
    const gnomon_statistics* statistics[2] = {not_null, not_null};
    EXPECT_EQ(gnomon_technique_run_each_light(technique("frustum-traced").get(), triangles.get(), points.get(), twice,
                                              2, nullptr, nullptr, statistics),
              invalid);
    EXPECT_EQ(statistics[0], nullptr);
    EXPECT_EQ(statistics[1], nullptr);
    EXPECT_EQ(t, nullptr);
    EXPECT_EQ(p, nullptr);
    EXPECT_EQ(v, nullptr);
}

TEST_F(BesideCpp, SharedMemory) {
    EXPECT_TRUE(fails(gnomon_visibility_fetch(visibility(1).get()), GNOMON_INVALID_ARGUMENT, {"share"}));
    triangles = made<gnomon_triangles>(
        [&](auto out) { return gnomon_triangles_share(device.get(), vertices.data(), triangle_count, out); });
    const auto ids = receivers();
    points = made<gnomon_points>(
        [&](auto out) { return gnomon_points_share(device.get(), positions.data(), points_count, ids.data(), out); });
    Floats values(points_count, 42);
    const auto result = made<gnomon_visibility>(
        [&](auto out) { return gnomon_visibility_share(device.get(), values.data(), points_count, out); });
    for (int i = 0; i < 2; ++i) {
        EXPECT_DONE(gnomon_technique_run(technique("frustum-traced").get(), triangles.get(), points.get(), lights[i],
                                         result.get(), &by_eye, nullptr, nullptr));
        EXPECT_DONE(gnomon_visibility_fetch(result.get()));
        EXPECT_EQ(values, cpp_run("frustum-traced", cpp_lights[i]));
        EXPECT_EQ(BesideCpp::values(result.get()), values);
    }
}

/// A buffer of the device with these values.
template <typename Value>
Owned<std::remove_pointer_t<cl_mem>> buffer_of(cl_context context, const std::vector<Value>& values) {
    return Owned<std::remove_pointer_t<cl_mem>>(clCreateBuffer(context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                                                               values.size() * sizeof(Value),
                                                               const_cast<Value*>(values.data()), nullptr));
}

// From arrays, from buffers and in parts, for shadows and a view.
TEST_F(BesideCpp, CutOuts) {
    const support::CutOutData data(support::mixed_masks(triangle_count, 5, true));
    const gnomon::CutOuts& wanted = data.cut_outs();
    std::vector<gnomon_cut_out_material> materials;
    for (const gnomon::CutOutMaterial& m : wanted.materials)
        materials.push_back({sizeof(gnomon_cut_out_material), m.texture, gnomon_texture_wrap(m.wrap_u),
                             gnomon_texture_wrap(m.wrap_v), gnomon_texture_filter(m.filter), m.cutoff, m.alpha_factor});
    std::vector<gnomon_alpha_texture> textures;
    for (const gnomon::AlphaTexture& texture : wanted.textures)
        textures.push_back({texture.width, texture.height, texture.alpha.data()});
    const gnomon_cut_outs arrays{sizeof(gnomon_cut_outs),
                                 wanted.material_of_triangle.data(),
                                 wanted.texture_coordinates.data(),
                                 wanted.corner_alphas.data(),
                                 materials.data(),
                                 materials.size(),
                                 textures.data(),
                                 textures.size()};
    cpp_triangles = gnomon::Triangles::upload(cpp_device, vertices, wanted);
    const Floats lit = cpp_run("frustum-traced", cpp_lights[0]);
    EXPECT_NE(lit, run(technique("frustum-traced").get(), lights[0])) << "the masks must matter";

    triangles = made<gnomon_triangles>([&](auto out) {
        return gnomon_triangles_upload_cut_outs(device.get(), vertices.data(), triangle_count, &arrays, out);
    });
    EXPECT_EQ(run(technique("frustum-traced").get(), lights[0]), lit);
    gnomon_cut_out_counts counts;
    EXPECT_DONE(gnomon_triangles_cut_out_counts(triangles.get(), &counts));
    const gnomon::CutOutCounts cpp_counts = cpp_triangles.cut_out_counts();
    EXPECT_EQ(std::tie(counts.masked, counts.opaque, counts.clear, counts.unusable),
              std::tie(cpp_counts.masked, cpp_counts.opaque, cpp_counts.clear, cpp_counts.unusable));

    const auto parts = visibility(points_count);
    const gnomon_host_scene scene{sizeof(gnomon_host_scene), vertices.data(), triangle_count, &arrays};
    gnomon_host_scene_options options = GNOMON_HOST_SCENE_OPTIONS_INIT;
    options.run = &by_eye;
    EXPECT_DONE(gnomon_host_scene_run(device.get(), &scene, points.get(), lights[0], parts.get(), &options, nullptr));
    EXPECT_EQ(values(parts.get()), lit);
    const auto view = made<const gnomon_view_of_parts>(
        [&](auto out) { return gnomon_host_scene_look(device.get(), &scene, &camera, width, height, out); });
    std::vector<std::uint32_t> receiver(pixels);
    EXPECT_DONE(gnomon_view_read(view->view, view->triangles, nullptr, nullptr, receiver.data()));
    const auto seen = gnomon::look(cpp_device, cpp_triangles, cpp_camera, width, height);
    EXPECT_EQ(receiver, seen.read(cpp_device, cpp_triangles).receiver);

    cl_context context;
    EXPECT_DONE(gnomon_device_context(device.get(), &context));
    const auto copy = [](auto span) { return std::vector(span.begin(), span.end()); };
    Floats behind_three(3, 0.0f);
    behind_three.insert(behind_three.end(), vertices.begin(), vertices.end());
    const auto vertex_buffer = buffer_of(context, behind_three);
    const auto ids = buffer_of(context, copy(wanted.material_of_triangle));
    const auto coordinates = buffer_of(context, copy(wanted.texture_coordinates));
    const auto alphas = buffer_of(context, copy(wanted.corner_alphas));
    std::vector<Owned<std::remove_pointer_t<cl_mem>>> texels;
    std::vector<gnomon_alpha_texture_buffer> texture_buffers;
    for (const gnomon::AlphaTexture& texture : wanted.textures) {
        texels.push_back(buffer_of(context, copy(texture.alpha)));
        texture_buffers.push_back({texture.width, texture.height, texels.back().get()});
    }
    gnomon_cut_out_buffers buffers{sizeof(gnomon_cut_out_buffers),
                                   ids.get(),
                                   coordinates.get(),
                                   alphas.get(),
                                   materials.data(),
                                   materials.size(),
                                   texture_buffers.data(),
                                   texture_buffers.size()};
    const auto copied = [&](gnomon_triangles** out) {
        return gnomon_triangles_copy_cut_outs(device.get(), vertex_buffer.get(), triangle_count, 3, &buffers, out);
    };
    triangles = made<gnomon_triangles>(copied);
    EXPECT_EQ(run(technique("frustum-traced").get(), lights[0]), lit);
    std::size_t clear_hits = 0;
    for (std::size_t i = 0; i < points_count; i += points_count / 16) {
        const auto why = made<const gnomon_explanation>(
            [&](auto out) { return gnomon_points_explain(points.get(), triangles.get(), i, lights[0], &by_eye, out); });
        const auto expected =
            gnomon::explain(cpp_device, cpp_triangles, cpp_points, i, cpp_lights[0], cpp_by_eye.facing);
        ASSERT_EQ(why->clear_hit_count, expected.clear_hits.size());
        for (std::size_t k = 0; k < why->clear_hit_count; ++k) {
            EXPECT_EQ(why->clear_hits[k].triangle, expected.clear_hits[k].triangle);
            EXPECT_TRUE(why->clear_hits[k].is_clear && !why->clear_hits[k].blocks);
        }
        clear_hits += why->clear_hit_count;
    }
    EXPECT_GT(clear_hits, 0u);
    gnomon_triangles* refused = nullptr;
    texture_buffers[0].width = 8;
    EXPECT_TRUE(fails(copied(&refused), GNOMON_INVALID_ARGUMENT, {"texture buffer holds 35 bytes", "40"}));
    texture_buffers[0].width = 7;
    std::swap(buffers.texture_coordinates, buffers.corner_alphas);
    EXPECT_TRUE(fails(copied(&refused), GNOMON_INVALID_ARGUMENT, {"texture coordinate buffer holds"}));
    EXPECT_EQ(refused, nullptr);
}

// Every function, with a null for each of its arguments that must not be null, one at a time.
TEST_F(BesideCpp, NullArgumentsAreNamed) {
    const gnomon_device* const d = device.get();
    gnomon_triangles* const t = triangles.get();
    gnomon_points* const p = points.get();
    const auto with = technique("frustum-traced");
    gnomon_technique* const k = with.get();
    const auto result = visibility(points_count);
    const gnomon_visibility* const v = result.get();
    const auto seen = made<gnomon_view>(
        [&](auto out) { return gnomon_view_look(d, t, &camera, width, height, out, nullptr, nullptr); });
    const gnomon_view* const w = seen.get();
    const auto camera_pass = made<gnomon_camera_pass>([&](auto out) { return gnomon_camera_pass_create(d, out); });
    gnomon_camera_pass* const pass = camera_pass.get();
    const float* const xyz = eye.data();
    const gnomon_light sun = lights[0];
    gnomon_light light;
    gnomon_camera c;
    float floats[3];
    std::uint8_t bytes[4];
    gnomon_triangles* triangles_out;
    gnomon_points* points_out;
    gnomon_visibility* visibility_out;
    gnomon_technique* technique_out;
    gnomon_view* view_out;
    gnomon_vertex_fans* fans_out;
    const std::uint32_t* ids_out;
    std::size_t count_out;
    const auto fans = made<gnomon_vertex_fans>(
        [&](auto out) { return gnomon_vertex_fans_find(d, vertices.data(), 1, vertices.data(), 1, out); });
    gnomon_lights* lights_out;
    const auto table = made<gnomon_lights>([&](auto out) { return gnomon_lights_create(&sun, nullptr, 1, out); });
    const gnomon_light_table_buffers buffers = GNOMON_LIGHT_TABLE_BUFFERS_INIT;
    const gnomon_explanation* why;
    const gnomon_view_of_parts* parts;
    const gnomon_light_visibility one{sun, v}, no_visibility{sun, nullptr};
    const gnomon_materials no_ids{sizeof(gnomon_materials), nullptr, 2, floats, 1};
    const gnomon_host_scene empty = GNOMON_HOST_SCENE_INIT, no_vertices{sizeof(gnomon_host_scene), nullptr, 1, nullptr};
    const gnomon_run_options no_normals = options_by(GNOMON_FACING_NORMALS), no_fans = options_by(GNOMON_FACING_FANS);
    gnomon_host_scene_options parts_options = GNOMON_HOST_SCENE_OPTIONS_INIT;
    const gnomon_setting bad_setting{"map-size", nullptr};
    parts_options.settings = &bad_setting;
    parts_options.setting_count = 1;
    const gnomon_cut_outs no_cut_outs = GNOMON_CUT_OUTS_INIT;
    gnomon_cut_outs without_materials = no_cut_outs, without_alpha = no_cut_outs;
    const gnomon_alpha_texture no_alpha{1, 1, nullptr};
    without_materials.material_count = without_alpha.texture_count = 1;
    without_alpha.textures = &no_alpha;
    const gnomon_cut_out_buffers no_buffers = GNOMON_CUT_OUT_BUFFERS_INIT;
    gnomon_cut_out_counts cut_out_counts;
    cl_mem vertex_buffer;
    EXPECT_DONE(gnomon_triangles_buffer(t, &vertex_buffer, nullptr));
    const struct {
        gnomon_status status;
        const char* argument;
        std::string text;
    } refused[] = {
#define REFUSES(argument, call) {call, argument, gnomon_last_error()}
        REFUSES("direction", gnomon_light_directional(nullptr, &light)),
        REFUSES("light_out", gnomon_light_directional(xyz, nullptr)),
        REFUSES("position", gnomon_light_point(nullptr, &light)),
        REFUSES("light_out", gnomon_light_point(xyz, nullptr)),
        REFUSES("eye", gnomon_camera_look_at(nullptr, xyz, xyz, 40, &c)),
        REFUSES("target", gnomon_camera_look_at(xyz, nullptr, xyz, 40, &c)),
        REFUSES("up", gnomon_camera_look_at(xyz, xyz, nullptr, 40, &c)),
        REFUSES("camera_out", gnomon_camera_look_at(xyz, origin.data(), up.data(), 40, nullptr)),
        REFUSES("list_out", gnomon_devices_list(nullptr)),
        REFUSES("list_out", gnomon_techniques_list(nullptr)),
        REFUSES("device_out", gnomon_device_open(nullptr, nullptr, nullptr)),
        REFUSES("device_out", gnomon_device_wrap(cpp_device.context(), cpp_device.queue(), nullptr, nullptr)),
        REFUSES("device", gnomon_device_memory(nullptr, nullptr, nullptr)),
        REFUSES("builds_out", gnomon_device_kernel_builds(d, nullptr)),
        REFUSES("description_out", gnomon_device_describe(d, nullptr)),
        REFUSES("context_out", gnomon_device_context(d, nullptr)),
        REFUSES("queue_out", gnomon_device_queue(d, nullptr)),
        REFUSES("device", gnomon_triangles_upload(nullptr, xyz, 0, &triangles_out)),
        REFUSES("vertices", gnomon_triangles_upload(d, nullptr, 1, &triangles_out)),
        REFUSES("triangles_out", gnomon_triangles_upload(d, xyz, 0, nullptr)),
        REFUSES("device", gnomon_triangles_upload_cut_outs(nullptr, xyz, 0, &no_cut_outs, &triangles_out)),
        REFUSES("vertices", gnomon_triangles_upload_cut_outs(d, nullptr, 1, &no_cut_outs, &triangles_out)),
        REFUSES("cut_outs", gnomon_triangles_upload_cut_outs(d, xyz, 0, nullptr, &triangles_out)),
        REFUSES("materials", gnomon_triangles_upload_cut_outs(d, xyz, 0, &without_materials, &triangles_out)),
        REFUSES("textures[i].alpha", gnomon_triangles_upload_cut_outs(d, xyz, 0, &without_alpha, &triangles_out)),
        REFUSES("triangles_out", gnomon_triangles_upload_cut_outs(d, xyz, 0, &no_cut_outs, nullptr)),
        REFUSES("device", gnomon_triangles_copy_cut_outs(nullptr, nullptr, 0, 0, &no_buffers, &triangles_out)),
        REFUSES("vertices", gnomon_triangles_copy_cut_outs(d, nullptr, 0, 0, &no_buffers, &triangles_out)),
        REFUSES("cut_outs", gnomon_triangles_copy_cut_outs(d, vertex_buffer, 0, 0, nullptr, &triangles_out)),
        REFUSES("triangles_out", gnomon_triangles_copy_cut_outs(d, nullptr, 0, 0, &no_buffers, nullptr)),
        REFUSES("triangles", gnomon_triangles_cut_out_counts(nullptr, &cut_out_counts)),
        REFUSES("counts_out", gnomon_triangles_cut_out_counts(t, nullptr)),
        REFUSES("device", gnomon_triangles_share(nullptr, xyz, 0, &triangles_out)),
        REFUSES("vertices", gnomon_triangles_share(d, nullptr, 1, &triangles_out)),
        REFUSES("triangles_out", gnomon_triangles_share(d, xyz, 0, nullptr)),
        REFUSES("device", gnomon_points_share(nullptr, xyz, 0, nullptr, &points_out)),
        REFUSES("positions", gnomon_points_share(d, nullptr, 1, nullptr, &points_out)),
        REFUSES("points_out", gnomon_points_share(d, xyz, 0, nullptr, nullptr)),
        REFUSES("device", gnomon_visibility_share(nullptr, floats, 1, &visibility_out)),
        REFUSES("values", gnomon_visibility_share(d, nullptr, 1, &visibility_out)),
        REFUSES("visibility_out", gnomon_visibility_share(d, floats, 1, nullptr)),
        REFUSES("visibility", gnomon_visibility_fetch(nullptr)),
        REFUSES("device", gnomon_triangles_wrap(nullptr, nullptr, 0, 0, &triangles_out)),
        REFUSES("device", gnomon_triangles_raster(nullptr, xyz, 2, xyz, 2, xyz, false, &triangles_out)),
        REFUSES("x", gnomon_triangles_raster(d, nullptr, 2, xyz, 2, xyz, false, &triangles_out)),
        REFUSES("y", gnomon_triangles_raster(d, xyz, 2, nullptr, 2, xyz, false, &triangles_out)),
        REFUSES("heights", gnomon_triangles_raster(d, xyz, 2, xyz, 2, nullptr, false, &triangles_out)),
        REFUSES("triangles_out", gnomon_triangles_raster(d, xyz, 2, xyz, 2, xyz, false, nullptr)),
        REFUSES("triangles", gnomon_triangles_keep_clusters(nullptr, nullptr)),
        REFUSES("count_out", gnomon_triangles_count(t, nullptr)),
        REFUSES("triangles", gnomon_triangles_buffer(nullptr, nullptr, nullptr)),
        REFUSES("positions", gnomon_points_upload(d, nullptr, 1, nullptr, &points_out)),
        REFUSES("points_out", gnomon_points_wrap(d, nullptr, nullptr, 0, nullptr, nullptr)),
        REFUSES("camera", gnomon_points_set_camera(p, nullptr, 1, 1)),
        REFUSES("triangles", gnomon_points_set_lifted_off(p, nullptr, xyz)),
        REFUSES("points", gnomon_points_positions(nullptr, nullptr, nullptr)),
        REFUSES("buffer_out", gnomon_points_receivers(p, nullptr)),
        REFUSES("count_out", gnomon_points_count(p, nullptr)),
        REFUSES("points", gnomon_points_read(nullptr, floats, nullptr)),
        REFUSES("triangles", gnomon_points_lift(p, nullptr, xyz, &points_out, nullptr)),
        REFUSES("points", gnomon_points_lift(nullptr, t, xyz, &points_out, nullptr)),
        REFUSES("eye", gnomon_points_lift(p, t, nullptr, &points_out, nullptr)),
        REFUSES("lifted_out", gnomon_points_lift(p, t, xyz, nullptr, nullptr)),
        REFUSES("visibility_out", gnomon_visibility_create(d, 1, nullptr)),
        REFUSES("device", gnomon_visibility_wrap(nullptr, nullptr, 1, 0, &visibility_out)),
        REFUSES("count_out", gnomon_visibility_count(v, nullptr)),
        REFUSES("buffer_out", gnomon_visibility_buffer(v, nullptr)),
        REFUSES("values_out", gnomon_visibility_read(v, nullptr)),
        REFUSES("device", gnomon_technique_create(nullptr, "frustum-traced", &technique_out)),
        REFUSES("name", gnomon_technique_create(d, nullptr, &technique_out)),
        REFUSES("technique", gnomon_technique_set(nullptr, "map-size", "16")),
        REFUSES("name", gnomon_technique_set(k, nullptr, "16")),
        REFUSES("value", gnomon_technique_set(k, "map-size", nullptr)),
        REFUSES("technique", gnomon_technique_run(nullptr, t, p, sun, v, &by_eye, nullptr, nullptr)),
        REFUSES("triangles", gnomon_technique_run(k, nullptr, p, sun, v, &by_eye, nullptr, nullptr)),
        REFUSES("points", gnomon_technique_run(k, t, nullptr, sun, v, &by_eye, nullptr, nullptr)),
        REFUSES("visibility", gnomon_technique_run(k, t, p, sun, nullptr, &by_eye, nullptr, nullptr)),
        REFUSES("facing.normals_buffer", gnomon_technique_run(k, t, p, sun, v, &no_normals, nullptr, nullptr)),
        REFUSES("facing.fans", gnomon_technique_run(k, t, p, sun, v, &no_fans, nullptr, nullptr)),
        REFUSES("lights", gnomon_technique_run_each_light(k, t, p, nullptr, 1, nullptr, nullptr, nullptr)),
        REFUSES("lights[i].visibility",
                gnomon_technique_run_each_light(k, t, p, &no_visibility, 1, nullptr, nullptr, nullptr)),
        REFUSES("technique", gnomon_technique_prepare(nullptr, t, sun, nullptr, nullptr)),
        REFUSES("triangles", gnomon_technique_prepare(k, nullptr, sun, nullptr, nullptr)),
        REFUSES("technique", gnomon_technique_release_prepared_light(nullptr)),
        REFUSES("name", gnomon_technique_diagnose(k, nullptr, t, p, sun, nullptr, bytes)),
        REFUSES("rgba_out", gnomon_technique_diagnose(k, "decided", t, p, sun, nullptr, nullptr)),
        REFUSES("device", gnomon_device_finish(nullptr)),
        REFUSES("device", gnomon_vertex_fans_find(nullptr, xyz, 0, xyz, 0, &fans_out)),
        REFUSES("vertices", gnomon_vertex_fans_find(d, nullptr, 1, xyz, 0, &fans_out)),
        REFUSES("points", gnomon_vertex_fans_find(d, xyz, 0, nullptr, 1, &fans_out)),
        REFUSES("fans_out", gnomon_vertex_fans_find(d, xyz, 0, xyz, 0, nullptr)),
        REFUSES("fans", gnomon_vertex_fans_alone(nullptr, &ids_out, &count_out)),
        REFUSES("points_out", gnomon_vertex_fans_open(fans.get(), nullptr, &count_out)),
        REFUSES("count_out", gnomon_vertex_fans_open(fans.get(), &ids_out, nullptr)),
        REFUSES("count_out", gnomon_vertex_fans_extended(fans.get(), nullptr)),
        REFUSES("triangles", gnomon_view_look(d, nullptr, &camera, 1, 1, &view_out, nullptr, nullptr)),
        REFUSES("camera", gnomon_view_look(d, t, nullptr, 1, 1, &view_out, nullptr, nullptr)),
        REFUSES("view_out", gnomon_view_look(d, t, &camera, 1, 1, nullptr, nullptr, nullptr)),
        REFUSES("lights_out", gnomon_lights_create(&sun, nullptr, 1, nullptr)),
        REFUSES("lights", gnomon_lights_create(nullptr, nullptr, 1, &lights_out)),
        REFUSES("direction", gnomon_lights_sun_disk(nullptr, 1, 1, &lights_out)),
        REFUSES("edge_b", gnomon_lights_area(xyz, xyz, nullptr, 1, &lights_out)),
        REFUSES("north", gnomon_lights_sky(xyz, nullptr, 1, &lights_out)),
        REFUSES("lights", gnomon_lights_count(nullptr, &count_out)),
        REFUSES("count_out", gnomon_lights_count(table.get(), nullptr)),
        REFUSES("lights", gnomon_lights_read(nullptr, nullptr, nullptr)),
        REFUSES("lights", gnomon_lights_rounding(nullptr, nullptr, nullptr)),
        REFUSES("technique", gnomon_technique_run_light_table(nullptr, t, p, table.get(), &buffers, nullptr, nullptr)),
        REFUSES("lights", gnomon_technique_run_light_table(k, t, p, nullptr, &buffers, nullptr, nullptr)),
        REFUSES("outputs", gnomon_technique_run_light_table(k, t, p, table.get(), nullptr, nullptr, nullptr)),
        REFUSES("outputs", gnomon_technique_run_light_table_to_host(k, t, p, table.get(), nullptr, nullptr, nullptr)),
        REFUSES("mean", gnomon_technique_run_mean(k, t, p, table.get(), nullptr, nullptr, nullptr, nullptr)),
        REFUSES("points_out", gnomon_view_points(w, nullptr)),
        REFUSES("view", gnomon_view_read(nullptr, t, nullptr, nullptr, nullptr)),
        REFUSES("triangles", gnomon_view_read(w, nullptr, nullptr, nullptr, nullptr)),
        REFUSES("materials", gnomon_view_shade(w, t, &one, 1, nullptr, bytes)),
        REFUSES("materials.triangle_material", gnomon_view_shade(w, t, &one, 1, &no_ids, bytes)),
        REFUSES("pass_out", gnomon_camera_pass_create(d, nullptr)),
        REFUSES("pass", gnomon_camera_pass_look(nullptr, t, &camera, 1, 1, &view_out, nullptr, nullptr)),
        REFUSES("camera", gnomon_camera_pass_look(pass, t, nullptr, 1, 1, &view_out, nullptr, nullptr)),
        REFUSES("offsets_out", gnomon_sample_pattern(4, nullptr)),
        REFUSES("view", gnomon_technique_run_samples(k, t, nullptr, sun, v, nullptr, nullptr, nullptr)),
        REFUSES("mean", gnomon_technique_run_samples(k, t, w, sun, nullptr, nullptr, nullptr, nullptr)),
        REFUSES("points", gnomon_points_explain(nullptr, t, 0, sun, nullptr, &why)),
        REFUSES("explanation_out", gnomon_points_explain(p, t, 0, sun, nullptr, nullptr)),
        REFUSES("scene", gnomon_host_scene_look(d, nullptr, &camera, 1, 1, &parts)),
        REFUSES("scene.vertices", gnomon_host_scene_look(d, &no_vertices, &camera, 1, 1, &parts)),
        REFUSES("points", gnomon_host_scene_run(d, &empty, nullptr, sun, v, nullptr, nullptr)),
        REFUSES("settings[i].value", gnomon_host_scene_run(d, &empty, p, sun, v, &parts_options, nullptr)),
#undef REFUSES
    };
    // A getter that fails gives null, whatever was there.
    cl_command_queue queue = cpp_device.queue();
    EXPECT_EQ(gnomon_device_queue(nullptr, &queue), GNOMON_INVALID_ARGUMENT);
    EXPECT_EQ(queue, nullptr);
    for (const auto& [status, argument, text] : refused) {
        EXPECT_EQ(status, GNOMON_INVALID_ARGUMENT) << argument << ": " << text;
        EXPECT_EQ(text, "the argument " + std::string(argument) + " must not be null");
    }
}

TEST(CInterface, HasTheVersionOfItsLibrary) {
    const std::string version = std::to_string(GNOMON_VERSION_MAJOR) + "." + std::to_string(GNOMON_VERSION_MINOR) +
                                "." + std::to_string(GNOMON_VERSION_PATCH);
    EXPECT_EQ(gnomon_version(), version);
}

// ---- Memory ---------------------------------------------------------------------------------------------------------

TEST_F(BesideCpp, NothingIsLostOnTheDevice) {
    std::uint64_t before = 0, after = 0, peak = 0;
    EXPECT_DONE(gnomon_device_memory(device.get(), &before, nullptr));
    {
        const auto view = made<gnomon_view>([&](auto out) {
            return gnomon_view_look(device.get(), triangles.get(), &camera, width, height, out, nullptr, nullptr);
        });
        const auto with = technique("frustum-traced");
        EXPECT_DONE(gnomon_technique_prepare(with.get(), triangles.get(), lights[0], nullptr, nullptr));
        run(with.get(), lights[0]);
        EXPECT_DONE(gnomon_device_memory(device.get(), &after, &peak));
        EXPECT_GT(after, before);
        EXPECT_GE(peak, after);
    }
    EXPECT_DONE(gnomon_device_memory(device.get(), &after, nullptr));
    EXPECT_EQ(after, before);
}

}  // namespace
