// SPDX-License-Identifier: MIT
// A tree of leaves, a pergola, a fence and a veil, all cut out of textures or by the alpha of vertices: every wrap,
// both filters and several cutoffs, some with texels exactly at them.
#include <algorithm>
#include <array>

#include "recipes.hpp"
#include "shapes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr std::array<double, 3> green{0.20, 0.42, 0.10}, wood{0.40, 0.28, 0.18}, iron{0.30, 0.32, 0.36};

/// A texture of one colour whose alpha is alpha_of(x, y).
Mask mask_of(std::uint32_t side, const std::array<std::uint8_t, 3>& color, double cutoff, Mask::Filter filter,
             Mask::Wrap wrap, auto alpha_of) {
    Mask mask{cutoff, side, side, {}, filter, wrap};
    for (int y = 0; y < int(side); ++y)
        for (int x = 0; x < int(side); ++x) {
            mask.rgba.insert(mask.rgba.end(), color.begin(), color.end());
            mask.rgba.push_back(std::uint8_t(alpha_of(x, y)));
        }
    return mask;
}

/// A leaf of 64 x 64 texels from its stem at the left to its tip: a parabola on each side, soft for four texels.
int leaf_alpha(int x, int y) {
    const int inside = 4 * x * (63 - x) - 70 * (2 * y > 63 ? 2 * y - 63 : 63 - 2 * y) + 400;
    return std::clamp(inside / 2, 0, 255);
}

/// Wires crossing the texture, whose texels lie on both sides of the cutoffs .2, .4, .5, .6 and .8, and at them.
int wires_alpha(int x, int y) {
    static constexpr std::array ties{51, 102, 127, 128, 153, 204, 203, 50};
    if (x % 8 == 0 || y % 8 == 0) return 255;
    return (x + y) % 5 == 0 ? ties[std::size_t(3 * x + y) % ties.size()] : 0;
}

struct Corner {
    Vec3 position;
    double u, v;
};

void textured_quad(Part& part, const std::array<Corner, 4>& corners) {
    std::array<std::uint32_t, 4> index{};
    for (std::size_t i = 0; i < 4; ++i) {
        index[i] = part.vertex(corners[i].position);
        part.coordinates.insert(part.coordinates.end(), {float(corners[i].u), float(corners[i].v)});
    }
    part.quad(index[0], index[1], index[2], index[3]);
}

/// Leaves at random around the crown; each second one shows the texture mirrored.
void crown(Part& part, Random& random, int count) {
    for (int i = 0; i < count; ++i) {
        const CosineSine turn = cosine_sine(random.unit()), tilt = cosine_sine(random.between(-0.2, 0.2));
        const double reach = random.between(0.2, 1.3), height = random.between(1.4, 3.2);
        const Vec3 at{reach * turn.cosine, height, reach * turn.sine};
        const Vec3 along = Vec3{turn.cosine * tilt.cosine, tilt.sine, turn.sine * tilt.cosine} * 0.3;
        const Vec3 across = Vec3{-turn.sine, random.between(-0.4, 0.4), turn.cosine} * 0.12;
        const double left = i % 2 == 0 ? 0 : 1;
        textured_quad(part, {Corner{at - across, left, 1}, Corner{at + along - across, 1 - left, 1},
                             Corner{at + along + across, 1 - left, 0}, Corner{at + across, left, 0}});
    }
}

/// Without a texture: the alpha of the vertices falls from 1 at the bottom to 0 at the top.
void veil(Part& part) {
    for (int i = 0; i <= 8; ++i) {
        for (const double y : {0.0, 1.5}) {
            part.vertex({-2.5 + 0.25 * i, y, 1.75 + (i % 2) * 0.25});
            part.alphas.push_back(y > 0 ? float(i % 3) / 8 : 1);
        }
        const auto last = std::uint32_t(2 * i);
        if (i > 0) part.quad(last - 2, last, last + 1, last - 1);
    }
}

}  // namespace

Scene make_leaves(const Request& request) {
    Random random(request.seed);
    Scene scene;
    floor_quad(scene.part("soil", {0.45, 0.40, 0.30}), -4, -4, 4, 4, 0);
    bar(scene.part("trunk", wood), {0, -0.25, 0}, {0, 2.5, 0}, 0.25);

    Part& leaves = scene.part("leaves", {1, 1, 1});
    leaves.mask = mask_of(64, {110, 160, 70}, 0.5, Mask::linear, Mask::clamp, leaf_alpha);
    crown(leaves, random, 300);
    Part& ivy = scene.part("ivy", green);
    ivy.mask = mask_of(64, {255, 255, 255}, 0.8, Mask::nearest, Mask::repeat, leaf_alpha);
    crown(ivy, random, 60);

    // Corners of the pergola are multiples of 1/4, and its texels have sides of 1/64: hits fall on their borders.
    const auto roof = [](double x, double y, double z, double times) {
        const Vec3 u{1.5, 0, 0}, v{0, 0, 1.5}, at{x, y, z};
        return std::array{Corner{at, -times, -times}, Corner{at + v, -times, times}, Corner{at + u + v, times, times},
                          Corner{at + u, times, -times}};
    };
    Part& pergola = scene.part("pergola", wood);
    pergola.mask = mask_of(16, {255, 255, 255}, 0.4, Mask::nearest, Mask::mirror, wires_alpha);
    for (const double x : {1.5, -3.0}) textured_quad(pergola, roof(x, 2, -3, 3));
    Part& net = scene.part("net", iron);
    net.mask = mask_of(16, {255, 255, 255}, 0.2, Mask::linear, Mask::repeat, wires_alpha);
    textured_quad(net, roof(1.5, 1.5, 0.25, 2));

    Part& fence = scene.part("fence", iron);
    fence.mask = mask_of(16, {255, 255, 255}, 0.6, Mask::linear, Mask::mirror, wires_alpha);
    textured_quad(fence, {Corner{{-3.5, 0, -2.5}, 0, 2}, Corner{{3.5, 0, -2.75}, 14, 2}, Corner{{3.5, 1, -2.75}, 14, 0},
                          Corner{{-3.5, 1, -2.5}, 0, 0}});
    Part& cloth = scene.part("veil", {0.75, 0.30, 0.25});
    cloth.mask = Mask{0.5, 0, 0, {}, Mask::linear, Mask::repeat};
    veil(cloth);

    scene.camera("main", {3.5, 3.25, 5.5}, {0, 1.25, 0});
    scene.camera("under_the_leaves", {0.75, 0.5, 1.25}, {-0.5, 2.5, -0.5}, 70);
    scene.directional("sun", {-0.5, -1, -0.25});
    scene.directional("straight_down", {0, -1, 0});
    scene.directional("low", {1, -0.25, -0.5});
    scene.point("lamp", {0, 3.5, 0.25});
    return scene;
}

}  // namespace gnomon::make_scenes
