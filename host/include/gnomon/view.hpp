// SPDX-License-Identifier: MIT
// A camera's view (stable), and scenes in parts (experimental).
#pragma once

#include <gnomon/trace.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

/// The offset of a sample from its pixel's centre, in 1/64 pixel, x to the right and y down, each from -32 to 31.
struct SampleOffset {
    int x = 0, y = 0;
};

/// A view on the host, for pictures and files.
struct ViewOnHost {
    std::vector<float> position;          ///< 3 per pixel; sky: 0
    std::vector<float> normal;            ///< 3 per pixel, unit geometric normal facing the camera; sky: 0
    std::vector<std::uint32_t> receiver;  ///< sky: no_receiver
};

/// The view of a camera: per pixel (row by row from the top) the nearest triangle and the shading point on it.
class View {
public:
    std::uint32_t width = 0, height = 0;
    SampleOffset offset{};  ///< of the points from their pixels' centres
    float pixel_share = 1;  ///< the side of the square that a point stands for, in pixels
    Points points;          ///< width * height; absent (NaN) where the pixel shows the sky
    Statistics statistics;  ///< of the camera stages
    /// Waits for the queue and copies to the host. `triangles` are those that look() saw.
    ViewOnHost read(const Device& device, const Triangles& triangles) const;
};

/// Runs the camera stages: visibility buffer, then shading points, lifted off their receiver by a proven bound. Throws
/// InvalidArgument if width or height is 0 or over 16384, or if the camera's members break its rules.
View look(const Device& device, const Triangles& triangles, const Camera& camera, std::uint32_t width,
          std::uint32_t height);

/// look() for picture after picture. Keeps the lists and buffers of the last picture: the next one of this size
/// allocates nothing, and repeats no stage because a list was too short. Same bits.
class CameraPass {
public:
    explicit CameraPass(const Device& device);  ///< allocates nothing yet
    ~CameraPass();
    CameraPass(CameraPass&&) noexcept;             ///< the other one may only be assigned to or destroyed
    CameraPass& operator=(CameraPass&&) noexcept;  ///< the same
    /// As look(). A view's buffers are used for a later picture only when no copy of its points is left.
    /// Statistics::device_memory_bytes counts all that the pass keeps.
    View look(const Triangles& triangles, const Camera& camera, std::uint32_t width, std::uint32_t height);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Lifts a caller's own points off their receivers as the camera stages do: each moves along its receiver's normal
/// towards `eye` by 4 float32 ulps of the largest coordinate of point and eye, and is rounded up along it
/// (docs/numerics.md, 9). If a point is an exact position on its receiver rounded to float32, the result is never below
/// its plane, and at most 9 such ulps from the point. Absent points, and points on a receiver without a plane, do not
/// move. The result shares the receivers; give runs Facing::eye(eye) with it. Throws InvalidArgument if there are no
/// receivers.
Points lift(const Device& device, const Triangles& triangles, const Points& points, const Float3& eye);

// ---- Scenes larger than the device's memory -------------------------------------------------------------------------

/// A scene that stays on the host.
struct SceneOnHost {
    std::span<const float> vertices;    ///< 9 floats per triangle
    const CutOuts* cut_outs = nullptr;  ///< of all these triangles; null: none
};

/// The view of a camera of a scene that stays on the host.
struct ViewOfParts {
    View view;                       ///< its receivers are indices in `ids`
    Triangles triangles;             ///< the triangles of `ids`, on the device: for View::read() and shade()
    std::vector<std::uint32_t> ids;  ///< ids in the whole scene, ascending: all seen triangles, and maybe more
};
/// look() for triangles on the host, same bits. The device stores as many triangles at a time as fit
/// into its memory or under the limit given to Device. Throws OutOfDeviceMemory if the view itself does not fit.
ViewOfParts look_in_parts(const Device& device, const SceneOnHost& scene, const Camera& camera, std::uint32_t width,
                          std::uint32_t height);

/// Technique::run() for triangles on the host: the device stores as many triangles, and as many points, at a time as
/// fit. Same bits for an exact technique; for other techniques, each point gets the lowest visibility of its parts.
/// `make` makes the technique, and makes it again after an attempt that did not fit. A receiver r of the points is
/// triangle ids[r] of the scene, or r if `ids` is empty. Progress counts triangles. Throws OutOfDeviceMemory if even
/// small parts do not fit, InvalidArgument for Facing::fans().
Statistics run_in_parts(const std::function<std::unique_ptr<Technique>()>& make, const Device& device,
                        const SceneOnHost& scene, const Points& points, std::span<const std::uint32_t> ids,
                        const Light& light, const Visibility& visibility, const RunOptions& options = {});

}  // namespace gnomon

#pragma GCC visibility pop
