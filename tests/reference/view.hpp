// SPDX-License-Identifier: MIT
// Judges a whole view: every pixel's shading point, normal and visibility against the oracle and the camera's truth.
// Also makes a right view from nothing but the reference, to test the judge and to feed tests that need points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "camera.hpp"
#include "visibility.hpp"

namespace reference {

/// What is claimed, row by row from the top. Sky: position and normal 0, NO_RECEIVER, visibility 1.
struct ViewClaim {
    std::span<const float> position;          ///< 3 per pixel
    std::span<const float> normal;            ///< 3 per pixel: unit, facing the eye; empty: not judged
    std::span<const std::uint32_t> receiver;  ///< 1 per pixel
    std::span<const float> visibility;        ///< 1 per pixel: exactly 1 or 0; empty: not judged
};

struct JudgeOptions {
    double ray_tolerance = DEFAULT_RAY_TOLERANCE;
    std::uint64_t camera_sample = 0;  ///< judge the camera's promises on about this many pixels; 0: on all
    std::uint64_t seed = 1;           ///< of the sample
    const Masks* masks = nullptr;     ///< of the triangles
};

/// How many pixels break one promise, and the first few of them.
struct Faults {
    static constexpr std::size_t SHOWN = 5;
    std::uint64_t count = 0;
    std::vector<std::size_t> first;  ///< pixel indices, rising, at most SHOWN

    void add(std::size_t pixel);
    void merge(const Faults& other);
};

struct ViewReport {
    std::uint64_t pixels = 0;
    std::uint64_t sky = 0;
    VisibilityCounts visibility;      ///< of the pixels that are not sky
    std::uint64_t camera_pixels = 0;  ///< judged for the camera's promises
    std::uint64_t camera_ambiguous = 0;
    std::uint64_t camera_decided_exactly = 0;
    long double largest_distance_ulp = 0;
    Faults wrong_visibility, wrong_sky, wrong_normal, wrong_nearest, wrong_side, wrong_distance;
    double visibility_seconds = 0, camera_seconds = 0;

    std::uint64_t wrong() const;
};

/// Throws std::invalid_argument for sizes that do not match.
ViewReport judge_view(std::span<const float> triangles, const PinholeCamera& camera,
                      const std::optional<std::array<float, 4>>& light, const ViewClaim& claim,
                      const JudgeOptions& options = {});

struct View {
    std::vector<float> position, normal, visibility;
    std::vector<std::uint32_t> receiver;

    ViewClaim claim() const { return {position, normal, receiver, visibility}; }
};

/// The view that the reference itself sees. P is the true hit, rounded, then moved by single ulps of its largest
/// coordinate along the normal's largest axis until it is not under its receiver's plane.
View make_view(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light);

}  // namespace reference
