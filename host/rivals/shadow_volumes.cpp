// SPDX-License-Identifier: MIT
// Technique shadow-volumes: stencil shadow volumes without a stencil buffer (kernels/rivals/shadow_volumes.h).
#include "kernels/rivals/shadow_volumes.h"

#include <algorithm>
#include <cmath>

#include "occluders/triangle_setup.hpp"
#include "query/inputs.hpp"
#include "query/settings_table.hpp"
#include "query/statistics.hpp"
#include "query/vectors.hpp"
#include "rivals/rivals.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "rivals/shadow_volumes.cl";

/// Room for this many (side, tile) pairs at a time, and the sides of a slice, which seldom need more: the pixels of
/// other pairs are counted at once.
constexpr cl_uint pair_capacity = 1u << 23, sides_at_once = 1u << 16;

cl_uint divided_up(cl_uint count, cl_uint size) { return (count + size - 1) / size; }

struct Settings {
    bool cancel, both_faces, z_fail;
};

const SettingsTable<Settings>& settings_table() {
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

class ShadowVolumes final : public Technique {
public:
    explicit ShadowVolumes(const Device& device) : device_(device), session_(session_of(device)) {}
    const Device& device() const override { return device_; }

    static TechniqueDescription describe() {
        return {"shadow-volumes",
                "shadow volumes (Crow 1977), counted per pixel; shared sides cancel; needs a whole picture's points",
                false, settings_table().descriptions()};
    }

    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "shadow-volumes", name, value);
    }

    /// Throws InvalidArgument unless the points are a picture's (Points::set_camera): volumes are counted along the
    /// rays of pixels.
    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) override {
        require_run(triangles, points, light, visibility);
        if (points.count() == 0) return {};
        const TriangleInputs triangle_data = triangle_inputs(triangles);
        const PointInputs point_data = point_inputs(points, triangles);
        VolumeParams params = params_of(triangle_data, points, light);
        MeasuredRun measured(session_, kept_bytes_);
        const std::size_t tiles = std::size_t(params.tiles_x) * params.tiles_y;
        session_.reserve_filled(counters_, 0, sizeof(VolumeCounters));
        session_.reserve_filled(tile_counts_, 0, tiles * sizeof(cl_int));
        session_.reserve_filled(pixel_counts_, 0, points.count() * sizeof(cl_int));
        tile_depths_.reserve(session_, tiles * 2 * sizeof(cl_float));

        cl_uint side_count = 0;
        cl::StageTimer timer(session_, measured.stages, "volume_sides");
        if (triangles.count() != 0) side_count = make_sides(params, triangle_data.vertices);
        timer.next("volume_depths");
        session_.launch(file, "shadow_volumes_depths", cl::Range::items(tiles), params, point_data.layout,
                        point_data.positions, tile_depths_);
        timer.next("volume_draw");
        if (side_count != 0) draw(params, point_data, side_count);
        timer.next("volume_resolve");
        session_.launch(file, "shadow_volumes_resolve", cl::Range::items(points.count()), params, point_data.layout,
                        point_data.positions, point_data.receivers, triangle_data.vertices, tile_counts_, pixel_counts_,
                        counters_, visibility.buffer());
        timer.next(nullptr);
        const auto counted = session_.read_value<VolumeCounters>(counters_);
        return measured.finish(
            {{"points", points.count()},
             {"triangles", triangles.count()},
             {"triangles_casting", counted.casting},
             {"edges", counted.edges},
             {"sides", side_count},
             {"eye_inside", counted.eye_inside},
             {"tiles_whole", counted.tiles_whole},
             {"pixels_written", counted.pixels_written_low + (std::uint64_t(counted.pixels_written_high) << 32) +
                                    std::uint64_t(counted.tiles_whole) * VOLUME_TILE * VOLUME_TILE}});
    }

