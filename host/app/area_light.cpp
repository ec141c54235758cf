// SPDX-License-Identifier: MIT
#include "area_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "query/vectors.hpp"

namespace gnomon::app {
namespace {

/// edge_a x edge_b, as long as its area.
Double3 area_vector(const AreaLight& source) {
    return cross({source.edge_a[0], source.edge_a[1], source.edge_a[2]},
                 {source.edge_b[0], source.edge_b[1], source.edge_b[2]});
}

/// The three sums of one point.
struct Sums {
    double reaching = 0, facing = 0, towards = 0;  ///< of V f c, of f c, of f
};

class LitPoint {
public:
    LitPoint(const Double3& area, const float* position, const float* normal)
        : area_(area), position_{position[0], position[1], position[2]}, normal_{normal[0], normal[1], normal[2]} {}

    void add(const Light& sample, bool reaches, Sums& sums) const {
        const Double3 l{sample.xyzw[0] - position_[0], sample.xyzw[1] - position_[1], sample.xyzw[2] - position_[2]};
        const double square = dot(l, l);
        if (square == 0) return;
        // area . l = |area| r cosine, so f times the area is this over r^3.
        const double f = std::max(0.0, -dot(area_, l)) / (square * std::sqrt(square));
        const double fc = f * std::max(0.0, dot(normal_, l)) / std::sqrt(square);
        sums.towards += f;
        sums.facing += fc;
        if (reaches) sums.reaching += fc;
    }

private:
    const Double3& area_;
    Double3 position_, normal_;
};

}  // namespace

Float3 AreaLight::centre() const {
    Float3 at{};
    for (std::size_t c = 0; c < 3; ++c)
        at[c] = static_cast<float>(corner[c] + 0.5 * (double(edge_a[c]) + double(edge_b[c])));
    return at;
}

void AreaLight::require_area() const {
    const Double3 area = area_vector(*this);
    if (!(dot(area, area) > 0)) throw Error("the area light has no area: its two edges must not be parallel");
}

ReceivedLight received_light(const AreaLight& source, const Lights& lights, const ViewOnHost& view,
                             const std::vector<std::uint32_t>& bits) {
    const Double3 area = area_vector(source);
    const std::size_t count = view.receiver.size(), samples = lights.count(), words = (samples + 31) / 32;
    ReceivedLight light;
    for (auto* values : {&light.share, &light.irradiance, &light.brightness}) values->assign(count, 0.0f);
    for (std::size_t pixel = 0; pixel < count; ++pixel) {
        if (view.receiver[pixel] == no_receiver) {
            light.share[pixel] = 1;
            continue;
        }
        const LitPoint point(area, &view.position[3 * pixel], &view.normal[3 * pixel]);
        Sums sums;
        for (std::size_t i = 0; i < samples; ++i)
            point.add(lights.lights()[i], (bits[pixel * words + i / 32] >> (i % 32) & 1u) != 0, sums);
        if (sums.facing == 0) continue;
        const double share = sums.reaching / sums.facing;
        light.share[pixel] = static_cast<float>(share);
        light.irradiance[pixel] = static_cast<float>(sums.reaching / double(samples));
        light.brightness[pixel] = static_cast<float>(share * sums.towards / double(samples));
    }
    return light;
}

}  // namespace gnomon::app
