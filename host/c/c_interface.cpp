// SPDX-License-Identifier: MIT
// gnomon.h: statuses, values, devices, triangles, points and visibility.
#include "c/c_interface.hpp"

#include <new>

#include "cl/opencl.hpp"
#include "query/inputs.hpp"

using namespace gnomon;
using namespace gnomon::c;

namespace {

thread_local std::string last_error;
thread_local bool is_text_lost = false;  ///< there was no memory for the last error's text
thread_local cl_int last_opencl_error = CL_SUCCESS;

gnomon_status failed(gnomon_status status, std::string_view text, cl_int opencl_code = CL_SUCCESS) noexcept {
    last_opencl_error = opencl_code;
    try {
        last_error = text;
        is_text_lost = false;
    } catch (...) {
        is_text_lost = true;
    }
    return status;
}

DeviceOptions options_of(const gnomon_device_options* options) {
    const gnomon_device_options& c_options = sized_or(options, "options", GNOMON_DEVICE_OPTIONS_INIT);
    return {.profile = c_options.profile,
            .memory_limit_bytes = c_options.memory_limit_bytes,
            .hide_fp64 = c_options.hide_fp64,
            .work_group_size = c_options.work_group_size,
            .gpu_kernels = c_options.gpu_kernels};
}

gnomon_device* new_device(const Device& device) {
    return new gnomon_device{device, description_of(device.description())};
}

}  // namespace

