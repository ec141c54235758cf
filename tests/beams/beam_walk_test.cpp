// SPDX-License-Identifier: MIT
// Stage beam_walk: the walk comes once to each leaf that a ray of the beam meets, to near ones first, and its stack
// has room for the tallest tree that is made; every trace walks such a tree to its last leaf.
#include <gtest/gtest.h>

#include <bit>
#include <numeric>

#include "support/beam_stages.hpp"
#include "support/block_cases.hpp"
#include "support/kernel_file.hpp"
#include "support/tree_scenes.hpp"

namespace {

using namespace support;

constexpr const char* KERNELS = "beams/beam_walk_test.cl";

struct Box {
    Float3 low, high;
};

/// A tree made by hand.
struct HandMadeTree {
    std::uint32_t width;
    Floats nodes{};

    /// `codes`: of a child for each box; the other children are absent.
    void add_node(const std::vector<Box>& boxes, const std::vector<std::uint32_t>& codes) {
        constexpr float infinite = std::numeric_limits<float>::infinity();
        for (const bool is_high : {false, true})
            for (int c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < width; ++k)
                    nodes.push_back(k < boxes.size() ? (is_high ? boxes[k].high[c] : boxes[k].low[c])
                                                     : (is_high ? -infinite : infinite));
        for (std::size_t k = 0; k < width; ++k) nodes.push_back(std::bit_cast<float>(k < codes.size() ? codes[k] : 0u));
    }
};

/// The walk of one block.
struct Walk {
    std::vector<std::uint32_t> leaves;
    std::uint32_t highest;
};

std::vector<Walk> walk_blocks(gnomon::cl::Session& session, const Floats& positions,
                              std::span<const gnomon::Light> lights, const gnomon::cl::Buffer& nodes, float largest,
                              std::uint32_t max_leaves) {
    add_kernel_file(session, KERNELS);
    const bool are_positions = !lights[0].is_directional();
    const auto bundles = gnomon::make_light_bundles(lights, MAX_BUNDLE_LIGHTS).value();
    const auto count = cl_uint(positions.size() / 3 / gnomon::bvh_width(session));
    gnomon::PointsLayout layout{};
    layout.point_stride = 3;
    layout.coordinate_stride = 1;
    layout.count = cl_uint(positions.size() / 3);
    const gnomon::cl::Buffer leaves(session, count * max_leaves * 4), counts(session, count * 4),
        highest(session, count * 4);
    session.launch({KERNELS, "walk_blocks", {.point_lights = are_positions}}, gnomon::bvh_range(session, count), count,
                   layout, beam_rounding(largest, are_positions),
                   uploaded(session, std::vector{bundles.bundles[0].cones[0]}), uploaded(session, positions), nodes,
                   max_leaves, leaves, counts, highest, gnomon::cl::LocalBytes{BEAM_LOCAL_WORDS * sizeof(cl_uint)});
    const auto all = downloaded<std::uint32_t>(session, leaves.get(), count * max_leaves);
    const auto found = downloaded<std::uint32_t>(session, counts.get(), count);
    const auto max_entries = downloaded<std::uint32_t>(session, highest.get(), count);
    std::vector<Walk> walks;
    for (std::size_t i = 0; i < count; ++i) {
        EXPECT_LE(found[i], max_leaves);
        const auto first = all.begin() + std::ptrdiff_t(i * max_leaves);
        walks.push_back({{first, first + std::min(found[i], max_leaves)}, max_entries[i]});
    }
    return walks;
}

/// Lights along z, or lamps up there: some that are neighbours.
std::vector<gnomon::Light> lights_above(bool are_positions) {
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < 20; ++i) {
        const float x = float(i % 4) / 512, y = float(i / 4) / 512;
        lights.push_back(are_positions ? gnomon::Light::point({x, y, 64}) : gnomon::Light::directional({-x, -y, -1}));
    }
    return lights;
}

/// Points of so many blocks in the square [0, 1] x [0, 1] at z = -1.
Floats points_below(std::size_t count) {
    Random random(3);
    Floats points;
    for (std::size_t i = 0; i < count; ++i) add(points, {random.between(0, 1), random.between(0, 1), -1});
    return points;
}

