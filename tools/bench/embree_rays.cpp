// SPDX-License-Identifier: MIT
#include "embree_rays.hpp"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

namespace gnomon::bench::embree {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t block_side = 4;

struct CoherentContext : RTCIntersectContext {
    CoherentContext() {
        rtcInitIntersectContext(this);
        flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
};

struct PacketOf8 {
    static constexpr std::size_t width = 8;
    using Ray = RTCRay8;
    using RayHit = RTCRayHit8;
    static constexpr auto occluded = rtcOccluded8;
    static constexpr auto intersect = rtcIntersect8;
};
struct PacketOf16 {
    static constexpr std::size_t width = 16;
    using Ray = RTCRay16;
    using RayHit = RTCRayHit16;
    static constexpr auto occluded = rtcOccluded16;
    static constexpr auto intersect = rtcIntersect16;
};

// w = 0: a direction without end; w = 1: from the point to the light.
float last_of(const std::array<float, 4>& light) { return light[3] == 0 ? infinity : 1; }

float length_of(const std::array<float, 4>& light, float x, float y, float z) {
    return std::hypot(light[0] - light[3] * x, light[1] - light[3] * y, light[2] - light[3] * z);
}

// Only what differs from packet to packet is written for each of them.
template <typename Traits>
void occluded_by_packets(const ShadowRays& rays, RTCScene scene, const RayPoints& points, std::size_t first,
                         std::size_t count, std::uint8_t* lit) {
    constexpr std::size_t width = Traits::width;
    alignas(64) typename Traits::Ray packet{};
    alignas(64) int valid[width];
    std::fill_n(valid, width, -1);
    std::fill_n(packet.mask, width, ~0u);
    CoherentContext context;
    const auto& light = rays.light;
    for (std::size_t i = first; i < first + count; i += width) {
        for (std::size_t lane = 0; lane < width; ++lane) {
            const float x = points.x[i + lane], y = points.y[i + lane], z = points.z[i + lane];
            packet.org_x[lane] = x;
            packet.org_y[lane] = y;
            packet.org_z[lane] = z;
            packet.dir_x[lane] = light[0] - light[3] * x;
            packet.dir_y[lane] = light[1] - light[3] * y;
            packet.dir_z[lane] = light[2] - light[3] * z;
            packet.tfar[lane] = last_of(light);
        }
        if (rays.offset != 0)
            for (std::size_t lane = 0; lane < width; ++lane)
                packet.tnear[lane] =
                    rays.offset / length_of(light, points.x[i + lane], points.y[i + lane], points.z[i + lane]);
        Traits::occluded(valid, scene, &context, &packet);
        const std::size_t lanes = std::min(width, first + count - i);
        for (std::size_t lane = 0; lane < lanes; ++lane) lit[points.index[i + lane]] = packet.tfar[lane] >= 0;
    }
}

void occluded_by_streams(const ShadowRays& rays, RTCScene scene, const RayPoints& points, std::size_t first,
                         std::size_t count, std::uint8_t* lit) {
    alignas(64) std::array<RTCRay, stream_length> stream{};
    for (RTCRay& ray : stream) ray.mask = ~0u;
    CoherentContext context;
    const auto& light = rays.light;
    for (std::size_t i = first; i < first + count; i += stream_length) {
        const std::size_t length = std::min(stream_length, first + count - i);
        for (std::size_t k = 0; k < length; ++k) {
            RTCRay& ray = stream[k];
            ray.org_x = points.x[i + k];
            ray.org_y = points.y[i + k];
            ray.org_z = points.z[i + k];
            ray.dir_x = light[0] - light[3] * ray.org_x;
            ray.dir_y = light[1] - light[3] * ray.org_y;
            ray.dir_z = light[2] - light[3] * ray.org_z;
            ray.tnear = rays.offset == 0 ? 0 : rays.offset / length_of(light, ray.org_x, ray.org_y, ray.org_z);
            ray.tfar = last_of(light);
        }
        rtcOccluded1M(scene, &context, stream.data(), static_cast<unsigned>(length), sizeof(RTCRay));
        for (std::size_t k = 0; k < length; ++k) lit[points.index[i + k]] = stream[k].tfar >= 0;
    }
}

// The pixel of a tile's ray. Of one sample: 4 x 4 pixels, then the next such block to the right.
std::array<std::uint32_t, 2> place_in_tile(std::uint32_t pixel, std::uint32_t tile_width, bool in_blocks) {
    if (!in_blocks) return {pixel % tile_width, pixel / tile_width};
    const std::uint32_t block = pixel / (block_side * block_side), in_block = pixel % (block_side * block_side);
    const std::uint32_t per_row = tile_width / block_side;
    return {block % per_row * block_side + in_block % block_side, block / per_row * block_side + in_block / block_side};
}

}  // namespace

const char* name_of(Shape shape) {
    switch (shape) {
        case Shape::packets_of_8:
            return "packets-of-8";
        case Shape::packets_of_16:
            return "packets-of-16";
        case Shape::streams_of_256:
            return "streams-of-256";
    }
    return "";
}

void for_each_tile(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next{0};
    const auto take = [&] {
        const unsigned mode = _mm_getcsr();
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) work(i);
        _mm_setcsr(mode);
    };
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back(take);
    take();
}

