// SPDX-License-Identifier: MIT
// The arithmetic of the scene maker, the same on every machine: + - * / and sqrt in double (IEEE 754 rounds them in
// one way only), a generator of random numbers written out here, and a sine and cosine made from polynomials. The
// sines of C++ libraries differ in the last bit from machine to machine, and so do std::*_distribution.
// Callers must not draw two random numbers in one expression whose order C++ leaves open (function arguments, sums);
// braces are evaluated from left to right.
#pragma once

#include <cmath>
#include <cstdint>

namespace gnomon::make_scenes {

struct Vec3 {
    double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalized(const Vec3& a) { return a * (1 / length(a)); }
/// A unit vector at right angles to the unit vector `a`.
inline Vec3 perpendicular(const Vec3& a) {
    return normalized(a.x * a.x < 0.5 ? cross(a, Vec3{1, 0, 0}) : cross(a, Vec3{0, 1, 0}));
}

struct CosineSine {
    double cosine = 1, sine = 0;
};

/// Cosine and sine of an angle in turns (1 is 360 degrees); exact at multiples of a quarter turn. Below, the Taylor
/// polynomials on [-pi/4, pi/4]: their first missing terms are under 1e-16.
inline CosineSine cosine_sine(double turns) {
    const double quarters = std::floor(turns * 4 + 0.5);
    const double angle = (turns - quarters / 4) * 6.283185307179586476925;
    const double square = angle * angle;
    double cosine = 1, sine = 1;
    for (int k = 8; k >= 1; --k) {
        cosine = 1 - cosine * square / ((2.0 * k - 1) * (2.0 * k));
        sine = 1 - sine * square / ((2.0 * k) * (2.0 * k + 1));
    }
    sine *= angle;
    switch (static_cast<int>(quarters - 4 * std::floor(quarters / 4))) {
        case 0:
            return {cosine, sine};
        case 1:
            return {-sine, cosine};
        case 2:
            return {-cosine, -sine};
        default:
            return {sine, -cosine};
    }
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        state_ += 0x9E3779B97F4A7C15u;
        std::uint64_t bits = state_;
        bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
        bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
        return bits ^ (bits >> 31);
    }
    /// In [0, 1), in steps of 2^-53.
    double unit() { return static_cast<double>(next() >> 11) / 9007199254740992.0; }
    /// In [low, high).
    double between(double low, double high) { return low + (high - low) * unit(); }
    /// One of 0 .. count-1; the first are likelier by at most count / 2^64.
    std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(next() % count); }
    /// Inside the unit ball, evenly.
    Vec3 in_ball() {
        for (;;) {
            const Vec3 candidate{between(-1, 1), between(-1, 1), between(-1, 1)};
            if (dot(candidate, candidate) <= 1) return candidate;
        }
    }
    /// On the unit sphere, evenly.
    Vec3 direction() {
        for (;;) {
            const Vec3 candidate = in_ball();
            if (dot(candidate, candidate) > 0.01) return normalized(candidate);
        }
    }

private:
    std::uint64_t state_;
};

}  // namespace gnomon::make_scenes
