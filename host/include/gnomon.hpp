// SPDX-License-Identifier: MIT
// gnomon: exact hard shadows as OpenCL kernels. The public face of the library.
//
//   gnomon::Device device;                                        // or your own cl_context and queue
//   auto triangles = gnomon::Triangles::upload(device, nine_floats_each);
//   auto points    = gnomon::Points::upload(device, three_floats_each);
//   auto technique = gnomon::make_technique("frustum-traced", device);
//   gnomon::Visibility visibility(device, points.count());
//   technique->run(triangles, points, gnomon::Light::directional({0, -1, 0}), visibility);
//   std::vector<float> lit = visibility.read();                   // 1 lit, 0 in shadow
//
// A point is "in shadow" by the visibility contract of docs/numerics.md, which is decided in exact real arithmetic on
// the float32 inputs: the same bits on every device. Objects are cheap handles (shared ownership). One Device and the
// objects made from it may be used from one thread at a time. A failure throws one of the exceptions below. The library
// never prints, never exits, and has no global state but the OpenCL functions that it has loaded (and gnomon.h's error
// texts, one per thread).
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Private types of the library.
namespace gnomon {
namespace cl {
class Buffer;
class Session;
}  // namespace cl
class Clusters;
struct Internals;
}  // namespace gnomon

// The library is compiled with hidden visibility (host/CMakeLists.txt): a shared library exports only the declarations
// from here on. This is a pragma since clang 14 does not apply a namespace's attribute to the namespace's functions.
#pragma GCC visibility push(default)

namespace gnomon {

/// Three float32 coordinates: world space, in the scene's unit (glTF: metres), +Y up, right-handed.
using Float3 = std::array<float, 3>;

/// Receiver id of a point that lies on no triangle (and, in a view, of a pixel that shows the sky).
inline constexpr std::uint32_t no_receiver = 0xFFFFFFFFu;

/// "MAJOR.MINOR.PATCH".
std::string_view version();

// ---- Errors ---------------------------------------------------------------------------------------------------------

/// Base class of all exceptions that the library throws. what() is one sentence that names the cause and, where there
/// is one, the remedy.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An argument outside its stated range (sizes that do not match, a zero direction, an unknown setting).
class InvalidArgument : public Error {
public:
    using Error::Error;
};

/// No device fits: none is installed, none has that name, or the named device lacks a feature that gnomon needs.
class DeviceNotFound : public Error {
public:
    using Error::Error;
};

/// An OpenCL call failed. Carries the call, the error's name ("CL_INVALID_VALUE") and, for builds, the compiler's log.
class OpenClError : public Error {
public:
    /// what(): "CALL failed with NAME (CODE): REMEDY", then the build log.
    OpenClError(std::string_view call, cl_int code, std::string build_log = {}, std::string_view remedy = {});
    cl_int code() const noexcept { return code_; }                        ///< CL_INVALID_VALUE and so on
    const std::string& build_log() const noexcept { return build_log_; }  ///< the compiler's; empty if no build failed

private:
    cl_int code_;
    std::string build_log_;
};

/// The device has too little memory for the call (CL_MEM_OBJECT_ALLOCATION_FAILURE and similar codes, or the limit
/// given to Device). No object is left in a partial state: the library stays usable.
class OutOfDeviceMemory : public OpenClError {
public:
    /// As OpenClError.
    OutOfDeviceMemory(std::string_view call, cl_int code, std::string_view remedy = "ask for fewer points at once")
        : OpenClError(call, code, {}, remedy) {}
};

// ---- Devices --------------------------------------------------------------------------------------------------------

/// gnomon links no OpenCL library: it loads one when it first needs it. The file that is loaded is the one that the
/// environment variable GNOMON_OPENCL_LIBRARY names, else `library`, else the library that the program itself links,
/// else the system's libOpenCL.so.1. Only programs that must choose the file call this; after the first success it does
/// nothing. Throws DeviceNotFound with the cause and the remedy.
void load_opencl(const std::string& library = {});

/// One OpenCL device of this machine, as `gnomon devices` lists it.
struct DeviceDescription {
    cl_platform_id platform_id = nullptr;
    cl_device_id device_id = nullptr;
    std::string selector;  ///< "P:D", platform and device index: what Device and --device accept
    std::string platform;  ///< platform name, e.g. "Portable Computing Language"
    std::string name;      ///< device name
    std::string vendor;
    std::string driver_version;
    std::string opencl_version;    ///< CL_DEVICE_VERSION
    std::string opencl_c_version;  ///< CL_DEVICE_OPENCL_C_VERSION
    std::string type;              ///< "CPU", "GPU", "accelerator" or "custom"
    std::uint32_t compute_units = 0;
    std::uint64_t global_memory_bytes = 0;
    std::uint64_t largest_allocation_bytes = 0;
    bool has_fp64 = false;
    bool shares_host_memory = false;  ///< CL_DEVICE_HOST_UNIFIED_MEMORY: share() copies nothing
    std::string lacks;                ///< empty if the device can be used, else the features that it lacks
    std::string note;         ///< of an open device: features that its start-up check switched off, and why; else empty
    bool is_default = false;  ///< a Device without a selector opens this one
    std::string why_default;  ///< for the default: the rule that chose it
};

/// All devices of all platforms; empty if there is no OpenCL at all. Never throws for a broken driver: a platform that
/// fails a query is left out.
std::vector<DeviceDescription> devices();

/// How a Device is opened.
struct DeviceOptions {
    /// Time every kernel by events (Statistics then has device times). Slows small launches: off for wall-clock times.
    bool profile = false;
    /// Refuse to allocate more than this many bytes on the device; 0: gnomon sets no limit.
    std::uint64_t memory_limit_bytes = 0;
    /// Hide double precision: the wide filter is skipped, and more pairs reach the exact predicate. Same bits.
    bool hide_fp64 = false;
    /// Work-group size of every kernel, 0: chosen per device. Same bits for every size.
    std::uint32_t work_group_size = 0;
    /// Use the kernels made for GPUs (one point per work-item, cooperating work-groups) on a CPU as well, as the
    /// environment variable GNOMON_GPU_KERNELS does: for tests and measurements. Same bits.
    bool gpu_kernels = false;
};

/// The builds that a Device's runs waited for before their kernels ran. A platform with its own cache (PoCL) compiles
/// or loads a kernel when it is first launched: that wait is counted too if the queue can time it.
struct KernelBuilds {
    std::uint32_t programs = 0;    ///< compiled or loaded
    std::uint32_t from_cache = 0;  ///< loaded from gnomon's cache on disk; 0 on a platform with its own cache
    double ms = 0;
};

/// A device, its context and in-order queue, and the compiled kernels. Building the kernels takes most of the time of a
/// first start; they are cached on disk for later starts.
class Device {
public:
    /// Opens the device that `selector` names: "P:D" (indices as in devices()), or a part of the device's or platform's
    /// name in any case; empty: the environment variable GNOMON_DEVICE, else the default (the first usable GPU, else
    /// the first usable CPU). Throws DeviceNotFound with the list of the devices.
    explicit Device(std::string_view selector = {}, const DeviceOptions& options = {});
    /// Uses the caller's context and queue (both are retained). The queue must be in-order; kernels and copies are
    /// enqueued on it, and results are complete when the queue has executed them. The queue decides whether kernels are
    /// profiled; `options` does not. Throws InvalidArgument if context and queue do not belong together, DeviceNotFound
    /// if the queue's device cannot be used.
    Device(cl_context context, cl_command_queue queue, const DeviceOptions& options = {});

