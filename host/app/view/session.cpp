// SPDX-License-Identifier: MIT
#include "session.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "../sun_sums.hpp"
#include "facts.hpp"
#include "measure/visibility_errors.hpp"

namespace gnomon::app {
namespace {

using nlohmann::ordered_json;
const char* const exact_name = "frustum-traced";

/// Names the times between its calls, each to the end of the device's work.
class Stopwatch {
public:
    explicit Stopwatch(const Device& device) : device_(device) {}
    void stop(const char* name) {
        device_.finish();
        const auto now = std::chrono::steady_clock::now();
        times_[name] = std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
    }
    const ordered_json& times() const { return times_; }

private:
    const Device& device_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    ordered_json times_ = ordered_json::object();
};

RunOptions run_options(const GoOn& go_on) {
    RunOptions run;
    if (go_on) run.progress = [go_on](double) { return go_on(); };
    return run;
}

void require_hard(const RenderOptions& options) {
    if (options.samples != 1 || options.sun_angle_degrees || options.sky_division != 0 || options.light == "all")
        throw UsageError("a comparison shows the hard shadows of one light at the pixels' centres");
}

}  // namespace

struct ViewSession::Pose {
    Pose(const Device& device, scene::Scene of, std::optional<double> at_s, SurfaceTextures* textures)
        : time_s(at_s),
          scene(std::move(of)),
          triangles(upload_triangles(device, scene)),
          surfaces(device, scene, textures) {}

