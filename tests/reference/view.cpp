// SPDX-License-Identifier: MIT
// Judges a whole view. See view.hpp.
#include "view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "parallel.hpp"

namespace reference {
namespace {

using Vector = std::array<long double, 3>;

constexpr long double UNIT_TOLERANCE = 1e-6L;           // | |N| - 1 |
constexpr long double PERPENDICULAR_TOLERANCE = 1e-5L;  // cosine of N and an edge

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Vector subtract(const Float3& a, const Float3& b) {
    return {static_cast<long double>(a[0]) - b[0], static_cast<long double>(a[1]) - b[1],
            static_cast<long double>(a[2]) - b[2]};
}
long double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
long double length(const Vector& a) { return std::sqrt(dot(a, a)); }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The triangle's normal towards the eye, not normalised. Its two shortest edges give the smallest error.
Vector normal_towards(const Triangle& t, const Float3& eye) {
    std::array<int, 3> corner{0, 1, 2};
    const auto opposite_length = [&](int i) { return length(subtract(t[(i + 1) % 3], t[(i + 2) % 3])); };
    std::sort(corner.begin(), corner.end(), [&](int a, int b) { return opposite_length(a) > opposite_length(b); });
    const Float3& tip = t[corner[0]];  // opposite the longest edge
    Vector normal = cross(subtract(t[corner[1]], tip), subtract(t[corner[2]], tip));
    Effort effort;
    // side_of_point: the sign of (b - a) x (c - a) . (a - eye), so + means that it points away from the eye.
    const bool is_even = (corner[1] - corner[0] + 3) % 3 == 1;
    const int turn = (is_even ? 1 : -1) * -side_of_point(eye, t, effort);
    for (long double& x : normal) x *= turn;
    return normal;
}

bool is_right_normal(const Vector& normal, const Triangle& triangle, const Float3& eye) {
    if (!(std::fabs(length(normal) - 1) <= UNIT_TOLERANCE)) return false;
    for (int i = 0; i < 3; ++i) {
        const Vector edge = subtract(triangle[(i + 1) % 3], triangle[i]);
        if (!(std::fabs(dot(normal, edge)) <= PERPENDICULAR_TOLERANCE * length(edge))) return false;
    }
    return dot(normal, normal_towards(triangle, eye)) > 0;
}

/// A number from 0 to 1 per pixel, the same on every machine and for every order of threads (splitmix64).
double sample_value(std::uint64_t seed, std::uint64_t pixel) {
    std::uint64_t z = seed * 0x9E3779B97F4A7C15u + pixel * 0xD1B54A32D192ED03u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -53);
}

void check_sizes(const PinholeCamera& camera, const ViewClaim& claim) {
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    const auto fits = [&](std::size_t size, std::size_t per_pixel) { return size == pixels * per_pixel; };
    if (!fits(claim.position.size(), 3) || !fits(claim.receiver.size(), 1) ||
        (!claim.normal.empty() && !fits(claim.normal.size(), 3)) ||
        (!claim.visibility.empty() && !fits(claim.visibility.size(), 1)))
        throw std::invalid_argument("the view's arrays do not match its width and height");
}

/// Visibility of all pixels that are not sky; the sky's own rules.
void judge_visibility(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light,
                      const ViewClaim& claim, const Masks* masks, ViewReport& report) {
    std::vector<float> points;
    std::vector<std::uint32_t> receivers;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < claim.receiver.size(); ++i) {
        if (claim.receiver[i] == NO_RECEIVER) continue;
        points.insert(points.end(), claim.position.begin() + 3 * i, claim.position.begin() + 3 * i + 3);
        receivers.push_back(claim.receiver[i]);
        pixels.push_back(i);
    }
    const auto truth = shadowed(triangles, points, receivers, light, camera.eye, &report.visibility, masks);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        if (claim.visibility[pixels[i]] != (truth[i] ? 0.0f : 1.0f)) report.wrong_visibility.add(pixels[i]);
}

bool is_right_sky(const ViewClaim& claim, std::size_t pixel) {
    const auto is_zero = [&](std::span<const float> vectors) {
        return vectors.empty() || point_at(vectors, pixel) == Float3{0, 0, 0};
    };
    return is_zero(claim.position) && is_zero(claim.normal) &&
           (claim.visibility.empty() || claim.visibility[pixel] == 1.0f);
}

void judge_normals_and_sky(std::span<const float> triangles, const PinholeCamera& camera, const ViewClaim& claim,
                           ViewReport& report) {
    for (std::size_t i = 0; i < claim.receiver.size(); ++i) {
        const std::uint32_t receiver = claim.receiver[i];
        if (receiver == NO_RECEIVER) {
            ++report.sky;
            if (!is_right_sky(claim, i)) report.wrong_sky.add(i);
        } else if (!claim.normal.empty()) {
            const Float3 n = point_at(claim.normal, i);
            if (receiver >= triangles.size() / 9 ||
                !is_right_normal({n[0], n[1], n[2]}, triangle_at(triangles, receiver), camera.eye))
                report.wrong_normal.add(i);
        }
    }
}

