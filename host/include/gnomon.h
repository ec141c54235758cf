// SPDX-License-Identifier: MIT
// gnomon: exact hard shadows as OpenCL kernels, from C (in C++: gnomon.hpp). Stable but for what says: experimental.
//
//   gnomon_device_wrap(context, queue, NULL, &device);                       // your own, or gnomon_device_open()
//   gnomon_triangles_wrap(device, vertices, triangle_count, 0, &triangles);  // your cl_mem, or ..._upload()
//   gnomon_points_wrap(device, positions, NULL, point_count, NULL, &points);
//   gnomon_visibility_wrap(device, result, point_count, 0, &visibility);
//   gnomon_technique_create(device, "frustum-traced", &technique);
//   gnomon_light_directional(down, &light);
//   gnomon_technique_run(technique, triangles, points, light, visibility, NULL, &event, NULL);
//
// A point is "in shadow" by the visibility contract of docs/numerics.md, which is decided in exact real arithmetic on
// the float32 inputs: the same bits on every device, and the same as from C++.
//
// Status. Every function returns a gnomon_status, except gnomon_version(), gnomon_status_name(), gnomon_last_error(),
//   gnomon_last_opencl_error() and the gnomon_*_destroy(), which cannot fail. No exception leaves the library, and it
//   never prints or exits. Every function can return GNOMON_INVALID_ARGUMENT (also for a NULL where none is allowed),
//   GNOMON_OUT_OF_HOST_MEMORY, and, where it uses the device, GNOMON_OUT_OF_DEVICE_MEMORY and GNOMON_OPENCL_ERROR; a
//   comment below states the rest. After a failure all objects are as they were and stay usable.
// Results. Pointers whose names end with _out come last. A function that fails sets its handle, event and result
//   pointers to NULL and writes no other value. event_out and statistics_out may be NULL, and so may each of several
//   results of a getter.
// Ownership. Objects (gnomon_device, gnomon_points, ...) are destroyed by their gnomon_*_destroy(), in any order: an
//   object keeps what it needs of the others. NULL is allowed there. gnomon retains each cl_context, cl_command_queue
//   and cl_mem that it is given and keeps, and releases it with the last object that needs it: the caller keeps its own
//   reference, and may release it at once. A cl_context, cl_command_queue or cl_mem that a getter returns is not
//   retained for the caller. A cl_event that a function returns belongs to the caller: clReleaseEvent(). A struct that
//   comes by pointer (gnomon_statistics, gnomon_device_list, ...) is read-only, and so are its strings and arrays: they
//   are valid until its gnomon_*_destroy(). Host arrays that are passed in are not needed after the call.
// Threads. One device and the objects made from it may be used by one thread at a time; different devices by different
//   threads at once. gnomon_last_error() is per thread.
// Queue. The device's queue is in-order. Work is enqueued there; event_out gives an event of this queue that completes
//   when the results of the call are there. To wait for it in another queue, call clFlush() on the device's queue
//   first. For inputs that another queue writes, enqueue clEnqueueBarrierWithWaitList() with its events on the device's
//   queue.
// Waits. As in gnomon.hpp, whose table says it of the same functions: `always`, a call waits for the queue, and so for
//   all that was enqueued before; `large`, only where it makes a buffer of 4 MiB or more for a CPU; `never`. What is
//   not in the table never waits, but gnomon_device_kernel_builds() after a first launch, gnomon_device_wrap() as
//   gnomon_device_open(), and the gnomon_*_share() as gnomon_*_upload() where the device has memory of its own.
//
// WAITS
//   gnomon_device_open                       always
//   gnomon_device_finish                     always
//   gnomon_triangles_upload                  always
//   gnomon_triangles_wrap                    never
//   gnomon_triangles_raster                  always
//   gnomon_triangles_upload_cut_outs         always
//   gnomon_triangles_copy_cut_outs           always
//   gnomon_triangles_keep_clusters           always
//   gnomon_points_upload                     always
//   gnomon_points_wrap                       never
//   gnomon_points_read                       always
//   gnomon_points_lift                       large
//   gnomon_points_explain                    always
//   gnomon_visibility_create                 large
//   gnomon_visibility_wrap                   never
//   gnomon_visibility_fetch                  always
//   gnomon_visibility_read                   always
//   gnomon_vertex_fans_find                  always
//   gnomon_vertex_fans_extended              always
//   gnomon_technique_create                  never
//   gnomon_technique_set                     never
//   gnomon_technique_run                     always
//   gnomon_technique_run_each_light          always
//   gnomon_technique_run_light_table         always
//   gnomon_technique_run_light_table_to_host always
//   gnomon_technique_run_mean                always
//   gnomon_technique_run_samples             always
//   gnomon_technique_prepare                 always
//   gnomon_technique_release_prepared_light  never
//   gnomon_technique_diagnose                always
//   gnomon_view_look                         always
//   gnomon_camera_pass_look                  always
//   gnomon_view_read                         always
//   gnomon_view_shade                        always
//   gnomon_host_scene_look                   always
//   gnomon_host_scene_run                    always
// END OF WAITS
// Options and other structs that the caller fills and passes by pointer begin with their size: set them to
//   GNOMON_..._INIT, then change members. A struct of another size than the library's is refused. NULL for options:
//   GNOMON_..._INIT. Small values (gnomon_light, gnomon_camera, gnomon_point_layout, ...) have no size and stay as they
//   are. Enumerations are integers of a fixed width.
// Order. The object that a function's name begins with comes first, results last. A part of a buffer is given as
//   (buffer, count, first_float), as in gnomon.hpp.
// Strings are UTF-8 and end with 0. Sizes of arrays and buffers are numbers of elements, not bytes.
#ifndef GNOMON_H
#define GNOMON_H

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gnomon/version.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/// "MAJOR.MINOR.PATCH" of the library that the program runs with (GNOMON_VERSION is that of the headers).
const char* gnomon_version(void);

// ---- Status ---------------------------------------------------------------------------------------------------------

/// What a function returns: one of the values below.
typedef int32_t gnomon_status;
enum {
    GNOMON_SUCCESS = 0,
    GNOMON_INVALID_ARGUMENT = 1,      ///< an argument outside its stated range, an unknown technique or setting
    GNOMON_DEVICE_NOT_FOUND = 2,      ///< no device fits, or the named one lacks a feature that gnomon needs
    GNOMON_OUT_OF_DEVICE_MEMORY = 3,  ///< of the device, or of the limit in gnomon_device_options
    GNOMON_OUT_OF_HOST_MEMORY = 4,
    GNOMON_OPENCL_ERROR = 5,     ///< an OpenCL call failed: gnomon_last_opencl_error() has its code
    GNOMON_STOPPED = 6,          ///< the caller's gnomon_sample_sink or gnomon_progress stopped the run
    GNOMON_UNEXPECTED_ERROR = 7  ///< anything else; the text says what
};

