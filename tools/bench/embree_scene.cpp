// SPDX-License-Identifier: MIT
#include "embree_scene.hpp"

#include <fmt/core.h>
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

// By comparisons alone for a texel that lies at most one texture away, as nearly all do.
int wrapped(int texel, int side, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp) return std::clamp(texel, 0, side - 1);
    if (wrap == TextureWrap::repeat && texel >= -side && texel < side) return texel < 0 ? texel + side : texel;
    const int period = wrap == TextureWrap::mirror ? 2 * side : side;
    const int in_period = (texel % period + period) % period;
    return std::min(in_period, period - 1 - in_period + (wrap == TextureWrap::mirror ? 0 : period));
}

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

Mesh::Mesh(const scene::Scene& scene, unsigned threads) : scene_(scene), diagonal_(diagonal_of(scene.triangles)) {
    const std::vector<float>& triangles = scene.triangles;
    const scene::SceneCutOuts& cut_outs = scene.cut_outs;
    Welder welder(triangles.size() / 3);
    const std::size_t count = triangles.size() / 9;
    indices_[0].reserve(3 * count);
    for (std::size_t id = 0; id < count; ++id) {
        const bool is_masked = !cut_outs.empty() && cut_outs.material_of_triangle[id] != no_cut_out;
        for (std::size_t corner = 0; corner < 3; ++corner)
            indices_[is_masked].push_back(welder.index_of(&triangles[9 * id + 3 * corner], vertices_));
        if (!cut_outs.empty()) ids_[is_masked].push_back(std::uint32_t(id));
    }
    device_ = rtcNewDevice(fmt::format("threads={}", threads).c_str());
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

void Mesh::attach(RTCScene scene, const Build& build, unsigned geometry) {
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(mesh, build.flag);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                               3 * sizeof(float), vertices_.size() / 3 - 1);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_[geometry].data(), 0,
                               3 * sizeof(std::uint32_t), indices_[geometry].size() / 3);
    if (geometry == 1) {
        rtcSetGeometryUserData(mesh, this);
        rtcSetGeometryOccludedFilterFunction(mesh, filter);
        rtcSetGeometryIntersectFilterFunction(mesh, filter);
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(scene, mesh, geometry);
    rtcReleaseGeometry(mesh);
}

// Hits on cut-outs: those in a hole do not count.
void Mesh::filter(const RTCFilterFunctionNArguments* hits) {
    const Mesh& mesh = *static_cast<const Mesh*>(hits->geometryUserPtr);
    for (unsigned i = 0; i < hits->N; ++i)
        if (hits->valid[i] == -1 && !mesh.is_opaque(RTCHitN_primID(hits->hit, hits->N, i),
                                                    RTCHitN_u(hits->hit, hits->N, i), RTCHitN_v(hits->hit, hits->N, i)))
            hits->valid[i] = 0;
}

// The look-up of the contract (docs/numerics.md, 15), in float.
bool Mesh::is_opaque(std::uint32_t masked, float u, float v) const {
    const std::uint32_t id = ids_[1][masked];
    const CutOutMaterial& material = scene_.cut_outs.materials[scene_.cut_outs.material_of_triangle[id]];
    const float weights[] = {1 - u - v, u, v};
    float alpha = material.alpha_factor;
    if (!scene_.cut_outs.corner_alphas.empty()) {
        const float* corners = &scene_.cut_outs.corner_alphas[3 * std::size_t(id)];
        alpha *= weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    }
    if (material.texture == no_texture) return alpha >= material.cutoff;
    const auto& texture = scene_.cut_outs.textures[material.texture];
    const float* at = &scene_.texture_coordinates[6 * std::size_t(id)];
    const float x = (weights[0] * at[0] + weights[1] * at[2] + weights[2] * at[4]) * float(texture.width);
    const float y = (weights[0] * at[1] + weights[1] * at[3] + weights[2] * at[5]) * float(texture.height);
    const auto row = [&](int j) {
        return &texture.alpha[std::size_t(wrapped(j, int(texture.height), material.wrap_v)) * texture.width];
    };
    const auto column = [&](int i) { return wrapped(i, int(texture.width), material.wrap_u); };
    if (material.filter == TextureFilter::nearest)
        return float(row(int(std::floor(y)))[column(int(std::floor(x)))]) * alpha >= 255 * material.cutoff;
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f), f = x - 0.5f - left, g = y - 0.5f - top;
    const int columns[] = {column(int(left)), column(int(left) + 1)};
    const std::uint8_t *upper = row(int(top)), *lower = row(int(top) + 1);
    const float above = float(upper[columns[0]]) * (1 - f) + float(upper[columns[1]]) * f;
    const float below = float(lower[columns[0]]) * (1 - f) + float(lower[columns[1]]) * f;
    return (above * (1 - g) + below * g) * alpha >= 255 * material.cutoff;
}

std::unique_ptr<Scene> Mesh::build(const Build& build) {
    const std::int64_t before = bytes_;
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, build.scene_flags);
    rtcSetSceneBuildQuality(scene, build.flag);
    attach(scene, build, 0);
    if (!indices_[1].empty()) attach(scene, build, 1);
    rtcCommitScene(scene);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
        throw Error(fmt::format("Embree could not build its tree: error {}", error));
    return std::make_unique<Scene>(scene, static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_ - before)));
}

}  // namespace gnomon::bench::embree