namespace gnomon::c {

gnomon_status status_of_exception() noexcept {
    try {
        throw;
    } catch (const InvalidArgument& error) {
        return failed(GNOMON_INVALID_ARGUMENT, error.what());
    } catch (const DeviceNotFound& error) {
        return failed(GNOMON_DEVICE_NOT_FOUND, error.what());
    } catch (const OutOfDeviceMemory& error) {
        return failed(GNOMON_OUT_OF_DEVICE_MEMORY, error.what(), error.code());
    } catch (const OpenClError& error) {
        return failed(GNOMON_OPENCL_ERROR, error.what(), error.code());
    } catch (const Stopped&) {
        return failed(GNOMON_STOPPED, "the caller's sample sink stopped the run");
    } catch (const Cancelled&) {
        return failed(GNOMON_STOPPED, "the caller's progress function stopped the run");
    } catch (const std::bad_alloc&) {
        return failed(GNOMON_OUT_OF_HOST_MEMORY, "the host has too little memory for this call");
    } catch (const std::length_error&) {
        return failed(GNOMON_OUT_OF_HOST_MEMORY, "this call needs more memory than any host has");
    } catch (const std::exception& error) {
        return failed(GNOMON_UNEXPECTED_ERROR, error.what());
    } catch (...) {
        return failed(GNOMON_UNEXPECTED_ERROR, "an exception that is no std::exception");
    }
}

void refuse_null(const char* argument) {
    throw InvalidArgument("the argument " + std::string(argument) + " must not be null");
}

void refuse_size(const char* argument, std::size_t given, std::size_t own) {
    throw InvalidArgument(std::string(argument) + ".struct_size is " + std::to_string(given) +
                          ", and this library's is " + std::to_string(own) +
                          ": begin with the GNOMON_..._INIT of the gnomon.h that belongs to the library");
}

namespace {

Facing facing_of(const gnomon_facing& from, const Points& points) {
    switch (from.kind) {
        case GNOMON_FACING_AUTOMATIC:
            return Facing::automatic();
        case GNOMON_FACING_NONE:
            return Facing::none();
        case GNOMON_FACING_EYE:
            return Facing::eye(float3_at(from.eye, "facing.eye"));
        case GNOMON_FACING_NORMALS:
            if (from.normals != nullptr)
                return Facing::normals(array(from.normals, points.count(), 3, "facing.normals"));
            if (from.normals_buffer == nullptr && points.count() != 0) refuse_null("facing.normals_buffer");
            return Facing::normals(from.normals_buffer, layout_or_packed(from.normals_layout));
        case GNOMON_FACING_WINDING:
            return Facing::winding();
        case GNOMON_FACING_FANS:
            return Facing::fans(at(from.fans, "facing.fans").fans,
                                from.up == nullptr ? std::nullopt : std::optional(float3_at(from.up, "facing.up")));
        default:
            throw InvalidArgument("facing.kind is none of GNOMON_FACING_...: " + std::to_string(from.kind));
    }
}

}  // namespace

RunOptions run_options_at(const gnomon_run_options* options, const Points& points) {
    const gnomon_run_options& c_options = sized_or(options, "options", GNOMON_RUN_OPTIONS_INIT);
    RunOptions made{.facing = facing_of(c_options.facing, points)};
    if (c_options.progress != nullptr)
        made.progress = [progress = c_options.progress, user_data = c_options.user_data](double done) {
            return progress(done, user_data) == 0;
        };
    return made;
}

Camera camera_at(const gnomon_camera* camera) {
    const gnomon_camera& c_camera = at(camera, "camera");
    return {.eye = float3_at(c_camera.eye, "eye"),
            .right = values_at<double, 3>(c_camera.right, "right"),
            .up = values_at<double, 3>(c_camera.up, "up"),
            .forward = values_at<double, 3>(c_camera.forward, "forward"),
            .fov_y_radians = c_camera.fov_y_radians};
}

std::vector<CutOutMaterial> materials_at(const gnomon_cut_out_material* materials, std::size_t count) {
    std::vector<CutOutMaterial> all;
    for (const gnomon_cut_out_material& c_material : array(materials, count, 1, "materials")) {
        sized_at(&c_material, "materials[i]");
        if (std::max(c_material.wrap_u, c_material.wrap_v) > GNOMON_WRAP_CLAMP ||
            c_material.filter > GNOMON_FILTER_LINEAR)
            throw InvalidArgument("materials[" + std::to_string(all.size()) +
                                  "] has a wrap or a filter that is none: begin with GNOMON_CUT_OUT_MATERIAL_INIT");
        all.push_back({c_material.texture, TextureWrap(c_material.wrap_u), TextureWrap(c_material.wrap_v),
                       TextureFilter(c_material.filter), c_material.cutoff, c_material.alpha_factor});
    }
    return all;
}

CutOutsArgument::CutOutsArgument(const gnomon_cut_outs* from, std::size_t count) : is_given_(from != nullptr) {
    if (!is_given_) return;
    sized_at(from, "cut_outs");
    materials_ = materials_at(from->materials, from->material_count);
    for (const gnomon_alpha_texture& texture : array(from->textures, from->texture_count, 1, "textures"))
        textures_.push_back({texture.width,
                             texture.height,
                             {&at(texture.alpha, "textures[i].alpha"), std::size_t(texture.width) * texture.height}});
    const auto optional = [&](const float* values, std::size_t each) {
        return array(values, values == nullptr ? 0 : count, each, "");
    };
    cut_outs_ = {array(from->material_of_triangle, count, 1, "material_of_triangle"),
                 optional(from->texture_coordinates, 6), optional(from->corner_alphas, 3), materials_, textures_};
}

LightVisibilities::LightVisibilities(const gnomon_light_visibility* pairs, std::size_t count) {
    for (const gnomon_light_visibility& pair : array(pairs, count, 1, "lights")) {
        lights.push_back(light_of(pair.light));
        visibilities.push_back(at(pair.visibility, "lights[i].visibility").visibility);
    }
}

std::vector<Light> lights_at(const gnomon_light* lights, std::size_t count) {
    std::vector<Light> all;
    for (const gnomon_light& light : array(lights, count, 1, "lights")) all.push_back(light_of(light));
    return all;
}

void WorkResults::finish(const Device& device, Statistics&& statistics) {
    StatisticsPointer shown;
    if (statistics_out_ != nullptr) shown.reset(new_statistics(std::move(statistics)));
    if (event_out_ != nullptr)
        cl::check(clEnqueueMarkerWithWaitList(device.queue(), 0, nullptr, event_out_), "enqueuing a marker");
    if (statistics_out_ != nullptr) *statistics_out_ = shown.release();
}

}  // namespace gnomon::c

const char* gnomon_version(void) { return version().data(); }

// ---- Status ---------------------------------------------------------------------------------------------------------

const char* gnomon_status_name(gnomon_status status) {
    switch (status) {
#define GN_STATUS(name) \
    case name:          \
        return #name
        GN_STATUS(GNOMON_SUCCESS);
        GN_STATUS(GNOMON_INVALID_ARGUMENT);
        GN_STATUS(GNOMON_DEVICE_NOT_FOUND);
        GN_STATUS(GNOMON_OUT_OF_DEVICE_MEMORY);
        GN_STATUS(GNOMON_OUT_OF_HOST_MEMORY);
        GN_STATUS(GNOMON_OPENCL_ERROR);
        GN_STATUS(GNOMON_STOPPED);
        GN_STATUS(GNOMON_UNEXPECTED_ERROR);
#undef GN_STATUS
    }
    return "an unknown status";
}

