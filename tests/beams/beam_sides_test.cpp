// SPDX-License-Identifier: MIT
// Stages beam_sides and point_light_planes: no plane of a beam culls what a shadow ray of the beam meets. The boxes
// end at a place on a ray, and the triangles block a ray by the exact predicate.
#include <gtest/gtest.h>

#include <iostream>

#include "support/block_cases.hpp"
#include "support/kernel_file.hpp"

namespace {

using namespace support;

/// A box, and whether a ray of the beam meets it for certain.
struct Box {
    Float3 low, high;
    bool must_be_met;
};

/// Rounded outward, so it is as thin as it can be, or from there on to one side.
Box box_around(Random& random, const Wide3& place, double scale) {
    Box box{rounded(place), rounded(place), true};
    for (int c = 0; c < 3; ++c) {
        if (box.low[c] > place[c]) box.low[c] = std::nextafter(box.low[c], -INFINITY);
        if (box.high[c] < place[c]) box.high[c] = std::nextafter(box.high[c], INFINITY);
        const float wider = float(scale * random.between(0, 1));
        const std::uint32_t kind = random.below(4);
        if (kind == 0) box.low[c] -= wider;
        if (kind == 1) box.high[c] += wider;
    }
    return box;
}

Box box_anywhere(Random& random, const BlockCase& of) {
    Box box{{}, {}, false};
    for (int c = 0; c < 3; ++c) {
        box.low[c] = float(of.middle[c] + of.scale * random.between(-2, 2));
        box.high[c] = float(box.low[c] + of.scale * random.between(0, 0.1f));
    }
    return box;
}

/// Half of a node's boxes lie on rays; of a point beam, those of the first point.
std::vector<Box> boxes_of(Random& random, const BlockCase& of, bool is_point_beam, long double begin) {
    std::vector<Box> boxes;
    for (std::size_t k = 0; k < of.points.size(); ++k) {
        const std::size_t point = is_point_beam ? 0 : random.below(std::uint32_t(of.points.size()));
        const Light& light = of.lights[random.below(std::uint32_t(of.lights.size()))];
        const long double t = begin + parameter_on_ray(random, of);
        const Wide3 place = place_on_ray(of.points[point], light, t);
        boxes.push_back(k % 2 == 0 ? box_around(random, place, of.scale) : box_anywhere(random, of));
    }
    return boxes;
}

void append_node(Floats& nodes, const std::vector<Box>& boxes) {
    for (const auto side : {&Box::low, &Box::high})
        for (int c = 0; c < 3; ++c)
            for (const Box& box : boxes) nodes.push_back((box.*side)[c]);
    nodes.insert(nodes.end(), boxes.size(), 0.0f);  // codes
}

/// The inputs of the kernels, case by case.
struct Inputs {
    Floats positions, normals, roundings, nodes, leaves;
    std::vector<gnomon::LightCone> cones;
    std::vector<std::vector<Box>> boxes;
    gnomon::PointsLayout layout{};