    const DeviceDescription& description() const;  ///< with what its start-up check found
    cl_context context() const;                    ///< not retained for the caller
    cl_command_queue queue() const;                ///< in-order; not retained for the caller
    /// Waits until the device has executed all that was enqueued.
    void finish() const;
    /// Bytes of device memory that gnomon's own buffers occupy now, and the largest number so far.
    std::uint64_t memory_bytes() const;
    /// The largest memory_bytes() so far.
    std::uint64_t peak_memory_bytes() const;
    /// The builds since the device was opened. Waits for the queue if kernels were launched for the first time since
    /// the last call.
    KernelBuilds kernel_builds() const;

private:
    friend struct Internals;

    std::shared_ptr<cl::Session> session_;
};

// ---- Inputs and outputs ---------------------------------------------------------------------------------------------

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
    static Triangles copy(const Device& device, cl_mem vertices, std::size_t count, const CutOutBuffers& cut_outs,
                          std::size_t first_float = 0);
    /// Uses the caller's memory itself where device and host share memory, and copies it elsewhere. The caller must
    /// keep it, unchanged, while this handle or a copy of it exists. (Many drivers copy nothing only if the memory
    /// begins at a multiple of 4096 bytes.)
    static Triangles share(const Device& device, std::span<const float> vertices);
    /// Uses the caller's buffer (retained) from float `first_float` on. The caller must not write it during a run.
    static Triangles wrap(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float = 0);

    /// For a mesh that does not change: builds boxes around clusters of 64 triangles (half a byte per triangle, on the
    /// device). Stages then skip clusters that a camera does not see or a light does not need, and do not read their
    /// vertices. Same bits. If neighbours in the buffer are far apart in the scene, a sorted copy is built too (40
    /// bytes per triangle, if there is room). Worth it from about two views or lights on. The caller promises not to
    /// write the vertices while this handle, or a later copy of it, is in use; after a change, call this again. Costs
    /// one pass over the triangles, or about ten with a copy.
    void keep_clusters(const Device& device);
    /// Frees the clusters: the state is that from before keep_clusters().
    void forget_clusters() { clusters_.reset(); }

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

/// Shading points on the device: position, and optionally the id of the triangle that the point lies on (its receiver,
/// which never shadows it). A point with a NaN or infinite coordinate is absent: visibility 1, no work.
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

    /// From here on, a point is backfacing if its receiver's plane separates the light from this eye or contains the
    /// light: visibility 0 by definition of shading, decided exactly, no work. look() sets the eye.
    void set_eye(const Float3& eye) {
        eye_ = eye;
        lifted_off_.reset();
    }
    const std::optional<Float3>& eye() const { return eye_; }  ///< none until one is set
    /// Sets the camera of the picture of width x height pixels that these points belong to, and the eye. Shadow maps
    /// that are split or warped along the view need the camera; without it they fit the points alone. Views made by
    /// look() have it set.
    void set_camera(const Camera& camera, std::uint32_t width, std::uint32_t height) {
        camera_ = PointsCamera{camera, width, height};
        set_eye(camera.eye);
    }
    const std::optional<PointsCamera>& camera() const { return camera_; }  ///< none until one is set
    /// The caller promises that no point lies on the far side of its receiver as the eye sees it; receivers are ids in
    /// `triangles`. Some tests of receivers are then skipped, which saves time. Views made by look() have this set; it
    /// lasts until an eye or a camera is set. After a change of the triangles, call look() again.
    void set_lifted_off(const Triangles& triangles);
    bool is_lifted_off(const Triangles& triangles) const;  ///< set_lifted_off() was called with these triangles

