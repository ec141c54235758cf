// SPDX-License-Identifier: MIT
#include "shading/received_light.hpp"

#include <bit>

#include "camera/camera.hpp"
#include "kernels/shading/received_light.h"

namespace gnomon {
namespace {

constexpr const char* file = "shading/received_light.cl";

}  // namespace

ReceivedLight received_light(const Device& device, const Triangles& triangles, const View& view, const glm::dvec3& area,
                             const Lights& lights, cl_mem bits) {
    cl::Session& session = session_of(device);
    const std::size_t pixels = view.points.count();
    const PointInputs points = point_inputs(view.points);
    ReceivedParams params{.layout = points.layout, .area = {}, .samples = cl_uint(lights.count()), .words = 0};
    params.words = (params.samples + 31) / 32;
    for (int c = 0; c < 3; ++c) params.area[c] = std::bit_cast<std::uint64_t>(area[c]);
    cl::Buffer normals, samples(session, lights.count() * sizeof(Light));
    camera_normals(device, triangles, view, normals);
    static_assert(sizeof(Light) == sizeof(float4), "lights are four floats each");
    session.write(samples.get(), lights.lights().data(), lights.lights().size_bytes());
    ReceivedLight made{{device, pixels}, {device, pixels}, {device, pixels}};
    session.launch(file, "received_from_area", cl::Range::items(pixels), params, points.positions, points.receivers,
                   normals, samples, bits, made.share.buffer(), made.irradiance.buffer(), made.brightness.buffer());
    session.finish();  // the inputs' memory is free again
    return made;
}

void round_sums(cl::Session& session, cl_mem sums, std::size_t count, const cl::Buffer& to) {
    session.launch(file, "received_from_sky", cl::Range::items(count), cl_uint(count), sums, to);
}

}  // namespace gnomon
