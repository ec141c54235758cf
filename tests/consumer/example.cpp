// SPDX-License-Identifier: MIT
// Which of these points does the sun reach? A roof, three points under and beside it, light from straight above.
#include <gnomon.hpp>

#include <cstdio>
#include <vector>

int main() try {
    // Two triangles make a square roof, 2 m above the ground and 2 m wide: nine numbers for each triangle.
    const std::vector<float> roof{-1, 2, -1, 1, 2, -1, 1,  2, 1,   //
                                  -1, 2, -1, 1, 2, 1,  -1, 2, 1};  //
    // Under the middle, exactly under the roof's edge, and beside the roof.
    const std::vector<float> ground{0, 0, 0, 1, 0, 0, 1.001f, 0, 0};

    gnomon::Device device;  // the best there is; or Device("nvidia"), or your own cl_context and cl_command_queue
    const auto triangles = gnomon::Triangles::upload(device, roof);
    const auto points = gnomon::Points::upload(device, ground);
    const gnomon::Visibility visibility(device, points.count());
    const auto sun = gnomon::Light::directional({0, -1, 0});

    const auto technique = gnomon::make_technique("frustum-traced", device);
    const gnomon::Statistics statistics = technique->run(triangles, points, sun, visibility);

    const std::vector<float> lit = visibility.read();  // 1 lit, 0 in shadow; an edge blocks: it is part of the roof
    for (std::size_t i = 0; i < lit.size(); ++i)
        std::printf("point %zu is %s\n", i, lit[i] == 1 ? "in the light" : "in shadow");
    std::printf("%s: %.3f ms\n", device.description().name.c_str(), statistics.total_wall_ms);
} catch (const gnomon::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