    std::size_t count() const { return count_; }           ///< of points
    cl_mem positions() const;                              ///< as layout() describes
    cl_mem receivers() const;                              ///< null if no point has a receiver
    const PointLayout& layout() const { return layout_; }  ///< of positions()

private:
    friend struct Internals;

    std::shared_ptr<void> positions_;
    std::shared_ptr<void> receivers_;
    PointLayout layout_;
    std::size_t count_ = 0;
    std::optional<Float3> eye_;
    std::optional<PointsCamera> camera_;
    std::weak_ptr<void> lifted_off_;  ///< the triangles' buffer
    std::size_t lifted_off_first_float_ = 0;
};

/// Points on the host, for files and checks.
struct PointsOnHost {
    std::vector<float> position;          ///< 3 per point
    std::vector<std::uint32_t> receiver;  ///< one per point; no_receiver if the points have none
};
PointsOnHost read(const Device& device, const Points& points);  ///< waits for the queue

/// Visibility per point, one float32 each: 1 lit, 0 in shadow; filtered techniques write values between.
class Visibility {
public:
    Visibility(const Device& device, std::size_t count);  ///< a new buffer of `count` floats
    /// Uses `count` floats of the caller's buffer (retained) from `first_float` on: the device writes the result there,
    /// and no copy goes through the host. first_float * 4 must be a multiple of the device's
    /// CL_DEVICE_MEM_BASE_ADDR_ALIGN / 8 (gnomon makes a sub-buffer), else the constructor throws InvalidArgument.
    Visibility(const Device& device, cl_mem buffer, std::size_t count, std::size_t first_float = 0);
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
    Device device_;
    std::shared_ptr<void> buffer_;
    std::size_t count_ = 0;
    float* shared_ = nullptr;  ///< the caller's
};

/// A directional light or a point light. Float32 as given, never normalised.
struct Light {
    std::array<float, 4> xyzw{};  ///< w = 0: minus the direction of travel; w = 1: the position
    bool is_directional() const { return xyzw[3] == 0.0f; }  ///< else it is a point light

    /// A directional light that travels along `direction`. Throws InvalidArgument if zero or not finite.
    static Light directional(const Float3& direction);
    /// A point light at `position`, in the scene's unit. Throws InvalidArgument if not finite.
    static Light positional(const Float3& position);
};

// ---- World coordinates ----------------------------------------------------------------------------------------------

/// float64 coordinates, for example of a national grid, as float32 without loss: each is snapped once to a whole number
/// of steps, floor(x / step + 1/2), and stored as its distance from an origin on the lattice. A distance of up to 2^24
/// steps is a float32 value, so nothing rounds again, and since all answers are exact and do not change when everything
/// moves by the same vector, they do not depend on the origin: one scene, cut into tiles with origins of their own,
/// gives the same bits as a whole. A directional light is rounded once, for the world; a point light is snapped too.
/// docs/numerics.md, 13, has the proofs.
struct WorldLattice {
    int exponent = -10;                    ///< the step is 2^exponent, from -100 to 100
    std::array<std::int64_t, 3> origin{};  ///< in steps; all positions are below 2^46 steps

    /// The step, in the unit of the world's coordinates.
    double step() const;
    /// A lattice of this step with the origin nearest the centre of the finite positions (3 numbers each). Throws
    /// InvalidArgument if the step is out of range.
    static WorldLattice around(std::span<const double> positions, int exponent);
    /// The finest step at which the positions lie within 2^23 steps of the origin: half the range, so that points
    /// around the scene fit too.
    static WorldLattice fit(std::span<const double> positions);

    /// What snap() returns.
    struct Snapped {
        std::vector<float> positions;  ///< relative to the origin; NaN where a position is not finite
        double largest_move = 0;       ///< of any coordinate: at most half a step
    };
    /// Snaps positions (3 numbers each). Throws InvalidArgument with the first that lies more than 2^24 steps from the
    /// origin, and the finest step that fits.
    Snapped snap(std::span<const double> positions) const;
    /// Snaps points that lie on a surface so that this surface does not shadow them: moves each by `lift_steps` steps
    /// along its normal (3 numbers each, of any length, of the surface before snapping), then snaps. If the surface was
    /// flat, and the point within sqrt(3)/2 steps of it, no snapped triangle of it meets a ray from the point to the
    /// normal's side. Decide facing by the same normal. Throws as snap() does, or if a normal is zero or not finite.
    std::vector<float> lift(std::span<const double> positions, std::span<const double> normals) const;
    /// What snapping does to each of these triangles (9 numbers each): it leaves them without area, turns them over (by
    /// more than a right angle), or tilts them by more than `degrees`, 0 to 90. Triangles that have no area before, or
    /// are not finite, are `none`. Throws as snap() does.
    enum class Change : std::uint8_t { none, zero_area, turned_over, tilted };
    /// One value for each triangle.
    std::vector<Change> changes(std::span<const double> triangles, double degrees = 1) const;
    /// For each corner of these triangles (9 numbers each) another triangle that it touches: one within a step of the
    /// corner, before snapping, that has no corner there, after snapping (a T-junction, a wall that stands on terrain,
    /// tiles of two triangulations); no_receiver if there is none, the nearest if there are several. Such a corner is
    /// to be lifted off that triangle as a point on its surface, since snapping may have put the corner below it. Some
    /// seconds for a million triangles. Throws as snap() does.
    std::vector<std::uint32_t> touched_triangles(std::span<const double> triangles) const;
    /// The world's coordinates of a snapped position, exactly.
    std::array<double, 3> world_of(const Float3& position) const;
    /// Snapped positions relative to the origin of another lattice of the same step, exactly. Throws InvalidArgument if
    /// the steps differ, or a position lies more than 2^24 steps from the new origin.
    std::vector<float> rebased(std::span<const float> positions, const WorldLattice& other) const;

