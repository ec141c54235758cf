// SPDX-License-Identifier: MIT
// Rays whose direction is an exact sum of float vectors (kernels/camera/camera.h says such sums are the camera's rays),
// and what they meet, by the definition alone: a long double filter, then integers.
//
// The filter: each entry of a determinant has a relative error of at most 2^-62, each of the six products of three
// meets at most 8 roundings, so the error is below 2^-58 of the permanent (predicates.hpp has the full argument).
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "grid_map.hpp"

namespace reference {

class ExactRay {
public:
    /// Leaves `origin` along the sum of `parts`.
    ExactRay(const Float3& origin, std::initializer_list<Float3> parts)
        : origin_(origin), exponent_(common_exponent(parts)) {
        for (const Float3& part : parts) {
            const Integer3 integers = scaled(part, exponent_);
            for (int i = 0; i < 3; ++i) direction_[i] += integers[i];
        }
        for (int i = 0; i < 3; ++i) rounded_[i] = Quotient{direction_[i], Integer(1), exponent_}.value();
    }

    /// The ray after its origin meets the closed triangle; never one that is edge-on. t > 0 comes with it: the
    /// direction is a positive combination of the vertices as seen from the origin.
    bool meets(const Triangle& t) const {
        const int orientation = side(t[0], t[1], t[2]);
        return orientation != 0 && side(t[0], t[1]) * orientation >= 0 && side(t[1], t[2]) * orientation >= 0 &&
               side(t[2], t[0]) * orientation >= 0;
    }

    /// Where it meets the triangle's plane, in lengths of the direction; the triangle is not edge-on.
    Quotient parameter(const Triangle& t) const {
        const int exponent = common_exponent({origin_, t[0], t[1], t[2]});
        const Integer3 a = scaled(t[0], exponent), origin = scaled(origin_, exponent);
        const Integer3 normal = cross(scaled(t[1], exponent) - a, scaled(t[2], exponent) - a);
        Quotient result{reference::dot(normal, a - origin), reference::dot(normal, direction_), exponent - exponent_};
        if (result.denominator.sign() < 0) {
            result.numerator = -result.numerator;
            result.denominator = -result.denominator;
        }
        return result;
    }

private:
    Wide3 seen(const Float3& v) const {
        return {static_cast<long double>(v[0]) - origin_[0], static_cast<long double>(v[1]) - origin_[1],
                static_cast<long double>(v[2]) - origin_[2]};
    }
    static std::optional<int> filtered(const Wide3& u, const Wide3& v, const Wide3& w) {
        const auto magnitudes = [](const Wide3& x) { return Wide3{std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])}; };
        const Wide3 mu = magnitudes(u), mv = magnitudes(v), mw = magnitudes(w);
        const long double permanent = mu[0] * (mv[1] * mw[2] + mv[2] * mw[1]) +
                                      mu[1] * (mv[2] * mw[0] + mv[0] * mw[2]) + mu[2] * (mv[0] * mw[1] + mv[1] * mw[0]);
        const long double value = reference::dot(u, reference::cross(v, w));
        if (std::fabs(value) > 0x1p-58L * permanent) return value > 0 ? 1 : -1;
        if (permanent == 0) return 0;
        return std::nullopt;
    }
    /// det(u - origin, v - origin, direction)
    int side(const Float3& u, const Float3& v) const {
        if (const auto certain = filtered(seen(u), seen(v), rounded_)) return *certain;
        const int exponent = common_exponent({origin_, u, v});
        const Integer3 origin = scaled(origin_, exponent);
        return sign(determinant(scaled(u, exponent) - origin, scaled(v, exponent) - origin, direction_));
    }
    int side(const Float3& u, const Float3& v, const Float3& w) const {
        if (const auto certain = filtered(seen(u), seen(v), seen(w))) return *certain;
        const int exponent = common_exponent({origin_, u, v, w});
        const Integer3 origin = scaled(origin_, exponent);
        return sign(
            determinant(scaled(u, exponent) - origin, scaled(v, exponent) - origin, scaled(w, exponent) - origin));
    }

    Float3 origin_;
    int exponent_;
    Integer3 direction_{};  ///< times 2^exponent_
    Wide3 rounded_{};
};

/// What an ExactRay meets, nearest first; equally near by rising id.
struct Meeting {
    std::uint32_t id;
    long double parameter;  ///< relative error below 2^-62
};

inline std::vector<Meeting> meetings(const ExactRay& ray, std::span<const float> triangles) {
    std::vector<Meeting> met;
    for (std::uint32_t id = 0; id < triangles.size() / 9; ++id) {
        const Triangle t = triangle_at(triangles, id);
        if (is_finite(t) && ray.meets(t)) met.push_back({id, ray.parameter(t).value()});
    }
    std::stable_sort(met.begin(), met.end(),
                     [](const Meeting& a, const Meeting& b) { return a.parameter < b.parameter; });
    return met;
}

}  // namespace reference
