// SPDX-License-Identifier: MIT
#include "embree_scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include <gnomon.hpp>

namespace gnomon::bench::embree {

namespace {

// Vertices of the same bits get the same index: a hash table with open addressing, at most half full.
class Welder {
public:
    explicit Welder(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), free) {}

    std::uint32_t index_of(const float* vertex, std::vector<float>& vertices) {
        std::uint64_t hash = 14695981039346656037ull;
        for (int c = 0; c < 3; ++c) hash = (hash ^ std::bit_cast<std::uint32_t>(vertex[c])) * 0x9E3779B97F4A7C15ull;
        for (std::size_t slot = (hash >> 20) & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
            if (slots_[slot] == free) {
                slots_[slot] = static_cast<std::uint32_t>(vertices.size() / 3);
                vertices.insert(vertices.end(), vertex, vertex + 3);
                return slots_[slot];
            }
            const float* other = &vertices[3 * std::size_t(slots_[slot])];
            if (std::equal(vertex, vertex + 3, other, [](float a, float b) {
                    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
                }))
                return slots_[slot];
        }
    }

private:
    static constexpr std::uint32_t free = ~0u;
    std::vector<std::uint32_t> slots_;
};

double diagonal_of(std::span<const float> triangles) {
    double low[3], high[3];
    std::fill_n(low, 3, std::numeric_limits<double>::infinity());
    std::fill_n(high, 3, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (std::isfinite(triangles[i])) {
            low[i % 3] = std::min<double>(low[i % 3], triangles[i]);
            high[i % 3] = std::max<double>(high[i % 3], triangles[i]);
        }
    return triangles.empty() ? 0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

}  // namespace

Mesh::Mesh(std::span<const float> triangles, unsigned threads) : diagonal_(diagonal_of(triangles)) {
    Welder welder(triangles.size() / 3);
    indices_.reserve(triangles.size() / 3);
    for (std::size_t i = 0; i < triangles.size(); i += 3) indices_.push_back(welder.index_of(&triangles[i], vertices_));
    device_ = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (device_ == nullptr) throw Error("Embree could not be started");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* bytes, ssize_t change, bool) {
            *static_cast<std::atomic<std::int64_t>*>(bytes) += change;
            return true;
        },
        &bytes_);
    vertices_.resize(vertices_.size() + 4);
}

std::unique_ptr<Scene> Mesh::build(const Build& build) {
    const std::int64_t before = bytes_;
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, build.scene_flags);
    rtcSetSceneBuildQuality(scene, build.flag);
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(mesh, build.flag);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                               3 * sizeof(float), vertices_.size() / 3 - 1);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0,
                               3 * sizeof(std::uint32_t), indices_.size() / 3);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
        throw Error("Embree could not build its tree: error " + std::to_string(error));
    return std::make_unique<Scene>(scene, static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_ - before)));
}

}  // namespace gnomon::bench::embree