void judge_camera(std::span<const float> triangles, const PinholeCamera& camera, const ViewClaim& claim,
                  const JudgeOptions& options, ViewReport& report) {
    const Bvh bvh(triangles, options.masks);
    const PixelRays rays(camera, options.ray_tolerance);
    const double share = options.camera_sample == 0
                             ? 1
                             : static_cast<double>(options.camera_sample) / static_cast<double>(report.pixels);
    std::mutex mutex;
    for_chunks(claim.receiver.size(), 1024, [&](std::size_t first, std::size_t last) {
        ViewReport local;
        for (std::size_t i = first; i < last; ++i) {
            if (sample_value(options.seed, i) >= share) continue;
            Effort effort;
            const auto x = static_cast<std::uint32_t>(i % camera.width),
                       y = static_cast<std::uint32_t>(i / camera.width);
            const CameraVerdict verdict =
                judge_pixel(bvh, triangles, rays, x, y, claim.receiver[i], point_at(claim.position, i), effort);
            ++local.camera_pixels;
            local.camera_ambiguous += verdict.is_ambiguous;
            local.camera_decided_exactly += effort.exact_signs > 0;
            local.largest_distance_ulp = std::max(local.largest_distance_ulp, verdict.distance_ulp);
            if (!verdict.is_nearest) local.wrong_nearest.add(i);
            if (!verdict.is_on_side) local.wrong_side.add(i);
            if (!verdict.is_close) local.wrong_distance.add(i);
        }
        const std::lock_guard lock(mutex);
        report.camera_pixels += local.camera_pixels;
        report.camera_ambiguous += local.camera_ambiguous;
        report.camera_decided_exactly += local.camera_decided_exactly;
        report.largest_distance_ulp = std::max(report.largest_distance_ulp, local.largest_distance_ulp);
        report.wrong_nearest.merge(local.wrong_nearest);
        report.wrong_side.merge(local.wrong_side);
        report.wrong_distance.merge(local.wrong_distance);
    });
}

/// The hit rounded to float32, lifted so that it is not under the plane as seen from the eye.
Float3 shading_point(const Vector& hit, const Triangle& triangle, const Float3& eye) {
    Float3 point;
    for (int i = 0; i < 3; ++i) point[i] = static_cast<float>(hit[i]);
    const Vector normal = normal_towards(triangle, eye);
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(normal[i]) > std::fabs(normal[axis])) axis = i;
    const auto step = static_cast<float>(std::copysign(ulp_at(point, point), normal[axis]));
    Effort effort;
    const int eye_side = side_of_point(eye, triangle, effort);
    while (side_of_point(point, triangle, effort) == -eye_side) point[axis] += step;
    return point;
}

}  // namespace

void Faults::add(std::size_t pixel) {
    ++count;
    if (first.size() < SHOWN) first.push_back(pixel);
}

void Faults::merge(const Faults& other) {
    count += other.count;
    first.insert(first.end(), other.first.begin(), other.first.end());
    std::sort(first.begin(), first.end());
    if (first.size() > SHOWN) first.resize(SHOWN);
}

std::uint64_t ViewReport::wrong() const {
    return wrong_visibility.count + wrong_sky.count + wrong_normal.count + wrong_nearest.count + wrong_side.count +
           wrong_distance.count;
}

ViewReport judge_view(std::span<const float> triangles, const PinholeCamera& camera,
                      const std::optional<std::array<float, 4>>& light, const ViewClaim& claim,
                      const JudgeOptions& options) {
    check_sizes(camera, claim);
    ViewReport report;
    report.pixels = claim.receiver.size();
    auto start = std::chrono::steady_clock::now();
    if (light && !claim.visibility.empty()) judge_visibility(triangles, camera, *light, claim, options.masks, report);
    report.visibility_seconds = seconds_since(start);
    start = std::chrono::steady_clock::now();
    judge_normals_and_sky(triangles, camera, claim, report);
    judge_camera(triangles, camera, claim, options, report);
    report.camera_seconds = seconds_since(start);
    return report;
}

View make_view(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light) {
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    View view{std::vector<float>(3 * pixels), std::vector<float>(3 * pixels), std::vector<float>(pixels, 1.0f),
              std::vector<std::uint32_t>(pixels, NO_RECEIVER)};
    const Bvh bvh(triangles);
    const PixelRays rays(camera);
    for_chunks(pixels, 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Effort effort;
            const Ray ray = rays.through_centre(static_cast<std::uint32_t>(i % camera.width),
                                                static_cast<std::uint32_t>(i / camera.width));
            const auto receiver = nearest_triangle(bvh, ray, effort);
            if (!receiver) continue;
            const Triangle triangle = triangle_at(triangles, *receiver);
            const Float3 point = shading_point(*meeting_point(ray, triangle), triangle, camera.eye);
            const Vector normal = normal_towards(triangle, camera.eye);
            view.receiver[i] = *receiver;
            for (int k = 0; k < 3; ++k) {
                view.position[3 * i + k] = point[k];
                view.normal[3 * i + k] = static_cast<float>(normal[k] / length(normal));
            }
        }
    });
    const auto truth = shadowed(triangles, view.position, view.receiver, light, camera.eye);
    for (std::size_t i = 0; i < pixels; ++i)
        view.visibility[i] = view.receiver[i] != NO_RECEIVER && truth[i] ? 0.0f : 1.0f;
    return view;
}

}  // namespace reference
