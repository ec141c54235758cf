// SPDX-License-Identifier: MIT
// Inputs for the test of the predicates. See cases.hpp.
#include "cases.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>

namespace predicates {
namespace {

using Vector = std::array<float, 3>;
using Wide3 = std::array<double, 3>;

/// What every predicate is asked about: a triangle, a point, and a light that is a position, or a direction.
struct Configuration {
    Vector a, b, c, p, light;
    bool is_directional = false;
};

Wide3 wide(const Vector& v) { return {v[0], v[1], v[2]}; }

/// from + s (to - from)
Wide3 along(const Wide3& from, const Wide3& to, double s) {
    return {from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1]), from[2] + s * (to[2] - from[2])};
}

float clamped(double x) { return static_cast<float>(std::clamp(x, -double{FLT_MAX}, double{FLT_MAX})); }

Vector rounded(const Wide3& v) { return {clamped(v[0]), clamped(v[1]), clamped(v[2])}; }

/// x moved by `steps` representable numbers, within the finite ones.
float moved(float x, int steps) {
    auto key = std::bit_cast<std::int32_t>(x);
    if (key < 0) key = INT32_MIN - key;
    key = std::clamp(key + steps, -0x7F7FFFFF, 0x7F7FFFFF);
    return std::bit_cast<float>(key < 0 ? INT32_MIN - key : key);
}

void nudge(Random& random, Vector& v) {
    const int reach = 1 << random.below(4);
    for (float& x : v)
        if (random.once_in(2)) x = moved(x, random.below(2 * reach + 1) - reach);
}

template <typename Coordinate>
Configuration filled(Random& random, Coordinate coordinate) {
    Configuration result;
    for (Vector* v : {&result.a, &result.b, &result.c, &result.p, &result.light})
        for (float& x : *v) x = coordinate();
    result.is_directional = random.once_in(2);
    return result;
}

Configuration ordinary(Random& random) {
    const double scale = std::ldexp(1.0, random.below(20) - 8);
    const double offset = random.once_in(4) ? scale * 64 * random.unit() : 0;
    return filled(random, [&] { return static_cast<float>(offset + scale * random.unit()); });
}

/// Puts some of the configuration where a predicate vanishes: exactly there in double, then rounded, then nudged.
void make_degenerate(Random& random, Configuration& k) {
    const Wide3 a = wide(k.a), b = wide(k.b), c = wide(k.c);
    const double s = random.unit(), t = random.unit();
    const Wide3 on_edge = along(a, b, s), in_plane = along(on_edge, c, t);
    // A light seen from p through the place x.
    const auto behind = [&](const Wide3& x) {
        Wide3 light = along(wide(k.p), x, 1 + std::ldexp(1.0, random.below(8) - 4));
        if (k.is_directional)
            for (std::size_t i = 0; i < 3; ++i) light[i] = (x[i] - k.p[i]) * std::ldexp(1.0, random.below(3) - 1);
        return rounded(light);
    };
    switch (random.below(5)) {
        case 0:
            k.p = rounded(in_plane);
            break;
        case 1:
            k.light = behind(on_edge);
            break;
        case 2:
            k.light = behind(random.once_in(2) ? a : c);
            break;
        case 3:
            k.c = rounded(on_edge);
            break;
        default:
            k.light = rounded(k.is_directional ? Wide3{b[0] - a[0], b[1] - a[1], b[2] - a[2]} : in_plane);
    }
    nudge(random, random.once_in(2) ? k.light : k.p);
    if (random.once_in(2)) nudge(random, k.c);
}

Configuration near_degenerate(Random& random) {
    const double scale = std::ldexp(1.0, random.below(20) - 10);
    // Far away, what is left of the coordinates is a coarse lattice.
    const double offset = random.once_in(2) ? 0 : scale * std::ldexp(1.0, random.below(18));
    Configuration k = filled(random, [&] { return static_cast<float>(offset + scale * random.unit()); });
    make_degenerate(random, k);
    return k;
}

