// SPDX-License-Identifier: MIT
// The list of cases. See cases.hpp.
#include "cases.hpp"

#include <fmt/core.h>
#include <cmath>

#include "scenes.hpp"
#include "support/tie_points.hpp"

namespace stress {
namespace {

using support::add;
using support::along;
using support::append;
using support::at;

std::shared_ptr<const Floats> shared(Floats triangles) { return std::make_shared<const Floats>(std::move(triangles)); }

std::vector<Light> unit_lights() {
    std::vector<Light> lights;
    for (const auto& [name, light] : support::lights_of_every_kind()) lights.push_back(light);
    return lights;
}

/// A subject of the cube [-1, 1]^3 under lights of every kind, scaled and moved as a whole: coordinates round once.
Subject placed_subject(const Floats& triangles, double scale = 1, const std::array<double, 3>& offset = {}) {
    Subject subject{shared(support::placed(triangles, scale, offset)), {}, {}, 2 * scale, scale, offset};
    for (const Light& light : unit_lights()) subject.lights.push_back(support::moved(light, scale, offset));
    const Floats eye = support::placed({0.7f, 1.1f, 2.4f, 0, 0, 0}, scale, offset);
    subject.views = {{{eye[0], eye[1], eye[2]}, {eye[3], eye[4], eye[5]}}};
    return subject;
}

/// Triangles of whole numbers under lights along the diagonals of their cells, point lights on their vertices and in
/// their cells: exact ties everywhere. In odd variants all is 331 times as large: exact still, but no longer in float
/// products.
Subject lattice_subject(const Floats& triangles, std::uint64_t variant) {
    const double scale = variant % 2 == 0 ? 1 : 331;
    Subject subject{shared(support::placed(triangles, scale, {})), {}, {}, 4 * scale, scale};
    for (const Light& light :
         {along(1, 0, 0), along(1, 1, 0), along(1, 1, 1), along(0, -1, 0), along(-1, 2, 3), along(1, -1, 1),
          along(-2, -1, 0), along(3, -1, 2), at(2, 7, 2), at(2.5f, 2.5f, 2.5f), at(20, 40, 20)})
        subject.lights.push_back(support::moved(light, scale, {}));
    return subject;
}

// ---- Shapes that tests/support does not have
// --------------------------------------------------------------------------

/// Long, a thousandth of a millimetre wide, all along x.
Floats skinny(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const float y = random.between(-1, 1), z = random.between(-1, 1);
        add(triangles, {-1, y, z}, {1, y + random.between(-1e-6f, 1e-6f), z + random.between(-1e-6f, 1e-6f)},
            {0, y + random.between(-0.05f, 0.05f), z + random.between(-1e-5f, 1e-5f)});
    }
    return triangles;
}

/// A sphere's mesh with every vertex pulled in or pushed out: closed, full of concave edges, star-shaped around 0.
Floats star(int subdivisions, std::uint64_t seed) {
    Floats triangles = support::icosphere(subdivisions, 1);
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        // By the vertex's own bits, so that neighbours agree.
        std::uint64_t bits = seed;
        for (std::size_t c = 0; c < 3; ++c)
            bits = bits * 1099511628211u + static_cast<std::uint64_t>(std::lround(triangles[i + c] * 1e4));
        const float radius = Random(bits).between(0.6f, 1.4f);
        for (std::size_t c = 0; c < 3; ++c) triangles[i + c] *= radius;
    }
    return triangles;
}

/// `side` x `side` cells of two triangles; heights are whole numbers of `step`.
Floats terrain(int side, std::uint32_t levels, float step, std::uint64_t seed) {
    Random random(seed);
    std::vector<float> height;
    for (int i = 0; i < (side + 1) * (side + 1); ++i) height.push_back(step * float(random.below(levels)));
    const auto corner = [&](int x, int z) {
        return Float3{float(x), height[std::size_t(z * (side + 1) + x)], float(z)};
    };
    Floats triangles;
    for (int z = 0; z < side; ++z)
        for (int x = 0; x < side; ++x) {
            add(triangles, corner(x, z), corner(x + 1, z), corner(x + 1, z + 1));
            add(triangles, corner(x, z), corner(x + 1, z + 1), corner(x, z + 1));
        }
    return triangles;
}

