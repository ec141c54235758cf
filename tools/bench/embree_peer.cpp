// SPDX-License-Identifier: MIT
// Embree 3 as the rival: see peers.hpp for what is compared.
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "peers.hpp"

namespace gnomon::bench {

namespace {

constexpr std::size_t ray_width = 16;
constexpr double offsets[] = {0, 1e-6, 1e-4};
constexpr std::uint32_t block_side = 4;

using Double3 = std::array<double, 3>;

Double3 difference(std::span<const float> a, std::span<const float> b) {
    return {double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]};
}
Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// In double: good enough to spare the rival rays that gnomon does not trace either.
bool faces_light(const PeerTask& task, std::uint32_t receiver) {
    const auto vertex = [&](std::size_t k) { return task.triangles.subspan(9 * std::size_t(receiver) + 3 * k, 3); };
    const Double3 normal = cross(difference(vertex(1), vertex(0)), difference(vertex(2), vertex(0)));
    const std::span<const float> light = std::span(task.light.xyzw).first(3);
    const Double3 to_light =
        task.light.is_directional() ? Double3{light[0], light[1], light[2]} : difference(light, vertex(0));
    return dot(normal, to_light) * dot(normal, difference(task.eye, vertex(0))) > 0;
}

// The points that get a ray, structure of arrays, in blocks of pixels.
struct RayPoints {
    std::vector<float> x, y, z;  ///< of whole packets: longer than `pixel`
    std::vector<std::size_t> pixel;
};

RayPoints ray_points(const PeerTask& task) {
    RayPoints points;
    for (std::uint32_t top = 0; top < task.height; top += block_side)
        for (std::uint32_t left = 0; left < task.width; left += block_side)
            for (std::uint32_t y = top; y < std::min(top + block_side, task.height); ++y)
                for (std::uint32_t x = left; x < std::min(left + block_side, task.width); ++x)
                    for (std::uint32_t sample = 0; sample < task.samples; ++sample) {
                        const std::size_t pixel = std::size_t(y) * task.width + x;
                        const std::size_t i = sample * (std::size_t(task.width) * task.height) + pixel;
                        const std::uint32_t receiver = task.host.receiver[i];
                        if (receiver == no_receiver || !faces_light(task, receiver)) continue;
                        points.x.push_back(task.host.position[3 * i]);
                        points.y.push_back(task.host.position[3 * i + 1]);
                        points.z.push_back(task.host.position[3 * i + 2]);
                        points.pixel.push_back(pixel);
                    }
    // The last packet is filled up with its last point, over and over.
    for (std::vector<float>* coordinate : {&points.x, &points.y, &points.z})
        while (coordinate->size() % ray_width != 0) coordinate->push_back(coordinate->back());
    return points;
}

double diagonal_of(std::span<const float> triangles) {
    Double3 low{}, high{};
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (std::isfinite(triangles[i])) {
            low[i % 3] = std::min<double>(low[i % 3], triangles[i]);
            high[i % 3] = std::max<double>(high[i % 3], triangles[i]);
        }
    const Double3 extent{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    return triangles.empty() ? 0 : std::sqrt(dot(extent, extent));
}

unsigned thread_count(const PeerTask& task) {
    return task.threads != 0 ? task.threads : std::max(1u, std::thread::hardware_concurrency());
}

double length_of(const RTCRay16& rays, std::size_t lane) {
    const Double3 direction{rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]};
    return std::sqrt(dot(direction, direction));
}

/// The device, and the triangles in the form Embree shares: indexed, and readable 16 bytes past the end.
class Tracer {
public:
    Tracer(const PeerTask& task)
        : task_(task),
          points_(ray_points(task)),
          diagonal_(diagonal_of(task.triangles)),
          vertices_(task.triangles.begin(), task.triangles.end()) {
        device_ = rtcNewDevice(("threads=" + std::to_string(thread_count(task))).c_str());
        if (device_ == nullptr) throw Error("Embree could not be started");
        rtcSetDeviceMemoryMonitorFunction(
            device_,
            [](void* bytes, ssize_t change, bool) {
                *static_cast<std::atomic<std::int64_t>*>(bytes) += change;
                return true;
            },
            &bytes_);
        vertices_.resize(vertices_.size() + 4);
        indices_.resize(task.triangles.size() / 3);
        for (std::size_t i = 0; i < indices_.size(); ++i) indices_[i] = static_cast<std::uint32_t>(i);
        answer_.resize(points_.x.size());
    }
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;
    ~Tracer() {
        drop_scene();
        rtcReleaseDevice(device_);
    }

