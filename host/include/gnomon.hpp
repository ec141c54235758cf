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
// What "in shadow" means is the visibility contract in docs/numerics.md: decided in exact real arithmetic on the
// float32 inputs, the same bits on every device. Objects are cheap handles (shared ownership); one Device and what
// was made from it may be used from one thread at a time. Failures throw the exceptions below; the library never
// prints, never exits and has no globals.
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

// What the library keeps to itself.
namespace gnomon {
namespace cl {
class Session;
}
class Clusters;
struct OwnedPoints;
}  // namespace gnomon

// The library is compiled with hidden visibility (host/CMakeLists.txt): a shared one shows what is declared from here
// on, and nothing else. A pragma, since clang 14 does not hand a namespace's attribute on to its functions.
#pragma GCC visibility push(default)

namespace gnomon {

/// Three float32 coordinates: world space, in the scene's unit (glTF: metres), +Y up, right-handed.
using Float3 = std::array<float, 3>;

/// Receiver id of a point that lies on no triangle (and, in a view, of a pixel that sees the sky).
inline constexpr std::uint32_t no_receiver = 0xFFFFFFFFu;

/// "MAJOR.MINOR.PATCH".
std::string_view version();

// ---- Errors ---------------------------------------------------------------------------------------------------------

/// Root of everything the library throws. what() is one sentence that names the thing and, where there is one, the
/// remedy.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An argument outside its stated range (sizes that do not match, a zero direction, an unknown setting).
class InvalidArgument : public Error {
public:
    using Error::Error;
};

/// No device fits: none installed, none of that name, or the one asked for lacks something gnomon needs.
class DeviceNotFound : public Error {
public:
    using Error::Error;
};

/// An OpenCL call failed. Carries the call, the error's name ("CL_INVALID_VALUE") and, for builds, the compiler's log.
class OpenClError : public Error {
public:
    /// what(): "CALL failed with NAME (CODE): REMEDY", then the build log.
    OpenClError(std::string_view call, cl_int code, std::string build_log = {}, std::string_view remedy = {});
    cl_int code() const noexcept { return code_; }
    const std::string& build_log() const noexcept { return build_log_; }

private:
    cl_int code_;
    std::string build_log_;
};

/// The device has too little memory for what was asked (CL_MEM_OBJECT_ALLOCATION_FAILURE and its kin, or the limit
/// given to Device). Nothing was half done: the library stays usable.
class OutOfDeviceMemory : public OpenClError {
public:
    OutOfDeviceMemory(std::string_view call, cl_int code, std::string_view remedy = "ask for fewer points at once")
        : OpenClError(call, code, {}, remedy) {}
};

// ---- Devices --------------------------------------------------------------------------------------------------------

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
    std::string lacks;        ///< empty if the device can be used, else what it lacks
    std::string note;         ///< of an open device: what the check at start-up switched off, and why; else empty
    bool is_default = false;  ///< the one a Device without a selector opens
    std::string why_default;  ///< for the default: the rule that chose it
};

/// All devices of all platforms; empty if there is no OpenCL at all. Never throws for a broken driver: a platform that
/// cannot be asked is left out.
std::vector<DeviceDescription> devices();

/// How a Device is opened.
struct DeviceOptions {
    /// Time every kernel by events (Statistics then has device times). Slows small launches: off for wall-clock times.
    bool profile = false;
    /// Refuse to allocate more than this many bytes on the device; 0: no limit of ours.
    std::uint64_t memory_limit_bytes = 0;
    /// Hide double precision, so that the wide filter is skipped and the exact level is reached sooner. Same bits.
    bool hide_fp64 = false;
    /// Work-group size of every kernel, 0: chosen per device. Same bits for every size.
    std::uint32_t work_group_size = 0;
    /// Take the kernels that are made for GPUs (a point per work-item, groups that work together) on a CPU as well, as
    /// the environment variable GNOMON_GPU_KERNELS does: for tests and measurements. Same bits.
    bool gpu_kernels = false;
};