Configuration degenerate(Random& random) {
    constexpr int reaches[] = {1, 2, 3, 8, 255, 32767, 4194303};
    const int reach = reaches[random.below(7)];
    const int shift = random.once_in(2) ? 0 : random.below(200) - 120;
    const int offset = random.once_in(3) ? random.below(reach + 1) * 2 : 0;
    const auto lattice = [&] {
        return std::ldexp(static_cast<float>(random.below(2 * reach + 1) - reach + offset), shift);
    };
    Configuration k = filled(random, lattice);
    const auto combine = [&](const Vector& from, const Vector& to, int times) {
        Vector v;
        for (std::size_t i = 0; i < 3; ++i)  // exact for all but the largest lattice
            v[i] = clamped(from[i] + times * (double{to[i]} - from[i]));
        return v;
    };
    switch (random.below(8)) {
        case 0:
            k.p = combine(combine(k.a, k.b, random.below(5) - 2), k.c, random.below(5) - 2);
            break;
        case 1:
            k.c = combine(k.a, k.b, random.below(7) - 3);
            break;
        case 2:  // through a vertex or an edge's lattice point, exactly
            k.light = combine(k.p, random.once_in(2) ? k.a : combine(k.a, k.b, 2), random.below(3) + 1);
            if (k.is_directional)
                for (std::size_t i = 0; i < 3; ++i) k.light[i] = k.a[i] - k.p[i];
            break;
        case 3:
            (random.once_in(2) ? k.b : k.p) = k.a;
            break;
        case 4:
            k.c = k.b = k.a;
            break;
        case 5:  // an axis-aligned rectangle's half, and an axis-aligned light
            k.b = k.c = k.a;
            k.b[0] += std::ldexp(1.0f, shift), k.c[2] -= std::ldexp(2.0f, shift);
            k.light = {0, 0, 0};
            k.light[static_cast<std::size_t>(random.below(3))] = std::ldexp(random.once_in(2) ? 1.0f : -1.0f, shift);
            break;
        case 6:
            (random.once_in(2) ? k.p : k.light) = {0.0f, -0.0f, 0.0f};
            break;
        default:
            break;
    }
    return k;
}

float finite_bits(Random& random) {
    for (;;) {
        const float x = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        if (std::isfinite(x)) return x;
    }
}

float from_palette(Random& random) {
    constexpr float palette[] = {0.0f, -0.0f, 0x1p-149f, 0x1.fffffcp-127f, 0x1p-126f, 1e-38f,   1e-20f,
                                 1.0f, 1e20f, 1e38f,     FLT_MAX,          0x1p127f,  0x1p-64f, 0x1p63f};
    const float x = palette[random.below(14)];
    const float y = random.once_in(3) ? moved(x, random.below(5) - 2) : x;
    return random.once_in(2) ? y : -y;
}

Configuration extreme(Random& random) {
    switch (random.below(7)) {
        case 0:
            return filled(random, [&] { return finite_bits(random); });
        case 1:
            return filled(random, [&] { return std::ldexp(static_cast<float>(random.below(17) - 8), -149); });
        case 2:
            return filled(random, [&] { return static_cast<float>(random.unit() * 0x1p-126); });
        case 3:
            return filled(random, [&] { return clamped(random.unit() * 3.5e38); });
        case 4:
            return filled(random, [&] { return from_palette(random); });
        default: {  // near a tie, moved to an end of the range, where rounding to denormals or to the largest moves it
                    // on
            Configuration k = random.once_in(2) ? near_degenerate(random) : degenerate(random);
            const int shift = random.once_in(2) ? -100 - random.below(50) : 90 + random.below(39);
            for (Vector* v : {&k.a, &k.b, &k.c, &k.p, &k.light}) {
                const int own = random.once_in(4) ? random.below(9) - 4 : 0;
                for (float& x : *v) x = clamped(std::ldexp(double{x}, shift + own));
            }
            if (random.once_in(2)) make_degenerate(random, k);
            return k;
        }
    }
}

Configuration configuration(Class which, Random& random) {
    switch (which) {
        case Class::ordinary:
            return ordinary(random);
        case Class::near_degenerate:
            return near_degenerate(random);
        case Class::degenerate:
            return degenerate(random);
        default:
            return extreme(random);
    }
}

Random random_for(Class which, std::uint64_t seed, std::uint64_t number) {
    Random mixer(seed * 4 + static_cast<std::uint64_t>(which));
    return Random(mixer() ^ (number * 0xD1342543DE82EF95ull));
}

