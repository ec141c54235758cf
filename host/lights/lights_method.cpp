// SPDX-License-Identifier: MIT
#include "lights/lights_method.hpp"

#include <algorithm>
#include <utility>

namespace gnomon {
namespace {

constexpr const LightsTuning& tuning = lights_tuning;

std::size_t pairs_of(const LightsTraits& traits) { return traits.points * traits.lights; }

// True if the methods that share shadow rays may decide the table.
bool are_shared(const LightsTraits& traits) { return traits.can_be_bundled && wants_tree(traits); }

bool are_worth_measuring(const LightsTraits& traits) {
    return are_shared(traits) && pairs_of(traits) >= tuning.min_measured_pairs;
}

bool are_thin(const LightsTraits& traits) {
    return traits.widest_bundle < (traits.are_point_lights ? tuning.thin_box : tuning.thin_cone);
}

// True if neighbouring lights share little. A picture's points are so dense that beams may be faster all the same.
bool are_scattered(const LightsTraits& traits) {
    if (!traits.is_cpu || traits.is_picture) return false;
    if (traits.lights < tuning.min_shared_lights) return true;
    return traits.are_point_lights ? traits.widest_bundle >= tuning.cpu_scattered_box
                                   : traits.lights_per_bundle < tuning.cpu_scattered_lights;
}

double vertices_worth_sweeps(const LightsTraits& traits) {
    if (!traits.is_cpu) return double(tuning.gpu_vertices_of_point);
    if (traits.lights < tuning.min_shared_lights) return double(tuning.cpu_vertices_of_point_few_lights);
    return std::min(double(tuning.cpu_vertices_of_point), tuning.cpu_vertices_times_bundle / traits.lights_per_bundle);
}

bool serve_sweeps(const LightsTraits& traits) {
    return traits.raster_vertices != 0 &&
           double(traits.points_at_vertices) >= tuning.share_at_vertices * double(traits.points) &&
           double(traits.raster_vertices) <= double(traits.points) * vertices_worth_sweeps(traits);
}

// On a GPU one light at a time was the fastest for the points of some pictures, seldom for other points. Other points
// are measured only where the next runs can use the choice.
bool may_take_single_lights(const LightsTraits& traits) {
    return !traits.is_implicit && pairs_of(traits) >= tuning.min_single_light_pairs &&
           traits.lights < (traits.is_cpu ? tuning.cpu_many_lights : tuning.gpu_many_lights) &&
           (traits.is_picture || (!traits.is_cpu && traits.keeps_clusters));
}

// The method that a rule chooses, or no value where measured costs decide.
std::optional<LightsMethod> method_by_rule(const LightsTraits& traits) {
    if (!are_shared(traits)) return LightsMethod::one_by_one;
    if (serve_sweeps(traits)) return LightsMethod::sweeps;
    if (are_scattered(traits) && !traits.is_height_field) return LightsMethod::rays;
    if (!are_worth_measuring(traits)) return LightsMethod::beams;
    if (traits.is_cpu) return {};
    if (traits.is_height_field) return LightsMethod::horizons;
    if (are_thin(traits)) return LightsMethod::beams;
    if (traits.are_point_lights && !traits.is_implicit)
        return traits.points < tuning.gpu_points_of_single_lights ? LightsMethod::beams : LightsMethod::one_by_one;
    if (!may_take_single_lights(traits)) return LightsMethod::beams;
    return {};
}

}  // namespace

bool wants_tree(const LightsTraits& traits) {
    if (traits.lights >= tuning.min_shared_lights || traits.is_implicit) return true;
    return traits.is_cpu && traits.keeps_clusters && !traits.is_picture &&
           pairs_of(traits) >= traits.triangles / tuning.cpu_triangles_per_pair;
}

bool wants_raster(const LightsTraits& traits) {
    const std::size_t least = traits.is_cpu ? tuning.cpu_min_raster_pairs : tuning.gpu_min_raster_pairs;
    return !traits.is_picture && !traits.are_point_lights && are_shared(traits) &&
           pairs_of(traits) >= std::max(least, traits.triangles / tuning.cpu_triangles_per_pair);
}

// On a GPU horizons are never the fastest for the points of pictures.
bool wants_height_field(const LightsTraits& traits) {
    if (serve_sweeps(traits) || traits.is_implicit) return false;
    if (are_scattered(traits) && traits.lights < tuning.cpu_sector_lights) return false;
    return are_worth_measuring(traits) && !traits.are_point_lights && (traits.is_cpu || !traits.is_picture) &&
           pairs_of(traits) >= tuning.min_field_pairs_per_triangle * traits.triangles;
}

bool wants_bundles(const LightsTraits& traits) {
    if (traits.is_cpu) return are_shared(traits) && !traits.is_picture;
    return are_worth_measuring(traits) && !traits.is_height_field;
}

std::vector<LightsMethod> methods_to_measure(const LightsTraits& traits) {
    if (method_by_rule(traits)) return {};
    std::vector<LightsMethod> methods{LightsMethod::beams};
    if (traits.is_cpu) methods.insert(methods.end(), {LightsMethod::point_beams, LightsMethod::rays});
    if (traits.is_cpu && traits.is_height_field) methods.push_back(LightsMethod::horizons);
    if (may_take_single_lights(traits)) methods.push_back(LightsMethod::one_by_one);
    return methods;
}

LightsMethod choose_method(const LightsTraits& traits, const LightsCosts& costs) {
    if (const auto method = method_by_rule(traits)) return *method;
    LightsCosts expected = costs;
    if (!traits.is_cpu) expected[LightsMethod::beams] *= tuning.gpu_beams_over_estimate;
    // Among equal costs the first method wins: beams take the least memory.
    constexpr LightsMethod methods[] = {LightsMethod::beams, LightsMethod::point_beams, LightsMethod::rays,
                                        LightsMethod::horizons, LightsMethod::one_by_one};
    return *std::ranges::min_element(methods, {}, [&](LightsMethod method) { return expected[method]; });
}

std::optional<LightsMethod> MethodCache::find(const Key& key) {
    if (kept_ && (kept_->runs_left == 0 || kept_->key != key)) kept_.reset();
    if (!kept_) return {};
    --kept_->runs_left;
    return kept_->method;
}

void MethodCache::keep(Key key, LightsMethod method) { kept_ = Kept{std::move(key), method, tuning.runs_of_choice}; }

}  // namespace gnomon
