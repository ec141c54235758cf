// SPDX-License-Identifier: MIT
// A run's inputs as the kernels take them.
#pragma once

#include "cl/session.hpp"
#include "kernels/simd/points.h"
#include "kernels/simd/projection.h"

namespace gnomon {

inline float4 float4_of(const std::array<float, 4>& v) { return {{v[0], v[1], v[2], v[3]}}; }

/// Opens to the library what the public types keep private.
struct Internals {
    static cl::Session& session(const Device& device) { return *device.session_; }
    static const Clusters* clusters(const Triangles& triangles) { return triangles.clusters_.get(); }
    static const std::shared_ptr<void>& receivers(const Points& points) { return points.receivers_; }
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

/// The same for Technique::run_lights(), which also needs a visibility of its own for each light.
void require_run_lights(const Triangles& triangles, const Points& points, std::span<const Light> lights,
                        std::span<const Visibility> visibilities);

/// A launch takes the layout in its parameters, and `vertices`. Whatever a triangle has is found by these two.
struct TriangleInputs : TrianglesLayout {
    cl_mem vertices;
    const Clusters* clusters;  ///< null if there are none
    bool has_cut_outs;         ///< behind the vertices (kernels/exact/cut_outs.h)

    /// A kernel that decides hits on triangles: with cut-outs, of the program that reads them.
    cl::Kernel kernel(const char* file, const char* name) const { return {file, name, {.cut_outs = has_cut_outs}}; }
    /// The same for kernels of many lights, which have a program for point lights.
    cl::Kernel kernel_of_lights(const char* file, const char* name, bool are_positions) const {
        return {file, name, {.point_lights = are_positions, .cut_outs = has_cut_outs}};
    }
};
TriangleInputs triangle_inputs(const Triangles& triangles);
/// Throws InvalidArgument if the floats are no multiple of 9.
void require_whole_triangles(std::span<const float> vertices);
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
/// `is_lifted`: the points are known to be lifted off the triangles of the run (PointsLayout::is_lifted).
PointInputs point_inputs(const Points& points, bool is_lifted = false);

/// The rays of a camera, and where in a pixel its samples lie.
struct CameraSamples {
    PictureRays picture;
    cl_uint samples_per_pixel;  ///< as in TriangleSetupParams
    float first_sample;
};

/// A projection on the device.
struct ProjectionInput {
    ProjectionInput(const cl::Buffer& on_device, bool directional = false)
        : buffer(on_device), is_directional(directional) {}
    const cl::Buffer& buffer;
    bool is_directional;                    ///< known to be parallel
    const CameraSamples* camera = nullptr;  ///< of a camera's projection
};

}  // namespace gnomon
