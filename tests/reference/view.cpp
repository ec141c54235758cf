// SPDX-License-Identifier: MIT
// Judges a whole view. See view.hpp.
#include "view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
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
    if (sample_positions(claim.samples).empty())
        throw std::invalid_argument("a pixel has 1, 4, 8, 16 or 32 samples, not " + std::to_string(claim.samples));
    if (claim.samples != 1 &&
        (!fits(claim.sample_position.size(), 3 * claim.samples) || !fits(claim.sample_receiver.size(), claim.samples)))
        throw std::invalid_argument("the samples do not match the view's width and height");
}

/// Visibility of all points of `claim` that are not sky: how many of each pixel's are in shadow.
std::vector<std::uint32_t> count_shadowed(std::span<const float> triangles, const PinholeCamera& camera,
                                          const std::array<float, 4>& light, std::span<const float> position,
                                          std::span<const std::uint32_t> receiver, std::size_t pixel_count,
                                          const Masks* masks, ViewReport& report) {
    std::vector<float> points;
    std::vector<std::uint32_t> receivers;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < receiver.size(); ++i) {
        if (receiver[i] == NO_RECEIVER) continue;
        points.insert(points.end(), position.begin() + 3 * i, position.begin() + 3 * i + 3);
        receivers.push_back(receiver[i]);
        pixels.push_back(i % pixel_count);
    }
    const auto truth = shadowed(triangles, points, receivers, light, camera.eye, &report.visibility, masks);
    std::vector<std::uint32_t> counts(pixel_count);
    for (std::size_t i = 0; i < pixels.size(); ++i) counts[pixels[i]] += truth[i];
    return counts;
}

void judge_visibility(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light,
                      const ViewClaim& claim, const Masks* masks, ViewReport& report) {
    const bool has_samples = claim.samples != 1;
    const auto in_shadow =
        count_shadowed(triangles, camera, light, has_samples ? claim.sample_position : claim.position,
                       has_samples ? claim.sample_receiver : claim.receiver, claim.receiver.size(), masks, report);
    for (std::size_t i = 0; i < in_shadow.size(); ++i) {
        if (!has_samples && claim.receiver[i] == NO_RECEIVER) continue;  // the sky has rules of its own
        // The number of samples is a power of two: their mean is exact.
        if (claim.visibility[i] != float(claim.samples - in_shadow[i]) / float(claim.samples))
            report.wrong_visibility.add(i);
        report.partly_lit += in_shadow[i] != 0 && in_shadow[i] != claim.samples;
    }
}

