// SPDX-License-Identifier: MIT
// The report of a run: stats.json for programs, a short table for people. Both are made from one struct.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "setup.hpp"

namespace gnomon::app {

/// Points by their visibility; "partly" only with techniques that filter.
struct Shares {
    std::uint64_t lit = 0, in_shadow = 0, partly = 0;
};

/// A light, and the points that it reaches.
struct LightReport {
    ChosenLight chosen;
    Statistics statistics;
    Shares shares;
};

/// What to try where a picture shows no triangle of a scene, which may have none.
const char* hint_of_empty(bool has_triangles);

/// All figures of a finished run.
struct Report {
    RenderOptions options;
    std::uint64_t triangles = 0;
    std::uint64_t non_finite_triangles = 0;
    std::size_t unused_lights = 0;  ///< of the scene, where the first was taken for want of a choice
    bool is_empty = false;          ///< the camera sees no triangle
    std::vector<std::string> warnings;
    struct Animations {
        std::vector<std::string> names;  ///< of the file
        std::string shown;               ///< empty: the pose at rest
    } animations;
    ChosenCamera camera;
    std::vector<LightReport> lights;    ///< one; more with --light all
    std::optional<double> exposure_ev;  ///< of the picture, once it is made
    std::uint64_t texture_bytes = 0;    ///< on the device
    DeviceDescription device;
    Statistics camera_statistics;
    std::uint64_t device_memory_bytes = 0, device_memory_peak_bytes = 0;
    /// Wall time of the command's own steps, in order, each until the device has finished it, without compilation;
    /// "kernels" is the time that the steps waited for compilation, and "other" is the rest of the total.
    std::vector<std::pair<std::string, double>> phases_ms;
    KernelBuilds kernels;
    double total_ms = 0;
};

/// What was measured of the frames of a sequence.
struct SequenceReport {
    struct Frame {
        double time_s = 0, total_ms = 0;
        std::vector<std::pair<std::string, double>> phases_ms;
    };
    std::vector<Frame> frames;
};

/// NAME.png as NAME_0007.png: with as many digits as the last of `count` frames needs, at least four.
std::filesystem::path numbered(const std::filesystem::path& file, std::uint32_t frame, std::uint32_t count);

/// The device, as stats.json has it.
nlohmann::ordered_json device_json(const DeviceDescription& device);

/// The name of one light's mask among the outputs: "mask", or with several lights "mask_0", "mask_1", ...
std::string mask_name(std::size_t light, std::size_t light_count);

/// The name in stats.json and the file of every output of the options, in the order they are written. With several
/// lights, --mask NAME.png stands for NAME_0.png, NAME_1.png, ...
std::vector<std::pair<std::string, std::filesystem::path>> outputs_of(const RenderOptions& options,
                                                                      std::size_t light_count);

/// stats.json: keys keep this order, float32 values are printed exactly.
nlohmann::ordered_json statistics_json(const Report& report);

/// Of each frame its time, and its phases as in statistics_json().
nlohmann::ordered_json frames_json(const SequenceReport& sequence);

/// The table for the terminal.
std::string summary(const Report& report);

/// The table of a sequence: the first frame beside the median of the others.
std::string frames_text(const SequenceReport& sequence);

}  // namespace gnomon::app
