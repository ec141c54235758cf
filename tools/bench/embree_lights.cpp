// SPDX-License-Identifier: MIT
// Embree's way with many lights. Points are sorted by the side and main axis of their normal and then along a Morton
// curve, lights as the question orders them, and only pairs whose light is in front of the point get a ray. A tile of
// points belongs to one thread, so counts and bits are written without atomic operations.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "embree_rays.hpp"
#include "many_lights.hpp"
#include "peers.hpp"

namespace gnomon::bench {

namespace {

using namespace embree;

constexpr std::size_t tile_points = 256, sample_stride = 16;

enum class Way { points_by_16, lights_by_16, streams };
constexpr Way ways[] = {Way::points_by_16, Way::lights_by_16, Way::streams};
const char* name_of(Way way) {
    switch (way) {
        case Way::points_by_16:
            return "16-points-x-1-light";
        case Way::lights_by_16:
            return "1-point-x-16-lights";
        case Way::streams:
            return "streams-of-256";
    }
    return "";
}

std::vector<std::uint32_t> sorted_points(const LightsQuestion& question) {
    Float3 low{};
    float extent = 0;
    low.fill(std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < question.positions.size(); ++i)
        low[i % 3] = std::min(low[i % 3], question.positions[i]);
    for (std::size_t i = 0; i < question.positions.size(); ++i)
        extent = std::max(extent, question.positions[i] - low[i % 3]);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    for (std::size_t i = 0; i < question.count(); ++i) {
        const float *p = &question.positions[3 * i], *n = &question.normals[3 * i];
        if (question.shows_sky(i)) continue;
        std::uint64_t key = 0;
        std::size_t axis = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto step = static_cast<std::uint64_t>((p[c] - low[c]) / std::max(extent, 1e-30f) * 65535);
            for (unsigned bit = 0; bit < 16; ++bit) key |= (step >> bit & 1u) << (3 * bit + c);
            if (std::fabs(n[c]) > std::fabs(n[axis])) axis = c;
        }
        key |= std::uint64_t(2 * axis + (n[axis] < 0)) << 48;
        keys.emplace_back(key, static_cast<std::uint32_t>(i));
    }
    std::ranges::sort(keys);
    std::vector<std::uint32_t> order;
    for (const auto& [key, i] : keys) order.push_back(i);
    return order;
}

/// What all ways share.
struct Shared {
    Shared(const LightsQuestion& asked, unsigned wanted_threads)
        : question(asked),
          threads(wanted_threads != 0 ? wanted_threads : std::max(1u, std::thread::hardware_concurrency())),
          mesh(asked.scene.scene, threads),
          order(sorted_points(asked)),
          offset(asked.are_vertices() ? static_cast<float>(1e-6 * mesh.diagonal()) : 0.0f) {}

    std::size_t tiles() const { return (order.size() + tile_points - 1) / tile_points; }

    const LightsQuestion& question;
    unsigned threads;
    Mesh mesh;
    std::vector<std::uint32_t> order;
    float offset;
};

/// Rays that wait until there are enough of them. Adds each lit one to its point's count, or sets its bit.
template <typename Rays>
class Batch {
public:
    Batch(const Shared& shared, RTCScene scene, std::uint32_t* counts, std::uint32_t* bits)
        : shared_(shared), scene_(scene), counts_(counts), bits_(bits) {
        rtcInitIntersectContext(&context_);
        context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }

    void add(std::uint32_t point, std::uint32_t light) {
        const float* p = &shared_.question.positions[3 * std::size_t(point)];
        rays_.set(count_, p, shared_.question.lights.lights()[light].xyzw, shared_.offset);
        pairs_[count_++] = {point, light};
        if (count_ == Rays::width) flush();
    }
    void flush() {
        if (count_ == 0) return;
        rays_.trace(scene_, context_, count_);
        for (std::size_t i = 0; i < count_; ++i) {
            if (!rays_.is_lit(i)) continue;
            const auto [point, light] = pairs_[i];
            if (bits_ != nullptr)
                bits_[point * shared_.question.words() + light / 32] |= 1u << (light % 32);
            else
                ++counts_[point];
        }
        count_ = 0;
    }

private:
    const Shared& shared_;
    RTCScene scene_;
    std::uint32_t *counts_, *bits_;
    RTCIntersectContext context_{};
    Rays rays_{};
    std::array<std::array<std::uint32_t, 2>, Rays::width> pairs_{};
    std::size_t count_ = 0;
};

/// In lengths of the direction.
float end_of_ray(const std::array<float, 4>& light) {
    return light[3] != 0 ? 1.0f : std::numeric_limits<float>::infinity();
}

struct Packet {
    static constexpr std::size_t width = 16;
    alignas(64) RTCRay16 packet{};
    alignas(64) int valid[width]{};

