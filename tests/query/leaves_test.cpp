// SPDX-License-Identifier: MIT
// scenes/leaves.glb: cut-outs of textures and of vertices' alpha in a scene, through every path, held to the oracle.
// Two controls: with textures that are opaque all over each path answers as without cut-outs, and with clear ones as
// without the masked triangles.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

#include "reference/view.hpp"
#include "support/cut_out_scenes.hpp"
#include "support/decoded_png.hpp"
#include "support/expect_exact.hpp"
#include "support/scene_masks.hpp"

namespace {

using namespace gnomon;
using support::Floats;

constexpr std::uint32_t width = 96, height = 64;

const scene::Scene& leaves() {
    static const scene::Scene scene = scene::load(GNOMON_SCENES "/leaves.glb", {.decode_alpha = support::alpha_of_png});
    return scene;
}

/// The scene's cut-outs with this alpha in all textures and corners.
scene::Scene with_alpha(std::uint8_t alpha) {
    scene::Scene scene = leaves();
    for (auto& texture : scene.cut_outs.textures) std::ranges::fill(texture.alpha, alpha);
    std::ranges::fill(scene.cut_outs.corner_alphas, float(alpha) / 255);
    return scene;
}

scene::Scene without_cut_outs(scene::Scene scene = leaves()) {
    scene.cut_outs = {};
    return scene;
}

bool is_masked(std::size_t triangle) { return leaves().cut_outs.material_of_triangle[triangle] != no_cut_out; }

scene::Scene without_masked_triangles() {
    scene::Scene scene = without_cut_outs();
    for (std::size_t i = 0; i < scene.triangle_count(); ++i)
        if (is_masked(i))
            std::fill_n(scene.triangles.begin() + std::ptrdiff_t(9 * i), 9, std::numeric_limits<float>::quiet_NaN());
    return scene;
}

struct Family {
    const char* name;
    Device device;
};
/// The kernels for CPUs, those for GPUs, and those without double. A test opens its devices once, since each device
/// loads its programs anew.
std::vector<Family> open_families() {
    return {{"kernels for CPUs", Device()},
            {"kernels for GPUs", Device({}, {.gpu_kernels = true})},
            {"without double", Device({}, {.hide_fp64 = true})}};
}

/// What every path answers for one view and light.
struct Answers {
    std::vector<std::uint32_t> receiver;
    std::map<std::string, std::vector<std::uint32_t>> sun_bits;  ///< by beams and one by one
    Floats position, normal, animated, clustered, prepared, mean;

