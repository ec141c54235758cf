// SPDX-License-Identifier: MIT
// Stage depth_pass: the nearest caster at each texel's centre, against rays and triangles in double, under every kind
// of view; no cracks; second layers; slopes.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "occluders/clusters.hpp"
#include "support/map_scenes.hpp"

namespace {

using namespace support;
using Double3 = std::array<double, 3>;

Double3 minus(const Double3& a, const Double3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Double3 vertex3(const Floats& triangles, std::size_t i) {
    return {triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]};
}

/// Depth of the nearest hit, 1 if none; `certain` is false where a border of a triangle, or the plane of the light, is
/// so near that float may decide otherwise.
double nearest_depth(const RayOfLight& ray, const Floats& triangles, double front, bool& certain) {
    double nearest = 1;
    certain = true;
    for (std::size_t t = 0; t < triangles.size() / 9; ++t) {
        const Double3 a = vertex3(triangles, 3 * t), ab = minus(vertex3(triangles, 3 * t + 1), a),
                      ac = minus(vertex3(triangles, 3 * t + 2), a), p = cross(ray.direction, ac);
        const double det = dot(ab, p);
        if (std::fabs(det) < 1e-9) continue;  // edge-on, or of no size that these scenes have
        const Double3 from_a = minus(ray.origin, a), q = cross(from_a, ab);
        const double u = dot(from_a, p) / det, v = dot(ray.direction, q) / det, s = dot(ac, q) / det;
        const double inside = std::min({u, v, 1 - u - v});
        const double depth = s * ray.depth_per_s;
        // Barycentric coordinates are off by about 1e-7 / size; those of edge-on triangles by more.
        const double doubt = 1e-6 / std::fabs(det) + 1e-6;
        if (inside < -doubt || depth <= front - 1e-4) continue;
        if (inside < doubt || depth < front + 1e-4 || doubt > 1e-2) certain = certain && depth > nearest + 1e-3;
        if (inside >= 0 && depth > front) nearest = std::min(nearest, std::max(depth, 0.0));
    }
    return nearest;
}

std::vector<float> depths_of(gnomon::cl::Session& session, const gnomon::cl::Buffer& keys, std::size_t texels) {
    return downloaded<float>(session, keys.get(), texels);
}

std::vector<float> drawn(const gnomon::Device& device, std::vector<ViewCase>& cases, const Floats& triangles,
                         const gnomon::DepthBias& bias = {}, std::uint32_t capacity = 0) {
    gnomon::cl::Session& session = session_of(device);
    const gnomon::MapViews map_views = uploaded_views(session, cases);
    const Triangles inputs = uploaded_triangles(session, triangles);
    gnomon::DepthMap depths;
    if (capacity != 0) depths.limit_initial_capacity(capacity);
    depths.run(session, inputs.inputs, map_views, bias, false);
    return depths_of(session, depths.keys(), map_views.set.texels);
}

Double2 centre_of(const ViewCase& c, std::uint32_t texel) {
    return c.unwarp({(texel % c.view.width + 0.5) / c.view.width, (texel / c.view.width + 0.5) / c.view.height});
}

/// Small ones, ones over many tiles, and ones through the light's plane: around and before the views.
Floats casters(std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (const float size : {0.02f, 0.1f, 0.5f, 3.0f})
        for (int i = 0; i < 12; ++i) {
            const Float3 center{random.between(-0.2f, 1.2f), random.between(-0.2f, 1.2f), random.between(-0.3f, 1.2f)};
            for (int k = 0; k < 3; ++k) {
                Float3 v = random_vector(random, -size, size);
                for (int j = 0; j < 3; ++j) v[j] += center[j];
                add(triangles, v);
            }
        }
    return triangles;
}

TEST(DepthPass, NearestHitUnderEveryView) {
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) {
        const gnomon::Device device = device_with(group);
        for (const std::uint64_t seed : {1, 2, 3}) {
            auto cases = view_cases(75, 52);
            const Floats triangles = casters(seed);
            const std::vector<float> depths = drawn(device, cases, triangles);
            for (const ViewCase& c : cases) {
                std::uint32_t doubtful = 0, hits = 0, texels = c.view.width * c.view.height;
                for (std::uint32_t i = 0; i < texels; ++i) {
                    bool certain = true;
                    const double truth = nearest_depth(c.ray(centre_of(c, i)), triangles, c.view.front_depth, certain);
                    doubtful += !certain;
                    hits += truth < 1;
                    if (!certain) continue;
                    EXPECT_NEAR(depths[c.view.first_texel + i], truth, 2e-5) << c.name << ", texel " << i;
                }
                EXPECT_LT(doubtful, texels / 50) << c.name;
                EXPECT_GT(hits, texels / 10) << c.name;
            }
        }
    }
}