/// "GNOMON_SUCCESS" and so on; "an unknown status" for another number.
const char* gnomon_status_name(gnomon_status status);
/// One sentence with the cause of the last failure in this thread and, where there is one, the remedy; for kernels that
/// do not build the compiler's log follows. "" before the first failure. Valid until the thread's next failure.
const char* gnomon_last_error(void);
/// The OpenCL code of the last failure in this thread; CL_SUCCESS if no OpenCL call was its cause.
cl_int gnomon_last_opencl_error(void);

// ---- Values ---------------------------------------------------------------------------------------------------------

/// The receiver of a point that lies on no triangle and, in a view, of a pixel that shows the sky.
#define GNOMON_NO_RECEIVER 0xFFFFFFFFu

/// A directional light (w = 0: xyz is minus the direction of travel) or a point light (w = 1: xyz is the position).
typedef struct gnomon_light {
    float xyzw[4];
} gnomon_light;

/// A light that travels along `direction` (need not have unit length). Fails if it is 0,0,0 or not finite.
gnomon_status gnomon_light_directional(const float direction[3], gnomon_light* light_out);
/// A point light, in the scene's unit. Fails if it is not finite.
gnomon_status gnomon_light_point(const float position[3], gnomon_light* light_out);

/// A pinhole camera. Pixel (x, y), row 0 on top, looks along
///   forward + (2 (x + 0.5) / width - 1) aspect t right + (1 - 2 (y + 0.5) / height) t up,  t = tan(fov_y_radians / 2).
/// The axes are unit vectors that span space.
typedef struct gnomon_camera {
    float eye[3];
    double right[3], up[3], forward[3];
    double fov_y_radians;
} gnomon_camera;

/// Looks from `eye` at `target`; `up` is made orthogonal to the view. Fails if eye and target coincide, if `up` is
/// parallel to the view, or if fov_y_degrees is not between 0 and 180 (both exclusive).
gnomon_status gnomon_camera_look_at(const float eye[3], const float target[3], const float up[3], double fov_y_degrees,
                                    gnomon_camera* camera_out);

/// Coordinate c (0..2) of point i is float first + i * point_stride + c * coordinate_stride of its buffer. Packed xyz
/// triples are {0, 3, 1}; a structure of arrays of n points is {0, 1, n}.
typedef struct gnomon_point_layout {
    size_t first, point_stride, coordinate_stride;
} gnomon_point_layout;

// ---- World coordinates (experimental) -------------------------------------------------------------------------------

/// float64 coordinates as float32 without loss: each is snapped once to a whole number of steps of 2^exponent,
/// floor(x / step + 1/2), and stored as its distance from the origin, which is given in steps. One scene, cut into
/// tiles with origins of their own, gives the same bits as a whole (docs/numerics.md, 13). A point light is snapped
/// too. The functions are in the library gnomon_full, not in gnomon.
typedef struct gnomon_world_lattice {
    int64_t origin[3];
    int32_t exponent;  ///< from -100 to 100
} gnomon_world_lattice;

/// A lattice of this step with the origin nearest the centre of the finite positions (3 * count numbers).
gnomon_status gnomon_world_lattice_around(const double* positions, size_t count, int32_t exponent,
                                          gnomon_world_lattice* lattice_out);
/// The finest step at which the positions lie within 2^23 steps of the origin, half of what fits.
gnomon_status gnomon_world_lattice_fit(const double* positions, size_t count, gnomon_world_lattice* lattice_out);
/// Snaps 3 * count numbers: positions relative to the origin, NaN where one is not finite. largest_move_out: of any
/// coordinate, at most half a step; may be NULL. Fails with the first position that lies more than 2^24 steps from the
/// origin, and the finest step that fits.
gnomon_status gnomon_world_lattice_snap(const gnomon_world_lattice* lattice, const double* positions, size_t count,
                                        float* snapped_out, double* largest_move_out);
/// Snaps points on a surface so that this surface does not shadow them: each moves first by 2.625 steps along its
/// normal (3 numbers, of any length, of the surface before snapping). Decide facing by the same normal. Fails as
/// snapping does, or if a normal is zero or not finite.
gnomon_status gnomon_world_lattice_lift(const gnomon_world_lattice* lattice, const double* positions,
                                        const double* normals, size_t count, float* lifted_out);
/// What snapping does to a triangle.
typedef uint8_t gnomon_change;
enum {
    GNOMON_CHANGE_NONE = 0,
    GNOMON_CHANGE_ZERO_AREA = 1,
    GNOMON_CHANGE_TURNED_OVER = 2,  ///< by more than a right angle
    GNOMON_CHANGE_TILTED = 3        ///< by more than the given angle
};
/// What snapping does to each of `count` triangles (9 numbers each): one value each. `degrees`, 0 to 90: the angle from
/// which on a triangle is tilted. Triangles without area before, or not finite: GNOMON_CHANGE_NONE. Fails as snapping.
gnomon_status gnomon_world_lattice_changes(const gnomon_world_lattice* lattice, const double* triangles, size_t count,
                                           double degrees, gnomon_change* changes_out);
/// For each corner of `count` triangles (9 numbers each) the nearest other triangle that it touches, 3 * count values:
/// one within a step of the corner, before snapping, that has no corner there, after snapping; GNOMON_NO_RECEIVER if
/// there is none. Snapping may have put such a corner below that triangle: lift it as a point on its surface.
gnomon_status gnomon_world_lattice_touched_triangles(const gnomon_world_lattice* lattice, const double* triangles,
                                                     size_t count, uint32_t* touched_out);
/// The world's coordinates of a snapped position, exactly.
gnomon_status gnomon_world_lattice_world_of(const gnomon_world_lattice* lattice, const float position[3],
                                            double world_out[3]);
/// 3 * count snapped numbers relative to the origin of another lattice of the same step, exactly. Fails if the steps
/// differ, or a position lies more than 2^24 steps from the new origin.
gnomon_status gnomon_world_lattice_rebase(const gnomon_world_lattice* lattice, const float* positions, size_t count,
                                          const gnomon_world_lattice* other, float* rebased_out);

// ---- Statistics -----------------------------------------------------------------------------------------------------

/// One stage of a run.
typedef struct gnomon_stage {
    const char* name;
    double device_ms;     ///< sum of its kernels; 0 unless the device profiles
    double wall_ms;       ///< host time without the building of kernels
    const char* skipped;  ///< why it did not run, "" if it did
} gnomon_stage;

/// One number of a run: of points, triangles, tests and so on.
typedef struct gnomon_count {
    const char* name;  ///< in snake_case, stable
    uint64_t value;
} gnomon_count;

/// The work of one run.
typedef struct gnomon_statistics {
    const gnomon_stage* stages;
    size_t stage_count;
    const gnomon_count* counts;
    size_t count_count;
    double total_wall_ms;          ///< host time of the whole run, the building of kernels included
    uint64_t device_memory_bytes;  ///< gnomon's own buffers during the run, without the caller's
} gnomon_statistics;

void gnomon_statistics_destroy(const gnomon_statistics* statistics);

// ---- Devices --------------------------------------------------------------------------------------------------------