// ---- Order ----------------------------------------------------------------------------------------------------------

// Slabs over the points, a whole unit apart, in any order among a node's children: the walk comes to them from below.
TEST(BeamWalk, NearLeavesComeFirst) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true}) {
            SCOPED_TRACE(std::string(are_positions ? "lamps" : "suns") + (gpu_kernels ? ", kernels for GPUs" : ""));
            const gnomon::Device device = device_of(gpu_kernels);
            gnomon::cl::Session& session = session_of(device);
            HandMadeTree tree{gnomon::bvh_width(session)};
            const std::uint32_t width = tree.width;
            const auto slab = [](std::uint32_t from, std::uint32_t to) {
                return Box{{-2, -2, float(from)}, {2, 2, float(to) + 0.5f}};
            };
            // Four nodes of `width` slabs each, without the third slab of each node, which lies beside the beam.
            const std::vector<std::uint32_t> nodes = shuffled_order(4, 8), slabs = shuffled_order(width, 9);
            std::vector<Box> boxes;
            std::vector<std::uint32_t> codes, expected;
            for (const std::uint32_t n : nodes) {
                boxes.push_back(slab(n * width / 4, n * width / 4 + width / 4));
                codes.push_back(1 + std::uint32_t(codes.size()));
            }
            tree.add_node(boxes, codes);
            for (const std::uint32_t n : nodes) {
                boxes.clear(), codes.clear();
                for (const std::uint32_t k : slabs) {
                    boxes.push_back(slab(n * width / 4 + k, n * width / 4 + k));
                    if (k == 2) boxes.back().low[0] += 40, boxes.back().high[0] += 40;
                    codes.push_back(BVH_LEAF | (n * width + k));
                }
                tree.add_node(boxes, codes);
            }
            for (std::uint32_t n = 0; n < 4; ++n)
                for (std::uint32_t k = 0; k < width; ++k)
                    if (k != 2) expected.push_back(n * width + k);
            const auto walks = walk_blocks(session, points_below(2 * width), lights_above(are_positions),
                                           uploaded(session, tree.nodes), 64, 4 * width);
            ASSERT_EQ(walks.size(), 2u);
            for (const Walk& walk : walks) EXPECT_EQ(walk.leaves, expected);
        }
}

// ---- Leaves ---------------------------------------------------------------------------------------------------------

/// Blocks here and there among the triangles.
Floats strewn_blocks(std::size_t blocks, std::size_t width, std::uint64_t seed) {
    Random random(seed);
    Floats points;
    for (std::size_t b = 0; b < blocks; ++b) {
        const Float3 middle = random_vector(random, 0, 1000);
        for (std::size_t i = 0; i < width; ++i) {
            const Float3 off = random_vector(random, -20, 20);
            add(points, {middle[0] + off[0], middle[1] + off[1], middle[2] + off[2]});
        }
    }
    return points;
}

/// Of the triangles that block a pair of the block, the leaves, each once.
std::vector<std::uint32_t> leaves_with(const std::vector<std::uint32_t>& leaf_of, const Blockers& blockers,
                                       std::size_t points, std::size_t lights, std::size_t block, std::size_t width) {
    std::vector<std::uint32_t> leaves;
    for (std::size_t l = 0; l < lights; ++l)
        for (std::size_t p = block * width; p < (block + 1) * width; ++p)
            for (const std::uint32_t id : blockers[l * points + p]) leaves.push_back(leaf_of[id]);
    std::ranges::sort(leaves);
    leaves.erase(std::ranges::unique(leaves).begin(), leaves.end());
    return leaves;
}

std::vector<std::uint32_t> leaves_of_triangles(gnomon::cl::Session& session, const gnomon::WideBvh& tree,
                                               std::size_t triangles) {
    const std::size_t width = gnomon::bvh_width(session);
    const auto ids = downloaded<std::uint32_t>(session, tree.ids().get(), tree.leaf_count() * width);
    std::vector<std::uint32_t> leaf_of(triangles, GN_NO_ID);
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (ids[i] != GN_NO_ID) leaf_of.at(ids[i]) = std::uint32_t(i / width);
    return leaf_of;
}