// A disc of triangles with vertices anywhere, and one with vertices exactly on texel centres: no centre inside is
// empty.
TEST(DepthPass, NoCracks) {
    const std::uint32_t size = 64;
    for (const bool on_centres : {false, true}) {
        Random random(5);
        const int side = on_centres ? 32 : 41;
        std::vector<Float3> corners;
        for (int y = 0; y <= side; ++y)
            for (int x = 0; x <= side; ++x) {
                const float jitter = on_centres ? 0 : 0.4f;
                const float px = float(x) + random.between(-jitter, jitter),
                            py = float(y) + random.between(-jitter, jitter);
                // On centres of texels: (2 k + 0.5) / 64.
                const float offset = on_centres ? 0.25f : -0.5f;
                corners.push_back({(px + offset) / 32, (py + offset) / 32, random.between(0.2f, 0.8f)});
            }
        Floats triangles;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const std::size_t i = std::size_t(y) * (side + 1) + x;
                const std::size_t next = i + 1, above = i + side + 1, across = i + side + 2;
                // Both windings, so that an edge function that is exactly 0 meets the other two with either sign.
                if (x % 2 == 0) {
                    add(triangles, corners[i], corners[next], corners[across]);
                    add(triangles, corners[across], corners[above], corners[i]);
                } else {
                    add(triangles, corners[across], corners[next], corners[i]);
                    add(triangles, corners[i], corners[above], corners[across]);
                }
            }
        std::vector<ViewCase> cases = view_cases(size, size);
        cases.erase(cases.begin() + 3);  // the point light's view lies elsewhere
        const std::vector<float> depths = drawn(device_with(), cases, triangles);
        for (const ViewCase& c : cases)
            for (std::uint32_t i = 0; i < size * size; ++i) {
                const Double2 uv = centre_of(c, i);
                const RayOfLight ray = c.ray(uv);
                const bool inside =
                    ray.origin[0] >= 0.02 && ray.origin[0] <= 0.98 && ray.origin[1] >= 0.02 && ray.origin[1] <= 0.98;
                if (!inside) continue;
                EXPECT_LT(depths[c.view.first_texel + i], 1.0f) << c.name << ", texel " << i;
            }
    }
}

// Long thin pairs of triangles whose common edge runs through a centre but for rounding: one of the two must have it,
// though neither may by its own rounding. A pair per four rows, so that no other covers for it.
TEST(DepthPass, NoCracksAlongEdgesThroughCentres) {
    const std::uint32_t size = 64;
    const gnomon::Device device = device_with();
    Random random(8);
    for (int round = 0; round < 40; ++round) {
        Floats triangles;
        for (std::uint32_t row = 2; row < size; row += 4) {
            const float x = 32.5f / size, y = (float(row) + 0.5f) / size, rise = random.between(-0.04f, 0.04f);
            const float before = random.between(0.2f, 0.4f), after = random.between(0.2f, 0.4f);
            const Float3 from{x - before, y - before * rise, 0.5f}, to{x + after, y + after * rise, 0.5f};
            add(triangles, from, to, {x, y - 0.3f / size, 0.5f});
            add(triangles, to, from, {x, y + 0.3f / size, 0.5f});
        }
        std::vector<ViewCase> cases{straight_view(size, size)};
        const std::vector<float> depths = drawn(device, cases, triangles);
        for (std::uint32_t row = 2; row < size; row += 4)
            EXPECT_LT(depths[row * size + 32], 1.0f) << "round " << round << ", row " << row;
    }
}

// ---- The same bits as a loop over all texels and triangles ----------------------------------------------------------

struct Vertex {
    float x, y, z, depth;  ///< (u w, v w, w, depth)
};

float row_at(const gnomon::float4& row, const Float3& q) {
    return row.values[0] * q[0] + row.values[1] * q[1] + row.values[2] * q[2] + row.values[3];
}

/// The contract's edge function (depth_pass.h) in float, along u and v.
struct Edge {
    float slope_u, slope_v, at_u, at_v;
};

Edge edge_of(Vertex a, Vertex b) {
    const auto order = [](const Vertex& v) { return std::tuple(-std::fabs(v.z), v.x, v.y, v.z); };
    float sign = 1;
    if (!(order(a) < order(b))) {
        std::swap(a, b);
        sign = -1;
    }
    const float u = a.x / a.z, v = a.y / a.z;
    return {-sign * a.z * (b.y - v * b.z), sign * a.z * (b.x - u * b.z), u, v};
}

