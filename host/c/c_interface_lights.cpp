// SPDX-License-Identifier: MIT
// gnomon.h: many lights at once.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

struct gnomon_lights {
    Lights table;
};

namespace {

template <typename Make>
gnomon_status made_lights(gnomon_lights** lights_out, const Make& make) {
    return result_of(lights_out, "lights_out", [&] { return new gnomon_lights{make()}; });
}

const Lights& table_at(const gnomon_lights* lights) { return at(lights, "lights").table; }

template <typename T>
void copy(const std::vector<T>& from, T* to) {
    if (to != nullptr) std::copy(from.begin(), from.end(), to);
}

}  // namespace

gnomon_status gnomon_lights_create(const gnomon_light* lights, const float* weights, size_t count,
                                   gnomon_lights** lights_out) {
    return made_lights(lights_out, [&] {
        std::vector<Light> all = lights_at(lights, count);
        const auto given = weights != nullptr ? array(weights, count, 1, "weights") : std::span<const float>{};
        return Lights(std::move(all), {given.begin(), given.end()});
    });
}

gnomon_status gnomon_lights_sun_disk(const float direction[3], double angle_degrees, uint32_t samples,
                                     gnomon_lights** lights_out) {
    return made_lights(lights_out, [&] { return sun_disk(float3_at(direction, "direction"), angle_degrees, samples); });
}

gnomon_status gnomon_lights_area(const float corner[3], const float edge_a[3], const float edge_b[3], uint32_t samples,
                                 gnomon_lights** lights_out) {
    return made_lights(lights_out, [&] {
        return area_light(float3_at(corner, "corner"), float3_at(edge_a, "edge_a"), float3_at(edge_b, "edge_b"),
                          samples);
    });
}

gnomon_status gnomon_lights_sky(const float up[3], const float north[3], uint32_t division,
                                gnomon_lights** lights_out) {
    return made_lights(lights_out,
                       [&] { return sky_patches(float3_at(up, "up"), float3_at(north, "north"), division); });
}

void gnomon_lights_destroy(gnomon_lights* lights) { delete lights; }

gnomon_status gnomon_lights_count(const gnomon_lights* lights, size_t* count_out) {
    return guarded([&] { at(count_out, "count_out") = table_at(lights).count(); });
}

gnomon_status gnomon_lights_read(const gnomon_lights* lights, gnomon_light* lights_out, float* weights_out) {
    return guarded([&] {
        const Lights& table = table_at(lights);
        for (std::size_t i = 0; lights_out != nullptr && i < table.count(); ++i)
            std::copy_n(table.lights()[i].xyzw.begin(), 4, lights_out[i].xyzw);
        if (weights_out != nullptr) std::copy_n(table.weights().begin(), table.count(), weights_out);
    });
}

gnomon_status gnomon_lights_rounding(const gnomon_lights* lights, int32_t* exponent_out, double* largest_out) {
    return guarded([&] {
        const Lights& table = table_at(lights);
        give(exponent_out, int32_t(table.exponent()));
        give(largest_out, table.largest_rounding());
    });
}

gnomon_status gnomon_technique_run_light_table(gnomon_technique* technique, const gnomon_triangles* triangles,
                                               const gnomon_points* points, const gnomon_lights* lights,
                                               const gnomon_light_table_buffers* outputs,
                                               const gnomon_run_options* options,
                                               const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(nullptr, statistics_out);
        const gnomon_technique& c_technique = at(technique, "technique");
        const gnomon_light_table_buffers& to = sized_at(outputs, "outputs");
        const Points& cpp_points = at(points, "points").points;
        results.finish(c_technique.device, c_technique.technique->run_light_table(
                                               at(triangles, "triangles").triangles, cpp_points, table_at(lights),
                                               {to.bits, to.counts, to.sums, to.first_lit, to.last_lit, to.cosines},
                                               run_options_at(options, cpp_points)));
    });
}

gnomon_status gnomon_technique_run_light_table_to_host(gnomon_technique* technique, const gnomon_triangles* triangles,
                                                       const gnomon_points* points, const gnomon_lights* lights,
                                                       const gnomon_light_table_arrays* outputs,
                                                       const gnomon_run_options* options,
                                                       const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(nullptr, statistics_out);
        const gnomon_technique& c_technique = at(technique, "technique");
        const gnomon_light_table_arrays& to = sized_at(outputs, "outputs");
        const Points& cpp_points = at(points, "points").points;
        LightsOnHost found = run_light_table_to_host(*c_technique.technique, at(triangles, "triangles").triangles,
                                                     cpp_points, table_at(lights),
                                                     {.bits = to.bits != nullptr,
                                                      .counts = to.counts != nullptr,
                                                      .sums = to.sums != nullptr,
                                                      .first_lit = to.first_lit != nullptr,
                                                      .last_lit = to.last_lit != nullptr,
                                                      .cosines = to.cosines},
                                                     run_options_at(options, cpp_points));
        results.finish(c_technique.device, std::move(found.statistics));
        copy(found.bits, to.bits);
        copy(found.counts, to.counts);
        copy(found.sums, to.sums);
        copy(found.first_lit, to.first_lit);
        copy(found.last_lit, to.last_lit);
    });
}

gnomon_status gnomon_technique_run_mean(gnomon_technique* technique, const gnomon_triangles* triangles,
                                        const gnomon_points* points, const gnomon_lights* lights,
                                        const gnomon_visibility* mean, const gnomon_run_options* options,
                                        cl_event* event_out, const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        const gnomon_technique& c_technique = at(technique, "technique");
        const Points& cpp_points = at(points, "points").points;
        results.finish(c_technique.device,
                       run_mean(*c_technique.technique, at(triangles, "triangles").triangles, cpp_points,
                                table_at(lights), at(mean, "mean").visibility, run_options_at(options, cpp_points)));
    });
}
