// SPDX-License-Identifier: MIT
// Embree 3 as the rival: see peers.hpp for what is compared.
//
// What makes it fast, by measuring (Sponza's atrium, noon, 2K, two cores of an AMD EPYC with AVX2, processor time of
// one thread; the order is the same at 4K):
//   rays by tree         low 37 ms, medium 43, high 31: only `high` splits triangles. At 4K 117, 145, 100.
//   shadow rays by shape packets of 16 30.8 ms, of 8 31.9, streams of 256 30.9; of the low tree 36.7, 37.1, 35.0
//   primary rays         packets of 16 107 ms, of 8 103, streams of 256 87
//   low build            indexed vertices 9.3 ms, three of its own for each triangle 12.2; a scene that is kept and
//                        built again 9.5; the flag `dynamic` 8.9
// Without effect: denormals as zeros, -march=native, an atomic counter per 32 x 32 pixels or per 1024 rays.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <thread>

#include "embree_rays.hpp"
#include "embree_scene.hpp"
#include "peers.hpp"

namespace gnomon::bench {

namespace {

using namespace embree;
using Double3 = std::array<double, 3>;

// How far own shading points stand off their triangle, of the scene's diagonal: a usual choice.
constexpr double lift = 1e-5;

Double3 difference(std::span<const float> a, std::span<const float> b) {
    return {double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]};
}
Double3 cross(const Double3& a, const Double3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Double3& a, const Double3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Double3 normal_of(std::span<const float> triangles, std::uint32_t triangle) {
    const auto vertex = [&](std::size_t k) { return triangles.subspan(9 * std::size_t(triangle) + 3 * k, 3); };
    return cross(difference(vertex(1), vertex(0)), difference(vertex(2), vertex(0)));
}

// In double: good enough to spare the rival rays that gnomon does not trace either.
bool faces_light(const Seen& seen, std::span<const float> triangles, std::uint32_t receiver) {
    const Double3 normal = normal_of(triangles, receiver);
    const std::span<const float> vertex = triangles.subspan(9 * std::size_t(receiver), 3);
    const std::span<const float> light = std::span(seen.c.light.xyzw).first(3);
    const Double3 to_light =
        seen.c.light.is_directional() ? Double3{light[0], light[1], light[2]} : difference(light, vertex);
    return dot(normal, to_light) * dot(normal, difference(seen.c.camera.eye, vertex)) > 0;
}

unsigned thread_count(unsigned threads) {
    return threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
}

std::vector<std::uint8_t> srgb_table() {
    std::vector<std::uint8_t> table(4096);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double linear = double(i) / double(table.size() - 1);
        const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
        table[i] = static_cast<std::uint8_t>(encoded * 255 + 0.5);
    }
    return table;
}

std::string text_of(double offset) {
    char text[16];
    std::snprintf(text, sizeof(text), "%g", offset);
    return text;
}

/// What all of a view's contestants share. Their runs follow each other, so the buffers are shared too.
struct Shared {
    Shared(const PeerTask& task);

    std::shared_ptr<const Scene> tree(const Build& build, std::vector<double>& build_ms);

