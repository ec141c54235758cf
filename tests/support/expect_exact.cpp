// SPDX-License-Identifier: MIT
#include "expect_exact.hpp"

#include <algorithm>

#include "rerun.hpp"

namespace support {

void AnswerTally::add(const std::vector<float>& truth) {
    const auto dark = static_cast<std::uint64_t>(std::ranges::count(truth, 0.0f));
    shadowed += dark;
    lit += truth.size() - dark;
}

void AnswerTally::add(const gnomon::Statistics& statistics) {
    uncertain += statistics.count("uncertain_pairs");
    by_map += statistics.count("points_decided_by_map");
    by_trace += statistics.count("points_decided_by_trace");
    by_exact += statistics.count("points_decided_by_exact");
}

std::unique_ptr<gnomon::Technique> technique_with(const gnomon::Device& device, const Settings& settings,
                                                  const std::string& name) {
    auto technique = gnomon::make_technique(name, device);
    for (const auto& [setting, value] : settings) technique->set(setting, value);
    return technique;
}

Answer answer(const gnomon::Device& device, gnomon::Technique& technique, const gnomon::Triangles& triangles,
              const gnomon::Points& points, const gnomon::Light& light, const gnomon::Facing& facing) {
    const gnomon::Visibility visibility(device, points.count());
    gnomon::Statistics statistics = technique.run(triangles, points, light, visibility, {.facing = facing});
    return {visibility.read(), std::move(statistics)};
}

Answer answer(const gnomon::Device& device, const LightScene& scene, const Settings& settings, Mode mode) {
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const auto technique = technique_with(device, settings);
    if (mode == Mode::prepared) {
        if (text_of(settings).find("map-size") == std::string::npos) technique->set("map-size", "128");
        technique->prepare(triangles, gnomon::Light{scene.light});
    }
    return answer(device, *technique, triangles, upload_points(device, scene), gnomon::Light{scene.light},
                  facing_of(scene.eye));
}

std::size_t expect_equal(const std::vector<float>& got, const std::vector<float>& wanted, const LightScene& scene,
                         const std::string& what) {
    const std::string title = scene.name + (what.empty() ? "" : ": " + what);
    EXPECT_EQ(got.size(), wanted.size()) << title;
    if (got.size() != wanted.size()) return wanted.size();
    std::size_t wrong = 0, false_shadows = 0, first = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        if (got[i] == wanted[i]) continue;
        if (wrong++ == 0) first = i;
        false_shadows += wanted[i] == 1;
    }
    if (wrong == 0) return 0;
    const Float3 point = vertex(scene.points, first);
    const std::uint32_t receiver = scene.receivers.empty() ? gnomon::no_receiver : scene.receivers[first];
    ADD_FAILURE() << title << ": " << wrong << " of " << got.size() << " points wrong (" << false_shadows
                  << " false shadows), first " << first << " at ("
                  << gnomon_test::rerun_numbers(point[0], point[1], point[2]) << "), "
                  << (receiver == gnomon::no_receiver ? "no receiver" : "receiver " + std::to_string(receiver)) << ": "
                  << got[first] << ", must be " << wanted[first] << "; light ("
                  << gnomon_test::rerun_numbers(scene.light[0], scene.light[1], scene.light[2])
                  << "; w = " << scene.light[3] << "), " << scene.triangles.size() / 9 << " triangles\n"
                  << gnomon_test::rerun_command(scene.triangles, point, receiver, scene.light, scene.eye);
    return wrong;
}

Answer expect_exact(const gnomon::Device& device, const LightScene& scene, const Settings& settings, AnswerTally& tally,
                    Mode mode, const std::vector<float>* truth) {
    std::vector<float> own_truth;
    if (!truth) tally.add(*(truth = &(own_truth = truth_of(scene))));
    Answer found = answer(device, scene, settings, mode);
    expect_equal(found.visibility, *truth, scene, text_of(settings) + (mode == Mode::prepared ? ", prepared" : ""));
    if (mode == Mode::animated) tally.add(found.statistics);
    tally.pairs += found.visibility.size() * (scene.triangles.size() / 9);
    return found;
}

}  // namespace support
