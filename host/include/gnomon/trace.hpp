// SPDX-License-Identifier: MIT
// Runs: which points the lights reach, by which technique, and why. Stable; diagnose(), run_mean(): experimental.
#pragma once

#include <functional>

#include <gnomon/inputs.hpp>
#include <gnomon/lights.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

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
    /// Host time of the call, the building of kernels included. Most runs end when the device has finished them (which
    /// do: the table of waits in gnomon.hpp); what is enqueued last, for normals, winding or fans, is then left out.
    double total_wall_ms = 0;
    std::uint64_t device_memory_bytes = 0;  ///< gnomon's own buffers during the run, without the caller's

    /// The count of that name, 0 if there is none.
    std::uint64_t count(std::string_view name) const;
};

// ---- Facing ---------------------------------------------------------------------------------------------------------

/// Points that are vertices of a mesh, and the fan of each: the triangles that have the point as a corner. By contract
/// none of these shadows the point, so the point needs no lift; Facing::fans() decides facing. Copies share buffers.
class VertexFans {
public:
    /// Finds the fans of `points` (3 floats each) among the triangles of `vertices` (9 floats each), by equal
    /// coordinates, and copies them to the device. Triangles with a NaN or infinite vertex are left out. Takes time in
    /// proportion to both numbers. Throws InvalidArgument if a size is no multiple, or for 2^31 corners or more.
    static VertexFans find(const Device& device, std::span<const float> vertices, std::span<const float> points);

    std::size_t count() const { return count_; }  ///< of points
    /// The points that no triangle has as a corner, ascending: they face every light.
    const std::vector<std::uint32_t>& alone() const { return alone_; }
    /// The points with triangles that do not close around them, ascending: at a border or a hole, or where windings
    /// disagree or more than two triangles share an edge.
    const std::vector<std::uint32_t>& open() const { return open_; }
    /// The points for which the last run that faced by these fans used the extension (of several lights: the last
    /// light). Waits for the queue.
    std::uint64_t extended() const;

private:
    friend struct Internals;

    std::optional<Device> device_;
    std::shared_ptr<void> fans_, corners_, extended_;
    std::vector<std::uint32_t> alone_, open_;
    std::size_t count_ = 0, triangles_ = 0;
};

/// By what a run decides that a point faces away from a light: it is then backfacing, and its visibility is 0 by
/// definition of shading. All is decided exactly. A receiver alone only excludes its triangle: without facing, a point
/// behind its own surface may be lit. Absent points are not backfacing. A facing refers to the arrays, buffers and fans
/// that it is made of: they must be there until the run has returned.
class Facing {
public:
    Facing() = default;  ///< automatic()
    /// By the eye of the camera that the points came from (Points::camera()), else none().
    static Facing automatic() { return {}; }
    /// No point is backfacing.
    static Facing none() { return Facing(Kind::none); }
    /// A point is backfacing if its receiver's plane separates the light from this eye, or contains one of the two.
    /// Points without a receiver are not.
    static Facing eye(const Float3& eye);
    /// A point is backfacing unless the light is strictly on the side of its normal n, of any length: n . D > 0 with D
    /// towards the light. Points whose normal has a NaN or infinite coordinate are not. Three floats per point, which
    /// each run copies to the device.
    static Facing normals(std::span<const float> normals);
    /// The same for normals on the device, which lie in the buffer as `layout` describes.
    static Facing normals(cl_mem normals, const PointLayout& layout = {});
    /// The counter-clockwise side of each triangle is its front: a point is backfacing unless the light is strictly in
    /// front of its receiver. Points without a receiver are not.
    static Facing winding() { return Facing(Kind::winding); }
    /// For points that are vertices of a mesh (docs/numerics.md, 14), among whose triangles, those of the run, `fans`
    /// were found: a point is backfacing unless the light, seen from the vertex, is strictly in front of its fan, whose
    /// front is where corners run counter-clockwise. The extension for an open fan: the light must be strictly in front
    /// of the planes of all its triangles.
    /// With `up`, the mesh is a height field in that direction, whatever its winding: the light must be strictly above
    /// the one or two triangles over which the ray leaves. The extension where it leaves over none of them: it must be
    /// strictly above the planes of all. Vertical triangles are left out; a fan with one counts as extended.
    static Facing fans(const VertexFans& fans, const std::optional<Float3>& up = {});
    static Facing fans(VertexFans&&, const std::optional<Float3>& up = {}) = delete;  ///< the run reads them later

private:
    friend struct Internals;
    enum class Kind : std::uint8_t { automatic, none, eye, normals_on_host, normals, winding, fans };
    explicit Facing(Kind kind) : kind_(kind) {}