    const Place& place;
    const Seen& seen;
    std::uint32_t samples;
    unsigned threads;
    Mesh mesh;
    CameraRays camera;
    std::size_t pixels;
    RayPoints points;                ///< gnomon's own that face the light, tile by tile; of one sample
    Hits hits;                       ///< of one sample: tile by tile; of several: of each pixel's first
    std::vector<std::uint8_t> srgb;  ///< of linear light in [0, 1]

private:
    // The tree that was last asked for, which some contestants in a row share.
    Build kept_build_ = low;
    std::shared_ptr<const Scene> kept_;
    std::vector<double> kept_ms_;
};

Shared::Shared(const PeerTask& task)
    : place(task.place),
      seen(task.seen),
      samples(task.samples),
      threads(thread_count(task.threads)),
      mesh(place.scene.scene, threads),
      camera(seen.c.camera, seen.row.width, seen.row.height, samples, seen.c.light, mesh,
             static_cast<float>(lift * mesh.diagonal())),
      pixels(std::size_t(seen.row.width) * seen.row.height),
      hits(samples == 1 ? camera.tiles() * tile_rays : pixels),
      srgb(srgb_table()) {
    if (samples != 1) return;
    for (std::size_t tile = 0; tile < camera.tiles(); ++tile) {
        const auto pixel_of = camera.pixels_of(tile);
        for (std::size_t ray = 0; ray < tile_rays; ++ray) {
            const std::size_t pixel = pixel_of(ray);
            if (pixel == CameraRays::no_pixel) continue;
            const std::uint32_t receiver = seen.host.receiver[pixel];
            if (receiver == no_receiver || !faces_light(seen, place.scene.scene.triangles, receiver)) continue;
            const float* p = &seen.host.position[3 * pixel];
            points.append(p[0], p[1], p[2], pixel);
        }
    }
    points.fill_up();
}

std::shared_ptr<const Scene> Shared::tree(const Build& build, std::vector<double>& build_ms) {
    if (kept_ == nullptr || !(kept_build_ == build)) {
        kept_.reset();
        kept_ms_.clear();
        for (int i = 0; i < 3 && (i == 0 || kept_ms_.back() < long_run_ms / 3); ++i)
            kept_ms_.push_back(time_ms([&] { kept_ = mesh.build(build); }));
        kept_build_ = build;
    }
    build_ms = kept_ms_;
    return kept_;
}

// The settings that are known before the shapes are chosen.
Row row_of(const Shared& shared, const Build& build, double offset, bool is_animated) {
    Row row = shared.seen.row;
    row.technique = "embree";
    row.settings = {{"build", build.quality}, {"rays", build.rays}};
    if (shared.samples == 1) row.settings.emplace_back("offset", text_of(offset));
    row.mode = is_animated ? "animated" : "static";
    row.device = "CPU";
    row.driver = embree_version();
    row.camera.reset();
    return row;
}

/// One tree, one offset.
class EmbreeContestant : public Contestant {
public:
    EmbreeContestant(std::shared_ptr<Shared> shared, const Build& build, double offset, bool is_animated,
                     bool has_frames)
        : Contestant(row_of(*shared, build, offset, is_animated), has_frames || shared->samples != 1),
          shared_(std::move(shared)),
          build_(build),
          is_animated_(is_animated),
          shadow_rays_{shared_->seen.c.light.xyzw, static_cast<float>(offset * shared_->mesh.diagonal())},
          lit_(shared_->pixels),
          mean_(shared_->pixels),
          picture_(4 * shared_->pixels) {}

    std::uint32_t samples() const override { return shared_->samples; }

private:
    void get_ready() override;
    FrameTimes run() override;
    std::vector<float> describe(Row& row) override;
    void free_memory() override {
        tree_.reset();
        shared_.reset();
    }

    /// A triangle as shading sees it.
    struct Surface {
        std::uint32_t triangle;
        Float3 normal;  ///< unit, on the eye's side
        float ambient;
        Float3 base;
    };

    void trace_camera();
    void trace_shadows();
    void trace_samples(FrameTimes& times, std::size_t every);
    void trace_samples_of(std::size_t tile, std::array<std::atomic<double>, 2>& ms);
    void shade_tile(std::size_t tile);
    Surface surface_of(std::uint32_t triangle) const;
    template <typename Work>
    void choose(Shape& shape, Work&& work);
    std::uint64_t other_triangles() const;