/// gnomon links no OpenCL library: it loads one when it first needs it, the file that the environment variable
/// GNOMON_OPENCL_LIBRARY names, else `library`, else the library that the program itself links, else the system's
/// libOpenCL.so.1. Only programs that must choose the file call this; after the first success it does nothing. NULL: no
/// file of the caller's. Fails with GNOMON_DEVICE_NOT_FOUND.
gnomon_status gnomon_opencl_load(const char* library);

/// One OpenCL device of this machine.
typedef struct gnomon_device_description {
    cl_platform_id platform_id;
    cl_device_id device_id;
    const char* selector;  ///< "P:D", platform and device index: what gnomon_device_open() accepts
    const char* platform;  ///< platform name
    const char* name;
    const char* vendor;
    const char* driver_version;
    const char* opencl_version;
    const char* opencl_c_version;
    const char* type;         ///< "CPU", "GPU", "accelerator" or "custom"
    const char* lacks;        ///< "" if the device can be used, else the features that it lacks
    const char* note;         ///< of an open device: features that its start-up check switched off, and why; else ""
    const char* why_default;  ///< of the default: the rule that chose it
    uint64_t global_memory_bytes, largest_allocation_bytes;
    uint32_t compute_units;
    bool has_fp64;
    bool shares_host_memory;  ///< CL_DEVICE_HOST_UNIFIED_MEMORY: the gnomon_*_share() copy nothing
    bool is_default;          ///< gnomon_device_open() without a selector opens this one
} gnomon_device_description;

/// What gnomon_devices() returns.
typedef struct gnomon_device_list {
    const gnomon_device_description* devices;
    size_t count;
} gnomon_device_list;

/// All devices of all platforms; an empty list if there is no OpenCL at all.
gnomon_status gnomon_devices_list(const gnomon_device_list** list_out);
void gnomon_device_list_destroy(const gnomon_device_list* list);

/// How a device is opened.
typedef struct gnomon_device_options {
    size_t struct_size;
    uint64_t memory_limit_bytes;  ///< refuse to allocate more than this on the device; 0: no limit
    uint32_t work_group_size;     ///< of every kernel, 0: chosen per device. Same bits for every size
    bool profile;                 ///< time kernels by events. A wrapped queue decides that itself. Slows small launches
    bool hide_fp64;               ///< use no double precision on the device. Same bits
    bool gpu_kernels;             ///< use the kernels made for GPUs on a CPU as well, for tests. Same bits
} gnomon_device_options;
/// The defaults, and the struct's size.
#define GNOMON_DEVICE_OPTIONS_INIT \
    { sizeof(gnomon_device_options), 0, 0, false, false, false }

/// A device, its context and in-order queue, and the compiled kernels (built when first used, cached on disk).
typedef struct gnomon_device gnomon_device;

/// Opens the device that `selector` names: "P:D", or a part of the device's or platform's name in any case; NULL or "":
/// the environment variable GNOMON_DEVICE, else the first usable GPU, else the first usable CPU. `options` may be NULL.
/// Fails with GNOMON_DEVICE_NOT_FOUND and the list of the devices.
gnomon_status gnomon_device_open(const char* selector, const gnomon_device_options* options,
                                 gnomon_device** device_out);
/// Uses the caller's context and in-order queue (both are retained). `options` may be NULL. Fails if they do not belong
/// together or the queue is out of order; with GNOMON_DEVICE_NOT_FOUND if the queue's device cannot be used.
gnomon_status gnomon_device_wrap(cl_context context, cl_command_queue queue, const gnomon_device_options* options,
                                 gnomon_device** device_out);
void gnomon_device_destroy(gnomon_device* device);

/// Valid until the device is destroyed.
gnomon_status gnomon_device_describe(const gnomon_device* device, const gnomon_device_description** description_out);
/// Not retained for the caller.
gnomon_status gnomon_device_context(const gnomon_device* device, cl_context* context_out);
gnomon_status gnomon_device_queue(const gnomon_device* device, cl_command_queue* queue_out);  ///< the same
/// Waits until the device has executed all that was enqueued.
gnomon_status gnomon_device_finish(const gnomon_device* device);
/// Bytes of device memory that gnomon's own buffers occupy now, and the largest number so far.
gnomon_status gnomon_device_memory(const gnomon_device* device, uint64_t* bytes_out, uint64_t* peak_bytes_out);

/// The builds of kernels that a device's runs waited for.
typedef struct gnomon_kernel_builds {
    uint32_t programs;    ///< compiled or loaded
    uint32_t from_cache;  ///< loaded from gnomon's cache on disk
    double ms;
} gnomon_kernel_builds;
/// Since the device was opened. May wait for the queue.
gnomon_status gnomon_device_kernel_builds(const gnomon_device* device, gnomon_kernel_builds* builds_out);

// ---- Triangles ------------------------------------------------------------------------------------------------------

/// Triangles on the device: 9 consecutive float32 each, three vertices in world space. A triangle's id is its index. A
/// triangle with a NaN or infinite vertex casts no shadow and is never seen.
typedef struct gnomon_triangles gnomon_triangles;

/// Copies 9 * count floats to the device. `vertices` may be NULL if count is 0.
gnomon_status gnomon_triangles_upload(const gnomon_device* device, const float* vertices, size_t count,
                                      gnomon_triangles** triangles_out);
/// Uses the caller's memory itself where device and host share memory, and copies it elsewhere. The caller must keep
/// it, unchanged, until the triangles are destroyed and no work that uses them is left. (Many drivers copy nothing only
/// if the memory begins at a multiple of 4096 bytes.) Experimental.
gnomon_status gnomon_triangles_share(const gnomon_device* device, const float* vertices, size_t count,
                                     gnomon_triangles** triangles_out);
/// Uses 9 * count floats of the caller's buffer (retained) from `first_float` on. The caller must not write them during
/// a run. Fails if the buffer is smaller or belongs to another context.
gnomon_status gnomon_triangles_wrap(const gnomon_device* device, cl_mem vertices, size_t count, size_t first_float,
                                    gnomon_triangles** triangles_out);
/// Copies a raster to the device, 4 bytes for each vertex. z is the height: vertex (row, column) stands at (x[column],
/// y[row], heights[row * columns + column]); x and y rise, or fall, from each value to the next, two or more each.
/// Square q = row * (columns - 1) + column has the triangles 2 q and 2 q + 1, which meet along the diagonal from (row,
/// column) to (row + 1, column + 1) if `joins_first_corner`, else along the other one. A table of lights is decided
/// without writing them out; what that saves, and which triangles these are, gnomon/inputs.hpp says (Raster).
/// Experimental.
gnomon_status gnomon_triangles_raster(const gnomon_device* device, const float* x, size_t columns, const float* y,
                                      size_t rows, const float* heights, bool joins_first_corner,
                                      gnomon_triangles** triangles_out);
void gnomon_triangles_destroy(gnomon_triangles* triangles);

// Cut-outs: triangles with holes, by the alpha of a texture. All is decided exactly (docs/numerics.md, 15).