/// A triangle's edge functions and depths in a view.
struct ReferenceCaster {
    Edge edges[3];
    float depth[3], n_u = 0, n_v = 0, s_u = 0, s_v = 0;
};

std::vector<ReferenceCaster> reference_casters(const Floats& triangles, const gnomon::MapView& view) {
    std::vector<ReferenceCaster> casters;
    for (std::size_t t = 0; t < triangles.size() / 9; ++t) {
        Vertex h[3];
        for (std::size_t k = 0; k < 3; ++k) {
            Float3 q;
            for (std::size_t c = 0; c < 3; ++c) q[c] = triangles[9 * t + 3 * k + c] - view.origin.values[c];
            h[k] = {row_at(view.row_u, q), row_at(view.row_v, q), row_at(view.row_w, q), row_at(view.row_depth, q)};
        }
        if (std::min({h[0].depth, h[1].depth, h[2].depth}) >= 1) continue;
        ReferenceCaster& c = casters.emplace_back();
        for (int i = 0; i < 3; ++i) {
            c.edges[i] = edge_of(h[(i + 1) % 3], h[(i + 2) % 3]);
            c.depth[i] = h[i].depth;
            c.n_u += c.edges[i].slope_u * h[i].depth, c.n_v += c.edges[i].slope_v * h[i].depth;
            c.s_u += c.edges[i].slope_u, c.s_v += c.edges[i].slope_v;
        }
    }
    return casters;
}

struct ReferenceHit {
    float depth, squared_slope;
};

/// Hits of the casters at (u, v), with the bias. All texels have one length.
std::vector<ReferenceHit> hits_at(const std::vector<ReferenceCaster>& casters, float front_depth, float u, float v,
                                  float texel_u, float texel_v, const gnomon::DepthBias& bias) {
    std::vector<ReferenceHit> hits;
    for (const ReferenceCaster& c : casters) {
        float e[3];
        for (int i = 0; i < 3; ++i)
            e[i] = c.edges[i].slope_u * (u - c.edges[i].at_u) + c.edges[i].slope_v * (v - c.edges[i].at_v);
        if (std::min({e[0], e[1], e[2]}) < 0 && std::max({e[0], e[1], e[2]}) > 0) continue;
        const float reciprocal = 1 / (e[0] + e[1] + e[2]);
        float depth = (e[0] * c.depth[0] + e[1] * c.depth[1] + e[2] * c.depth[2]) * reciprocal;
        if (!(depth > front_depth)) continue;
        const float slope_u = std::min(std::fabs((c.n_u - depth * c.s_u) * reciprocal) * texel_u, 1.0f);
        const float slope_v = std::min(std::fabs((c.n_v - depth * c.s_v) * reciprocal) * texel_v, 1.0f);
        if (bias.slope != 0) depth += std::min(bias.slope * std::max(slope_u, slope_v), bias.slope_limit);
        hits.push_back({std::clamp(depth, 0.0f, 1.0f), slope_u * slope_u + slope_v * slope_v});
    }
    return hits;
}

/// Leaves and walls: small, middling and large triangles, many behind others, some before the near plane.
Floats layers(std::uint64_t seed, std::size_t count) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const float size = i % 16 == 0 ? 1.0f : i % 4 == 0 ? 0.1f : 0.015f;
        const Float3 center{random.between(0, 1), random.between(0, 1), random.between(-0.3f, 1)};
        for (int k = 0; k < 3; ++k) {
            Float3 v = random_vector(random, -size, size);
            v[2] *= 0.3f;
            for (int c = 0; c < 3; ++c) v[c] += center[c];
            add(triangles, v);
        }
    }
    return triangles;
}

/// Of several windows; sides are powers of two, so that all texels have one length.
std::vector<ViewCase> views_of_windows() {
    return {straight_view(256, 128), projective_view(256, 128, 1), projective_view(128, 256, -1),
            perspective_view(256, 256)};
}