    std::shared_ptr<Shared> shared_;
    Build build_;
    bool is_animated_;
    ShadowRays shadow_rays_;
    Shape camera_shape_ = Shape::streams_of_256, shadow_shape_ = Shape::packets_of_16;
    std::shared_ptr<const Scene> tree_;
    std::vector<double> build_ms_;
    std::vector<std::uint8_t> lit_;  ///< per pixel whose point has a shadow ray
    std::vector<float> mean_;        ///< of several samples
    std::vector<std::uint8_t> picture_;
};

void EmbreeContestant::trace_camera() {
    for_each_tile(shared_->threads, shared_->camera.tiles(), [&](std::size_t tile) {
        shared_->camera.trace(camera_shape_, tree_->get(), tile, shared_->hits, tile * tile_rays);
    });
}

void EmbreeContestant::trace_shadows() {
    const RayPoints& points = shared_->points;
    for_each_tile(shared_->threads, (points.count() + tile_rays - 1) / tile_rays, [&](std::size_t chunk) {
        const std::size_t first = chunk * tile_rays, count = std::min(tile_rays, points.count() - first);
        shadow_rays_.trace(shadow_shape_, tree_->get(), points, first, count, lit_.data());
    });
}

// ms: of the camera's rays and of the shadows'.
void EmbreeContestant::trace_samples_of(std::size_t tile, std::array<std::atomic<double>, 2>& ms) {
    thread_local Hits hits(tile_rays);
    thread_local RayPoints points;
    thread_local std::array<std::uint8_t, tile_rays> lit;
    const Clock camera;
    shared_->camera.trace(camera_shape_, tree_->get(), tile, hits, 0);
    ms[0] += camera.elapsed_ms();
    const Clock shadow;
    points.clear();
    for (std::size_t ray = 0; ray < tile_rays; ++ray) {
        lit[ray] = hits.triangle[ray] == no_receiver;
        if (hits.faces_light[ray] != 0) points.append(hits.x[ray], hits.y[ray], hits.z[ray], ray);
    }
    points.fill_up();
    shadow_rays_.trace(shadow_shape_, tree_->get(), points, 0, points.count(), lit.data());
    const auto pixel_of = shared_->camera.pixels_of(tile);
    for (std::size_t first = 0; first < tile_rays; first += shared_->samples) {
        const std::size_t pixel = pixel_of(first);
        if (pixel == CameraRays::no_pixel) continue;
        unsigned sum = 0;
        for (std::size_t ray = first; ray < first + shared_->samples; ++ray) sum += lit[ray];
        mean_[pixel] = float(sum) / float(shared_->samples);
        shared_->hits.triangle[pixel] = hits.triangle[first];
        shared_->hits.faces_light[pixel] = hits.faces_light[first];
        shared_->hits.x[pixel] = hits.x[first];
        shared_->hits.y[pixel] = hits.y[first];
        shared_->hits.z[pixel] = hits.z[first];
    }
    ms[1] += shadow.elapsed_ms();
}

// Of each so many tiles one.
void EmbreeContestant::trace_samples(FrameTimes& times, std::size_t every) {
    std::array<std::atomic<double>, 2> ms{};
    const RunTimes both = time_run([&] {
        for_each_tile(shared_->threads, (shared_->camera.tiles() + every - 1) / every,
                      [&](std::size_t i) { trace_samples_of(i * every, ms); });
    });
    const double share = ms[0] / (ms[0] + ms[1]);
    times.camera = {both.wall_ms * share, both.processor_ms * share};
    times.shadow = {both.wall_ms * (1 - share), both.processor_ms * (1 - share)};
}

// gnomon's own shading (kernels/shading/shade.cl), with the same ambient light and sky.
EmbreeContestant::Surface EmbreeContestant::surface_of(std::uint32_t triangle) const {
    const scene::Scene& scene = shared_->place.scene.scene;
    const float* v = &scene.triangles[9 * std::size_t(triangle)];
    const float a[] = {v[3] - v[0], v[4] - v[1], v[5] - v[2]}, b[] = {v[6] - v[0], v[7] - v[1], v[8] - v[2]};
    Float3 n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const Float3& eye = shared_->seen.c.camera.eye;
    const float side = n[0] * (eye[0] - v[0]) + n[1] * (eye[1] - v[1]) + n[2] * (eye[2] - v[2]);
    const float scale = std::copysign(1 / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), side);
    for (float& c : n) c *= scale;
    return {triangle, n, 0.25f * (1 + 0.35f * n[1] + 0.15f * n[0]),
            scene.materials.base_color[scene.materials.triangle_material[triangle]]};
}

// Neighbours often share their triangle.
void EmbreeContestant::shade_tile(std::size_t tile) {
    const Hits& hits = shared_->hits;
    const auto& light = shadow_rays_.light;
    const auto pixel_of = shared_->camera.pixels_of(tile);
    const bool is_one = shared_->samples == 1;
    Surface surface{no_receiver, {}, 0, {}};
    for (std::size_t ray = 0; ray < tile_rays; ray += shared_->samples) {
        const std::size_t pixel = pixel_of(ray);
        if (pixel == CameraRays::no_pixel) continue;
        const std::size_t hit = is_one ? tile * tile_rays + ray : pixel;
        const std::uint32_t triangle = hits.triangle[hit];
        Float3 color{0.46f, 0.62f, 0.86f};
        if (triangle != no_receiver) {
            if (triangle != surface.triangle) surface = surface_of(triangle);
            const auto& [_, n, ambient, base] = surface;
            float sum = ambient;
            if (const float visibility = is_one ? float(lit_[pixel]) : mean_[pixel];
                visibility != 0 && hits.faces_light[hit] != 0) {
                const float x = light[0] - light[3] * hits.x[hit], y = light[1] - light[3] * hits.y[hit],
                            z = light[2] - light[3] * hits.z[hit];
                sum += 0.75f * visibility * (n[0] * x + n[1] * y + n[2] * z) / std::sqrt(x * x + y * y + z * z);
            }
            for (std::size_t c = 0; c < 3; ++c) color[c] = base[c] * sum;
        }
        for (std::size_t c = 0; c < 3; ++c)
            picture_[4 * pixel + c] =
                shared_->srgb[static_cast<std::size_t>(std::clamp(color[c], 0.0f, 1.0f) * 4095 + 0.5f)];
        picture_[4 * pixel + 3] = 255;
    }
}

