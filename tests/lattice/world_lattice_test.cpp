// SPDX-License-Identifier: MIT
// The world lattice: snapping is floor(x / step + 1/2) in exact arithmetic, what is stored is exact, and a point on a
// surface is lifted above all that snapping can make of that surface.
#include <gtest/gtest.h>

#include <gnomon.hpp>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

namespace {

using gnomon::Float3;
using gnomon::InvalidArgument;
using gnomon::WorldLattice;
using Rational = boost::multiprecision::cpp_rational;
using Integer = boost::multiprecision::cpp_int;

Integer floor_of(const Rational& x) {
    Integer quotient = numerator(x) / denominator(x);
    if (x < 0 && quotient * denominator(x) != numerator(x)) --quotient;
    return quotient;
}

Rational step_of(const WorldLattice& lattice) { return Rational(std::ldexp(1.0, lattice.exponent)); }

TEST(WorldLattice, SnapsAsTheDefinitionSays) {
    std::mt19937_64 random(3);
    for (const int exponent : {-10, -7, 0, 3, -20}) {
        const WorldLattice lattice = WorldLattice::around(std::vector<double>{4.5e6, 6e6, 100}, exponent);
        const double step = std::ldexp(1.0, exponent);
        std::vector<double> positions;
        for (int i = 0; i < 3000; ++i) {
            // Whole steps, exact halves, the neighbours of both, and anything.
            const double base[] = {4.5e6, 6e6, 100};
            const double whole = std::floor(base[i % 3] / step) + double(int(random() % 4000) - 2000);
            double x = (whole + 0.5 * double(random() % 2)) * step;
            const auto kind = random() % 4;
            if (kind == 1) x = std::nextafter(x, -1e300);
            if (kind == 2) x = std::nextafter(x, 1e300);
            if (kind == 3) x += step * std::uniform_real_distribution<double>(-1, 1)(random);
            positions.push_back(x);
        }
        const WorldLattice::Snapped snapped = lattice.snap(positions);
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Integer n = floor_of(Rational(positions[i]) / step_of(lattice) + Rational(0.5));
            const Rational stored = Rational(n - lattice.origin[i % 3]) * step_of(lattice);
            ASSERT_EQ(Rational(double(snapped.positions[i])), stored) << positions[i] << " on steps of 2^" << exponent;
        }
        EXPECT_LE(snapped.largest_move, step / 2);
        EXPECT_GT(snapped.largest_move, step / 4);
    }
}

TEST(WorldLattice, TheLargestDoubleBelowAHalfStays) {
    const WorldLattice lattice{0, {}};
    EXPECT_EQ(lattice.snap(std::vector<double>{0x1.fffffffffffffp-2, 0.5, -0.5}).positions,
              (std::vector<float>{0, 1, 0}));
}

TEST(WorldLattice, TheFinestStepThatFits) {
    // 15 cm, and 20 km at national coordinates.
    const std::vector<double> model{0, 0, 0, 0.15, 0.1, 0.05};
    const WorldLattice small = WorldLattice::fit(model);
    EXPECT_EQ(small.exponent, -26);  // 7.5 cm are 2^22.3 steps of 2^-26, and 2^23.3 of 2^-27
    EXPECT_NO_THROW(small.snap(model));
    const std::vector<double> city{4.49e6, 6e6, 0, 4.51e6, 6.02e6, 400};
    const WorldLattice large = WorldLattice::fit(city);
    EXPECT_EQ(large.exponent, -9);  // 10 km are 2^22.3 steps of 2^-9, and 2^23.3 of 2^-10
    EXPECT_NO_THROW(large.snap(city));
    for (const WorldLattice& lattice : {small, large})
        for (std::size_t c = 0; c < 3; ++c) EXPECT_LT(std::abs(double(lattice.origin[c])), 0x1p46);
    EXPECT_EQ(WorldLattice::fit({}).origin, (std::array<std::int64_t, 3>{}));
}

