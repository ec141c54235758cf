// SPDX-License-Identifier: MIT
// The functions of gnomon.h for several samples per pixel.
#include "c/c_interface.hpp"

using namespace gnomon;
using namespace gnomon::c;

gnomon_status gnomon_sample_pattern(uint32_t samples, gnomon_sample_offset* offsets_out) {
    return guarded([&] {
        const std::span<const SampleOffset> pattern = sample_pattern(samples);
        std::transform(pattern.begin(), pattern.end(), &at(offsets_out, "offsets_out"), [](const SampleOffset& s) {
            return gnomon_sample_offset{s.x, s.y};
        });
    });
}

gnomon_status gnomon_technique_run_samples(gnomon_technique* technique, const gnomon_triangles* triangles,
                                           const gnomon_view* view, gnomon_light light, const gnomon_visibility* mean,
                                           const gnomon_samples_options* options, cl_event* event_out,
                                           const gnomon_statistics** statistics_out) {
    return guarded([&] {
        WorkResults results(event_out, statistics_out);
        const gnomon_samples_options& chosen = sized_or(options, "options", GNOMON_SAMPLES_OPTIONS_INIT);
        gnomon_technique& c_technique = at(technique, "technique");
        const Device& cpp_device = c_technique.device;
        SampleSink forward;
        if (chosen.sink != nullptr)
            forward = [&](const Points& points) {
                const gnomon_points shown{cpp_device, points};
                if (chosen.sink(&shown, chosen.user_data) != 0) throw Stopped();
            };
        results.finish(cpp_device,
                       run_samples(*c_technique.technique, at(triangles, "triangles").triangles, at(view, "view").view,
                                   light_of(light), chosen.samples, at(mean, "mean").visibility, forward));
    });
}
