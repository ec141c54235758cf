// SPDX-License-Identifier: MIT
// Cases about cut-outs: where a texture decides, and everything about it that can be exactly on the border.
#include <cmath>

#include "cases.hpp"
#include "scenes.hpp"
#include "support/tie_points.hpp"

namespace stress {
namespace {

using reference::MaskMaterial;
using reference::Masks;
using reference::MaskTexture;
using reference::MaskWrap;
using support::along;
using support::at;

std::shared_ptr<const support::CutOutData> shared(Masks masks) {
    return std::make_shared<const support::CutOutData>(std::move(masks));
}

std::size_t count_of(const Floats& triangles) { return triangles.size() / 9; }

Subject subject_of(const Floats& triangles, Masks masks) {
    Subject subject{std::make_shared<const Floats>(triangles), {}};
    for (const auto& [name, light] : support::lights_of_every_kind()) subject.lights.push_back(light);
    subject.views = {{{0.7f, 1.1f, 2.4f}, {0, 0, 0}}};
    subject.cut_outs = shared(std::move(masks));
    return subject;
}

Subject lattice_subject(const Floats& triangles, Masks masks) {
    Subject subject = subject_of(triangles, std::move(masks));
    subject.reach = 4;
    subject.views.clear();
    subject.lights = {along(1, 0, 0), along(1, 1, 0),  along(1, 1, 1),  along(0, -1, 0), along(-1, 2, 3),
                      at(2, 7, 2),    along(1, -1, 1), along(3, -1, 2), at(20, 40, 20)};
    return subject;
}

Masks masks_of(const Floats& triangles, std::vector<MaskMaterial> materials, std::vector<MaskTexture> textures,
               Random& random, auto coordinate) {
    Masks masks;
    masks.materials = std::move(materials);
    masks.textures = std::move(textures);
    for (std::size_t i = 0; i < count_of(triangles); ++i) {
        masks.material.push_back(random.below(std::uint32_t(masks.materials.size())));
        for (int k = 0; k < 6; ++k) masks.coordinates.push_back(coordinate());
    }
    return masks;
}

MaskWrap random_wrap(Random& random) { return MaskWrap(random.below(3)); }

/// Texels exactly at the four cutoffs, and 127 beside 128.
MaskTexture texture_of_ties(Random& random, std::uint32_t side) {
    const std::uint8_t ties[] = {0, 51, 102, 127, 128, 153, 204, 255};
    return support::made_texture(side, side, [&](auto, auto) { return ties[random.below(8)]; });
}

std::vector<MaskMaterial> materials_of_ties(Random& random, std::size_t textures) {
    std::vector<MaskMaterial> materials;
    for (const float cutoff : {0.2f, 0.4f, 0.5f, 0.6f, 0.8f, 1.0f, 0.0f, 127.0f / 255, 128.0f / 255})
        for (const bool is_linear : {false, true})
            for (std::size_t i = 0; i < textures; ++i)
                materials.push_back({std::int64_t(i), random_wrap(random), random_wrap(random), is_linear, cutoff});
    return materials;
}

Subject mixed(std::uint64_t seed, bool has_alphas) {
    const Floats triangles = support::soup(120, 0.7f, seed);
    return subject_of(triangles, support::mixed_masks(count_of(triangles), seed, has_alphas));
}

// Corners of triangles are whole numbers, and coordinates multiples of half a texel: hits lie exactly on borders and
// centres of texels.
Subject ties(std::uint64_t seed) {
    Random random(seed);
    const Floats triangles = support::lattice_blocks(6, 5, seed);
    return lattice_subject(triangles, masks_of(triangles, materials_of_ties(random, 2),
                                               {texture_of_ties(random, 8), texture_of_ties(random, 4)}, random,
                                               [&] { return float(int(random.below(65)) - 32) / 16; }));
}

// From a few denormals to the farthest texel that is decided.
Subject huge_and_tiny(std::uint64_t seed) {
    Random random(seed);
    const Floats triangles = support::soup(120, 0.7f, seed);
    const auto coordinate = [&] {
        const float sign = random.below(2) == 0 ? 1.0f : -1.0f;
        return sign * std::ldexp(random.between(0.5f, 1), int(random.below(176)) - 149);
    };
    return subject_of(triangles,
                      masks_of(triangles, materials_of_ties(random, 2),
                               {texture_of_ties(random, 8), texture_of_ties(random, 5)}, random, coordinate));
}

Subject large_and_small_textures(std::uint64_t seed) {
    Random random(seed);
    const Floats triangles = support::soup(120, 0.7f, seed);
    const MaskTexture one = support::made_texture(1, 1, [](auto, auto) { return 128; });
    const MaskTexture large = support::made_texture(8192, 8192, [&](auto, auto) { return random.below(256); });
    const MaskTexture row = support::made_texture(257, 1, [&](auto, auto) { return random.below(256); });
    return subject_of(triangles, masks_of(triangles, materials_of_ties(random, 3), {one, large, row}, random,
                                          [&] { return random.between(-2, 2); }));
}

// Pairs of triangles that share an edge, with mirrored texture coordinates, seen from both sides.
Subject mirrored_leaves(std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    Masks masks;
    masks.textures = {texture_of_ties(random, 16)};
    masks.materials = materials_of_ties(random, 1);
    for (int i = 0; i < 60; ++i) {
        const std::uint32_t material = random.below(std::uint32_t(masks.materials.size()));
        const Float3 a = support::random_vector(random, -1, 1), b = support::random_vector(random, -1, 1);
        const std::array<float, 4> stem{random.between(0, 1), 0, random.between(0, 1), 1};
        for (const float side : {1.0f, -1.0f}) {
            Float3 tip = support::random_vector(random, -1, 1);
            support::add(triangles, side > 0 ? a : b, side > 0 ? b : a, tip);
            masks.material.push_back(material);
            const std::array<float, 4> uv = side > 0 ? stem : std::array<float, 4>{stem[2], stem[3], stem[0], stem[1]};
            masks.coordinates.insert(masks.coordinates.end(), uv.begin(), uv.end());
            masks.coordinates.insert(masks.coordinates.end(), {side * random.between(0, 1), 0.5f});
        }
    }
    return subject_of(triangles, masks);
}

// Every width of the integers that decide.
Case all_ranges(std::uint64_t seed) {
    const auto scene_of = [=](std::uint64_t variant, std::size_t more_points) {
        for (reference::TestScene& scene : reference::all_test_scenes(100 * seed + variant, more_points))
            if (scene.name == "all of float's range") return scene;
        throw std::logic_error("the reference has no scene of all of float's range");
    };
    const auto points = [=](const PointRequest& request, Question& question) {
        const reference::TestScene scene = scene_of(request.variant, request.count / 160 + 1);
        question.points = scene.points;
        question.receivers = scene.receivers;
    };
    return {"cut-outs, all of float's range",
            "coordinates of 1e-45 to 3.4e38, textures too, and alphas of corners",
            [=](auto v) {
                const reference::TestScene scene = scene_of(v, 1);
                Masks masks = huge_and_tiny(seed + v).cut_outs->masks();
                masks.material.resize(count_of(scene.triangles));  // of its 120
                masks.coordinates.resize(6 * count_of(scene.triangles));
                Random random(seed + v);
                for (std::size_t i = 0; i < 3 * count_of(scene.triangles) && v % 2 == 0; ++i)
                    masks.alphas.push_back(std::ldexp(random.between(0.5f, 1), -int(random.below(140))));
                Subject subject = subject_of(scene.triangles, masks);
                subject.lights.clear();
                for (const Light& light : scene.lights)
                    if (light[3] != 0 || light[0] != 0 || light[1] != 0 || light[2] != 0)
                        subject.lights.push_back(light);
                subject.views.clear();
                return subject;
            },
            {points},
            0.02,
            8,
            5'000};
}

}  // namespace

void add_cut_outs(std::vector<Case>& list, std::uint64_t seed) {
    const std::vector<MakePoints> anywhere{points_in_the_cube, points_near_triangles, points_on_rays, points_of_a_view};
    constexpr double share = 0.2;  // the oracle's rationals take their time
    constexpr std::size_t largest = 50'000;
    list.push_back({"cut-outs", "all filters, wraps and cutoffs", [=](auto v) { return mixed(seed + v, false); },
                    anywhere, share, 4, largest});
    list.push_back({"cut-outs, alphas of corners", "the same times a vertex alpha",
                    [=](auto v) { return mixed(seed + v, true); }, anywhere, share, 4, largest});
    list.push_back({"cut-outs, exact ties",
                    "hits on borders and centres of texels, texels exactly at the cutoff",
                    [=](auto v) { return ties(seed + v); },
                    {points_on_lattice, points_exactly_behind, points_on_rays},
                    share,
                    8,
                    largest});
    list.push_back({"cut-outs, huge and tiny coordinates", "from denormals to the farthest texel that is decided",
                    [=](auto v) { return huge_and_tiny(seed + v); }, anywhere, share, 4, largest});
    list.push_back({"cut-outs, large and small textures", "8192 x 8192 texels, one, and one row",
                    [=](auto v) { return large_and_small_textures(seed + v); }, anywhere, share, 2, largest});
    list.push_back({"cut-outs, mirrored leaves", "pairs of triangles with mirrored coordinates",
                    [=](auto v) { return mirrored_leaves(seed + v); }, anywhere, share, 4, largest});
    list.push_back(all_ranges(seed));
}

}  // namespace stress