#define GNOMON_NO_CUT_OUT 0xFFFFFFFFu  ///< the material of an opaque triangle
#define GNOMON_NO_TEXTURE 0xFFFFFFFFu  ///< a material's alpha is 255 everywhere

/// What a texture coordinate outside of 0..1 stands for.
typedef uint32_t gnomon_texture_wrap;
enum { GNOMON_WRAP_REPEAT = 0, GNOMON_WRAP_MIRROR = 1, GNOMON_WRAP_CLAMP = 2 };
/// The alpha between texels' centres: that of the nearest texel (of the greatest where a border is hit), or the exact
/// bilinear mean of four.
typedef uint32_t gnomon_texture_filter;
enum { GNOMON_FILTER_NEAREST = 0, GNOMON_FILTER_LINEAR = 1 };

/// A triangle of this material blocks, and is seen, at a point X only where texel(X) * alpha_factor * alpha of the
/// corners at X is at least the cutoff: texel(X) >= 255 cutoff / alpha_factor, which is rounded once to a multiple of
/// 2^-16. A cutoff up to 0: everywhere; a cutoff above 1, or a factor up to 0: nowhere.
typedef struct gnomon_cut_out_material {
    size_t struct_size;
    uint32_t texture;  ///< an index, or GNOMON_NO_TEXTURE: 255
    gnomon_texture_wrap wrap_u, wrap_v;
    gnomon_texture_filter filter;
    float cutoff, alpha_factor;
} gnomon_cut_out_material;
/// glTF's defaults: no texture, repeat, linear, cutoff .5, factor 1.
#define GNOMON_CUT_OUT_MATERIAL_INIT                                                                \
    {                                                                                               \
        sizeof(gnomon_cut_out_material), GNOMON_NO_TEXTURE, GNOMON_WRAP_REPEAT, GNOMON_WRAP_REPEAT, \
            GNOMON_FILTER_LINEAR, 0.5f, 1.0f                                                        \
    }

/// width * height alphas, row by row; the first texel is at (u, v) = (0, 0). Sides from 1 to 32768.
typedef struct gnomon_alpha_texture {
    uint32_t width, height;
    const uint8_t* alpha;
} gnomon_alpha_texture;
/// gnomon_alpha_texture in a buffer of width * height bytes.
typedef struct gnomon_alpha_texture_buffer {
    uint32_t width, height;
    cl_mem alpha;
} gnomon_alpha_texture_buffer;

/// The cut-outs of `count` triangles.
typedef struct gnomon_cut_outs {
    size_t struct_size;
    const uint32_t* material_of_triangle;  ///< count: an index of materials, or GNOMON_NO_CUT_OUT
    const float* texture_coordinates;      ///< 6 * count: u, v of each corner. NULL: no texture is used
    const float* corner_alphas;            ///< 3 * count, 0 to 1. NULL: 1
    const gnomon_cut_out_material* materials;
    size_t material_count;
    const gnomon_alpha_texture* textures;
    size_t texture_count;
} gnomon_cut_outs;
/// No cut-outs.
#define GNOMON_CUT_OUTS_INIT \
    { sizeof(gnomon_cut_outs), NULL, NULL, NULL, NULL, 0, NULL, 0 }
/// The same in buffers of the device's context, each from its beginning.
typedef struct gnomon_cut_out_buffers {
    size_t struct_size;
    cl_mem material_of_triangle, texture_coordinates, corner_alphas;
    const gnomon_cut_out_material* materials;
    size_t material_count;
    const gnomon_alpha_texture_buffer* textures;
    size_t texture_count;
} gnomon_cut_out_buffers;
/// No cut-outs.
#define GNOMON_CUT_OUT_BUFFERS_INIT \
    { sizeof(gnomon_cut_out_buffers), NULL, NULL, NULL, NULL, 0, NULL, 0 }

/// What became of the triangles that have a material: masked + opaque + clear is their number.
typedef struct gnomon_cut_out_counts {
    size_t masked;    ///< the texture decides, hit by hit
    size_t opaque;    ///< all over
    size_t clear;     ///< all over: they block nothing and are never seen
    size_t unusable;  ///< of the opaque: coordinates that are NaN or 2^30 texels or more away; alphas outside of 0..1
} gnomon_cut_out_counts;

/// gnomon_triangles_upload() with cut-outs, which are copied, too: 28 bytes for each masked triangle, and the textures.
/// Techniques that do not decide exactly take masked triangles for opaque ones.
gnomon_status gnomon_triangles_upload_cut_outs(const gnomon_device* device, const float* vertices, size_t count,
                                               const gnomon_cut_outs* cut_outs, gnomon_triangles** triangles_out);
/// The same from buffers, of which all is copied: 9 * count floats of `vertices` from `first_float` on, and the
/// cut-outs. Waits for the queue, since the host finds the triangles that are opaque or clear all over.
gnomon_status gnomon_triangles_copy_cut_outs(const gnomon_device* device, cl_mem vertices, size_t count,
                                             size_t first_float, const gnomon_cut_out_buffers* cut_outs,
                                             gnomon_triangles** triangles_out);
/// What became of the triangles that have a material; zeros without cut-outs.
gnomon_status gnomon_triangles_cut_out_counts(const gnomon_triangles* triangles, gnomon_cut_out_counts* counts_out);

/// For a mesh that does not change: builds boxes around clusters of triangles on the device, so that stages skip
/// clusters. Same bits. Worth it from about two views or lights on. The caller promises not to write the vertices from
/// now on; after a change, call this again.
gnomon_status gnomon_triangles_keep_clusters(gnomon_triangles* triangles, cl_event* event_out);

gnomon_status gnomon_triangles_count(const gnomon_triangles* triangles, size_t* count_out);  ///< of triangles
/// The buffer, and the float in it where the triangles begin.
gnomon_status gnomon_triangles_buffer(const gnomon_triangles* triangles, cl_mem* buffer_out, size_t* first_float_out);

// ---- Points ---------------------------------------------------------------------------------------------------------

/// Shading points on the device: position, and optionally the id of the triangle that the point lies on (its receiver,
/// which never shadows it). A point with a NaN or infinite coordinate is absent: visibility 1, no work. A receiver
/// alone darkens no point: that a point faces away from the light is decided by the run's gnomon_facing.
typedef struct gnomon_points gnomon_points;

/// Copies 3 * count floats, and `count` receivers (NULL: no point has one) to the device. `positions` may be NULL if
/// count is 0.
gnomon_status gnomon_points_upload(const gnomon_device* device, const float* positions, size_t count,
                                   const uint32_t* receivers, gnomon_points** points_out);
/// Experimental. As gnomon_triangles_share(), for both arrays.
gnomon_status gnomon_points_share(const gnomon_device* device, const float* positions, size_t count,
                                  const uint32_t* receivers, gnomon_points** points_out);