/// A flat floor of 32 x 32 cells in a plane askew to all axes, and lights `slope` rad off that plane, on both sides.
Subject tilted_floor(double slope) {
    // Columns of a rotation with whole numbers: (2, 3, 6), (3, -6, 2), (6, 2, -3), each of length 7.
    const auto turned = [](double along_x, double up, double along_z) {
        return std::array<double, 3>{(2 * along_x + 3 * up + 6 * along_z) / 7, (3 * along_x - 6 * up + 2 * along_z) / 7,
                                     (6 * along_x + 2 * up - 3 * along_z) / 7};
    };
    const auto rounded = [](const std::array<double, 3>& v) { return Float3{float(v[0]), float(v[1]), float(v[2])}; };
    Floats triangles = terrain(32, 1, 1, 1);
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        const Float3 v = rounded(turned(triangles[i] - 16, triangles[i + 1], triangles[i + 2] - 16));
        std::copy(v.begin(), v.end(), triangles.begin() + static_cast<std::ptrdiff_t>(i));
    }
    Subject subject{shared(std::move(triangles)), {}, {}, 16, 16};
    for (const double angle : {0.1, 0.8, 2.0})
        for (const double side : {-1.0, 1.0}) {
            const Float3 d = rounded(turned(std::cos(angle), side * slope, std::sin(angle)));
            subject.lights.push_back({d[0], d[1], d[2], 0});
        }
    const Float3 position = rounded(turned(60, 60 * slope, 10)), eye = rounded(turned(-3, 5, 24));
    subject.lights.push_back(at(position[0], position[1], position[2]));
    subject.views = {{eye, {0, 0, 0}}};
    return subject;
}

/// Around a point light, with vertices in the planes W = 0 of the cube's faces and an ulp beside them.
Floats around(const Light& light, std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < 3 * count; ++i) {
        Float3 v = support::random_vector(random, -size, size);
        for (int c = 0; c < 3; ++c) v[c] = random.below(3) == 0 ? light[c] : light[c] + v[c];
        add(triangles, random.below(2) == 0 ? v : support::nudged(random, v));
    }
    return triangles;
}

/// Each triangle as it is, again, and with the other face in front.
Floats in_triplicate(const Floats& once) {
    Floats triangles = once;
    append(triangles, once);
    append(triangles, support::reversed_winding(once));
    return triangles;
}

/// Something of everything: the scene that is moved and scaled.
Floats medley(std::uint64_t seed) {
    Floats triangles = support::soup(150, 0.3f, seed);
    append(triangles, support::placed(support::lattice_blocks(12, 4, seed + 1), 0.25, {-0.5, -0.5, -0.5}));
    append(triangles, support::placed(support::icosphere(2, 0.5f), 1, {0.25, 0.5, -0.25}));
    return triangles;
}

// ---- Points that one case alone asks for
// --------------------------------------------------------------------------------

/// Strictly inside a sphere's mesh of radius 2: every face lies beyond 1.5.
void points_inside_a_sphere(const PointRequest& request, Question& question) {
    while (question.points.size() < 3 * request.count) {
        const Float3 p = support::random_vector(request.random, -1.5f, 1.5f);
        if (std::hypot(p[0], p[1], p[2]) < 1.5f) add(question.points, p);
    }
    question.is_inside = true;
}

/// On the floor y = 1 of whole cells, one ulp over it and one under it; some with a receiver.
void points_at_the_floor(const PointRequest& request, Question& question) {
    const float heights[] = {1.0f, std::nextafter(1.0f, 2.0f), std::nextafter(1.0f, 0.0f)};
    const auto triangles = static_cast<std::uint32_t>(question.triangles->size() / 9);
    for (std::size_t i = 0; i < request.count; ++i) {
        add(question.points, {float(request.random.below(65)) / 2, heights[request.random.below(3)],
                              float(request.random.below(65)) / 2});
        question.receivers.push_back(request.random.below(2 * triangles));
    }
}

