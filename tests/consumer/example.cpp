// SPDX-License-Identifier: MIT
// Which of these points does the sun reach? A roof, three points under and beside it, light from straight above.
#include <gnomon.hpp>

#include <cstdio>
#include <vector>

int main() try {
    // README begins
    const std::vector<float> roof{-1, 2, -1, 1, 2, -1, 1,  2, 1,   // two triangles, nine numbers each: a square roof,
                                  -1, 2, -1, 1, 2, 1,  -1, 2, 1};  // 2 m wide, 2 m above the ground
    const std::vector<float> ground{0, 0, 0, 1, 0, 0, 1.001f, 0, 0};  // under its middle, under its edge, beside it
    gnomon::Device device;  // the best there is; or Device("nvidia"), or your own cl_context and cl_command_queue
    const auto triangles = gnomon::Triangles::upload(device, roof);
    const auto points = gnomon::Points::upload(device, ground);
    const gnomon::Visibility visibility(device, points.count());
    const auto sun = gnomon::Light::directional({0, -1, 0});
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->run(triangles, points, sun, visibility);
    const std::vector<float> lit = visibility.read();  // 0, 0, 1: an edge blocks, it is part of the roof
    // README ends
    for (std::size_t i = 0; i < lit.size(); ++i)
        std::printf("point %zu is %s\n", i, lit[i] == 1 ? "in the light" : "in shadow");
    std::printf("%s\n", device.description().name.c_str());
    return lit == std::vector<float>{0, 0, 1} ? 0 : 1;
} catch (const gnomon::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