    void set(std::size_t i, const float* p, const std::array<float, 4>& light, float offset) {
        packet.org_x[i] = p[0];
        packet.org_y[i] = p[1];
        packet.org_z[i] = p[2];
        const Float3 d = towards(p, light);
        packet.dir_x[i] = d[0];
        packet.dir_y[i] = d[1];
        packet.dir_z[i] = d[2];
        packet.tnear[i] = offset;
        packet.tfar[i] = end_of_ray(light);
        packet.mask[i] = ~0u;
    }
    void trace(RTCScene scene, RTCIntersectContext& context, std::size_t count) {
        for (std::size_t i = 0; i < width; ++i) valid[i] = i < count ? -1 : 0;
        rtcOccluded16(valid, scene, &context, &packet);
    }
    bool is_lit(std::size_t i) const { return packet.tfar[i] >= 0; }
};

struct Stream {
    static constexpr std::size_t width = stream_length;
    alignas(64) std::array<RTCRay, width> rays{};

    void set(std::size_t i, const float* p, const std::array<float, 4>& light, float offset) {
        RTCRay& ray = rays[i];
        ray.org_x = p[0];
        ray.org_y = p[1];
        ray.org_z = p[2];
        const Float3 d = towards(p, light);
        ray.dir_x = d[0];
        ray.dir_y = d[1];
        ray.dir_z = d[2];
        ray.tnear = offset;
        ray.tfar = end_of_ray(light);
        ray.mask = ~0u;
    }
    void trace(RTCScene scene, RTCIntersectContext& context, std::size_t count) {
        rtcOccluded1M(scene, &context, rays.data(), static_cast<unsigned>(count), sizeof(RTCRay));
    }
    bool is_lit(std::size_t i) const { return rays[i].tfar >= 0; }
};

class EmbreeLights : public LightsContestant {
public:
    EmbreeLights(const LightsQuestion& question, unsigned threads) : shared_(question, threads) { choose(); }

    std::vector<std::uint32_t> bits() override {
        std::vector<std::uint32_t> bits(shared_.question.count() * shared_.question.words());
        trace(tree_->get(), way_, 1, nullptr, bits.data());
        return bits;
    }
    RunTimes run() override {
        return time_run([&] {
            counts_.assign(shared_.question.count(), 0);
            trace(tree_->get(), way_, 1, counts_.data(), nullptr);
        });
    }
    std::vector<std::uint32_t> counts() const override { return counts_; }
    void describe(Row& row) const override {
        row.technique = "embree";
        row.driver = embree_version();
        row.settings = {{"quality", build_.quality},
                        {"rays", build_.rays},
                        {"shadow-rays", name_of(way_)},
                        {"threads", std::to_string(shared_.threads)}};
        row.mode = "static";
        row.device_memory_bytes = tree_->bytes();
    }

private:
    // On every sixteenth tile, by processor time, which other programs change least.
    void choose() {
        double least = std::numeric_limits<double>::infinity();
        counts_.assign(shared_.question.count(), 0);
        for (const Build& build : {medium, high}) {
            std::shared_ptr<Scene> tree = shared_.mesh.build(build);
            for (const Way way : ways)
                for (int i = 0; i < 2; ++i) {
                    const double ms =
                        time_run([&] { trace(tree->get(), way, sample_stride, counts_.data(), nullptr); }).processor_ms;
                    if (ms >= least) continue;
                    least = ms;
                    way_ = way;
                    build_ = build;
                    tree_ = tree;
                }
        }
    }

    void trace(RTCScene scene, Way way, std::size_t stride, std::uint32_t* counts, std::uint32_t* bits) const {
        const std::size_t tiles = (shared_.tiles() + stride - 1) / stride;
        for_each_tile(shared_.threads, tiles, [&](std::size_t tile) {
            const std::size_t first = tile * stride * tile_points;
            const std::size_t count = std::min(tile_points, shared_.order.size() - first);
            const std::span points = std::span(shared_.order).subspan(first, count);
            if (way == Way::streams)
                trace_tile<Stream>(scene, points, way, counts, bits);
            else
                trace_tile<Packet>(scene, points, way, counts, bits);
        });
    }

    template <typename Rays>
    void trace_tile(RTCScene scene, std::span<const std::uint32_t> points, Way way, std::uint32_t* counts,
                    std::uint32_t* bits) const {
        const LightsQuestion& question = shared_.question;
        Batch<Rays> batch(shared_, scene, counts, bits);
        const auto add = [&](std::uint32_t point, std::uint32_t light) {
            const std::size_t at = 3 * std::size_t(point);
            if (is_facing(&question.normals[at], &question.positions[at], question.lights.lights()[light].xyzw))
                batch.add(point, light);
        };
        if (way == Way::lights_by_16) {
            for (const std::uint32_t point : points)
                for (const std::uint32_t light : question.light_order) add(point, light);
        } else {
            for (const std::uint32_t light : question.light_order)
                for (const std::uint32_t point : points) add(point, light);
        }
        batch.flush();
    }

    Shared shared_;
    Build build_ = medium;
    Way way_ = Way::points_by_16;
    std::shared_ptr<Scene> tree_;
    std::vector<std::uint32_t> counts_;
};

}  // namespace

std::vector<std::unique_ptr<LightsContestant>> make_light_peers(const LightsQuestion& question, unsigned threads) {
    std::vector<std::unique_ptr<LightsContestant>> peers;
    peers.push_back(std::make_unique<EmbreeLights>(question, threads));
    return peers;
}

}  // namespace gnomon::bench
