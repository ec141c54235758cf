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

bool is_met(const Bvh& bvh, std::span<const float> triangles, const Ray& ray, std::uint32_t id, Effort& effort) {
    const Triangle triangle = triangle_at(triangles, id);
    return meets(ray, triangle, effort) && bvh.is_opaque(id, triangle, ray);
}

/// Promise (a) for one ray.
bool sees(const Bvh& bvh, std::span<const float> triangles, const Ray& ray, std::uint32_t receiver, std::uint32_t own,
          long double depth_slack, Effort& effort) {
    if (own < triangles.size() / 9 && is_met(bvh, triangles, ray, own, effort)) return receiver == own;
    const auto nearest = nearest_triangle(bvh, ray, effort);
    if (receiver == NO_RECEIVER) return !nearest;
    if (!nearest) return false;
    if (*nearest == receiver) return true;
    if (!is_met(bvh, triangles, ray, receiver, effort)) return false;
    ++effort.signs;
    ++effort.exact_signs;
    return depth_between(ray, triangle_at(triangles, receiver), triangle_at(triangles, *nearest)) <= depth_slack;
}

}  // namespace

PixelRays::PixelRays(const PinholeCamera& camera, double ray_tolerance) : camera_(camera) {
    if (camera.width == 0 || camera.height == 0) throw std::invalid_argument("the camera has no pixels");
    if (!(camera.fov_y_degrees > 0 && camera.fov_y_degrees < 180))
        throw std::invalid_argument("the vertical field of view must lie between 0 and 180 degrees");
    tangent_ = std::tan(static_cast<long double>(camera.fov_y_degrees) * std::numbers::pi_v<long double> / 360);
    if (camera.axes) {
        for (int i = 0; i < 3; ++i) {
            right_[i] = (*camera.axes)[0][i];
            up_[i] = (*camera.axes)[1][i];
            forward_[i] = (*camera.axes)[2][i];
        }
        tilt_ = static_cast<long double>(ray_tolerance);
        return;
    }
    Vector view, hint;
    for (int i = 0; i < 3; ++i) {
        view[i] = static_cast<long double>(camera.target[i]) - static_cast<long double>(camera.eye[i]);
        hint[i] = camera.up[i];
    }
    forward_ = normalized(view, "the camera's eye and target coincide");
    const Vector sideways = cross(forward_, normalized(hint, "the camera's up must not be 0,0,0"));
    right_ = normalized(sideways, "the camera's up is parallel to its view");
    up_ = cross(right_, forward_);
    tilt_ = static_cast<long double>(ray_tolerance) / length(sideways);
}

PixelRays::Vector PixelRays::direction(const PicturePosition& at) const {
    const long double height = camera_.height;
    // (2 x / width - 1) width / height: the numerators are exact, being whole numbers of 64ths of a pixel.
    const long double across = (2.0L * at.x - static_cast<long double>(camera_.width)) / height * tangent_;
    const long double upwards = (height - 2.0L * at.y) / height * tangent_;
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

Ray PixelRays::through(const PicturePosition& at) const { return fixed(direction(at)); }

std::vector<Ray> PixelRays::around(const PicturePosition& at) const {
    const Vector centre = direction(at);
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

CameraVerdict judge_position(const Bvh& bvh, std::span<const float> triangles, const PixelRays& rays,
                             const PicturePosition& at, std::uint32_t receiver, const Float3& point, Effort& effort,
                             std::uint32_t own) {
    CameraVerdict verdict;
    const bool is_sky = receiver == NO_RECEIVER;
    const bool has_plane = receiver < triangles.size() / 9 && is_finite(triangle_at(triangles, receiver));
    if (!is_sky && (!has_plane || !is_finite(point))) return {false, false, false, false, 0};

    Ray ray = rays.through(at);
    const long double ulp = is_sky ? 0 : ulp_at(point, ray.origin);
    verdict.is_nearest = sees(bvh, triangles, ray, receiver, own, CAMERA_ULP * ulp, effort);
    if (!verdict.is_nearest) {
        for (const Ray& tilted : rays.around(at)) {
            if (!sees(bvh, triangles, tilted, receiver, own, CAMERA_ULP * ulp, effort)) continue;
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

std::vector<PicturePosition> sample_positions(std::uint32_t samples) {
    // Microsoft's D3D11_STANDARD_MULTISAMPLE_PATTERN, in sixteenths of a pixel from its centre.
    using Sixteenths = std::vector<std::array<int, 2>>;
    static const Sixteenths of_4{{-2, -6}, {6, -2}, {-6, 2}, {2, 6}};
    static const Sixteenths of_8{{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};
    static const Sixteenths of_16{{1, 1},  {-1, -3}, {-3, 2},  {4, -1}, {-5, -2}, {2, 5},  {5, 3}, {3, -5},
                                  {-2, 6}, {0, -7},  {-4, -6}, {-6, 4}, {-8, 0},  {7, -4}, {6, 7}, {-7, -8}};
    std::vector<PicturePosition> positions;
    if (samples == 1) return {{0.5L, 0.5L}};
    if (samples == 32) {
        for (unsigned i = 0; i < 32; ++i) {
            const unsigned reversed = (i & 1) << 4 | (i & 2) << 2 | (i & 4) | (i & 8) >> 2 | (i & 16) >> 4;
            positions.push_back({(i + 0.5L) / 32, (reversed + 0.5L) / 32});
        }
        return positions;
    }
    const Sixteenths none, &pattern = samples == 4 ? of_4 : samples == 8 ? of_8 : samples == 16 ? of_16 : none;
    for (const auto& [x, y] : pattern) positions.push_back({(x + 8) / 16.0L, (y + 8) / 16.0L});
    return positions;
}

}  // namespace reference