    void build(RTCBuildQuality quality, RTCSceneFlags flags) {
        drop_scene();
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, flags);
        rtcSetSceneBuildQuality(scene_, quality);
        RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(mesh, quality);
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                                   3 * sizeof(float), indices_.size());
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0,
                                   3 * sizeof(std::uint32_t), indices_.size() / 3);
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene_, mesh);
        rtcReleaseGeometry(mesh);
        rtcCommitScene(scene_);
        if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
            throw Error("Embree could not build its tree: error " + std::to_string(error));
    }

    void trace(double offset) {
        std::atomic<std::size_t> next{0};
        const auto work = [&] {
            constexpr std::size_t chunk = 64 * ray_width;
            for (std::size_t first; (first = next.fetch_add(chunk)) < points_.x.size();)
                for (std::size_t i = first; i < std::min(first + chunk, points_.x.size()); i += ray_width)
                    trace_packet(i, offset);
        };
        std::vector<std::jthread> others;
        for (unsigned i = 1; i < thread_count(task_); ++i) others.emplace_back(work);
        work();
    }

    // Samples without a ray: sky is lit, what faces away is in shadow.
    std::vector<float> mask() const {
        std::vector<float> mask(std::size_t(task_.width) * task_.height);
        for (std::size_t i = 0; i < task_.host.receiver.size(); ++i)
            if (task_.host.receiver[i] == no_receiver) mask[i % mask.size()] += 1;
        for (std::size_t i = 0; i < points_.pixel.size(); ++i) mask[points_.pixel[i]] += answer_[i];
        for (float& lit : mask) lit /= float(task_.samples);
        return mask;
    }

    std::uint64_t memory_bytes() const { return static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_)); }

private:
    void trace_packet(std::size_t first, double offset) {
        alignas(64) RTCRay16 rays;
        alignas(64) int valid[ray_width];
        std::copy_n(&points_.x[first], ray_width, rays.org_x);
        std::copy_n(&points_.y[first], ray_width, rays.org_y);
        std::copy_n(&points_.z[first], ray_width, rays.org_z);
        const auto& light = task_.light.xyzw;
        const float last = task_.light.is_directional() ? std::numeric_limits<float>::infinity() : 1;
        for (std::size_t lane = 0; lane < ray_width; ++lane) {
            // w = 0: a direction; w = 1: from the point to the light.
            rays.dir_x[lane] = light[0] - light[3] * rays.org_x[lane];
            rays.dir_y[lane] = light[1] - light[3] * rays.org_y[lane];
            rays.dir_z[lane] = light[2] - light[3] * rays.org_z[lane];
            rays.tnear[lane] = 0;
            rays.tfar[lane] = last;
            rays.time[lane] = 0;
            rays.mask[lane] = ~0u;
            rays.flags[lane] = 0;
            valid[lane] = -1;
        }
        if (offset != 0)
            for (std::size_t lane = 0; lane < ray_width; ++lane)
                rays.tnear[lane] = static_cast<float>(offset * diagonal_ / length_of(rays, lane));
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcOccluded16(valid, scene_, &context, &rays);
        for (std::size_t lane = 0; lane < ray_width; ++lane) answer_[first + lane] = rays.tfar[lane] < 0 ? 0.0f : 1.0f;
    }

    void drop_scene() {
        if (scene_ != nullptr) rtcReleaseScene(scene_);
        scene_ = nullptr;
    }

    const PeerTask& task_;
    RayPoints points_;
    double diagonal_ = 0;
    std::vector<float> vertices_;
    std::vector<std::uint32_t> indices_;
    std::vector<float> answer_;
    std::atomic<std::int64_t> bytes_{0};
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
};

std::string text_of(double offset) {
    char text[16];
    std::snprintf(text, sizeof(text), "%g", offset);
    return text;
}

struct Kind {
    const char* build;
    RTCBuildQuality quality;
    const char* rays;
    RTCSceneFlags flags;
};
constexpr Kind kinds[] = {
    {"low", RTC_BUILD_QUALITY_LOW, "fast", RTC_SCENE_FLAG_NONE},
    {"low", RTC_BUILD_QUALITY_LOW, "robust", RTC_SCENE_FLAG_ROBUST},
    {"medium", RTC_BUILD_QUALITY_MEDIUM, "fast", RTC_SCENE_FLAG_NONE},
    {"medium", RTC_BUILD_QUALITY_MEDIUM, "robust", RTC_SCENE_FLAG_ROBUST},
};

}  // namespace

std::string embree_version() { return RTC_VERSION_STRING; }

void run_peers(const PeerTask& task, const std::function<void(PeerResult&&)>& take) {
    Tracer tracer(task);
    for (const Kind& kind : kinds) {
        if (task.samples != 1 && kind.quality != RTC_BUILD_QUALITY_MEDIUM) continue;
        std::vector<double> build_ms, both_ms;
        for (const Clock clock; task.rule.goes_on(static_cast<int>(both_ms.size()), clock.elapsed_ms());) {
            const Clock both;
            build_ms.push_back(time_ms([&] { tracer.build(kind.quality, kind.flags); }));
            tracer.trace(offsets[0]);
            both_ms.push_back(both.elapsed_ms());
        }
        const auto settings = [&](double offset) {
            return Settings{{"build", kind.build}, {"rays", kind.rays}, {"offset", text_of(offset)}};
        };
        const auto result = [&](double offset, const char* mode, const Times& total) {
            return PeerResult{"embree",           settings(offset),      mode,         total,
                              times_of(build_ms), tracer.memory_bytes(), tracer.mask()};
        };
        take(result(offsets[0], "animated", times_of(both_ms)));
        for (const double offset : offsets)
            take(result(offset, "static", times_of(timed_runs(task.rule, 2, [&] { tracer.trace(offset); }))));
    }
}

}  // namespace gnomon::bench
