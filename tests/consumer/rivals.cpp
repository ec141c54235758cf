// SPDX-License-Identifier: MIT
// The classic techniques of gnomon::full, beside the exact one: how many points of a floor under a tilted roof each of
// them gets wrong.
#include <gnomon.hpp>

#include <cstdio>

int main() {
    const std::vector<float> roof{-1, 2, -1, 1, 2.5f, -1, 1, 2.5f, 1};
    std::vector<float> floor;
    for (int z = 0; z < 64; ++z)
        for (int x = 0; x < 64; ++x) floor.insert(floor.end(), {float(x - 32) / 16, 0, float(z - 32) / 16});
    gnomon::add_rivals();
    const gnomon::Device device;
    const auto triangles = gnomon::Triangles::upload(device, roof);
    const auto points = gnomon::Points::upload(device, floor);
    const auto sun = gnomon::Light::directional({0.5f, -1, 0.25f});
    const gnomon::Visibility exact(device, points.count()), rival(device, points.count());
    gnomon::make_technique("frustum-traced", device)->run(triangles, points, sun, exact);
    const std::vector<float> truth = exact.read();
    for (const char* name : {"izb", "shadow-map"}) {
        gnomon::make_technique(name, device)->run(triangles, points, sun, rival);
        const std::vector<float> found = rival.read();
        int wrong = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) wrong += found[i] != truth[i];
        std::printf("%s: %s\n", name, wrong == 0 ? "exact" : wrong < 200 ? "a few points wrong" : "many points wrong");
    }
}