    Kind kind_ = Kind::automatic;
    Float3 eye_{};
    std::span<const float> host_normals_;
    cl_mem normals_ = nullptr;
    PointLayout normals_layout_;
    const VertexFans* fans_ = nullptr;
    std::optional<Float3> up_;
};

/// How a run goes, for one light or many.
struct RunOptions {
    Facing facing{};
    /// Called now and then with the part that is done, 0 to 1, after the device has finished it (so the run waits); a
    /// run of one light calls it once, with 1. False ends the run: it throws Cancelled.
    std::function<bool(double)> progress{};
};

// ---- Tables of lights -----------------------------------------------------------------------------------------------

/// What a run over many lights writes; all buffers are the caller's, and one that is null is not written. For n points
/// and m lights:
struct LightsOutputs {
    cl_mem bits = nullptr;       ///< uint32, n rows of ceil(m / 32): light l is bit l % 32 of word l / 32; 1 lit
    cl_mem counts = nullptr;     ///< uint32, n: the number of lights that reach the point
    cl_mem sums = nullptr;       ///< float64, n: the sum of their weights, exact before this one rounding
    cl_mem first_lit = nullptr;  ///< uint32, n: the smallest index of these, or no_light
    cl_mem last_lit = nullptr;   ///< uint32, n: the largest
    /// `sums` adds each weight times max(0, n . l), at most 1, with the light's unit direction l and the normal n as it
    /// is, in float32: x + y + z of the three products, each operation rounded once; times the weight, rounded once;
    /// and that rounded once to a whole number times 2^exponent(). Needs Facing::normals() and directional lights.
    bool cosines = false;
};

// ---- Techniques -----------------------------------------------------------------------------------------------------

/// A setting of a technique, as `gnomon techniques` lists it and --set changes it.
struct SettingDescription {
    std::string name;
    std::string default_value;
    std::string meaning;  ///< one line with range and unit
};

struct LightsOptions;  // private

/// One way to compute visibility. All share this interface, so one benchmark, viewer and test harness serves all. Which
/// of its functions wait for the device: the table of waits in gnomon.hpp.
class Technique {
public:
    virtual ~Technique() = default;
    /// The device that it was made for.
    virtual const Device& device() const = 0;
    /// Writes visibility (points.count() floats) and returns the statistics. The visibility is complete when the
    /// device's queue has executed the run. Throws InvalidArgument if visibility has fewer entries than there are
    /// points or overlaps an input, if the light is neither directional nor a point light, or if the facing does not
    /// fit the points.
    Statistics run(const Triangles& triangles, const Points& points, const Light& light, const Visibility& visibility,
                   const RunOptions& options = {});
    /// run() for several lights and the same points: visibilities[i] belongs to lights[i] and has the same bits as from
    /// run(). Work that all lights share is done once where the technique can. Returns the statistics of each light.
    /// Throws InvalidArgument if the numbers of visibilities and lights differ, or two visibilities overlap.
    std::vector<Statistics> run_each_light(const Triangles& triangles, const Points& points,
                                           std::span<const Light> lights, std::span<const Visibility> visibilities,
                                           const RunOptions& options = {});
    /// Answers all lights of a table for all points at once. Each bit is that of run() for the one light with the same
    /// facing (a technique with values between 0 and 1: at least 1/2). frustum-traced takes the faster of several ways
    /// (its setting many-lights). Never stores points x lights values: the points pass in parts. Throws as run() does,
    /// or if a buffer is too small, InvalidArgument.
    Statistics run_light_table(const Triangles& triangles, const Points& points, const Lights& lights,
                               const LightsOutputs& outputs, const RunOptions& options = {});
    /// Prepares the light: stores the data that depend on these triangles and this light alone, so that later runs with
    /// both do less work (a scene that does not change while the camera moves). Same bits, prepared or not. Runs with
    /// other triangles or another light do not use the prepared light and do not change it. The caller promises not to
    /// change the triangles' buffer until release_prepared_light(), set(), another prepare() or the technique's end;
    /// each of these frees the memory, which counts in device_memory_bytes of every run until then. If points lie far
    /// outside the triangles' bounds or far below their own receiver, the run ignores the prepared light; the count
    /// prepared_fallback_points is the number of such points. Most techniques store nothing. Returns the statistics.
    /// Throws as run() does; the light is not prepared then.
    virtual Statistics prepare(const Triangles& triangles, const Light& light);
    /// Frees the prepared light, and all else that the technique keeps of the triangles and points of earlier runs.
    virtual void release_prepared_light() {}
    /// Changes a setting. Throws InvalidArgument, naming the setting and its range.
    virtual void set(std::string_view name, std::string_view value) = 0;
    /// Draws how the technique works for each point: RGBA, 4 bytes per point (sRGB). Shadow maps, for a camera's
    /// points, have "aliasing" (texels per pixel, in colours), "grid" (texels), "views" (the cascade or face of each
    /// point), "depth" and "warp"; a virtual map has "page"; frustum-traced has "decided": each point's provenance
    /// (docs/techniques.md has the legends). Throws InvalidArgument if the technique has no diagnostic of this name, if
    /// the diagnostic needs points that a camera made, or if `facing` is by normals, winding or fans, which are decided
    /// after the technique.
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light, const Facing& facing = {});