const char* gnomon_last_error(void) {
    return is_text_lost ? "the host has too little memory for the error's text" : last_error.c_str();
}

cl_int gnomon_last_opencl_error(void) { return last_opencl_error; }

// ---- Values ---------------------------------------------------------------------------------------------------------

gnomon_status gnomon_light_directional(const float direction[3], gnomon_light* light_out) {
    return guarded([&] {
        const Light light = Light::directional(float3_at(direction, "direction"));
        std::copy_n(light.xyzw.begin(), 4, at(light_out, "light_out").xyzw);
    });
}

gnomon_status gnomon_light_point(const float position[3], gnomon_light* light_out) {
    return guarded([&] {
        const Light light = Light::point(float3_at(position, "position"));
        std::copy_n(light.xyzw.begin(), 4, at(light_out, "light_out").xyzw);
    });
}

gnomon_status gnomon_camera_look_at(const float eye[3], const float target[3], const float up[3], double fov_y_degrees,
                                    gnomon_camera* camera_out) {
    return guarded([&] {
        const Camera camera =
            Camera::look_at(float3_at(eye, "eye"), float3_at(target, "target"), float3_at(up, "up"), fov_y_degrees);
        gnomon_camera& out = at(camera_out, "camera_out");
        std::copy_n(camera.eye.begin(), 3, out.eye);
        std::copy_n(camera.right.begin(), 3, out.right);
        std::copy_n(camera.up.begin(), 3, out.up);
        std::copy_n(camera.forward.begin(), 3, out.forward);
        out.fov_y_radians = camera.fov_y_radians;
    });
}

// ---- Devices --------------------------------------------------------------------------------------------------------

gnomon_status gnomon_opencl_load(const char* library) {
    return guarded([&] { load_opencl(library == nullptr ? "" : library); });
}

gnomon_status gnomon_device_open(const char* selector, const gnomon_device_options* options,
                                 gnomon_device** device_out) {
    return result_of(device_out, "device_out",
                     [&] { return new_device(Device(selector == nullptr ? "" : selector, options_of(options))); });
}

gnomon_status gnomon_device_wrap(cl_context context, cl_command_queue queue, const gnomon_device_options* options,
                                 gnomon_device** device_out) {
    return result_of(device_out, "device_out", [&] { return new_device(Device(context, queue, options_of(options))); });
}

void gnomon_device_destroy(gnomon_device* device) { delete device; }

gnomon_status gnomon_device_describe(const gnomon_device* device, const gnomon_device_description** description_out) {
    return result_of(description_out, "description_out", [&] { return &at(device, "device").description; });
}

gnomon_status gnomon_device_context(const gnomon_device* device, cl_context* context_out) {
    return result_of(context_out, "context_out", [&] { return at(device, "device").device.context(); });
}

gnomon_status gnomon_device_queue(const gnomon_device* device, cl_command_queue* queue_out) {
    return result_of(queue_out, "queue_out", [&] { return at(device, "device").device.queue(); });
}

gnomon_status gnomon_device_finish(const gnomon_device* device) {
    return guarded([&] { at(device, "device").device.finish(); });
}

gnomon_status gnomon_device_memory(const gnomon_device* device, uint64_t* bytes_out, uint64_t* peak_bytes_out) {
    return guarded([&] {
        const Device& cpp_device = at(device, "device").device;
        give(bytes_out, cpp_device.memory_bytes());
        give(peak_bytes_out, cpp_device.peak_memory_bytes());
    });
}

gnomon_status gnomon_device_kernel_builds(const gnomon_device* device, gnomon_kernel_builds* builds_out) {
    return guarded([&] {
        gnomon_kernel_builds& out = at(builds_out, "builds_out");
        const KernelBuilds builds = at(device, "device").device.kernel_builds();
        out = {builds.programs, builds.from_cache, builds.ms};
    });
}

// ---- Triangles ------------------------------------------------------------------------------------------------------

gnomon_status gnomon_triangles_upload(const gnomon_device* device, const float* vertices, size_t count,
                                      gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out",
                [&](const Device& on) { return Triangles::upload(on, array(vertices, count, 9, "vertices")); });
}

gnomon_status gnomon_triangles_share(const gnomon_device* device, const float* vertices, size_t count,
                                     gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out",
                [&](const Device& on) { return Triangles::share(on, array(vertices, count, 9, "vertices")); });
}

gnomon_status gnomon_triangles_wrap(const gnomon_device* device, cl_mem vertices, size_t count, size_t first_float,
                                    gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out",
                [&](const Device& on) { return Triangles::wrap(on, vertices, count, first_float); });
}

