// SPDX-License-Identifier: MIT
// What a run reads and writes: triangles, points, their camera, visibility. Stable; each share() is experimental.
#pragma once

#include <optional>
#include <span>

#include <gnomon/device.hpp>

namespace gnomon {
class Clusters;        // private
class ImplicitRaster;  // private
}  // namespace gnomon

#pragma GCC visibility push(default)

namespace gnomon {

/// Receiver id of a point that lies on no triangle (and, in a view, of a pixel that shows the sky).
inline constexpr std::uint32_t no_receiver = 0xFFFFFFFFu;

/// A pinhole camera. Pixel (x, y), row 0 on top, looks along
///   forward + (2 (x + 0.5) / width - 1) aspect t right + (1 - 2 (y + 0.5) / height) t up,  t = tan(fov_y / 2).
/// There is no near or far plane: all triangles in front of the eye are seen. The axes are unit vectors; they need not
/// be orthogonal, but must span space.
struct Camera {
    Float3 eye{};
    std::array<double, 3> right{1, 0, 0};
    std::array<double, 3> up{0, 1, 0};
    std::array<double, 3> forward{0, 0, -1};
    double fov_y_radians = 1.0;

    /// Looks from `eye` at `target`; `up` is made orthogonal to the view. Throws InvalidArgument if eye and target
    /// coincide, `up` is parallel to the view, or fov_y_degrees is not between 0 and 180 (both exclusive).
    static Camera look_at(const Float3& eye, const Float3& target, const Float3& up, double fov_y_degrees);
};

/// The camera and the picture's size in pixels that a set of shading points came from: view-dependent fits need it.
struct PointsCamera {
    Camera camera;
    std::uint32_t width = 0, height = 0;
};

/// From this many triangles on, Triangles::keep_clusters() costs less time than it saves, even for one picture: the
/// camera and every batch of samples skip the clusters that they do not need.
inline constexpr std::size_t triangles_worth_clusters = 1u << 16;

// ---- Cut-outs: triangles with holes, by the alpha of a texture ------------------------------------------------------

/// What a texture coordinate outside of 0..1 stands for.
enum class TextureWrap : std::uint8_t { repeat, mirror, clamp };
/// The alpha between texels' centres: that of the nearest texel (of the greatest where a border is hit), or the exact
/// bilinear mean of four.
enum class TextureFilter : std::uint8_t { nearest, linear };

/// Row by row; the first texel is at (u, v) = (0, 0). Sides from 1 to 32768.
struct AlphaTexture {
    std::uint32_t width = 0, height = 0;
    std::span<const std::uint8_t> alpha;
};

inline constexpr std::uint32_t no_texture = 0xFFFFFFFFu;
inline constexpr std::uint32_t no_cut_out = 0xFFFFFFFFu;

/// A triangle of this material blocks, and is seen, at a point X only where texel(X) * factor * alpha of the corners at
/// X, all exact, is at least the cutoff: texel(X) >= 255 cutoff / factor, which is rounded once to a multiple of 2^-16.
/// A cutoff up to 0: everywhere; a cutoff above 1, or a factor up to 0: nowhere.
struct CutOutMaterial {
    std::uint32_t texture = no_texture;  ///< of CutOuts::textures; none: 255
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    TextureFilter filter = TextureFilter::linear;
    float cutoff = 0.5f;
    float alpha_factor = 1.0f;
};

/// The cut-outs of a scene, in the caller's memory (read by Triangles::upload(), not kept).
struct CutOuts {
    std::span<const std::uint32_t> material_of_triangle;  ///< one per triangle; no_cut_out: opaque
    std::span<const float> texture_coordinates;  ///< u, v of three corners per triangle; none: no texture is used
    std::span<const float> corner_alphas;        ///< three per triangle, 0 to 1, or none at all
    std::span<const CutOutMaterial> materials;
    std::span<const AlphaTexture> textures;

