// SPDX-License-Identifier: MIT
// gnomon.h: the results that the caller reads as structs. Behind each is an object that owns the values as the C++
// library gave them, and derives from the struct, whose pointers lead into these values.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

namespace {

template <typename From, typename Row>
auto rows_of(const std::vector<From>& all, const Row& row) {
    std::vector<decltype(row(all[0]))> rows;
    for (const From& one : all) rows.push_back(row(one));
    return rows;
}

struct OwnedStatistics : gnomon_statistics {
    explicit OwnedStatistics(Statistics&& statistics) : gnomon_statistics{}, owned(std::move(statistics)) {
        stage_rows = rows_of(owned.stages, [](const StageStatistics& s) {
            return gnomon_stage{s.name.c_str(), s.device_ms, s.wall_ms, s.skipped.c_str()};
        });
        count_rows = rows_of(owned.counts, [](const auto& c) { return gnomon_count{c.first.c_str(), c.second}; });
        stages = stage_rows.data();
        stage_count = stage_rows.size();
        counts = count_rows.data();
        count_count = count_rows.size();
        total_wall_ms = owned.total_wall_ms;
        device_memory_bytes = owned.device_memory_bytes;
    }
    Statistics owned;
    std::vector<gnomon_stage> stage_rows;
    std::vector<gnomon_count> count_rows;
};

struct OwnedDevices : gnomon_device_list {
    OwnedDevices() : gnomon_device_list{}, owned(gnomon::devices()), rows(rows_of(owned, description_of)) {
        devices = rows.data();
        count = rows.size();
    }
    std::vector<DeviceDescription> owned;
    std::vector<gnomon_device_description> rows;
};

/// A technique's description, whose settings and diagnostics stay where they are when the object moves.
struct TechniqueRow {
    explicit TechniqueRow(const TechniqueDescription& technique)
        : settings(
              rows_of(technique.settings,
                      [](const SettingDescription& s) {
                          return gnomon_setting_description{s.name.c_str(), s.default_value.c_str(), s.meaning.c_str()};
                      })),
          diagnostics(rows_of(technique.diagnostics,
                              [](const DiagnosticDescription& d) {
                                  return gnomon_diagnostic_description{d.name.c_str(), d.meaning.c_str()};
                              })),
          row{technique.name.c_str(), technique.summary.c_str(), settings.data(), settings.size(),
              diagnostics.data(),     diagnostics.size(),        technique.exact} {}
    std::vector<gnomon_setting_description> settings;
    std::vector<gnomon_diagnostic_description> diagnostics;
    gnomon_technique_description row;
};

struct OwnedTechniques : gnomon_technique_list {
    OwnedTechniques() : gnomon_technique_list{}, owned(gnomon::techniques()) {
        parts = rows_of(owned, [](const TechniqueDescription& t) { return TechniqueRow(t); });
        rows = rows_of(parts, [](const TechniqueRow& t) { return t.row; });
        techniques = rows.data();
        count = rows.size();
    }
    std::vector<TechniqueDescription> owned;
    std::vector<TechniqueRow> parts;
    std::vector<gnomon_technique_description> rows;
};

gnomon_triangle_signs signs_of(const TriangleSigns& from) {
    gnomon_triangle_signs to{};
    to.triangle = from.triangle;
    std::copy(from.vertices.begin(), from.vertices.end(), to.vertices);
    to.blocks = from.blocks;
    to.is_clear = from.is_clear;
    to.point_side = from.point_side;
    to.light_side = from.light_side;
    std::copy(from.edges.begin(), from.edges.end(), to.edges);
    to.arithmetic = from.arithmetic.c_str();
    to.distance = from.distance;
    return to;
}

struct OwnedExplanation : gnomon_explanation {
    explicit OwnedExplanation(Explanation&& explanation) : gnomon_explanation{}, owned(std::move(explanation)) {
        occluder_rows = rows_of(owned.occluders, signs_of);
        near_miss_rows = rows_of(owned.near_misses, signs_of);
        clear_hit_rows = rows_of(owned.clear_hits, signs_of);
        std::copy(owned.position.begin(), owned.position.end(), position);
        receiver = owned.receiver;
        on_receiver = signs_of(owned.on_receiver);
        eye_side = owned.eye_side;
        is_backfacing = owned.is_backfacing;
        is_consistent = owned.is_consistent();
        visibility = owned.visibility;
        occluders = occluder_rows.data();
        occluder_count = occluder_rows.size();
        near_misses = near_miss_rows.data();
        near_miss_count = near_miss_rows.size();
        clear_hits = clear_hit_rows.data();
        clear_hit_count = clear_hit_rows.size();
        stage = owned.stage.c_str();
        arithmetic = owned.arithmetic.c_str();
    }
    Explanation owned;
    std::vector<gnomon_triangle_signs> occluder_rows, near_miss_rows, clear_hit_rows;
};

struct OwnedViewOfParts : gnomon_view_of_parts {
    OwnedViewOfParts(const Device& device, ViewOfParts&& parts)
        : gnomon_view_of_parts{},
          owned_view{device, parts.view, {device, parts.view.points}},
          owned_triangles{device, std::move(parts.triangles)},
          owned_ids(std::move(parts.ids)) {
        view = &owned_view;
        triangles = &owned_triangles;
        ids = owned_ids.data();
        id_count = owned_ids.size();
    }
    gnomon_view owned_view;
    gnomon_triangles owned_triangles;
    std::vector<std::uint32_t> owned_ids;
};

}  // namespace