    /// A vertex, a point's own error and its snapping move by at most sqrt(3)/2 steps each: 3 sqrt(3)/2 = 2.598...
    static constexpr double lift_steps = 2.625;

private:
    Float3 snapped(const double* position) const;  ///< NaN if it is not finite or out of range
};

// ---- Statistics -----------------------------------------------------------------------------------------------------

/// One stage of one run.
struct StageStatistics {
    std::string name;
    double device_ms = 0;  ///< sum of its kernels by events; 0 unless the device was opened with `profile`
    /// Host time without the building of kernels: with `profile` until the device has finished the stage, else until
    /// its kernels are enqueued (this time contains no execution of kernels).
    double wall_ms = 0;
    std::string skipped;  ///< why it did not run, empty if it did
};

/// The work of one run. Names are stable, in snake_case, and appear unchanged in stats.json.
struct Statistics {
    std::vector<StageStatistics> stages;
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    /// Host time from the call until the device has finished the run, the building of kernels included.
    double total_wall_ms = 0;
    std::uint64_t device_memory_bytes = 0;  ///< gnomon's own buffers during the run, without the caller's

    /// The count of that name, 0 if there is none.
    std::uint64_t count(std::string_view name) const;
};

// ---- Camera ---------------------------------------------------------------------------------------------------------

/// The offset of a sample from its pixel's centre, in 1/64 pixel, x to the right and y down, each from -32 to 31.
struct SampleOffset {
    int x = 0, y = 0;
};

/// The view of a camera: per pixel (row by row from the top) the nearest triangle and the shading point on it.
class View {
public:
    std::uint32_t width = 0, height = 0;
    Points points;          ///< width * height; absent (NaN) where the pixel shows the sky
    Statistics statistics;  ///< of the camera stages
};

/// Runs the camera stages: visibility buffer, then shading points, lifted off their receiver by a proven bound. Throws
/// InvalidArgument if width or height is 0 or over 16384, or if the camera's members break its rules.
View look(const Device& device, const Triangles& triangles, const Camera& camera, std::uint32_t width,
          std::uint32_t height);

/// look() for picture after picture. Keeps the lists and buffers of the last picture: the next one of this size
/// allocates nothing, and repeats no stage because a list was too short. Same bits.
class CameraPass {
public:
    explicit CameraPass(const Device& device);  ///< allocates nothing before the first look()
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
/// move. The result shares the receivers and has `eye` set. Throws InvalidArgument if there are no receivers.
Points lift(const Device& device, const Triangles& triangles, const Points& points, const Float3& eye);

/// A view on the host, for pictures and files.
struct ViewOnHost {
    std::vector<float> position;          ///< 3 per pixel; sky: 0
    std::vector<float> normal;            ///< 3 per pixel, unit geometric normal facing the camera; sky: 0
    std::vector<std::uint32_t> receiver;  ///< sky: no_receiver
};
ViewOnHost read(const Device& device, const Triangles& triangles, const View& view);  ///< waits for the queue

/// Base colours for shade(): one material id per triangle, and linear RGB per material.
struct Materials {
    std::vector<std::uint32_t> triangle_material;
    std::vector<Float3> base_color;
};

/// An image of base colours: 8-bit sRGB with unassociated alpha, 4 bytes per texel, row by row; the first texel is at
/// (u, v) = (0, 0). Sides from 1 to 32768.
struct ColorTexture {
    std::uint32_t width = 0, height = 0;
    std::span<const std::uint8_t> rgba;
};
/// How a material takes its texture. Its colours are filtered in linear light over the pixel's area in it, through all
/// levels of half the size; `filter` is for texels larger than pixels.
struct ColorTextureUse {
    std::uint32_t texture = no_texture;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    TextureFilter filter = TextureFilter::linear;
    bool weigh_by_alpha = false;  ///< clear texels give no colour to their neighbours; for cut-outs
};
/// What surfaces show beside the colours of their materials. Refers to the caller's arrays; each may be empty.
struct SurfaceDetail {
    std::span<const float> texture_coordinates{};     ///< u, v of the corners, 6 per triangle
    std::span<const float> corner_colors{};           ///< linear RGB of the corners, 9 per triangle: a factor
    std::span<const std::uint32_t> corner_normals{};  ///< pack_normal() of the corners, 3 per triangle; 0: none
    std::span<const ColorTextureUse> texture_uses{};  ///< one per material
    std::span<const ColorTexture> textures{};
};
/// A normal of any length in 32 bits, to .01 degrees (the octahedral map of Meyer et al. 2010). 0 for one that is 0 or
/// not finite.
std::uint32_t pack_normal(const Float3& normal);

/// What Surfaces::read() returns: 3 floats per pixel each.
struct SurfacesOnHost {
    std::vector<float> albedo;  ///< linear RGB per pixel; sky: 0
    std::vector<float> normal;  ///< unit shading normal on the eye's side of the triangle; sky: 0
};
/// The colour textures of a view on the device, for the next view: give the same object to both.
struct SurfaceTextures {
    struct OnDevice;
    std::shared_ptr<const OnDevice> on_device;
};
/// The surfaces of a view on the device: albedo (material x vertex colours x texture) and shading normal (interpolated;
/// without corner normals the triangle's own) at each pixel's centre. Visibility does not depend on them.
class Surfaces {
public:
    /// Only the textures that the view shows are uploaded. If they do not fit into the device's memory, the finest
    /// levels of all are left out. Those of `kept` are used again if they are of the same arrays, whose contents must
    /// be as they were. Throws InvalidArgument if arrays and numbers do not fit together.
    Surfaces(const Device& device, const Triangles& triangles, const View& view, const Materials& materials,
             const SurfaceDetail& detail = {}, SurfaceTextures* kept = nullptr);
    std::size_t count() const;              ///< pixels
    cl_mem normals() const;                 ///< the shading normals, 3 floats per pixel
    std::uint64_t texture_bytes() const;    ///< device memory of the textures
    std::uint32_t left_out_levels() const;  ///< the finest ones, of each texture; 0: none
    /// `materials`: those given to the constructor.
    SurfacesOnHost read(const Materials& materials) const;