TEST(WorldLattice, RefusesWhatDoesNotFitAndNamesWhatDoes) {
    const WorldLattice lattice{-10, {}};
    const std::vector<double> far{0, 0, 0, 16384, 0, 0, 16384.001, 0, 0};
    EXPECT_NO_THROW(lattice.snap(std::span(far).first(6)));
    try {
        lattice.snap(far);
        FAIL() << "16.4 km from the origin";
    } catch (const InvalidArgument& error) {
        EXPECT_NE(std::string(error.what()).find("row 2"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("is 2^-9"), std::string::npos)
            << error.what();  // about the same origin
    }
    EXPECT_THROW(lattice.snap(std::vector<double>{1, 2}), InvalidArgument);
    EXPECT_THROW(lattice.snap(std::vector<double>{1e300, 2, 3}), InvalidArgument);
    EXPECT_THROW(WorldLattice::around({}, 101), InvalidArgument);
    EXPECT_THROW(WorldLattice::around(std::vector<double>{1e20, 0, 0}, -10), InvalidArgument);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(lattice.snap(std::vector<double>{nan, 2, 3}).positions[0]));
}

TEST(WorldLattice, RebasingIsExactAndComesBack) {
    const std::vector<double> city{4.5e6, 6e6, 0, 4.5001e6, 6.0003e6, 40.0625};
    const WorldLattice one = WorldLattice::around(city, -10);
    WorldLattice other = one;
    other.origin[0] += 4'000'001;
    other.origin[2] -= 77;
    const std::vector<float> here = one.snap(city).positions;
    EXPECT_EQ(one.rebased(here, other), other.snap(city).positions);
    EXPECT_EQ(other.rebased(one.rebased(here, other), one), here);
    EXPECT_EQ(
        one.world_of({here[3], here[4], here[5]}),
        other.world_of({other.snap(city).positions[3], other.snap(city).positions[4], other.snap(city).positions[5]}));
    other.origin[0] += 1 << 25;
    EXPECT_THROW(one.rebased(here, other), InvalidArgument);
    other.exponent = -9;
    EXPECT_THROW(one.rebased(here, other), InvalidArgument);
}

