// SPDX-License-Identifier: MIT
// A scene that stays on its device while it is looked at: picture after picture with the bits of gnomon render, beside
// other techniques, and explained. For one thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../explained.hpp"
#include "../picture.hpp"
#include "request.hpp"

namespace gnomon::app {

/// A picture, and what is known of it, as JSON for the page.
struct Frame {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    nlohmann::ordered_json facts;
};

/// Asked now and then during long work: false ends it with Cancelled.
using GoOn = std::function<bool()>;

class ViewSession {
public:
    /// Opens the device and reads the scene. `say` is told what is being done. Throws Error.
    ViewSession(const PageOptions& page, const std::function<void(const std::string&)>& say);
    ~ViewSession();

    /// What the page can choose from, and where it starts.
    nlohmann::ordered_json facts() const;
    /// The picture that gnomon render makes of these options.
    Frame picture(const RenderOptions& options, const GoOn& go_on);
    /// Three pictures, one below the other: hard shadows by the exact technique, by the options' technique, and where
    /// the two differ.
    Frame comparison(const RenderOptions& options);
    /// The picture that gnomon hours makes of these options, with its legend or, for the page, with the legend's
    /// colours among the facts.
    Frame hours(const HoursOptions& options, bool has_legend, const GoOn& go_on);
    /// What gnomon explain says, and the shapes that it names.
    nlohmann::ordered_json explanation(const ExplainOptions& options);

private:
    /// The scene at one time, on the device.
    struct Pose;
    /// What a camera sees, decided by nobody yet.
    struct Seen;

    Pose& pose_of(const ViewOptions& options);
    ChosenCamera camera_of(const ViewOptions& options, Pose& pose);
    Seen look_of(const RenderOptions& options);
    Technique& technique_of(const RenderOptions& options);
    Technique& exact();
    void prepare_still_light(Pose& pose, const RenderOptions& options, const PictureLights& lights);

    PageOptions page_;
    Device device_;
    std::unique_ptr<SceneSource> source_;
    std::map<std::string, std::unique_ptr<Technique>> techniques_;  ///< the exact one, and the last other one
    CameraPass camera_pass_;
    SurfaceTextures textures_;
    std::unique_ptr<Pose> pose_;
    bool has_told_ = false;  ///< what the default view does not frame
};

}  // namespace gnomon::app
