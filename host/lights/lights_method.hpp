// SPDX-License-Identifier: MIT
// The choice among the methods that decide a table of lights: pure functions of a run's traits and of measured costs.
// The choice affects time alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace gnomon {

/// The methods that decide a table of lights, as the setting many-lights names them. `automatic`: the fastest of them.
enum class LightsMethod { automatic, one_by_one, beams, point_beams, rays, horizons, sweeps };
inline constexpr std::string_view lights_method_names[] = {"auto", "one-by-one", "beams", "point-beams",
                                                           "rays", "horizons",   "sweeps"};

/// The constants by which `automatic` measures and chooses, with the machine and the commit that they were measured by.
/// docs/many_lights.md has what each method takes. "Two cores" are those of an EPYC.
struct LightsTuning {
    // ---- Rules
    /// Fewer lights are decided one by one (two cores, dba3afc), unless wants_tree().
    std::size_t min_shared_lights = 4;
    /// A BVH that is kept serves fewer lights, too, if there is a pair for this number of triangles: packets to 1 and 3
    /// lights take .5 to 1.5 and .16 to .5 of the time of single lights; 1 light and a million vertices of a terrain of
    /// 2 million .56 (two cores, ba4c1fc).
    std::size_t cpu_triangles_per_pair = 4;
    /// Fewer pairs take some milliseconds by beams, and a sample of them as long (two cores, dba3afc).
    std::size_t min_measured_pairs = std::size_t(1) << 20;
    /// Directional lights with fewer lights than this in a bundle, on average, are scattered, and so are point lights
    /// in boxes of at least this share of the largest coordinate: packets were the fastest for all points but
    /// pictures' (40 suns of a year, 1.8 in a bundle: two cores, AVX-512, 130dda7).
    double cpu_scattered_lights = 4, cpu_scattered_box = 0.25;
    /// Fewer scattered lights than this have sectors of one or two lights each: horizons of a terrain took twice the
    /// time of packets for 40 suns (two cores, 130dda7).
    std::size_t cpu_sector_lights = 64;
    /// Sweeps decide all vertices of a raster; other methods decide the points alone. So they serve where at least this
    /// share of the points is at vertices, and a point has no more than a number of vertices (two cores, AVX-512, and
    /// H200, cd3b3fb5).
    double share_at_vertices = 0.875;
    std::size_t cpu_vertices_of_point = 16, cpu_vertices_of_point_few_lights = 8, gpu_vertices_of_point = 8;
    /// The same times the mean number of lights in a bundle: others share work among these.
    double cpu_vertices_times_bundle = 180;
    /// Pairs from which on a raster is searched for (two cores, 330b2f4e; H200, cd3b3fb5).
    std::size_t cpu_min_raster_pairs = std::size_t(1) << 18, gpu_min_raster_pairs = std::size_t(1) << 19;
    /// Pairs of each triangle from which on a height field is searched for: that takes as long as to decide some
    /// (H200, ec9c821).
    std::size_t min_field_pairs_per_triangle = 8;
    /// Pairs from which on it pays to time one light by itself (H200, e471466).
    std::size_t min_single_light_pairs = std::size_t(1) << 25;
    /// From this number of lights on, single lights were never the fastest (two cores, a2c3aef).
    std::size_t cpu_many_lights = 32;
    /// Thousands of lights are dense, and single lights were never the fastest (H200, 2ed168f).
    std::size_t gpu_many_lights = 2048;
    /// A scattered point light takes a millisecond by itself, as beams do for this number of points (cd6b871).
    std::size_t gpu_points_of_single_lights = std::size_t(1) << 18;
    /// Beams took longer than estimated where the estimates were close (H200, d261765).
    double gpu_beams_over_estimate = 1.1;
    /// A cone is thin below some 2 degrees, and a box of point lights below this share of the largest coordinate: then
    /// beams were the fastest (H200, 814bed1).
    double thin_cone = 0.02, thin_box = 1 / 16.0;
    /// The next runs that a choice serves. Measuring takes a tenth of many runs, and of those with few lights more; it
    /// may be misled by what else the machine does, so that a choice expires (H200, eae2532).
    std::uint32_t runs_of_choice = 7;

