// SPDX-License-Identifier: MIT
// gnomon.h: techniques, views and runs in parts.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

namespace {

Technique& technique_at(gnomon_technique* technique) { return *at(technique, "technique").technique; }

void give_view(const Device& device, View&& view, gnomon_view*& out, WorkResults& results) {
    Statistics statistics = view.statistics;
    auto made = std::make_unique<gnomon_view>(gnomon_view{device, view, {device, view.points}});
    results.finish(device, std::move(statistics));
    out = made.release();
}

std::unique_ptr<Technique> make_with_settings(const Device& device, const char* name,
                                              std::span<const gnomon_setting> settings) {
    auto technique = make_technique(&at(name, "technique"), device);
    for (const gnomon_setting& setting : settings)
        technique->set(&at(setting.name, "settings[i].name"), &at(setting.value, "settings[i].value"));
    return technique;
}

/// Lends one of the fans' lists.
gnomon_status ids_of(const gnomon_vertex_fans* fans, const std::vector<std::uint32_t>& (VertexFans::*list)() const,
                     const uint32_t** points_out, size_t* count_out) {
    return guarded([&] {
        const uint32_t*& ids = result_at(points_out, "points_out");
        size_t& count = at(count_out, "count_out");
        const std::vector<std::uint32_t>& found = (at(fans, "fans").fans.*list)();
        ids = found.data();
        count = found.size();
    });
}

}  // namespace

// ---- Techniques -----------------------------------------------------------------------------------------------------

gnomon_status gnomon_technique_create(const gnomon_device* device, const char* name, gnomon_technique** technique_out) {
    return made(device, technique_out, "technique_out",
                [&](const Device& on) { return make_technique(&at(name, "name"), on); });
}

void gnomon_technique_destroy(gnomon_technique* technique) { delete technique; }

gnomon_status gnomon_technique_set(gnomon_technique* technique, const char* name, const char* value) {
    return guarded([&] { technique_at(technique).set(&at(name, "name"), &at(value, "value")); });
}

gnomon_status gnomon_technique_run(gnomon_technique* technique, const gnomon_triangles* triangles,
                                   const gnomon_points* points, gnomon_light light, const gnomon_visibility* visibility,
                                   const gnomon_run_options* options, cl_event* event_out,
                                   const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        Technique& cpp_technique = technique_at(technique);
        const Points& cpp_points = at(points, "points").points;
        results.finish(technique->device,
                       cpp_technique.run(at(triangles, "triangles").triangles, cpp_points, light_of(light),
                                         at(visibility, "visibility").visibility, run_options_at(options, cpp_points)));
    });
}

gnomon_status gnomon_technique_run_each_light(gnomon_technique* technique, const gnomon_triangles* triangles,
                                              const gnomon_points* points, const gnomon_light_visibility* lights,
                                              size_t count, const gnomon_run_options* options, cl_event* event_out,
                                              const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out);
        if (statistics_out != nullptr) std::fill_n(statistics_out, count, nullptr);
        Technique& cpp_technique = technique_at(technique);
        const Points& cpp_points = at(points, "points").points;
        const LightVisibilities pairs(lights, count);
        std::vector<Statistics> statistics =
            cpp_technique.run_each_light(at(triangles, "triangles").triangles, cpp_points, pairs.lights,
                                         pairs.visibilities, run_options_at(options, cpp_points));
        std::vector<StatisticsPointer> shown;
        if (statistics_out != nullptr)
            for (Statistics& one : statistics) shown.emplace_back(new_statistics(std::move(one)));
        results.finish(technique->device);
        for (std::size_t i = 0; i < shown.size(); ++i) statistics_out[i] = shown[i].release();
    });
}

gnomon_status gnomon_technique_prepare(gnomon_technique* technique, const gnomon_triangles* triangles,
                                       gnomon_light light, cl_event* event_out,
                                       const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        results.finish(at(technique, "technique").device,
                       technique_at(technique).prepare(at(triangles, "triangles").triangles, light_of(light)));
    });
}

gnomon_status gnomon_technique_release_prepared_light(gnomon_technique* technique) {
    return guarded([&] { technique_at(technique).release_prepared_light(); });
}

gnomon_status gnomon_technique_diagnose(gnomon_technique* technique, const char* name,
                                        const gnomon_triangles* triangles, const gnomon_points* points,
                                        gnomon_light light, const gnomon_run_options* options, uint8_t* rgba_out) {
    return guarded([&] {
        Technique& cpp_technique = technique_at(technique);
        const Points& cpp_points = at(points, "points").points;
        const std::vector<std::uint8_t> drawn =
            cpp_technique.diagnose(&at(name, "name"), at(triangles, "triangles").triangles, cpp_points, light_of(light),
                                   run_options_at(options, cpp_points).facing);
        std::copy(drawn.begin(), drawn.end(), &at(rgba_out, "rgba_out"));
    });
}