void view_of_a_star(const PointRequest& request, Question& question) {
    Random& random = request.random;
    // The farther the eye, the coarser an ulp of it: that is what pushes points through faces.
    constexpr float distances[] = {3, 100, 10'000};
    Viewpoint from;
    from.eye = support::random_vector(random, -1, 1);
    const float distance = distances[request.variant % 3] / std::hypot(from.eye[0], from.eye[1], from.eye[2]);
    for (float& x : from.eye) x *= distance;
    from.fov_y_degrees = 360 / std::numbers::pi * std::asin(1.4 / distances[request.variant % 3]);
    const auto side = std::max<std::uint32_t>(2, static_cast<std::uint32_t>(std::sqrt(double(request.count))));
    add_view(request.device, from, side, side, question);
    question.star_view = reference::PinholeCamera{from.eye, from.target, from.up, from.fov_y_degrees, side, side};
}

MakePoints view_of(std::uint32_t width, std::uint32_t height) {
    return [=](const PointRequest& request, Question& question) {
        add_view(request.device, request.subject.views.at(0), width, height, question);
    };
}

void no_points(const PointRequest&, Question&) {}

/// NaN and infinity among good triangles and points.
Subject not_finite(std::uint64_t seed) {
    Floats triangles = support::soup(200, 0.4f, seed);
    Random random(seed);
    for (int i = 0; i < 60; ++i)
        triangles[random.below(static_cast<std::uint32_t>(triangles.size()))] =
            i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
    Subject subject = placed_subject({});
    subject.triangles = shared(triangles);
    return subject;
}

void points_not_finite(const PointRequest& request, Question& question) {
    points_in_the_cube(request, question);
    Random& random = request.random;
    for (std::size_t i = 0; i < request.count / 8; ++i)
        question.points[random.below(static_cast<std::uint32_t>(question.points.size()))] =
            -std::numeric_limits<float>::infinity();
}

// ---- Rooms of the list
// ----------------------------------------------------------------------------------------------------

const std::vector<MakePoints> cube_points = {points_in_the_cube, points_near_triangles, points_on_rays};
const std::vector<MakePoints> scene_points = {points_of_a_view, points_near_triangles, points_on_rays};

void add_soups(std::vector<Case>& list, std::uint64_t seed) {
    list.push_back({"soup", "400 random triangles",
                    [=](auto v) { return placed_subject(support::soup(400, 0.3f, seed + v)); }, cube_points});
    list.push_back({"dense soup", "20,000 small random triangles",
                    [=](auto v) { return placed_subject(support::soup(20000, 0.05f, seed + v)); }, cube_points});
    list.push_back({"specks and giants", "5,000 specks among triangles as large as the scene and far larger",
                    [=](auto v) {
                        Floats triangles = support::soup(5000, 0.004f, seed + v);
                        append(triangles, support::soup(8, 4, seed + v + 1));
                        append(triangles, support::soup(3, 1e5f, seed + v + 2));
                        return placed_subject(triangles);
                    },
                    cube_points});
    list.push_back({"needle fan", "3,000 needles that share a tip and their edges",
                    [=](auto) {
                        Subject subject = placed_subject(support::needle_fan(3000, 8));
                        subject.scale = 6;
                        subject.reach = 6;
                        for (const Light& light : {along(1, -1, 0), at(0, 1, 0), at(4, 0, 1), at(2, 0.001f, 3)})
                            subject.lights.push_back(light);
                        return subject;
                    },
                    cube_points, 0.1});
    list.push_back({"skinny, nearly parallel", "500 triangles 2 long and 1e-5 wide",
                    [=](auto v) { return placed_subject(skinny(500, seed + v)); }, cube_points});
    list.push_back({"slivers", "5,000 slivers that all cross one axis",
                    [=](auto v) { return placed_subject(support::slivers(5000, 1e-4f, seed + v)); }, cube_points,
                    0.05});
    list.push_back({"duplicates", "every triangle three times, once with the other face in front",
                    [=](auto v) {
                        Floats once = support::soup(80, 0.6f, seed + v);
                        append(once, support::placed(support::lattice_blocks(8, 4, seed + v), 0.5, {-1, -1, -1}));
                        return placed_subject(in_triplicate(once));
                    },
                    cube_points});
    list.push_back({"around a point light",
                    "triangles on all sides of a point light, vertices in the planes of its cube's faces",
                    [=](auto v) {
                        const Light light = at(0.05f, -0.1f, 0.2f);
                        constexpr float sizes[] = {1, 1e-4f, 0.01f, 30};
                        return Subject{shared(around(light, 300, sizes[v % 4], seed + v)),
                                       {light, along(0, -1, 0), at(0.05f, 3, 0.2f)}};
                    },
                    cube_points});
}

void add_closed_meshes(std::vector<Case>& list, std::uint64_t seed) {
    list.push_back({"inside closed meshes",
                    "points strictly inside a sphere's mesh, lit from outside at every angle",
                    [=](auto v) {
                        Subject subject{shared(support::icosphere(int(v % 6), 2)), {}};
                        Random random(seed + v);
                        const auto vertices = static_cast<std::uint32_t>(subject.triangles->size() / 3);
                        for (int i = 0; i < 12; ++i) {
                            const Float3 d = i % 3 == 0 ? support::vertex(*subject.triangles, random.below(vertices))
                                                        : support::random_vector(random, -1, 1);
                            subject.lights.push_back({d[0], d[1], d[2], 0});
                            subject.lights.push_back(at(8 * d[0] + 4, 8 * d[1], 8 * d[2]));
                            if (std::hypot(8 * d[0] + 4, 8 * d[1], 8 * d[2]) < 2.1f) subject.lights.pop_back();
                        }
                        return subject;
                    },
                    {points_inside_a_sphere},
                    1,
                    6});
    list.push_back({"camera at closed meshes",
                    "camera points of a spiky closed mesh: how many slip through a face",
                    [=](auto v) { return placed_subject(star(2 + int(v % 3), seed + v)); },
                    {view_of_a_star}});
}

void add_lattices(std::vector<Case>& list, std::uint64_t seed) {
    const std::vector<MakePoints> points = {points_on_lattice, points_exactly_behind, points_near_triangles};
    list.push_back({"lattice", "cubes of an integer lattice under (1,0,0), (1,1,0), (1,1,1) and other exact ties",
                    [=](auto v) { return lattice_subject(support::lattice_blocks(24, 5, seed + v), v); }, points});
    list.push_back({"lattice city", "2,000 cubes on a lattice of 40 cells, the same lights",
                    [=](auto v) { return lattice_subject(support::lattice_blocks(2000, 40, seed + v), v); }, points});
    list.push_back({"vertices and edges hit exactly",
                    "an integer landscape, each ray through a vertex or an edge's middle",
                    [=](auto v) { return lattice_subject(terrain(40, 4, 1, seed + v), v); },
                    {points_exactly_behind},
                    2});
    list.push_back({"grazing by 1e-6",
                    "flat floors whose light is 1e-6 rad off their plane; points an ulp over and under it",
                    [=](auto) {
                        Subject subject{shared(support::placed(terrain(32, 1, 1, 1), 1, {0, 1, 0})), {}};
                        subject.lights = {along(1, -1e-6f, 0),   along(1, -1e-6f, 0.3f), along(-1, 1e-6f, 0),
                                          along(1, -1e-6f, 1),   at(-100, 1.0001f, 5),   at(8, 1.0000001f, 8),
                                          along(0.3f, -3e-7f, 1)};
                        subject.views = {{{-3, 4, 40}, {16, 1, 16}}, {{16, 1.0001f, -5}, {16, 1, 16}}};
                        return subject;
                    },
                    {points_at_the_floor, points_of_a_view, points_on_rays}});
    list.push_back({"tilted floor, grazing by 1e-6",
                    "the same in a plane askew to all axes, so that its vertices are rounded",
                    [](auto) { return tilted_floor(1e-6); },
                    {points_of_a_view, points_near_triangles, points_on_rays}});
    list.push_back(
        {"rough floor, grazing",
         "a floor whose heights differ by single ulps, light 1e-6 rad off it",
         [=](auto v) {
             Subject subject{shared(support::placed(terrain(32, 3, 0x1p-23f, seed + v), 1, {0, 1, 0})), {}};
             subject.lights = {along(1, -1e-6f, 0), along(1, -1e-6f, 1), at(-100, 1.0001f, 5), along(0.3f, -3e-7f, 1)};
             subject.views = {{{-3, 4, 40}, {16, 1, 16}}, {{16, 1.0001f, -5}, {16, 1, 16}}};
             return subject;
         },
         {points_at_the_floor, points_of_a_view, points_on_rays}});
}

void add_places(std::vector<Case>& list, std::uint64_t seed) {
    const std::vector<MakePoints> points = {points_in_the_cube, points_near_triangles, points_on_rays,
                                            points_of_a_view};
    const auto text = [](const char* what, double x) { return fmt::format("{} {:g}", what, x); };
    for (const double offset : {1e3, 1e4, 1e5, 1e6, 1e7})
        list.push_back({text("moved by", offset), "soup, cubes and a sphere, far from the origin",
                        [=](auto v) {
                            return placed_subject(medley(seed + v), 1, {offset, -offset / 2, offset / 3});
                        },
                        points, 0.5});
    for (const double scale : {1e-6, 1e-3, 1e3, 1e6})
        list.push_back({text("scaled by", scale), "the same, around the origin",
                        [=](auto v) { return placed_subject(medley(seed + v), scale); }, points, 0.5});
    for (const double offset : {1e5, 1e6})
        list.push_back({text("camera at", offset),
                        "a view of the same, 20 times as large, by a camera there",
                        [=](auto v) {
                            return placed_subject(medley(seed + v), 20, {offset, offset, -offset});
                        },
                        {points_of_a_view}});
}

/// Scenes of the maker: idea, recipe, and whether a view of it is all that makes sense.
void add_made_scenes(std::vector<Case>& list, const CaseOptions& options) {
    struct Made {
        const char *name, *recipe, *idea;
    };
    const Made scenes[] = {
        {"thin wires", "thin_wires", "wires a millimetre thick"},
        {"grass", "grass", "bent blades"},
        {"millimetres in kilometres", "millimetres_in_kilometres", "pins and dice on a plain of kilometres"},
        {"cathedral at 1e6", "cathedral_far", "a nave where float32 steps are 62 mm"},
        {"one over everything", "one_over_everything", "one giant triangle over a small yard"},
        {"light in planes", "light_in_plane", "fins exactly edge-on to the light"},
        {"zero areas", "degenerate", "points and lines among good triangles"},
        {"coincident", "coplanar_pair", "coincident and overlapping coplanar triangles, both windings"},
        {"one-sided planes", "one_sided_plane", "open planes wound either way"},
        {"lit from inside", "closed_box_lit_inside", "closed meshes with point lights inside, outside and within them"},
        {"concave corners", "concave_corners", "a room's corner, stairs, an acute wedge"},
    };
    // Scenes differ in what they bring: each gets a sun, a sun along an axis and a point light.
    const auto lit = [seed = options.seed](const char* recipe, std::uint32_t triangles) {
        Subject subject = made_scene(recipe, seed, triangles);
        const Float3 eye = subject.views.at(0).eye;
        for (const Light& light : {along(0.3f, -1, 0.2f), along(0, -1, 0), at(eye[0], eye[1], eye[2])})
            subject.lights.push_back(light);
        return subject;
    };
    for (const Made& made : scenes)
        list.push_back({made.name, made.idea, [=](auto) { return lit(made.recipe, 0); }, scene_points, 0.5, 2});
    list.push_back({fmt::format("{} slivers", options.slivers),
                    "all through one texel, a few millimetres wide",
                    [=, count = options.slivers](auto) {
                        Subject subject = lit("million_slivers", count);
                        subject.lights.erase(subject.lights.begin(), subject.lights.end() - 2);
                        std::swap(subject.views.at(0), subject.views.at(1));  // the one that looks into the texel
                        return subject;
                    },
                    {points_of_a_view},
                    0.002,
                    1});
}

void add_extremes(std::vector<Case>& list, std::uint64_t seed) {
    // Of the reference's own hard scenes those that no case above resembles.
    struct Extreme {
        const char *name, *idea;
    };
    for (const Extreme& extreme :
         {Extreme{"nearly flat", "all in one plane, up to single ulps"},
          Extreme{"denormals", "coordinates of a few denormals"}, Extreme{"huge", "coordinates up to 3.4e38"},
          Extreme{"all of float's range", "coordinates of 1e-45 to 3.4e38, mixed"}}) {
        const auto scene_of = [=](std::uint64_t variant, std::size_t more_points) {
            for (reference::TestScene& scene : reference::all_test_scenes(100 * seed + variant, more_points))
                if (scene.name == extreme.name) return scene;
            throw std::logic_error(std::string("the reference has no scene ") + extreme.name);
        };
        const auto points = [=](const PointRequest& request, Question& question) {
            const reference::TestScene scene = scene_of(request.variant, request.count / 160 + 1);
            question.points = scene.points;
            question.receivers = scene.receivers;
        };
        list.push_back({extreme.name,
                        extreme.idea,
                        [=](auto v) {
                            const reference::TestScene scene = scene_of(v, 1);
                            Subject subject{shared(scene.triangles), {}};
                            for (const Light& light : scene.lights)  // a direction of zero is no light
                                if (light[3] != 0 || light[0] != 0 || light[1] != 0 || light[2] != 0)
                                    subject.lights.push_back(light);
                            return subject;
                        },
                        {points},
                        0.2,
                        8,
                        50'000});
    }
}

void add_borders(std::vector<Case>& list, const CaseOptions& options) {
    const std::uint64_t seed = options.seed;
    list.push_back({"NaN and infinity",
                    "among good triangles and points",
                    [=](auto v) { return not_finite(seed + v); },
                    {points_not_finite},
                    0.1});
    list.push_back(
        {"no triangles", "nothing casts", [](auto) { return placed_subject({}); }, {points_in_the_cube}, 0.01});
    list.push_back({"no points",
                    "nothing is asked",
                    [=](auto v) { return placed_subject(support::soup(50, 0.5f, seed + v)); },
                    {no_points},
                    0});
    list.push_back({"one pixel",
                    "and views of one row and one column",
                    [=](auto v) { return placed_subject(support::icosphere(2, 1 + float(v % 7) / 8)); },
                    {view_of(1, 1), view_of(257, 1), view_of(1, 257)},
                    0});
    const std::uint32_t side = options.longest_side;
    list.push_back({fmt::format("{} x {}", side, side),
                    "a view that large, and strips as long",
                    [=](auto v) {
                        Subject subject = placed_subject(medley(seed + v));
                        subject.lights = {subject.lights[0], subject.lights[5]};
                        // Most pixels see the sky; the last rows and columns do not.
                        subject.views = {{{0.7f, 1.1f, 2.4f}, {-1.4f, 2.6f, 0}, {0, 1, 0}, 95}};
                        return subject;
                    },
                    {view_of(side, side), view_of(side, 7), view_of(7, side)},
                    0,
                    1});
}

void add_real_scenes(std::vector<Case>& cases) {
    cases.push_back({"Sponza", "views and lights of views.json, and a point light",
                     [](auto) {
                         Subject subject = real_scene("sponza");
                         subject.lights.push_back(at(-100, 700, -30));
                         subject.lights.push_back(along(0, -1, 0));
                         return subject;
                     },
                     scene_points, 6, 2, 2'000'000});
    cases.push_back({"lost_empire", "a city on a 16-bit lattice, its views and lights, and a point light",
                     [](auto) {
                         Subject subject = real_scene("lost_empire");
                         subject.lights.push_back(at(10, 45, 40));
                         return subject;
                     },
                     scene_points, 6, 2, 2'000'000});
    cases.push_back({"lost_empire, exact ties",
                     "the same under axes, diagonals and a point light on the lattice; points on its lattice too",
                     [](auto) {
                         Subject subject = real_scene("lost_empire");
                         subject.lights = {along(1, -1, 1), along(-1, -1, -1), along(0, -1, 0),
                                           along(1, -1, 0), along(-1, 0, 0),   at(10, 45, 40)};
                         return subject;
                     },
                     {points_of_a_view, points_on_lattice, points_exactly_behind},
                     3,
                     2,
                     2'000'000});
}

}  // namespace

std::vector<Case> all_cases(const CaseOptions& options) {
    std::vector<Case> cases;
    const std::uint64_t seed = 1000 * options.seed;
    add_soups(cases, seed);
    add_closed_meshes(cases, seed);
    add_lattices(cases, seed);
    add_places(cases, seed);
    add_made_scenes(cases, options);
    add_extremes(cases, seed);
    add_borders(cases, options);
    add_cut_outs(cases, seed);
    add_real_scenes(cases);
    return cases;
}

}  // namespace stress