/// What a Device's runs had to wait for before their kernels could run. A platform with a cache of its own (PoCL)
/// compiles or loads a kernel when it is first launched: then that wait is counted too, if the queue can time it.
struct KernelBuilds {
    std::uint32_t programs = 0;    ///< compiled or loaded
    std::uint32_t from_cache = 0;  ///< of them, loaded from gnomon's cache on disk; 0 on a platform with its own
    double ms = 0;
};

/// A device, its context and in-order queue, and the compiled kernels. Building the kernels is the slow part of a
/// first start; they are cached on disk for the next one.
class Device {
public:
    /// Opens the device that `selector` names: "P:D" (indices as in devices()), or a part of the device's or platform's
    /// name in any case; empty: the environment variable GNOMON_DEVICE, else the default (the first usable GPU, else
    /// the first usable CPU). Throws DeviceNotFound with the list of what there is.
    explicit Device(std::string_view selector = {}, const DeviceOptions& options = {});
    /// Uses the caller's context and queue (both are retained). The queue must be in-order; kernels and copies are
    /// enqueued on it, and results are there when the queue has come that far. Whether it profiles is the queue's word,
    /// not that of `options`. Throws InvalidArgument if the two do not belong together, DeviceNotFound if the queue's
    /// device cannot be used.
    Device(cl_context context, cl_command_queue queue, const DeviceOptions& options = {});

    const DeviceDescription& description() const;
    cl_context context() const;
    cl_command_queue queue() const;
    /// Bytes of device memory that gnomon's own buffers hold now, and the most they ever held.
    std::uint64_t memory_bytes() const;
    std::uint64_t peak_memory_bytes() const;
    /// Since the device was opened. Waits for the queue if kernels were launched for the first time since the last
    /// call.
    KernelBuilds kernel_builds() const;
    /// For the library's own stages.
    cl::Session& session() const { return *session_; }

private:
    std::shared_ptr<cl::Session> session_;
};

// ---- Inputs and outputs ---------------------------------------------------------------------------------------------

/// A pinhole camera. Pixel (x, y), row 0 on top, looks along
///   forward + (2 (x + 0.5) / width - 1) aspect t right + (1 - 2 (y + 0.5) / height) t up,  t = tan(fov_y / 2).
/// There is no near or far plane: everything in front of the eye is seen. The axes are unit vectors; they need not be
/// orthogonal, but must span space.
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

/// The camera whose pixels a set of shading points came from: what fits that follow the view need.
struct PointsCamera {
    Camera camera;
    std::uint32_t width = 0, height = 0;
};

/// Triangles on the device: 9 consecutive float32 each (three world-space vertices). A triangle's id is its position.
/// One with a NaN or infinite vertex casts nothing and is never seen; Statistics counts it.
class Triangles {
public:
    /// Copies `vertices` (9 floats per triangle) to the device. Throws InvalidArgument if the size is no multiple of 9.
    static Triangles upload(const Device& device, std::span<const float> vertices);
    /// Uses the caller's buffer (retained) from float `first_float` on. The caller must not write it during a run.
    static Triangles wrap(const Device& device, cl_mem vertices, std::size_t count, std::size_t first_float = 0);

    /// For a mesh that does not change: keeps boxes around clusters of 64 triangles (half a byte each, on the device),
    /// so that what cameras do not see and lights do not need is skipped without its vertices being read. The answers
    /// are the same bits. Where neighbours in the buffer are far apart in the scene, a copy in order is kept as well
    /// (40 bytes each, if there is room). Worth it from about two views or lights on. The caller promises not to write
    /// the vertices from here on while this handle, or a copy made of it from now on, is in use; after a change, call
    /// this again. Costs one pass over the triangles, or some ten with a copy.
    void keep_clusters(const Device& device);
    /// Lets go of them: as before keep_clusters().
    void forget_clusters() { clusters_.reset(); }

    std::size_t count() const { return count_; }
    cl_mem buffer() const;
    std::size_t first_float() const { return first_float_; }
    /// For the library's own stages: null if none are kept.
    const Clusters* clusters() const { return clusters_.get(); }

private:
    friend class Points;  // watches the buffer

