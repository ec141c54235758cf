// SPDX-License-Identifier: MIT
// What `gnomon devices --check` knows the answers of: hard scenes, made of whole numbers alone so that every machine
// makes the same bits, and views of the sundial. tests/command/device_check_test.cpp compares the answers with the
// oracle.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <gnomon.hpp>

namespace gnomon::app {

struct HardCase {
    std::string name;
    std::vector<float> triangles, points;
    std::vector<Light> lights;
    std::uint64_t answers = 0;  ///< hash_of() the visibility under each light, one after the other
};

std::vector<HardCase> hard_cases();

/// A light of the sundial, and what the golden record (tests/golden/made_scenes.txt) has for it and the first camera.
struct KnownView {
    std::string name;
    Light light;
    std::uint64_t visibility;
};
inline constexpr std::uint32_t known_width = 640, known_height = 360;
inline constexpr std::uint64_t known_camera = 0x7020816744cd4001;  ///< positions, then receivers

std::vector<KnownView> known_views(const Light& sun);

/// FNV-1a of 64 bits over bytes, continued from `hash`.
inline constexpr std::uint64_t hash_start = 0xcbf29ce484222325u;
std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t hash = hash_start);

}  // namespace gnomon::app