    struct Inside;  ///< for the library's own use
    const Inside& inside() const { return *inside_; }

private:
    std::shared_ptr<const Inside> inside_;
};

/// How shade() exposes, and where the sky lights.
struct ShadeOptions {
    /// All light times 2^this. None: metered, so that 95 % of the surfaces' pixels are no brighter than .8.
    std::optional<double> exposure_ev = 0;
    /// For each pixel the part of the sky's light that reaches it, 1 for a free horizontal surface. Empty: ambient
    /// light everywhere.
    std::span<const float> sky_shares{};
};
/// What shade() returns: width * height pixels.
struct Picture {
    std::vector<std::uint8_t> rgba;  ///< 8-bit sRGB, 4 bytes per pixel
    double exposure_ev = 0;          ///< as given or metered
};
/// Lambert with visibility, plus ambient light, times the exposure: the sum over the lights, each as bright as the
/// others. Where normals are interpolated, each cosine is shifted, so that a light fades out before its triangle is
/// backfacing (the shadow terminator; as appleseed and Cycles do). Colours up to .8 stay as they are, brighter ones
/// follow the curve of Khronos' PBR Neutral tone mapper. visibilities[i] belongs to lights[i]: throws InvalidArgument
/// if the two numbers differ.
Picture shade(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
              const ShadeOptions& options = {});
/// The same with base colours alone, as 8-bit sRGB, 4 bytes (RGBA) per pixel.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                std::span<const Visibility> visibilities, const Materials& materials,
                                std::span<const Light> lights);
/// The same for one light.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                const Visibility& visibility, const Materials& materials, const Light& light);

// ---- Many lights ----------------------------------------------------------------------------------------------------

/// Index of no light.
inline constexpr std::uint32_t no_light = 0xFFFFFFFFu;

/// A table of lights, each with a weight. Sums of weights are exact: each weight is rounded once to a whole number
/// times 2^exponent(), where the exponent depends on the largest weight and the number of lights alone, and whole
/// numbers are added. So a sum does not depend on the order of the lights, on the device, or on how the work was
/// divided.
class Lights {
public:
    Lights() = default;
    /// `weights`: one per light, negative ones too, or none at all: 1 each. Throws InvalidArgument with the index of
    /// the first light that no maker of Light could have made, or of the first weight that is NaN or infinite, or if
    /// the numbers differ.
    explicit Lights(std::vector<Light> lights, std::vector<float> weights = {});

    std::size_t count() const { return lights_.size(); }                    ///< of lights
    std::span<const Light> lights() const { return lights_; }               ///< in the order in which they were given
    std::span<const float> weights() const { return weights_; }             ///< one per light, as given or 1
    std::span<const std::int64_t> whole_weights() const { return whole_; }  ///< one per light, in units of 2^exponent()
    int exponent() const { return exponent_; }                              ///< of whole_weights()
    /// The most by which a weight was rounded.
    double largest_rounding() const { return largest_rounding_; }

private:
    std::vector<Light> lights_;
    std::vector<float> weights_;
    std::vector<std::int64_t> whole_;
    int exponent_ = 0;
    double largest_rounding_ = 0;
};

/// A disk in the sky, such as the sun's (0.533 degrees across): directional lights around the one that travels along
/// `direction`, weight 1 each. Light i of n lies at sqrt((i + 1/2) / n) of the disk's radius, i golden angles around
/// its centre (Vogel, "A better way to construct the sunflower head", 1979). Throws InvalidArgument if the direction is
/// zero or not finite, the angle not between 0 and 90 degrees (exclusive), or `samples` 0.
Lights sun_disk(const Float3& direction, double angle_degrees, std::uint32_t samples);
/// A parallelogram that shines: point lights at corner + a edge_a + b edge_b, weight 1 each, where (a, b) for light i
/// of n is ((i + 1/2) / n, the i-th number of van der Corput's sequence in base 2) (Hammersley's points). Throws
/// InvalidArgument if a coordinate is not finite, or `samples` 0.
Lights area_light(const Float3& corner, const Float3& edge_a, const Float3& edge_b, std::uint32_t samples);
/// The sky's hemisphere around `up` in `division`^2 times as many patches as Tregenza's 145 ("Subdivision of the sky
/// hemisphere for luminance measurements", 1987), as Reinhart divides each: 145, 577, 1297 ... directional lights from
/// the patches' centres. A weight is the patch's solid angle times the cosine of its angle to `up`, over pi: the
/// weights' sum is nearly 1. The first patch of each row lies at the azimuth of `north`. Throws InvalidArgument if `up`
/// or `north` is zero or not finite, the two are parallel, or the division is not from 1 to 16.
Lights sky_patches(const Float3& up, const Float3& north, std::uint32_t division = 1);