// ---- Facing ---------------------------------------------------------------------------------------------------------

gnomon_status gnomon_vertex_fans_find(const gnomon_device* device, const float* vertices, size_t triangle_count,
                                      const float* points, size_t count, gnomon_vertex_fans** fans_out) {
    return made(device, fans_out, "fans_out", [&](const Device& on) {
        return VertexFans::find(on, array(vertices, triangle_count, 9, "vertices"), array(points, count, 3, "points"));
    });
}

void gnomon_vertex_fans_destroy(gnomon_vertex_fans* fans) { delete fans; }

gnomon_status gnomon_vertex_fans_alone(const gnomon_vertex_fans* fans, const uint32_t** points_out, size_t* count_out) {
    return ids_of(fans, &VertexFans::alone, points_out, count_out);
}

gnomon_status gnomon_vertex_fans_open(const gnomon_vertex_fans* fans, const uint32_t** points_out, size_t* count_out) {
    return ids_of(fans, &VertexFans::open, points_out, count_out);
}

gnomon_status gnomon_vertex_fans_extended(const gnomon_vertex_fans* fans, uint64_t* count_out) {
    return guarded([&] { at(count_out, "count_out") = at(fans, "fans").fans.extended(); });
}

// ---- Views ----------------------------------------------------------------------------------------------------------

gnomon_status gnomon_view_look(const gnomon_device* device, const gnomon_triangles* triangles,
                               const gnomon_camera* camera, uint32_t width, uint32_t height, gnomon_view** view_out,
                               cl_event* event_out, const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        gnomon_view*& out = result_at(view_out, "view_out");
        const Device& cpp_device = at(device, "device").device;
        give_view(cpp_device, look(cpp_device, at(triangles, "triangles").triangles, camera_at(camera), width, height),
                  out, results);
    });
}

void gnomon_view_destroy(gnomon_view* view) { delete view; }

gnomon_status gnomon_view_points(const gnomon_view* view, const gnomon_points** points_out) {
    return result_of(points_out, "points_out", [&] { return &at(view, "view").points; });
}

gnomon_status gnomon_view_read(const gnomon_view* view, const gnomon_triangles* triangles, float* positions_out,
                               float* normals_out, uint32_t* receivers_out) {
    return guarded([&] {
        const gnomon_view& c_view = at(view, "view");
        const ViewOnHost host = c_view.view.read(c_view.device, at(triangles, "triangles").triangles);
        if (positions_out != nullptr) std::copy(host.position.begin(), host.position.end(), positions_out);
        if (normals_out != nullptr) std::copy(host.normal.begin(), host.normal.end(), normals_out);
        if (receivers_out != nullptr) std::copy(host.receiver.begin(), host.receiver.end(), receivers_out);
    });
}

gnomon_status gnomon_camera_pass_create(const gnomon_device* device, gnomon_camera_pass** pass_out) {
    return made(device, pass_out, "pass_out", [&](const Device& on) { return CameraPass(on); });
}

void gnomon_camera_pass_destroy(gnomon_camera_pass* pass) { delete pass; }

gnomon_status gnomon_camera_pass_look(gnomon_camera_pass* pass, const gnomon_triangles* triangles,
                                      const gnomon_camera* camera, uint32_t width, uint32_t height,
                                      gnomon_view** view_out, cl_event* event_out,
                                      const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        gnomon_view*& out = result_at(view_out, "view_out");
        gnomon_camera_pass& c_camera_pass = at(pass, "pass");
        give_view(c_camera_pass.device,
                  c_camera_pass.pass.look(at(triangles, "triangles").triangles, camera_at(camera), width, height), out,
                  results);
    });
}

// ---- Scenes larger than the device's memory -------------------------------------------------------------------------

gnomon_status gnomon_host_scene_run(const gnomon_device* device, const gnomon_host_scene* scene,
                                    const gnomon_points* points, gnomon_light light,
                                    const gnomon_visibility* visibility, const gnomon_host_scene_options* options,
                                    const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(nullptr, statistics_out);
        const Device& cpp_device = at(device, "device").device;
        const Points& cpp_points = at(points, "points").points;
        const gnomon_host_scene_options& chosen = sized_or(options, "options", GNOMON_HOST_SCENE_OPTIONS_INIT);
        const char* name = chosen.technique != nullptr ? chosen.technique : "frustum-traced";
        const auto settings = array(chosen.settings, chosen.setting_count, 1, "settings");
        const HostSceneArgument on_host(scene);
        results.finish(
            cpp_device,
            run_in_parts([&] { return make_with_settings(cpp_device, name, settings); }, cpp_device, on_host.get(),
                         cpp_points, array(chosen.ids, chosen.ids == nullptr ? 0 : chosen.id_count, 1, "ids"),
                         light_of(light), at(visibility, "visibility").visibility,
                         run_options_at(chosen.run, cpp_points)));
    });
}
