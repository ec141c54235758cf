// SPDX-License-Identifier: MIT
// Runs the stages of a light one by one, in the order of frustum_tracer.cpp, and copies every stage's output to the
// host, so that a stage's test can check its inputs and outputs.
#pragma once

#include <bit>
#include <optional>
#include <vector>

#include "device.hpp"
#include "light_scene.hpp"
#include "occluders/occluder_lists.hpp"
#include "receivers/facing.hpp"
#include "receivers/receiver_depth_pyramid.hpp"
#include "reference/predicates.hpp"
#include "rivals/izb.hpp"

namespace support {

/// A listed point as the trace reads it.
struct ListedPoint {
    std::uint32_t id;
    std::uint32_t bin, texel;  ///< texel: of those of the bin, row by row
    float x, y, z;
};

/// Bins that a record may touch, both ends included.
struct BinRange {
    std::uint32_t x0, y0, x1, y1;
    bool contains(std::uint32_t x, std::uint32_t y) const { return x0 <= x && x <= x1 && y0 <= y && y <= y1; }
};

/// The bins of a triangle's quantised bounds (kernels/occluders/bin_lists.h), and whether they are empty.
BinRange bins_of(const gnomon::TriangleBounds& bounds, const gnomon::Projection& projection);
bool is_dropped(const gnomon::TriangleBounds& bounds);

struct SetUpTriangle {
    std::uint32_t id;
    gnomon::TriangleRecord record;
    BinRange bins;
};

/// The outputs of one frame's stages.
struct FrameOutput {
    gnomon::LightFrame frame;  ///< as face_of() makes it
    gnomon::Projection projection;
    std::vector<std::uint32_t> pyramid;                  ///< receiver_depth_pyramid, base level first
    std::vector<std::uint32_t> self_shadow_depths;       ///< receiver_depth_pyramid, per bin
    std::vector<std::uint32_t> depth_after_map;          ///< receiver_depth_pyramid after the map, per bin
    std::vector<SetUpTriangle> triangles;                ///< triangle_setup, by id
    std::vector<std::uint32_t> map;                      ///< conservative_map, as keys; empty if not run
    std::vector<ListedPoint> points;                     ///< izb, by id
    std::vector<ListedPoint> points_left;                ///< after izb_trace
    std::vector<std::vector<std::uint32_t>> references;  ///< bins, triangle ids per bin, sorted
    std::vector<float> visibility_before;                ///< of the frame's stages
    std::vector<float> visibility_after_izb;             ///< listed points are 1 here
    std::vector<float> visibility_after_izb_trace;       ///< before the queue is decided
    std::vector<float> visibility;                       ///< after exact_trace
    gnomon::FrameCounters izb_counters;                  ///< counts of the izb stage alone
    gnomon::FrameCounters counters;
};

struct StageSettings {
    gnomon::FrameGrid grid{64, 3};
    bool with_map = false;
    gnomon::CoverTest cover_test = gnomon::CoverTest::tight;
    std::uint32_t first_capacity = 0;  ///< 0: the stages' own
};

/// Visibility of an open point (kernels/simd/point_blocks.clh).
inline bool is_open(float visibility) { return visibility >= 2.0f; }
inline bool may_self_shadow(float visibility) { return visibility == 3.0f; }
/// A run's visibility, from the visibility after its last frame. Points of frames that did not run are lit.
inline float decided(float visibility) { return is_open(visibility) ? 1.0f : visibility; }

/// All frames of a light, as the kernels make them.
std::vector<gnomon::LightFrame> light_frames(const gnomon::Light& light, const gnomon::FrameGrid& grid);

/// The stages' inputs on the device; the facing stage has opened the points.
class UploadedScene {
public:
    UploadedScene(const gnomon::Device& device, const LightScene& scene);
    gnomon::TriangleInputs triangle_inputs() const { return gnomon::triangle_inputs(triangles); }
    gnomon::PointInputs point_inputs() const { return gnomon::point_inputs(points); }

    gnomon::Triangles triangles;
    gnomon::Points points;
    gnomon::Light light;
    gnomon::cl::Buffer visibility, counters;
    gnomon::FacingStage facing;
};

struct LightStages {
    gnomon::LightFrameFit light_frame;
    gnomon::ReceiverDepthPyramid receiver_depth_pyramid;
    gnomon::OccluderLists lists;
    gnomon::Izb izb;
    gnomon::Trace trace;
    gnomon::cl::Buffer projection;           ///< of the frame that runs
    std::vector<std::uint32_t> izb_offsets;  ///< of the izb, on the host
};

/// Runs the stages once for one frame, `out.frame`, with both traversals; their visibility must be equal. False if a
/// list was too short: the list is longer now, and the caller repeats the call.
bool run_stages_once(gnomon::cl::Session& session, LightStages& stages, const UploadedScene& scene,
                     const StageSettings& settings, FrameOutput& out);

/// Everything for each frame of the light that has points. Lists grow as in the pipeline. `kept`: stages of earlier
/// runs on this device, whose memory is used again (the izb of the largest grid takes 256 MiB).
std::vector<FrameOutput> run_light_stages(const gnomon::Device& device, const LightScene& scene,
                                          const StageSettings& settings = {}, LightStages* kept = nullptr);

/// The inverse of the order-preserving map from floats to integers (kernels/prelude.h).
inline float float_of_key(std::uint32_t key) {
    return std::bit_cast<float>((key & 0x80000000u) != 0 ? key & 0x7FFFFFFFu : ~key);
}
inline std::uint32_t key_of_float(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

inline constexpr std::uint32_t NO_KEY = 0xFFFFFFFFu;

}  // namespace support
