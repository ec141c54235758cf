// SPDX-License-Identifier: MIT
#include "camera/camera.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "query/statistics.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

// A double as the sum of two floats, to 48 bits. The volatile is needed: g++ 12 at -O2 and above vectorizes the loop
// and drops the rounding of double(float(v)), so that `low` became 0 (seen here: two pixels of Sponza moved by 600
// ulp).
void append_split(std::vector<float>& rays, const glm::dvec3& v) {
    std::array<float, 3> high, low;
    for (int i = 0; i < 3; ++i) {
        volatile float rounded = static_cast<float>(v[i]);
        high[i] = rounded;
        low[i] = static_cast<float>(v[i] - double(high[i]));
    }
    rays.insert(rays.end(), high.begin(), high.end());
    rays.insert(rays.end(), low.begin(), low.end());
}

double volume_of(const Camera& camera) {
    return determinant(loaded(camera.right), loaded(camera.up), loaded(camera.forward));
}

// Refuses a camera with axes that are not of about unit length or do not span space, or with an impossible angle.
void require_camera(const Camera& camera) {
    if (!is_finite(camera.eye)) throw InvalidArgument("the camera's eye must be finite numbers");
    for (const auto& axis : {camera.right, camera.up, camera.forward}) {
        const double length = glm::length(loaded(axis));
        if (!(length > 0.5 && length < 2)) throw InvalidArgument("the camera's axes must be unit vectors");
    }
    if (!(std::fabs(volume_of(camera)) > 0.01))
        throw InvalidArgument("the camera's right, up and forward must not lie in one plane");
    if (!(camera.fov_y_radians > 0 && camera.fov_y_radians < 3.14159265358979))
        throw InvalidArgument("the camera's vertical field of view must lie between 0 and 180 degrees");
}

// A pixel's side at distance 1. Pixels are square: aspect tan(fov / 2) / half the width is the same.
double pixel_size(const Camera& camera, std::uint32_t height) {
    return std::tan(camera.fov_y_radians / 2) / (height / 2.0);
}

constexpr std::uint32_t largest_side = 16384;

// The rays, and the coarsest grid of positions in a pixel that has all these samples in both coordinates. The spacing
// divides SAMPLE_UNITS, a power of two, and so is one.
CameraSamples camera_samples(const Camera& camera, std::uint32_t width, std::uint32_t height,
                             std::span<const SampleOffset> offsets) {
    const int first = offsets.front().x + SAMPLE_UNITS / 2;
    int spacing = SAMPLE_UNITS;
    for (const SampleOffset& offset : offsets)
        for (const int position : {offset.x, offset.y})
            spacing = std::gcd(spacing, position + SAMPLE_UNITS / 2 - first);
    return {picture_rays(camera, width, height), cl_uint(SAMPLE_UNITS / spacing),
            float(first % spacing) / SAMPLE_UNITS};
}

}  // namespace

RayAxes ray_axes(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    RayAxes axes{};
    for (std::size_t i = 0; i < 3; ++i) {
        axes.right[i] = std::bit_cast<std::uint64_t>(camera.right[i]);
        axes.up[i] = std::bit_cast<std::uint64_t>(camera.up[i]);
        axes.forward[i] = std::bit_cast<std::uint64_t>(camera.forward[i]);
    }
    axes.pixel = std::bit_cast<std::uint64_t>(pixel_size(camera, height));
    axes.half_width = std::bit_cast<std::uint64_t>(width / 2.0);
    axes.half_height = std::bit_cast<std::uint64_t>(height / 2.0);
    axes.width = width;
    axes.height = height;
    return axes;
}

