// SPDX-License-Identifier: MIT
// See masks.hpp. X = o + t r from the plane; its barycentric coordinates are n . ((c - b) x (X - b)) / n . n and so on.
#include "masks.hpp"

#include <boost/multiprecision/gmp.hpp>
#include <cmath>

namespace reference {
namespace {

// GMP's, since a rational is reduced at each step: Boost's own take ten times as long.
using Rational = boost::multiprecision::mpq_rational;
using Whole = boost::multiprecision::mpz_int;
using Point = std::array<Rational, 3>;

Rational exact(float x) { return Rational(x); }
Point exact(const Float3& v) { return {exact(v[0]), exact(v[1]), exact(v[2])}; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point crossed(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational inner(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Whole floor_of(const Rational& x) {
    const Whole top = numerator(x), bottom = denominator(x);
    Whole quotient = top / bottom;
    if (top < 0 && quotient * bottom != top) --quotient;
    return quotient;
}

Point direction_of(const Ray& ray) {
    if (ray.towards == Ray::Towards::pixel)
        return {Rational(ray.pixel[0]), Rational(ray.pixel[1]), Rational(ray.pixel[2])};
    const Point light = exact(ray.light);
    return ray.towards == Ray::Towards::direction ? light : minus(light, exact(ray.origin));
}

/// The barycentric coordinates of the point where the ray meets the triangle's plane.
Point weights_at_hit(const Triangle& triangle, const Ray& ray) {
    const Point a = exact(triangle[0]), b = exact(triangle[1]), c = exact(triangle[2]);
    const Point o = exact(ray.origin), r = direction_of(ray), n = crossed(minus(b, a), minus(c, a));
    const Rational t = inner(n, minus(a, o)) / inner(n, r);
    const Point x{o[0] + t * r[0], o[1] + t * r[1], o[2] + t * r[2]};
    const Rational all = inner(n, n);
    return {inner(n, crossed(minus(c, b), minus(x, b))) / all, inner(n, crossed(minus(a, c), minus(x, c))) / all,
            inner(n, crossed(minus(b, a), minus(x, a))) / all};
}

std::uint32_t wrapped(const Whole& texel, std::uint32_t side, MaskWrap wrap) {
    if (wrap == MaskWrap::clamp) return texel < 0 ? 0 : texel >= side ? side - 1 : std::uint32_t(texel);
    const std::uint32_t period = wrap == MaskWrap::mirror ? 2 * side : side;
    Whole rest = texel % period;
    if (rest < 0) rest += period;
    const auto at = std::uint32_t(rest);
    return at < side ? at : 2 * side - 1 - at;
}

class Sampler {
public:
    Sampler(const MaskMaterial& material, const MaskTexture& texture) : material_(material), texture_(texture) {}

    Rational nearest(const Rational& x, const Rational& y) const {
        std::uint8_t most = 0;
        for (const Whole& j : squares_with(y))
            for (const Whole& i : squares_with(x)) most = std::max(most, texel(i, j));
        return most;
    }

    Rational linear(const Rational& x, const Rational& y) const {
        const Rational s = x - Rational(1, 2), t = y - Rational(1, 2);
        const Whole i = floor_of(s), j = floor_of(t);
        const Rational f = s - Rational(i), g = t - Rational(j);
        return (1 - g) * ((1 - f) * texel(i, j) + f * texel(i + 1, j)) +
               g * ((1 - f) * texel(i, j + 1) + f * texel(i + 1, j + 1));
    }

private:
    static std::vector<Whole> squares_with(const Rational& x) {
        const Whole i = floor_of(x);
        if (Rational(i) == x) return {i - 1, i};
        return {i};
    }

    std::uint8_t texel(const Whole& i, const Whole& j) const {
        return texture_.alpha[std::size_t(wrapped(j, texture_.height, material_.wrap_v)) * texture_.width +
                              wrapped(i, texture_.width, material_.wrap_u)];
    }

    const MaskMaterial& material_;
    const MaskTexture& texture_;
};

}  // namespace

bool Masks::is_opaque(std::uint32_t id, const Triangle& triangle, const Ray& ray) const {
    if (material[id] == NO_MATERIAL) return true;
    const MaskMaterial& of = materials[material[id]];
    if (of.cutoff <= 0) return true;
    if (of.cutoff > 1 || of.factor <= 0) return false;
    const Rational threshold = Rational(std::nearbyint(255.0 * of.cutoff / of.factor * 65536.0)) / 65536;
    const Point weights = weights_at_hit(triangle, ray);
    const auto at_hit = [&](const float* corners, int step) -> Rational {
        return weights[0] * exact(corners[0]) + weights[1] * exact(corners[step]) +
               weights[2] * exact(corners[2 * step]);
    };
    Rational alpha = 255;
    if (of.texture >= 0 && !coordinates.empty()) {
        const MaskTexture& texture = textures[std::size_t(of.texture)];
        const float* corners = &coordinates[6 * std::size_t(id)];
        const Rational x = at_hit(corners, 2) * texture.width, y = at_hit(corners + 1, 2) * texture.height;
        const Sampler sampler(of, texture);
        alpha = of.is_linear ? sampler.linear(x, y) : sampler.nearest(x, y);
    }
    if (!alphas.empty()) alpha *= at_hit(&alphas[3 * std::size_t(id)], 1);
    return alpha >= threshold;
}

}  // namespace reference
