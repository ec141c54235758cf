// SPDX-License-Identifier: MIT
// Techniques that filter what a map stores, over two planes: a floor and a tilted plate above it, which lies inside the
// map's range of depths or, seen by no point, before it. Farther than the filter's width from silhouettes every texel's
// depth has a closed form, so each technique's published formula gives its value in double. Derivatives are those of
// the depth that is stored: 0 where it is clamped.
#include <gtest/gtest.h>

#include "support/expect_exact.hpp"
#include "support/map_fits.hpp"

namespace {

using namespace support;
using gnomon::Light;

constexpr int side = 256;         // of the map, texels
constexpr int half_window = 3;    // of the widest filter around a point's texel, with the bilinear lookup
constexpr double half_plate = 3;  // along x and z

struct Plane {
    Double3 normal;
    double offset;  ///< normal . p = offset
};

/// A plate of 6 x 6 seen from above, its lowest edge 2 over the floor.
struct Plate {
    double slope;
    explicit Plate(double degrees) : slope(std::tan(degrees * std::numbers::pi / 180)) {}
    float height(double x) const { return float(2 + slope * (x + half_plate)); }
    Plane plane() const { return {{-slope, 1, 0}, 2 + slope * half_plate}; }
};

Floats floor_and_plate(const Plate& plate) {
    Floats triangles;
    add(triangles, {-40, 0, -40}, {40, 0, -40}, {40, 0, 40});
    add(triangles, {-40, 0, -40}, {40, 0, 40}, {-40, 0, 40});
    const float low = plate.height(-half_plate), high = plate.height(half_plate), h = half_plate;
    add(triangles, {-h, low, -h}, {h, high, -h}, {h, high, h});
    add(triangles, {-h, low, -h}, {h, high, h}, {-h, low, h});
    return triangles;
}

/// Points over the floor and, if the plate shall lie inside the map's range of depths, on its upper side too. Only
/// those of the floor, the first ones, are judged.
constexpr int floor_columns = 31;
Floats points_of(const Plate& plate, bool is_inside) {
    Floats points;
    for (int i = 0; i < floor_columns * floor_columns; ++i)
        add(points, {0.583f * float(i % floor_columns - 15), 0, 0.571f * float(i / floor_columns - 15)});
    if (is_inside)
        for (const float x : {-2.9f, 0.0f, 2.9f}) add(points, {x, plate.height(x), 0.1f});
    return points;
}

// ---- The planes' depths in the map ----------------------------------------------------------------------------------

/// A map that was fitted to the points, read back; the ray of light of a place in it is where two planes meet.
struct Map {
    MapView view;
    Plate plate;