Det3Case rows(const Vector& u1, const Vector& u0, const Vector& v1, const Vector& v0, const Vector& w1,
              const Vector& w0) {
    Det3Case numbers;
    std::size_t i = 0;
    for (const Vector* v : {&u1, &u0, &v1, &v0, &w1, &w0})
        for (const float x : *v) numbers[i++] = x;
    return numbers;
}

/// Three vectors of 48 bits, each the difference of two floats, the third nearly in the plane of the other two: the
/// double filter's own difficult cases.
Det3Case long_vectors(Random& random) {
    std::array<Wide3, 3> v;
    for (std::size_t k = 0; k < 2; ++k)
        for (double& x : v[k]) x = random.unit();
    const double s = random.unit(), t = random.unit();
    for (std::size_t i = 0; i < 3; ++i) v[2][i] = s * v[0][i] + t * v[1][i];
    std::array<Vector, 6> ends;
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i) {
            ends[2 * k][i] = static_cast<float>(v[k][i]);
            ends[2 * k + 1][i] = static_cast<float>(ends[2 * k][i] - v[k][i]);
        }
    if (random.once_in(2)) nudge(random, ends[5]);
    if (random.once_in(2)) {
        // Exactly in the plane but for something far below a double's last bit.
        const int s_times = random.below(9) - 4, t_times = random.below(9) - 4;
        for (std::size_t k = 0; k < 4; ++k)
            for (float& x : ends[k]) x = k % 2 == 0 ? static_cast<float>(random.below(65536) - 32768) : 0.0f;
        for (std::size_t i = 0; i < 3; ++i) {
            ends[4][i] = static_cast<float>(s_times) * ends[0][i] + static_cast<float>(t_times) * ends[2][i];
            ends[5][i] = static_cast<float>(std::ldexp(random.unit(), -20 - random.below(100)));
        }
    }
    return rows(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5]);
}

/// Three rows of very unlike sizes whose product is not unusual: what underflows on the way shows in the end.
Det3Case unlike_rows(Random& random, Det3Case numbers) {
    const int first = random.below(220) - 110, second = random.below(220) - 110;
    const int third = random.below(60) - 40 - first - second;
    std::array shifts{first, second, third};
    std::shuffle(shifts.begin(), shifts.end(), random);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = clamped(std::ldexp(double{numbers[i]}, shifts[i / 6]));
    return numbers;
}

}  // namespace

const char* name_of(Class which) {
    switch (which) {
        case Class::ordinary:
            return "ordinary";
        case Class::near_degenerate:
            return "near-degenerate";
        case Class::degenerate:
            return "exactly degenerate";
        default:
            return "extreme";
    }
}

Det3Case det3_case(Class which, std::uint64_t seed, std::uint64_t number) {
    Random random = random_for(which, seed, number);
    if (which == Class::near_degenerate && random.once_in(6)) return long_vectors(random);
    if (which == Class::extreme && random.once_in(4))
        return unlike_rows(random, det3_case(Class::near_degenerate, seed, number));
    const Configuration k = configuration(which, random);
    const Vector start = k.is_directional ? Vector{} : k.p;
    switch (random.below(5)) {
        case 0:  // which side of the plane the point is on
            return rows(k.b, k.a, k.c, k.a, k.a, k.p);
        case 1:  // which side of an edge the light passes
            return rows(k.a, k.p, k.b, k.p, k.light, start);
        case 2:
            return rows(k.c, k.p, k.a, k.p, k.light, start);
        case 3:  // which side of the plane the light is on
            return rows(k.b, k.a, k.c, k.a, k.light, k.is_directional ? Vector{} : k.a);
        default:  // six vectors without a relation
            return rows(k.a, k.b, k.c, k.p, k.light, rounded(along(wide(k.a), wide(k.c), random.unit())));
    }
}

BlocksCase blocks_case(Class which, std::uint64_t seed, std::uint64_t number) {
    Random random = random_for(which, seed, number);
    const Configuration k = configuration(which, random);
    BlocksCase numbers{};
    std::size_t i = 0;
    for (const Vector* v : {&k.a, &k.b, &k.c, &k.p, &k.light})
        for (const float x : *v) numbers[i++] = x;
    numbers[15] = k.is_directional ? 0.0f : 1.0f;
    return numbers;
}

}  // namespace predicates
