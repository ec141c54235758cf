// SPDX-License-Identifier: MIT
// The camera's truth. See camera.hpp.
#include "camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "visibility.hpp"

namespace reference {
namespace {

static_assert(std::numeric_limits<long double>::digits >= 64, "the camera reference needs a 64-bit mantissa");

using Vector = std::array<long double, 3>;

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

long double length(const Vector& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Long double's exponents reach far beyond float's squares, so nothing overflows or vanishes on the way.
Vector normalized(const Vector& v, const char* complaint) {
    const long double size = length(v);
    if (!(size > 0) || !std::isfinite(size)) throw std::invalid_argument(complaint);
    return {v[0] / size, v[1] / size, v[2] / size};
}

/// How far `a` lies behind `b` along the ray, in world units (negative: before).
long double depth_between(const Ray& ray, const Triangle& a, const Triangle& b) {
    Quotient at_a = exact_parameter(ray, a), at_b = exact_parameter(ray, b);
    const int exponent = std::min(at_a.exponent, at_b.exponent);
    at_a.numerator <<= static_cast<unsigned>(at_a.exponent - exponent);
    at_b.numerator <<= static_cast<unsigned>(at_b.exponent - exponent);
    const Quotient difference{at_a.numerator * at_b.denominator - at_b.numerator * at_a.denominator,
                              at_a.denominator * at_b.denominator, exponent};
    const Vector direction{static_cast<long double>(ray.pixel[0]), static_cast<long double>(ray.pixel[1]),
                           static_cast<long double>(ray.pixel[2])};
    return difference.value() * length(direction);
}

/// Whether the ray meets the closed triangle after its origin.
bool meets(const Ray& ray, const Triangle& triangle, Effort& effort) { return blocks(ray, triangle, effort); }

/// Promise (a) for one ray.
bool sees(const Bvh& bvh, std::span<const float> triangles, const Ray& ray, std::uint32_t receiver,
          long double depth_slack, Effort& effort) {
    const auto nearest = nearest_triangle(bvh, ray, effort);
    if (receiver == NO_RECEIVER) return !nearest;
    if (!nearest) return false;
    if (*nearest == receiver) return true;
    const Triangle claimed = triangle_at(triangles, receiver);
    if (!meets(ray, claimed, effort) || !bvh.is_opaque(receiver, claimed, ray)) return false;
    ++effort.signs;
    ++effort.exact_signs;
    return depth_between(ray, claimed, triangle_at(triangles, *nearest)) <= depth_slack;
}

}  // namespace

PixelRays::PixelRays(const PinholeCamera& camera, double ray_tolerance) : camera_(camera) {
    if (camera.width == 0 || camera.height == 0) throw std::invalid_argument("the camera has no pixels");
    if (!(camera.fov_y_degrees > 0 && camera.fov_y_degrees < 180))
        throw std::invalid_argument("the vertical field of view must lie between 0 and 180 degrees");
    Vector view, hint;
    for (int i = 0; i < 3; ++i) {
        view[i] = static_cast<long double>(camera.target[i]) - static_cast<long double>(camera.eye[i]);
        hint[i] = camera.up[i];
    }
    forward_ = normalized(view, "the camera's eye and target coincide");
    const Vector sideways = cross(forward_, normalized(hint, "the camera's up must not be 0,0,0"));
    right_ = normalized(sideways, "the camera's up is parallel to its view");
    up_ = cross(right_, forward_);
    tangent_ = std::tan(static_cast<long double>(camera.fov_y_degrees) * std::numbers::pi_v<long double> / 360);
    tilt_ = static_cast<long double>(ray_tolerance) / length(sideways);
}

PixelRays::Vector PixelRays::direction(std::uint32_t x, std::uint32_t y) const {
    const long double height = camera_.height;
    // (2 (x + 0.5) / width - 1) width / height: the numerators are integers.
    const long double across = (2.0L * x + 1 - static_cast<long double>(camera_.width)) / height * tangent_;
    const long double upwards = (height - 2.0L * y - 1) / height * tangent_;
    Vector result;
    for (int i = 0; i < 3; ++i) result[i] = forward_[i] + across * right_[i] + upwards * up_[i];
    return result;
}

Ray PixelRays::fixed(const Vector& direction) const {
    const long double largest = std::max({std::fabs(direction[0]), std::fabs(direction[1]), std::fabs(direction[2])});
    std::array<std::int64_t, 3> integers;
    for (int i = 0; i < 3; ++i) integers[i] = std::llrint(std::ldexp(direction[i], 60 - std::ilogb(largest)));
    return Ray::through_pixel(camera_.eye, integers);
}

Ray PixelRays::through_centre(std::uint32_t x, std::uint32_t y) const { return fixed(direction(x, y)); }

std::vector<Ray> PixelRays::around_centre(std::uint32_t x, std::uint32_t y) const {
    const Vector centre = direction(x, y);
    std::vector<Ray> rays;
    for (const long double share : {1.0L, 0.5L})
        for (int k = 0; k < 16; ++k) {
            const long double angle = k * std::numbers::pi_v<long double> / 8;
            const long double radius = share * tilt_ * length(centre);
            Vector tilted;
            for (int i = 0; i < 3; ++i)
                tilted[i] = centre[i] + radius * (std::cos(angle) * right_[i] + std::sin(angle) * up_[i]);
            rays.push_back(fixed(tilted));
        }
    return rays;
}

std::optional<std::uint32_t> nearest_triangle(const Bvh& bvh, const Ray& ray, Effort& effort) {
    std::optional<std::uint32_t> nearest;
    Triangle nearest_shape{};
    ParameterBounds nearest_bounds;
    bvh.traverse(ray, [&](std::uint32_t id, const Triangle& triangle) {
        if (!meets(ray, triangle, effort) || !bvh.is_opaque(id, triangle, ray)) return nearest_bounds.latest;
        const ParameterBounds bounds = parameter_bounds(ray, triangle);
        bool is_nearer = !nearest || bounds.latest < nearest_bounds.earliest;
        if (!is_nearer && bounds.earliest <= nearest_bounds.latest) {
            ++effort.signs;
            ++effort.exact_signs;
            const long double behind = depth_between(ray, triangle, nearest_shape);  // 0 only if exactly 0
            is_nearer = behind < 0 || (behind == 0 && id < *nearest);
        }
        if (is_nearer) {
            nearest = id;
            nearest_shape = triangle;
            nearest_bounds = bounds;
        }
        return nearest_bounds.latest;
    });
    return nearest;
}

std::optional<std::array<long double, 3>> meeting_point(const Ray& ray, const Triangle& triangle) {
    const ParameterBounds bounds = parameter_bounds(ray, triangle);
    long double parameter = (static_cast<long double>(bounds.earliest) + bounds.latest) / 2;
    if (!(bounds.latest - bounds.earliest <= 0x1p-40 * bounds.earliest)) {
        const Quotient exact = exact_parameter(ray, triangle);
        if (exact.denominator.is_zero()) return std::nullopt;
        parameter = exact.value();
    }
    Vector point;
    for (int i = 0; i < 3; ++i) point[i] = ray.origin[i] + parameter * static_cast<long double>(ray.pixel[i]);
    return point;
}

long double ulp_at(const Float3& a, const Float3& b) {
    float largest = 0;
    for (int i = 0; i < 3; ++i) largest = std::max({largest, std::fabs(a[i]), std::fabs(b[i])});
    const int exponent = largest == 0 ? FINEST_EXPONENT : std::max(std::ilogb(largest) - 23, FINEST_EXPONENT);
    return std::ldexp(1.0L, exponent);
}

CameraVerdict judge_pixel(const Bvh& bvh, std::span<const float> triangles, const PixelRays& rays, std::uint32_t x,
                          std::uint32_t y, std::uint32_t receiver, const Float3& point, Effort& effort) {
    CameraVerdict verdict;
    const bool is_sky = receiver == NO_RECEIVER;
    const bool has_plane = receiver < triangles.size() / 9 && is_finite(triangle_at(triangles, receiver));
    if (!is_sky && (!has_plane || !is_finite(point))) return {false, false, false, false, 0};

    Ray ray = rays.through_centre(x, y);
    const long double ulp = is_sky ? 0 : ulp_at(point, ray.origin);
    verdict.is_nearest = sees(bvh, triangles, ray, receiver, CAMERA_ULP * ulp, effort);
    if (!verdict.is_nearest) {
        for (const Ray& tilted : rays.around_centre(x, y)) {
            if (!sees(bvh, triangles, tilted, receiver, CAMERA_ULP * ulp, effort)) continue;
            verdict.is_nearest = verdict.is_ambiguous = true;
            ray = tilted;
            break;
        }
    }
    if (is_sky) return verdict;

    const Triangle plane = triangle_at(triangles, receiver);
    const int eye_side = side_of_point(ray.origin, plane, effort);
    verdict.is_on_side = eye_side != 0 && eye_side * side_of_point(point, plane, effort) >= 0;
    const auto hit = meeting_point(ray, plane);
    if (hit) verdict.distance_ulp = length({point[0] - (*hit)[0], point[1] - (*hit)[1], point[2] - (*hit)[2]}) / ulp;
    verdict.is_close = hit && verdict.distance_ulp <= CAMERA_ULP;
    return verdict;
}

}  // namespace reference