namespace gnomon::c {

const gnomon_statistics* new_statistics(Statistics&& statistics) { return new OwnedStatistics(std::move(statistics)); }

gnomon_device_description description_of(const DeviceDescription& from) {
    return {.platform_id = from.platform_id,
            .device_id = from.device_id,
            .selector = from.selector.c_str(),
            .platform = from.platform.c_str(),
            .name = from.name.c_str(),
            .vendor = from.vendor.c_str(),
            .driver_version = from.driver_version.c_str(),
            .opencl_version = from.opencl_version.c_str(),
            .opencl_c_version = from.opencl_c_version.c_str(),
            .type = from.type.c_str(),
            .lacks = from.lacks.c_str(),
            .note = from.note.c_str(),
            .why_default = from.why_default.c_str(),
            .global_memory_bytes = from.global_memory_bytes,
            .largest_allocation_bytes = from.largest_allocation_bytes,
            .compute_units = from.compute_units,
            .has_fp64 = from.has_fp64,
            .shares_host_memory = from.shares_host_memory,
            .is_default = from.is_default};
}

}  // namespace gnomon::c

void gnomon_statistics_destroy(const gnomon_statistics* statistics) {
    delete static_cast<const OwnedStatistics*>(statistics);
}

gnomon_status gnomon_devices_list(const gnomon_device_list** list_out) {
    return result_of(list_out, "list_out", [&] { return new OwnedDevices; });
}

void gnomon_device_list_destroy(const gnomon_device_list* list) { delete static_cast<const OwnedDevices*>(list); }

gnomon_status gnomon_techniques_list(const gnomon_technique_list** list_out) {
    return result_of(list_out, "list_out", [&] { return new OwnedTechniques; });
}

void gnomon_technique_list_destroy(const gnomon_technique_list* list) {
    delete static_cast<const OwnedTechniques*>(list);
}

gnomon_status gnomon_points_explain(const gnomon_points* points, const gnomon_triangles* triangles, size_t index,
                                    gnomon_light light, const gnomon_run_options* options,
                                    const gnomon_explanation** explanation_out) {
    return result_of(explanation_out, "explanation_out", [&] {
        const gnomon_points& c_points = at(points, "points");
        return new OwnedExplanation(explain(c_points.device, at(triangles, "triangles").triangles, c_points.points,
                                            index, light_of(light), run_options_at(options, c_points.points).facing));
    });
}

void gnomon_explanation_destroy(const gnomon_explanation* explanation) {
    delete static_cast<const OwnedExplanation*>(explanation);
}

gnomon_status gnomon_host_scene_look(const gnomon_device* device, const gnomon_host_scene* scene,
                                     const gnomon_camera* camera, uint32_t width, uint32_t height,
                                     const gnomon_view_of_parts** view_out) {
    return result_of(view_out, "view_out", [&] {
        const Device& cpp_device = at(device, "device").device;
        const HostSceneArgument on_host(scene);
        return new OwnedViewOfParts(cpp_device,
                                    look_in_parts(cpp_device, on_host.get(), camera_at(camera), width, height));
    });
}

void gnomon_view_of_parts_destroy(const gnomon_view_of_parts* view) {
    delete static_cast<const OwnedViewOfParts*>(view);
}
