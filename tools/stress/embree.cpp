// SPDX-License-Identifier: MIT
// Embree 3, one ray at a time.
#include "embree.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "reference/parallel.hpp"

namespace stress {
namespace {

/// The largest coordinate that Embree's manual allows; Debian's build stops the program beyond it.
constexpr float LARGEST = 1.844e18f;

/// A ray carries its point's receiver as its id.
void pass_over_receiver(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned i = 0; i < arguments->N; ++i)
        if (RTCHitN_primID(arguments->hit, arguments->N, i) == RTCRayN_id(arguments->ray, arguments->N, i))
            arguments->valid[i] = 0;
}

}  // namespace

struct EmbreeScene::Handles {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
};

std::string embree_version() { return "Embree " RTC_VERSION_STRING; }

EmbreeScene::EmbreeScene(std::span<const float> triangles, EmbreeFlags flags) : handles_(std::make_unique<Handles>()) {
    handles_->device = rtcNewDevice(nullptr);
    if (!handles_->device) throw std::runtime_error("Embree could not open its device");
    const std::size_t count = triangles.size() / 9;
    RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (count > 0) {
        auto* vertices = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * count));
        auto* indices = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count));
        if (!vertices || !indices) throw std::runtime_error("Embree has too little memory for the triangles");
        std::copy(triangles.begin(), triangles.end(), vertices);
        for (unsigned i = 0; i < 3 * count; ++i) indices[i] = i;
    }
    rtcSetGeometryOccludedFilterFunction(geometry, pass_over_receiver);
    rtcCommitGeometry(geometry);
    handles_->scene = rtcNewScene(handles_->device);
    rtcSetSceneFlags(handles_->scene, flags == EmbreeFlags::robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcAttachGeometry(handles_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(handles_->scene);
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(handles_->scene);
    rtcReleaseDevice(handles_->device);
}

std::vector<std::uint8_t> EmbreeScene::shadowed(std::span<const float> points, std::span<const std::uint32_t> receivers,
                                                const support::Light& light, double offset) const {
    std::vector<std::uint8_t> result(points.size() / 3);
    const auto ask = [&](std::size_t i) -> std::uint8_t {
        RTCRay ray{};
        ray.org_x = points[3 * i], ray.org_y = points[3 * i + 1], ray.org_z = points[3 * i + 2];
        const bool is_point_light = light[3] != 0;
        ray.dir_x = is_point_light ? light[0] - ray.org_x : light[0];
        ray.dir_y = is_point_light ? light[1] - ray.org_y : light[1];
        ray.dir_z = is_point_light ? light[2] - ray.org_z : light[2];
        ray.tnear = static_cast<float>(offset / std::hypot(double(ray.dir_x), double(ray.dir_y), double(ray.dir_z)));
        ray.tfar = is_point_light ? 1 : std::numeric_limits<float>::infinity();
        ray.mask = 0xFFFFFFFFu;
        ray.id = receivers.empty() ? reference::NO_RECEIVER : receivers[i];
        for (const float x : {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z})
            if (!(std::fabs(x) < LARGEST)) return BEYOND_EMBREE;
        if (!(ray.tnear < ray.tfar)) return 0;  // no ray is left
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(handles_->scene, &context, &ray);
        return ray.tfar < 0;
    };
    reference::for_chunks(result.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) result[i] = ask(i);
    });
    return result;
}

}  // namespace stress