    CutOuts part(std::size_t first, std::size_t count) const;  ///< of some triangles
};

/// The same in buffers of the device's context: one value per element from the beginning, as in CutOuts.
struct CutOutBuffers {
    /// AlphaTexture in a buffer.
    struct Texture {
        std::uint32_t width = 0, height = 0;
        cl_mem alpha = nullptr;  ///< width * height bytes
    };
    cl_mem material_of_triangle = nullptr;
    cl_mem texture_coordinates = nullptr;  ///< null: no texture is used
    cl_mem corner_alphas = nullptr;        ///< null: none
    std::span<const CutOutMaterial> materials;
    std::span<const Texture> textures;
};

/// What became of the triangles that have a material: their sum is the number of these.
struct CutOutCounts {
    std::size_t masked = 0;  ///< the texture decides, hit by hit
    std::size_t opaque = 0;  ///< all over
    std::size_t clear = 0;   ///< all over: they block nothing and are never seen
    std::size_t unusable =
        0;  ///< of the opaque: corners that are NaN, or 2^30 texels or more away; alphas outside 0..1
};

// ---- Triangles ------------------------------------------------------------------------------------------------------

/// Ground of which z is the height: vertex (row, column) stands at (x[column], y[row], heights[row * x.size() +
/// column]). Square q = row * (x.size() - 1) + column has the triangles 2 q, with the edge from (row + 1, column) to
/// (row + 1, column + 1), and 2 q + 1, both counter-clockwise as seen from above.
struct Raster {
    std::span<const float> x, y;     ///< two or more each; both rise, or fall, from each value to the next
    std::span<const float> heights;  ///< NaN or infinite: triangles with this vertex are left out
    /// Diagonals join (row, column) and (row + 1, column + 1); else (row + 1, column) and (row, column + 1).
    bool joins_first_corner = false;
};

/// Triangles on the device: 9 consecutive float32 each (three world-space vertices). A triangle's id is its index. A
/// triangle with a NaN or infinite vertex casts no shadow and is never seen; Statistics counts it.
class Triangles {
public:
    /// Copies `vertices` (9 floats per triangle) to the device. Throws InvalidArgument if the size is no multiple of 9.
    static Triangles upload(const Device& device, std::span<const float> vertices);
    /// The same with cut-outs, which are copied, too: 28 bytes for each masked triangle, and the textures. Techniques
    /// that do not decide exactly take masked triangles for opaque ones (docs/techniques.md). Throws InvalidArgument if
    /// sizes do not match.
    static Triangles upload(const Device& device, std::span<const float> vertices, const CutOuts& cut_outs);
    /// The same from buffers, of which all is copied: 9 * count floats of `vertices` from `first_float` on, and the
    /// cut-outs. Waits for the queue, since the host finds the triangles that are opaque or clear all over. Throws
    /// InvalidArgument also if a buffer is too small or belongs to another context.
    static Triangles copy(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float,
                          const CutOutBuffers& cut_outs);
    /// Uses the caller's memory itself where device and host share memory, and copies it elsewhere. The caller must
    /// keep it, unchanged, while this handle or a copy of it exists. (Many drivers copy nothing only if the memory
    /// begins at a multiple of 4096 bytes.)
    static Triangles share(const Device& device, std::span<const float> vertices);
    /// Uses the caller's buffer (retained) from float `first_float` on. The caller must not write it during a run.
    static Triangles wrap(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float = 0);
    /// Copies a raster to the device, 4 bytes for each vertex. Technique::run_light_table() with frustum-traced reads
    /// it as it is, through a BVH of 4 bytes for each square, and by sweeps (20 more) where there is memory for these.
    /// What else reads the triangles has them written out, once for all copies of this handle: 72 bytes for each
    /// square. The same bits as those triangles. Throws InvalidArgument, as Raster says.
    static Triangles raster(const Device& device, const Raster& raster);

    /// For a mesh that does not change: builds boxes around clusters of 64 triangles (half a byte per triangle, on the
    /// device). Stages then skip clusters that a camera does not see or a light does not need, and do not read their
    /// vertices. Same bits. If neighbours in the buffer are far apart in the scene, a sorted copy is built too (40
    /// bytes per triangle, if there is room). Worth it from about two views or lights on. The caller promises not to
    /// write the vertices while this handle, or a later copy of it, is in use; after a change, call this again. Costs
    /// one pass over the triangles, or about ten with a copy.
    void keep_clusters(const Device& device);

    std::size_t count() const { return count_; }              ///< of triangles
    cl_mem buffer() const;                                    ///< of the vertices; not retained for the caller
    std::size_t first_float() const { return first_float_; }  ///< where the first vertex begins in buffer()
    const CutOutCounts& cut_out_counts() const { return cut_out_counts_; }  ///< zeros without cut-outs
    bool is_same_as(const Triangles& other) const;                          ///< of the same part of the same buffer

private:
    friend struct Internals;
    friend class Points;  // set_lifted_off() refers to the buffer