// A flat surface of random slope, cut into triangles (slivers too) whose corners are snapped; points on it, each off by
// up to sqrt(3)/2 steps, are lifted. Along the surface's normal every point must end strictly higher than every snapped
// corner: then no triangle between these corners meets a ray that leaves on the normal's side. Without the lift it may.
TEST(WorldLattice, LiftedPointsLieAboveTheSnappedSurface) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    const WorldLattice lattice{-10, {4'607'999'001, 6'143'999'003, 102'401}};
    const double step = lattice.step();
    const std::array<double, 3> centre = lattice.world_of({});
    std::size_t checked = 0, below_without_lift = 0;
    for (int plane = 0; plane < 300; ++plane) {
        const std::vector<double> n{unit(random), unit(random), 0.2 + std::abs(unit(random))};
        const double size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const auto on_plane = [&](double reach) {
            const double x = reach * unit(random), y = reach * unit(random);
            return std::vector<double>{centre[0] + x, centre[1] + y, centre[2] - (n[0] * x + n[1] * y) / n[2]};
        };
        const auto height = [&](const std::vector<float>& q) {
            Rational sum = 0;
            for (int c = 0; c < 3; ++c) sum += Rational(n[c]) * Rational(double(q[c]));
            return sum;
        };
        std::vector<Rational> corners;
        for (int k = 0; k < 30; ++k) corners.push_back(height(lattice.snap(on_plane(0.1)).positions));
        const Rational highest = *std::max_element(corners.begin(), corners.end());
        for (int k = 0; k < 20; ++k) {
            std::vector<double> p = on_plane(0.1);
            const double off = 0.86 * step * unit(random);
            for (int c = 0; c < 3; ++c) p[c] += off * n[c] / size;
            ++checked;
            EXPECT_GT(height(lattice.lift(p, n)), highest);
            below_without_lift += height(lattice.snap(p).positions) <= highest;
        }
    }
    EXPECT_GT(checked, 3000u);
    EXPECT_GT(below_without_lift, 1000u);
}

using RationalVector = std::array<Rational, 3>;

RationalVector operator-(const RationalVector& a, const RationalVector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Rational dot(const RationalVector& a, const RationalVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
RationalVector cross(const RationalVector& a, const RationalVector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
RationalVector corner_of(const auto& triangles, std::size_t i) {
    return {Rational(double(triangles[3 * i])), Rational(double(triangles[3 * i + 1])),
            Rational(double(triangles[3 * i + 2]))};
}

/// The squared distance of p from the closed triangle t.
Rational squared_distance(const RationalVector& p, const std::array<RationalVector, 3>& t) {
    const RationalVector n = cross(t[1] - t[0], t[2] - t[0]);
    Rational nearest = dot(p - t[0], p - t[0]);
    bool is_over = true;
    for (int i = 0; i < 3; ++i) {
        const RationalVector from = t[i], along = t[(i + 1) % 3] - t[i], to = p - from;
        is_over &= dot(cross(along, to), n) >= 0;
        Rational at = dot(to, along) / dot(along, along);
        at = at < 0 ? Rational(0) : at > 1 ? Rational(1) : at;
        const RationalVector rest{to[0] - at * along[0], to[1] - at * along[1], to[2] - at * along[2]};
        if (dot(rest, rest) < nearest) nearest = dot(rest, rest);
    }
    return is_over ? Rational(dot(p - t[0], n) * dot(p - t[0], n) / dot(n, n)) : nearest;
}

// Triangulations of one slope that do not fit each other, at national coordinates, and triangles at random beside them.
TEST(WorldLattice, TouchedTrianglesAreThoseWithinAStep) {
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> unit(0, 1);
    const WorldLattice lattice{-10, {4'607'999'001, 6'143'999'003, 102'401}};
    const std::array<double, 3> centre = lattice.world_of({});
    std::vector<double> triangles;
    const auto add = [&](double x, double y, double off) {
        triangles.insert(triangles.end(), {centre[0] + x, centre[1] + y, centre[2] + 0.37 * x + off * lattice.step()});
    };
    const auto add_square = [&](double x, double y, double size, double off) {
        add(x, y, off), add(x + size, y, off), add(x + size, y + size, off);
        add(x, y, off), add(x + size, y + size, off), add(x, y + size, off);
    };
    for (int i = 0; i < 4; ++i) add_square(i, 0, 1, 0);
    for (int i = 0; i < 6; ++i) add_square(i * 0.65, 1, 0.65, 0);     // T-junctions along y = 1
    for (int i = 0; i < 6; ++i) add_square(i * 0.65, -1, 1, i / 3.);  // overlaps, up to two steps higher
    for (int i = 0; i < 10; ++i)
        for (int c = 0; c < 3; ++c) add(4 * unit(random), 2 * unit(random), 1000 * unit(random));
    // A corner each near a sharp tip and over the inside of a triangle, up to two steps away.
    const double s = lattice.step();
    add(6, 0, 0), add(7, 0.05, 0), add(7, -0.05, 0);
    for (int i = 0; i < 60; ++i) {
        const double x = i % 2 == 0 ? 6 - 2 * s * unit(random) : 6.3 + 0.6 * unit(random);
        add(x, (i % 2 == 0 ? 2 * s : 0.02) * (unit(random) - 0.5), i % 2 == 0 ? 0 : 4 * unit(random) - 2);
        add(6 - unit(random), unit(random), 3000), add(6 - unit(random), unit(random), 3000);
    }
    const std::vector<float> snapped = lattice.snap(triangles).positions;
    const std::vector<std::uint32_t> touched = lattice.touched_triangles(triangles);
    ASSERT_EQ(touched.size(), triangles.size() / 3);
    std::size_t found = 0;
    for (std::size_t corner = 0; corner < touched.size(); ++corner) {
        Rational nearest = step_of(lattice) * step_of(lattice);
        bool is_touched = false;
        std::vector<Rational> distance;
        for (std::size_t t = 0; t < triangles.size() / 9; ++t) {
            bool has_it = false;
            for (std::size_t k = 0; k < 3; ++k)
                has_it |= std::equal(&snapped[3 * corner], &snapped[3 * corner] + 3, &snapped[9 * t + 3 * k]);
            const Rational d = squared_distance(
                corner_of(triangles, corner),
                {corner_of(triangles, 3 * t), corner_of(triangles, 3 * t + 1), corner_of(triangles, 3 * t + 2)});
            distance.push_back(has_it ? Rational(1) : d);
            if (!has_it && d <= nearest) nearest = d, is_touched = true;
        }
        ASSERT_EQ(touched[corner] != gnomon::no_receiver, is_touched) << "corner " << corner;
        if (!is_touched) continue;
        ++found;
        EXPECT_LE(double(distance[touched[corner]]), double(nearest) + 1e-6 * std::pow(lattice.step(), 2));
    }
    EXPECT_GT(found, 50u);
    EXPECT_LT(found, touched.size() - 20);
}

TEST(WorldLattice, TheRoofsVertexSnapsUnderItsNeighbour) {
    const WorldLattice lattice{-10, {}};
    const std::vector<double> roof{0, 0,  0, 10,  0, 3.7,   10, 5, 3.7,  // the vertex (3.3, 0, 1.221) lies on its edge
                                   0, -5, 0, 3.3, 0, 1.221, 0,  0, 0};
    EXPECT_EQ(lattice.touched_triangles(roof),
              (std::vector<std::uint32_t>{gnomon::no_receiver, gnomon::no_receiver, gnomon::no_receiver,
                                          gnomon::no_receiver, 0, gnomon::no_receiver}));
    const auto q = lattice.snap(roof).positions;
    const RationalVector a = corner_of(q, 0), n = cross(corner_of(q, 1) - a, corner_of(q, 2) - a);
    const Rational below = dot(corner_of(q, 4) - a, n);
    EXPECT_LT(below, 0);
    EXPECT_NEAR(std::sqrt(double(Rational(below * below / dot(n, n)))) / lattice.step(), 0.27, 0.03);
}

TEST(WorldLattice, ChangedTrianglesAreNamed) {
    using Change = WorldLattice::Change;
    const WorldLattice lattice{-10, {}};
    const double s = lattice.step(), nan = std::nan("");
    const std::vector<double> triangles{
        0, 0, 0, 10,      0,       3, 5.001, .0004,   1.5003,   // becomes vertical
        0, 0, 0, 0.4 * s, 0,       0, 0,     0.4 * s, 0,        // becomes a point
        0, 0, 0, 10 * s,  0.6 * s, 0, 5 * s, 0.4 * s, 0,        // turns over
        0, 0, 0, 1,       0,       0, 0,     1,       0,        // stays
        0, 0, 0, 40 * s,  0,       0, 0,     40 * s,  0.6 * s,  // tilts by half a degree
        0, 0, 0, 1,       1,       1, 2,     2,       2,        // had no area
        0, 0, 0, 1,       0,       0, 0,     nan,     0};
    EXPECT_EQ(lattice.changes(triangles),
              (std::vector<Change>{Change::tilted, Change::zero_area, Change::turned_over, Change::none, Change::none,
                                   Change::none, Change::none}));
    EXPECT_EQ(lattice.changes(triangles, 0.25)[4], Change::tilted);
    EXPECT_THROW(lattice.changes(triangles, 91), InvalidArgument);
    EXPECT_THROW(lattice.changes(triangles, nan), InvalidArgument);
    EXPECT_THROW(lattice.changes(std::vector<double>(10)), InvalidArgument);
    EXPECT_THROW(lattice.touched_triangles(std::vector<double>(10)), InvalidArgument);
    EXPECT_EQ(lattice.touched_triangles(triangles).size(), 21u);
    EXPECT_TRUE(lattice.touched_triangles({}).empty() && lattice.changes({}).empty());
}

TEST(WorldLattice, LiftRefusesNormalsThatAreNone) {
    const WorldLattice lattice{-10, {}};
    const std::vector<double> p{1, 2, 3};
    EXPECT_THROW(lattice.lift(p, std::vector<double>{0, 0, 0}), InvalidArgument);
    EXPECT_THROW(lattice.lift(p, std::vector<double>{0, 0, std::nan("")}), InvalidArgument);
    EXPECT_THROW(lattice.lift(p, {}), InvalidArgument);
    EXPECT_EQ(lattice.lift(p, std::vector<double>{0, 0, 1e200}), lattice.lift(p, std::vector<double>{0, 0, 1e-200}));
}

}  // namespace
