// SPDX-License-Identifier: MIT
// The camera's truth: exact pixel rays, the exact nearest triangle, and whether a claimed shading point keeps the three
// promises of the camera stage.
//
// The ray of pixel (x, y), row 0 on top, runs from the eye along
//   forward + (2 (x + 0.5) / width - 1) aspect t right + (1 - 2 (y + 0.5) / height) t up,   t = tan(fov_y / 2),
//   forward = normalize(target - eye), right = normalize(forward x up hint), up = right x forward,
// computed in long double (64-bit mantissa or more) and then *fixed*: scaled by a power of two so that the largest
// coordinate lies in [2^60, 2^61), and rounded to integers. From there on nothing is rounded: coverage is of closed
// triangles, both faces count, edge-on triangles are never met, there is no near and no far plane, t > 0.
//
// Another implementation's rays differ from these by roundings. So a claim that this ray does not bear out is checked
// again with rays tilted by `ray_tolerance` (and half of it) in 16 directions; a claim that one of them bears out is
// not wrong but "ambiguous", and counted. No claim is excused that way unless an edge passes that close to the ray.
//
// Promises (ulp: of float32 at the largest coordinate of P and eye in magnitude):
//   (a) nearest: the receiver is met by the ray, and by at most 16 ulp of depth behind the nearest triangle met;
//       no receiver is claimed exactly where none is met;
//   (b) side: P is not under its receiver's plane as seen from the eye (on it is allowed), by exact sign;
//   (c) distance: P is at most 16 ulp from where the ray meets the receiver's plane.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "bvh.hpp"
#include "visibility.hpp"

namespace reference {

/// The promised 16 ulp, of depth and of distance.
inline constexpr int CAMERA_ULP = 16;

/// The default of `ray_tolerance`: covers a camera whose axes are rounded to double, and nothing coarser.
inline constexpr double DEFAULT_RAY_TOLERANCE = 0x1p-48;

struct PinholeCamera {
    Float3 eye{}, target{0, 0, -1}, up{0, 1, 0};
    double fov_y_degrees = 50;
    std::uint32_t width = 0, height = 0;
    /// Right, up and forward, unit and orthogonal up to the roundings of doubles: in place of target and up.
    std::optional<std::array<std::array<double, 3>, 3>> axes{};
};

/// In pixels from the picture's upper left corner, rightwards and downwards.
struct PicturePosition {
    long double x = 0, y = 0;
};

inline PicturePosition centre_of(std::uint32_t x, std::uint32_t y) { return {x + 0.5L, y + 0.5L}; }

class PixelRays {
public:
    /// Throws std::invalid_argument if the camera has no view (eye at target, up along the view, a field of view
    /// outside 0..180, no pixels).
    explicit PixelRays(const PinholeCamera& camera, double ray_tolerance = DEFAULT_RAY_TOLERANCE);

    Ray through(const PicturePosition& at) const;

    /// The rays that decide about ambiguity: tilted by the tolerance and half of it.
    std::vector<Ray> around(const PicturePosition& at) const;

private:
    using Vector = std::array<long double, 3>;
    Vector direction(const PicturePosition& at) const;
    Ray fixed(const Vector& direction) const;

    PinholeCamera camera_;
    long double tangent_ = 0;
    long double tilt_ = 0;  ///< the tolerance, larger where the up hint is nearly parallel to the view
    Vector forward_{}, right_{}, up_{};
};

/// The triangle met first, exactly; of several at the same parameter the one with the lowest id.
std::optional<std::uint32_t> nearest_triangle(const Bvh& bvh, const Ray& ray, Effort& effort);

/// Where the ray's line meets the triangle's plane, with an error below 2^-38 of the distance from the eye; nothing if
/// edge-on.
std::optional<std::array<long double, 3>> meeting_point(const Ray& ray, const Triangle& triangle);

/// float32's spacing at the largest coordinate, in magnitude, of the two.
long double ulp_at(const Float3& a, const Float3& b);

/// What became of one claim.
struct CameraVerdict {
    bool is_nearest = true;        ///< (a)
    bool is_on_side = true;        ///< (b); vacuous for the sky
    bool is_close = true;          ///< (c); vacuous for the sky
    bool is_ambiguous = false;     ///< (a) holds for a tilted ray only
    long double distance_ulp = 0;  ///< |P - true hit|; 0 for the sky and where there is no true hit
};

/// Judges the claim that the ray through `at` sees `receiver` (NO_RECEIVER: the sky) at `point`. `own` is the receiver
/// of the pixel that a sample belongs to: a sample whose ray meets that triangle lies on it, whatever else is nearer.
CameraVerdict judge_position(const Bvh& bvh, std::span<const float> triangles, const PixelRays& rays,
                             const PicturePosition& at, std::uint32_t receiver, const Float3& point, Effort& effort,
                             std::uint32_t own = NO_RECEIVER);

/// Where samples lie within a pixel: 1 (the centre), 4, 8 or 16 (Direct3D's standard patterns) or 32 (Hammersley's
/// points in base 2, in the middle of their strata), each from the pixel's upper left corner. Empty for another number.
std::vector<PicturePosition> sample_positions(std::uint32_t samples);

}  // namespace reference
