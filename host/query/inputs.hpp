// SPDX-License-Identifier: MIT
// A run's inputs as the kernels take them.
#pragma once

#include "cl/session.hpp"
#include "kernels/simd/points.h"
#include "kernels/simd/projection.h"

namespace gnomon {

inline float4 float4_of(const std::array<float, 4>& v) { return {{v[0], v[1], v[2], v[3]}}; }

/// A run's facing as the stages take it: at most one of eye, front, normals and fans is given.
struct FacingInputs {
    std::optional<Float3> eye{};
    bool front = false;
    cl_mem normals = nullptr;
    PointLayout normals_layout{};
    const VertexFans* fans = nullptr;
    std::optional<Float3> up{};        ///< of the fans
    std::optional<Points> uploaded{};  ///< owns the normals that lay on the host
};
/// What `facing` says for these points. Throws InvalidArgument if it does not fit them, or fans not the triangles.
FacingInputs facing_inputs(const Device& device, const Triangles& triangles, const Points& points,
                           const Facing& facing);
/// The points with the eye that `facing` names. Throws InvalidArgument if it decides by anything else.
Points seen_from_eye(const Device& device, const Points& points, const Facing& facing);
/// Throws InvalidArgument if the visibility lies in the memory of normals.
void require_apart(const Points& points, const FacingInputs& sides, const Visibility& visibility);

/// The buffers of fans (kernels/receivers/backfacing.h), and the number of triangles that they were found among.
struct FansOnDevice {
    cl_mem fans, corners, extended;
    std::size_t triangle_count;
};

/// Opens to the library what the public types keep private.
struct Internals {
    static cl::Session& session(const Device& device) { return *device.session_; }
    static const Clusters* clusters(const Triangles& triangles) { return triangles.clusters_.get(); }
    static ImplicitRaster* raster(const Triangles& triangles) { return triangles.raster_.get(); }
    static const std::shared_ptr<void>& receivers(const Points& points) { return points.receivers_; }
    /// Points as a technique takes them: with the eye by which they face, if any.
    static Points seen_from(Points points, const std::optional<Float3>& eye) {
        points.eye_ = eye;
        return points;
    }
    static const std::optional<Float3>& eye(const Points& points) { return points.eye_; }
    static FacingInputs facing_inputs(const Device& device, const Points& points, const Facing& facing);
    static bool is_by_eye(const Facing& facing) { return facing.kind_ <= Facing::Kind::eye; }
    static FansOnDevice on_device(const VertexFans& fans) {
        const auto buffer = [](const std::shared_ptr<void>& memory) { return static_cast<cl_mem>(memory.get()); };
        return {buffer(fans.fans_), buffer(fans.corners_), buffer(fans.extended_), fans.triangles_};
    }
    /// One light by a technique. The points have their eye; facing by normals, winding or fans is the caller's.
    static Statistics run_light(Technique& technique, const Triangles& triangles, const Points& points,
                                const Light& light, const Visibility& visibility) {
        return technique.run_light(triangles, points, light, visibility);
    }
    /// Makes points; their buffers live as long as these points, or copies of them, do.
    static Points make_points(std::shared_ptr<void> positions, const PointLayout& layout, std::size_t count,
                              std::shared_ptr<void> receivers) {
        Points points;
        points.positions_ = std::move(positions);
        points.receivers_ = std::move(receivers);
        points.layout_ = layout;
        points.count_ = count;
        return points;
    }
};
inline cl::Session& session_of(const Device& device) { return Internals::session(device); }

/// A buffer that gnomon owns. It and its device live as long as any copy of the pointer; points to the cl_mem.
std::shared_ptr<void> shared_buffer(const Device& device, cl::Buffer buffer);

/// A copy of the data in such a buffer.
std::shared_ptr<void> uploaded(const Device& device, const void* data, std::size_t bytes);

std::size_t bytes_of(cl_mem memory);

/// Throws InvalidArgument unless one of Light's makers could have made the light (its xyzw is public).
void require_light(const Light& light);

/// Throws InvalidArgument if the points have an eye that is not finite.
void require_eye(const Points& points);

/// Throws InvalidArgument if the first floats of a buffer that a run writes, `name`, overlap one that it reads.
void require_apart(const Triangles& triangles, const Points& points, cl_mem written, std::size_t floats,
                   const std::string& name);

/// True if the first floats of two buffers share memory.
bool overlap(cl_mem a, std::size_t floats_a, cl_mem b, std::size_t floats_b);

/// Throws InvalidArgument unless a technique can run on these: a light, a finite eye, if any, and a visibility buffer
/// that is large enough and overlaps no input. Every technique's run begins with it.
void require_run(const Triangles& triangles, const Points& points, const Light& light, const Visibility& visibility);

/// The same for Technique::run_each_light(), which also needs a visibility of its own for each light.
void require_run_lights(const Triangles& triangles, const Points& points, std::span<const Light> lights,
                        std::span<const Visibility> visibilities);

/// A launch takes the layout in its parameters, and `vertices`. Whatever a triangle has is found by these two.
struct TriangleInputs : TrianglesLayout {
    cl_mem vertices;
    const Clusters* clusters;  ///< null if there are none
    bool has_cut_outs;         ///< behind the vertices (kernels/exact/cut_outs.h)
    bool is_raster = false;    ///< `vertices` is an implicit raster (implicit_inputs())

    /// A kernel that decides hits on triangles: of the program that reads cut-outs, or an implicit raster.
    cl::Kernel kernel(const char* file, const char* name) const {
        return {file, name, {.cut_outs = has_cut_outs, .raster = is_raster}};
    }
    /// The same for kernels of many lights, which have a program for point lights.
    cl::Kernel kernel_of_lights(const char* file, const char* name, bool are_positions) const {
        return {file, name, {.point_lights = are_positions, .cut_outs = has_cut_outs, .raster = is_raster}};
    }
};
TriangleInputs triangle_inputs(const Triangles& triangles);
/// Throws InvalidArgument unless the numbers of `what` (which are `kind`) come in groups of `each`.
void require_groups(std::size_t numbers, std::size_t each, const char* what, const char* kind = "floats");
/// Some triangles are masked or clear.
bool has_cut_outs(const Triangles& triangles);

struct PointInputs {
    PointsLayout layout;
    cl_mem positions;
    cl_mem receivers;                     ///< any buffer if the points have no receivers
    cl_mem footprints = nullptr;          ///< kernels/receivers/footprint.h, around the points; null: points are points
    std::size_t expected_footprints = 0;  ///< about as many as there are, and the same number in each run
    bool face_light = false;              ///< all points are known to face the light, and not to shadow themselves
};
/// `is_lifted`: known to be lifted off the triangles of the run, towards the eye by which they face.
PointInputs point_inputs(const Points& points, bool is_lifted = false);
inline PointInputs point_inputs(const Points& points, const Triangles& triangles) {
    const auto& eye = Internals::eye(points);
    return point_inputs(points, eye && points.is_lifted_off(triangles, *eye));
}

/// The rays of a camera, and where in a pixel its samples lie.
struct CameraSamples {
    PictureRays picture;
    cl_uint samples_per_pixel;  ///< as in TriangleSetupParams
    float first_sample;
};

struct ProjectionInput {
    ProjectionInput(const cl::Buffer& on_device, bool directional = false)
        : buffer(on_device), is_directional(directional) {}
    const cl::Buffer& buffer;
    bool is_directional;                    ///< known to be parallel
    const CameraSamples* camera = nullptr;  ///< of a camera's projection
};

}  // namespace gnomon
