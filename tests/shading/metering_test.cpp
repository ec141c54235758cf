// SPDX-License-Identifier: MIT
// The metered exposure against sorting.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shading/surface.hpp"

namespace {

using namespace gnomon;

/// The exposure by the light that sorting finds. Sky is negative.
double sorted_ev(std::vector<float> lights) {
    std::erase_if(lights, [](float light) { return !(light >= 0); });
    if (lights.empty()) return 0;
    std::ranges::sort(lights);
    const double light = lights[static_cast<std::size_t>(0.95 * double(lights.size() - 1))];
    return light > 0 ? std::clamp(std::log2(0.8 / light), -8.0, 8.0) : 0;
}

void expect_sorted(std::vector<float> lights, const DeviceOptions& options) {
    const Device device({}, options);
    cl::Session& session = session_of(device);
    SurfaceBuffers buffers;
    session.upload(buffers.brightest, lights);
    const double wanted = sorted_ev(lights);
    EXPECT_EQ(metered_ev(session, buffers, lights.size()), wanted) << lights.size();
    EXPECT_EQ(metered_ev(session, buffers, lights.size()), wanted) << "with the buffers of the time before";
}

TEST(Metering, FindsTheLightThatSortingFinds) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> exponents(-30, 20), near_one(0.99f, 1.01f);
    for (const DeviceOptions& options : {DeviceOptions{}, DeviceOptions{.gpu_kernels = true},
                                         DeviceOptions{.work_group_size = 7, .gpu_kernels = true}}) {
        for (const std::size_t count : {1, 2, 20, 21, 22, 41, 1000, 70001}) {
            std::vector<float> wide, narrow, equal(count, 0.3f), with_sky;
            for (std::size_t i = 0; i < count; ++i) {
                wide.push_back(std::exp2(exponents(random)));
                narrow.push_back(near_one(random));
                with_sky.push_back(random() % 3 == 0 ? -1 : near_one(random));
            }
            for (const auto& lights : {wide, narrow, equal, with_sky}) expect_sorted(lights, options);
        }
        expect_sorted({-1, -1, -1}, options);
        expect_sorted({0, 0, 0, -1}, options);
        expect_sorted({1e-42f, 2e-42f, 3e-42f, INFINITY, NAN, -0.0f}, options);
    }
}

}  // namespace