TEST(DepthPass, EqualsReference) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const Floats triangles = layers(3, 700);
    gnomon::DepthBias slope;
    slope.slope = 2;
    slope.slope_limit = 0.01f;
    for (const gnomon::DepthBias& bias : {gnomon::DepthBias{}, slope}) {
        auto cases = views_of_windows();
        const gnomon::MapViews map_views = uploaded_views(session, cases);
        const Triangles inputs = uploaded_triangles(session, triangles);
        gnomon::DepthMap depths;
        depths.run(session, inputs.inputs, map_views, bias, true);
        const auto keys = depths_of(session, depths.keys(), map_views.set.texels);
        const auto slopes = depths_of(session, depths.slopes(), map_views.set.texels);
        for (const ViewCase& c : cases) {
            const auto casters = reference_casters(triangles, c.view);
            const float texel_u = 1.0f / float(c.view.width), texel_v = 1.0f / float(c.view.height);
            std::size_t wrong = 0;
            for (std::uint32_t i = 0; i < c.view.width * c.view.height; ++i) {
                const float u = (float(i % c.view.width) + 0.5f) * texel_u;
                const float v = (float(i / c.view.width) + 0.5f) * texel_v;
                float nearest = 1, steepest = 0;
                const auto hits = hits_at(casters, c.view.front_depth, u, v, texel_u, texel_v, bias);
                for (const ReferenceHit& hit : hits) nearest = std::min(nearest, hit.depth);
                for (const ReferenceHit& hit : hits)
                    // A clamped depth, 0 or 1, has no slope.
                    if (hit.depth == nearest && nearest > 0 && nearest < 1)
                        steepest = std::max(steepest, hit.squared_slope);
                const std::size_t at = c.view.first_texel + i;
                wrong += keys[at] != nearest || slopes[at] != steepest;
            }
            EXPECT_EQ(wrong, 0u) << c.name << ", bias " << bias.slope;
        }
    }
}

// The second layer is the nearest key after the first.
TEST(DepthPass, SecondLayersEqualReference) {
    const Floats triangles = layers(4, 300);
    std::vector<ViewCase> cases{straight_view(256, 128)};
    gnomon::DepthBias bias;
    bias.dual_limit = 1;
    const std::vector<float> depths = drawn(device_with(), cases, triangles, bias);
    const auto casters = reference_casters(triangles, cases[0].view);
    std::size_t wrong = 0;
    for (std::uint32_t i = 0; i < 256 * 128; ++i) {
        float first = 1, second = 1;
        const float u = (float(i % 256) + 0.5f) / 256, v = (float(i / 256) + 0.5f) / 128;
        const auto hits = hits_at(casters, cases[0].view.front_depth, u, v, 1.0f / 256, 1.0f / 128, {});
        for (const ReferenceHit& hit : hits) first = std::min(first, hit.depth);
        for (const ReferenceHit& hit : hits)
            if (hit.depth > first) second = std::min(second, hit.depth);
        wrong += depths[i] != first + std::min(0.5f * (second - first), 1.0f);
    }
    EXPECT_EQ(wrong, 0u);
}

// Clusters here and there: in the views, across their borders, beside, before and behind them.
TEST(DepthPass, BoxesOfClustersChangeNothing) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    Random random(6);
    Floats triangles;
    for (int swarm = 0; swarm < 300; ++swarm) {
        const Float3 center{random.between(-0.5f, 1.5f), random.between(-0.5f, 1.5f), random.between(-0.5f, 1.5f)};
        for (std::uint32_t i = 0; i < CLUSTER_TRIANGLES; ++i)
            for (int k = 0; k < 3; ++k) {
                Float3 v = random_vector(random, -0.04f, 0.04f);
                for (int c = 0; c < 3; ++c) v[c] += center[c];
                add(triangles, v);
            }
    }
    auto cases = view_cases(200, 150);
    const std::vector<float> plain = drawn(device, cases, triangles);
    const gnomon::MapViews map_views = uploaded_views(session, cases);
    Triangles inputs = uploaded_triangles(session, triangles);
    const gnomon::Clusters clusters(device, inputs.inputs);
    inputs.inputs.clusters = &clusters;
    gnomon::DepthMap depths;
    depths.run(session, inputs.inputs, map_views, {}, false);
    EXPECT_EQ(plain, depths_of(session, depths.keys(), map_views.set.texels));
}

TEST(DepthPass, SurvivesDegenerates) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const Floats sound = layers(7, 200);
    Floats all = sound;
    for (const float bad : {nan, infinity, -infinity}) add(all, {0, 0, bad}, {1, 0, 0.1f}, {0, 1, 0.1f});
    add(all, {0.5f, 0.5f, 0.1f}, {0.5f, 0.5f, 0.1f}, {0.5f, 0.5f, 0.1f});  // a point
    add(all, {0.3f, 0.2f, 0.1f}, {0.3f, 0.2f, 0.5f}, {0.3f, 0.2f, 0.9f});  // along the light
    add(all, {0, 0, 3}, {1, 0, 2}, {0, 1, 3});                             // behind all receivers
    add(all, {5, 0, 0.1f}, {6, 0, 0.1f}, {5, 1, 0.1f});                    // beside the map
    std::vector<ViewCase> cases{straight_view(256, 128)};
    EXPECT_EQ(drawn(device_with(), cases, all), drawn(device_with(), cases, sound));
}