// By processor time, which other programs change least.
template <typename Work>
void EmbreeContestant::choose(Shape& shape, Work&& work) {
    double least = std::numeric_limits<double>::infinity();
    Shape best = shape;
    for (const Shape candidate : shapes) {
        shape = candidate;
        for (int i = 0; i < 3; ++i)
            if (const double ms = time_run(work).processor_ms; ms < least) {
                least = ms;
                best = candidate;
            }
    }
    shape = best;
}

void EmbreeContestant::get_ready() {
    tree_ = shared_->tree(build_, build_ms_);
    if (shared_->samples != 1) {
        FrameTimes times;
        const auto some = [&] { trace_samples(times, shared_->samples); };
        choose(camera_shape_, some);
        choose(shadow_shape_, some);
        return;
    }
    if (has_frames()) choose(camera_shape_, [&] { trace_camera(); });
    choose(shadow_shape_, [&] { trace_shadows(); });
}

FrameTimes EmbreeContestant::run() {
    FrameTimes times;
    if (is_animated_)
        times.build = time_run([&] {
            tree_.reset();
            tree_ = shared_->mesh.build(build_);
        });
    if (shared_->samples != 1) {
        trace_samples(times, 1);
    } else {
        if (has_frames()) times.camera = time_run([&] { trace_camera(); });
        times.shadow = time_run([&] { trace_shadows(); });
    }
    if (has_frames())
        times.shade = time_run([&] {
            for_each_tile(shared_->threads, shared_->camera.tiles(), [&](std::size_t tile) { shade_tile(tile); });
        });
    return times;
}

// Pixels whose triangle is another one than gnomon's.
std::uint64_t EmbreeContestant::other_triangles() const {
    std::uint64_t count = 0;
    for (std::size_t tile = 0; tile < shared_->camera.tiles(); ++tile) {
        const auto pixel_of = shared_->camera.pixels_of(tile);
        for (std::size_t ray = 0; ray < tile_rays; ++ray)
            if (const std::size_t pixel = pixel_of(ray); pixel != CameraRays::no_pixel)
                count += shared_->hits.triangle[tile * tile_rays + ray] != shared_->seen.host.receiver[pixel];
    }
    return count;
}

// Points without a ray: sky is lit, what faces away is in shadow.
std::vector<float> EmbreeContestant::describe(Row& row) {
    if (has_frames()) row.settings.emplace_back("camera-rays", name_of(camera_shape_));
    row.settings.emplace_back("shadow-rays", name_of(shadow_shape_));
    row.settings.emplace_back("threads", std::to_string(shared_->threads));
    if (shared_->samples != 1) row.settings.push_back(samples_setting(shared_->samples));
    row.build = times_of(build_ms_);
    row.device_memory_bytes = tree_->bytes();
    if (shared_->samples != 1) return mean_;
    std::vector<float> mask(shared_->pixels);
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
        mask[pixel] = shared_->seen.host.receiver[pixel] == no_receiver ? 1.0f : 0.0f;
    for (const std::uint32_t pixel : shared_->points.index) mask[pixel] = lit_[pixel];
    if (has_frames()) {
        trace_camera();  // others have overwritten the hits
        row.counts = {{"points", mask.size()}, {"points_on_other_triangles", other_triangles()}};
    }
    return mask;
}

constexpr double offsets[] = {0, 1e-6, 1e-4};

}  // namespace

std::string embree_version() { return RTC_VERSION_STRING; }

std::vector<Peer> make_peers(const PeerTask& task) {
    const auto shared = std::make_shared<Shared>(task);
    std::vector<Peer> peers;
    const auto add = [&](const Build& build, double offset, bool is_animated, bool takes_turns) {
        peers.push_back(
            {std::make_unique<EmbreeContestant>(shared, build, offset, is_animated, takes_turns), takes_turns});
    };
    add(low, 0, true, true);
    add(medium, 0, false, true);
    add(high, 0, false, true);
    if (task.samples != 1 || !task.has_errors) return peers;
    for (const Build& build : {low, low_robust, medium, medium_robust, high}) {
        if (build == low_robust) add(build, 0, true, false);
        for (const double offset : offsets)
            if (offset != 0 || !(build == medium || build == high)) add(build, offset, false, false);
    }
    return peers;
}

}  // namespace gnomon::bench