    std::shared_ptr<void> buffer_;
    std::shared_ptr<const Clusters> clusters_;
    std::size_t count_ = 0;
    std::size_t first_float_ = 0;
};

/// Where coordinate c (0..2) of point i lies in a buffer of floats: first + i * point_stride + c * coordinate_stride.
/// The default is packed xyz triples; structure of arrays for n points is {0, 1, n}.
struct PointLayout {
    std::size_t first = 0;
    std::size_t point_stride = 3;
    std::size_t coordinate_stride = 1;
};

/// Shading points on the device: position, and optionally the id of the triangle each lies on (its receiver, which
/// never shadows it). A point with a NaN or infinite coordinate is absent: visibility 1, no work.
class Points {
public:
    Points() = default;  ///< none
    /// Copies `positions` (3 floats per point) and `receivers` (one per point, or none at all) to the device.
    static Points upload(const Device& device, std::span<const float> positions,
                         std::span<const std::uint32_t> receivers = {});
    /// Uses the caller's buffers (retained). `receivers` may be null: no point has one.
    static Points wrap(const Device& device, cl_mem positions, const PointLayout& layout, std::size_t count,
                       cl_mem receivers = nullptr);

    /// From here on, a point whose receiver's plane separates the light from this eye (or contains the light) faces
    /// away: visibility 0 by definition of shading, decided exactly, and no work. Views made by a Camera have it set.
    void set_eye(const Float3& eye) {
        eye_ = eye;
        lifted_off_.reset();
    }
    const std::optional<Float3>& eye() const { return eye_; }
    /// The camera of a picture of width x height pixels that these points belong to: shadow maps that are split or
    /// warped along the view need it; without it they fit the points alone. Sets the eye too. Views made by look()
    /// have it set.
    void set_camera(const Camera& camera, std::uint32_t width, std::uint32_t height) {
        camera_ = PointsCamera{camera, width, height};
        set_eye(camera.eye);
    }
    const std::optional<PointsCamera>& camera() const { return camera_; }
    /// The caller promises that no point lies on the far side of its receiver as the eye sees it, `triangles` being
    /// what receivers name: then less is asked of the receivers, which saves time. Views made by look() have it set; it
    /// lasts until an eye or a camera is set. After a change of the triangles, look again.
    void set_lifted_off(const Triangles& triangles);
    bool is_lifted_off(const Triangles& triangles) const;

    std::size_t count() const { return count_; }
    cl_mem positions() const;
    cl_mem receivers() const;  ///< null if no point has a receiver
    const PointLayout& layout() const { return layout_; }

private:
    friend struct OwnedPoints;  // the camera stages make points of their own buffers

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
PointsOnHost read(const Device& device, const Points& points);

/// Visibility per point, one float32 each: 1 lit, 0 in shadow; filtered techniques write values between.
class Visibility {
public:
    Visibility(const Device& device, std::size_t count);
    /// Uses the caller's buffer (retained) of at least `count` floats: the result appears there, without a trip
    /// through the host.
    Visibility(const Device& device, cl_mem buffer, std::size_t count);

    std::size_t count() const { return count_; }
    cl_mem buffer() const;
    /// Waits for the queue and copies to the host.
    std::vector<float> read() const;

private:
    Device device_;
    std::shared_ptr<void> buffer_;
    std::size_t count_ = 0;
};

/// A light that is a direction or a point. Float32 as given, never normalised.
struct Light {
    std::array<float, 4> xyzw{};  ///< w = 0: minus the direction of travel; w = 1: the position
    bool is_directional() const { return xyzw[3] == 0.0f; }