/// Uses the caller's buffers (retained). `layout` NULL: packed xyz triples from the buffer's beginning. `receivers`:
/// `count` uint32 from the buffer's beginning (a sub-buffer for another place), or NULL: no point has one. Fails if a
/// buffer is smaller than that or belongs to another context.
gnomon_status gnomon_points_wrap(const gnomon_device* device, cl_mem positions, const gnomon_point_layout* layout,
                                 size_t count, cl_mem receivers, gnomon_points** points_out);
void gnomon_points_destroy(gnomon_points* points);

/// Sets the camera of the picture of width x height pixels that the points belong to. GNOMON_FACING_AUTOMATIC takes its
/// eye, and shadow maps that are fitted to the view need it. A view's points have it set.
gnomon_status gnomon_points_set_camera(gnomon_points* points, const gnomon_camera* camera, uint32_t width,
                                       uint32_t height);
/// The caller promises that no point lies on the far side of its receiver, a triangle of `triangles`, as `eye` sees it.
/// Saves runs whose points face by this eye time; lasts until a camera is set. A view's points have it set.
gnomon_status gnomon_points_set_lifted_off(gnomon_points* points, const gnomon_triangles* triangles,
                                           const float eye[3]);

gnomon_status gnomon_points_count(const gnomon_points* points, size_t* count_out);  ///< of points
/// The buffer, not retained for the caller, and how the coordinates lie in it.
gnomon_status gnomon_points_positions(const gnomon_points* points, cl_mem* buffer_out, gnomon_point_layout* layout_out);
/// NULL if no point has a receiver.
gnomon_status gnomon_points_receivers(const gnomon_points* points, cl_mem* buffer_out);
/// Waits for the queue and copies to the host: 3 floats and one uint32 per point. Either may be NULL.
gnomon_status gnomon_points_read(const gnomon_points* points, float* positions_out, uint32_t* receivers_out);

/// Lifts the points off their receivers as a view's points are: along the receiver's normal towards `eye`, by a proven
/// bound of a few float32 ulps (docs/numerics.md, 9). The result shares the receivers. Fails if there are no receivers.
gnomon_status gnomon_points_lift(const gnomon_points* points, const gnomon_triangles* triangles, const float eye[3],
                                 gnomon_points** lifted_out, cl_event* event_out);

// ---- Visibility -----------------------------------------------------------------------------------------------------

/// Visibility per point, one float32 each: 1 lit, 0 in shadow; filtered techniques write values between.
typedef struct gnomon_visibility gnomon_visibility;

/// A new buffer of `count` floats on the device.
gnomon_status gnomon_visibility_create(const gnomon_device* device, size_t count, gnomon_visibility** visibility_out);
/// Uses `count` floats of the caller's buffer (retained) from `first_float` on: the device writes the result there.
/// first_float * 4 must be a multiple of the device's CL_DEVICE_MEM_BASE_ADDR_ALIGN / 8 (gnomon makes a sub-buffer).
/// Fails if it is not, or if the buffer is smaller or belongs to another context.
gnomon_status gnomon_visibility_wrap(const gnomon_device* device, cl_mem buffer, size_t count, size_t first_float,
                                     gnomon_visibility** visibility_out);
/// The results' place is the caller's `values`, which must be kept until the visibility is destroyed. They are there
/// after gnomon_visibility_fetch(), from then on until the next run; where device and host share memory, nothing is
/// copied. Experimental.
gnomon_status gnomon_visibility_share(const gnomon_device* device, float* values, size_t count,
                                      gnomon_visibility** visibility_out);
/// Waits for the queue. Fails if gnomon_visibility_share() did not make the visibility.
gnomon_status gnomon_visibility_fetch(const gnomon_visibility* visibility);
void gnomon_visibility_destroy(gnomon_visibility* visibility);
gnomon_status gnomon_visibility_count(const gnomon_visibility* visibility, size_t* count_out);  ///< of values
/// The buffer whose first `count` floats are the visibility: the caller's own, or gnomon's (sub-)buffer.
gnomon_status gnomon_visibility_buffer(const gnomon_visibility* visibility, cl_mem* buffer_out);
/// Waits for the queue and copies `count` floats to the host.
gnomon_status gnomon_visibility_read(const gnomon_visibility* visibility, float* values_out);

// ---- Facing ---------------------------------------------------------------------------------------------------------

/// Points that are vertices of a mesh, and the fan of each: the triangles that have the point as a corner. By contract
/// none of these shadows the point, and GNOMON_FACING_FANS decides facing.
typedef struct gnomon_vertex_fans gnomon_vertex_fans;

/// Finds the fans of `count` points (3 floats each) among triangles (9 floats each), by equal coordinates. Triangles
/// with a vertex that is not finite are left out.
gnomon_status gnomon_vertex_fans_find(const gnomon_device* device, const float* vertices, size_t triangle_count,
                                      const float* points, size_t count, gnomon_vertex_fans** fans_out);
void gnomon_vertex_fans_destroy(gnomon_vertex_fans* fans);
/// The points that no triangle has as a corner, ascending: they face every light. The array is the fans'.
gnomon_status gnomon_vertex_fans_alone(const gnomon_vertex_fans* fans, const uint32_t** points_out, size_t* count_out);
/// The points with triangles that do not close around them, ascending: at a border or a hole, or where windings
/// disagree or more than two triangles share an edge. The array is the fans'.
gnomon_status gnomon_vertex_fans_open(const gnomon_vertex_fans* fans, const uint32_t** points_out, size_t* count_out);
/// The number of points for which the last run that faced by these fans used the extension (of several lights: the last
/// light).
gnomon_status gnomon_vertex_fans_extended(const gnomon_vertex_fans* fans, uint64_t* count_out);

/// By what a run decides that a point faces away from a light, so that its visibility is 0. All is decided exactly.
/// Without facing, a point behind its own surface may be lit.
typedef uint32_t gnomon_facing_kind;
enum {
    GNOMON_FACING_AUTOMATIC = 0,  ///< by the eye of the camera that the points came from, else none
    GNOMON_FACING_NONE = 1,
    GNOMON_FACING_EYE = 2,      ///< dark unless eye and light are strictly on one side of the point's receiver
    GNOMON_FACING_NORMALS = 3,  ///< dark unless the light is strictly on the side of the point's normal
    GNOMON_FACING_WINDING =
        4,                  ///< dark unless the light is strictly in front of the receiver: counter-clockwise corners
    GNOMON_FACING_FANS = 5  ///< dark unless the light is strictly in front of the vertex's fan (docs/numerics.md, 14)
};
/// Without a receiver, and with a normal that is not finite, a point faces every light. The members that the kind does
/// not name are not read. What a facing points to must be there until the run has returned.
typedef struct gnomon_facing {
    gnomon_facing_kind kind;
    float eye[3];                               ///< EYE
    const float* normals;                       ///< NORMALS: 3 floats a point, of any length; or NULL, and in a buffer:
    cl_mem normals_buffer;                      ///< NORMALS
    const gnomon_point_layout* normals_layout;  ///< of the buffer; NULL: packed xyz triples from its beginning
    /// FANS: of the run's points, found among its triangles; their front is where corners run counter-clockwise, and
    /// the extension for an open fan is: in front of the planes of all its triangles.
    const gnomon_vertex_fans* fans;
    /// FANS: NULL, or 3 floats: the mesh is a height field in this direction, whatever its winding. The light must be
    /// strictly above the one or two triangles over which the ray leaves; the extension where it leaves over none:
    /// above the planes of all.
    const float* up;
} gnomon_facing;

