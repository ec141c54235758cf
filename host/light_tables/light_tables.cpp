// SPDX-License-Identifier: MIT
#include "light_tables/light_tables.hpp"

#include <algorithm>
#include <cmath>

#include "query/vectors.hpp"

namespace gnomon {
namespace {

// The sentence that says why the BVH's methods cannot decide this run; null if they can.
const char* missing_for_tree(const BvhRun& run) {
    if (!(run.largest_coordinate() <= BVH_MAX_COORDINATE)) return "coordinates up to 2^19";
    if (can_be_bundled(run.lights.lights())) return nullptr;
    return "lights that are all directional, with directions that lose no bits when they are scaled, or all point "
           "lights";
}

[[noreturn]] void throw_missing(LightsMethod method, const std::string& what) {
    throw InvalidArgument("many-lights=" + std::string(lights_method_names[std::size_t(method)]) + " needs " + what +
                          ": use many-lights=auto");
}

// What is built over triangles is kept as long as the caller keeps their clusters, since the caller promised not to
// write the vertices for that time. An implicit raster never changes.
const void* kept_id(const Triangles& triangles) {
    const void* raster = Internals::raster(triangles);
    return raster != nullptr ? raster : Internals::clusters(triangles);
}

LightsTraits traits_of(const LightsRun& run, const Triangles& given, bool can_be_bundled) {
    return {.is_cpu = session_of(run.device).is_cpu(),
            .points = run.points.count(),
            .lights = run.lights.count(),
            .triangles = run.triangles.count(),
            .is_picture = run.points.camera().has_value(),
            .keeps_clusters = kept_id(given) != nullptr,
            .can_be_bundled = can_be_bundled,
            .are_point_lights = !run.lights.lights().front().is_directional(),
            .is_implicit = Internals::raster(given) != nullptr};
}

void describe_bundles(LightsTraits& traits, const TableRun& table) {
    double widest = 0;
    for (const LightBundle& bundle : table.bundles.coned().bundles) {
        const LightCone& cone = bundle.cones[0];
        const glm::dvec3 across = loaded(cone.across), along = loaded(cone.along);
        const glm::dvec3 squares = across * across + along * along;
        widest = std::max(widest, std::sqrt(squares.x + squares.y + squares.z));
    }
    const LightBundles& coned = table.bundles.coned();
    traits.widest_bundle = coned.are_positions ? widest / table.run.largest_coordinate() : widest;
    traits.lights_per_bundle = double(traits.lights) / double(coned.bundles.size());
}

MethodCache::Key key_of(const LightsRun& run) {
    MethodCache::Key key{{}, run.points.count(), run.points.camera().has_value()};
    for (const Light& light : run.lights.lights()) key.lights.push_back(light.xyzw);
    return key;
}

}  // namespace

Statistics LightTables::run(Technique& one_light, const LightsRun& given, LightsMethod method,
                            std::uint32_t bundle_lights) {
    const bool is_automatic = method == LightsMethod::automatic;
    if (session_.joins_items()) throw_missing(method, "another driver (Mesa's llvmpipe compiles its kernels wrongly)");
    std::uint64_t kept = kept_bytes_;  // runs of single lights within this run count their own kept bytes
    MeasuredRun measured(session_, kept);
    const Triangles clustered = is_automatic ? with_clusters(device_, given.triangles) : given.triangles;
    const LightsRun run{device_, clustered, given.points, given.lights, given.outputs, given.options};
    require_lights_run(run);
    cl::StageTimer timer(session_, measured.stages, "point_order");
    const SortedPoints& sorted = sort_points(run);
    timer.next("wide_bvh");
    BundleTables bundles(run.lights.lights(), bundle_lights);
    TableRun table{
        {run, sorted, kept_of(tree_, given.triangles)}, given.triangles, bundles, one_light, measured.stages};
    timer.next(nullptr);
    const char* missing = missing_for_tree(table.run);
    if (missing != nullptr && !is_automatic) throw_missing(method, missing);
    method = is_automatic ? automatic_method(table, missing == nullptr) : method;
    if (method == LightsMethod::one_by_one) {
        run_one_by_one(one_light, run, table.order_of_one_light(), measured.stages);
        return measured.finish({{"points", run.points.count()}, {"lights", run.lights.count()}});
    }
    decide(table, method, is_automatic);
    merge_stages(measured.stages);
    return measured.finish();
}

// Mesa's compiler says of the walks' kernels for llvmpipe that "results may be incorrect", and some were
// (docs/drivers.md).
bool LightTables::wants_tree(const LightsRun& given) {
    return !session_of(given.device).joins_items() && gnomon::wants_tree(traits_of(given, given.triangles, true));
}

LightsMethod LightTables::automatic_method(TableRun& table, bool can_be_bundled) {
    MethodCache::Key key = key_of(table.run);
    if (const auto found = methods_.find(key)) return *found;
    LightsTraits traits = traits_of(table.run, table.given, can_be_bundled);
    if (traits.is_cpu && wants_bundles(traits)) describe_bundles(traits, table);
    if (wants_raster(traits)) {
        if_there_is_memory([&] { find_raster(table); });
        if (table.raster == nullptr) release_raster(table);
        traits.points_at_vertices = table.at.count;
        traits.raster_vertices = table.raster != nullptr ? table.raster->vertex_count() : 0;
    }
    if (wants_height_field(traits)) {
        if_there_is_memory([&] { find_field(table); });
        traits.is_height_field = table.field != nullptr;
    }
    if (!traits.is_cpu && wants_bundles(traits)) describe_bundles(traits, table);
    const LightsMethod chosen = choose_method(traits, measured_costs(methods_to_measure(traits), table));
    methods_.keep(std::move(key), chosen);
    return chosen;
}

void LightTables::decide(TableRun& table, LightsMethod method, bool is_automatic) {
    if (method == LightsMethod::rays && !session_.is_cpu()) method = LightsMethod::point_beams;
    if (method == LightsMethod::horizons) {
        if (!table.run.lights.lights().front().is_directional()) throw_missing(method, "directional lights");
        if (table.field == nullptr) find_field(table);
        if (table.field == nullptr)
            throw_missing(method, "a height field: triangles that lie side by side over a plane");
    }
    if (method == LightsMethod::sweeps) require_raster(table);
    try {
        if (method == LightsMethod::sweeps) return run_sweeps(table);
        passes_of(method, table, table.run).run();
    } catch (const OutOfDeviceMemory&) {
        // Beams take less memory than horizons and sweeps, so they decide the table.
        if ((method != LightsMethod::horizons && method != LightsMethod::sweeps) || !is_automatic) throw;
        release_raster(table);
        methods_.keep(key_of(table.run), LightsMethod::beams);
        passes_of(LightsMethod::beams, table, table.run).run();
    }
}

template <typename Built>
const Built& LightTables::kept_of(std::unique_ptr<Built>& kept, const Triangles& triangles) {
    const void* id = kept_id(triangles);
    if (kept && id != nullptr && id == kept_id(kept->triangles())) return *kept;
    const MeasuredRun built(session_, kept_bytes_);
    methods_.clear();
    kept.reset();
    kept = std::make_unique<Built>(device_, triangles);
    return *kept;
}

const SortedPoints& LightTables::sort_points(const LightsRun& run) {
    const MeasuredRun made(session_, kept_bytes_);
    sorted_points_ = SortedPoints(run, std::move(sorted_points_));
    return sorted_points_;
}

void LightTables::find_field(TableRun& table) {
    const cl::StageTimer timer(session_, table.statistics, "height_field");
    const BuiltHeightField& built = kept_of(field_, table.given);
    table.field = built.is_field() ? &built : nullptr;
}

void LightTables::find_raster(TableRun& table) {
    const cl::StageTimer timer(session_, table.statistics, "raster");
    const BuiltRaster& built = kept_of(raster_, table.given);
    if (!built.is_raster()) return;
    table.at = points_on(built, table.run, table.run.sorted);
    table.raster = &built;
}

// Frees the memory of a raster by which nothing is decided. That there is none is kept.
void LightTables::release_raster(TableRun& table) {
    table.raster = nullptr;
    table.at = {};
    if (raster_ && raster_->is_raster()) raster_.reset();
}

void LightTables::require_raster(TableRun& table) {
    if (!table.run.lights.lights().front().is_directional()) throw_missing(LightsMethod::sweeps, "directional lights");
    if (table.raster == nullptr) find_raster(table);
    if (table.raster == nullptr)
        throw_missing(LightsMethod::sweeps, "a raster: a height field whose vertices stand in rows and columns");
}

void LightTables::release() {
    tree_.reset();
    field_.reset();
    raster_.reset();
    methods_.clear();
    sorted_points_ = {};
}

}  // namespace gnomon