    /// A light infinitely far away that travels along `direction`. Throws InvalidArgument if zero or not finite.
    static Light directional(const Float3& direction);
    /// A light at `position`. Throws InvalidArgument if not finite.
    static Light positional(const Float3& position);
};

// ---- Statistics -----------------------------------------------------------------------------------------------------

/// One stage of one run.
struct StageStatistics {
    std::string name;
    double device_ms = 0;  ///< sum of its kernels by events; 0 unless the device was opened with `profile`
    /// Host time without the building of kernels: with `profile` until the device has finished the stage, else until
    /// its kernels are enqueued, which says nothing of how long they run.
    double wall_ms = 0;
    std::string skipped;  ///< why it did not run, empty if it did
};

/// What one run did. Names are stable, in snake_case, and appear as they are in stats.json.
struct Statistics {
    std::vector<StageStatistics> stages;
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    /// Host time from the call until the device has finished the run, the building of kernels included.
    double total_wall_ms = 0;
    std::uint64_t device_memory_bytes = 0;  ///< gnomon's own buffers during the run, beside the caller's

    /// The count of that name, 0 if there is none.
    std::uint64_t count(std::string_view name) const;
};

// ---- Camera ---------------------------------------------------------------------------------------------------------

/// Where in its pixel a sample lies: from the centre, in 1/64 pixel, x to the right and y down, each from -32 to 31.
struct SampleOffset {
    int x = 0, y = 0;
};

/// What a camera sees: per pixel (row by row from the top) the nearest triangle and the shading point on it.
class View {
public:
    std::uint32_t width = 0, height = 0;
    Points points;          ///< width * height; absent (NaN) where the sky is seen
    Statistics statistics;  ///< of the camera stages
};

/// Runs the camera stages: visibility buffer, then shading points, lifted off their receiver by a proven bound.
/// Throws InvalidArgument if width or height is 0 or over 16384, or for a camera filled by hand that is none.
View look(const Device& device, const Triangles& triangles, const Camera& camera, std::uint32_t width,
          std::uint32_t height);

/// A caller's own points, lifted off their receivers as the camera's are: moved along the receiver's normal towards
/// `eye` by 4 float32 ulps of the largest coordinate of point and eye, and rounded up along it (docs/numerics.md, 9).
/// A point that is its exact place on the receiver rounded to float32 is never under the receiver's plane afterwards,
/// and at most 9 such ulps from where it was. Absent points, and points whose receiver has no plane, stay where they
/// are. The points returned share the receivers and have `eye` set. Throws InvalidArgument if there are no receivers.
Points lift(const Device& device, const Triangles& triangles, const Points& points, const Float3& eye);

/// A view on the host, for pictures and files.
struct ViewOnHost {
    std::vector<float> position;          ///< 3 per pixel; sky: 0
    std::vector<float> normal;            ///< 3 per pixel, unit geometric normal facing the camera; sky: 0
    std::vector<std::uint32_t> receiver;  ///< sky: no_receiver
};
ViewOnHost read(const Device& device, const Triangles& triangles, const View& view);

/// Base colours for shade(): one material id per triangle, and linear RGB per material.
struct Materials {
    std::vector<std::uint32_t> triangle_material;
    std::vector<Float3> base_color;
};
/// Lambert with visibility, plus ambient, written as 8-bit sRGB, 4 bytes (RGBA) per pixel.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                const Visibility& visibility, const Materials& materials, const Light& light);
/// The same under several lights: their Lambert terms, each as bright as the one light above, are added up; what is
/// brighter than white is white. visibilities[i] belongs to lights[i]: throws InvalidArgument if there is not one each.
std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                std::span<const Visibility> visibilities, const Materials& materials,
                                std::span<const Light> lights);

// ---- Techniques -----------------------------------------------------------------------------------------------------

/// A setting of a technique, as `gnomon techniques` lists it and --set changes it.
struct SettingDescription {
    std::string name;
    std::string default_value;
    std::string meaning;  ///< one line with range and unit
};