void RayPoints::clear() {
    for (std::vector<float>* coordinate : {&x, &y, &z}) coordinate->clear();
    index.clear();
}

void RayPoints::append(float px, float py, float pz, std::size_t at) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
    index.push_back(static_cast<std::uint32_t>(at));
}

void RayPoints::fill_up() {
    for (std::vector<float>* coordinate : {&x, &y, &z})
        while (coordinate->size() % ray_width != 0) coordinate->push_back(coordinate->back());
}

void ShadowRays::trace(Shape shape, RTCScene scene, const RayPoints& points, std::size_t first, std::size_t count,
                       std::uint8_t* lit) const {
    switch (shape) {
        case Shape::packets_of_8:
            return occluded_by_packets<PacketOf8>(*this, scene, points, first, count, lit);
        case Shape::packets_of_16:
            return occluded_by_packets<PacketOf16>(*this, scene, points, first, count, lit);
        case Shape::streams_of_256:
            return occluded_by_streams(*this, scene, points, first, count, lit);
    }
}

// ---- Camera ---------------------------------------------------------------------------------------------------------

CameraRays::CameraRays(const Camera& camera, std::uint32_t width, std::uint32_t height, std::uint32_t samples,
                       const Light& light, const Mesh& mesh, float lift)
    : mesh_(mesh),
      width_(width),
      height_(height),
      samples_(samples),
      eye_(camera.eye),
      light_(light.xyzw),
      lift_(lift) {
    // 1024, 256, 128, 64 or 32 pixels.
    tile_width_ = samples == 1 ? 32 : samples <= 8 ? 16 : 8;
    tile_height_ = static_cast<std::uint32_t>(tile_rays) / samples / tile_width_;
    tiles_per_row_ = (width + tile_width_ - 1) / tile_width_;
    tiles_per_column_ = (height + tile_height_ - 1) / tile_height_;
    const double pixel = std::tan(camera.fov_y_radians / 2) / (height / 2.0);
    for (std::size_t c = 0; c < 3; ++c) {
        right_[c] = static_cast<float>(pixel * camera.right[c]);
        down_[c] = static_cast<float>(-pixel * camera.up[c]);
        corner_[c] = static_cast<float>(camera.forward[c] - pixel * (width / 2.0) * camera.right[c] +
                                        pixel * (height / 2.0) * camera.up[c]);
    }
    const std::span<const SampleOffset> pattern = sample_pattern(samples);
    for (std::uint32_t i = 0; i < tile_rays; ++i) {
        const auto [column, row] = place_in_tile(i / samples, tile_width_, samples == 1);
        const SampleOffset& sample = pattern[i % samples];
        column_[i] = static_cast<std::uint8_t>(column);
        row_[i] = static_cast<std::uint8_t>(row);
        at_x_[i] = float(column) + 0.5f + float(sample.x) / 64;
        at_y_[i] = float(row) + 0.5f + float(sample.y) / 64;
    }
}

Float3 CameraRays::corner_of(std::size_t tile) const {
    const auto x = float(tile % tiles_per_row_ * tile_width_), y = float(tile / tiles_per_row_ * tile_height_);
    Float3 corner;
    for (std::size_t c = 0; c < 3; ++c) corner[c] = corner_[c] + x * right_[c] + y * down_[c];
    return corner;
}