    std::shared_ptr<void> buffer_;
    std::shared_ptr<const Clusters> clusters_;
    std::shared_ptr<ImplicitRaster> raster_;  ///< in place of a buffer
    std::size_t count_ = 0;
    std::size_t first_float_ = 0;
    CutOutCounts cut_out_counts_;
};

/// Coordinate c (0..2) of point i has the index first + i * point_stride + c * coordinate_stride in a buffer of floats.
/// The default is packed xyz triples; structure of arrays for n points is {0, 1, n}.
struct PointLayout {
    std::size_t first = 0;
    std::size_t point_stride = 3;
    std::size_t coordinate_stride = 1;
};

/// Points on the host, for files and checks.
struct PointsOnHost {
    std::vector<float> position;          ///< 3 per point
    std::vector<std::uint32_t> receiver;  ///< one per point; no_receiver if the points have none
};

/// Shading points on the device: position, and optionally the id of the triangle that the point lies on (its receiver,
/// which never shadows it). A point with a NaN or infinite coordinate is absent: visibility 1, no work. That a point
/// faces away from a light is decided by the run's Facing; a receiver alone only excludes its triangle.
class Points {
public:
    Points() = default;  ///< none
    /// Copies `positions` (3 floats per point) and `receivers` (one per point, or none at all) to the device.
    static Points upload(const Device& device, std::span<const float> positions,
                         std::span<const std::uint32_t> receivers = {});
    /// As Triangles::share(), for both arrays.
    static Points share(const Device& device, std::span<const float> positions,
                        std::span<const std::uint32_t> receivers = {});
    /// Uses the caller's buffers (retained). `receivers` may be null: no point has one.
    static Points wrap(const Device& device, cl_mem positions, const PointLayout& layout, std::size_t count,
                       cl_mem receivers = nullptr);

    /// Sets the camera of the picture of width x height pixels that these points belong to. Facing::automatic() takes
    /// its eye. Shadow maps that are split or warped along the view need the camera; without it they fit the points
    /// alone. Views made by look() have it set.
    void set_camera(const Camera& camera, std::uint32_t width, std::uint32_t height) {
        camera_ = PointsCamera{camera, width, height};
        lifted_off_.reset();
    }
    const std::optional<PointsCamera>& camera() const { return camera_; }  ///< none until one is set
    /// The caller promises that no point lies on the far side of its receiver as `eye` sees it; receivers are ids in
    /// `triangles`. Runs whose points face by this eye then skip some tests of receivers, which saves time. Views made
    /// by look() have this set, for their camera's eye; it lasts until a camera is set. After a change of the
    /// triangles, call look() again.
    void set_lifted_off(const Triangles& triangles, const Float3& eye);
    bool is_lifted_off(const Triangles& triangles,
                       const Float3& eye) const;  ///< set_lifted_off() was called with these

    std::size_t count() const { return count_; }           ///< of points
    cl_mem positions() const;                              ///< as layout() describes
    cl_mem receivers() const;                              ///< null if no point has a receiver
    const PointLayout& layout() const { return layout_; }  ///< of positions()
    /// Waits for the queue and copies to the host.
    PointsOnHost read(const Device& device) const;

private:
    friend struct Internals;

    std::shared_ptr<void> positions_;
    std::shared_ptr<void> receivers_;
    PointLayout layout_;
    std::size_t count_ = 0;
    std::optional<Float3> eye_;  ///< during a run: the eye by which these points face
    std::optional<PointsCamera> camera_;
    std::weak_ptr<void> lifted_off_;  ///< the triangles' buffer
    std::size_t lifted_off_first_float_ = 0;
    Float3 lifted_towards_{};
};

/// Visibility per point, one float32 each: 1 lit, 0 in shadow; filtered techniques write values between.
class Visibility {
public:
    Visibility(const Device& device, std::size_t count);  ///< a new buffer of `count` floats
    /// Uses `count` floats of the caller's buffer (retained) from `first_float` on: the device writes the result there,
    /// and no copy goes through the host. first_float * 4 must be a multiple of the device's
    /// CL_DEVICE_MEM_BASE_ADDR_ALIGN / 8 (gnomon makes a sub-buffer). Throws InvalidArgument if it is not.
    static Visibility wrap(const Device& device, cl_mem buffer, std::size_t count, std::size_t first_float = 0);
    /// The results' place is `values`, which the caller must keep while this handle or a copy of it exists. They are
    /// there after fetch(), from then on until the next run; where device and host share memory, nothing is copied.
    static Visibility share(const Device& device, std::span<float> values);

    std::size_t count() const { return count_; }  ///< of values
    cl_mem buffer() const;                        ///< not retained for the caller
    /// Waits for the queue and copies to the host.
    std::vector<float> read() const;
    /// Waits for the queue and brings the values to the place that share() was given. Throws InvalidArgument if this
    /// was not made by share().
    void fetch() const;

private:
    Visibility(const Device& device, std::shared_ptr<void> buffer, std::size_t count);

    Device device_;
    std::shared_ptr<void> buffer_;
    std::size_t count_ = 0;
    float* shared_ = nullptr;  ///< the caller's
};

}  // namespace gnomon

#pragma GCC visibility pop