TEST(BeamWalk, ComesOnceToEachLeafThatRaysMeet) {
    for (const bool gpu_kernels : {false, true})
        for (const bool are_positions : {false, true}) {
            SCOPED_TRACE(std::string(are_positions ? "lamps" : "suns") + (gpu_kernels ? ", kernels for GPUs" : ""));
            const gnomon::Device device = device_of(gpu_kernels);
            gnomon::cl::Session& session = session_of(device);
            const std::size_t width = gnomon::bvh_width(session), blocks = 64;
            LightScene scene{"strewn", strewn_triangles(6000, 60, 4), strewn_blocks(blocks, width, 5)};
            std::vector<gnomon::Light> lights;
            for (int i = 0; i < 8; ++i)
                lights.push_back(are_positions ? gnomon::Light::point({400 + 9.0f * float(i), 900, 300})
                                               : gnomon::Light::directional({-0.3f, -1, 0.01f * float(i)}));
            const gnomon::WideBvh tree(device, gnomon::Triangles::upload(device, scene.triangles));
            const auto walks =
                walk_blocks(session, scene.points, lights, tree.nodes(), tree.largest_coordinate(), tree.leaf_count());
            const Blockers blockers = blockers_of_pairs(scene, lights);
            const auto leaf_of = leaves_of_triangles(session, tree, scene.triangles.size() / 9);
            std::size_t needed = 0, visited = 0;
            for (std::size_t block = 0; block < blocks; ++block) {
                std::vector<std::uint32_t> met = walks[block].leaves;
                std::ranges::sort(met);
                EXPECT_EQ(std::ranges::adjacent_find(met), met.end()) << "block " << block << " comes to a leaf twice";
                const auto wanted =
                    leaves_with(leaf_of, blockers, scene.points.size() / 3, lights.size(), block, width);
                EXPECT_TRUE(std::ranges::includes(met, wanted)) << "block " << block;
                EXPECT_LE(walks[block].highest, MAX_STACK_ENTRIES);
                needed += wanted.size();
                visited += met.size();
            }
            std::cout << needed << " of " << visited << " leaves hold what blocks; " << tree.leaf_count()
                      << " leaves\n";
            EXPECT_GT(needed, 200u);
            EXPECT_LT(visited, blocks * tree.leaf_count() / 2);
        }
}

// ---- The tallest tree -----------------------------------------------------------------------------------------------

/// Levels of nodes of which each has leaves and one node, which a walk comes to first. `by_packets`: a packet comes
/// first to the box that is nearest to the light, a beam to the one that is nearest to the points.
HandMadeTree tallest_tree(std::uint32_t width, std::uint32_t levels, bool by_packets) {
    HandMadeTree tree{width};
    const Box leaf{{-512, -512, 1}, {512, 512, 10}};
    const Box node{{-512, -512, by_packets ? 2.0f : 0.0f}, {512, 512, by_packets ? 11.0f : 10.0f}};
    for (std::uint32_t level = 0, leaves = 0; level < levels; ++level) {
        const bool is_last = level + 1 == levels;
        std::vector<Box> boxes(width, leaf);
        std::vector<std::uint32_t> codes;
        for (std::uint32_t k = 0; k < width; ++k) codes.push_back(BVH_LEAF | leaves++);
        if (!is_last) {
            --leaves;
            boxes[level % width] = node;
            for (std::uint32_t k = level % width + 1; k < width; ++k) --codes[k];
            codes[level % width] = level + 1;
        }
        tree.add_node(boxes, codes);
    }
    return tree;
}

constexpr std::uint32_t max_levels(std::uint32_t width) { return (MAX_STACK_ENTRIES - 2) / (width - 1); }

TEST(BeamWalk, ItsStackHasRoomForTheTallestTree) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        gnomon::cl::Session& session = session_of(device);
        const std::uint32_t width = gnomon::bvh_width(session), levels = max_levels(width);
        const std::uint32_t leaves = levels * (width - 1) + 1;
        for (const bool are_positions : {false, true}) {
            const HandMadeTree tree = tallest_tree(width, levels, false);
            const auto walks = walk_blocks(session, points_below(width), lights_above(are_positions),
                                           uploaded(session, tree.nodes), 512, leaves);
            std::vector<std::uint32_t> met = walks.at(0).leaves, every(leaves);
            std::ranges::sort(met);
            std::iota(every.begin(), every.end(), 0u);
            EXPECT_EQ(met, every);
            EXPECT_EQ(walks[0].highest, leaves);  // all leaves wait while the last node is opened
            EXPECT_LE(walks[0].highest, MAX_STACK_ENTRIES);
        }
    }
}