Projection camera_projection(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    const double half_width = width / 2.0, half_height = height / 2.0;
    const double pixel = pixel_size(camera, height);

    Projection p{};
    std::copy(camera.eye.begin(), camera.eye.end(), p.center);
    std::copy(camera.eye.begin(), camera.eye.end(), p.light);
    p.light[3] = 1.0f;
    // With d = a right + b up + c forward:  X = a / (pixel c) + half_width,  Y = half_height - b / (pixel c),  W = c.
    // a, b, c by the dual basis, so that axes need not be orthogonal.
    const double volume = volume_of(camera);
    const glm::dvec3 right = loaded(camera.right), up = loaded(camera.up), forward = loaded(camera.forward);
    const glm::dvec3 dual_right = cross(up, forward) * (1 / volume), dual_up = cross(forward, right) * (1 / volume);
    const glm::dvec3 dual_forward = cross(right, up) * (1 / volume);
    store(p.row_x, 1 / pixel * dual_right + half_width * dual_forward);
    store(p.row_y, -1 / pixel * dual_up + half_height * dual_forward);
    store(p.row_z, dual_forward);
    // The rows hold the duals of right, -up and forward, and the dual basis has the basis's orientation.
    p.handedness = volume > 0 ? -1.0f : 1.0f;
    p.width = width;
    p.height = height;
    p.bin_log2 = CAMERA_TILE_LOG2;
    p.bins_x = (width + (1u << p.bin_log2) - 1) >> p.bin_log2;
    p.bins_y = (height + (1u << p.bin_log2) - 1) >> p.bin_log2;
    p.perspective = 1;
    p.active_points = 1;
    p.z_scale = 0.0f;
    return p;
}

PictureRays picture_rays(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    const double half_width = width / 2.0, half_height = height / 2.0;
    const double pixel = pixel_size(camera, height);
    PictureRays picture{};
    const glm::dvec3 right = loaded(camera.right), up = loaded(camera.up);
    store(picture.corner, loaded(camera.forward) - half_width * pixel * right + half_height * pixel * up);
    store(picture.step_x, pixel * right);
    store(picture.step_y, -pixel * up);
    return picture;
}

std::vector<float> camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, SampleOffset offset) {
    const double half_width = width / 2.0, half_height = height / 2.0;
    const double pixel = pixel_size(camera, height);
    // Exact: sums of small multiples of 1 / SAMPLE_UNITS.
    const double sample_x = 0.5 + double(offset.x) / SAMPLE_UNITS, sample_y = 0.5 + double(offset.y) / SAMPLE_UNITS;
    std::vector<float> rays;
    rays.reserve((std::size_t(width) + height) * RAY_FLOATS);
    const glm::dvec3 right = loaded(camera.right), up = loaded(camera.up), forward = loaded(camera.forward);
    for (std::uint32_t x = 0; x < width; ++x) append_split(rays, forward + (x + sample_x - half_width) * pixel * right);
    for (std::uint32_t y = 0; y < height; ++y) append_split(rays, (half_height - (y + sample_y)) * pixel * up);
    return rays;
}

void CameraStage::aim(const Triangles& triangles, const Camera& camera, std::uint32_t width, std::uint32_t height,
                      std::span<const SampleOffset> offsets) {
    triangles_ = triangle_inputs(triangles);
    camera_ = camera;
    width_ = width;
    height_ = height;
    samples_ = camera_samples(camera, width, height, offsets);
    fitted_ = false;
    chunk_count_ = open_count_ = 0;
    long_list_ = next_long_list_;
    projection_.reserve(session_, sizeof(Projection));
    counters_.reserve(session_, sizeof(FrameCounters));
    const Projection projection = camera_projection(camera, width, height);
    session_.write(projection_.get(), &projection, sizeof(projection));
}

void CameraStage::make_lists(Statistics& statistics, bool orders_runs) {
    session_.fill(counters_, 0, sizeof(FrameCounters));
    ListInputs in{.projection{projection_}, .bin_count = tiles_x() * tiles_y()};
    in.projection.camera = &samples_;
    in.settings.orders_runs = orders_runs;
    lists_.run(session_, statistics, in, triangles_, counters_);
    if (session_.lanes() != 1) return;
    // A list of n entries has fewer than 2 n / long_list_ chunks. There is room for the least limit from the start.
    chunks_.reserve(session_, (2 * std::size_t(bins().entry_capacity()) / MIN_LONG_LIST + 1) * sizeof(ListChunk));
    cl::StageTimer timer(session_, statistics, "camera_bins");
    session_.launch(triangles_.kernel("camera/camera.cl", "camera_chunks"), cl::Range::items(in.bin_count),
                    in.bin_count, long_list_, bins().ranges(), chunks_, counters_);
}