    std::optional<double> time_s;
    scene::Scene scene;
    Triangles triangles;
    SceneSurfaces surfaces;                     ///< of this scene
    std::map<double, ChosenCamera> framings{};  ///< by the picture's aspect
    std::optional<Light> last_light{};          ///< of the last picture; prepared after two
    bool is_prepared = false;
};

struct ViewSession::Seen {
    Pose& pose;
    ChosenCamera camera;
    PictureLights lights;
    View view;
};

ViewSession::ViewSession(const PageOptions& page, const std::function<void(const std::string&)>& say)
    : page_(page),
      device_((say("opening the device"), open_device(page, false))),
      source_((say("reading the scene"), std::make_unique<SceneSource>(page, true))),
      camera_pass_(device_) {
    say("copying the scene to the device");
    pose_of(page);
    say("the first picture (compiles kernels the first time)");
}

ViewSession::~ViewSession() = default;

ViewSession::Pose& ViewSession::pose_of(const ViewOptions& options) {
    const bool is_other_animation = options.animation != page_.animation;
    if (pose_ && pose_->time_s == options.time_s && !is_other_animation) return *pose_;
    if (is_other_animation) {
        source_ = std::make_unique<SceneSource>(options, true);
        page_.animation = options.animation;
    }
    if (!source_) source_ = std::make_unique<SceneSource>(options, true);
    scene::Scene scene = source_->at(options.time_s);
    if (scene.animations.empty()) source_.reset();  // no time comes that would read it again
    pose_.reset();
    for (auto& [name, technique] : techniques_) technique->release_prepared_light();
    pose_ = std::make_unique<Pose>(device_, std::move(scene), options.time_s, &textures_);
    return *pose_;
}

ChosenCamera ViewSession::camera_of(const ViewOptions& options, Pose& pose) {
    const bool frames_scene = !options.eye && !options.camera && !options.fov_y_degrees && pose.scene.cameras.empty();
    if (!frames_scene) return choose_camera(options, pose.scene);
    const double aspect = double(options.size.width) / double(options.size.height);
    const auto found = pose.framings.find(aspect);
    if (found != pose.framings.end()) return found->second;
    if (pose.framings.size() > 64) pose.framings.clear();
    ChosenCamera framing = choose_camera(options, pose.scene);
    if (!std::exchange(has_told_, true)) print_camera_note(options, pose.scene, framing);
    return pose.framings.emplace(aspect, std::move(framing)).first->second;
}

ViewSession::Seen ViewSession::look_of(const RenderOptions& options) {
    Pose& pose = pose_of(options);
    ChosenCamera camera = camera_of(options, pose);
    PictureLights lights{options, choose_lights(options, pose.scene)};
    View view = camera_pass_.look(pose.triangles, camera.camera, options.size.width, options.size.height);
    return {pose, std::move(camera), std::move(lights), std::move(view)};
}

Technique& ViewSession::technique_of(const RenderOptions& options) {
    std::string key = options.technique;
    for (const auto& [name, value] : options.settings) key += "\n" + name + "=" + value;
    if (const auto found = techniques_.find(key); found != techniques_.end()) return *found->second;
    auto made = make_technique(device_, options.technique, options.settings);
    if (key != exact_name) std::erase_if(techniques_, [](const auto& kept) { return kept.first != exact_name; });
    return *(techniques_[key] = std::move(made));
}

Technique& ViewSession::exact() { return technique_of(RenderOptions()); }

/// A light that stands still for two pictures is prepared: the same bits in less time.
void ViewSession::prepare_still_light(Pose& pose, const RenderOptions& options, const PictureLights& lights) {
    const bool can_be = lights.chosen.size() == 1 && !options.sun_angle_degrees && options.technique == exact_name &&
                        options.settings.empty();
    if (!can_be) return;
    const Light& light = lights.chosen.front().light;
    const bool stands_still = pose.last_light && pose.last_light->xyzw == light.xyzw;
    if (stands_still && !pose.is_prepared) {
        techniques_.erase(exact_name);       // with its lists of pictures without a prepared light
        camera_pass_ = CameraPass(device_);  // with its lists: the next picture makes them again, in some 10 ms
        exact().prepare(pose.triangles, light);
    }
    pose.is_prepared = stands_still;
    pose.last_light = light;
}

Frame ViewSession::picture(const RenderOptions& options, const GoOn& go_on) {
    Stopwatch watch(device_);
    const Seen seen = look_of(options);
    watch.stop("camera");
    prepare_still_light(seen.pose, options, seen.lights);
    Technique& technique = technique_of(options);
    Frame frame{options.size.width, options.size.height, {}, {}};
    // A run of one light has no steps between which it could end.
    const RunOptions run = options.samples > 1 || options.sun_angle_degrees ? run_options(go_on) : RunOptions();
    std::optional<double> exposure_ev = exposure_of(options, seen.lights.chosen.size());
    if (options.samples > 1) {
        frame.rgba = smooth_picture(technique, seen.pose.surfaces, seen.lights, seen.pose.triangles, seen.view,
                                    exposure_ev, {}, run)
                         .rgba;
        watch.stop("all");
    } else {
        const auto visibilities = visibilities_for(device_, seen.view, seen.lights.chosen.size());
        seen.lights.decide(technique, seen.pose.triangles, seen.view, visibilities, run);
        watch.stop("shadow");
        const Surfaces surfaces = seen.pose.surfaces.of(seen.pose.triangles, seen.view);
        cl::Buffer sky;
        if (options.sky_division != 0)
            sky = sky_sums_of(device_, technique, seen.pose.triangles, seen.view.points, surfaces, options.sky_division,
                              run_options(go_on));
        frame.rgba =
            shade(surfaces, visibilities, seen.lights.lights(), {.exposure_ev = exposure_ev, .sky_sums = sky.get()})
                .rgba;
        watch.stop("colours");
    }
    frame.facts = {{"camera", camera_facts(seen.camera)}, {"lights", light_facts(seen.lights)}, {"ms", watch.times()}};
    return frame;
}

Frame ViewSession::comparison(const RenderOptions& options) {
    require_hard(options);
    Technique& other = technique_of(options);
    const Seen seen = look_of(options);
    const auto [width, height] = options.size;
    Stopwatch watch(device_);
    const auto decided = [&](Technique& by, const char* name) {
        const auto visibilities = visibilities_for(device_, seen.view, 1);
        seen.lights.decide(by, seen.pose.triangles, seen.view, visibilities);
        watch.stop(name);
        return visibilities;
    };
    const auto truth = decided(exact(), "exact"), rival = decided(other, "rival");
    const Surfaces surfaces = seen.pose.surfaces.of(seen.pose.triangles, seen.view);
    const auto shaded = [&](const std::vector<Visibility>& of) {
        return shade(surfaces, of, seen.lights.lights(), {.exposure_ev = exposure_of(options, 1)}).rgba;
    };
    Frame frame{width, 3 * height, shaded(truth), {}};
    const std::vector<std::uint8_t> below = shaded(rival);
    frame.rgba.insert(frame.rgba.end(), below.begin(), below.end());
    const std::vector<float> visible = rival.front().read(), true_visible = truth.front().read();
    const std::vector<std::uint8_t> difference = measure::difference_picture(visible, true_visible);
    for (std::size_t i = 0; i < difference.size(); i += 3)
        frame.rgba.insert(frame.rgba.end(), {difference[i], difference[i + 1], difference[i + 2], 255});
    const measure::VisibilityErrors errors = measure::visibility_errors(visible, true_visible, width, height);
    frame.facts = {{"camera", camera_facts(seen.camera)},
                   {"lights", light_facts(seen.lights)},
                   {"ms", watch.times()},
                   {"points", errors.points},
                   {"wrongly_lit", errors.wrongly_lit},
                   {"wrongly_shadowed", errors.wrongly_shadowed}};
    return frame;
}

Frame ViewSession::hours(const HoursOptions& options, bool has_legend, const GoOn& go_on) {
    Stopwatch watch(device_);
    Pose& pose = pose_of(options);
    const ChosenCamera camera = camera_of(options, pose);
    const auto [width, height] = options.size;
    const SunTable table = suns_of_place(*options.place, options.north_degrees);
    const View view = camera_pass_.look(pose.triangles, camera.camera, width, height);
    watch.stop("camera");
    std::vector<double> values =
        sun_sums(options, exact(), pose.triangles, view.points, table, run_options(go_on)).values;
    leave_sky_out(view.read(device_, pose.triangles).receiver, values);
    watch.stop("hours");
    const ColorScale scale = scale_of(options, values);
    Frame frame{width, height, colored(scale, values), {}};
    if (has_legend) draw_legend(scale, width, height, frame.rgba);
    watch.stop("colours");
    frame.facts = {{"camera", camera_facts(camera)},
                   {"lights", ordered_json::array()},
                   {"legend", legend_facts(scale)},
                   {"suns", table.suns.size()},
                   {"ms", watch.times()}};
    return frame;
}

ordered_json ViewSession::explanation(const ExplainOptions& options) {
    Pose& pose = pose_of(options);
    const ChosenCamera camera = camera_of(options, pose);
    const auto [width, height] = options.size;
    const View view = camera_pass_.look(pose.triangles, camera.camera, width, height);
    camera_pass_ = CameraPass(device_);  // its lists make room
    const ChosenLight light = choose_light(options, pose.scene);
    const std::size_t pixel = std::size_t(options.pixel->y) * width + options.pixel->x;
    return explanation_facts(
        {explain(device_, pose.triangles, view.points, pixel, light.light), where_of(options, camera), light}, camera);
}

ordered_json ViewSession::facts() const { return scene_facts(page_, pose_->scene, device_.description()); }

}  // namespace gnomon::app
