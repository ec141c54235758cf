// SPDX-License-Identifier: MIT
// One point's explanation as text: the same run as render's with the exact technique, on the same points.
#include "options.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "explained.hpp"
#include "miss_distance.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

bool is_absent(const Explanation& e) {
    return !std::all_of(e.position.begin(), e.position.end(), [](float c) { return std::isfinite(c); });
}

constexpr std::size_t max_printed = 8;  // triangles of a list; gnomon::explain() has all

Points given_point(const ExplainOptions& options, const Device& device, std::size_t triangle_count) {
    if (options.receiver && *options.receiver >= triangle_count)
        throw Error(fmt::format("--receiver {} is no triangle: the scene has {}, counted from 0", *options.receiver,
                                triangle_count));
    const std::array receiver{options.receiver.value_or(no_receiver)};
    return Points::upload(device, *options.point, receiver);
}

/// One sample of the pixel, among all points of that sample's batch, in render's order.
Explanation explain_sample(const ExplainOptions& options, const Device& device, const Triangles& triangles,
                           const View& view, const Light& light, std::size_t pixel) {
    Explanation explanation;
    std::size_t first = 0;  // sample of the batch
    const std::size_t pixels = view.points.count();
    const auto technique = gnomon::make_technique("frustum-traced", device);
    const SampleSink sink = [&](const Points& points) {
        const std::size_t count = points.count() / pixels;
        if (options.sample >= first && options.sample < first + count)
            explanation = gnomon::explain(device, triangles, points, (options.sample - first) * pixels + pixel, light);
        first += count;
    };
    run_samples(*technique, triangles, view, light, options.samples, Visibility(device, pixels), sink);
    return explanation;
}

Explained explain_in(const ExplainOptions& options, const Device& device, const scene::Scene& scene) {
    Explained explained{{}, "a point of its own", choose_light(options, scene)};
    const Light& light = explained.light.light;
    const Triangles triangles = upload_triangles(device, scene);
    if (options.point) {
        const Points points = given_point(options, device, triangles.count());
        const Facing facing = options.eye ? Facing::eye(*options.eye) : Facing::none();
        explained.explanation = gnomon::explain(device, triangles, points, 0, light, facing);
        return explained;
    }
    const auto [width, height] = options.size;
    const auto [x, y] = *options.pixel;
    const ChosenCamera camera = choose_camera(options, scene);
    print_camera_note(options, scene, camera);
    const View view = look(device, triangles, camera.camera, width, height);
    const std::size_t pixel = std::size_t(y) * width + x;
    explained.where = where_of(options, camera);
    explained.explanation = options.samples > 1 ? explain_sample(options, device, triangles, view, light, pixel)
                                                : gnomon::explain(device, triangles, view.points, pixel, light);
    return explained;
}

char sign(int of) { return of > 0 ? '+' : of < 0 ? '-' : '0'; }

std::string vertices_text(const TriangleSigns& t) {
    const auto vertex = [&](std::size_t i) {
        return fmt::format("({})", float3_text({t.vertices[i], t.vertices[i + 1], t.vertices[i + 2]}));
    };
    return vertex(0) + " " + vertex(3) + " " + vertex(6);
}

/// `after` tells more of a triangle.
template <typename After>
void add_triangles(std::ostream& out, const std::string& heading, const std::vector<TriangleSigns>& list,
                   const After& after) {
    if (list.empty()) return;
    out << '\n' << heading << ": " << grouped(list.size()) << '\n';
    for (std::size_t i = 0; i < std::min(list.size(), max_printed); ++i) {
        const TriangleSigns& t = list[i];
        out << "  triangle " << t.triangle << "  " << vertices_text(t)
            << fmt::format("\n    signs: point's side {}, light's side {}, edges ab {} bc {} ca {}; certain in ",
                           sign(t.point_side), sign(t.light_side), sign(t.edges[0]), sign(t.edges[1]), sign(t.edges[2]))
            << t.arithmetic << "; " << after(t) << '\n';
    }
    if (list.size() > max_printed) out << "  and " << grouped(list.size() - max_printed) << " more\n";
}

}  // namespace

std::string reason(const Explanation& e) {
    if (is_absent(e)) return "the point is absent (a pixel of the sky): lit by definition";
    if (e.stage == "facing" && e.arithmetic == "none") return "no triangle can be between the point and the light";
    if (e.stage == "facing")
        return "the point is backfacing: the light is not strictly on the eye's side of the receiver's plane";
    if (e.stage == "conservative_map") return "one triangle covers the point's whole texel, nearer to the light";
    if (e.stage == "trace") return "the float filter was certain for every triangle that mattered";
    return "the filter left pairs undecided, and the exact predicate decided them";
}

std::vector<TriangleSigns> near_misses_of(const Explained& explained) {
    const Explanation& e = explained.explanation;
    if (e.stage == "facing" || e.arithmetic == "filter") return {};
    std::vector<TriangleSigns> sorted = e.near_misses;
    sort_by_miss_distance(sorted, e.position, explained.light.light);
    return sorted;
}

std::string text_of(const Explained& explained) {
    const Explanation& e = explained.explanation;
    const Light& light = explained.light.light;
    std::ostringstream out;
    const auto& [x, y, z] = e.position;
    out << explained.where << "\npoint     " << float3_text(e.position)
        << fmt::format("\n          {:a},{:a},{:a}\n", double(x), double(y), double(z));
    if (e.receiver == no_receiver) {
        out << "receiver  none\n";
    } else {
        out << "receiver  triangle " << e.receiver << "  " << vertices_text(e.on_receiver)
            << "\n          signs: point's side " << sign(e.on_receiver.point_side) << ", light's side "
            << sign(e.on_receiver.light_side);
        if (e.eye_side != 0) out << ", eye's side " << sign(e.eye_side);
        out << '\n';
    }
    out << "light     " << light_option(explained.light) << " (" << explained.light.source << ")\n"
        << "result    " << (e.is_lit() ? "lit" : "in shadow") << ": " << reason(e) << '\n'
        << "decided   by the stage " << e.stage << ", arithmetic: " << e.arithmetic << '\n';
    const auto distance = [](const TriangleSigns& t) { return float_text(float(t.distance)) + " from the point"; };
    add_triangles(out, "block the shadow ray, nearest first", e.occluders, distance);
    add_triangles(out, "let the shadow ray pass, which meets them where their texture is clear, nearest first",
                  e.clear_hits, distance);
    add_triangles(out, "do not block, and the exact predicate's level float was not certain, least missed first",
                  near_misses_of(explained), [&](const TriangleSigns& t) {
                      return fmt::format("missed by {:.3g}, rounded", miss_distance(t, e.position, light));
                  });
    return out.str();
}

std::string where_of(const ExplainOptions& options, const ChosenCamera& camera) {
    const auto& [width, height] = options.size;
    const auto& [x, y] = *options.pixel;
    std::string where = fmt::format("pixel {},{} of {}x{} ({})", x, y, width, height, camera.source);
    if (options.samples > 1) where += fmt::format(", sample {} of {}", options.sample, options.samples);
    return where;
}

void explain(const ExplainOptions& options) {
    const Device device = open_device(options, false);
    const scene::Scene scene = options.triangles ? load_triangles(*options.triangles) : load_scene(options);
    const Explained explained = explain_in(options, device, scene);
    print_result(text_of(explained));
    if (!explained.explanation.is_consistent())
        throw Error("the technique's answer is not the one of the exact signs: gnomon is wrong here, please report it");
}

}  // namespace gnomon::app