bool CameraStage::check_lists(Statistics& statistics) {
    const auto counted = session_.read_value<FrameCounters>(counters_);
    statistics.counts = {{"pixels", std::size_t(width_) * height_},
                         {"triangles", triangles_.count},
                         {"clusters", triangles_.clusters != nullptr ? triangles_.clusters->count() : 0},
                         {"clusters_outside", counted.clusters_outside},
                         {"triangles_not_finite", counted.not_finite},
                         {"triangles_edge_on", counted.edge_on},
                         {"triangles_outside", counted.outside},
                         {"triangles_kept", counted.survivors - counted.edge_on},
                         {"references", counted.references}};
    chunk_count_ = counted.chunks;
    open_count_ = counted.open_pairs;
    next_long_list_ = std::max(MIN_LONG_LIST, counted.entries / LONG_LISTS);
    return lists_.fitted(session_, counted);
}

void CameraStage::fit_lists(Statistics& statistics) {
    while (!fitted_) {
        make_lists(statistics, true);
        fitted_ = check_lists(statistics);
    }
}

CameraParams CameraStage::params_of(SampleOffset offset, bool has_pixel_receivers, const PointSlice& out) const {
    return {.triangles = triangles_,
            .picture = samples_.picture,
            .eye = {camera_.eye[0], camera_.eye[1], camera_.eye[2]},
            .offset = {float(offset.x) / SAMPLE_UNITS, float(offset.y) / SAMPLE_UNITS},
            .width = width_,
            .height = height_,
            .first_point = cl_uint(out.first),
            .point_count = cl_uint(out.count),
            .has_pixel_receivers = has_pixel_receivers,
            .long_list = long_list_,
            .chunk_count = chunk_count_};
}

void CameraStage::find_receivers(const CameraParams& params, cl_mem pixel_receivers, const PointSlice& out,
                                 Statistics& statistics) {
    if (triangles_.count == 0) {
        const std::vector<cl_uint> sky(out.count, no_receiver);
        session_.write(out.receivers, sky.data(), sky.size() * sizeof(cl_uint));
        session_.fill(counters_, 0, sizeof(FrameCounters));
        return;
    }
    cl::StageTimer timer(session_, statistics, "camera_visibility");
    session_.launch(triangles_.kernel("camera/camera.cl", "camera_visibility"),
                    session_.block_shares(std::size_t(width_) * height_), params, projection_, triangles_.vertices,
                    rays_, setup().records(), setup().bounds(), bins().ranges(), bins().entries(),
                    pixel_receivers != nullptr ? pixel_receivers : out.receivers, out.receivers, counters_);
}

// Pairs that find no place are decided in place, by another look.
bool CameraStage::filters(const CameraParams& params) const {
    return session_.lanes() == 1 && !fitted_ && params.has_pixel_receivers == 0;
}

void CameraStage::filter_receivers(const CameraParams& params, const PointSlice& out, Statistics& statistics) {
    const auto of_file = [&](const char* kernel) { return triangles_.kernel("camera/camera_filter.cl", kernel); };
    const std::size_t pixels = std::size_t(width_) * height_;
    const std::size_t every = triangles_.has_cut_outs ? OPEN_PAIRS_EVERY_WITH_CUT_OUTS : OPEN_PAIRS_EVERY;
    open_capacity_ = cl_uint(pixels / every + MIN_OPEN_PAIRS);
    open_pairs_.reserve(session_, open_capacity_ * sizeof(cl_uint2));
    cl::StageTimer timer(session_, statistics, "camera_visibility");
    // Tiles differ in work: a multiprocessor that is done takes another one.
    const std::size_t tile_pixels = 1u << 2 * CAMERA_TILE_LOG2, group = session_.work_group_size();
    const std::size_t groups = std::size_t(tiles_x()) * tiles_y() * ((tile_pixels + group - 1) / group);
    session_.launch(of_file("camera_filter"), cl::Range::groups(groups), params, projection_, setup().records(),
                    setup().bounds(), bins().ranges(), bins().entries(), out.receivers, open_pairs_, open_capacity_,
                    counters_);
    session_.launch(of_file("camera_open_pairs"), cl::Range::items(open_capacity_), params, triangles_.vertices, rays_,
                    setup().bounds(), open_pairs_, open_capacity_, out.receivers, counters_);
}

