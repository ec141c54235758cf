// SPDX-License-Identifier: MIT
// Stage received_light: what of an area light's or the sky's light reaches each pixel
// (kernels/shading/received_light.h).
#pragma once

#include "query/inputs.hpp"
#include "query/vectors.hpp"

namespace gnomon {

/// Per pixel, on the device, in double arithmetic and rounded once. n samples of an area light, each at a distance r
/// along the unit vector l from the point: f = max(0, -l . the light's normal) / r^2, c = max(0, l . point's normal); V
/// is 1 where the sample reaches the point, and 0 else. Sums go over the samples in their order. The sky has 1, 0 and
/// 0.
struct ReceivedLight {
    Visibility share;       ///< sum of V f c over the sum of f c; 0 where that is 0: no light to shadow
    Visibility irradiance;  ///< area / n times the sum of V f c, in W/m^2
    Visibility brightness;  ///< share times area / n times the sum of f: for shade(), which has the cosine
};
/// `area`: edge_a x edge_b, as long as the light's area. `lights`: its samples by area_light(). `bits`: those of
/// LightsOutputs for the view's points.
ReceivedLight received_light(const Device& device, const Triangles& triangles, const View& view, const glm::dvec3& area,
                             const Lights& lights, cl_mem bits);

/// Writes float32 of the float64 sums of a table of lights.
void round_sums(cl::Session& session, cl_mem sums, std::size_t count, const cl::Buffer& to);

}  // namespace gnomon