    Double3 on_plane(double u, double v, const Plane& plane) const {
        const auto row = [&](const float* along, double share) {
            std::array<double, 4> r;
            for (int i = 0; i < 4; ++i) r[i] = along[i] - share * view.row_w[i];
            return r;
        };
        const auto a = row(view.row_u, u), b = row(view.row_v, v);
        const Double3 na{a[0], a[1], a[2]}, nb{b[0], b[1], b[2]};
        const Double3 normal = plane.normal, origin = to_double(view.origin);
        const double c = plane.offset - dot(normal, origin);
        const Double3 q =
            (c * cross(na, nb) - a[3] * cross(nb, normal) - b[3] * cross(normal, na)) / dot(cross(na, nb), normal);
        return q + origin;
    }
    double depth(double u, double v, const Plane& plane) const { return place(view, on_plane(u, v, plane)).depth; }
    bool shows_plate(double u, double v) const {
        const Double3 p = on_plane(u, v, plate.plane());
        return std::fabs(p[0]) < half_plate && std::fabs(p[2]) < half_plate;
    }
};

/// A texel's depth and the squared slope of the depth before it is clamped, per texel.
struct Texel {
    double depth, slope2;
};

Texel texel_of(const Map& map, int x, int y, const Plane& plane) {
    const auto depth = [&](double i, double j) { return map.depth((x + 0.5 + i) / side, (y + 0.5 + j) / side, plane); };
    const double e = 1e-3, dx = (depth(e, 0) - depth(-e, 0)) / (2 * e), dy = (depth(0, e) - depth(0, -e)) / (2 * e);
    return {depth(0, 0), dx * dx + dy * dy};
}

// ---- The published formulas -----------------------------------------------------------------------------------------

// Setting moment-bias, larger than the presets' own: rounding of floats then moves no value by 1e-3.
constexpr double min_deviation = 3e-3, min_share = 3e-5;

struct Formula {
    std::string technique;
    Settings settings;
    /// The numbers of a texel, and the visibility that their means give a point of depth t.
    std::function<std::vector<double>(const Texel&)> numbers;
    std::function<double(const std::vector<double>&, double t)> visibility;
    double bias = 1e-4;   ///< constant-bias
    bool is_box = false;  ///< a box of five texels in place of the Gaussian
    bool is_for_edges_only = false;
};

/// A depth's place between low and high, and its variance within the texel: that of a Gaussian of half a texel's
/// deviation (Donnelly and Lauritzen 2006). The derivative of a clamped place is 0, and no quantity in [0, 1] varies
/// more than its mean allows: the limit of that term that Lauritzen asks for (GPU Gems 3, chapter 8).
std::vector<double> two_moments(const Texel& texel, double low, double high) {
    const double length = high - low, z = (texel.depth - low) / length;
    if (z <= 0) return {0, 0};
    if (z >= 1) return {1, 1};
    return {z, z * z + std::min(texel.slope2 / (4 * length * length), z * (1 - z))};
}

double chebyshev(double mean, double square, double t, double deviation) {
    if (t <= mean) return 1;
    const double variance = std::max(square - mean * mean, deviation * deviation);
    return variance / (variance + (t - mean) * (t - mean));
}

Texel clamped(const Texel& texel) { return {std::clamp(texel.depth, 0.0, 1.0), 0}; }

Formula variance_formula(const std::string& technique) {
    return {technique,
            {},
            [](const Texel& texel) {
                return two_moments({texel.depth, texel.slope2}, 0, 1);
            },
            [](const auto& m, double t) { return chebyshev(m[0], m[1], t, min_deviation); }};
}

/// Layers of equal length, each reaching half of it back into the one before (Lauritzen and McCool 2008).
Formula layered_formula(int layers) {
    const auto low = [layers](int l) { return (l - (l > 0 ? 0.5 : 0)) / layers; };
    const auto high = [layers](int l) { return (l + 1.0) / layers; };
    return {"layered-vsm",
            {{"layers", std::to_string(layers)}, {"moment-bias", "0.003"}},
            [=](const Texel& texel) {
                std::vector<double> all;
                for (int l = 0; l < layers; ++l)
                    for (const double number : two_moments(texel, low(l), high(l))) all.push_back(number);
                return all;
            },
            [=](const auto& m, double t) {
                const int l = std::clamp(int(t * layers), 0, layers - 1);
                const double length = high(l) - low(l);
                return chebyshev(m[2 * l], m[2 * l + 1], std::clamp((t - low(l)) / length, 0.0, 1.0),
                                 min_deviation / length);
            }};
}

/// Annen et al. 2007: the step's Fourier series with 16 terms, moved by half its rise.
Formula convolution_formula() {
    const auto c = [](int k) { return std::numbers::pi * (2 * k + 1); };
    return {"convolution",
            {},
            [=](const Texel& texel) {
                std::vector<double> all;
                for (int k = 0; k < 16; ++k)
                    for (const double number :
                         {std::sin(c(k) * clamped(texel).depth), std::cos(c(k) * clamped(texel).depth)})
                        all.push_back(number);
                return all;
            },
            [=](const auto& m, double t) {
                double sum = 0.5;
                for (int k = 0; k < 16; ++k)
                    sum +=
                        2 / c(k) * std::exp(-0.1 * (k + 1) * (k + 1) / 256) *
                        (std::cos(c(k) * (t - 1.0 / 32)) * m[2 * k] - std::sin(c(k) * (t - 1.0 / 32)) * m[2 * k + 1]);
                return std::clamp(sum, 0.0, 1.0);
            }};
}

Formula exponential_formula() {
    return {"esm",
            {},
            [](const Texel& texel) { return std::vector<double>{std::exp(80 * clamped(texel).depth)}; },
            [](const auto& m, double t) { return std::min(1.0, m[0] * std::exp(-80 * t)); }};
}

/// Lauritzen and McCool 2008, with the exponents of the presets; `is_gaussian`: Gumbau et al. 2013.
Formula warped_formula(const std::string& technique, bool has_negative, bool is_gaussian) {
    const auto warps = [](double z) { return std::array{std::exp(40 * (2 * z - 1)), -std::exp(-5 * (2 * z - 1))}; };
    return {technique,
            {},
            [=](const Texel& texel) {
                const auto [w, n] = warps(clamped(texel).depth);
                return has_negative ? std::vector{w, w * w, n, n * n} : std::vector{w, w * w};
            },
            [=](const auto& m, double t) {
                const auto [w, n] = warps(t);
                const double least = 2e-4 * 40 * w, variance = std::max(m[1] - m[0] * m[0], least * least);
                if (is_gaussian) return w <= m[0] ? 1.0 : std::erfc((w - m[0]) / std::sqrt(2 * variance));
                const double bound = chebyshev(m[0], m[1], w, least);
                return has_negative ? std::min(bound, chebyshev(m[2], m[3], n, 2e-4 * 5 * n)) : bound;
            }};
}

/// Of all distributions with four moments b the least share nearer than t (Peters and Klein 2015, algorithm 2).
double hamburger(const std::array<double, 4>& b, double t) {
    const double d22 = b[1] - b[0] * b[0], l = b[2] - b[0] * b[1], d33 = (b[3] - b[1] * b[1]) * d22 - l * l;
    double c3 = (t * t - b[1] - l / d22 * (t - b[0])) * d22 / d33, c2 = (t - b[0]) / d22 - l / d22 * c3;
    const double c1 = 1 - c2 * b[0] - c3 * b[1], p = c2 / c3, root = std::sqrt(std::max(p * p / 4 - c1 / c3, 0.0));
    const double near = -p / 2 - root, far = -p / 2 + root;
    if (far < t) return std::clamp(1 + (near * far - b[0] * (near + far) + b[1]) / ((far - t) * (t - near)), 0.0, 1.0);
    if (near < t) return std::clamp((t * far - b[0] * (t + far) + b[1]) / ((far - near) * (t - near)), 0.0, 1.0);
    return 0;
}

Formula moments_formula() {
    return {"msm128",
            {{"moment-bias", "0.00003"}},
            [](const Texel& texel) {
                const double x = 2 * clamped(texel).depth - 1;
                return std::vector{x, x * x, x * x * x, x * x * x * x};
            },
            [](const auto& m, double t) {
                const double mixed[4] = {0, 0.375, 0, 0.375};
                std::array<double, 4> b;
                for (int i = 0; i < 4; ++i) b[i] = m[i] + min_share * (mixed[i] - m[i]);
                return 1 - hamburger(b, 2 * t - 1);
            }};
}

std::vector<Formula> formulas() {
    std::vector<Formula> all{variance_formula("vsm"),
                             variance_formula("vsm-remap"),
                             variance_formula("vsm-edges"),
                             variance_formula("shadow-map"),
                             layered_formula(4),
                             layered_formula(16),
                             convolution_formula(),
                             exponential_formula(),
                             warped_formula("evsm2", false, false),
                             warped_formula("evsm4", true, false),
                             warped_formula("ewgf", false, true),
                             moments_formula()};
    const auto plain = all[1].visibility;
    all[1].visibility = [plain](const auto& m, double t) { return std::max(0.0, (plain(m, t) - 0.3) / 0.7); };
    all[2].bias = 0.002, all[2].is_for_edges_only = true;
    all[3].is_box = true;
    for (const auto& setting : Settings{{"store", "variance"}, {"prefilter", "summed-area"}, {"filter-width", "5"}})
        all[3].settings.push_back(setting);
    return all;
}

// ---- A point's value ------------------------------------------------------------------------------------------------

/// Weights of seven texels around the point's, along one axis: the bilinear mean of two filtered ones.
std::array<double, 2 * half_window + 1> weights_along(double at, bool is_box) {
    std::array<double, 2 * half_window + 1> weights{};
    const double corner = at - 0.5 - std::floor(at), fraction = corner < 0 ? corner + 1 : corner;
    const int first = corner < 0 ? -1 : 0;  // the nearer one of the two, beside the point's texel
    double all = 0;
    for (int i = -2; i <= 2; ++i) {
        const double weight = is_box ? 1 : std::exp(-0.5 * i * i * 0.81);  // deviation 5 / 4.5
        all += weight;
        weights[i + first + half_window] += weight * (1 - fraction);
        weights[i + first + 1 + half_window] += weight * fraction;
    }
    for (double& weight : weights) weight /= all;
    return weights;
}

/// Nothing where the filter meets a silhouette or the map's border.
std::optional<double> value_of(const Formula& formula, const Map& map, const Double3& point) {
    const SceneBox at = place(map.view, point);
    const double x = at.u * side, y = at.v * side, t = at.depth - formula.bias;
    const int column = int(std::floor(x)), row = int(std::floor(y));
    if (std::min(column, row) <= half_window || std::max(column, row) >= side - 1 - half_window) return {};
    const bool in_shadow = map.shows_plate(at.u, at.v);
    const Plane plane = in_shadow ? map.plate.plane() : Plane{{0, 1, 0}, 0};
    const auto across = weights_along(x, formula.is_box), down = weights_along(y, formula.is_box);
    std::vector<double> means;
    int lit = 0;
    for (int j = -half_window; j <= half_window; ++j)
        for (int i = -half_window; i <= half_window; ++i) {
            if (map.shows_plate((column + i + 0.5) / side, (row + j + 0.5) / side) != in_shadow) return {};
            const Texel texel = texel_of(map, column + i, row + j, plane);
            const double weight = across[i + half_window] * down[j + half_window];
            const std::vector<double> numbers = formula.numbers(texel);
            means.resize(numbers.size());
            for (std::size_t p = 0; p < numbers.size(); ++p) means[p] += weight * numbers[p];
            const bool is_corner =
                (i == int(std::floor(x - 0.5)) - column || i == int(std::floor(x - 0.5)) - column + 1) &&
                (j == int(std::floor(y - 0.5)) - row || j == int(std::floor(y - 0.5)) - row + 1);
            lit += is_corner && clamped(texel).depth >= t;
        }
    if (formula.is_for_edges_only && lit % 4 == 0) return lit == 4 ? 1 : 0;
    return formula.visibility(means, t);
}

/// The view that the points' light fits: the one that the technique uses for the judged ones.
Map fitted_map(const gnomon::Device& device, const gnomon::Triangles& triangles, const gnomon::Points& points,
               const Light& light, const Plate& plate) {
    gnomon::cl::Session& session = session_of(device);
    const auto visibility = uploaded(session, std::vector<float>(points.count(), 1.0f));
    gnomon::ViewFit stage;
    gnomon::MapViews map_views;
    stage.run(
        session,
        {gnomon::triangle_inputs(triangles), gnomon::point_inputs(points), visibility.get(), light, points.camera()},
        side, map_views);
    for (const MapView& view : downloaded<MapView>(session, map_views.views.get(), map_views.set.view_count))
        if (view.width != 0) return {view, plate};
    throw std::runtime_error("no view");
}

struct Judged {
    int in_shadow = 0, in_light = 0;
};

Judged judge(const gnomon::Device& device, const Formula& formula, const Map& map, const Floats& places,
             const gnomon::Triangles& triangles, const gnomon::Points& points, const Light& light) {
    Settings settings = formula.settings;
    settings.emplace_back("size", std::to_string(side));
    const auto technique = technique_with(device, settings, formula.technique);
    const std::vector<float> found = answer(device, *technique, triangles, points, light).visibility;
    Judged judged;
    int wrong = 0;
    double largest = 0;
    for (std::size_t i = 0; i < floor_columns * floor_columns; ++i) {
        const Double3 point = to_double(&places[3 * i]);
        const std::optional<double> value = value_of(formula, map, point);
        if (!value) continue;
        const SceneBox at = place(map.view, point);
        ++(map.shows_plate(at.u, at.v) ? judged.in_shadow : judged.in_light);
        const double error = std::fabs(found[i] - *value);
        if (error > 1e-3 && wrong++ == 0) ADD_FAILURE() << "point " << i << ": " << found[i] << ", must be " << *value;
        largest = std::max(largest, error);
    }
    EXPECT_EQ(wrong, 0) << "of " << judged.in_shadow + judged.in_light << " points; the largest error: " << largest;
    return judged;
}

TEST(Moments, TwoPlanesHaveTheValueOfTheFormula) {
    const gnomon::Device device;
    for (const Light& light : {Light::directional({0.02f, -1, 0.01f}), Light::directional({0.15f, -1, 0.1f}),
                               Light::point({0.7f, 60, 0.4f})})
        for (const double degrees : {0, 30, 80})
            for (const bool is_inside : {false, true}) {
                const Plate plate(degrees);
                const Floats places = points_of(plate, is_inside);
                const auto triangles = gnomon::Triangles::upload(device, floor_and_plate(plate));
                const auto points = gnomon::Points::upload(device, places);
                const Map map = fitted_map(device, triangles, points, light, plate);
                for (const Formula& formula : formulas()) {
                    SCOPED_TRACE(formula.technique + ", " + std::to_string(degrees) + " degrees, " +
                                 (is_inside ? "inside" : "before") + " the range, light " +
                                 std::to_string(light.xyzw[0]) + (light.xyzw[3] != 0 ? " lamp" : " sun"));
                    const Judged judged = judge(device, formula, map, places, triangles, points, light);
                    EXPECT_GT(judged.in_shadow, 30);
                    EXPECT_GT(judged.in_light, 300);
                }
            }
}

// The plate is not in the view, so it lies before the range of depths: all of its texels hold depth 0 without any
// variance, whatever the prefilter. Points a texel of any mip level or more inside its shadow have one value.
TEST(Moments, ABlockerBeforeTheRangeHasNoVariance) {
    const gnomon::Device device;
    std::vector<Formula> all = formulas();
    all.push_back(variance_formula("vsm-mip"));
    all.push_back(moments_formula());
    all.back().technique = "msm64";  // mixes other moments in, 3e-5 of them
    for (const Light& light : {Light::directional({0, -1, 0}), Light::point({0, 60, 0})})
        for (const double degrees : {30, 80}) {
            const Plate plate(degrees);
            const auto triangles = gnomon::Triangles::upload(device, floor_and_plate(plate));
            const auto camera = gnomon::Camera::look_at({0, 1.5f, 9}, {0, 0, 0}, {0, 1, 0}, 20);
            const gnomon::View view = gnomon::look(device, triangles, camera, 96, 64);
            const Map map = fitted_map(device, triangles, view.points, light, plate);
            const gnomon::ViewOnHost host = view.read(device, triangles);
            for (const Formula& formula : all) {
                SCOPED_TRACE(formula.technique + ", " + std::to_string(degrees) + " degrees");
                Settings settings = formula.settings;
                settings.emplace_back("size", std::to_string(side));
                const auto technique = technique_with(device, settings, formula.technique);
                const auto found = answer(device, *technique, triangles, view.points, light).visibility;
                const auto means = formula.numbers({0, 0});
                int judged = 0;
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const float* p = &host.position[3 * i];
                    if (host.receiver[i] > 1 || std::fabs(p[0]) > 2 || std::fabs(p[2]) > 2) continue;
                    const double t = place(map.view, to_double(p)).depth - formula.bias;
                    const double value = formula.is_for_edges_only ? 0 : formula.visibility(means, t);
                    ASSERT_NEAR(found[i], value, 1e-3) << "point " << i;
                    ++judged;
                }
                EXPECT_GT(judged, 400);
            }
        }
}

}  // namespace