void CameraStage::find_in_long_lists(const CameraParams& params, cl_mem pixel_receivers, const PointSlice& out,
                                     Statistics& statistics) {
    const char* file = "camera/long_lists.cl";
    const cl_mem own = pixel_receivers != nullptr ? pixel_receivers : out.receivers;
    const std::uint32_t tile_pixels = 1u << 2 * CAMERA_TILE_LOG2;
    found_.reserve(session_, std::size_t(chunk_count_) * tile_pixels * sizeof(cl_uint));
    cl::StageTimer timer(session_, statistics, "camera_long_lists");
    const auto items = cl::Range::items(std::size_t(chunk_count_) * tile_pixels);
    session_.launch(triangles_.kernel(file, "camera_search_chunks"), items, params, projection_, triangles_.vertices,
                    rays_, setup().records(), setup().bounds(), bins().ranges(), bins().entries(), own, chunks_,
                    found_);
    session_.launch(triangles_.kernel(file, "camera_join_chunks"), items, params, projection_, triangles_.vertices,
                    rays_, setup().records(), setup().bounds(), bins().ranges(), own, chunks_, found_, out.receivers);
}

void CameraStage::make_points(const CameraParams& params, const PointSlice& out, Statistics& statistics) {
    cl::StageTimer timer(session_, statistics, "camera_points");
    session_.launch(triangles_.kernel("camera/camera.cl", "camera_points"),
                    cl::Range::shares(std::size_t(width_) * height_), params, triangles_.vertices, rays_, out.receivers,
                    out.positions, counters_);
}

void CameraStage::run(SampleOffset offset, cl_mem pixel_receivers, const PointSlice& out, Statistics& statistics) {
    const CameraParams params = params_of(offset, pixel_receivers != nullptr, out);
    if (std::vector<float> rays = camera_rays(camera_, width_, height_, offset); rays != written_rays_) {
        session_.upload(rays_, rays);
        written_rays_ = std::move(rays);
    }
    fitted_ = fitted_ || triangles_.count == 0;
    // Lists grow until they fit. The host reads the counters after it has enqueued all stages, so that the device does
    // not wait; where a list was too short, the kernels see it and do nothing.
    for (bool is_done = false; !is_done;) {
        const bool had_lists = fitted_;
        if (!had_lists) make_lists(statistics, false);
        if (filters(params))
            filter_receivers(params, out, statistics);
        else
            find_receivers(params, pixel_receivers, out, statistics);
        make_points(params, out, statistics);
        fitted_ = is_done = had_lists || check_lists(statistics);
    }
    if (open_count_ <= open_capacity_ && chunk_count_ == 0) return;
    if (open_count_ > open_capacity_) find_receivers(params, pixel_receivers, out, statistics);
    open_count_ = 0;
    if (chunk_count_ != 0)
        find_in_long_lists(params_of(offset, pixel_receivers != nullptr, out), pixel_receivers, out, statistics);
    make_points(params, out, statistics);
}

// ---- Views ----------------------------------------------------------------------------------------------------------

namespace {

// The buffers of a view. They serve another view when no object but the pass refers to them.
struct ViewBuffers {
    std::size_t pixels = 0;
    std::shared_ptr<void> positions, receivers;

    bool is_free() const { return positions.use_count() <= 1 && receivers.use_count() <= 1; }
};

}  // namespace

struct CameraPass::State {
    explicit State(const Device& theirs) : device(theirs), stage(theirs) {}

    ViewBuffers& buffers_for(std::size_t pixels) {
        for (ViewBuffers& some : kept)
            if (some.pixels == pixels && some.is_free()) return some;
        std::erase_if(kept, [&](const ViewBuffers& some) { return some.is_free() || some.pixels != pixels; });
        cl::Session& session = session_of(device);
        cl::Buffer positions(session, pixels * 3 * sizeof(float)), receivers(session, pixels * sizeof(cl_uint));
        kept.push_back(
            {pixels, shared_buffer(device, std::move(positions)), shared_buffer(device, std::move(receivers))});
        return kept.back();
    }

