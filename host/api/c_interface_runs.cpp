// SPDX-License-Identifier: MIT
// gnomon.h: techniques, views, samples and runs in parts.
#include "api/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

namespace {

Technique& technique_at(gnomon_technique* technique) { return *at(technique, "technique").technique; }

/// What look() gave, and what belongs to it.
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
                                   cl_event* event_out, const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        results.finish(at(technique, "technique").device,
                       technique_at(technique).run(at(triangles, "triangles").triangles, at(points, "points").points,
                                                   light_of(light), at(visibility, "visibility").visibility));
    });
}

gnomon_status gnomon_technique_run_lights(gnomon_technique* technique, const gnomon_triangles* triangles,
                                          const gnomon_points* points, const gnomon_light* lights,
                                          const gnomon_visibility* const* visibilities, size_t count,
                                          cl_event* event_out, const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out);
        if (statistics_out != nullptr) std::fill_n(statistics_out, count, nullptr);
        std::vector<Statistics> statistics =
            technique_at(technique).run_lights(at(triangles, "triangles").triangles, at(points, "points").points,
                                               lights_at(lights, count), visibilities_at(visibilities, count));
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

gnomon_status gnomon_technique_forget(gnomon_technique* technique) {
    return guarded([&] { technique_at(technique).forget(); });
}

gnomon_status gnomon_technique_diagnose(gnomon_technique* technique, const char* name,
                                        const gnomon_triangles* triangles, const gnomon_points* points,
                                        gnomon_light light, uint8_t* rgba_out) {
    return guarded([&] {
        const std::vector<std::uint8_t> drawn = technique_at(technique).diagnose(
            &at(name, "name"), at(triangles, "triangles").triangles, at(points, "points").points, light_of(light));
        std::copy(drawn.begin(), drawn.end(), &at(rgba_out, "rgba_out"));
    });
}

// ---- Facing by a side that the caller gives -------------------------------------------------------------------------

gnomon_status gnomon_face_by_normals(const gnomon_points* points, const float* normals, gnomon_light light,
                                     const gnomon_visibility* visibility, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        const gnomon_points& of = at(points, "points");
        face_by_normals(of.device, of.points, array(normals, of.points.count(), 3, "normals"), light_of(light),
                        at(visibility, "visibility").visibility);
        results.finish(of.device);
    });
}

gnomon_status gnomon_face_by_normals_buffer(const gnomon_points* points, cl_mem normals,
                                            const gnomon_point_layout* layout, gnomon_light light,
                                            const gnomon_visibility* visibility, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        const gnomon_points& of = at(points, "points");
        face_by_normals(of.device, of.points, normals, layout_or_packed(layout), light_of(light),
                        at(visibility, "visibility").visibility);
        results.finish(of.device);
    });
}

gnomon_status gnomon_face_by_winding(const gnomon_triangles* triangles, const gnomon_points* points, gnomon_light light,
                                     const gnomon_visibility* visibility, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        const gnomon_points& of = at(points, "points");
        face_by_winding(of.device, at(triangles, "triangles").triangles, of.points, light_of(light),
                        at(visibility, "visibility").visibility);
        results.finish(of.device);
    });
}

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

gnomon_status gnomon_face_by_fans(const gnomon_triangles* triangles, const gnomon_vertex_fans* fans, gnomon_light light,
                                  const float* up, const gnomon_visibility* visibility, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        const gnomon_triangles& mesh = at(triangles, "triangles");
        face_by_fans(mesh.device, mesh.triangles, at(fans, "fans").fans, light_of(light),
                     at(visibility, "visibility").visibility,
                     up == nullptr ? std::nullopt : std::optional(float3_at(up, "up")));
        results.finish(mesh.device);
    });
}

// ---- Views ----------------------------------------------------------------------------------------------------------

gnomon_status gnomon_look(const gnomon_device* device, const gnomon_triangles* triangles, const gnomon_camera* camera,
                          uint32_t width, uint32_t height, gnomon_view** view_out, cl_event* event_out,
                          const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        gnomon_view*& out = result_at(view_out, "view_out");
        const Device& on = at(device, "device").device;
        give_view(on, look(on, at(triangles, "triangles").triangles, camera_at(camera), width, height), out, results);
    });
}

void gnomon_view_destroy(gnomon_view* view) { delete view; }

