// SPDX-License-Identifier: MIT
// Runs a technique on a scene with points and compares every point with the oracle. A failure prints the first wrong
// point with its receiver, the light and the settings, and the command that explains this point.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "light_scene.hpp"

namespace support {

/// The result of a run of a technique.
struct Answer {
    std::vector<float> visibility;
    gnomon::Statistics statistics;

    std::uint64_t count(const std::string& name) const { return statistics.count(name); }
};

/// Sums over many runs, to show that a test is not vacuous.
struct AnswerTally {
    std::uint64_t lit = 0, shadowed = 0;                                  ///< points, by the truth
    std::uint64_t pairs = 0;                                              ///< of a point and a triangle
    std::uint64_t uncertain = 0, by_map = 0, by_trace = 0, by_exact = 0;  ///< of animated runs

    void add(const std::vector<float>& truth);
    void add(const gnomon::Statistics& statistics);
};

/// Whether the technique prepares the light before the run.
enum class Mode { animated, prepared };

std::unique_ptr<gnomon::Technique> technique_with(const gnomon::Device& device, const Settings& settings,
                                                  const std::string& name = "frustum-traced");
Answer answer(const gnomon::Device& device, gnomon::Technique& technique, const gnomon::Triangles& triangles,
              const gnomon::Points& points, const gnomon::Light& light, const gnomon::Facing& facing = {});
/// Makes a new frustum-traced for the run. A prepared light gets a grid of 128 unless the settings name one: without
/// this, clearing maps would take most of the time.
Answer answer(const gnomon::Device& device, const LightScene& scene, const Settings& settings,
              Mode mode = Mode::animated);

/// Fails with the first wrong point unless all are equal. `what` names the run. Returns how many points are wrong.
std::size_t expect_equal(const std::vector<float>& got, const std::vector<float>& wanted, const LightScene& scene,
                         const std::string& what);

/// Runs answer() and expects the oracle's visibility at every point. `truth`: truth_of(scene), if the caller has it.
Answer expect_exact(const gnomon::Device& device, const LightScene& scene, const Settings& settings, AnswerTally& tally,
                    Mode mode = Mode::animated, const std::vector<float>* truth = nullptr);

}  // namespace support