/// Called now and then with the part that is done, 0 to 1, after the device has finished it; a run of one light calls
/// it once, with 1. A result other than 0 stops the run (GNOMON_STOPPED); the outputs' contents are then not defined.
typedef int (*gnomon_progress)(double done, void* user_data);

/// How a run goes, for one light or many.
typedef struct gnomon_run_options {
    size_t struct_size;
    gnomon_facing facing;
    gnomon_progress progress;  ///< NULL: none
    void* user_data;           ///< for `progress`
} gnomon_run_options;
/// Points face by the eye of their camera, if they have one.
#define GNOMON_FACING_INIT \
    { GNOMON_FACING_AUTOMATIC, {0, 0, 0}, NULL, NULL, NULL, NULL, NULL }
/// The same facing, no progress.
#define GNOMON_RUN_OPTIONS_INIT \
    { sizeof(gnomon_run_options), GNOMON_FACING_INIT, NULL, NULL }

/// A light and the visibility that belongs to it.
typedef struct gnomon_light_visibility {
    gnomon_light light;
    const gnomon_visibility* visibility;
} gnomon_light_visibility;

// ---- Techniques -----------------------------------------------------------------------------------------------------

/// A setting of a technique, or a picture that gnomon_technique_diagnose() draws.
typedef struct gnomon_setting_description {
    const char* name;
    const char* default_value;
    const char* meaning;  ///< one line with range and unit
} gnomon_setting_description;
/// A picture that gnomon_technique_diagnose() draws.
typedef struct gnomon_diagnostic_description {
    const char* name;
    const char* meaning;  ///< one line
} gnomon_diagnostic_description;

/// One technique: its name, what it is, its settings and pictures.
typedef struct gnomon_technique_description {
    const char* name;
    const char* summary;  ///< one line
    const gnomon_setting_description* settings;
    size_t setting_count;
    const gnomon_diagnostic_description* diagnostics;
    size_t diagnostic_count;
    bool exact;
} gnomon_technique_description;

/// What gnomon_techniques() returns.
typedef struct gnomon_technique_list {
    const gnomon_technique_description* techniques;
    size_t count;
} gnomon_technique_list;

/// Adds the classic techniques, which are to be measured beside the exact one, to those that gnomon_techniques_list()
/// lists and gnomon_technique_create() makes. In the library gnomon_full, not in gnomon. Any thread may call it, and
/// more than once. Experimental.
gnomon_status gnomon_rivals_add(void);
/// Every technique that was added; the first is the default, "frustum-traced".
gnomon_status gnomon_techniques_list(const gnomon_technique_list** list_out);
void gnomon_technique_list_destroy(const gnomon_technique_list* list);

/// One way to compute visibility.
typedef struct gnomon_technique gnomon_technique;

/// Fails with the list of names if there is no technique of this name.
gnomon_status gnomon_technique_create(const gnomon_device* device, const char* name, gnomon_technique** technique_out);
void gnomon_technique_destroy(gnomon_technique* technique);
/// Changes a setting. Fails with the setting and its range.
gnomon_status gnomon_technique_set(gnomon_technique* technique, const char* name, const char* value);

/// Writes the visibility of every point. Fails if visibility has fewer entries than there are points or overlaps an
/// input, if the light is none that its makers could have made, or if the facing does not fit the points.
gnomon_status gnomon_technique_run(gnomon_technique* technique, const gnomon_triangles* triangles,
                                   const gnomon_points* points, gnomon_light light, const gnomon_visibility* visibility,
                                   const gnomon_run_options* options, cl_event* event_out,
                                   const gnomon_statistics** statistics_out);
/// gnomon_technique_run() for `count` lights and the same points: each visibility has the same bits as from a run of
/// its own; work that all lights share is done once. statistics_out: NULL, or an array of `count` pointers, each to be
/// destroyed. Fails also if two visibilities overlap.
gnomon_status gnomon_technique_run_each_light(gnomon_technique* technique, const gnomon_triangles* triangles,
                                              const gnomon_points* points, const gnomon_light_visibility* lights,
                                              size_t count, const gnomon_run_options* options, cl_event* event_out,
                                              const gnomon_statistics** statistics_out);
/// Prepares the light: stores what depends on these triangles and this light alone, so that later runs with both do
/// less work. Same bits. The caller promises not to change the triangles' buffer until
/// gnomon_technique_release_prepared_light(), gnomon_technique_set(), another prepare or the technique's end; each of
/// these frees the memory.
gnomon_status gnomon_technique_prepare(gnomon_technique* technique, const gnomon_triangles* triangles,
                                       gnomon_light light, cl_event* event_out,
                                       const gnomon_statistics** statistics_out);
/// Frees the prepared light, and all else that the technique keeps of earlier runs.
gnomon_status gnomon_technique_release_prepared_light(gnomon_technique* technique);
/// Draws how the technique works for each point: 4 bytes (sRGB and alpha) per point to the host. Of the options it
/// takes a facing by an eye, or none. Fails if there is no diagnostic of this name, or if it needs points that a camera
/// made. Experimental.
gnomon_status gnomon_technique_diagnose(gnomon_technique* technique, const char* name,
                                        const gnomon_triangles* triangles, const gnomon_points* points,
                                        gnomon_light light, const gnomon_run_options* options, uint8_t* rgba_out);

// ---- Many lights at once (experimental) -----------------------------------------------------------------------------

/// Lights with a weight each. Weights are rounded once, for the whole table, to whole numbers times a power of two, so
/// that a sum of them does not depend on its order (docs/many_lights.md). It belongs to no device.
typedef struct gnomon_lights gnomon_lights;

/// `weights` NULL: 1 each. Fails, naming the index, for a light that its makers could not have made or a weight that is
/// not finite.
gnomon_status gnomon_lights_create(const gnomon_light* lights, const float* weights, size_t count,
                                   gnomon_lights** lights_out);
/// A disk in the sky, such as the sun's (0.533 degrees across): `samples` directional lights around the one that
/// travels along `direction`, weight 1 each, by Vogel's spiral. Fails if the direction is zero or not finite, the angle
/// not between 0 and 90 degrees (exclusive), or `samples` 0.
gnomon_status gnomon_lights_sun_disk(const float direction[3], double angle_degrees, uint32_t samples,
                                     gnomon_lights** lights_out);
/// A parallelogram that shines: `samples` point lights on corner + a edge_a + b edge_b, weight 1 each, by Hammersley's
/// points. Fails if a coordinate is not finite, or `samples` 0.
gnomon_status gnomon_lights_area(const float corner[3], const float edge_a[3], const float edge_b[3], uint32_t samples,
                                 gnomon_lights** lights_out);
