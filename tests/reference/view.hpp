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
    /// With several samples per pixel (sample_positions()), visibility is the share of the pixel's samples that are
    /// lit, and these are sample by sample, each pixel by pixel. A sample of the sky: NO_RECEIVER, and it is lit.
    std::uint32_t samples = 1;
    std::span<const float> sample_position{};  ///< 3 per sample
    std::span<const std::uint32_t> sample_receiver{};
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

    // Of several samples per pixel. The counts above that begin with `camera` are of pixels' centres.
    std::uint64_t samples_judged = 0;                                             ///< for the camera's promises
    std::uint64_t samples_of_sky = 0, samples_on_own = 0, samples_on_others = 0;  ///< of all samples; own: the pixel's
    std::uint64_t samples_ambiguous = 0;
    std::uint64_t partly_lit = 0;                                           ///< pixels
    Faults wrong_sample_nearest, wrong_sample_side, wrong_sample_distance;  ///< pixels, once for each wrong sample

    std::uint64_t wrong() const;
};

/// Throws std::invalid_argument for sizes that do not match.
ViewReport judge_view(std::span<const float> triangles, const PinholeCamera& camera,
                      const std::optional<std::array<float, 4>>& light, const ViewClaim& claim,
                      const JudgeOptions& options = {});

struct View {
    std::vector<float> position, normal, visibility;
    std::vector<std::uint32_t> receiver;
    std::uint32_t samples = 1;
    std::vector<float> sample_position;
    std::vector<std::uint32_t> sample_receiver;

    ViewClaim claim() const {
        return {position, normal, receiver, visibility, samples, sample_position, sample_receiver};
    }
};

/// The view that the reference itself sees. P is the true hit, rounded, then moved by single ulps of its largest
/// coordinate along the normal's largest axis until it is not under its receiver's plane.
View make_view(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light,
               std::uint32_t samples = 1);

}  // namespace reference
