// SPDX-License-Identifier: MIT
// What takes part in the runs of one view: gnomon in one of its modes, or a rival. All of them take turns in one loop,
// since a machine's speed drifts within minutes.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gnomon.hpp>
#include "cases.hpp"
#include "row.hpp"
#include "sweep.hpp"
#include "timing.hpp"

namespace gnomon::bench {

constexpr double short_run_ms = 100, long_run_ms = 3000;  // of warm-up runs

struct Size {
    std::uint32_t width = 0, height = 0;
};

/// A scene on a device.
struct Place {
    Place(const std::string& selector, const NamedScene& named, bool profile);

    /// The median of a few runs of the camera stage alone.
    Times time_camera(const Triangles& seen, const Case& c, Size size) const;

    Device device;
    const NamedScene& scene;
    Triangles triangles;
};

/// A view of it, with everything that a row says about a view.
struct Seen {
    View view;
    ViewOnHost host;
    Visibility visibility;
    Row row;  ///< what all rows of this view share
    Case c;
    std::optional<double> sun_angle_degrees{};  ///< of a soft truth

    /// The lights of the configuration on the disk.
    Lights sun(const Configuration& configuration) const;
};
/// What the case's camera sees, and the time that it takes to see it.
Seen seen_in(const Place& place, const Case& c, Size size);

template <typename Value>
std::string hash_of(std::span<const Value> values);  // of float and std::uint32_t
std::pair<std::string, std::string> samples_setting(std::uint32_t samples);
/// The technique of that name with these settings.
std::unique_ptr<Technique> make(const Configuration& configuration, const Device& device);

/// One that fails says so in its row; the others go on.
class Contestant {
public:
    struct Result {
        Row row;  ///< without its errors
        std::vector<float> mask;
    };

    virtual ~Contestant() = default;
    /// What is done once, and the first runs, which compile kernels and make lists grow.
    void warm_up();
    void run_timed();
    /// After this, nothing runs any more and all memory is free.
    Result finish();
    /// Per pixel.
    virtual std::uint32_t samples() const = 0;

protected:
    /// `has_frames`: each run makes a whole frame.
    Contestant(Row row, bool has_frames) : row_(std::move(row)), has_frames_(has_frames) {}

    virtual void get_ready() = 0;
    virtual FrameTimes run() = 0;
    /// Makes the mask, and adds to the row all but its times.
    virtual std::vector<float> describe(Row& row) = 0;
    virtual void free_memory() = 0;

    bool has_frames() const { return has_frames_; }
    const std::string& failed() const { return failed_; }
    template <typename Work>
    void guarded(Work&& work) {
        if (!failed_.empty()) return;
        try {
            work();
        } catch (const Error& error) {
            failed_ = error.what();
        }
    }

private:
    Row row_;
    bool has_frames_;
    std::vector<FrameTimes> runs_;
    std::string failed_;
};

/// gnomon. What a mode keeps between runs is made once, in get_ready(). A whole frame is a camera pass, then run() or
/// run_samples() on its points, then shade(); else the shadows of `seen`'s points run alone.
class OwnContestant : public Contestant {
public:
    OwnContestant(Configuration configuration, const Place& place, const Seen& seen, bool has_frames);

    std::uint32_t samples() const override { return configuration_.samples; }
    /// Device time of each stage, by events: the median of a few runs. `place` must profile.
    std::vector<std::pair<std::string, double>> profile();

private:
    void get_ready() override;
    FrameTimes run() override;
    std::vector<float> describe(Row& row) override;
    void free_memory() override;

    Statistics run_shadows(const View& view);
    void keep();
    void require_same_points(const View& view) const;

    Configuration configuration_;
    const Place& place_;
    const Seen& seen_;
    Triangles triangles_;
    std::unique_ptr<Technique> technique_;
    std::optional<CameraPass> camera_;
    std::optional<View> view_;  ///< of the last frame
    std::optional<Appearance> appearance_;
    std::optional<Visibility> picture_;  ///< its buffer: as many bytes
    std::vector<double> keep_ms_;
};

}  // namespace gnomon::bench