/// The sky's hemisphere around `up` in division^2 times as many patches as Tregenza's 145, as Reinhart divides each; a
/// weight is the patch's solid angle times the cosine of its angle to `up`, over pi. The first patch of each row lies
/// at the azimuth of `north`. Fails if a direction is zero or not finite, the two are parallel, or the division is not
/// from 1 to 16.
gnomon_status gnomon_lights_sky(const float up[3], const float north[3], uint32_t division, gnomon_lights** lights_out);
void gnomon_lights_destroy(gnomon_lights* lights);

gnomon_status gnomon_lights_count(const gnomon_lights* lights, size_t* count_out);  ///< of lights
/// Copies the lights and their weights, as they were given. Either may be NULL.
gnomon_status gnomon_lights_read(const gnomon_lights* lights, gnomon_light* lights_out, float* weights_out);
/// A weight counts as a whole number times 2^exponent; `largest` is the most by which one was rounded.
gnomon_status gnomon_lights_rounding(const gnomon_lights* lights, int32_t* exponent_out, double* largest_out);

/// No light reaches the point: in first_lit and last_lit.
#define GNOMON_NO_LIGHT 0xFFFFFFFFu

/// What a run over m lights writes for n points; one that is NULL is not written. Buffers of the caller's, from their
/// beginning on.
typedef struct gnomon_light_table_buffers {
    size_t struct_size;
    cl_mem bits;       ///< uint32, n rows of (m + 31) / 32: light l is bit l % 32 of word l / 32; 1 lit
    cl_mem counts;     ///< uint32, n: the number of lights that reach the point
    cl_mem sums;       ///< double, n: the sum of their weights, exact before this one rounding
    cl_mem first_lit;  ///< uint32, n: the smallest index of these, or GNOMON_NO_LIGHT
    cl_mem last_lit;   ///< uint32, n: the largest
    bool cosines;      ///< sums add each weight times max(0, n . l): needs GNOMON_FACING_NORMALS, directional lights
} gnomon_light_table_buffers;
/// No outputs.
#define GNOMON_LIGHT_TABLE_BUFFERS_INIT \
    { sizeof(gnomon_light_table_buffers), NULL, NULL, NULL, NULL, NULL, false }
/// The same in arrays on the host.
typedef struct gnomon_light_table_arrays {
    size_t struct_size;
    uint32_t* bits;
    uint32_t* counts;
    double* sums;
    uint32_t* first_lit;
    uint32_t* last_lit;
    bool cosines;
} gnomon_light_table_arrays;
/// No outputs.
#define GNOMON_LIGHT_TABLE_ARRAYS_INIT \
    { sizeof(gnomon_light_table_arrays), NULL, NULL, NULL, NULL, NULL, false }

/// Decides all pairs of a point and a light: bit for bit what a run with one light after the other gives, and sums that
/// depend on no order. Nothing of the size points x lights is held unless `bits` is wanted. Fails as
/// gnomon_technique_run() does, or if a buffer is too small or overlaps an input.
gnomon_status gnomon_technique_run_light_table(gnomon_technique* technique, const gnomon_triangles* triangles,
                                               const gnomon_points* points, const gnomon_lights* lights,
                                               const gnomon_light_table_buffers* outputs,
                                               const gnomon_run_options* options,
                                               const gnomon_statistics** statistics_out);
/// The same with outputs on the host.
gnomon_status gnomon_technique_run_light_table_to_host(gnomon_technique* technique, const gnomon_triangles* triangles,
                                                       const gnomon_points* points, const gnomon_lights* lights,
                                                       const gnomon_light_table_arrays* outputs,
                                                       const gnomon_run_options* options,
                                                       const gnomon_statistics** statistics_out);
/// Soft shadows: writes to `mean` the share of the lights that reach each point, rounded once; weights are not read.
gnomon_status gnomon_technique_run_mean(gnomon_technique* technique, const gnomon_triangles* triangles,
                                        const gnomon_points* points, const gnomon_lights* lights,
                                        const gnomon_visibility* mean, const gnomon_run_options* options,
                                        cl_event* event_out, const gnomon_statistics** statistics_out);

// ---- Views ----------------------------------------------------------------------------------------------------------

/// The view of a camera: per pixel (row by row from the top) the nearest triangle and the shading point on it.
typedef struct gnomon_view gnomon_view;

/// Runs the camera stages. Fails if width or height is 0 or over 16384, or if the camera breaks its rules.
gnomon_status gnomon_view_look(const gnomon_device* device, const gnomon_triangles* triangles,
                               const gnomon_camera* camera, uint32_t width, uint32_t height, gnomon_view** view_out,
                               cl_event* event_out, const gnomon_statistics** statistics_out);
void gnomon_view_destroy(gnomon_view* view);
/// The view's width * height points; absent (NaN) where the pixel shows the sky. They belong to the view: valid until
/// it is destroyed.
gnomon_status gnomon_view_points(const gnomon_view* view, const gnomon_points** points_out);
/// Waits for the queue and copies to the host: per pixel 3 floats of position, 3 of unit normal, and the receiver; sky:
/// 0 and GNOMON_NO_RECEIVER. Each may be NULL. `triangles` are those of the view.
gnomon_status gnomon_view_read(const gnomon_view* view, const gnomon_triangles* triangles, float* positions_out,
                               float* normals_out, uint32_t* receivers_out);

/// Base colours: one material id per triangle, and 3 floats of linear RGB per material.
typedef struct gnomon_materials {
    size_t struct_size;
    const uint32_t* triangle_material;
    size_t triangle_count;
    const float* base_color;
    size_t material_count;
} gnomon_materials;
/// No materials.
#define GNOMON_MATERIALS_INIT \
    { sizeof(gnomon_materials), NULL, 0, NULL, 0 }
/// In the library gnomon_full, not in gnomon. Experimental.
/// Shades the view: the sum of the lights' Lambert terms with visibility, plus ambient, as 4 bytes (8-bit sRGB and
/// alpha) per pixel on the host.
gnomon_status gnomon_view_shade(const gnomon_view* view, const gnomon_triangles* triangles,
                                const gnomon_light_visibility* lights, size_t light_count,
                                const gnomon_materials* materials, uint8_t* rgba_out);

/// gnomon_view_look() for picture after picture: keeps lists and buffers, so that the next picture of the same size
/// allocates nothing. Same bits. A view's buffers are used again when it is destroyed.
typedef struct gnomon_camera_pass gnomon_camera_pass;
/// A pass that keeps nothing yet.
gnomon_status gnomon_camera_pass_create(const gnomon_device* device, gnomon_camera_pass** pass_out);
void gnomon_camera_pass_destroy(gnomon_camera_pass* pass);
/// As gnomon_look().
gnomon_status gnomon_camera_pass_look(gnomon_camera_pass* pass, const gnomon_triangles* triangles,
                                      const gnomon_camera* camera, uint32_t width, uint32_t height,
                                      gnomon_view** view_out, cl_event* event_out,
                                      const gnomon_statistics** statistics_out);