// A leaf of the root, to which the walk comes after those of all other nodes, holds what blocks all rays.
void expect_trace_of_tallest_tree(const gnomon::Device& device, BeamMethod method, bool are_positions) {
    gnomon::cl::Session& session = session_of(device);
    const std::uint32_t width = gnomon::bvh_width(session), levels = max_levels(width);
    LightScene scene{"tallest tree", {}, points_below(4 * width)};
    append(scene.triangles, {400, 400, 5, 401, 400, 5, 400, 401, 5, -500, -500, 5, 500, -500, 5, 0, 500, 5});
    const std::vector<gnomon::Light> lights = lights_above(are_positions);
    BeamStage stage(device, scene, lights, method, MAX_BUNDLE_LIGHTS);
    const std::size_t leaves = levels * (width - 1) + 1;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (const bool is_dark : {false, true})
        for (const std::uint32_t blocking : {0u, width - 2}) {  // the first and the last leaf of the root
            Floats rows;
            std::vector<std::uint32_t> ids;
            for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
                const std::uint32_t id = is_dark && leaf == blocking ? 1 : 0;
                std::vector<reference::Triangle> triangles(width, reference::Triangle{{{nan, nan, nan}}});
                triangles[leaf % width] = reference::triangle_at(scene.triangles, id);
                append_leaf(rows, triangles);
                ids.insert(ids.end(), width, GN_NO_ID);
                ids[leaf * width + leaf % width] = id;
            }
            stage.set_tree(tallest_tree(width, levels, method == BeamMethod::packets).nodes, rows, ids);
            const auto given = stage.all_open();
            const TracedBeams traced = stage.trace(given);
            EXPECT_EQ(traced.counters.queued, 0u);
            for (std::size_t p = 0; p < stage.point_count(); ++p)
                ASSERT_EQ(traced.masks[p], is_dark ? 0u : given[p]) << "point " << p << ", leaf " << blocking;
        }
}

TEST(BeamWalk, EveryTraceWalksTheTallestTree) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        for (const BeamMethod method : {BeamMethod::blocks, BeamMethod::points, BeamMethod::packets})
            for (const bool are_positions : {false, true}) {
                if (gpu_kernels && method == BeamMethod::packets) continue;
                SCOPED_TRACE("method " + std::to_string(int(method)) + (are_positions ? ", lamps" : ", suns") +
                             (gpu_kernels ? ", kernels for GPUs" : ""));
                expect_trace_of_tallest_tree(device, method, are_positions);
            }
    }
}

// ---- What is remembered ---------------------------------------------------------------------------------------------

TEST(BeamWalk, RemembersTheLeavesThatBlockedLast) {
    for (const bool gpu_kernels : {false, true}) {
        const gnomon::Device device = device_of(gpu_kernels);
        gnomon::cl::Session& session = session_of(device);
        add_kernel_file(session, KERNELS);
        Random random(2);
        std::vector<std::uint32_t> codes, latest;
        for (int i = 0; i < 300; ++i) codes.push_back(BVH_LEAF | random.below(6));
        const gnomon::cl::Buffer remembered(session, codes.size() * 64), room(session, 4);
        session.launch(KERNELS, "note_codes", gnomon::cl::Range::groups_of(1, 1), cl_uint(codes.size()),
                       uploaded(session, codes), remembered, room);
        const auto leaves = session.read_value<std::uint32_t>(room);
        const auto seen = downloaded<std::uint32_t>(session, remembered.get(), codes.size() * leaves);
        for (std::size_t n = 0; n < codes.size(); ++n) {
            std::erase(latest, codes[n]);
            latest.insert(latest.begin(), codes[n]);
            for (std::size_t k = 0; k < leaves; ++k)
                ASSERT_EQ(seen[n * leaves + k], k < latest.size() ? latest[k] : 0u) << "after code " << n;
        }
    }
}

}  // namespace