gnomon_status gnomon_triangles_raster(const gnomon_device* device, const float* x, size_t columns, const float* y,
                                      size_t rows, const float* heights, bool joins_first_corner,
                                      gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out", [&](const Device& on) {
        const auto all_heights = array(heights, rows, columns, "heights");
        return Triangles::raster(on,
                                 {array(x, columns, 1, "x"), array(y, rows, 1, "y"), all_heights, joins_first_corner});
    });
}

void gnomon_triangles_destroy(gnomon_triangles* triangles) { delete triangles; }

gnomon_status gnomon_triangles_upload_cut_outs(const gnomon_device* device, const float* vertices, size_t count,
                                               const gnomon_cut_outs* cut_outs, gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out", [&](const Device& on) {
        const auto all = array(vertices, count, 9, "vertices");
        at(cut_outs, "cut_outs");
        return Triangles::upload(on, all, *CutOutsArgument(cut_outs, count).get());
    });
}

gnomon_status gnomon_triangles_copy_cut_outs(const gnomon_device* device, cl_mem vertices, size_t count,
                                             size_t first_float, const gnomon_cut_out_buffers* cut_outs,
                                             gnomon_triangles** triangles_out) {
    return made(device, triangles_out, "triangles_out", [&](const Device& on) {
        at(vertices, "vertices");
        const gnomon_cut_out_buffers& c_buffers = sized_at(cut_outs, "cut_outs");
        const std::vector<CutOutMaterial> materials = materials_at(c_buffers.materials, c_buffers.material_count);
        std::vector<CutOutBuffers::Texture> textures;
        for (const gnomon_alpha_texture_buffer& texture :
             array(c_buffers.textures, c_buffers.texture_count, 1, "textures"))
            textures.push_back({texture.width, texture.height, &at(texture.alpha, "textures[i].alpha")});
        return Triangles::copy(on, vertices, count, first_float,
                               {c_buffers.material_of_triangle, c_buffers.texture_coordinates, c_buffers.corner_alphas,
                                materials, textures});
    });
}

gnomon_status gnomon_triangles_cut_out_counts(const gnomon_triangles* triangles, gnomon_cut_out_counts* counts_out) {
    return guarded([&] {
        const CutOutCounts& counts = at(triangles, "triangles").triangles.cut_out_counts();
        at(counts_out, "counts_out") = {counts.masked, counts.opaque, counts.clear, counts.unusable};
    });
}

gnomon_status gnomon_triangles_keep_clusters(gnomon_triangles* triangles, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        gnomon_triangles& c_triangles = at(triangles, "triangles");
        c_triangles.triangles.keep_clusters(c_triangles.device);
        results.finish(c_triangles.device);
    });
}

gnomon_status gnomon_triangles_count(const gnomon_triangles* triangles, size_t* count_out) {
    return guarded([&] { at(count_out, "count_out") = at(triangles, "triangles").triangles.count(); });
}

gnomon_status gnomon_triangles_buffer(const gnomon_triangles* triangles, cl_mem* buffer_out, size_t* first_float_out) {
    return guarded([&] {
        const Triangles& cpp_triangles = at(triangles, "triangles").triangles;
        give(buffer_out, cpp_triangles.buffer());
        give(first_float_out, cpp_triangles.first_float());
    });
}

// ---- Points ---------------------------------------------------------------------------------------------------------

gnomon_status gnomon_points_upload(const gnomon_device* device, const float* positions, size_t count,
                                   const uint32_t* receivers, gnomon_points** points_out) {
    return made(device, points_out, "points_out", [&](const Device& on) {
        const auto ids = array(receivers, receivers == nullptr ? 0 : count, 1, "receivers");
        return Points::upload(on, array(positions, count, 3, "positions"), ids);
    });
}

gnomon_status gnomon_points_share(const gnomon_device* device, const float* positions, size_t count,
                                  const uint32_t* receivers, gnomon_points** points_out) {
    return made(device, points_out, "points_out", [&](const Device& on) {
        const auto ids = array(receivers, receivers == nullptr ? 0 : count, 1, "receivers");
        return Points::share(on, array(positions, count, 3, "positions"), ids);
    });
}

gnomon_status gnomon_points_wrap(const gnomon_device* device, cl_mem positions, const gnomon_point_layout* layout,
                                 size_t count, cl_mem receivers, gnomon_points** points_out) {
    return made(device, points_out, "points_out", [&](const Device& on) {
        return Points::wrap(on, positions, layout_or_packed(layout), count, receivers);
    });
}

