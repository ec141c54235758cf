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

// In the order of the PROVENANCE_ values; docs/techniques.md has the legend. Common colours are blue or grey, rare ones
// bright: the harder the decision, the warmer.
constexpr Colors legend[PROVENANCE_COUNT] = {
    {{255, 0, 255}, {255, 0, 255}},      // none: must not appear
    {{255, 0, 255}, {255, 0, 255}},      // none, may shadow itself
    {{221, 230, 240}, {221, 230, 240}},  // lit by the filter
    {{160, 220, 120}, {60, 130, 40}},    // the predicate in float
    {{255, 215, 80}, {200, 140, 0}},     // in double
    {{255, 110, 90}, {190, 0, 30}},      // in integers
    {{70, 120, 175}, {70, 120, 175}},    // in shadow by the filter
    {{25, 50, 110}, {25, 50, 110}},      // by the map
    {{220, 150, 255}, {130, 40, 220}},   // queue overflow
    {{20, 20, 20}, {20, 20, 20}},        // backfacing
    {{255, 255, 255}, {255, 255, 255}},  // not traced
    {{96, 96, 96}, {96, 96, 96}},        // absent
};

}  // namespace

void Provenance::record(cl::Session& session, Moment moment, const TraceInputs& inputs, const Trace& trace) {
    const PointInputs& points = inputs.points;
    const TraceParams params = trace.params(inputs);
    const auto blocks = session.blocks(points.layout.count);
    if (moment == Moment::after_facing) {
        provenance_.reserve(session, points.layout.count * sizeof(cl_uint));
        session.launch(file, "provenance_of_facing", cl::Range::items(points.layout.count), points.layout,
                       points.positions, inputs.visibility, provenance_);
    } else if (moment == Moment::after_trace) {
        session.launch(file, "provenance_of_trace", blocks, params, inputs.projections, points.positions,
                       inputs.map != nullptr ? *inputs.map : provenance_, inputs.visibility, provenance_);
    } else if (moment == Moment::after_exact_trace) {
        session.launch(inputs.triangles.kernel(file, "provenance_of_pairs"), cl::Range::items(trace.capacity()), params,
                       points.positions, inputs.triangles.vertices, trace.queue(), inputs.visibility, provenance_,
                       inputs.counters);
    } else {
        session.launch(file, "provenance_of_overflow", blocks, params, points.positions, inputs.visibility,
                       provenance_);
    }
}

std::vector<std::uint32_t> Provenance::read(cl::Session& session, std::size_t count) const {
    return session.read_values<std::uint32_t>(provenance_.get(), count);
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