    Device device;
    CameraStage stage;
    std::vector<ViewBuffers> kept;
    std::uint64_t kept_bytes = 0;
};

CameraPass::CameraPass(const Device& device) : state_(std::make_unique<State>(device)) {}
CameraPass::~CameraPass() = default;
CameraPass::CameraPass(CameraPass&&) noexcept = default;
CameraPass& CameraPass::operator=(CameraPass&&) noexcept = default;

View CameraPass::look(const Triangles& triangles, const Camera& camera, std::uint32_t width, std::uint32_t height) {
    if (width == 0 || height == 0 || width > largest_side || height > largest_side)
        throw InvalidArgument("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                              " pixels: each side must be from 1 to " + std::to_string(largest_side));
    require_camera(camera);
    cl::Session& session = session_of(state_->device);
    MeasuredRun measured(session, state_->kept_bytes);
    const std::size_t pixels = std::size_t(width) * height;
    const ViewBuffers& buffers = state_->buffers_for(pixels);
    View view;
    view.width = width;
    view.height = height;
    view.points = Internals::make_points(buffers.positions, {0, 1, pixels}, pixels, buffers.receivers);
    constexpr SampleOffset centre[1] = {};
    state_->stage.aim(triangles, camera, width, height, centre);
    state_->stage.run({}, nullptr, {view.points.positions(), view.points.receivers(), 0, pixels}, measured.stages);
    view.points.set_camera(camera, width, height);
    view.points.set_lifted_off(triangles, camera.eye);
    session.finish();
    view.statistics = measured.finish();
    return view;
}

View look(const Device& device, const Triangles& triangles, const Camera& camera, std::uint32_t width,
          std::uint32_t height) {
    return CameraPass(device).look(triangles, camera, width, height);
}

Points lift(const Device& device, const Triangles& triangles, const Points& points, const Float3& eye) {
    if (!is_finite(eye)) throw InvalidArgument("the eye to lift points towards must be finite numbers");
    if (points.receivers() == nullptr) throw InvalidArgument("points without receivers have no plane to be lifted off");
    cl::Session& session = session_of(device);
    const TriangleInputs inputs = triangle_inputs(triangles);
    const PointInputs at = point_inputs(points);
    cl::Buffer positions(session, points.count() * 3 * sizeof(float));
    if (points.count() != 0)
        session.launch(inputs.kernel("camera/camera.cl", "lift_points"), cl::Range::items(points.count()),
                       LiftParams{.first_float = inputs.first_float,
                                  .layout = at.layout,
                                  .eye = {eye[0], eye[1], eye[2]},
                                  .triangle_count = inputs.count},
                       inputs.vertices, at.positions, at.receivers, positions);
    return Internals::make_points(shared_buffer(device, std::move(positions)), {}, points.count(),
                                  Internals::receivers(points));
}

void camera_normals(const Device& device, const Triangles& triangles, const View& view, cl::Buffer& normals) {
    cl::Session& session = session_of(device);
    const TriangleInputs inputs = triangle_inputs(triangles);
    normals.reserve(session, view.points.count() * 3 * sizeof(float));
    CameraParams params{};
    params.triangles = inputs;
    std::copy_n(view.points.camera()->camera.eye.begin(), 3, params.eye);
    params.width = view.width;
    params.height = view.height;
    session.launch(inputs.kernel("camera/camera.cl", "camera_normals"), cl::Range::shares(view.points.count()), params,
                   inputs.vertices, view.points.receivers(), normals);
}

ViewOnHost View::read(const Device& device, const Triangles& triangles) const {
    PointsOnHost on_host = points.read(device);
    ViewOnHost host{std::move(on_host.position), {}, std::move(on_host.receiver)};
    cl::Buffer normals;
    camera_normals(device, triangles, *this, normals);
    host.normal.resize(host.position.size());
    session_of(device).read(normals.get(), host.normal.data(), host.normal.size() * sizeof(float));
    for (std::size_t i = 0; i < host.receiver.size(); ++i)
        if (host.receiver[i] == no_receiver) std::fill_n(&host.position[3 * i], 3, 0.0f);
    return host;
}

}  // namespace gnomon
