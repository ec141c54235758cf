// SPDX-License-Identifier: MIT
#include "beam_stages.hpp"

#include <iostream>
#include <limits>
#include <map>
#include <tuple>

#include "device.hpp"
#include "reference/bvh.hpp"
#include "reference/parallel.hpp"
#include "tie_points.hpp"

namespace support {
namespace {

gnomon::LightBundles bundles_of(BeamMethod method, std::span<const gnomon::Light> lights, std::uint32_t most) {
    gnomon::LightBundles coned = gnomon::make_light_bundles(lights, most).value();
    return method == BeamMethod::packets ? gnomon::make_plain_bundles(coned) : coned;
}

const char* kernel_of(BeamMethod method) { return method == BeamMethod::points ? "point_beam_trace" : "beam_trace"; }

}  // namespace

Blockers blockers_of_pairs(const LightScene& scene, std::span<const gnomon::Light> lights) {
    const reference::Bvh bvh(scene.triangles);
    const std::size_t points = scene.points.size() / 3;
    Blockers blockers(points * lights.size());
    reference::for_chunks(blockers.size(), 512, [&](std::size_t first, std::size_t last) {
        reference::Effort effort;
        for (std::size_t pair = first; pair < last; ++pair) {
            const std::size_t p = pair % points;
            const Float3 point = vertex(scene.points, p);
            if (!reference::is_finite(point)) continue;  // an absent point is lit
            const reference::Ray ray = reference::Ray::to_light(point, lights[pair / points].xyzw);
            bvh.traverse(ray, [&](std::uint32_t id, const reference::Triangle& triangle) {
                const bool is_receiver = !scene.receivers.empty() && scene.receivers[p] == id;
                if (!is_receiver && reference::blocks(ray, triangle, effort)) blockers[pair].push_back(id);
                return ray.last_parameter;
            });
        }
    });
    return blockers;
}

BeamStage::BeamStage(const gnomon::Device& device, const LightScene& scene, std::span<const gnomon::Light> lights,
                     BeamMethod method, std::uint32_t bundle_lights)
    : method_(method),
      device_(device),
      session_(session_of(device_)),
      triangles_(gnomon::Triangles::upload(device, scene.triangles)),
      points_(upload_points(device, scene)),
      lights_({lights.begin(), lights.end()}),
      run_{device_, triangles_, points_, lights_, outputs_, options_},
      sorted_(run_),
      tree_(device, triangles_),
      tree_run_{run_, sorted_, tree_},
      bundles_(bundles_of(method, lights, bundle_lights)),
      masks_(tree_run_, bundles_, statistics_, gnomon::LightMasks::Before::nothing),
      order_(downloaded<std::uint32_t>(session_, sorted_.order().get(), points_.count())) {
    masks_.reserve(points_.count());
    EXPECT_LE(tree_run_.largest_coordinate(), BVH_MAX_COORDINATE);
}

void BeamStage::set_tree(const std::vector<float>& nodes, const std::vector<float>& leaves,
                         const std::vector<std::uint32_t>& ids) {
    own_tree_ = {uploaded(session_, nodes), uploaded(session_, leaves), uploaded(session_, ids)};
}

std::vector<std::uint32_t> BeamStage::all_open() const {
    std::vector<std::uint32_t> masks(mask_stride() * bundle_count(), CANARY);
    for (std::size_t bundle = 0; bundle < bundle_count(); ++bundle) {
        std::uint32_t lights = 0;
        for (std::uint32_t slot = 0; slot < MAX_BUNDLE_LIGHTS; ++slot)
            if (light_of(bundle, slot) != gnomon::no_light) lights |= 1u << slot;
        std::fill_n(masks.begin() + std::ptrdiff_t(bundle * mask_stride()), point_count(), lights);
    }
    return masks;
}

gnomon::BeamParams BeamStage::params_of(std::uint32_t queue_capacity) const {
    gnomon::BeamParams params = masks_.params_of({0, points_.count()});
    params.queue_capacity = queue_capacity;
    params.are_packets = method_ == BeamMethod::packets ? 1 : 0;
    return params;
}

void BeamStage::launch(const gnomon::BeamParams& params, std::size_t tasks, const char* kernel) {
    const std::string file = "light_tables/" + std::string(kernel) + ".cl";
    const gnomon::cl::Buffer &nodes = own_tree_ ? (*own_tree_)[0] : tree_.nodes(),
                             &leaves = own_tree_ ? (*own_tree_)[1] : tree_.leaves(),
                             &ids = own_tree_ ? (*own_tree_)[2] : tree_.ids();
    session_.launch(triangle_inputs(triangles_).kernel_of_lights(file.c_str(), kernel, masks_.are_positions()),
                    gnomon::bvh_range(session_, tasks), params, masks_.bundles(), nodes, leaves, ids,
                    sorted_.positions(), sorted_.receivers(), sorted_.surface_normals(), masks_.masks(), queue_,
                    masks_.counters(), gnomon::cl::LocalBytes{BEAM_LOCAL_WORDS * sizeof(cl_uint)});
}

TracedBeams BeamStage::trace(const std::vector<std::uint32_t>& given, std::uint32_t queue_capacity) {
    queue_.reserve(session_, (std::size_t(queue_capacity) + 1) * sizeof(gnomon::BeamPairs));
    put_canaries(session_, queue_);
    session_.write(masks_.masks().get(), given.data(), given.size() * sizeof(std::uint32_t));
    session_.fill(masks_.counters(), 0, sizeof(gnomon::BeamCounters));
    gnomon::BeamParams params = params_of(queue_capacity);
    const std::size_t tasks = masks_.tasks_of(points_.count());
    params.parts_of_task = session_.is_cpu() ? 1 : 4;
    launch(params, method_ == BeamMethod::points ? tasks * params.parts_of_task : tasks, kernel_of(method_));
    TracedBeams traced;
    traced.counters = session_.read_value<gnomon::BeamCounters>(masks_.counters());
    params.listed_tasks = traced.counters.left_to_points;
    if (params.listed_tasks != 0) {
        launch(params, params.listed_tasks * params.parts_of_task, kernel_of(BeamMethod::points));
        traced.counters = session_.read_value<gnomon::BeamCounters>(masks_.counters());
    }
    traced.masks = downloaded<std::uint32_t>(session_, masks_.masks().get(), given.size());
    traced.queue =
        downloaded<gnomon::BeamPairs>(session_, queue_.get(), std::min(traced.counters.queued, queue_capacity));
    gnomon::BeamPairs past_the_end{};
    session_.read(queue_.get(), &past_the_end, sizeof(past_the_end), queue_capacity * sizeof(past_the_end));
    EXPECT_EQ(past_the_end.lights, CANARY) << "the queue is written past its end";
    return traced;
}

std::vector<std::uint32_t> BeamStage::decide_queue(std::uint32_t queue_capacity) {
    const gnomon::TriangleInputs triangles = triangle_inputs(triangles_);
    session_.launch(triangles.kernel_of_lights("light_tables/beam_trace.cl", "beam_exact", masks_.are_positions()),
                    gnomon::cl::Range::items(queue_capacity), params_of(queue_capacity), masks_.bundles(),
                    triangles.vertices, sorted_.positions(), queue_, masks_.masks(), masks_.counters());
    return downloaded<std::uint32_t>(session_, masks_.masks().get(), mask_stride() * bundle_count());
}

namespace {

/// Pairs by what a trace made of them; of a queued pair some triangles are in the queue.
struct TracedPairs {
    std::size_t dark = 0, lit = 0, queued = 0;
    std::size_t count() const { return dark + lit + queued; }
    void operator+=(const TracedPairs& other) {
        dark += other.dark;
        lit += other.lit;
        queued += other.queued;
    }
};

/// The lights for which a triangle is queued, by bundle, point and triangle.
using Queued = std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t>;

Queued queued_pairs(const BeamStage& stage, const std::vector<std::uint32_t>& given, const TracedBeams& traced) {
    EXPECT_EQ(traced.counters.queued, traced.queue.size()) << "the queue is too short";
    Queued queued;
    for (const gnomon::BeamPairs& pairs : traced.queue) {
        if (pairs.lights == 0) continue;  // an unused slot
        EXPECT_TRUE(pairs.point < stage.point_count() && pairs.bundle < stage.bundle_count());
        if (testing::Test::HasFailure()) return {};
        EXPECT_EQ(pairs.lights & ~given[pairs.bundle * stage.mask_stride() + pairs.point], 0u)
            << "point " << pairs.point;
        queued[{pairs.bundle, pairs.point, pairs.triangle}] |= pairs.lights;
    }
    return queued;
}

/// Expects that what the trace has closed is blocked, and that what blocks an open pair is in the queue.
TracedPairs expect_trace_holds(const BeamStage& stage, const std::vector<std::uint32_t>& given,
                               const TracedBeams& traced, const Blockers& blockers) {
    TracedPairs pairs;
    const Queued queued = queued_pairs(stage, given, traced);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> any_queued;
    for (const auto& [key, lights] : queued) any_queued[{std::get<0>(key), std::get<1>(key)}] |= lights;
    for (std::uint32_t bundle = 0; bundle < stage.bundle_count(); ++bundle)
        for (std::uint32_t p = 0; p < stage.mask_stride(); ++p) {
            const std::uint32_t before = given[bundle * stage.mask_stride() + p],
                                after = traced.masks[bundle * stage.mask_stride() + p];
            EXPECT_EQ(after & ~before, 0u) << "point " << p << " gains lights";
            if (p >= stage.point_count()) {
                EXPECT_EQ(after, before) << "point " << p << " is none";
                continue;
            }
            const auto some = any_queued.find({bundle, p});
            for (std::uint32_t slot = 0; slot < MAX_BUNDLE_LIGHTS; ++slot) {
                if ((before >> slot & 1) == 0) continue;
                const std::uint32_t light = stage.light_of(bundle, slot), point = stage.point_of(p);
                const auto& blocking = blockers[light * stage.point_count() + point];
                if ((after >> slot & 1) == 0) {
                    ++pairs.dark;
                    EXPECT_FALSE(blocking.empty()) << "nothing blocks point " << point << ", light " << light;
                } else {
                    ++(some != any_queued.end() && (some->second >> slot & 1) != 0 ? pairs.queued : pairs.lit);
                    for (const std::uint32_t id : blocking) {
                        const auto found = queued.find({bundle, p, id});
                        EXPECT_TRUE(found != queued.end() && (found->second >> slot & 1) != 0)
                            << "triangle " << id << " blocks point " << point << ", light " << light;
                    }
                }
            }
            if (testing::Test::HasFailure()) return pairs;
        }
    return pairs;
}

/// Expects the oracle's bits of all pairs that were open in `given`.
void expect_decided(const BeamStage& stage, const std::vector<std::uint32_t>& given,
                    const std::vector<std::uint32_t>& masks, const Blockers& blockers) {
    for (std::size_t bundle = 0; bundle < stage.bundle_count(); ++bundle)
        for (std::size_t p = 0; p < stage.point_count(); ++p)
            for (std::uint32_t slot = 0; slot < MAX_BUNDLE_LIGHTS; ++slot) {
                const std::size_t word = bundle * stage.mask_stride() + p;
                if ((given[word] >> slot & 1) == 0) continue;
                const std::uint32_t light = stage.light_of(bundle, slot), point = stage.point_of(p);
                ASSERT_EQ((masks[word] >> slot & 1) != 0, blockers[light * stage.point_count() + point].empty())
                    << "point " << point << ", light " << light;
            }
}

// ---- Cases ----------------------------------------------------------------------------------------------------------

struct Place {
    const char* name;
    double scale;
    std::array<double, 3> offset;
};
/// Of the last two the largest coordinates are half of BVH_MAX_COORDINATE and more.
constexpr Place PLACES[] = {{"", 1, {0, 0, 0}},
                            {" of 1e-4", 1e-4, {0, 0, 0}},
                            {" of 64 at 2^18", 64, {0x1p18, -0x1p18, 0x1p17}},
                            {" of 2^15", 0x1p15, {0, 0, 0}}};

/// Triangles without area, with repeated or collinear corners, among some that are sound and some that are not finite.
Floats degenerate_triangles(std::uint64_t seed) {
    Random random(seed);
    Floats triangles = soup(20, 0.7f, seed);
    for (int i = 0; i < 20; ++i) {
        const Float3 a = random_vector(random, -1, 1), b = random_vector(random, -1, 1);
        const Float3 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
        add(triangles, a, i % 3 == 0 ? a : b, i % 3 == 1 ? b : middle);
        add(triangles, a, b, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
    }
    return triangles;
}

/// Small triangles across the first light's rays, in planes that are not those of the axes.
Floats plates(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const Float3 at = random_vector(random, -1, 1);
        const auto place = [&](float u, float v) { return Float3{at[0] + u, at[1] - 0.3f * u - 0.2f * v, at[2] + v}; };
        const float size = random.between(0.1f, 0.5f);
        add(triangles, place(-size, -size), place(size, random.between(-size, size)), place(0, size));
    }
    return triangles;
}

struct Shape {
    const char* name;
    Floats triangles;
};
std::vector<Shape> shapes() {
    return {{"soup", soup(50, 0.5f, 11)},
            {"specks", soup(150, 0.02f, 13)},
            {"slivers", slivers(30, 1e-5f, 14)},
            {"fan", needle_fan(37, 1)},
            {"plates", plates(40, 12)},
            {"blocks", placed(lattice_blocks(6, 3, 15), 0.5, {-0.75, -0.75, -0.75})},
            {"degenerate", degenerate_triangles(16)}};
}

/// A place for a light beside the first one: there, an ulp off, near it, or anywhere.
Float3 light_beside(Random& random, const Float3& first, std::size_t i) {
    if (i % 4 == 0) return i % 8 == 0 ? first : nudged(random, first);
    Float3 v = first;
    const float reach = i % 4 == 1 ? 1e-3f : i % 4 == 2 ? 0.05f : 1.5f;
    for (float& c : v) c += random.between(-reach, reach);
    return v;
}

/// Some lie along the lattice of the blocks, or at corners of triangles and in their planes.
std::vector<gnomon::Light> lights_of(bool are_positions, const Floats& triangles, const Place& place,
                                     std::uint64_t seed) {
    Random random(seed);
    std::vector<gnomon::Light> lights;
    const Float3 first = are_positions ? Float3{0.2f, 1.25f, 0.3f} : Float3{0.3f, 1, 0.2f};
    for (std::size_t i = 0; i < 41; ++i) {
        Float3 v = light_beside(random, first, i);
        if (i % 5 == 4) v = {float(random.below(5)) / 2 - 1, float(random.below(5)) / 2 - 1, 0.5f};
        if (!are_positions) {
            lights.push_back(gnomon::Light::directional({-v[0], -v[1], -v[2]}));
            continue;
        }
        if (i % 11 == 10) v = vertex(triangles, random.below(std::uint32_t(triangles.size() / 3)));
        for (int c = 0; c < 3; ++c) v[c] = float(double(v[c]) * place.scale + place.offset[c]);
        if (reference::is_finite(v)) lights.push_back(gnomon::Light::point(v));
    }
    return lights;
}

/// Points on the rays of three lights, at corners of triangles, and one that is absent.
Floats points_of(const Floats& triangles, const std::vector<gnomon::Light>& lights, const Place& place,
                 std::uint64_t seed) {
    Floats points, sound;
    for (std::size_t t = 0; t < triangles.size() / 9; ++t)
        if (reference::is_finite(reference::triangle_at(triangles, t)))
            sound.insert(sound.end(), &triangles[9 * t], &triangles[9 * t] + 9);
    const double reach = lights[0].is_directional() ? 2 * place.scale : 2;  // of points_behind(): times the distance
    for (const std::size_t light : {0u, 3u, 14u})
        append(points, points_behind(sound, lights[light].xyzw, 40, reach, seed + light));
    append(points, Floats(sound.begin(), sound.begin() + 30));
    add(points, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
    return points;
}

struct BeamCase {
    LightScene scene;
    std::vector<gnomon::Light> lights;
};

/// Lights that are neighbours, to the last ulp or all around, of one kind. Shadow rays pass through edges and corners
/// of triangles, lie in their planes, and begin or end on them.
std::vector<BeamCase> beam_cases(bool are_positions) {
    std::vector<BeamCase> cases;
    std::uint64_t seed = 100;
    for (const Shape& shape : shapes())
        for (const Place& place : PLACES) {
            ++seed;
            BeamCase made{};
            made.scene.name = std::string(shape.name) + place.name;
            made.scene.triangles = placed(shape.triangles, place.scale, place.offset);
            made.lights = lights_of(are_positions, shape.triangles, place, seed);
            made.scene.points = points_of(made.scene.triangles, made.lights, place, seed);
            if (seed % 2 == 0)
                for (std::size_t p = 0; p < made.scene.points.size() / 3; ++p)
                    made.scene.receivers.push_back(std::uint32_t(p % (made.scene.triangles.size() / 9)));
            cases.push_back(std::move(made));
        }
    return cases;
}

/// Only point `lane` of each block is open: the block's beam is then that of a point.
std::vector<std::uint32_t> open_in_lane(const BeamStage& stage, std::size_t lane, std::size_t width) {
    std::vector<std::uint32_t> given = stage.all_open();
    for (std::size_t bundle = 0; bundle < stage.bundle_count(); ++bundle)
        for (std::size_t p = 0; p < stage.point_count(); ++p)
            if (p % width != lane) given[bundle * stage.mask_stride() + p] = 0;
    return given;
}

TracedPairs expect_case_holds(BeamStage& stage, const std::vector<std::uint32_t>& given, const Blockers& blockers) {
    const TracedPairs pairs = expect_trace_holds(stage, given, stage.trace(given), blockers);
    expect_decided(stage, given, stage.decide_queue(), blockers);
    return pairs;
}

}  // namespace

void expect_cases_hold(const gnomon::Device& device, BeamMethod method, bool are_positions) {
    const std::size_t width = gnomon::bvh_width(session_of(device));
    // A CPU runs the kernels for GPUs slowly: it takes a third of the cases, and one lane in eleven.
    const bool is_cpu = session_of(device).is_cpu();
    const std::vector<BeamCase> cases = beam_cases(are_positions);
    TracedPairs pairs;
    for (std::size_t i = 0; i < cases.size(); i += is_cpu ? 1 : 3) {
        const BeamCase& one = cases[i];
        SCOPED_TRACE(one.scene.name);
        const Blockers blockers = blockers_of_pairs(one.scene, one.lights);
        BeamStage many(device, one.scene, one.lights, method, MAX_BUNDLE_LIGHTS);
        pairs += expect_case_holds(many, many.all_open(), blockers);
        BeamStage few(device, one.scene, one.lights, method, 5);
        for (std::size_t lane = 0; lane < width; lane += is_cpu ? 1 : 11)
            pairs += expect_case_holds(few, open_in_lane(few, lane, width), blockers);
        if (testing::Test::HasFailure()) return;
    }
    std::cout << pairs.dark << " pairs dark, " << pairs.lit << " lit, " << pairs.queued << " queued\n";
    EXPECT_GT(pairs.dark, pairs.count() / 10);
    EXPECT_GT(pairs.lit, pairs.count() / 3);
    EXPECT_GT(pairs.queued, pairs.count() / 20);
}

void expect_queue_grows(const gnomon::Device& device, BeamMethod method, bool are_positions) {
    const BeamCase one = beam_cases(are_positions).at(12);  // the fan
    const Blockers blockers = blockers_of_pairs(one.scene, one.lights);
    BeamStage stage(device, one.scene, one.lights, method, MAX_BUNDLE_LIGHTS);
    const auto given = stage.all_open();
    const TracedBeams first = stage.trace(given, 5);
    EXPECT_GT(first.counters.queued, 5u);
    const std::uint32_t room = first.counters.queued * 5 / 4;
    expect_trace_holds(stage, first.masks, stage.trace(first.masks, room), blockers);
    expect_decided(stage, given, stage.decide_queue(room), blockers);
}

}  // namespace support