/// One way to compute visibility. All share this interface, so one benchmark, viewer and test harness serve them all.
class Technique {
public:
    virtual ~Technique() = default;
    /// Writes visibility (points.count() floats) and returns what was done. Waits for the result only as far as it has
    /// to (buffers that must grow); the visibility is there when the device's queue has come that far.
    /// Throws InvalidArgument if visibility has fewer entries than there are points or overlaps an input, or if the
    /// light is none.
    virtual Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                           const Visibility& visibility) = 0;
    /// Keeps what depends on these triangles and this light alone, so that later runs with both have less to do: for a
    /// scene that stands still while the camera moves. Visibility is the same bits, prepared or not; runs with other
    /// triangles or another light go on as ever, and leave this alone. The caller promises not to change the triangles'
    /// buffer until forget(), another prepare() or the technique's end, each of which frees what was kept (as does
    /// set()); till then it counts in device_memory_bytes of every run. Points far outside the triangles' bounds, and
    /// points far below their own receiver, make a run go on as if nothing were prepared; the count
    /// prepared_fallback_points says how many there were. A technique that can keep nothing does nothing, as most.
    /// Returns what was done. Throws as run() does, and has nothing prepared then.
    virtual Statistics prepare(const Triangles& triangles, const Light& light);
    /// Frees what prepare() kept.
    virtual void forget() {}
    /// run() for several lights and the same points: visibilities[i] gets the answer of lights[i], bit for bit run()'s.
    /// What serves all of them is done once, as far as the technique can. Returns the statistics of each light. Throws
    /// InvalidArgument if there is not one visibility for each light, or two of them are the same buffer.
    virtual std::vector<Statistics> run_lights(const Triangles& triangles, const Points& points,
                                               std::span<const Light> lights, std::span<const Visibility> visibilities);
    /// Changes a setting. Throws InvalidArgument, naming the setting and its range.
    virtual void set(std::string_view name, std::string_view value) = 0;
    /// Draws how the technique works for each point: RGBA, 4 bytes per point (sRGB). Shadow maps, for what a camera
    /// sees, have "aliasing" (texels per pixel, in colours), "grid" (texels), "views" (which cascade or face serves),
    /// "depth" and "warp"; a virtual map has "page"; frustum-traced has "decided": what decided each point
    /// (docs/techniques.md has the legends). Throws InvalidArgument for a name that is none of the technique's, or
    /// where it needs points that a camera made.
    virtual std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                               const Light& light);
};

/// The pattern of 1, 4, 8, 16 or 32 samples per pixel. 1: the centre. 4, 8, 16: Direct3D's standard patterns. 32:
/// Hammersley's points in base 2, x = (i + 1/2) / 32 and y = (i's five bits in reverse + 1/2) / 32 from the pixel's
/// upper left corner, i = 0 .. 31: every row, column and elementary rectangle of 1/32 of a pixel holds one. Throws
/// InvalidArgument for another number.
std::span<const SampleOffset> sample_pattern(std::uint32_t samples);

/// Is handed the points of some samples before their visibility is computed: sample by sample in the pattern's order,
/// each pixel by pixel. They are valid during the call.
using SampleSink = std::function<void(const Points& points)>;

/// Anti-aliased shadows: writes to `mean` the mean visibility of each pixel's samples. Each sample is a point of its
/// own with its own answer: where its ray through the pixel meets the pixel's receiver it lies on that receiver, else
/// on what its ray meets first (or creases would leak light); one that meets nothing counts as lit. Where an exact
/// technique proves that all samples which a pixel has on one receiver are in shadow, or lit, they are not made one by
/// one; the bits are the same. Samples are processed in batches of bounded memory, which an exact technique keeps until
/// its end; times add up over them. `view` must come from look(). Throws InvalidArgument like sample_pattern(), or if
/// `mean` has fewer entries than the view has pixels.
Statistics run_samples(Technique& technique, const Device& device, const Triangles& triangles, const View& view,
                       const Light& light, std::uint32_t samples, const Visibility& mean, const SampleSink& sink = {});

/// A picture that Technique::diagnose() draws.
struct DiagnosticDescription {
    std::string name;
    std::string meaning;  ///< one line
};

struct TechniqueDescription {
    std::string name;
    std::string summary;  ///< one line
    bool exact = false;
    std::vector<SettingDescription> settings;
    std::vector<DiagnosticDescription> diagnostics{};
};
/// Every technique this build knows, in the order they are listed.
std::vector<TechniqueDescription> techniques();
/// Makes one by name. Throws InvalidArgument with the list of names.
std::unique_ptr<Technique> make_technique(std::string_view name, const Device& device);

// ---- Why a point is lit or in shadow --------------------------------------------------------------------------------