    // ---- Samples
    /// A CPU measures each method so many times, on so many bundles and such a share of the points that all of it takes
    /// some 5 % of a run (two loaded cores and 16 threads, 932267b9).
    std::size_t cpu_sample_bundles = 16, cpu_sample_rounds = 2, cpu_sample_share = 192;
    std::size_t cpu_sample_points = 16384, cpu_min_sample_points = 512;
    /// A GPU measures one in 128 of a picture's points: these are many, and much alike (H200, 2ed168f).
    std::size_t gpu_picture_share = 128;
    /// It measures one in 16 of other points: one in 128 of a million does not fill it (H100, 1c38620).
    std::size_t gpu_points_share = 16;
    /// The second sample of a GPU has one in 8 of the first one's points (H200, 2ed168f).
    std::size_t gpu_launch_share = 8;
    /// A GPU times one light by itself thrice from this number of lights on: its run is short and easily disturbed
    /// (H200, 38177c3).
    std::size_t gpu_lights_timed_thrice = 64;
};
inline constexpr LightsTuning lights_tuning;

/// What is known of a run before anything is measured.
struct LightsTraits {
    bool is_cpu = false;
    std::size_t points = 0, lights = 0, triangles = 0;
    bool is_picture = false;        ///< the points are a camera's
    bool keeps_clusters = false;    ///< the caller keeps the triangles' clusters, so that later runs can use a choice
    bool can_be_bundled = true;     ///< the lights are of one kind, and all coordinates are in the filter's range
    bool are_point_lights = false;  ///< else they are directional
    bool is_implicit = false;       ///< the triangles are an implicit raster, which one light at a time would write out
    bool is_height_field = false;   ///< set where wants_height_field()
    /// Set where wants_raster(), if there is one: its vertices, and the points that are at some of them.
    std::size_t raster_vertices = 0, points_at_vertices = 0;
    /// Set where wants_bundles(): the mean number of lights in a bundle.
    double lights_per_bundle = std::numeric_limits<double>::infinity();
    /// Set where wants_bundles(): half the diagonal of the widest bundle, of directions of length 1, or of
    /// positions as a share of the largest coordinate.
    double widest_bundle = std::numeric_limits<double>::infinity();
};

/// What each method takes for a whole run, in ms: infinite if it was not measured or ran out of memory.
class LightsCosts {
public:
    static constexpr double infinite = std::numeric_limits<double>::infinity();
    LightsCosts() { ms_.fill(infinite); }
    double& operator[](LightsMethod method) { return ms_[std::size_t(method)]; }
    double operator[](LightsMethod method) const { return ms_[std::size_t(method)]; }

private:
    std::array<double, std::size(lights_method_names)> ms_;
};

/// Whether a run by `automatic` makes the BVH. Else it decides one light at a time.
bool wants_tree(const LightsTraits& traits);
/// Whether the choice depends on whether the triangles are a raster.
bool wants_raster(const LightsTraits& traits);
/// Whether the choice depends on whether the triangles are a height field.
bool wants_height_field(const LightsTraits& traits);
/// Whether the choice depends on how wide and full bundles are. On a CPU wants_height_field() depends on that, too.
bool wants_bundles(const LightsTraits& traits);
/// The methods whose costs the choice depends on; none where a rule decides.
std::vector<LightsMethod> methods_to_measure(const LightsTraits& traits);
/// The method that takes the least time by rule, or else by these costs. Never `automatic`.
LightsMethod choose_method(const LightsTraits& traits, const LightsCosts& costs);

/// A measured choice, for the next runs of the same lights and as many points.
class MethodCache {
public:
    struct Key {
        std::vector<std::array<float, 4>> lights;
        std::size_t points = 0;
        bool is_picture = false;
        bool operator==(const Key&) const = default;
    };
    /// The method that was chosen for such a run, if the choice has not expired. Uses up one of its runs; forgets the
    /// choice for another key.
    std::optional<LightsMethod> find(const Key& key);
    void keep(Key key, LightsMethod method);
    void clear() { kept_.reset(); }

private:
    struct Kept {
        Key key;
        LightsMethod method;
        std::uint32_t runs_left;
    };
    std::optional<Kept> kept_;
};

}  // namespace gnomon
