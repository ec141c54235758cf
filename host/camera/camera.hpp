// SPDX-License-Identifier: MIT
// Stage camera: visibility buffer and shading points (kernels/camera/camera.h, kernels/camera/camera.cl). gnomon.hpp
// gives it the functions look(), read() and lift(); samples.cpp runs it for many samples per pixel.
#pragma once

#include "kernels/camera/camera.h"
#include "kernels/simd/projection.h"
#include "occluders/occluder_lists.hpp"
#include "query/inputs.hpp"

namespace gnomon {

/// The camera as kernels take it: a projection to pixels, the rays through any position in the picture, and the table
/// of exact rays through one sample of each pixel, RAY_FLOATS floats per column, then per row.
RayAxes ray_axes(const Camera& camera, std::uint32_t width, std::uint32_t height);
Projection camera_projection(const Camera& camera, std::uint32_t width, std::uint32_t height);
PictureRays picture_rays(const Camera& camera, std::uint32_t width, std::uint32_t height);
std::vector<float> camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, SampleOffset offset);

/// The part of the output buffers for one sample of every pixel: from `first` on in buffers for `count` points.
struct PointSlice {
    cl_mem positions;  ///< x of all points, then y, then z
    cl_mem receivers;
    std::size_t first, count;
};

/// A camera over a scene: its lists of triangles per tile are made once and serve every sample.
class CameraStage {
public:
    explicit CameraStage(const Device& device) : session_(session_of(device)) {}
    /// Sets the scene and the camera for the next runs, each at one of these offsets. The lists keep their memory; they
    /// leave out triangles that lie between all samples.
    void aim(const Triangles& triangles, const Camera& camera, std::uint32_t width, std::uint32_t height,
             std::span<const SampleOffset> offsets);
    /// Writes receivers and points of the sample at `offset` in every pixel. A sample takes the receiver of its pixel
    /// if the sample's ray meets it; else, or if pixel_receivers is null, the nearest triangle. Adds to `statistics`.
    void run(SampleOffset offset, cl_mem pixel_receivers, const PointSlice& out, Statistics& statistics);

    /// Makes the lists of triangles per tile, once, and their runs in order (bin_lists.h). Adds to `statistics`.
    void fit_lists(Statistics& statistics);
    const cl::Buffer& projection() const { return projection_; }
    const PictureRays& picture() const { return samples_.picture; }
    const TriangleSetup& setup() const { return lists_.setup(); }
    /// The counts of the frame whose lists fit_lists() made.
    const cl::Buffer& counters() const { return counters_; }
    const Bins& bins() const { return lists_.bins(); }
    std::uint32_t tiles_x() const { return (width_ + (1u << CAMERA_TILE_LOG2) - 1) >> CAMERA_TILE_LOG2; }
    std::uint32_t tiles_y() const { return (height_ + (1u << CAMERA_TILE_LOG2) - 1) >> CAMERA_TILE_LOG2; }

private:
    CameraParams params_of(SampleOffset offset, bool has_pixel_receivers, const PointSlice& out) const;
    bool check_lists(Statistics& statistics);
    bool filters(const CameraParams& params) const;
    void filter_receivers(const CameraParams& params, const PointSlice& out, Statistics& statistics);
    void find_receivers(const CameraParams& params, cl_mem pixel_receivers, const PointSlice& out,
                        Statistics& statistics);
    void find_in_long_lists(const CameraParams& params, cl_mem pixel_receivers, const PointSlice& out,
                            Statistics& statistics);
    void make_points(const CameraParams& params, const PointSlice& out, Statistics& statistics);
    void make_lists(Statistics& statistics, bool orders_runs);

    cl::Session& session_;
    TriangleInputs triangles_{};
    Camera camera_;
    std::uint32_t width_ = 0, height_ = 0;
    CameraSamples samples_{};
    cl::Buffer projection_, rays_, counters_;
    std::vector<float> written_rays_;  ///< to rays_: those of a camera that stands still are not written again
    OccluderLists lists_;
    cl::Buffer chunks_, found_;  ///< of long lists
    cl::Buffer open_pairs_;
    std::uint32_t open_capacity_ = 0, open_count_ = 0;
    bool fitted_ = false;
    std::uint32_t chunk_count_ = 0;  ///< of the lists that fitted
    std::uint32_t long_list_ = FIRST_LONG_LIST, next_long_list_ = FIRST_LONG_LIST;
};

/// Writes unit geometric normals facing the camera, 3 floats per pixel, packed; sky: 0. Makes room for them.
void camera_normals(const Device& device, const Triangles& triangles, const View& view, cl::Buffer& normals);

}  // namespace gnomon
