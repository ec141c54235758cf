// SPDX-License-Identifier: MIT
#include "trace/provenance.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "trace/provenance.cl";

struct Color {
    std::uint8_t red, green, blue;
};
struct Colors {
    Color lit, shadowed;
};

// In the order of the decisions; docs/techniques.md has the legend. What is common is blue or grey, what is rare is
// bright: the harder, the warmer.
constexpr Colors legend[PROVENANCE_COUNT] = {
    {{255, 0, 255}, {255, 0, 255}},      // none: must not appear
    {{255, 0, 255}, {255, 0, 255}},      // none, doubtful
    {{221, 230, 240}, {221, 230, 240}},  // lit by the filter
    {{160, 220, 120}, {60, 130, 40}},    // the predicate in float
    {{255, 215, 80}, {200, 140, 0}},     // in double
    {{255, 110, 90}, {190, 0, 30}},      // in integers
    {{70, 120, 175}, {70, 120, 175}},    // in shadow by the filter
    {{25, 50, 110}, {25, 50, 110}},      // by the map
    {{220, 150, 255}, {130, 40, 220}},   // second look
    {{20, 20, 20}, {20, 20, 20}},        // faces away
    {{255, 255, 255}, {255, 255, 255}},  // not asked
    {{96, 96, 96}, {96, 96, 96}},        // absent
};

}  // namespace

void Provenance::facing(cl::Session& session, const PointInputs& points, cl_mem visibility) {
    provenance_.reserve(session, points.layout.count * sizeof(cl_uint));
    session.launch(file, "decisions_of_facing", cl::Range::items(points.layout.count), points.layout, points.positions,
                   visibility, provenance_);
}

void Provenance::trace(cl::Session& session, const LightFrame& light_frame, cl_uint frame, const PointInputs& points,
                       const cl::Buffer& projection, const cl::Buffer* map, cl_mem visibility) {
    session.launch(file, "decisions_of_trace", cl::Range::items(points.layout.count / session.lanes() + 1), light_frame,
                   frame, points.layout, projection, cl_uint(map != nullptr), points.positions,
                   map != nullptr ? *map : provenance_, visibility, provenance_);
}

void Provenance::exact_trace(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points,
                             const Light& light, const Trace& trace, cl_mem visibility, const cl::Buffer& counters) {
    session.launch(file, "decisions_of_pairs", cl::Range::items(trace.capacity()), float4_of(light.xyzw), points.layout,
                   triangles.first_float, trace.capacity(), points.positions, triangles.vertices, trace.queue(),
                   visibility, provenance_, counters);
}

void Provenance::queue_overflow(cl::Session& session, const LightFrame& light_frame, cl_uint frame,
                                const PointInputs& points, cl_mem visibility) {
    session.launch(file, "decisions_of_second_look", cl::Range::items(points.layout.count / session.lanes() + 1),
                   light_frame, frame, points.layout, points.positions, visibility, provenance_);
}

std::vector<std::uint32_t> Provenance::read(cl::Session& session, std::size_t count) const {
    std::vector<std::uint32_t> provenance(count);
    session.read(provenance_.get(), provenance.data(), count * sizeof(std::uint32_t));
    return provenance;
}

std::vector<std::uint8_t> provenance_colors(std::span<const std::uint32_t> provenance,
                                            std::span<const float> visibility) {
    std::vector<std::uint8_t> rgba;
    rgba.reserve(4 * provenance.size());
    for (std::size_t i = 0; i < provenance.size(); ++i) {
        const Colors& colors = legend[provenance[i]];
        const Color& color = visibility[i] == 0.0f ? colors.shadowed : colors.lit;
        rgba.insert(rgba.end(), {color.red, color.green, color.blue, 255});
    }
    return rgba;
}

}  // namespace gnomon
