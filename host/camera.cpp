// SPDX-License-Identifier: MIT
#include "camera.hpp"

#include <algorithm>
#include <cmath>

#include "../kernels/camera.h"
#include "bins.hpp"
#include "vectors.hpp"

namespace gnomon {
namespace {

// A double as the sum of two floats, to 48 bits. The volatile is needed: g++ 12 at -O2 and above vectorizes the loop
// and drops the rounding of double(float(v)), so that `low` became 0 (seen here: two pixels of Sponza moved by 600
// ulp).
void append_split(std::vector<float>& rays, const Double3& v) {
    std::array<float, 3> high, low;
    for (int i = 0; i < 3; ++i) {
        volatile float rounded = static_cast<float>(v[i]);
        high[i] = rounded;
        low[i] = static_cast<float>(v[i] - double(high[i]));
    }
    rays.insert(rays.end(), high.begin(), high.end());
    rays.insert(rays.end(), low.begin(), low.end());
}

double determinant(const Camera& camera) { return dot(camera.right, cross(camera.up, camera.forward)); }

// A camera filled by hand: axes of about unit length that span space, and an angle that a picture can have.
void require_camera(const Camera& camera) {
    for (const float c : camera.eye)
        if (!std::isfinite(c)) throw InvalidArgument("the camera's eye must be finite numbers");
    for (const Double3& axis : {camera.right, camera.up, camera.forward}) {
        const double length = std::sqrt(dot(axis, axis));
        if (!(length > 0.5 && length < 2)) throw InvalidArgument("the camera's axes must be unit vectors");
    }
    if (!(std::fabs(determinant(camera)) > 0.01))
        throw InvalidArgument("the camera's right, up and forward must not lie in one plane");
    if (!(camera.fov_y_radians > 0 && camera.fov_y_radians < 3.14159265358979))
        throw InvalidArgument("the camera's vertical field of view must lie between 0 and 180 degrees");
}

void set_row(float* row, double a, const Double3& u, double b, const Double3& v) {
    for (int i = 0; i < 3; ++i) row[i] = static_cast<float>(a * u[i] + b * v[i]);
    row[3] = 0.0f;
}

constexpr std::uint32_t largest_side = 16384;

Float4 eye_of(const View& view) {
    const Float3& eye = *view.points.eye();
    return {eye[0], eye[1], eye[2], 0.0f};
}

// Survivors and references of the view's triangles, grown until they fit.
struct CameraLists {
    TriangleSetup setup;
    Bins bins;
};

void run_visibility(cl::Session& session, const TriangleInputs& triangles, const CameraTables& tables,
                    const cl::Buffer& projection, const cl::Buffer& rays, cl_mem visible, Statistics& statistics) {
    const std::uint32_t bin_count = tables.projection.bins_x * tables.projection.bins_y;
    const std::size_t pixels = std::size_t(tables.projection.width) * tables.projection.height;
    CameraLists lists;
    cl::Buffer counters(session, sizeof(FrameCounters));
    FrameCounters counted;
    bool fitted = false;
    do {
        session.fill(counters, 0, sizeof(FrameCounters));
        {
            cl::StageTimer timer(session, statistics, "camera_setup");
            lists.setup.run(session, projection, triangles, nullptr, counters);
        }
        {
            cl::StageTimer timer(session, statistics, "camera_bins");
            lists.bins.run(session, projection, bin_count, lists.setup, nullptr, counters);
        }
        {
            cl::StageTimer timer(session, statistics, "camera_visibility");
            session.launch("camera.cl", "camera_visibility", cl::Range::items(pixels / session.lanes() + 1), projection,
                           triangles.first_float, lists.setup.capacity(), lists.bins.capacity(), triangles.vertices,
                           rays, lists.setup.records(), lists.setup.ids(), lists.bins.offsets(),
                           lists.bins.references(), counters, visible);
        }
        session.read(counters.get(), &counted, sizeof(counted));
        const bool records = lists.setup.fitted(session, counted);
        fitted = lists.bins.fitted(session, counted, records) && records;
    } while (!fitted);
    statistics.counts = {{"pixels", pixels},
                         {"triangles", triangles.count},
                         {"triangles_not_finite", counted.not_finite},
                         {"triangles_edge_on", counted.edge_on},
                         {"triangles_outside", counted.outside},
                         {"triangles_kept", counted.survivors},
                         {"references", counted.references}};
}

}  // namespace

CameraTables camera_tables(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    const double t = std::tan(camera.fov_y_radians / 2);
    const double half_width = width / 2.0, half_height = height / 2.0;
    const double pixel = t / half_height;  // pixels are square: aspect t / half_width is the same

    CameraTables tables{};
    Projection& p = tables.projection;
    std::copy(camera.eye.begin(), camera.eye.end(), p.center);
    std::copy(camera.eye.begin(), camera.eye.end(), p.light);
    p.light[3] = 1.0f;
    // With d = a right + b up + c forward:  X = a / (pixel c) + half_width,  Y = half_height - b / (pixel c),  W = c.
    // a, b, c by the dual basis, so that axes need not be orthogonal.
    const double volume = determinant(camera);
    const Double3 dual_right = scaled(cross(camera.up, camera.forward), 1 / volume);
    const Double3 dual_up = scaled(cross(camera.forward, camera.right), 1 / volume);
    const Double3 dual_forward = scaled(cross(camera.right, camera.up), 1 / volume);
    set_row(p.row_x, 1 / pixel, dual_right, half_width, dual_forward);
    set_row(p.row_y, -1 / pixel, dual_up, half_height, dual_forward);
    set_row(p.row_z, 1, dual_forward, 0, dual_forward);
    // The rows hold the duals of right, -up and forward, and the dual basis has the basis's orientation.
    p.handedness = volume > 0 ? -1.0f : 1.0f;
    p.width = width;
    p.height = height;
    p.bin_log2 = CAMERA_TILE_LOG2;
    p.bins_x = (width + (1u << p.bin_log2) - 1) >> p.bin_log2;
    p.bins_y = (height + (1u << p.bin_log2) - 1) >> p.bin_log2;
    p.perspective = 1;
    p.active_points = 1;

    tables.rays.reserve((std::size_t(width) + height) * RAY_FLOATS);
    for (std::uint32_t x = 0; x < width; ++x) {
        Double3 column;
        for (int i = 0; i < 3; ++i) column[i] = camera.forward[i] + (x + 0.5 - half_width) * pixel * camera.right[i];
        append_split(tables.rays, column);
    }
    for (std::uint32_t y = 0; y < height; ++y) {
        Double3 row;
        for (int i = 0; i < 3; ++i) row[i] = (half_height - (y + 0.5)) * pixel * camera.up[i];
        append_split(tables.rays, row);
    }
    return tables;
}

View look(const Device& device, const Triangles& triangles, const Camera& camera, std::uint32_t width,
          std::uint32_t height) {
    if (width == 0 || height == 0 || width > largest_side || height > largest_side)
        throw InvalidArgument("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                              " pixels: each side must be from 1 to " + std::to_string(largest_side));
    require_camera(camera);
    cl::Session& session = device.session();
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t before = session.memory_bytes();
    session.begin_run();
    const std::size_t pixels = std::size_t(width) * height;
    const CameraTables tables = camera_tables(camera, width, height);
    cl::Buffer projection(session, sizeof(Projection)), rays(session, tables.rays.size() * sizeof(float));
    session.write(projection.get(), &tables.projection, sizeof(Projection));
    session.write(rays.get(), tables.rays.data(), tables.rays.size() * sizeof(float));

    cl::Buffer positions(session, pixels * 3 * sizeof(float)), visible(session, pixels * sizeof(cl_uint));
    const TriangleInputs inputs = triangle_inputs(triangles);
    View view;
    view.width = width;
    view.height = height;
    if (triangles.count() == 0)
        session.fill(visible, no_receiver, pixels * sizeof(cl_uint));
    else
        run_visibility(session, inputs, tables, projection, rays, visible.get(), view.statistics);
    {
        cl::StageTimer timer(session, view.statistics, "camera_points");
        session.launch("camera.cl", "camera_points", cl::Range::items(pixels), width, height,
                       Float4{camera.eye[0], camera.eye[1], camera.eye[2], 0.0f}, inputs.first_float, inputs.vertices,
                       rays, visible, positions);
    }
    view.points = Points::wrap(device, positions.get(), {0, 1, pixels}, pixels, visible.get());
    view.points.set_camera(camera, width, height);
    session.finish();
    view.statistics.device_memory_bytes = session.run_peak_bytes() - before;
    view.statistics.total_wall_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return view;
}

cl::Buffer camera_normals(const Device& device, const Triangles& triangles, const View& view) {
    cl::Session& session = device.session();
    const TriangleInputs inputs = triangle_inputs(triangles);
    cl::Buffer normals(session, view.points.count() * 3 * sizeof(float));
    session.launch("camera.cl", "camera_normals", cl::Range::items(view.points.count()), cl_uint(view.points.count()),
                   eye_of(view), inputs.first_float, inputs.vertices, view.points.receivers(), normals);
    return normals;
}

ViewOnHost read(const Device& device, const Triangles& triangles, const View& view) {
    cl::Session& session = device.session();
    const std::size_t pixels = view.points.count();
    ViewOnHost host;
    host.receiver.resize(pixels);
    host.normal.resize(pixels * 3);
    host.position.resize(pixels * 3);
    session.read(view.points.receivers(), host.receiver.data(), pixels * sizeof(cl_uint));
    const cl::Buffer normals = camera_normals(device, triangles, view);
    session.read(normals.get(), host.normal.data(), host.normal.size() * sizeof(float));
    std::vector<float> planes(pixels * 3);
    session.read(view.points.positions(), planes.data(), planes.size() * sizeof(float));
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            host.position[3 * i + c] = host.receiver[i] == no_receiver ? 0.0f : planes[i + c * pixels];
    return host;
}

}  // namespace gnomon