/// What a run over many lights writes; all buffers are the caller's, and one that is null is not written. For n points
/// and m lights:
struct LightsOutputs {
    cl_mem bits = nullptr;       ///< uint32, n rows of ceil(m / 32): light l is bit l % 32 of word l / 32; 1 lit
    cl_mem counts = nullptr;     ///< uint32, n: the number of lights that reach the point
    cl_mem sums = nullptr;       ///< float64, n: the sum of their weights, exact before this one rounding
    cl_mem first_lit = nullptr;  ///< uint32, n: the smallest index of these, or no_light
    cl_mem last_lit = nullptr;   ///< uint32, n: the largest
};

/// How a run over many lights goes. A point that has a side of a surface is backfacing for each light that is not
/// strictly on it, decided exactly: the side of points.eye(), or else, where given, of its normal, or the front of its
/// receiver. A receiver alone only excludes its triangle: without a side, a point behind its surface may be lit.
struct LightsOptions {
    bool front = false;        ///< counter-clockwise vertices show a receiver's front (as face_by_winding)
    cl_mem normals = nullptr;  ///< a normal per point (as face_by_normals)
    PointLayout normals_layout{};
    /// `sums` adds each weight times max(0, n . l), at most 1, with the light's unit direction l and the normal n as it
    /// is, in float32: x + y + z of the three products, each operation rounded once; times the weight, rounded once;
    /// and that rounded once to a whole number times 2^exponent(). Needs normals and directional lights.
    bool cosines = false;
    /// Called now and then with the part that is done, 0 to 1, after the device has finished it. False ends the run
    /// early: it throws Cancelled.
    std::function<bool(double)> progress{};
};

/// A progress function ended the run. The outputs' contents are not defined.
class Cancelled : public Error {
public:
    using Error::Error;
};

/// The outputs on the host.
struct LightsOnHost {
    std::vector<std::uint32_t> bits, counts, first_lit, last_lit;
    std::vector<double> sums;
    Statistics statistics;
};
/// Which outputs run_lights_to_host() returns.
struct LightsWanted {
    bool bits = false, counts = false, sums = false, first_lit = false, last_lit = false;
};
class Technique;
/// Technique::run() over many lights, with outputs on the host.
LightsOnHost run_lights_to_host(Technique& technique, const Triangles& triangles, const Points& points,
                                const Lights& lights, const LightsWanted& wanted, const LightsOptions& options = {});
/// Soft shadows: writes to `mean` the share of the lights that reach each point, their number by lights.count(),
/// rounded once; weights are not read. Without lights it is 0. Throws as Technique::run() over many lights does, or if
/// `mean` has fewer entries than there are points.
Statistics run_mean(Technique& technique, const Triangles& triangles, const Points& points, const Lights& lights,
                    const Visibility& mean, const LightsOptions& options = {});

// ---- Techniques -----------------------------------------------------------------------------------------------------

/// A setting of a technique, as `gnomon techniques` lists it and --set changes it.
struct SettingDescription {
    std::string name;
    std::string default_value;
    std::string meaning;  ///< one line with range and unit
};

/// One way to compute visibility. All share this interface, so one benchmark, viewer and test harness serves all.
class Technique {
public:
    virtual ~Technique() = default;
    /// The device that it was made for.
    virtual const Device& device() const = 0;
    /// Writes visibility (points.count() floats) and returns the statistics. Waits only where a buffer must grow; the
    /// visibility is complete when the device's queue has executed the run. Throws InvalidArgument if visibility has
    /// fewer entries than there are points or overlaps an input, or if the light is neither directional nor a point
    /// light.
    virtual Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                           const Visibility& visibility) = 0;
    /// Prepares the light: stores the data that depend on these triangles and this light alone, so that later runs with
    /// both do less work (a scene that does not change while the camera moves). Same bits, prepared or not. Runs with
    /// other triangles or another light do not use the prepared light and do not change it. The caller promises not to
    /// change the triangles' buffer until forget(), set(), another prepare() or the technique's end; each of these
    /// frees the memory, which counts in device_memory_bytes of every run until then. If points lie far outside the
    /// triangles' bounds or far below their own receiver, the run ignores the prepared light; the count
    /// prepared_fallback_points is the number of such points. Most techniques store nothing. Returns the statistics.
    /// Throws as run() does; the light is not prepared then.
    virtual Statistics prepare(const Triangles& triangles, const Light& light);
    /// Frees the prepared light.
    virtual void forget() {}
    /// run() for several lights and the same points: visibilities[i] belongs to lights[i] and has the same bits as from
    /// run(). Work that all lights share is done once where the technique can. Returns the statistics of each light.
    /// Throws InvalidArgument if the numbers of visibilities and lights differ, or two visibilities overlap.
    virtual std::vector<Statistics> run_lights(const Triangles& triangles, const Points& points,
                                               std::span<const Light> lights, std::span<const Visibility> visibilities);
    /// Answers all lights of a table for all points at once. Each bit is that of run() for the one light (a technique
    /// with values between 0 and 1: at least 1/2), and of face_by_normals() or face_by_winding() where a side is given.
    /// frustum-traced takes the faster of several ways (its setting many-lights). Never stores points x lights values:
    /// the points pass in parts. Waits for the device. Throws as run() does, or if a buffer is too small,
    /// InvalidArgument.
    virtual Statistics run(const Triangles& triangles, const Points& points, const Lights& lights,
                           const LightsOutputs& outputs, const LightsOptions& options = {});
    /// Changes a setting. Throws InvalidArgument, naming the setting and its range.
    virtual void set(std::string_view name, std::string_view value) = 0;
    /// Draws how the technique works for each point: RGBA, 4 bytes per point (sRGB). Shadow maps, for a camera's
    /// points, have "aliasing" (texels per pixel, in colours), "grid" (texels), "views" (the cascade or face of each
    /// point), "depth" and "warp"; a virtual map has "page"; frustum-traced has "decided": each point's provenance
    /// (docs/techniques.md has the legends). Throws InvalidArgument if the technique has no diagnostic of this name, or
    /// if the diagnostic needs points that a camera made.
    virtual std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                               const Light& light);
};