/// The exact signs (-1, 0 or 1) of a triangle a, b, c for the shadow ray from a point P along D, which is minus the
/// direction of travel, or light - P. The triangle blocks the ray if P and the light are strictly on opposite sides of
/// its plane and no edge has the sign -light_side (docs/numerics.md, 1).
struct TriangleSigns {
    std::uint32_t triangle = no_receiver;
    std::array<float, 9> vertices{};
    bool blocks = false;
    int point_side = 0;          ///< det(b - a, c - a, P - a)
    int light_side = 0;          ///< det(b - a, c - a, light - a); directional: det(b - a, c - a, D)
    std::array<int, 3> edges{};  ///< det(a - P, b - P, D), det(b - P, c - P, D), det(c - P, a - P, D)
    std::string arithmetic;      ///< what the predicate needed to be certain: "float", "double" or "integers"
    double distance = 0;         ///< from P along the ray, rounded; 0 unless it blocks
};

/// Why frustum-traced found a point lit or in shadow.
struct Explanation {
    Float3 position{};                       ///< NaN or infinite: absent
    std::uint32_t receiver = no_receiver;    ///< a triangle of the scene, or none
    TriangleSigns on_receiver;               ///< its receiver, which never blocks; empty without one
    int eye_side = 0;                        ///< the eye's side of the receiver, as light_side; 0 without an eye
    bool is_backfacing = false;              ///< light_side and eye_side of the receiver are not equal, or one is 0
    std::vector<TriangleSigns> occluders;    ///< all triangles that block the shadow ray, nearest first
    std::vector<TriangleSigns> near_misses;  ///< all that do not block it, where the level float was not certain
    float visibility = 1;                    ///< what the technique wrote
    /// The stage that decided, as Statistics names it: facing, conservative_map, trace or exact_trace; and
    /// trace_queue_overflow for points whose undecided pairs found no room.
    std::string stage;
    /// What that stage needed to be certain: "none", "filter" (floats with a proven bound), then the levels of the
    /// exact predicate, "float", "double" and "integers" (the hardest of the point's pairs); "exact": one of these.
    std::string arithmetic;

    bool is_lit() const { return visibility != 0.0f; }
    /// Whether the technique's answer is the one that the signs give. If not, gnomon is wrong.
    bool is_consistent() const { return is_lit() == (!is_backfacing && occluders.empty()); }
};

/// Runs frustum-traced on all points, watched, and explains the point at `index`; one pass over all triangles by the
/// exact predicate. Throws InvalidArgument as Technique::run() does, or if there is no such point.
Explanation explain(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                    const Light& light);

// ---- Scenes larger than the device's memory -------------------------------------------------------------------------

/// What a camera sees of a scene that stays on the host.
struct ViewOfParts {
    View view;                       ///< its receivers are positions in `ids`
    Triangles triangles;             ///< those that `ids` names, on the device: for read() and shade() of this view
    std::vector<std::uint32_t> ids;  ///< in the whole scene, rising: all that are seen, and maybe more
};
/// As look(), bit for bit, for triangles on the host (9 floats each) of which the device holds as many at a time as fit
/// into its memory or under the limit given to Device. Throws OutOfDeviceMemory if the view itself does not fit.
ViewOfParts look_in_parts(const Device& device, std::span<const float> vertices, const Camera& camera,
                          std::uint32_t width, std::uint32_t height);

/// As Technique::run(), for triangles on the host of which the device holds as many at a time as fit, and for as many
/// points at a time. Bit for bit the same for an exact technique; for others, each point gets the darkest of its
/// parts. `make` makes the technique, anew after a try that did not fit. A receiver r of the points is triangle ids[r]
/// of `vertices`, or r if `ids` is empty. Throws OutOfDeviceMemory if even small parts do not fit.
Statistics run_in_parts(const std::function<std::unique_ptr<Technique>()>& make, const Device& device,
                        std::span<const float> vertices, const Points& points, std::span<const std::uint32_t> ids,
                        const Light& light, const Visibility& visibility);

}  // namespace gnomon

#pragma GCC visibility pop