    void add_case(const BlockCase& one, const Float3& normal, std::vector<Box> some) {
        for (const Float3& p : one.points) add(positions, p);
        add(normals, normal);
        float largest = one.largest();
        for (const Box& box : some)
            for (int c = 0; c < 3; ++c) largest = std::max({largest, std::abs(box.low[c]), std::abs(box.high[c])});
        EXPECT_LE(largest, BVH_MAX_COORDINATE);
        roundings.push_back(beam_rounding(largest, one.are_positions()));
        append_node(nodes, some);
        append_leaf(leaves, one.triangles);
        cones.push_back(one.bundle.cones[0]);
        boxes.push_back(std::move(some));
        layout.point_stride = 3;
        layout.coordinate_stride = 1;
        layout.count = cl_uint(positions.size() / 3);
    }
};

struct Tally {
    std::size_t boxes = 0, boxes_culled = 0, pairs = 0, triangles_culled = 0;
};

void expect_boxes_met(const Inputs& in, const std::vector<std::uint32_t>& met, Tally& tally) {
    for (std::size_t i = 0; i < met.size(); ++i)
        for (std::size_t k = 0; k < in.boxes[i].size(); ++k) {
            const bool is_met = (met[i] >> k & 1) != 0, must_be = in.boxes[i][k].must_be_met;
            ++tally.boxes;
            tally.boxes_culled += !is_met;
            ASSERT_TRUE(is_met || !must_be) << "case " << i << ", box " << k;
        }
}

/// For the first few lights of the cone.
void expect_triangles_met(const std::vector<BlockCase>& cases, const std::vector<std::uint32_t>& met,
                          const std::vector<std::uint32_t>& points_met, Tally& tally) {
    reference::Effort effort;
    for (std::size_t i = 0; i < cases.size(); ++i)
        for (std::size_t k = 0; k < cases[i].triangles.size(); ++k) {
            const bool is_met = (met[i] >> k & 1) != 0;
            const std::uint32_t by_points = points_met[i * cases[i].triangles.size() + k];
            tally.triangles_culled += !is_met;
            for (std::size_t p = 0; p < cases[i].points.size(); ++p)
                for (std::size_t l = 0; l < std::min<std::size_t>(cases[i].lights.size(), 6); ++l) {
                    const auto ray = reference::Ray::to_light(cases[i].points[p], cases[i].lights[l]);
                    if (!reference::blocks(ray, cases[i].triangles[k], effort)) continue;
                    ++tally.pairs;
                    ASSERT_TRUE(is_met && (by_points >> p & 1) != 0)
                        << "case " << i << ", triangle " << k << ", point " << p << ", light " << l;
                }
        }
}

constexpr const char* KERNELS = "beams/beam_sides_test.cl";

gnomon::cl::Kernel kernel_of(const char* name, bool are_positions) {
    return {KERNELS, name, {.point_lights = are_positions}};
}

const gnomon::cl::LocalBytes LOCAL{BEAM_LOCAL_WORDS * sizeof(cl_uint)};

void expect_blocks_cull_nothing_met(bool gpu_kernels, bool are_positions) {
    const gnomon::Device device = device_of(gpu_kernels);
    gnomon::cl::Session& session = session_of(device);
    add_kernel_file(session, KERNELS);
    const std::size_t width = gnomon::bvh_width(session);
    const std::vector<BlockCase> cases = block_cases(width, are_positions);
    Random random(5);
    Inputs in;
    for (const BlockCase& one : cases) in.add_case(one, one.normal, boxes_of(random, one, false, 0));
    const auto count = cl_uint(cases.size());
    const gnomon::cl::Buffer boxes(session, count * 4), triangles(session, count * 4),
        points(session, count * width * 4);
    session.launch(kernel_of("meet_block", are_positions), gnomon::bvh_range(session, count), count, in.layout,
                   uploaded(session, in.roundings), uploaded(session, in.cones), uploaded(session, in.positions),
                   uploaded(session, in.normals), uploaded(session, in.nodes), uploaded(session, in.leaves), boxes,
                   triangles, points, LOCAL);
    Tally tally;
    expect_boxes_met(in, downloaded<std::uint32_t>(session, boxes.get(), count), tally);
    expect_triangles_met(cases, downloaded<std::uint32_t>(session, triangles.get(), count),
                         downloaded<std::uint32_t>(session, points.get(), count * width), tally);
    std::cout << tally.boxes << " boxes, " << tally.boxes_culled << " culled; " << tally.pairs << " blocked pairs, "
              << tally.triangles_culled << " triangles culled\n";
    EXPECT_GT(tally.boxes_culled, tally.boxes / 8);
    EXPECT_GT(tally.pairs, 3000u);
    EXPECT_GT(tally.triangles_culled, 20u);
}

TEST(BeamSides, BeamsOfBlocksCullNothingThatTheirRaysMeet) {
    for (const bool gpu_kernels : {false, true}) expect_blocks_cull_nothing_met(gpu_kernels, false);
}
TEST(PointLightPlanes, BeamsOfBlocksCullNothingThatTheirRaysMeet) {
    for (const bool gpu_kernels : {false, true}) expect_blocks_cull_nothing_met(gpu_kernels, true);
}

/// Of a sector, a way along the ground that has all lights before it, of length 1.
Float3 ground_of(const BlockCase& one) {
    double sum[3] = {};
    for (const Light& light : one.lights)
        for (int c = 0; c < 3; ++c) sum[c] += light[c];
    const double length = std::hypot(sum[0], sum[2]);
    return {float(sum[0] / length), 0, float(sum[2] / length)};
}

/// Whether a ray to each light goes on along the ground by a good part of its length.
bool is_sector(const BlockCase& one, const Float3& ground) {
    return std::ranges::all_of(one.lights, [&](const Light& light) {
        return double(light[0]) * ground[0] + double(light[2]) * ground[2] > 0.1;
    });
}

/// How many of the cases are sectors.
std::size_t expect_points_cull_nothing_met(bool are_positions, Tally& tally) {
    const gnomon::Device device = device_of(false);
    gnomon::cl::Session& session = session_of(device);
    add_kernel_file(session, KERNELS);
    Random random(6);
    Inputs in;
    Floats begins;
    for (const BlockCase& one : block_cases(gnomon::bvh_width(session), are_positions)) {
        const Float3 ground = are_positions ? Float3{} : ground_of(one);
        const bool as_sector = !are_positions && is_sector(one, ground);
        // Every ray has gone that far along the ground at t = 10 begin.
        const float begin = as_sector ? float(one.scale * random.between(0, 0.05f)) : -1;
        begins.push_back(begin);
        in.add_case(one, as_sector ? ground : one.normal,
                    boxes_of(random, one, true, as_sector ? 10 * (long double)(begin) : 0));
    }
    const auto count = cl_uint(begins.size());
    const gnomon::cl::Buffer boxes(session, count * 4);
    session.launch(kernel_of("meet_point", are_positions), gnomon::bvh_range(session, count), count, in.layout,
                   uploaded(session, in.roundings), uploaded(session, in.cones), uploaded(session, in.positions),
                   uploaded(session, in.normals), uploaded(session, begins), uploaded(session, in.nodes), boxes, LOCAL);
    expect_boxes_met(in, downloaded<std::uint32_t>(session, boxes.get(), count), tally);
    EXPECT_GT(tally.boxes_culled, tally.boxes / 5);
    return std::size_t(std::ranges::count_if(begins, [](float begin) { return begin >= 0; }));
}

TEST(BeamSides, PointBeamsCullNothingThatTheirRaysMeet) {
    Tally tally;
    EXPECT_GT(expect_points_cull_nothing_met(false, tally), 20u);
}
TEST(PointLightPlanes, PointBeamsCullNothingThatTheirRaysMeet) {
    Tally tally;
    expect_points_cull_nothing_met(true, tally);
}

}  // namespace