/// For points whose side the caller knows by a normal (packed xyz, of any length): a point whose normal n and light are
/// not strictly on one side, n . D <= 0 with D towards the light, is backfacing, and its visibility becomes 0. Decided
/// exactly. All other values stay, also those of points whose normal has a NaN or infinite coordinate. Call it after a
/// technique's run with the same points and light. Throws InvalidArgument as run() does, or if there are fewer normals
/// than points.
void face_by_normals(const Device& device, const Points& points, std::span<const float> normals, const Light& light,
                     const Visibility& visibility);
/// The same for normals on the device, which lie in the buffer as `layout` describes.
void face_by_normals(const Device& device, const Points& points, cl_mem normals, const PointLayout& layout,
                     const Light& light, const Visibility& visibility);
/// The same where the counter-clockwise side of each triangle is its front: a point is backfacing unless the light is
/// strictly in front of its receiver. Points without a receiver keep their visibility.
void face_by_winding(const Device& device, const Triangles& triangles, const Points& points, const Light& light,
                     const Visibility& visibility);

/// Points that are vertices of a mesh, and the fan of each: the triangles that have the point as a corner. By contract
/// none of these shadows the point, so the point needs no lift, and face_by_fans() decides facing. Copies share
/// buffers.
class VertexFans {
public:
    /// Finds the fans of `points` (3 floats each) among the triangles of `vertices` (9 floats each), by equal
    /// coordinates, and copies them to the device. Triangles with a NaN or infinite vertex are left out. Takes time in
    /// proportion to both numbers. Throws InvalidArgument if a size is no multiple, or for 2^31 corners or more.
    static VertexFans find(const Device& device, std::span<const float> vertices, std::span<const float> points);

    std::size_t count() const { return count_; }  ///< of points
    /// The points that no triangle has as a corner, ascending: face_by_fans() leaves their visibility.
    const std::vector<std::uint32_t>& alone() const { return alone_; }
    /// The points with triangles that do not close around them, ascending: at a border or a hole, or where windings
    /// disagree or more than two triangles share an edge.
    const std::vector<std::uint32_t>& open() const { return open_; }
    /// The points for which the last face_by_fans() with these fans used the extension. Waits for the queue.
    std::uint64_t extended() const;

private:
    friend void face_by_fans(const Device& device, const Triangles& triangles, const VertexFans& fans,
                             const Light& light, const Visibility& visibility, const std::optional<Float3>& up);

    std::optional<Device> device_;
    std::shared_ptr<void> fans_, corners_, extended_;
    std::vector<std::uint32_t> alone_, open_;
    std::size_t count_ = 0, triangles_ = 0;
};
/// Facing at the vertices of a mesh, decided exactly (docs/numerics.md, 14): a point becomes dark if the light, seen
/// from the vertex, is not strictly in front of its fan, whose front is where corners run counter-clockwise. The
/// extension for an open fan: the light must be strictly in front of the planes of all its triangles.
/// With `up`, the mesh is a height field in that direction, whatever its winding: the light must be strictly above the
/// one or two triangles over which the ray leaves. The extension where it leaves over none of them: it must be strictly
/// above the planes of all. Vertical triangles are left out; a fan with one counts as extended.
/// `triangles` are those that `fans` were found among. Call it after a technique's run for the same points and light.
/// Throws InvalidArgument as run() does, or if `up` is zero or not finite.
void face_by_fans(const Device& device, const Triangles& triangles, const VertexFans& fans, const Light& light,
                  const Visibility& visibility, const std::optional<Float3>& up = {});

/// The pattern of 1, 4, 8, 16 or 32 samples per pixel. 1: the centre. 4, 8, 16: Direct3D's standard patterns. 32:
/// Hammersley's points in base 2, x = (i + 1/2) / 32 and y = (i's five bits in reverse + 1/2) / 32 from the pixel's
/// upper left corner, i = 0 .. 31: every row, column and elementary rectangle of 1/32 of a pixel holds one. Throws
/// InvalidArgument for another number.
std::span<const SampleOffset> sample_pattern(std::uint32_t samples);

/// Receives the points of some samples before their visibility is computed: sample by sample in the pattern's order,
/// each pixel by pixel. The points are valid during the call.
using SampleSink = std::function<void(const Points& points)>;

/// Anti-aliased shadows: writes to `mean` the mean visibility of each pixel's samples. Each sample is a point of its
/// own with its own visibility. If the sample's ray meets the pixel's receiver, the point lies on that receiver, else
/// on the first triangle that the ray meets (or creases would leak light); a sample without a triangle counts as lit.
/// If an exact technique proves that all samples of a pixel on one receiver are in shadow, or lit, it does not make
/// them one by one; same bits. Samples are processed in batches of bounded memory, which an exact technique frees at
/// its end; times are sums over the batches. `view` must come from look(). Throws InvalidArgument like
/// sample_pattern(), or if `mean` has fewer entries than the view has pixels.
Statistics run_samples(Technique& technique, const Device& device, const Triangles& triangles, const View& view,
                       const Light& light, std::uint32_t samples, const Visibility& mean, const SampleSink& sink = {});

