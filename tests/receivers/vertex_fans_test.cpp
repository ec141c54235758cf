// SPDX-License-Identifier: MIT
// Facing at the vertices of a mesh. The judges are rational numbers and other definitions than the kernel's: a path to
// some triangle of the fan, of which the first crossing decides; and the height of a height field's surface.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "receivers/backfacing.hpp"
#include "support/device.hpp"

namespace {

using namespace support;
using gnomon::Float3;
using Rational = boost::multiprecision::cpp_rational;
using Vector = std::array<Rational, 3>;

constexpr float KEPT = 0.5f;  ///< no technique's answer, so a value that the pass must not touch is seen

Vector exact(const Float3& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector sum(const Rational& k, const Vector& a, const Rational& l, const Vector& b) {
    return {k * a[0] + l * b[0], k * a[1] + l * b[1], k * a[2] + l * b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The directions from a vertex over one triangle: k a + l b, k, l >= 0.
struct Sector {
    Vector a, b, n;
    bool is_flat() const { return dot(n, n) != 0; }
    /// k and l of d, which lies in the plane.
    std::array<Rational, 2> weights(const Vector& d) const {
        return {dot(cross(d, b), n) / dot(n, n), dot(cross(a, d), n) / dot(n, n)};
    }
    bool has(const Vector& d) const {
        if (!is_flat() || dot(n, d) != 0) return false;
        const auto [k, l] = weights(d);
        return k >= 0 && l >= 0;
    }
};
using Fan = std::vector<Sector>;

bool lies_in_surface(const Fan& fan, const Vector& d) {
    return std::any_of(fan.begin(), fan.end(), [&](const Sector& s) { return s.has(d); });
}

/// d is strictly in front of a fan that closes around its vertex and does not cross itself: the first sector on the
/// straight path to a point inside of some sector is met from its front. Another path is tried if this one meets an
/// edge.
bool is_in_front_of_closed(const Fan& fan, const Vector& d, std::mt19937& random) {
    if (lies_in_surface(fan, d)) return false;
    for (;;) {
        const Sector& target = fan[random() % fan.size()];
        const Vector end = sum(1 + random() % 1000, target.a, 1 + random() % 1000, target.b);
        Rational first = 2;
        bool is_front = false, is_clear = true;
        for (const Sector& s : fan) {
            const Rational at_start = dot(s.n, d), at_end = dot(s.n, end);
            if (at_start == at_end) {
                is_clear &= at_start != 0;
                continue;
            }
            const Rational t = at_start / (at_start - at_end);
            if (t < 0 || t > 1) continue;
            const auto [k, l] = s.weights(sum(1 - t, d, t, end));
            if (k < 0 || l < 0) continue;
            is_clear &= k != 0 && l != 0 && t != first;
            if (t < first) first = t, is_front = at_start > 0;
        }
        if (is_clear && first <= 1) return is_front;
    }
}

/// d is strictly above a height field over z = 0: where it leaves over none of its triangles, above all their planes.
bool is_above_height_field(const Fan& fan, const Vector& d, bool* is_extended) {
    bool is_above = true, is_above_planes = true, is_over = false;
    for (const Sector& s : fan) {
        const Rational area = s.a[0] * s.b[1] - s.a[1] * s.b[0];
        // d = k a + l b in x and y; the plane's height there is k a.z + l b.z.
        const Rational k = (d[0] * s.b[1] - d[1] * s.b[0]) / area, l = (s.a[0] * d[1] - s.a[1] * d[0]) / area;
        const bool is_higher = d[2] > k * s.a[2] + l * s.b[2];
        is_above_planes &= is_higher;
        if (k < 0 || l < 0) continue;
        is_over = true;
        is_above &= is_higher;
    }
    *is_extended = !is_over;
    return is_over ? is_above : is_above_planes;
}

/// Fans of a mesh, each around a point of its own; triangles of all are shuffled, their corners turned.
struct Meshes {
    std::mt19937 random{11};
    std::vector<std::array<Float3, 3>> triangles;
    std::vector<float> points;
    std::vector<Fan> fans;

    float small(int range) { return float(int(random() % (2 * range + 1)) - range); }

    /// The ring around a point at small integers; `gap` sectors are left out at its end.
    void add(const std::vector<Float3>& ring, std::size_t gap, bool is_turned_over = false) {
        const std::size_t id = fans.size();  // far from other fans, whose triangles must not meet this point
        const Float3 p{10 * (float(id % 7) - 3), 10 * (float(id / 7 % 7) - 3), 10 * (float(id / 49) - 3)};
        Fan fan;
        for (std::size_t i = 0; i + gap < ring.size(); ++i) {
            Float3 a = ring[i], b = ring[(i + 1) % ring.size()];
            if (is_turned_over) std::swap(a, b);
            fan.push_back({exact(a), exact(b), cross(exact(a), exact(b))});
            std::array<Float3, 3> t{p, a, b};
            for (int c = 0; c < 3; ++c) t[1][c] += p[c], t[2][c] += p[c];
            std::rotate(t.begin(), t.begin() + random() % 3, t.end());
            triangles.push_back(t);
        }
        points.insert(points.end(), p.begin(), p.end());
        fans.push_back(fan);
    }
    std::vector<float> vertices() {
        std::shuffle(triangles.begin(), triangles.end(), random);
        std::vector<float> all;
        for (const auto& t : triangles)
            for (const Float3& v : t) all.insert(all.end(), v.begin(), v.end());
        return all;
    }
    /// A ring that turns once around z, counter-clockwise from above, at small integers: some edges are opposite, some
    /// neighbouring sectors coplanar.
    std::vector<Float3> star() {
        static const std::vector<Float3> around{
            {2, 0, 0},  {2, 1, 0},   {1, 1, 0},   {1, 2, 0},   {0, 2, 0},  {-1, 2, 0}, {-1, 1, 0}, {-2, 1, 0},
            {-2, 0, 0}, {-2, -1, 0}, {-1, -1, 0}, {-1, -2, 0}, {0, -2, 0}, {1, -2, 0}, {1, -1, 0}, {2, -1, 0}};
        std::vector<Float3> ring;
        const std::size_t stride = 1 + random() % 4, first = random() % 2;
        for (std::size_t i = first; i < around.size(); i += stride) {
            ring.push_back(around[i]);
            ring.back()[2] = small(1 + int(random() % 3));
        }
        return ring;
    }
};

Float3 turned(const Float3& v, int how) {
    const Float3 moved{v[how % 3], v[(how + 1) % 3], v[(how + 2) % 3]};
    return how < 3 ? moved : Float3{-moved[0], -moved[1], moved[2]};
}

std::vector<gnomon::Light> small_lights(Meshes& meshes, int directional, int positional) {
    std::vector<gnomon::Light> lights;
    while (directional > 0) {
        const Float3 d{meshes.small(3), meshes.small(3), meshes.small(3)};
        if (d == Float3{}) continue;
        lights.push_back(gnomon::Light::directional(d));
        --directional;
    }
    for (; positional > 0; --positional)
        lights.push_back(gnomon::Light::point({meshes.small(44), meshes.small(44), meshes.small(44)}));
    return lights;
}

Vector towards(const gnomon::Light& light, const float* point) {
    const Vector l = exact({light.xyzw[0], light.xyzw[1], light.xyzw[2]});
    return light.is_directional() ? l : minus(l, exact({point[0], point[1], point[2]}));
}

class VertexFans : public testing::Test {
protected:
    gnomon::Device device = device_with();

    /// The values after the pass; all were KEPT before.
    std::vector<float> faced(const std::vector<float>& vertices, const gnomon::VertexFans& fans,
                             const gnomon::Light& light, const std::optional<Float3>& up = {}) {
        const gnomon::Visibility visibility(device, fans.count() + 1);
        const std::vector<float> values(visibility.count(), KEPT);
        session_of(device).write(visibility.buffer(), values.data(), values.size() * sizeof(float));
        const auto triangles = gnomon::Triangles::upload(device, vertices);
        const auto points = gnomon::Points::upload(device, std::vector<float>(3 * fans.count()));
        const auto sides = facing_inputs(device, triangles, points, gnomon::Facing::fans(fans, up));
        darken_backfacing(device, triangles, points, sides, light, visibility);
        std::vector<float> after = visibility.read();
        EXPECT_EQ(after.back(), KEPT) << "the pass wrote behind its points";
        after.pop_back();
        return after;
    }
};

TEST_F(VertexFans, ClosedFansOfAnyMeshEqualTheFirstCrossing) {
    Meshes meshes;
    for (int i = 0; i < 240; ++i) {
        std::vector<Float3> ring = meshes.star();
        for (Float3& v : ring) v = turned(v, i % 6);
        meshes.add(ring, 0, i % 2 == 1);
    }
    // Bands like the letter C around an axis, wider than a half-space: no direction sees all triangles from one side.
    for (int i = 0; i < 30; ++i) {
        std::vector<Float3> ring;
        const float low = -1 - meshes.small(1) / 2, high = 4;
        for (const auto& [x, y] : std::array<std::array<float, 2>, 5>{{{3, 0}, {0, 3}, {-3, 0}, {0, -3}, {2, -3}}})
            ring.push_back({x, y, low});
        for (const auto& [x, y] : std::array<std::array<float, 2>, 5>{{{2, -3}, {0, -3}, {-3, 0}, {0, 3}, {3, 0}}})
            ring.push_back({x, y, high});
        for (Float3& v : ring) v = turned(v, i % 6);
        meshes.add(ring, 0, i % 2 == 1);
    }
    const std::vector<float> vertices = meshes.vertices();
    const auto fans = gnomon::VertexFans::find(device, vertices, meshes.points);
    EXPECT_TRUE(fans.open().empty() && fans.alone().empty());
    std::size_t front = 0, in_surface = 0, mixed = 0;
    for (const gnomon::Light& light : small_lights(meshes, 60, 12)) {
        const std::vector<float> after = faced(vertices, fans, light);
        EXPECT_EQ(fans.extended(), 0u);
        for (std::size_t i = 0; i < fans.count(); ++i) {
            const Vector d = towards(light, &meshes.points[3 * i]);
            if (dot(d, d) == 0) continue;
            const bool expected = is_in_front_of_closed(meshes.fans[i], d, meshes.random);
            ASSERT_EQ(after[i], expected ? KEPT : 0.0f)
                << "fan " << i << ", light " << light.xyzw[0] << ' ' << light.xyzw[1] << ' ' << light.xyzw[2];
            front += expected;
            in_surface += lies_in_surface(meshes.fans[i], d);
            mixed += expected && std::any_of(meshes.fans[i].begin(), meshes.fans[i].end(),
                                             [&](const Sector& s) { return dot(s.n, d) <= 0; });
        }
    }
    EXPECT_GT(front, 3000u);
    EXPECT_GT(in_surface, 500u) << "no light lies in a surface";
    EXPECT_GT(mixed, 1000u) << "the signs of the planes alone would do";
}

TEST_F(VertexFans, HeightFieldsEqualTheHeightOfTheSurface) {
    Meshes meshes;
    for (int i = 0; i < 300; ++i) meshes.add(meshes.star(), i % 3 == 0 ? 0 : i % 3, i % 2 == 1);
    const std::vector<float> vertices = meshes.vertices();
    const auto fans = gnomon::VertexFans::find(device, vertices, meshes.points);
    std::size_t front = 0, used = 0;
    for (const gnomon::Light& light : small_lights(meshes, 60, 12)) {
        const std::vector<float> after = faced(vertices, fans, light, Float3{0, 0, 0.5f});
        std::size_t extended = 0;
        for (std::size_t i = 0; i < fans.count(); ++i) {
            const Vector d = towards(light, &meshes.points[3 * i]);
            bool is_extended = false;
            const bool expected = is_above_height_field(meshes.fans[i], d, &is_extended);
            ASSERT_EQ(after[i], expected ? KEPT : 0.0f)
                << "fan " << i << ", light " << light.xyzw[0] << ' ' << light.xyzw[1] << ' ' << light.xyzw[2];
            front += expected;
            extended += is_extended;
        }
        EXPECT_EQ(fans.extended(), extended);
        used += extended;
    }
    EXPECT_GT(front, 3000u);
    EXPECT_GT(used, 1000u);
}

TEST_F(VertexFans, OpenFansNeedTheLightInFrontOfAllPlanes) {
    Meshes meshes;
    for (int i = 0; i < 100; ++i) meshes.add(meshes.star(), 1 + i % 2);
    const std::vector<float> vertices = meshes.vertices();
    const auto fans = gnomon::VertexFans::find(device, vertices, meshes.points);
    EXPECT_EQ(fans.open().size(), fans.count());
    for (const gnomon::Light& light : small_lights(meshes, 40, 4)) {
        const std::vector<float> after = faced(vertices, fans, light);
        for (std::size_t i = 0; i < fans.count(); ++i) {
            const Vector d = towards(light, &meshes.points[3 * i]);
            const Fan& fan = meshes.fans[i];
            const bool expected = std::all_of(fan.begin(), fan.end(), [&](const Sector& s) { return dot(s.n, d) > 0; });
            ASSERT_EQ(after[i], expected ? KEPT : 0.0f) << "fan " << i;
        }
    }
}

TEST(VertexFansSigns, TheSumOfTwoDeterminantsIsSignedExactly) {
    // Per case u, v, a and b, each an end and a start. The second sum cancels the first up to the last bits, or wholly.
    std::mt19937 random(5);
    std::vector<float> vectors;
    constexpr std::size_t count = 4000;
    for (std::size_t i = 0; i < count; ++i) {
        const float scales[] = {1, 0x1p-60f, 0x1p30f, 0x1p-10f};
        const auto value = [&] {
            return std::ldexp(float(int(random() % 0x1000000) - 0x800000), int(random() % 30) - 30) * scales[i / 8 % 4];
        };
        std::array<float, 24> c{};
        for (int k = 0; k < 18; ++k) c[k] = value();
        for (int k = 0; k < 3; ++k) c[18 + k] = c[15 + k], c[21 + k] = c[12 + k];  // b = -a
        if (i % 3 != 0) c[18 + i % 3] = std::nextafter(c[18 + i % 3], i % 2 == 0 ? 1e30f : -1e30f);
        if (i % 5 == 0) std::copy_n(c.begin(), 3, c.begin() + 6);  // u and v share an end
        if (i % 2 == 0) {
            // b = -a + k u + l v - start, so the sum is that of u, v and -start, and both determinants are large.
            c.fill(0);
            const auto small = [&] { return float(int(random() % 4096) - 2048); };
            const float k = small() / 16, l = small() / 16, tiny = std::ldexp(1.0f, -int(random() % 30));
            for (int n = 0; n < 3; ++n) {
                c[n] = small(), c[6 + n] = small(), c[12 + n] = small();
                c[18 + n] = k * c[n] + l * c[6 + n] - c[12 + n];
                if (i % 8 != 0) c[21 + n] = tiny * small();
            }
        }
        if (i % 4 ==
            1) {  // The same with more digits, and a start about as small as the roundings of double precision.
            c.fill(0);
            const auto long_value = [&] { return float(int(random() % 0x400000) - 0x200000); };
            const float k = float(random() % 3) - 1, l = float(random() % 3) - 1;
            const float tiny = std::ldexp(1.0f, -20 - int(random() % 30));
            for (int n = 0; n < 3; ++n) {
                c[n] = long_value(), c[6 + n] = long_value(), c[12 + n] = long_value();
                c[18 + n] = k * c[n] + l * c[6 + n] - c[12 + n];
                c[21 + n] = tiny * long_value();
            }
        }
        vectors.insert(vectors.end(), c.begin(), c.end());
    }
    for (const bool hide_fp64 : {false, true}) {
        const gnomon::Device device({}, {.hide_fp64 = hide_fp64});
        gnomon::cl::Session& session = session_of(device);
        session.add_source("vertex_fans_test.cl", R"(
#include "receivers/backfacing.cl"
static Arrow arrow_at(__global const float* v) { return (Arrow){(float3)(v[0], v[1], v[2]), (float3)(v[3], v[4], v[5])}; }
__kernel void sign_sums(uint count, __global const float* vectors, __global int* signs) {
    GN_FOR_EACH(i, count) {
        __global const float* v = vectors + 24 * i;
        signs[i] = det_pair_sign(arrow_at(v), arrow_at(v + 6), (Sector){arrow_at(v + 12), arrow_at(v + 18)});
    }
})");
        const gnomon::cl::Buffer signs(session, count * sizeof(int));
        session.launch("vertex_fans_test.cl", "sign_sums", gnomon::cl::Range::items(count), cl_uint(count),
                       uploaded(session, vectors), signs);
        const std::vector<int> found = downloaded<int>(session, signs.get(), count);
        std::size_t zeros = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto arrow = [&](int k) {
                const float* v = &vectors[24 * i + 6 * k];
                return minus(exact({v[0], v[1], v[2]}), exact({v[3], v[4], v[5]}));
            };
            const Rational value = dot(cross(arrow(0), arrow(1)), sum(1, arrow(2), 1, arrow(3)));
            ASSERT_EQ(found[i], value.sign()) << "case " << i;
            zeros += value == 0;
        }
        EXPECT_GT(zeros, count / 8);
        EXPECT_LT(zeros, count / 2);
    }
}

TEST_F(VertexFans, BigAndTinyCoordinatesAreDecidedByIntegers) {
    // The pit of a pyramid turned upside down, far from zero; lights within an ulp of its faces' planes.
    const float p = 0x1p22f, h = 0x1p-20f;
    const std::vector<Float3> ring{{1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}};
    for (const float scale : {1.0f, h}) {
        const float at = scale == 1.0f ? p : 0;
        std::vector<float> vertices;
        for (int i = 0; i < 4; ++i)
            for (const Float3& v : {Float3{}, ring[i], ring[(i + 1) % 4]})
                for (const float c : v) vertices.push_back(at + scale * c);
        const auto fans = gnomon::VertexFans::find(device, vertices, std::vector<float>{at, at, at});
        // Above the pit is where z > |x| + |y|.
        for (const float x : {0.25f, 0.5f, 0x1.000002p-1f, -0.5f})
            for (const float z : {0.75f, std::nextafter(0.75f, 0.0f), std::nextafter(0.75f, 1.0f), 1.0f}) {
                const float y = 0.25f;
                const bool is_above = double(z) > std::abs(double(x)) + y;
                const auto light = gnomon::Light::directional({-x, -y, -z});
                EXPECT_EQ(faced(vertices, fans, light)[0], is_above ? KEPT : 0.0f) << x << ' ' << z;
                EXPECT_EQ(faced(vertices, fans, light, Float3{0, 0, 1})[0], is_above ? KEPT : 0.0f) << x << ' ' << z;
            }
    }
}

TEST_F(VertexFans, SpecialPointsAndTriangles) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    // A triangle in z = 0, one without area, a vertical one, one that is not finite.
    const std::vector<float> vertices{0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 6, 6, 6, 7, 7,   7,
                                      9, 9, 0, 9, 9, 1, 9, 8, 0, 0, 0, 0, 1, 0, 0, 0, nan, 0};
    // On the first triangle, by -0 too; at the triangle without area; at the vertical one; at no vertex; absent.
    const std::vector<float> points{0, 0, 0, -0.0f, 0, 0, 5, 5, 5, 9, 9, 0, 3, 3, 3, nan, 0, 0};
    const auto fans = gnomon::VertexFans::find(device, vertices, points);
    EXPECT_EQ(fans.count(), 6u);
    EXPECT_EQ(fans.alone(), (std::vector<std::uint32_t>{4, 5}));
    EXPECT_EQ(fans.open(), (std::vector<std::uint32_t>{0, 1, 2, 3}));
    const auto from_above = gnomon::Light::directional({0, 0, -1}), from_below = gnomon::Light::directional({0, 0, 1});
    const Float3 up{0, 0, 1};
    EXPECT_EQ(faced(vertices, fans, from_above, up), (std::vector<float>{KEPT, KEPT, KEPT, 0, KEPT, KEPT}))
        << "the light lies in the vertical triangle, and above the first";
    EXPECT_EQ(fans.extended(), 1u) << "the triangle without area";
    EXPECT_EQ(faced(vertices, fans, from_below, up), (std::vector<float>{0, 0, KEPT, KEPT, KEPT, KEPT}));
    EXPECT_EQ(faced(vertices, fans, from_below), (std::vector<float>{0, 0, KEPT, 0, KEPT, KEPT}));
    EXPECT_EQ(faced(vertices, fans, gnomon::Light::point({0, 0, 0}))[0], 0.0f) << "a light at the point";

    EXPECT_THROW(gnomon::VertexFans::find(device, std::vector<float>(8), points), gnomon::InvalidArgument);
    EXPECT_THROW(gnomon::VertexFans::find(device, vertices, std::vector<float>(8)), gnomon::InvalidArgument);
    EXPECT_THROW(faced(vertices, fans, from_above, Float3{}), gnomon::InvalidArgument);
    EXPECT_THROW(faced(vertices, fans, from_above, Float3{0, nan, 0}), gnomon::InvalidArgument);
    EXPECT_THROW(faced(std::vector<float>(9), fans, from_above), gnomon::InvalidArgument);
    const auto fewer_points = gnomon::Points::upload(device, std::vector<float>(15));
    EXPECT_THROW(gnomon::make_technique("frustum-traced", device)
                     ->run(gnomon::Triangles::upload(device, vertices), fewer_points, from_above,
                           gnomon::Visibility(device, 5), {.facing = gnomon::Facing::fans(fans)}),
                 gnomon::InvalidArgument);
    EXPECT_EQ(gnomon::VertexFans::find(device, {}, {}).count(), 0u);
}

}  // namespace
