// SPDX-License-Identifier: MIT
// A floor seen by a camera, with casters over it: masks of any technique, and how they differ from the truth.
#pragma once

#include "device.hpp"
#include "expect_exact.hpp"

namespace support {

/// Two slanted directional lights and a point light.
inline const std::vector<gnomon::Light>& lights() {
    static const std::vector<gnomon::Light> all = {gnomon::Light::directional({-0.4f, -1, -0.3f}),
                                                   gnomon::Light::directional({1, -0.75f, 0.5f}),
                                                   gnomon::Light::point({0.5f, 3, 0.25f})};
    return all;
}

inline Floats over_a_floor(const Floats& casters) {
    Floats triangles;
    add(triangles, {-6, -1, -6}, {-6, -1, 6}, {6, -1, 6});
    add(triangles, {-6, -1, -6}, {6, -1, 6}, {6, -1, -6});
    append(triangles, casters);
    return triangles;
}

inline const Floats one_triangle{-1, 0.5f, -1, 1, 0.75f, -0.5f, 0, 0.25f, 1};

struct Errors {
    std::size_t wrongly_lit = 0, wrongly_shadowed = 0, in_shadow = 0, lit = 0;
};

inline Errors errors_of(const std::vector<float>& mask, const std::vector<float>& truth) {
    Errors errors;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        errors.wrongly_lit += mask[i] == 1 && truth[i] == 0;
        errors.wrongly_shadowed += mask[i] == 0 && truth[i] == 1;
        errors.in_shadow += truth[i] == 0;
        errors.lit += truth[i] == 1;
    }
    return errors;
}

inline double mean_error(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::fabs(double(a[i]) - b[i]);
    return sum / double(a.size());
}

/// A camera above the floor, and any technique's mask of it.
class FloorView : public testing::Test {
protected:
    static constexpr std::uint32_t width = 128, height = 96;

    std::vector<float> run(const Floats& scene, const gnomon::Light& light, const std::string& technique,
                           const Settings& settings = {}) {
        const auto triangles = gnomon::Triangles::upload(device_, scene);
        const auto camera = gnomon::Camera::look_at({0, 2, 4}, {0, -0.25f, 0}, {0, 1, 0}, 60);
        const gnomon::View view = gnomon::look(device_, triangles, camera, width, height);
        Answer found = answer(device_, *technique_with(device_, settings, technique), triangles, view.points, light);
        statistics_ = found.statistics;
        return found.visibility;
    }

    Errors errors(const Floats& scene, const gnomon::Light& light, const std::string& technique,
                  const Settings& settings = {}) {
        const std::vector<float> truth = run(scene, light, "frustum-traced");
        return errors_of(run(scene, light, technique, settings), truth);
    }

    gnomon::Device device_;
    gnomon::Statistics statistics_;  ///< of the last run
};

}  // namespace support