private:
    VolumeParams params_of(const TriangleInputs& triangles, const Points& points, const Light& light) const {
        const auto& seen = points.camera();
        if (!seen || std::size_t(seen->width) * seen->height != points.count())
            throw InvalidArgument(
                "shadow-volumes needs the points of a whole picture: make them with look(), or name their camera with "
                "set_camera()");
        const Camera& camera = seen->camera;
        // Pixels are square: a pixel's side is 2 tan(fov / 2) / height on the plane at distance 1.
        const double pixel = 2 * std::tan(camera.fov_y_radians / 2) / seen->height;
        VolumeParams view{};
        view.first_float = triangles.first_float;
        view.triangle_count = triangles.count;
        view.cancels = settings_.cancel;
        view.light = float4_of(light.xyzw);
        std::copy(camera.eye.begin(), camera.eye.end(), view.eye.values);
        const glm::dvec3 right = loaded(camera.right), up = loaded(camera.up);
        store(view.right, right * pixel);
        store(view.up, up * -pixel);
        store(view.forward,
              loaded(camera.forward) - 0.5 * seen->width * pixel * right + 0.5 * seen->height * pixel * up);
        view.width = seen->width;
        view.height = seen->height;
        view.tiles_x = divided_up(view.width, VOLUME_TILE);
        view.tiles_y = divided_up(view.height, VOLUME_TILE);
        view.blocks_x = divided_up(view.tiles_x, VOLUME_BLOCK);
        view.blocks_y = divided_up(view.tiles_y, VOLUME_BLOCK);
        view.both_faces = settings_.both_faces;
        view.z_fail = settings_.z_fail;
        return view;
    }

    cl_uint make_sides(VolumeParams params, cl_mem vertices) {
        const std::uint64_t edges = 3 * std::uint64_t(params.triangle_count);
        if (edges >= (std::uint64_t(1) << 30))
            throw InvalidArgument("shadow-volumes takes at most 357 million triangles, not " +
                                  std::to_string(params.triangle_count));
        // At most half full, so that the search for an edge is short.
        cl_uint slots = 16;
        while (slots < 2 * edges) slots *= 2;
        session_.reserve_filled(slot_edges_, GN_NO_ID, std::size_t(slots) * sizeof(cl_uint));
        session_.reserve_filled(slot_weights_, 0, std::size_t(slots) * sizeof(cl_int));
        params.slot_count = slots;
        session_.launch(file, "shadow_volumes_edges", cl::Range::items(params.triangle_count), params, vertices,
                        slot_edges_, slot_weights_, counters_);
        cursor_.reserve(session_, sizeof(cl_uint));
        sides_.reserve(session_, 1u << 16);
        for (;;) {
            params.side_capacity = sides_.capacity();
            session_.fill(cursor_, 0, sizeof(cl_uint));
            session_.launch(file, "shadow_volumes_sides", cl::Range::items(slots), params, vertices, slot_edges_,
                            slot_weights_, cursor_, sides_.buffer());
            if (settings_.z_fail)
                session_.launch(file, "shadow_volumes_caps", cl::Range::items(params.triangle_count), params, vertices,
                                cursor_, sides_.buffer());
            const auto wanted = session_.read_value<cl_uint>(cursor_);
            if (wanted <= sides_.capacity()) return wanted;
            sides_.reserve(session_, wanted);
        }
    }

    void draw(VolumeParams params, const PointInputs& points, cl_uint side_count) {
        const std::size_t blocks = std::size_t(params.blocks_x) * params.blocks_y;
        pairs_.reserve(session_, std::size_t(pair_capacity) * 2 * sizeof(cl_uint));
        params.pair_capacity = pair_capacity;
        for (cl_uint first = 0; first < side_count; first += params.side_count) {
            params.first_side = first;
            params.side_count = std::min(sides_at_once, side_count - first);
            session_.fill(cursor_, 0, sizeof(cl_uint));
            session_.launch(file, "shadow_volumes_tiles", cl::Range::items(params.side_count * blocks), params,
                            points.layout, points.positions, points.receivers, sides_.buffer(), tile_depths_,
                            tile_counts_, pairs_, cursor_, pixel_counts_, counters_);
            session_.launch(file, "shadow_volumes_pixels", cl::Range::items(session_.many_groups() * 256), params,
                            points.layout, points.positions, points.receivers, sides_.buffer(), pairs_, cursor_,
                            pixel_counts_, counters_);
        }
    }

    Device device_;
    cl::Session& session_;
    Settings settings_ = settings_table().defaults();
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    GrowingList sides_{sizeof(VolumeSide)};
    cl::Buffer counters_, slot_edges_, slot_weights_, cursor_, tile_depths_, tile_counts_, pixel_counts_, pairs_;
};

}  // namespace

Registered shadow_volumes_technique() { return registered<ShadowVolumes>(); }

}  // namespace gnomon