    bool operator==(const Answers&) const = default;
};

const reference::PinholeCamera views[] = {{{3.5f, 3.25f, 5.5f}, {0, 1.25f, 0}, {0, 1, 0}, 50, width, height},
                                          {{0.75f, 0.5f, 1.25f}, {-0.5f, 2.5f, -0.5f}, {0, 1, 0}, 70, width, height}};
const Light lights[] = {Light::directional({-0.5f, -1, -0.25f}), Light::directional({0, -1, 0}),
                        Light::point({0, 3.5f, 0.25f})};
const Lights& suns() {
    static const Lights all = sun_disk({-0.5f, -1, -0.25f}, 5, 40);
    return all;
}

Camera camera_of(const reference::PinholeCamera& view) {
    return Camera::look_at(view.eye, view.target, view.up, view.fov_y_degrees);
}

Answers answers_of(const Device& device, const scene::Scene& scene, const reference::PinholeCamera& view,
                   const Light& light) {
    Answers answers;
    const Triangles triangles = scene::upload(device, scene);
    const View seen = look(device, triangles, camera_of(view), width, height);
    const ViewOnHost host = seen.read(device, triangles);
    answers.receiver = host.receiver;
    answers.position = host.position;
    answers.normal = host.normal;
    const Visibility visibility(device, seen.points.count());
    const auto technique = support::technique_with(device, {});
    const auto run = [&](const Triangles& of) {
        technique->run(of, seen.points, light, visibility);
        return visibility.read();
    };
    answers.animated = run(triangles);
    Triangles clustered = triangles;
    clustered.keep_clusters(device);
    answers.clustered = run(clustered);
    for (const char* const way : {"beams", "one-by-one"}) {
        technique->set("many-lights", way);
        answers.sun_bits[way] =
            run_light_table_to_host(*technique, triangles, seen.points, suns(), {.bits = true}).bits;
    }
    run_samples(*technique, triangles, seen, light, 8, visibility);
    answers.mean = visibility.read();
    technique->set("map-size", "128");  // clearing the map of a larger grid would take most of the time
    technique->prepare(triangles, light);
    answers.prepared = run(triangles);
    return answers;
}

/// The oracle's visibility of points.
Floats truth_of(const PointsOnHost& points, const Light& light, const std::optional<Float3>& eye) {
    static const reference::Masks masks = support::masks_of(leaves());
    Floats visibility;
    for (const std::uint8_t in_shadow :
         reference::shadowed(leaves().triangles, points.position, points.receiver, light.xyzw, eye, nullptr, &masks))
        visibility.push_back(in_shadow ? 0.0f : 1.0f);
    return visibility;
}

/// The camera's promises, and the visibility of each pixel in every mode.
void expect_view(const reference::PinholeCamera& view, const Light& light, const Answers& answers) {
    static const reference::Masks masks = support::masks_of(leaves());
    const auto report = reference::judge_view(
        leaves().triangles, view, light.xyzw,
        reference::ViewClaim{answers.position, answers.normal, answers.receiver, answers.animated}, {.masks = &masks});
    EXPECT_EQ(report.wrong(), 0u) << report.wrong_nearest.count << " nearest, " << report.wrong_visibility.count
                                  << " visibility";
    EXPECT_EQ(report.camera_ambiguous, 0u);
    EXPECT_EQ(answers.clustered, answers.animated);
    EXPECT_EQ(answers.prepared, answers.animated);
}

/// Each sample, and each of many lights.
void expect_samples_and_suns(const Device& device, const reference::PinholeCamera& view, const Light& light,
                             const Answers& answers) {
    const Triangles triangles = scene::upload(device, leaves());
    const View seen = look(device, triangles, camera_of(view), width, height);
    Floats mean(seen.points.count());
    const Visibility means(device, mean.size());
    run_samples(*support::technique_with(device, {}), triangles, seen, light, 8, means, [&](const Points& samples) {
        const Floats one = truth_of(samples.read(device), light, view.eye);
        for (std::size_t i = 0; i < one.size(); ++i) mean[i % mean.size()] += one[i] / 8;
    });
    EXPECT_EQ(answers.mean, mean);
    const PointsOnHost points = seen.points.read(device);
    const std::size_t words = (suns().count() + 31) / 32;
    EXPECT_EQ(answers.sun_bits.at("beams"), answers.sun_bits.at("one-by-one"));
    for (const std::size_t sun : {0u, 17u, 39u}) {
        const Floats truth = truth_of(points, suns().lights()[sun], view.eye);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
            wrong += (answers.sun_bits.at("beams")[i * words + sun / 32] >> sun % 32 & 1u) != (truth[i] == 1);
        EXPECT_EQ(wrong, 0u) << "sun " << sun;
    }
}

TEST(Leaves, EveryPathEqualsReference) {
    ASSERT_TRUE(leaves().warnings.empty());
    const scene::Scene opaque = without_cut_outs();
    const std::vector<Family> families = open_families();
    for (const Family& family : families)
        for (const auto& view : views)
            for (const Light& light : lights) {
                if (&family != &families[0] && &view != &views[0]) continue;
                SCOPED_TRACE(family.name + (", light " + std::to_string(&light - lights)));
                const Answers answers = answers_of(family.device, leaves(), view, light);
                expect_view(view, light, answers);
                if (&light != &lights[1]) expect_samples_and_suns(family.device, view, light, answers);
                if (&family != &families[0]) continue;
                const Answers plain = answers_of(family.device, opaque, view, light);
                EXPECT_NE(answers.receiver, plain.receiver) << "the masks must matter";
                EXPECT_NE(answers.animated, plain.animated);
            }
}

TEST(Leaves, ControlsAreAsPlainAndAsAbsent) {
    const scene::Scene opaque = without_cut_outs(), absent = without_masked_triangles(), all_opaque = with_alpha(255),
                       all_clear = with_alpha(0);
    for (const auto& [name, device] : open_families()) {
        SCOPED_TRACE(name);
        EXPECT_TRUE(answers_of(device, all_opaque, views[0], lights[0]) ==
                    answers_of(device, opaque, views[0], lights[0]));
        EXPECT_TRUE(answers_of(device, all_clear, views[0], lights[2]) ==
                    answers_of(device, absent, views[0], lights[2]));
    }
}

// Seven words each, and half a byte for the classes of all triangles; then the material, the texture, its texels'
// classes.
TEST(Leaves, AMaskedTriangleTakes28BytesMore) {
    const Floats triangles = support::soup(20'000, 0.1f, 3);
    reference::Masks masks;
    masks.textures = {support::made_texture(16, 16, [](auto x, auto y) { return (x + y) % 2 * 255; })};
    masks.materials = {{0}};
    masks.material.assign(20'000, 0);
    for (std::size_t i = 0; i < 20'000; ++i) masks.coordinates.insert(masks.coordinates.end(), {0, 0, 1, 0, 0, 1});
    const support::CutOutData data(std::move(masks));
    const auto bytes_of = [&](const auto&... cut_outs) {
        const Device device;
        const std::uint64_t before = device.memory_bytes();
        const Triangles uploaded = Triangles::upload(device, triangles, cut_outs...);
        EXPECT_EQ(uploaded.cut_out_counts().masked, sizeof...(cut_outs) * 20'000);
        return device.memory_bytes() - before;
    };
    EXPECT_LE(bytes_of(data.cut_outs()), bytes_of() + 28 * 20'000 + 20'000 / 2 + 16 * 16 * 2);
}

// ---- Parts ----------------------------------------------------------------------------------------------------------

/// 12 x 12 copies, side by side.
scene::Scene forest_of(const scene::Scene& one) {
    scene::Scene forest;
    forest.cut_outs.materials = one.cut_outs.materials;
    forest.cut_outs.textures = one.cut_outs.textures;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (int tree = 0; tree < 144; ++tree) {
        const Float3 move{8 * float(tree % 12 - 6), 0, 8 * float(tree / 12 - 11)};
        for (std::size_t i = 0; i < one.triangles.size(); ++i)
            forest.triangles.push_back(one.triangles[i] + move[i % 3]);
        append(forest.texture_coordinates, one.texture_coordinates);
        append(forest.cut_outs.material_of_triangle, one.cut_outs.material_of_triangle);
        append(forest.cut_outs.corner_alphas, one.cut_outs.corner_alphas);
    }
    return forest;
}

struct Seen {
    std::vector<std::uint32_t> receiver;
    Floats visibility;
    std::uint64_t bytes = 0, parts = 1;
};

std::unique_ptr<Technique> technique_for_parts(const Device& device) {
    return support::technique_with(device, {{"first-capacity", "4096"}, {"map-size", "256"}});
}

Seen seen_whole(const scene::Scene& scene, const Light& light) {
    const Device device;
    const Triangles triangles = scene::upload(device, scene);
    const View view = look(device, triangles, camera_of(views[0]), width, height);
    const Visibility visibility(device, view.points.count());
    technique_for_parts(device)->run(triangles, view.points, light, visibility);
    return {view.read(device, triangles).receiver, visibility.read(), device.peak_memory_bytes()};
}

Seen seen_in_parts(const scene::Scene& scene, const Light& light, std::uint64_t limit) {
    const Device device({}, {.memory_limit_bytes = limit});
    const scene::CutOutsView cut_outs(scene);
    const SceneOnHost on_host{scene.triangles, cut_outs.get()};
    const ViewOfParts view = look_in_parts(device, on_host, camera_of(views[0]), width, height);
    Seen seen{view.view.read(device, view.triangles).receiver, {}};
    for (std::uint32_t& id : seen.receiver)
        if (id != no_receiver) id = view.ids.at(id);
    const Visibility visibility(device, view.view.points.count());
    const Statistics run = run_in_parts([&] { return technique_for_parts(device); }, device, on_host, view.view.points,
                                        view.ids, light, visibility);
    seen.parts = run.count("parts");
    seen.visibility = visibility.read();
    return seen;
}

TEST(Leaves, AForestInPartsIsTheWholeForest) {
    const struct {
        const char* name;
        scene::Scene in_parts, whole;
    } cases[] = {{"leaves", forest_of(leaves()), forest_of(leaves())},
                 {"opaque", forest_of(with_alpha(255)), without_cut_outs(forest_of(leaves()))},
                 {"clear", forest_of(with_alpha(0)), forest_of(without_masked_triangles())}};
    for (const auto& [name, in_parts, whole] : cases)
        for (const Light& light : {lights[0], lights[2]}) {
            SCOPED_TRACE(name);
            const Seen wanted = seen_whole(whole, light);
            // Less and less memory, until one part is not enough.
            Seen found;
            for (std::uint64_t limit = seen_whole(in_parts, light).bytes / 3; found.parts < 2; limit = limit * 7 / 8)
                found = seen_in_parts(in_parts, light, limit);
            EXPECT_EQ(found.receiver, wanted.receiver);
            EXPECT_EQ(found.visibility, wanted.visibility);
        }
}

// The same triangles and points, snapped for two origins of a national grid.
TEST(Leaves, OnAWorldLatticeTheOriginDoesNotMatter) {
    const Device device;
    std::vector<double> corners, places;
    for (std::size_t i = 0; i < leaves().triangles.size(); ++i)
        corners.push_back(double(leaves().triangles[i]) + (i % 3 == 0 ? 4.5e6 : i % 3 == 1 ? 100 : 6e6));
    for (std::size_t i = 0; i < 1500; ++i)
        places.insert(places.end(), {4.5e6 - 4 + double(i % 50) * 0.161, 100 + double(i % 7) * 0.4,
                                     6e6 - 4 + double(i / 50) * 0.267});
    const WorldLattice one = WorldLattice::around(corners, -10);
    WorldLattice other = one;
    other.origin[0] += 4'000'001;
    other.origin[2] -= 77;
    const Light sun = lights[0];
    std::vector<Floats> seen;
    for (const WorldLattice& lattice : {one, other}) {
        const Floats triangles = lattice.snap(corners).positions, points = lattice.snap(places).positions;
        const scene::CutOutsView cut_outs(leaves());
        const Points given = Points::upload(device, points);
        seen.push_back(support::answer(device, *support::technique_with(device, {}),
                                       Triangles::upload(device, triangles, *cut_outs.get()), given, sun)
                           .visibility);
        const reference::Masks masks = support::masks_of(leaves());
        const auto truth = reference::shadowed(triangles, points, {}, sun.xyzw, {}, nullptr, &masks);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) wrong += seen.back()[i] != (truth[i] ? 0.0f : 1.0f);
        EXPECT_EQ(wrong, 0u);
        EXPECT_NE(seen.back(), support::answer(device, *support::technique_with(device, {}),
                                               Triangles::upload(device, triangles), given, sun)
                                   .visibility)
            << "the masks must matter";
    }
    EXPECT_EQ(seen[0], seen[1]);
}

// ---- Techniques that are not exact ----------------------------------------------------------------------------------

std::size_t different(const Floats& a, const Floats& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += (a[i] >= 0.5f) != (b[i] >= 0.5f);
    return count;
}

/// A technique's visibility of the points of the whole scene's first view.
Floats by_technique(const Device& device, const std::string& name, const scene::Scene& scene, const Light& light) {
    const View view = look(device, scene::upload(device, leaves()), camera_of(views[0]), width, height);
    const Visibility visibility(device, view.points.count());
    support::technique_with(device, {}, name)->run(scene::upload(device, scene), view.points, light, visibility);
    return visibility.read();
}

// Maps are right but for their texels: most of what an opaque map has wrong is gone. A sub-pixel map is never dark
// where the truth is lit.
TEST(Leaves, MapsTestMasks) {
    const scene::Scene opaque = without_cut_outs();
    for (const bool gpu_kernels : {false, true}) {
        const Device device({}, {.gpu_kernels = gpu_kernels});
        for (const char* const name : {"shadow-map", "virtual-shadow-map", "sub-pixel"})
            for (const Light& light : {lights[0], lights[2]}) {
                const bool is_sub_pixel = std::string_view(name) == "sub-pixel";
                if (gpu_kernels && light.is_directional()) continue;
                SCOPED_TRACE(name + std::string(gpu_kernels ? ", kernels for GPUs" : ", kernels for CPUs"));
                const Floats truth = by_technique(device, "frustum-traced", leaves(), light);
                const Floats masked = by_technique(device, name, leaves(), light);
                const Floats plain = by_technique(device, name, opaque, light);
                EXPECT_GT(different(plain, truth), 100u);
                EXPECT_LT(different(masked, truth), is_sub_pixel ? 10 : different(plain, truth) * 2 / 3)
                    << "of " << different(plain, truth) << " with an opaque map";
                EXPECT_EQ(by_technique(device, name, with_alpha(255), light), plain);
                const Floats clear = by_technique(device, name, with_alpha(0), light),
                             truth_of_clear = by_technique(device, "frustum-traced", with_alpha(0), light);
                EXPECT_LT(different(clear, truth_of_clear), 60u);
                if (!is_sub_pixel) continue;
                for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_FALSE(masked[i] == 0 && truth[i] == 1);
            }
    }
}

// ---- explain --------------------------------------------------------------------------------------------------------

using Ids = std::set<std::uint32_t>;

Ids ids_of(const std::vector<TriangleSigns>& list) {
    Ids ids;
    double distance = 0;
    for (const TriangleSigns& t : list) {
        EXPECT_TRUE(ids.insert(t.triangle).second) << "triangle " << t.triangle << " is listed twice";
        EXPECT_GE(t.distance, distance) << "triangle " << t.triangle << " is not in order";
        distance = t.distance;
    }
    return ids;
}

/// The triangles that the oracle says the shadow ray meets, where they are opaque, and where they are clear.
std::array<Ids, 2> met_by(const Explanation& e, const Light& light) {
    static const reference::Masks masks = support::masks_of(leaves());
    const reference::Ray ray = reference::Ray::to_light(e.position, light.xyzw);
    reference::Effort effort;
    std::array<Ids, 2> met;
    for (std::uint32_t id = 0; id < leaves().triangle_count(); ++id) {
        const float* v = &leaves().triangles[9 * std::size_t(id)];
        const reference::Triangle triangle{{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}}};
        if (id == e.receiver || !reference::blocks(ray, triangle, effort)) continue;
        met[masks.is_opaque(id, triangle, ray) ? 0 : 1].insert(id);
    }
    return met;
}

TEST(Leaves, ExplainNamesTheHolesThatTheRayPasses) {
    std::size_t clear = 0, blocking = 0, only_clear = 0;
    for (const bool gpu_kernels : {false, true}) {
        const Device device({}, {.gpu_kernels = gpu_kernels});
        const Triangles triangles = scene::upload(device, leaves()),
                        all_opaque = scene::upload(device, with_alpha(255)),
                        all_clear = scene::upload(device, with_alpha(0)),
                        plain = scene::upload(device, without_cut_outs());
        const Points points = look(device, triangles, camera_of(views[0]), width, height).points;
        for (std::size_t i = width * height / 3; i < points.count(); i += 47) {
            const Light& light = lights[i % 3];
            const Explanation e = explain(device, triangles, points, i, light);
            EXPECT_TRUE(e.is_consistent());
            if (!std::isfinite(e.position[0])) continue;
            const auto [opaque_hits, clear_hits] = met_by(e, light);
            EXPECT_EQ(ids_of(e.occluders), opaque_hits);
            EXPECT_EQ(ids_of(e.clear_hits), clear_hits);
            for (const TriangleSigns& t : e.clear_hits) EXPECT_TRUE(t.is_clear && !t.blocks);
            for (const TriangleSigns& t : e.near_misses)
                EXPECT_TRUE(!t.is_clear && !t.blocks && !opaque_hits.contains(t.triangle) &&
                            !clear_hits.contains(t.triangle));
            clear += clear_hits.size();
            blocking += opaque_hits.size();
            only_clear += opaque_hits.empty() && !clear_hits.empty() && !e.is_backfacing;
            // The controls: nothing is clear, and all that is masked is.
            const Explanation of_opaque = explain(device, all_opaque, points, i, light),
                              of_clear = explain(device, all_clear, points, i, light),
                              of_plain = explain(device, plain, points, i, light);
            EXPECT_TRUE(of_opaque.clear_hits.empty() && of_plain.clear_hits.empty());
            EXPECT_EQ(ids_of(of_opaque.occluders), ids_of(of_plain.occluders));
            Ids masked, others;
            for (const std::uint32_t id : ids_of(of_plain.occluders)) (is_masked(id) ? masked : others).insert(id);
            EXPECT_EQ(ids_of(of_clear.clear_hits), masked);
            EXPECT_EQ(ids_of(of_clear.occluders), others);
        }
    }
    EXPECT_GT(clear, 20u);
    EXPECT_GT(blocking, 20u);
    EXPECT_GT(only_clear, 3u) << "points that are lit through holes";
}

}  // namespace