bool is_right_sky(const ViewClaim& claim, std::size_t pixel) {
    const auto is_zero = [&](std::span<const float> vectors) {
        return vectors.empty() || point_at(vectors, pixel) == Float3{0, 0, 0};
    };
    return is_zero(claim.position) && is_zero(claim.normal) &&
           (claim.visibility.empty() || claim.samples != 1 || claim.visibility[pixel] == 1.0f);
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

/// What the judges of one view share.
struct Judge {
    Judge(std::span<const float> of, const PinholeCamera& camera_, const ViewClaim& claim_,
          const JudgeOptions& options_)
        : triangles(of),
          camera(camera_),
          claim(claim_),
          options(options_),
          bvh(of, options_.masks),
          rays(camera_, options_.ray_tolerance),
          pattern(sample_positions(claim_.samples)) {}

    bool is_chosen(std::size_t pixel) const {
        const auto all = static_cast<double>(claim.receiver.size());
        return options.camera_sample == 0 ||
               sample_value(options.seed, pixel) < static_cast<double>(options.camera_sample) / all;
    }
    CameraVerdict verdict_of(std::size_t pixel, const PicturePosition& in_pixel, std::uint32_t receiver,
                             const Float3& point, std::uint32_t own, Effort& effort) const {
        const PicturePosition at{static_cast<long double>(pixel % camera.width) + in_pixel.x,
                                 static_cast<long double>(pixel / camera.width) + in_pixel.y};
        return judge_position(bvh, triangles, rays, at, receiver, point, effort, own);
    }

    std::span<const float> triangles;
    const PinholeCamera& camera;
    const ViewClaim& claim;
    const JudgeOptions& options;
    Bvh bvh;
    PixelRays rays;
    std::vector<PicturePosition> pattern;
};

void judge_centre(const Judge& judge, std::size_t pixel, ViewReport& report) {
    Effort effort;
    const CameraVerdict verdict = judge.verdict_of(pixel, centre_of(0, 0), judge.claim.receiver[pixel],
                                                   point_at(judge.claim.position, pixel), NO_RECEIVER, effort);
    ++report.camera_pixels;
    report.camera_ambiguous += verdict.is_ambiguous;
    report.camera_decided_exactly += effort.exact_signs > 0;
    report.largest_distance_ulp = std::max(report.largest_distance_ulp, verdict.distance_ulp);
    if (!verdict.is_nearest) report.wrong_nearest.add(pixel);
    if (!verdict.is_on_side) report.wrong_side.add(pixel);
    if (!verdict.is_close) report.wrong_distance.add(pixel);
}

/// The samples of one pixel. What is ambiguous about the pixel's own receiver is so for its samples.
void judge_samples(const Judge& judge, std::size_t pixel, ViewReport& report) {
    const ViewClaim& claim = judge.claim;
    for (std::size_t k = 0; k < judge.pattern.size(); ++k) {
        const std::size_t i = k * claim.receiver.size() + pixel;
        Effort effort;
        const CameraVerdict verdict =
            judge.verdict_of(pixel, judge.pattern[k], claim.sample_receiver[i], point_at(claim.sample_position, i),
                             claim.receiver[pixel], effort);
        ++report.samples_judged;
        report.samples_ambiguous += verdict.is_ambiguous;
        report.largest_distance_ulp = std::max(report.largest_distance_ulp, verdict.distance_ulp);
        if (!verdict.is_nearest) report.wrong_sample_nearest.add(pixel);
        if (!verdict.is_on_side) report.wrong_sample_side.add(pixel);
        if (!verdict.is_close) report.wrong_sample_distance.add(pixel);
    }
}

void merge(const ViewReport& part, ViewReport& report) {
    report.camera_pixels += part.camera_pixels;
    report.camera_ambiguous += part.camera_ambiguous;
    report.camera_decided_exactly += part.camera_decided_exactly;
    report.samples_judged += part.samples_judged;
    report.samples_ambiguous += part.samples_ambiguous;
    report.largest_distance_ulp = std::max(report.largest_distance_ulp, part.largest_distance_ulp);
    for (Faults ViewReport::*faults :
         {&ViewReport::wrong_nearest, &ViewReport::wrong_side, &ViewReport::wrong_distance,
          &ViewReport::wrong_sample_nearest, &ViewReport::wrong_sample_side, &ViewReport::wrong_sample_distance})
        (report.*faults).merge(part.*faults);
}

void judge_camera(const Judge& judge, ViewReport& report) {
    std::mutex mutex;
    for_chunks(judge.claim.receiver.size(), 1024, [&](std::size_t first, std::size_t last) {
        ViewReport local;
        for (std::size_t i = first; i < last; ++i) {
            if (!judge.is_chosen(i)) continue;
            judge_centre(judge, i, local);
            if (judge.claim.samples != 1) judge_samples(judge, i, local);
        }
        const std::lock_guard lock(mutex);
        merge(local, report);
    });
}

/// A sample of the sky has no point: its coordinates are NaN.
void count_samples(const ViewClaim& claim, ViewReport& report) {
    for (std::size_t i = 0; i < claim.sample_receiver.size(); ++i) {
        const std::uint32_t receiver = claim.sample_receiver[i];
        if (receiver == NO_RECEIVER) {
            ++report.samples_of_sky;
            if (is_finite(point_at(claim.sample_position, i))) report.wrong_sky.add(i % claim.receiver.size());
            continue;
        }
        ++(receiver == claim.receiver[i % claim.receiver.size()] ? report.samples_on_own : report.samples_on_others);
    }
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
           wrong_distance.count + wrong_sample_nearest.count + wrong_sample_side.count + wrong_sample_distance.count;
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
    judge_camera(Judge(triangles, camera, claim, options), report);
    count_samples(claim, report);
    report.camera_seconds = seconds_since(start);
    return report;
}

namespace {

/// What the ray through a position sees: its own receiver if it meets that, else the nearest triangle.
std::optional<std::uint32_t> seen_through(const Bvh& bvh, std::span<const float> triangles, const Ray& ray,
                                          std::uint32_t own) {
    Effort effort;
    if (own != NO_RECEIVER && blocks(ray, triangle_at(triangles, own), effort)) return own;
    return nearest_triangle(bvh, ray, effort);
}

void make_samples(const Bvh& bvh, std::span<const float> triangles, const PinholeCamera& camera, View& view) {
    const auto pattern = sample_positions(view.samples);
    const std::size_t pixels = view.receiver.size();
    const PixelRays rays(camera);
    view.sample_position.assign(3 * pixels * pattern.size(), std::numeric_limits<float>::quiet_NaN());
    view.sample_receiver.assign(pixels * pattern.size(), NO_RECEIVER);
    for (std::size_t i = 0; i < view.sample_receiver.size(); ++i) {
        const std::size_t pixel = i % pixels;
        const PicturePosition& in_pixel = pattern[i / pixels];
        const Ray ray = rays.through({static_cast<long double>(pixel % camera.width) + in_pixel.x,
                                      static_cast<long double>(pixel / camera.width) + in_pixel.y});
        const auto receiver = seen_through(bvh, triangles, ray, view.receiver[pixel]);
        if (!receiver) continue;
        const Triangle triangle = triangle_at(triangles, *receiver);
        const Float3 point = shading_point(*meeting_point(ray, triangle), triangle, camera.eye);
        view.sample_receiver[i] = *receiver;
        std::copy(point.begin(), point.end(), view.sample_position.begin() + std::ptrdiff_t(3 * i));
    }
}

}  // namespace

View make_view(std::span<const float> triangles, const PinholeCamera& camera, const std::array<float, 4>& light,
               std::uint32_t samples) {
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    View view{std::vector<float>(3 * pixels),
              std::vector<float>(3 * pixels),
              std::vector<float>(pixels, 1.0f),
              std::vector<std::uint32_t>(pixels, NO_RECEIVER),
              samples,
              {},
              {}};
    const Bvh bvh(triangles);
    const PixelRays rays(camera);
    for_chunks(pixels, 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Effort effort;
            const Ray ray = rays.through(
                centre_of(static_cast<std::uint32_t>(i % camera.width), static_cast<std::uint32_t>(i / camera.width)));
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
    if (samples != 1) make_samples(bvh, triangles, camera, view);
    ViewReport ignored;
    const auto in_shadow =
        samples == 1 ? count_shadowed(triangles, camera, light, view.position, view.receiver, pixels, nullptr, ignored)
                     : count_shadowed(triangles, camera, light, view.sample_position, view.sample_receiver, pixels,
                                      nullptr, ignored);
    for (std::size_t i = 0; i < pixels; ++i) view.visibility[i] = float(samples - in_shadow[i]) / float(samples);
    return view;
}

}  // namespace reference