// The triangle faces the light if the light is on the eye's side of it. Written without branches, so that a compiler
// makes it of all lanes of a packet at once.
inline void CameraRays::keep(Hits& hits, std::size_t at, const float direction[3], float t, const float normal[3],
                             std::uint32_t geometry, std::uint32_t triangle) const {
    const float along = normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2];
    const float square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    const float step = std::copysign(lift_, -along) / std::sqrt(square);
    const float x = eye_[0] + t * direction[0] + step * normal[0];
    const float y = eye_[1] + t * direction[1] + step * normal[1];
    const float z = eye_[2] + t * direction[2] + step * normal[2];
    const float light = normal[0] * (light_[0] - light_[3] * x) + normal[1] * (light_[1] - light_[3] * y) +
                        normal[2] * (light_[2] - light_[3] * z);
    const bool is_hit = geometry != RTC_INVALID_GEOMETRY_ID;
    hits.x[at] = x;
    hits.y[at] = y;
    hits.z[at] = z;
    hits.triangle[at] = is_hit ? mesh_.triangle_of(geometry, triangle) : no_receiver;
    hits.faces_light[at] = is_hit & (light * along < 0);
}

template <typename Traits>
void CameraRays::trace_packets(RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const {
    constexpr std::size_t width = Traits::width;
    alignas(64) typename Traits::RayHit packet{};
    alignas(64) int valid[width];
    std::fill_n(valid, width, -1);
    std::fill_n(packet.ray.mask, width, ~0u);
    std::fill_n(packet.ray.org_x, width, eye_[0]);
    std::fill_n(packet.ray.org_y, width, eye_[1]);
    std::fill_n(packet.ray.org_z, width, eye_[2]);
    CoherentContext context;
    const Float3 corner = corner_of(tile);
    for (std::size_t i = 0; i < tile_rays; i += width) {
        for (std::size_t lane = 0; lane < width; ++lane) {
            const float x = at_x_[i + lane], y = at_y_[i + lane];
            packet.ray.dir_x[lane] = corner[0] + x * right_[0] + y * down_[0];
            packet.ray.dir_y[lane] = corner[1] + x * right_[1] + y * down_[1];
            packet.ray.dir_z[lane] = corner[2] + x * right_[2] + y * down_[2];
            packet.ray.tfar[lane] = infinity;
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        }
        Traits::intersect(valid, scene, &context, &packet);
        for (std::size_t lane = 0; lane < width; ++lane) {
            const float direction[] = {packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]};
            const float normal[] = {packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]};
            keep(hits, first + i + lane, direction, packet.ray.tfar[lane], normal, packet.hit.geomID[lane],
                 packet.hit.primID[lane]);
        }
    }
}

void CameraRays::trace_streams(RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const {
    alignas(64) std::array<RTCRayHit, stream_length> stream{};
    for (RTCRayHit& ray : stream) {
        ray.ray.mask = ~0u;
        ray.ray.org_x = eye_[0];
        ray.ray.org_y = eye_[1];
        ray.ray.org_z = eye_[2];
    }
    CoherentContext context;
    const Float3 corner = corner_of(tile);
    for (std::size_t i = 0; i < tile_rays; i += stream_length) {
        for (std::size_t k = 0; k < stream_length; ++k) {
            const float x = at_x_[i + k], y = at_y_[i + k];
            RTCRay& ray = stream[k].ray;
            ray.dir_x = corner[0] + x * right_[0] + y * down_[0];
            ray.dir_y = corner[1] + x * right_[1] + y * down_[1];
            ray.dir_z = corner[2] + x * right_[2] + y * down_[2];
            ray.tfar = infinity;
            stream[k].hit.geomID = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect1M(scene, &context, stream.data(), stream_length, sizeof(RTCRayHit));
        for (std::size_t k = 0; k < stream_length; ++k) {
            const auto& [ray, hit] = stream[k];
            const float direction[] = {ray.dir_x, ray.dir_y, ray.dir_z}, normal[] = {hit.Ng_x, hit.Ng_y, hit.Ng_z};
            keep(hits, first + i + k, direction, ray.tfar, normal, hit.geomID, hit.primID);
        }
    }
}

void CameraRays::trace(Shape shape, RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const {
    switch (shape) {
        case Shape::packets_of_8:
            return trace_packets<PacketOf8>(scene, tile, hits, first);
        case Shape::packets_of_16:
            return trace_packets<PacketOf16>(scene, tile, hits, first);
        case Shape::streams_of_256:
            return trace_streams(scene, tile, hits, first);
    }
}

}  // namespace gnomon::bench::embree