void gnomon_points_destroy(gnomon_points* points) { delete points; }

gnomon_status gnomon_points_set_camera(gnomon_points* points, const gnomon_camera* camera, uint32_t width,
                                       uint32_t height) {
    return guarded([&] { at(points, "points").points.set_camera(camera_at(camera), width, height); });
}

gnomon_status gnomon_points_set_lifted_off(gnomon_points* points, const gnomon_triangles* triangles,
                                           const float eye[3]) {
    return guarded([&] {
        at(points, "points").points.set_lifted_off(at(triangles, "triangles").triangles, float3_at(eye, "eye"));
    });
}

gnomon_status gnomon_points_count(const gnomon_points* points, size_t* count_out) {
    return guarded([&] { at(count_out, "count_out") = at(points, "points").points.count(); });
}

gnomon_status gnomon_points_positions(const gnomon_points* points, cl_mem* buffer_out,
                                      gnomon_point_layout* layout_out) {
    return guarded([&] {
        const Points& cpp_points = at(points, "points").points;
        const PointLayout& layout = cpp_points.layout();
        give(buffer_out, cpp_points.positions());
        give(layout_out, {layout.first, layout.point_stride, layout.coordinate_stride});
    });
}

gnomon_status gnomon_points_receivers(const gnomon_points* points, cl_mem* buffer_out) {
    return result_of(buffer_out, "buffer_out", [&] { return at(points, "points").points.receivers(); });
}

gnomon_status gnomon_points_read(const gnomon_points* points, float* positions_out, uint32_t* receivers_out) {
    return guarded([&] {
        const gnomon_points& c_points = at(points, "points");
        const PointsOnHost host = c_points.points.read(c_points.device);
        if (positions_out != nullptr) std::copy(host.position.begin(), host.position.end(), positions_out);
        if (receivers_out != nullptr) std::copy(host.receiver.begin(), host.receiver.end(), receivers_out);
    });
}

gnomon_status gnomon_points_lift(const gnomon_points* points, const gnomon_triangles* triangles, const float eye[3],
                                 gnomon_points** lifted_out, cl_event* event_out) {
    return guarded([&] {
        WorkResults results(event_out);
        gnomon_points*& out = result_at(lifted_out, "lifted_out");
        const gnomon_points& c_points = at(points, "points");
        const Triangles& off = at(triangles, "triangles").triangles;
        auto lifted = std::make_unique<gnomon_points>(
            gnomon_points{c_points.device, lift(c_points.device, off, c_points.points, float3_at(eye, "eye"))});
        results.finish(c_points.device);
        out = lifted.release();
    });
}

// ---- Visibility -----------------------------------------------------------------------------------------------------

gnomon_status gnomon_visibility_create(const gnomon_device* device, size_t count, gnomon_visibility** visibility_out) {
    return made(device, visibility_out, "visibility_out", [&](const Device& on) { return Visibility(on, count); });
}

gnomon_status gnomon_visibility_wrap(const gnomon_device* device, cl_mem buffer, size_t count, size_t first_float,
                                     gnomon_visibility** visibility_out) {
    return made(device, visibility_out, "visibility_out",
                [&](const Device& on) { return Visibility::wrap(on, buffer, count, first_float); });
}

gnomon_status gnomon_visibility_share(const gnomon_device* device, float* values, size_t count,
                                      gnomon_visibility** visibility_out) {
    return made(device, visibility_out, "visibility_out", [&](const Device& on) {
        array(values, count, 1, "values");
        return Visibility::share(on, {values, count});
    });
}

gnomon_status gnomon_visibility_fetch(const gnomon_visibility* visibility) {
    return guarded([&] { at(visibility, "visibility").visibility.fetch(); });
}

void gnomon_visibility_destroy(gnomon_visibility* visibility) { delete visibility; }

gnomon_status gnomon_visibility_count(const gnomon_visibility* visibility, size_t* count_out) {
    return guarded([&] { at(count_out, "count_out") = at(visibility, "visibility").visibility.count(); });
}

gnomon_status gnomon_visibility_buffer(const gnomon_visibility* visibility, cl_mem* buffer_out) {
    return result_of(buffer_out, "buffer_out", [&] { return at(visibility, "visibility").visibility.buffer(); });
}

gnomon_status gnomon_visibility_read(const gnomon_visibility* visibility, float* values_out) {
    return guarded([&] {
        const auto& [device, from] = at(visibility, "visibility");
        if (from.count() == 0) return;
        session_of(device).read(from.buffer(), &at(values_out, "values_out"), from.count() * sizeof(float));
    });
}
