// SPDX-License-Identifier: MIT
// Launches a trace of beams by itself and compares with the oracle what it leaves of each pair of a point and a light:
// a pair that the trace closes is blocked, and each triangle that blocks an open pair is in the queue.
#pragma once

#include <gtest/gtest.h>

#include "light_scene.hpp"
#include "light_tables/light_masks.hpp"

namespace support {

/// The triangles that block each pair, by the exact predicate: of light l and point p at [l * points + p].
using Blockers = std::vector<std::vector<std::uint32_t>>;
Blockers blockers_of_pairs(const LightScene& scene, std::span<const gnomon::Light> lights);

/// Which shadow rays a trace decides together: those of a block of points to a bundle of lights, of one point to a
/// bundle, or (on a CPU) of some blocks to one light.
enum class BeamMethod { blocks, points, packets };

/// What a launch leaves.
struct TracedBeams {
    std::vector<std::uint32_t> masks;      ///< point p and bundle b: [b * mask_stride + p]
    std::vector<gnomon::BeamPairs> queue;  ///< as far as there was room
    gnomon::BeamCounters counters;
};

/// A scene and its lights on the device, as the traces read them.
class BeamStage {
public:
    /// `bundle_lights`: the most lights of a bundle. Packets take plain bundles, which are full.
    BeamStage(const gnomon::Device& device, const LightScene& scene, std::span<const gnomon::Light> lights,
              BeamMethod method, std::uint32_t bundle_lights);

    /// Traces the pairs that are open in `given`. The queue has room for `queue_capacity` entries; expects that nothing
    /// is written past them.
    TracedBeams trace(const std::vector<std::uint32_t>& given, std::uint32_t queue_capacity = 1u << 18);
    /// The masks after beam_exact has decided the queue of the last trace.
    std::vector<std::uint32_t> decide_queue(std::uint32_t queue_capacity = 1u << 18);
    /// Takes this tree in place of the scene's own.
    void set_tree(const std::vector<float>& nodes, const std::vector<float>& leaves,
                  const std::vector<std::uint32_t>& ids);

    /// Masks of which all pairs are open, and canaries where there is no point.
    std::vector<std::uint32_t> all_open() const;
    std::size_t point_count() const { return points_.count(); }
    std::size_t bundle_count() const { return masks_.bundle_count(); }
    std::size_t mask_stride() const { return masks_.max_points(); }
    /// The light of a bundle's slot, or gnomon::no_light.
    std::uint32_t light_of(std::size_t bundle, std::uint32_t slot) const {
        return masks_.slots()[bundle * MAX_BUNDLE_LIGHTS + slot];
    }
    /// The number in the scene of point p of the masks.
    std::uint32_t point_of(std::size_t p) const { return order_[p]; }

private:
    gnomon::BeamParams params_of(std::uint32_t queue_capacity) const;
    void launch(const gnomon::BeamParams& params, std::size_t tasks, const char* kernel);

    BeamMethod method_;
    gnomon::Device device_;
    gnomon::cl::Session& session_;
    gnomon::Triangles triangles_;
    gnomon::Points points_;
    gnomon::Lights lights_;
    gnomon::LightsOutputs outputs_;
    gnomon::LightsOptions options_;
    gnomon::LightsRun run_;
    gnomon::SortedPoints sorted_;
    gnomon::WideBvh tree_;
    gnomon::BvhRun tree_run_;
    gnomon::LightBundles bundles_;
    gnomon::Statistics statistics_;
    gnomon::LightMasks masks_;
    std::vector<std::uint32_t> order_;
    gnomon::cl::Buffer queue_;
    std::optional<std::array<gnomon::cl::Buffer, 3>> own_tree_;
};

/// Traces all cases, with bundles of many lights and whole blocks, and with bundles of few and one point of each block
/// at a time. Expects the law, and the oracle's bits after beam_exact. Not vacuous: there are pairs of all three
/// kinds.
void expect_cases_hold(const gnomon::Device& device, BeamMethod method, bool are_positions);

/// A queue that is too short says how long it must be; the masks so far, and a second trace, then give the oracle's
/// bits.
void expect_queue_grows(const gnomon::Device& device, BeamMethod method, bool are_positions);

}  // namespace support
