// SPDX-License-Identifier: MIT
#include "techniques/shadow_volumes.hpp"

#include <algorithm>
#include <cmath>

#include "api/vectors.hpp"

namespace gnomon {
namespace {

/// Room for this many (side, tile) pairs at a time; sides are drawn in slices that cannot need more.
constexpr std::size_t pair_capacity = std::size_t(1) << 23;

void set_vector(float* target, const Double3& v) {
    for (int i = 0; i < 3; ++i) target[i] = static_cast<float>(v[i]);
}

cl_uint pieces(cl_uint count, cl_uint size) { return (count + size - 1) / size; }

}  // namespace

const SettingsTable<ShadowVolumes::Settings>& ShadowVolumes::settings_table() {
    static constexpr std::string_view faces[] = {"front", "both"}, methods[] = {"z-pass", "z-fail"};
    static const SettingsTable<Settings> table{
        {{"cancel", "on", "on or off: leave out the sides that neighbouring triangles share"},
         setting::on_off(&Settings::cancel)},
        {{"faces", "both", "both or front: which triangles cast; front is right for closed meshes wound outwards"},
         setting::choice(&Settings::both_faces, faces)},
        {{"method", "z-pass", "z-pass or z-fail: count before the point from the eye, or behind it from infinity"},
         setting::choice(&Settings::z_fail, methods)},
    };
    return table;
}

VolumeView ShadowVolumes::view_of(const Points& points, const Light& light) const {
    const auto& seen = points.camera();
    if (!seen || std::size_t(seen->width) * seen->height != points.count())
        throw InvalidArgument(
            "shadow-volumes needs the points of a whole picture: make them with look(), or say their camera with "
            "set_camera()");
    const Camera& camera = seen->camera;
    // Pixels are square: a pixel's side is 2 tan(fov / 2) / height on the plane at distance 1.
    const double pixel = 2 * std::tan(camera.fov_y_radians / 2) / seen->height;
    VolumeView view{};
    std::copy(light.xyzw.begin(), light.xyzw.end(), view.light);
    std::copy(camera.eye.begin(), camera.eye.end(), view.eye);
    set_vector(view.right, scaled(camera.right, pixel));
    set_vector(view.up, scaled(camera.up, -pixel));
    Double3 corner;
    for (int i = 0; i < 3; ++i)
        corner[i] =
            camera.forward[i] - 0.5 * seen->width * pixel * camera.right[i] + 0.5 * seen->height * pixel * camera.up[i];
    set_vector(view.forward, corner);
    view.width = seen->width;
    view.height = seen->height;
    view.tiles_x = pieces(view.width, VOLUME_TILE);
    view.tiles_y = pieces(view.height, VOLUME_TILE);
    view.blocks_x = pieces(view.tiles_x, VOLUME_BLOCK);
    view.blocks_y = pieces(view.tiles_y, VOLUME_BLOCK);
    view.both_faces = settings_.both_faces;
    view.z_fail = settings_.z_fail;
    return view;
}

void ShadowVolumes::reserve_sides(cl_uint count) {
    if (count <= side_capacity_) return;
    side_capacity_ = 0;  // stays so if the next line throws
    sides_.reserve(device_.session(), std::size_t(count) * sizeof(VolumeSide));
    side_capacity_ = count;
}

cl_uint ShadowVolumes::make_sides(const VolumeView& view, const TriangleInputs& triangles) {
    cl::Session& session = device_.session();
    const std::uint64_t edges = 3 * std::uint64_t(triangles.count);
    if (edges >= (std::uint64_t(1) << 30))
        throw InvalidArgument("shadow-volumes takes at most 357 million triangles, not " +
                              std::to_string(triangles.count));
    // Half full at most, so that looking for an edge ends soon.
    cl_uint slots = 16;
    while (slots < 2 * edges) slots *= 2;
    slot_edges_.reserve(session, std::size_t(slots) * sizeof(cl_uint));
    slot_weights_.reserve(session, std::size_t(slots) * sizeof(cl_int));
    session.fill(slot_edges_, GN_NO_ID, std::size_t(slots) * sizeof(cl_uint));
    session.fill(slot_weights_, 0, std::size_t(slots) * sizeof(cl_int));
    session.launch("techniques/shadow_volumes.cl", "shadow_volumes_edges", cl::Range::items(triangles.count), view,
                   triangles.count, triangles.first_float, slots - 1, cl_uint(settings_.cancel), triangles.vertices,
                   slot_edges_, slot_weights_, counters_);
    cursor_.reserve(session, sizeof(cl_uint));
    reserve_sides(1u << 16);
    for (;;) {
        session.fill(cursor_, 0, sizeof(cl_uint));
        session.launch("techniques/shadow_volumes.cl", "shadow_volumes_sides", cl::Range::items(slots), view, slots,
                       triangles.first_float, triangles.vertices, slot_edges_, slot_weights_, cursor_, sides_,
                       side_capacity_);
        if (settings_.z_fail)
            session.launch("techniques/shadow_volumes.cl", "shadow_volumes_caps", cl::Range::items(triangles.count),
                           view, triangles.count, triangles.first_float, triangles.vertices, cursor_, sides_,
                           side_capacity_);
        cl_uint wanted = 0;
        session.read(cursor_.get(), &wanted, sizeof(wanted));
        if (wanted <= side_capacity_) return wanted;
        reserve_sides(wanted);
    }
}

void ShadowVolumes::draw(const VolumeView& view, const PointInputs& points, cl_uint side_count) {
    cl::Session& session = device_.session();
    const std::size_t tiles = std::size_t(view.tiles_x) * view.tiles_y;
    const std::size_t blocks = std::size_t(view.blocks_x) * view.blocks_y;
    const auto slice = static_cast<cl_uint>(std::clamp<std::size_t>(pair_capacity / tiles, 1, 1u << 20));
    pairs_.reserve(session, slice * tiles * 2 * sizeof(cl_uint));
    for (cl_uint first = 0; first < side_count; first += slice) {
        const cl_uint count = std::min(slice, side_count - first);
        session.fill(cursor_, 0, sizeof(cl_uint));
        session.launch("techniques/shadow_volumes.cl", "shadow_volumes_tiles", cl::Range::items(count * blocks), view,
                       first, count, sides_, tile_depths_, tile_counts_, pairs_, cursor_, counters_);
        session.launch("techniques/shadow_volumes.cl", "shadow_volumes_pixels",
                       cl::Range::items(session.many_groups() * 256), view, points.layout, points.positions,
                       points.receivers, sides_, pairs_, cursor_, pixel_counts_, counters_);
    }
}

Statistics ShadowVolumes::run(const Triangles& triangles, const Points& points, const Light& light,
                              const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    const auto start = std::chrono::steady_clock::now();
    Statistics statistics;
    if (points.count() == 0) return statistics;
    const VolumeView view = view_of(points, light);
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    const TriangleInputs triangle_data = triangle_inputs(triangles);
    const PointInputs point_data = point_inputs(points);
    const std::size_t tiles = std::size_t(view.tiles_x) * view.tiles_y;
    counters_.reserve(session, sizeof(VolumeCounters));
    tile_depths_.reserve(session, tiles * 2 * sizeof(cl_float));
    tile_counts_.reserve(session, tiles * sizeof(cl_int));
    pixel_counts_.reserve(session, points.count() * sizeof(cl_int));
    session.fill(counters_, 0, sizeof(VolumeCounters));
    session.fill(tile_counts_, 0, tiles * sizeof(cl_int));
    session.fill(pixel_counts_, 0, points.count() * sizeof(cl_int));

    cl_uint side_count = 0;
    if (triangles.count() != 0) {
        cl::StageTimer timer(session, statistics, "volume_sides");
        side_count = make_sides(view, triangle_data);
    }
    {
        cl::StageTimer timer(session, statistics, "volume_depths");
        session.launch("techniques/shadow_volumes.cl", "shadow_volumes_depths", cl::Range::items(tiles), view,
                       point_data.layout, point_data.positions, tile_depths_);
    }
    if (side_count != 0) {
        cl::StageTimer timer(session, statistics, "volume_draw");
        draw(view, point_data, side_count);
    }
    {
        cl::StageTimer timer(session, statistics, "volume_resolve");
        session.launch("techniques/shadow_volumes.cl", "shadow_volumes_resolve", cl::Range::items(points.count()), view,
                       point_data.layout, triangle_data.first_float, triangle_data.count, point_data.positions,
                       point_data.receivers, triangle_data.vertices, tile_counts_, pixel_counts_, counters_,
                       visibility.buffer());
    }
    VolumeCounters counted;
    session.read(counters_.get(), &counted, sizeof(counted));
    statistics.counts = {
        {"points", points.count()},
        {"triangles", triangles.count()},
        {"triangles_casting", counted.casting},
        {"edges", counted.edges},
        {"sides", side_count},
        {"eye_inside", counted.eye_inside},
        {"tiles_whole", counted.tiles_whole},
        {"pixels_written", counted.pixels_written_low + (std::uint64_t(counted.pixels_written_high) << 32) +
                               std::uint64_t(counted.tiles_whole) * VOLUME_TILE * VOLUME_TILE}};
    statistics.device_memory_bytes = memory.peak_bytes();
    statistics.total_wall_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return statistics;
}

void ShadowVolumes::set(std::string_view name, std::string_view value) {
    settings_table().set(settings_, "shadow-volumes", name, value);
}

TechniqueDescription ShadowVolumes::describe() {
    return {"shadow-volumes",
            "shadow volumes (Crow 1977), counted per pixel; shared sides cancel; needs a whole picture's points", false,
            settings_table().descriptions()};
}

}  // namespace gnomon