protected:
    friend struct Internals;
    /// What a technique implements. `points` have the eye by which they face, if any; other facings come afterwards.
    virtual Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                                 const Visibility& visibility) = 0;
    /// `after_light`: to be called with each light's index when its visibility is enqueued, in the lights' order.
    virtual std::vector<Statistics> run_lights(const Triangles& triangles, const Points& points,
                                               std::span<const Light> lights, std::span<const Visibility> visibilities,
                                               const std::function<void(std::size_t)>& after_light);
    /// run_light_table(). The default takes one light at a time.
    virtual Statistics run_table(const Triangles& triangles, const Points& points, const Lights& lights,
                                 const LightsOutputs& outputs, const LightsOptions& options);
    /// diagnose(). The default has no diagnostic.
    virtual std::vector<std::uint8_t> draw_diagnostic(std::string_view name, const Triangles& triangles,
                                                      const Points& points, const Light& light);
};

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
/// Every technique that this program has, in the order of `gnomon techniques`: frustum-traced, and after add_rivals()
/// the classic ones.
std::vector<TechniqueDescription> techniques();
/// Makes the technique of this name. Throws InvalidArgument with the list of names if there is none.
std::unique_ptr<Technique> make_technique(std::string_view name, const Device& device);

/// The outputs on the host.
struct LightsOnHost {
    std::vector<std::uint32_t> bits, counts, first_lit, last_lit;
    std::vector<double> sums;
    Statistics statistics;
};
/// Which outputs run_light_table_to_host() returns; `cosines` as in LightsOutputs.
struct LightsWanted {
    bool bits = false, counts = false, sums = false, first_lit = false, last_lit = false, cosines = false;
};
/// Technique::run_light_table() with outputs on the host.
LightsOnHost run_light_table_to_host(Technique& technique, const Triangles& triangles, const Points& points,
                                     const Lights& lights, const LightsWanted& wanted, const RunOptions& options = {});
/// Soft shadows: writes to `mean` the share of the lights that reach each point, their number by lights.count(),
/// rounded once; weights are not read. Without lights it is 0. Throws as Technique::run_light_table() does, or if
/// `mean` has fewer entries than there are points.
Statistics run_mean(Technique& technique, const Triangles& triangles, const Points& points, const Lights& lights,
                    const Visibility& mean, const RunOptions& options = {});

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
/// triangles by the exact predicate. Throws InvalidArgument as Technique::diagnose() does, or if there is no such
/// point.
Explanation explain(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                    const Light& light, const Facing& facing = {});

}  // namespace gnomon

#pragma GCC visibility pop
