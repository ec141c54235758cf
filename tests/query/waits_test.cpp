// SPDX-License-Identifier: MIT
// Which functions wait for the device: the tables in gnomon.hpp and gnomon.h are what the trace shows. The trace marks
// each call that blocks (host/cl/session.cpp; tools/check_layout.sh lets no other file make one).
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include <gnomon.h>
#include <gnomon.hpp>
#include "support/environment.hpp"
#include "support/scene_makers.hpp"

namespace {

using namespace gnomon;
using support::Floats;

/// The table of a header: a word for each function.
std::map<std::string, std::string> table_of(const std::string& header) {
    std::ifstream file(std::string(GNOMON_TESTS) + "/../host/include/" + header);
    std::map<std::string, std::string> table;
    std::string line;
    while (std::getline(file, line) && line != "// WAITS") {
    }
    while (std::getline(file, line) && line != "// END OF WAITS") {
        std::istringstream words(line);
        std::string slashes, name, word, more;
        words >> slashes >> name >> word;
        EXPECT_TRUE(slashes == "//" && !word.empty() && !(words >> more)) << line;
        EXPECT_TRUE(table.emplace(name, word).second) << name << " stands there twice";
    }
    return table;
}

/// How often a call blocks. A trace without a line of its own would count nothing: the device's opening is counted,
/// too.
std::size_t waits_of(const std::function<void()>& call) {
    testing::internal::CaptureStderr();
    call();
    std::istringstream trace(testing::internal::GetCapturedStderr());
    std::size_t count = 0;
    for (std::string line; std::getline(trace, line);) count += line.ends_with(", waits");
    return count;
}

struct Case {
    std::string name;
    std::function<void()> call;
    std::function<void()> call_with_large_buffer{};  ///< where a CPU waits for it
};

void expect_table(const std::string& header, const std::vector<Case>& cases, bool is_cpu) {
    const auto table = table_of(header);
    ASSERT_GT(table.size(), 20u);
    std::set<std::string> measured, listed;
    for (const auto& [name, word] : table) listed.insert(name);
    for (const Case& one : cases) {
        measured.insert(one.name);
        if (!table.contains(one.name)) continue;
        const std::string& word = table.at(one.name);
        SCOPED_TRACE(one.name + ": " + word);
        const std::size_t first = waits_of(one.call), second = waits_of(one.call);
        if (word == "always") {
            EXPECT_GT(first, 0u);
            EXPECT_GT(second, 0u);
        } else {
            EXPECT_TRUE(word == "never" || word == "large");
            EXPECT_EQ(second, 0u);
        }
        if (word == "never") {
            EXPECT_EQ(first, 0u);
        }
        if (word == "large" && is_cpu) {
            ASSERT_TRUE(one.call_with_large_buffer);
            EXPECT_GT(waits_of(one.call_with_large_buffer), 0u);
        }
    }
    EXPECT_EQ(measured, listed);
}

const Floats vertices = support::soup(300, 0.4f, 3), positions = support::random_points(2000, -1, 1, 4);
constexpr std::size_t points_count = 2000, large = std::size_t(1) << 21;  // floats: 8 MiB
std::vector<std::uint32_t> some_receivers() {
    std::vector<std::uint32_t> ids(points_count);
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = std::uint32_t(i % 300);
    return ids;
}
constexpr Float3 eye{0, 1, 4}, origin{}, up{0, 1, 0};

template <typename Make>
auto quietly(const Make& make) {
    testing::internal::CaptureStderr();
    auto made = make();
    testing::internal::GetCapturedStderr();
    return made;
}

/// What the cases of both languages are made of.
class Waits : public testing::Test {
protected:
    support::Environment trace{"GNOMON_TRACE", "1"};
    Device device = quietly([] { return Device(); });
    const std::vector<std::uint32_t> receivers = some_receivers();
    const Light light = Light::directional({0.3f, -1, 0.2f});
    const Camera camera = Camera::look_at(eye, origin, up, 50);
};

TEST_F(Waits, OfCppAreThoseOfTheTable) {
    const auto technique = quietly([&] { return make_technique("frustum-traced", device); });
    const auto fans = quietly([&] { return VertexFans::find(device, vertices, std::span(vertices).first(3)); });
    auto triangles = quietly([&] { return Triangles::upload(device, vertices); });
    const auto points = quietly([&] { return Points::upload(device, positions, receivers); });
    const auto many = quietly(
        [&] { return Points::upload(device, Floats(3 * large / 2), std::vector<std::uint32_t>(large / 2, 0)); });
    const Visibility visibility(device, points_count), second(device, points_count);
    CameraPass pass(device);
    const auto view = quietly([&] { return look(device, triangles, camera, 16, 12); });
    const Visibility picture(device, 16 * 12);
    const Materials grey{std::vector<std::uint32_t>(300, 0), {{0.5f, 0.5f, 0.5f}}};
    const Lights table = sun_disk({0.3f, -1, 0.2f}, 5, 40);
    std::vector<float> shared(points_count);
    const Visibility into_host = Visibility::share(device, shared);
    const std::array lights{light, Light::point({0, 3, 0})};
    const std::array<Visibility, 2> both{visibility, second};
    const Surfaces surfaces = quietly([&] { return Surfaces(device, triangles, view, grey); });
    const Visibility& counts = second;  // as many bytes
    const Appearance appearance = quietly([&] { return Appearance::upload(device, grey); });
    const View large_view = quietly([&] { return look(device, triangles, camera, 1200, 900); });
    const Visibility rgba(device, 16 * 12);  // as many bytes
    PictureMean mean(device, 16 * 12, 100), read_mean(device, 16 * 12, 1);
    read_mean.add(surfaces, std::span(&picture, 1), std::span(&light, 1));
    const Points opaque =
        quietly([&] { return Points::upload(device, Floats(900), std::vector<std::uint32_t>(300, no_cut_out)); });
    CutOutBuffers cut_outs;
    cut_outs.material_of_triangle = opaque.receivers();
    const Floats axis{0, 1, 2};
    const std::vector<Case> cases{
        {"Device::Device", [&] { Device(); }},
        {"Device::finish", [&] { device.finish(); }},
        {"Triangles::upload", [&] { Triangles::upload(device, vertices); }},
        {"Triangles::copy", [&] { Triangles::copy(device, triangles.buffer(), 300, 0, cut_outs); }},
        {"Triangles::wrap", [&] { Triangles::wrap(device, triangles.buffer(), 300); }},
        {"Triangles::raster",
         [&] {
             Triangles::raster(device, {std::span(axis), std::span(axis), std::span(vertices).first(9)});
         }},
        {"Triangles::keep_clusters", [&] { triangles.keep_clusters(device); }},
        {"Points::upload", [&] { Points::upload(device, positions, receivers); }},
        {"Points::wrap", [&] { Points::wrap(device, points.positions(), {}, points_count, points.receivers()); }},
        {"Points::read", [&] { points.read(device); }},
        {"Visibility::Visibility", [&] { Visibility(device, 100); }, [&] { Visibility(device, large); }},
        {"Visibility::wrap", [&] { Visibility::wrap(device, visibility.buffer(), points_count); }},
        {"Visibility::read", [&] { visibility.read(); }},
        {"Visibility::fetch", [&] { into_host.fetch(); }},
        {"lift", [&] { lift(device, triangles, points, eye); }, [&] { lift(device, triangles, many, eye); }},
        {"look", [&] { look(device, triangles, camera, 16, 12); }},
        {"CameraPass::look", [&] { pass.look(triangles, camera, 16, 12); }},
        {"View::read", [&] { view.read(device, triangles); }},
        {"Appearance::upload", [&] { Appearance::upload(device, grey); }},
        {"Appearance::surfaces", [&] { appearance.surfaces(triangles, view); },
         [&] { Appearance::upload(device, grey).surfaces(triangles, large_view); }},
        {"Surfaces::Surfaces", [&] { Surfaces(device, triangles, view, grey); }},
        {"Surfaces::read", [&] { surfaces.read(); }},
        {"shade", [&] { shade(surfaces, std::span(&picture, 1), std::span(&light, 1)); }},
        {"shade_into", [&] { shade_into(rgba.buffer(), surfaces, std::span(&picture, 1), std::span(&light, 1)); }},
        {"PictureMean::PictureMean", [&] { PictureMean(device, 16 * 12, 1); }, [&] { PictureMean(device, large, 1); }},
        {"PictureMean::add", [&] { mean.add(surfaces, std::span(&picture, 1), std::span(&light, 1)); }},
        {"PictureMean::read", [&] { read_mean.read(); }},
        {"VertexFans::find", [&] { VertexFans::find(device, vertices, std::span(vertices).first(3)); }},
        {"VertexFans::extended", [&] { fans.extended(); }},
        {"make_technique", [&] { make_technique("frustum-traced", device); }},
        {"Technique::set", [&] { technique->set("map-size", "64"); }},
        {"Technique::run", [&] { technique->run(triangles, points, light, visibility); }},
        {"Technique::run_each_light", [&] { technique->run_each_light(triangles, points, lights, both); }},
        {"Technique::run_light_table",
         [&] { technique->run_light_table(triangles, points, table, {.counts = counts.buffer()}); }},
        {"Technique::prepare", [&] { technique->prepare(triangles, light); }},
        {"Technique::release_prepared_light", [&] { technique->release_prepared_light(); }},
        {"Technique::diagnose", [&] { technique->diagnose("decided", triangles, points, light); }},
        {"run_light_table_to_host",
         [&] { run_light_table_to_host(*technique, triangles, points, table, {.counts = true}); }},
        {"run_mean", [&] { run_mean(*technique, triangles, points, table, visibility); }},
        {"run_samples", [&] { run_samples(*technique, triangles, view, light, 4, picture); }},
        {"run_samples_mean", [&] { run_samples_mean(*technique, triangles, view, table, 4, picture); }},
        {"SampleViews::SampleViews", [&] { SampleViews(device, triangles, view, 4); }},
        {"SampleViews::at", [&] { SampleViews(device, triangles, view, 4).at(0); }},
        {"run_in_parts",
         [&] {
             run_in_parts([&] { return make_technique("frustum-traced", device); }, device, {vertices}, points, {},
                          light, visibility);
         }},
        {"look_in_parts", [&] { look_in_parts(device, {vertices}, camera, 16, 12); }},
        {"explain", [&] { explain(device, triangles, points, 7, light); }}};
    quietly([&] {
        device.kernel_builds();
        return 0;
    });
    expect_table("gnomon.hpp", cases,
                 device.description().type == "CPU" && std::getenv("GNOMON_GPU_KERNELS") == nullptr);
}

/// The bytes that a call copies between host and device, by the trace.
std::size_t crossing_bytes_of(const std::function<void()>& call) {
    testing::internal::CaptureStderr();
    call();
    std::istringstream trace(testing::internal::GetCapturedStderr());
    std::size_t bytes = 0;
    for (std::string line; std::getline(trace, line);) {
        std::istringstream words(line);
        std::string gnomon, of, verb;
        std::size_t some = 0;
        if (words >> gnomon >> of >> verb && (verb == "writing" || verb == "reading") && words >> some) bytes += some;
    }
    return bytes;
}

// The second frame of a scene that stands still, with all that surfaces may have: what crosses between host and device
// beside the picture, which a caller may also leave in a buffer.
TEST_F(Waits, OnlyThePictureLeavesTheDevice) {
    constexpr std::uint32_t width = 320, height = 180, pixels = width * height;
    const auto technique = quietly([&] { return make_technique("frustum-traced", device); });
    auto triangles = quietly([&] { return Triangles::upload(device, vertices); });
    const Materials materials{std::vector<std::uint32_t>(300, 0), {{0.5f, 0.5f, 0.5f}}};
    const Floats coordinates = support::random_points(600, 0, 1, 5), colors(2700, 0.75f);
    const std::vector<std::uint32_t> normals(900, pack_normal({1, 2, 3}));
    const std::vector<std::uint8_t> texels(4 * 64 * 64, 100);
    const ColorTexture texture{64, 64, texels};
    const ColorTextureUse use{0};
    const Appearance appearance = quietly([&] {
        return Appearance::upload(device, materials, {coordinates, colors, normals, {&use, 1}, {&texture, 1}});
    });
    const Lights sky = sky_patches({0, 1, 0}, {0, 0, -1}, 1);
    const Visibility visibility(device, pixels), sums(device, 2 * pixels), rgba(device, pixels);
    CameraPass pass(device);
    std::optional<View> view;
    ShadeOptions options;
    const auto surfaces_of_frame = [&] {
        view.reset();
        view = pass.look(triangles, camera, width, height);
        technique->run(triangles, view->points, light, visibility);
        return appearance.surfaces(triangles, *view);
    };
    const auto frame = [&] { shade(surfaces_of_frame(), std::span(&visibility, 1), std::span(&light, 1), options); };
    const auto frame_into_buffer = [&] {
        shade_into(rgba.buffer(), surfaces_of_frame(), std::span(&visibility, 1), std::span(&light, 1), options);
    };
    EXPECT_GT(crossing_bytes_of(frame), 4 * pixels + 4096u) << "the first frame brings the camera's rays";
    EXPECT_LE(crossing_bytes_of(frame), 4 * pixels + 4096u);
    EXPECT_LE(crossing_bytes_of(frame_into_buffer), 4096u);
    options = {.exposure_ev = std::nullopt, .sky_sums = sums.buffer()};
    EXPECT_LE(crossing_bytes_of(frame_into_buffer), 4096u);
}

// A run waits whatever the facing, and progress makes each of its reports wait.
TEST_F(Waits, OfARunDependOnNoFacing) {
    const auto technique = quietly([&] { return make_technique("frustum-traced", device); });
    const auto triangles = quietly([&] { return Triangles::upload(device, vertices); });
    const auto points = quietly([&] { return Points::upload(device, positions, receivers); });
    const Visibility visibility(device, points_count);
    for (const Facing& facing : {Facing::automatic(), Facing::none(), Facing::eye(eye), Facing::normals(positions),
                                 Facing::normals(points.positions()), Facing::winding()})
        for (int repeat = 0; repeat < 2; ++repeat)
            EXPECT_GT(waits_of([&] { technique->run(triangles, points, light, visibility, {.facing = facing}); }), 0u);
}

#define DONE(call) EXPECT_EQ(call, GNOMON_SUCCESS) << gnomon_last_error()

/// Destroys what a function made; `made` is read after the call.
template <auto destroy, typename Handle>
void once(gnomon_status status, Handle*& made) {
    DONE(status);
    destroy(made);
}

TEST_F(Waits, OfCAreThoseOfTheTable) {
    gnomon_device* d = nullptr;
    gnomon_triangles* t = nullptr;
    gnomon_points *p = nullptr, *p_out = nullptr, *many = nullptr, *ids = nullptr;
    gnomon_visibility *v = nullptr, *second = nullptr, *small = nullptr, *shared = nullptr, *v_out = nullptr;
    gnomon_technique *k = nullptr, *k_out = nullptr;
    gnomon_vertex_fans *f = nullptr, *f_out = nullptr;
    gnomon_lights* table = nullptr;
    gnomon_view *w = nullptr, *w_out = nullptr;
    gnomon_camera_pass* pass = nullptr;
    gnomon_triangles* t_out = nullptr;
    const gnomon_explanation* why = nullptr;
    const gnomon_view_of_parts* parts = nullptr;
    gnomon_light sun;
    gnomon_camera seen_by;
    cl_mem t_buffer = nullptr, p_buffer = nullptr, r_buffer = nullptr, v_buffer = nullptr, id_buffer = nullptr;
    Floats host(points_count), read(3 * points_count);
    const Float3 direction{0.3f, -1, 0.2f};
    testing::internal::CaptureStderr();
    DONE(gnomon_device_open(nullptr, nullptr, &d));
    DONE(gnomon_triangles_upload(d, vertices.data(), 300, &t));
    DONE(gnomon_triangles_buffer(t, &t_buffer, nullptr));
    DONE(gnomon_points_upload(d, positions.data(), points_count, receivers.data(), &p));
    DONE(gnomon_points_positions(p, &p_buffer, nullptr));
    DONE(gnomon_points_receivers(p, &r_buffer));
    const Floats zeros(3 * large / 2);
    const std::vector<std::uint32_t> first(large / 2, 0);
    DONE(gnomon_points_upload(d, zeros.data(), large / 2, first.data(), &many));
    DONE(gnomon_visibility_create(d, points_count, &v));
    DONE(gnomon_visibility_create(d, points_count, &second));
    DONE(gnomon_visibility_create(d, 16 * 12, &small));
    const std::vector<std::uint32_t> opaque(300, GNOMON_NO_CUT_OUT);
    DONE(gnomon_points_upload(d, positions.data(), 300, opaque.data(), &ids));
    DONE(gnomon_points_receivers(ids, &id_buffer));
    DONE(gnomon_visibility_buffer(v, &v_buffer));
    DONE(gnomon_visibility_share(d, host.data(), points_count, &shared));
    DONE(gnomon_technique_create(d, "frustum-traced", &k));
    DONE(gnomon_vertex_fans_find(d, vertices.data(), 300, vertices.data(), 1, &f));
    DONE(gnomon_lights_sun_disk(direction.data(), 5, 40, &table));
    DONE(gnomon_light_directional(direction.data(), &sun));
    DONE(gnomon_camera_look_at(eye.data(), origin.data(), up.data(), 50, &seen_by));
    DONE(gnomon_view_look(d, t, &seen_by, 16, 12, &w, nullptr, nullptr));
    DONE(gnomon_camera_pass_create(d, &pass));
    testing::internal::GetCapturedStderr();
    const std::vector<std::uint32_t> material(300, 0);
    const Floats grey(3, 0.5f);
    const gnomon_materials materials{sizeof(gnomon_materials), material.data(), 300, grey.data(), 1};
    gnomon_cut_outs cut_outs = GNOMON_CUT_OUTS_INIT;
    cut_outs.material_of_triangle = opaque.data();
    gnomon_cut_out_buffers buffers = GNOMON_CUT_OUT_BUFFERS_INIT;
    buffers.material_of_triangle = id_buffer;
    gnomon_light_table_buffers outputs = GNOMON_LIGHT_TABLE_BUFFERS_INIT;
    outputs.counts = v_buffer;
    std::vector<std::uint32_t> counts(points_count);
    gnomon_light_table_arrays arrays = GNOMON_LIGHT_TABLE_ARRAYS_INIT;
    arrays.counts = counts.data();
    const gnomon_light_visibility pairs[2] = {{sun, v}, {sun, second}}, lit{sun, small};
    gnomon_host_scene scene = GNOMON_HOST_SCENE_INIT;
    scene.vertices = vertices.data();
    scene.count = 300;
    std::vector<std::uint8_t> rgba(4 * points_count);
    gnomon_kernel_builds builds;
    std::uint64_t extended = 0;
    const std::vector<Case> cases{
        {"gnomon_device_open",
         [&] {
             gnomon_device* opened = nullptr;
             once<gnomon_device_destroy>(gnomon_device_open(nullptr, nullptr, &opened), opened);
         }},
        {"gnomon_device_finish", [&] { DONE(gnomon_device_finish(d)); }},
        {"gnomon_triangles_upload",
         [&] { once<gnomon_triangles_destroy>(gnomon_triangles_upload(d, vertices.data(), 300, &t_out), t_out); }},
        {"gnomon_triangles_raster",
         [&] {
             const float axis[] = {0, 1, 2};
             once<gnomon_triangles_destroy>(
                 gnomon_triangles_raster(d, axis, 3, axis, 3, vertices.data(), false, &t_out), t_out);
         }},
        {"gnomon_triangles_wrap",
         [&] { once<gnomon_triangles_destroy>(gnomon_triangles_wrap(d, t_buffer, 300, 0, &t_out), t_out); }},
        {"gnomon_triangles_upload_cut_outs",
         [&] {
             once<gnomon_triangles_destroy>(
                 gnomon_triangles_upload_cut_outs(d, vertices.data(), 300, &cut_outs, &t_out), t_out);
         }},
        {"gnomon_triangles_copy_cut_outs",
         [&] {
             once<gnomon_triangles_destroy>(gnomon_triangles_copy_cut_outs(d, t_buffer, 300, 0, &buffers, &t_out),
                                            t_out);
         }},
        {"gnomon_triangles_keep_clusters", [&] { DONE(gnomon_triangles_keep_clusters(t, nullptr)); }},
        {"gnomon_points_upload",
         [&] {
             once<gnomon_points_destroy>(
                 gnomon_points_upload(d, positions.data(), points_count, receivers.data(), &p_out), p_out);
         }},
        {"gnomon_points_wrap",
         [&] {
             once<gnomon_points_destroy>(gnomon_points_wrap(d, p_buffer, nullptr, points_count, r_buffer, &p_out),
                                         p_out);
         }},
        {"gnomon_points_read", [&] { DONE(gnomon_points_read(p, read.data(), nullptr)); }},
        {"gnomon_points_lift",
         [&] { once<gnomon_points_destroy>(gnomon_points_lift(p, t, eye.data(), &p_out, nullptr), p_out); },
         [&] { once<gnomon_points_destroy>(gnomon_points_lift(many, t, eye.data(), &p_out, nullptr), p_out); }},
        {"gnomon_points_explain",
         [&] { once<gnomon_explanation_destroy>(gnomon_points_explain(p, t, 7, sun, nullptr, &why), why); }},
        {"gnomon_visibility_create",
         [&] { once<gnomon_visibility_destroy>(gnomon_visibility_create(d, 100, &v_out), v_out); },
         [&] { once<gnomon_visibility_destroy>(gnomon_visibility_create(d, large, &v_out), v_out); }},
        {"gnomon_visibility_wrap",
         [&] { once<gnomon_visibility_destroy>(gnomon_visibility_wrap(d, v_buffer, points_count, 0, &v_out), v_out); }},
        {"gnomon_visibility_fetch", [&] { DONE(gnomon_visibility_fetch(shared)); }},
        {"gnomon_visibility_read", [&] { DONE(gnomon_visibility_read(v, host.data())); }},
        {"gnomon_vertex_fans_find",
         [&] {
             once<gnomon_vertex_fans_destroy>(
                 gnomon_vertex_fans_find(d, vertices.data(), 300, vertices.data(), 1, &f_out), f_out);
         }},
        {"gnomon_vertex_fans_extended", [&] { DONE(gnomon_vertex_fans_extended(f, &extended)); }},
        {"gnomon_technique_create",
         [&] { once<gnomon_technique_destroy>(gnomon_technique_create(d, "frustum-traced", &k_out), k_out); }},
        {"gnomon_technique_set", [&] { DONE(gnomon_technique_set(k, "map-size", "64")); }},
        {"gnomon_technique_run", [&] { DONE(gnomon_technique_run(k, t, p, sun, v, nullptr, nullptr, nullptr)); }},
        {"gnomon_technique_run_each_light",
         [&] { DONE(gnomon_technique_run_each_light(k, t, p, pairs, 2, nullptr, nullptr, nullptr)); }},
        {"gnomon_technique_run_light_table",
         [&] { DONE(gnomon_technique_run_light_table(k, t, p, table, &outputs, nullptr, nullptr)); }},
        {"gnomon_technique_run_light_table_to_host",
         [&] { DONE(gnomon_technique_run_light_table_to_host(k, t, p, table, &arrays, nullptr, nullptr)); }},
        {"gnomon_technique_run_mean",
         [&] { DONE(gnomon_technique_run_mean(k, t, p, table, v, nullptr, nullptr, nullptr)); }},
        {"gnomon_technique_run_samples",
         [&] { DONE(gnomon_technique_run_samples(k, t, w, sun, small, nullptr, nullptr, nullptr)); }},
        {"gnomon_technique_prepare", [&] { DONE(gnomon_technique_prepare(k, t, sun, nullptr, nullptr)); }},
        {"gnomon_technique_release_prepared_light", [&] { DONE(gnomon_technique_release_prepared_light(k)); }},
        {"gnomon_technique_diagnose",
         [&] { DONE(gnomon_technique_diagnose(k, "decided", t, p, sun, nullptr, rgba.data())); }},
        {"gnomon_view_look",
         [&] { once<gnomon_view_destroy>(gnomon_view_look(d, t, &seen_by, 16, 12, &w_out, nullptr, nullptr), w_out); }},
        {"gnomon_camera_pass_look",
         [&] {
             once<gnomon_view_destroy>(gnomon_camera_pass_look(pass, t, &seen_by, 16, 12, &w_out, nullptr, nullptr),
                                       w_out);
         }},
        {"gnomon_view_read", [&] { DONE(gnomon_view_read(w, t, read.data(), nullptr, nullptr)); }},
        {"gnomon_view_shade", [&] { DONE(gnomon_view_shade(w, t, &lit, 1, &materials, rgba.data())); }},
        {"gnomon_host_scene_look",
         [&] {
             once<gnomon_view_of_parts_destroy>(gnomon_host_scene_look(d, &scene, &seen_by, 16, 12, &parts), parts);
         }},
        {"gnomon_host_scene_run", [&] { DONE(gnomon_host_scene_run(d, &scene, p, sun, v, nullptr, nullptr)); }}};
    testing::internal::CaptureStderr();
    DONE(gnomon_device_kernel_builds(d, &builds));
    testing::internal::GetCapturedStderr();
    expect_table("gnomon.h", cases, device.description().type == "CPU" && std::getenv("GNOMON_GPU_KERNELS") == nullptr);
    gnomon_camera_pass_destroy(pass);
    gnomon_view_destroy(w);
    gnomon_lights_destroy(table);
    gnomon_vertex_fans_destroy(f);
    gnomon_technique_destroy(k);
    for (gnomon_visibility* one : {v, second, small, shared}) gnomon_visibility_destroy(one);
    for (gnomon_points* one : {p, many, ids}) gnomon_points_destroy(one);
    gnomon_triangles_destroy(t);
    gnomon_device_destroy(d);
}

}  // namespace
