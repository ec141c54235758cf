// SPDX-License-Identifier: MIT
// What the benchmark measures, one row per (experiment, scene, view, size, device, way to shadow).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "measure/visibility_errors.hpp"
#include "reduced_mask.hpp"
#include "timing.hpp"

namespace gnomon::bench {

/// Settings of a technique in the order they are given: --set key=value; at the end samples=N if there are several.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// "a=1 b=2"
std::string text_of(const Settings& settings);

/// What runs of the same work took.
struct Times {
    double median_ms = 0, least_ms = 0, most_ms = 0;
    double spread_ms = 0;  ///< between the first and the third quartile
    std::size_t runs = 0;
};
/// Of at least one run.
Times times_of(std::vector<double> ms);

/// Points asked of the oracle (tests/reference, exact and independent), and how many answers differed from it.
struct OracleVerdict {
    std::uint64_t points = 0, wrong = 0;
    std::uint64_t rays = 0, wrong_rays = 0;  ///< of the camera, through pixels' centres and samples
};

/// Of a run over many lights: its decisions are the pairs whose light is strictly in front of the point's face.
struct LightPairs {
    std::uint64_t points = 0, lights = 0, facing = 0, lit = 0;
    std::uint64_t differing = 0;  ///< bits that are not those of the first row of the same question
    std::string points_made, lights_hash;
};

struct Row {
    std::string experiment;
    std::string scene, view, light;
    std::uint32_t width = 0, height = 0;
    std::uint64_t triangles = 0;
    std::string technique;
    Settings settings;
    Settings asked;      ///< of a comparison on equal terms: the settings before (Configuration)
    std::string terms;   ///< these terms; else empty
    bool exact = false;  ///< the technique promises no wrong point
    std::string mode;    ///< animated, moving or static: see Configuration
    std::string device, driver;
    /// One after the other. The k-th runs of rows that took turns were made together, in one round.
    std::vector<FrameTimes> runs;
    Times total;                  ///< of the shadows, with the build where each run builds
    std::optional<Times> camera;  ///< with the build where each run builds
    std::optional<Times> shade;
    std::optional<Times> frame;  ///< camera, shadow and shade: what a user waits for
    /// Of a ray tracer's tree, part of the other times in animated mode alone; of what is kept in the other modes.
    std::optional<Times> build;
    std::uint64_t device_memory_bytes = 0;
    std::vector<std::pair<std::string, double>> stages;  ///< device time by events, of profiled runs
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    std::vector<std::pair<std::string, std::string>> skipped;  ///< stages that did not run, and why
    std::string mask_hash, points_hash;
    std::optional<measure::VisibilityErrors> errors;
    std::optional<OracleVerdict> oracle;
    std::optional<LightPairs> pairs;
    std::string failed;  ///< why there are no figures; else empty

    std::optional<ReducedMask> picture;

    std::uint64_t count(std::string_view name) const;
    /// Keeps the runs, and sums them up. Of whole frames: camera, shade and frame too. At least one run.
    void set_runs(std::vector<FrameTimes> made, bool are_frames);
    /// "frustum-traced map-size=1024"
    std::string name() const;
    /// "crytek_sponza atrium_floor.noon_slant 1920x1080"
    std::string view_name() const;
};

}  // namespace gnomon::bench
