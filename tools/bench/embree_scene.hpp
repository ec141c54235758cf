// SPDX-License-Identifier: MIT
// Embree's device, mesh and trees.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace gnomon::bench::embree {

/// How a tree is built.
struct Build {
    const char* quality;
    RTCBuildQuality flag;
    const char* rays;
    RTCSceneFlags scene_flags;
    bool operator==(const Build&) const = default;
};
/// `high` splits triangles, so its rays are the fastest; of robust ones it splits none.
constexpr Build low{"low", RTC_BUILD_QUALITY_LOW, "fast", RTC_SCENE_FLAG_NONE};
constexpr Build low_robust{"low", RTC_BUILD_QUALITY_LOW, "robust", RTC_SCENE_FLAG_ROBUST};
constexpr Build medium{"medium", RTC_BUILD_QUALITY_MEDIUM, "fast", RTC_SCENE_FLAG_NONE};
constexpr Build medium_robust{"medium", RTC_BUILD_QUALITY_MEDIUM, "robust", RTC_SCENE_FLAG_ROBUST};
constexpr Build high{"high", RTC_BUILD_QUALITY_HIGH, "fast", RTC_SCENE_FLAG_NONE};

class Scene {
public:
    Scene(RTCScene scene, std::uint64_t bytes) : scene_(scene), bytes_(bytes) {}
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;
    ~Scene() { rtcReleaseScene(scene_); }

    RTCScene get() const { return scene_; }
    std::uint64_t bytes() const { return bytes_; }

private:
    RTCScene scene_;
    std::uint64_t bytes_;
};

/// The triangles in the form that Embree shares: indexed, equal vertices once, readable 16 bytes past the end.
class Mesh {
public:
    /// The scene must outlive this. The triangles of cut-outs are a geometry of their own, whose hits a filter judges.
    Mesh(const scene::Scene& scene, unsigned threads);
    Mesh(const Mesh&) = delete;
    Mesh& operator=(const Mesh&) = delete;
    ~Mesh() { rtcReleaseDevice(device_); }

    std::unique_ptr<Scene> build(const Build& build);
    /// The id of a geometry's triangle.
    std::uint32_t triangle_of(std::uint32_t geometry, std::uint32_t primitive) const {
        return ids_[geometry].empty() ? primitive : ids_[geometry][primitive];
    }
    /// The length of the diagonal of the finite vertices' box.
    double diagonal() const { return diagonal_; }

private:
    void attach(RTCScene scene, const Build& build, unsigned geometry);
    bool is_opaque(std::uint32_t masked, float u, float v) const;
    static void filter(const RTCFilterFunctionNArguments* hits);

    const scene::Scene& scene_;
    std::vector<float> vertices_;
    std::vector<std::uint32_t> indices_[2];  ///< of opaque triangles, and of cut-outs
    std::vector<std::uint32_t> ids_[2];      ///< empty: all of them in order
    double diagonal_ = 0;
    std::atomic<std::int64_t> bytes_{0};
    RTCDevice device_ = nullptr;
};

}  // namespace gnomon::bench::embree