// ---- Several samples per pixel (experimental) -----------------------------------------------------------------------

/// The offset of a sample from its pixel's centre, in 1/64 pixel, x to the right and y down, each from -32 to 31.
typedef struct gnomon_sample_offset {
    int32_t x, y;
} gnomon_sample_offset;
/// In the library gnomon_full, not in gnomon. Writes the pattern of `samples` = 1, 4, 8, 16 or 32 offsets. Fails for
/// another number.
gnomon_status gnomon_sample_pattern(uint32_t samples, gnomon_sample_offset* offsets_out);

/// Receives the points of some samples before their visibility is computed: sample by sample in the pattern's order,
/// each pixel by pixel. The points are valid during the call. A result other than 0 stops the run (GNOMON_STOPPED).
typedef int (*gnomon_sample_sink)(const gnomon_points* points, void* user_data);
/// How gnomon_technique_run_samples() goes.
typedef struct gnomon_samples_options {
    size_t struct_size;
    uint32_t samples;         ///< per pixel, as gnomon_sample_pattern() takes them
    gnomon_sample_sink sink;  ///< NULL: none
    void* user_data;          ///< for `sink`
} gnomon_samples_options;
/// 4 samples per pixel, no sink.
#define GNOMON_SAMPLES_OPTIONS_INIT \
    { sizeof(gnomon_samples_options), 4, NULL, NULL }
/// In the library gnomon_full, not in gnomon. Anti-aliased shadows: writes to `mean` the mean visibility of each
/// pixel's samples. Points face by the view's eye. Fails as gnomon_technique_run() and gnomon_sample_pattern() do.
gnomon_status gnomon_technique_run_samples(gnomon_technique* technique, const gnomon_triangles* triangles,
                                           const gnomon_view* view, gnomon_light light, const gnomon_visibility* mean,
                                           const gnomon_samples_options* options, cl_event* event_out,
                                           const gnomon_statistics** statistics_out);

// ---- Why a point is lit or in shadow --------------------------------------------------------------------------------

/// The exact signs (-1, 0 or 1) of a triangle for the shadow ray of a point. The triangle blocks the ray if point_side
/// and light_side are opposite and no edge has the sign -light_side (docs/numerics.md, 1).
typedef struct gnomon_triangle_signs {
    uint32_t triangle;  ///< GNOMON_NO_RECEIVER: there is none
    float vertices[9];
    bool blocks;
    bool is_clear;  ///< a cut-out that the ray meets where it is clear, so that it does not block
    int32_t point_side, light_side, edges[3];
    const char* arithmetic;  ///< what the predicate needed to be certain: "float", "double" or "integers"
    double distance;         ///< from the point along the ray, rounded; 0 unless the ray meets it
} gnomon_triangle_signs;

/// The facts by which "frustum-traced" found a point lit or in shadow.
typedef struct gnomon_explanation {
    float position[3];
    uint32_t receiver;
    gnomon_triangle_signs on_receiver;  ///< its receiver, which never blocks
    int32_t eye_side;                   ///< the eye's side of the receiver; 0 without an eye
    bool is_backfacing;
    bool is_consistent;  ///< the visibility agrees with the signs; if not, gnomon is wrong
    float visibility;
    const gnomon_triangle_signs* occluders;  ///< all triangles that block the shadow ray, nearest first
    size_t occluder_count;
    const gnomon_triangle_signs* near_misses;  ///< all others for which floats were not certain
    size_t near_miss_count;
    const char* stage;       ///< the stage that decided
    const char* arithmetic;  ///< the arithmetic that was certain: "none", "filter", "float", "double", "integers"
    const gnomon_triangle_signs* clear_hits;  ///< all that the ray meets where they are cut out, nearest first
    size_t clear_hit_count;
} gnomon_explanation;

/// Explains the point at `index`. Runs "frustum-traced" on all points. Of the options it takes a facing by an eye, or
/// none. Fails if there is no such point.
gnomon_status gnomon_points_explain(const gnomon_points* points, const gnomon_triangles* triangles, size_t index,
                                    gnomon_light light, const gnomon_run_options* options,
                                    const gnomon_explanation** explanation_out);
void gnomon_explanation_destroy(const gnomon_explanation* explanation);

// ---- Scenes larger than the device's memory (experimental) ----------------------------------------------------------

/// A scene that stays on the host: the device stores as many of its triangles at a time as fit.
typedef struct gnomon_host_scene {
    size_t struct_size;
    const float* vertices;  ///< 9 * count
    size_t count;
    const gnomon_cut_outs* cut_outs;  ///< of all these triangles; NULL: none
} gnomon_host_scene;
/// No triangles.
#define GNOMON_HOST_SCENE_INIT \
    { sizeof(gnomon_host_scene), NULL, 0, NULL }

/// The view of a scene that stays on the host. The whole belongs to gnomon_view_of_parts_destroy().
typedef struct gnomon_view_of_parts {
    const gnomon_view* view;            ///< its receivers are indices in `ids`
    const gnomon_triangles* triangles;  ///< the triangles of `ids`, on the device: for reading and shading this view
    const uint32_t* ids;                ///< ids in the whole scene, ascending
    size_t id_count;
} gnomon_view_of_parts;

/// gnomon_view_look() for such a scene, same bits.
gnomon_status gnomon_host_scene_look(const gnomon_device* device, const gnomon_host_scene* scene,
                                     const gnomon_camera* camera, uint32_t width, uint32_t height,
                                     const gnomon_view_of_parts** view_out);
void gnomon_view_of_parts_destroy(const gnomon_view_of_parts* view);

/// A technique's setting and its value, as gnomon_technique_set() takes them.
typedef struct gnomon_setting {
    const char* name;
    const char* value;
} gnomon_setting;
/// How gnomon_host_scene_run() goes.
typedef struct gnomon_host_scene_options {
    size_t struct_size;
    const char* technique;  ///< NULL: "frustum-traced"
    const gnomon_setting* settings;
    size_t setting_count;
    const uint32_t* ids;  ///< a receiver r of the points is triangle ids[r] of the scene; NULL: triangle r
    size_t id_count;
    const gnomon_run_options* run;  ///< NULL: GNOMON_RUN_OPTIONS_INIT; no GNOMON_FACING_FANS. Progress counts triangles
} gnomon_host_scene_options;
/// frustum-traced with its default settings.
#define GNOMON_HOST_SCENE_OPTIONS_INIT \
    { sizeof(gnomon_host_scene_options), NULL, NULL, 0, NULL, 0, NULL }
/// gnomon_technique_run() for such a scene; as many points at a time as fit, too. Same bits for an exact technique. The
/// visibility is there when the function returns.
gnomon_status gnomon_host_scene_run(const gnomon_device* device, const gnomon_host_scene* scene,
                                    const gnomon_points* points, gnomon_light light,
                                    const gnomon_visibility* visibility, const gnomon_host_scene_options* options,
                                    const gnomon_statistics** statistics_out);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