/// A picture that Technique::diagnose() draws.
struct DiagnosticDescription {
    std::string name;
    std::string meaning;  ///< one line
};

/// One technique, as `gnomon techniques` lists it.
struct TechniqueDescription {
    std::string name;
    std::string summary;  ///< one line
    bool exact = false;
    std::vector<SettingDescription> settings;
    std::vector<DiagnosticDescription> diagnostics{};
};
/// Every technique of this build, in the order of `gnomon techniques`.
std::vector<TechniqueDescription> techniques();
/// Makes the technique of this name. Throws InvalidArgument with the list of names if there is none.
std::unique_ptr<Technique> make_technique(std::string_view name, const Device& device);

// ---- Why a point is lit or in shadow --------------------------------------------------------------------------------

/// The exact signs (-1, 0 or 1) of a triangle a, b, c for the shadow ray from a point P along D, which is minus the
/// direction of travel, or light - P. The triangle blocks the ray if P and the light are strictly on opposite sides of
/// its plane and no edge has the sign -light_side (docs/numerics.md, 1).
struct TriangleSigns {
    std::uint32_t triangle = no_receiver;
    std::array<float, 9> vertices{};
    bool blocks = false;
    bool is_clear = false;       ///< a cut-out that the ray meets where it is clear, so that it does not block
    int point_side = 0;          ///< det(b - a, c - a, P - a)
    int light_side = 0;          ///< det(b - a, c - a, light - a); directional: det(b - a, c - a, D)
    std::array<int, 3> edges{};  ///< det(a - P, b - P, D), det(b - P, c - P, D), det(c - P, a - P, D)
    std::string arithmetic;      ///< what the predicate needed to be certain: "float", "double" or "integers"
    double distance = 0;         ///< from P along the ray, rounded; 0 unless the ray meets it
};

/// The facts by which frustum-traced found a point lit or in shadow.
struct Explanation {
    Float3 position{};                       ///< NaN or infinite: absent
    std::uint32_t receiver = no_receiver;    ///< a triangle of the scene, or none
    TriangleSigns on_receiver;               ///< its receiver, which never blocks; empty without one
    int eye_side = 0;                        ///< the eye's side of the receiver, as light_side; 0 without an eye
    bool is_backfacing = false;              ///< light_side and eye_side of the receiver are not equal, or one is 0
    std::vector<TriangleSigns> occluders;    ///< all triangles that block the shadow ray, nearest first
    std::vector<TriangleSigns> clear_hits;   ///< all that the ray meets where they are cut out, nearest first
    std::vector<TriangleSigns> near_misses;  ///< all others for which the level float was not certain
    float visibility = 1;                    ///< the technique's output
    /// The stage that decided, as Statistics names it: facing, conservative_map, trace or exact_trace; for points with
    /// undecided pairs that found no room in the queue, trace_queue_overflow.
    std::string stage;
    /// The arithmetic that was certain: "none", "filter" (floats with a proven bound), then the levels of the exact
    /// predicate, "float", "double" and "integers" (the hardest of the point's pairs); "exact": one of these levels.
    std::string arithmetic;

    bool is_lit() const { return visibility != 0.0f; }  ///< by the technique's output
    /// True if the technique's visibility agrees with the signs. If it does not, gnomon is wrong.
    bool is_consistent() const { return is_lit() == (!is_backfacing && occluders.empty()); }
};

/// Runs frustum-traced with its diagnostic on all points, and explains the point at `index`; one pass over all
/// triangles by the exact predicate. Throws InvalidArgument as Technique::run() does, or if there is no such point.
Explanation explain(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                    const Light& light);

// ---- Scenes larger than the device's memory -------------------------------------------------------------------------

/// The view of a camera of a scene that stays on the host.
struct ViewOfParts {
    View view;                       ///< its receivers are indices in `ids`
    Triangles triangles;             ///< the triangles of `ids`, on the device: for read() and shade() of this view
    std::vector<std::uint32_t> ids;  ///< ids in the whole scene, ascending: all seen triangles, and maybe more
};
/// look() for triangles on the host (9 floats each), same bits. The device stores as many triangles at a time as fit
/// into its memory or under the limit given to Device. Throws OutOfDeviceMemory if the view itself does not fit.
ViewOfParts look_in_parts(const Device& device, std::span<const float> vertices, const Camera& camera,
                          std::uint32_t width, std::uint32_t height, const CutOuts* cut_outs = nullptr);

/// Technique::run() for triangles on the host: the device stores as many triangles, and as many points, at a time as
/// fit. Same bits for an exact technique; for other techniques, each point gets the lowest visibility of its parts.
/// `make` makes the technique, and makes it again after an attempt that did not fit. A receiver r of the points is
/// triangle ids[r] of `vertices`, or r if `ids` is empty. Throws OutOfDeviceMemory if even small parts do not fit.
Statistics run_in_parts(const std::function<std::unique_ptr<Technique>()>& make, const Device& device,
                        std::span<const float> vertices, const Points& points, std::span<const std::uint32_t> ids,
                        const Light& light, const Visibility& visibility, const CutOuts* cut_outs = nullptr);

}  // namespace gnomon

#pragma GCC visibility pop