TEST(DepthPass, OrderAndGroupSizeDoNotMatter) {
    Floats triangles = casters(9), more = layers(9, 500);
    triangles.insert(triangles.end(), more.begin(), more.end());
    std::vector<float> first;
    for (const std::uint32_t group : {0u, 1u, 7u, 33u}) {
        Floats shuffled;
        for (const std::uint32_t t : shuffled_order(triangles.size() / 9, group))
            shuffled.insert(shuffled.end(), triangles.begin() + 9 * t, triangles.begin() + 9 * t + 9);
        auto cases = view_cases(150, 140);
        const std::vector<float> depths = drawn(device_with(group), cases, shuffled);
        if (first.empty()) first = depths;
        EXPECT_EQ(first, depths) << "group size " << group;
    }
}

TEST(DepthPass, Grows) {
    const Floats triangles = casters(4);
    auto cases = view_cases(512, 512);
    const gnomon::Device device = device_with();
    EXPECT_EQ(drawn(device, cases, triangles, {}, 1), drawn(device, cases, triangles));
}

/// Two parallel planes z = 0.25 + 0.1 x and z = 0.5 + 0.1 x over everything.
Floats two_planes() {
    Floats triangles;
    for (const float z : {0.25f, 0.5f}) add(triangles, {-1, -1, z - 0.1f}, {4, -1, z + 0.4f}, {-1, 4, z - 0.1f});
    return triangles;
}

TEST(DepthPass, DualLayersLieHalfWayButNoDeeperThanTheLimit) {
    std::vector<ViewCase> cases{straight_view(32, 32)};
    for (const auto& [limit, behind] : {std::pair{1.0f, 0.125f}, std::pair{0.01f, 0.01f}}) {
        gnomon::DepthBias bias;
        bias.dual_limit = limit;
        const std::vector<float> depths = drawn(device_with(), cases, two_planes(), bias);
        for (std::uint32_t i = 0; i < 32 * 32; ++i)
            EXPECT_NEAR(depths[i], 0.25 + 0.1 * (i % 32 + 0.5) / 32 + behind, 1e-6);
    }
}

TEST(DepthPass, SlopeBiasAndSlopesAreDepthPerTexel) {
    std::vector<ViewCase> cases{straight_view(32, 48)};
    const gnomon::Device device = device_with();
    gnomon::DepthBias bias;
    bias.slope = 2;
    // The plane rises 0.1 along u: 0.1 / 32 per texel.
    const std::vector<float> biased = drawn(device, cases, two_planes(), bias),
                             plain = drawn(device, cases, two_planes());
    bias.slope_limit = 0.001f;
    const std::vector<float> limited = drawn(device, cases, two_planes(), bias);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_NEAR(biased[i] - plain[i], 2 * 0.1 / 32, 1e-6);
        EXPECT_NEAR(limited[i] - plain[i], 0.001, 1e-6);
    }
    gnomon::cl::Session& session = session_of(device);
    const gnomon::MapViews map_views = uploaded_views(session, cases);
    const Triangles inputs = uploaded_triangles(session, two_planes());
    gnomon::DepthMap depths;
    depths.run(session, inputs.inputs, map_views, {}, true);
    for (const float slope : downloaded<float>(session, depths.slopes().get(), 32 * 48))
        EXPECT_NEAR(slope, std::pow(0.1 / 32, 2), 1e-9);
}

TEST(DepthPass, CastersBeforeTheNearPlaneAreClampedAndThoseBehindAPointLightAreNotSeen) {
    Floats triangles;
    add(triangles, {-9, -9, -0.5f}, {9, -9, -0.5f}, {0, 9, -0.5f});
    std::vector<ViewCase> cases{straight_view(16, 16), perspective_view(16, 16)};
    const std::vector<float> depths = drawn(device_with(), cases, triangles);
    for (std::uint32_t i = 0; i < 256; ++i) {
        EXPECT_EQ(depths[i], 0.0f);
        EXPECT_EQ(depths[256 + i], 1.0f);
    }
}

}  // namespace