gnomon_status gnomon_view_points(const gnomon_view* view, const gnomon_points** points_out) {
    return result_of(points_out, "points_out", [&] { return &at(view, "view").points; });
}

gnomon_status gnomon_view_read(const gnomon_view* view, const gnomon_triangles* triangles, float* positions_out,
                               float* normals_out, uint32_t* receivers_out) {
    return guarded([&] {
        const gnomon_view& of = at(view, "view");
        const ViewOnHost host = read(of.device, at(triangles, "triangles").triangles, of.view);
        if (positions_out != nullptr) std::copy(host.position.begin(), host.position.end(), positions_out);
        if (normals_out != nullptr) std::copy(host.normal.begin(), host.normal.end(), normals_out);
        if (receivers_out != nullptr) std::copy(host.receiver.begin(), host.receiver.end(), receivers_out);
    });
}

gnomon_status gnomon_view_shade(const gnomon_view* view, const gnomon_triangles* triangles, const gnomon_light* lights,
                                const gnomon_visibility* const* visibilities, size_t light_count,
                                const gnomon_materials* materials, uint8_t* rgba_out) {
    return guarded([&] {
        const gnomon_view& of = at(view, "view");
        const gnomon_materials& from = at(materials, "materials");
        const auto ids = array(from.triangle_material, from.triangle_count, 1, "materials.triangle_material");
        const auto colors = array(from.base_color, from.material_count, 3, "materials.base_color");
        Materials copied{{ids.begin(), ids.end()}, std::vector<Float3>(from.material_count)};
        for (std::size_t i = 0; i < colors.size(); ++i) copied.base_color[i / 3][i % 3] = colors[i];
        const std::vector<std::uint8_t> picture =
            shade(of.device, at(triangles, "triangles").triangles, of.view, visibilities_at(visibilities, light_count),
                  copied, lights_at(lights, light_count));
        std::copy(picture.begin(), picture.end(), &at(rgba_out, "rgba_out"));
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
        gnomon_camera_pass& of = at(pass, "pass");
        give_view(of.device, of.pass.look(at(triangles, "triangles").triangles, camera_at(camera), width, height), out,
                  results);
    });
}

// ---- Several samples per pixel --------------------------------------------------------------------------------------

gnomon_status gnomon_sample_pattern(uint32_t samples, gnomon_sample_offset* offsets_out) {
    return guarded([&] {
        const std::span<const SampleOffset> pattern = sample_pattern(samples);
        std::transform(pattern.begin(), pattern.end(), &at(offsets_out, "offsets_out"), [](const SampleOffset& s) {
            return gnomon_sample_offset{s.x, s.y};
        });
    });
}

gnomon_status gnomon_run_samples(gnomon_technique* technique, const gnomon_triangles* triangles,
                                 const gnomon_view* view, gnomon_light light, uint32_t samples,
                                 const gnomon_visibility* mean, gnomon_sample_sink sink, void* user_data,
                                 cl_event* event_out, const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        Technique& with = technique_at(technique);
        const Device& on = technique->device;
        SampleSink forward;
        if (sink != nullptr)
            forward = [&](const Points& points) {
                const gnomon_points shown{on, points};
                if (sink(&shown, user_data) != 0) throw Stopped();
            };
        results.finish(on, run_samples(with, on, at(triangles, "triangles").triangles, at(view, "view").view,
                                       light_of(light), samples, at(mean, "mean").visibility, forward));
    });
}

// ---- Scenes larger than the device's memory -------------------------------------------------------------------------

gnomon_status gnomon_run_in_parts(const gnomon_device* device, const char* technique, const gnomon_setting* settings,
                                  size_t setting_count, const float* vertices, size_t count,
                                  const gnomon_cut_outs* cut_outs, const gnomon_points* points, const uint32_t* ids,
                                  size_t id_count, gnomon_light light, const gnomon_visibility* visibility,
                                  const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(nullptr, statistics_out);
        const Device& on = at(device, "device").device;
        const auto chosen = array(settings, setting_count, 1, "settings");
        const CutOutsArgument masks(cut_outs, count);
        results.finish(on, run_in_parts([&] { return make_with_settings(on, technique, chosen); }, on,
                                        array(vertices, count, 9, "vertices"), at(points, "points").points,
                                        array(ids, ids == nullptr ? 0 : id_count, 1, "ids"), light_of(light),
                                        at(visibility, "visibility").visibility, masks.get()));
    });
}
