// SPDX-License-Identifier: MIT
// run_settled_samples(), at the end, reads top to bottom; the stages above are in its order.
#include "samples/settled_samples.hpp"

#include <algorithm>

#include "api/statistics.hpp"
#include "kernels/camera/camera.h"
#include "kernels/lists/append.h"
#include "kernels/receivers/footprint.h"

namespace gnomon {

class SampleBuffers {
public:
    explicit SampleBuffers(const Device& theirs) : device(theirs), camera(theirs) {}

    Device device;  ///< lives as long as the buffers
    CameraStage camera;
    cl::Buffer pattern, counters, rays;
    cl::Buffer edges, sought, seen, extra_pixels, receivers, masks, lit, mixed;  ///< of a batch of pixels
    cl::Buffer centres, footprints, answers;                                     ///< of its pieces
    cl::Buffer places, sample_receivers, positions, visibility;                  ///< of samples that are traced
    std::size_t extra_expected = 0;
    std::uint64_t bytes_of_runs = 0;       ///< what runs left on the device, here and in the technique
    std::uint64_t bytes_of_technique = 0;  ///< of these, in the technique
};

namespace {

SampleBuffers& buffers_of(SettlesFootprints& settling, const Device& device) {
    if (settling.sample_buffers == nullptr) settling.sample_buffers = std::make_unique<SampleBuffers>(device);
    return *settling.sample_buffers;
}

Float4 float4_of_eye(const Camera& camera) { return {camera.eye[0], camera.eye[1], camera.eye[2], 0.0f}; }

class SettledSamples {
public:
    SettledSamples(SettlesFootprints& settling, const Device& device, const Triangles& triangles, const View& view,
                   const Light& light, std::span<const SampleOffset> offsets, const Visibility& mean,
                   std::size_t points_at_once)
        : settling_(settling),
          device_(device),
          session_(device.session()),
          triangles_(triangles),
          inputs_(triangle_inputs(triangles)),
          view_(view),
          light_(light),
          mean_(mean),
          points_at_once_(std::max<std::size_t>(points_at_once, pixels_of_bands(1) * offsets.size())),
          camera_(view.points.camera()->camera),
          eye_(float4_of_eye(camera_)),
          pattern_(pattern_of(offsets)),
          kept_(buffers_of(settling, device)),
          memory_(session_, kept_.bytes_of_runs) {
        kept_.camera.aim(triangles, camera_, view.width, view.height);
        kept_.pattern.reserve(session_, sizeof(SamplePattern));
        kept_.counters.reserve(session_, sizeof(SampleCounters));
        session_.write(kept_.pattern.get(), &pattern_, sizeof(pattern_));
        make_rays();
    }

    Statistics run() {
        Statistics camera;
        kept_.camera.fit_lists(camera);
        add_stages(total_, camera);
        const std::uint32_t bands = kept_.camera.tiles_y();
        std::uint32_t at_once =
            static_cast<std::uint32_t>(std::clamp<std::size_t>(points_at_once_ / 2 / pixels_of_bands(1), 1, bands));
        for (std::uint32_t first = 0; first < bands;) {
            set_batch(first, std::min(at_once, bands - first));
            if (!make_pieces()) {
                // More receivers in a pixel than expected: room for them, or fewer pixels at a time.
                kept_.extra_expected = counted_.extra + counted_.extra / 4;
                if (batch_.count + kept_.extra_expected > points_at_once_) at_once = std::max(batch_.bands / 2, 1u);
                continue;
            }
            bound();
            settle();
            sort();
            trace_mixed();
            write_mean();
            first += batch_.bands;
        }
        add_counts();
        return std::move(total_);
    }

    std::uint64_t device_memory_bytes() const {
        return memory_.peak_bytes() - kept_.bytes_of_technique + technique_memory_bytes_;
    }

private:
    void make_rays() {
        const std::size_t entries = std::size_t(pattern_.count) * (view_.width + view_.height);
        kept_.rays.reserve(session_, entries * RAY_FLOATS * sizeof(float));
        cl::StageTimer timer(session_, total_, "samples_rays");
        session_.launch("samples/samples.cl", "samples_rays", cl::Range::items(entries),
                        ray_axes(camera_, view_.width, view_.height), kept_.pattern, view_.width, view_.height,
                        kept_.rays);
    }

    /// Work-groups of samples_pieces, each of which may leave some of the places that it claims unused.
    cl::Range pieces_range(std::size_t edges) const {
        cl::Range range = session_.small_groups();
        range.count = std::min(range.count, edges);
        return range;
    }

    /// What work-items may claim of a list and not use.
    std::size_t unused_places() const {
        return session_.is_cpu() ? session_.many_groups() * session_.work_group_size() * APPEND_BLOCK_ON_CPU : 0;
    }

    std::size_t pixels_of_bands(std::uint32_t bands) const {
        return std::size_t(view_.width) * std::min(bands << CAMERA_TILE_LOG2, view_.height);
    }

    void set_batch(std::uint32_t first_band, std::uint32_t bands) {
        const std::size_t first = pixels_of_bands(first_band), count = pixels_of_bands(first_band + bands) - first;
        const std::size_t extra = std::min(std::max(kept_.extra_expected, count / 2 + 64), points_at_once_);
        const std::size_t unused = session_.is_cpu() ? 2 * unused_places() : pieces_range(count).count * PIECES_CLAIM;
        extra_capacity_ = static_cast<cl_uint>(extra + unused);
        const std::size_t most_pieces = count + extra_capacity_;
        batch_ = {cl_uint(first),         cl_uint(count), view_.width,         view_.height,
                  kept_.camera.tiles_x(), bands,          cl_uint(most_pieces)};
        for (cl::Buffer* buffer : {&kept_.edges, &kept_.sought})
            buffer->reserve(session_, (count + unused_places()) * sizeof(cl_uint));
        kept_.lit.reserve(session_, count * sizeof(cl_uint));
        kept_.extra_pixels.reserve(session_, extra_capacity_ * sizeof(cl_uint));
        for (cl::Buffer* buffer : {&kept_.receivers, &kept_.masks})
            buffer->reserve(session_, most_pieces * sizeof(cl_uint));
        kept_.centres.reserve(session_, 3 * most_pieces * sizeof(float));
        kept_.footprints.reserve(session_, FOOTPRINT_FLOATS * most_pieces * sizeof(float));
        session_.fill(kept_.counters, 0, sizeof(SampleCounters));
        counted_ = {};
    }

    void read_counters() { counted_ = session_.read_value<SampleCounters>(kept_.counters); }

    /// False if there are more pieces than places.
    bool make_pieces() {
        const std::size_t count = batch_.count;
        {
            cl::StageTimer timer(session_, total_, "samples_whole");
            session_.launch("samples/samples.cl", "samples_whole", cl::Range::items(count / session_.lanes() + 1),
                            kept_.camera.picture(), kept_.pattern, batch_, eye_, inputs_.first_float, inputs_.vertices,
                            view_.points.receivers(), kept_.camera.bins().ranges(), kept_.receivers, kept_.masks,
                            kept_.lit, kept_.edges, kept_.centres, kept_.footprints, kept_.counters);
        }
        read_counters();
        guess();
        read_counters();
        if (session_.is_cpu())
            seek_in_parts();
        else
            seek_by_groups();
        read_counters();
        return counted_.extra <= extra_capacity_;
    }

    /// The receivers of edge pixels' samples. Where they cannot be guessed, they are sought.
    void guess() {
        cl::StageTimer timer(session_, total_, "samples_guess");
        session_.launch("samples/samples.cl", "samples_guess", cl::Range::items(counted_.edges / session_.lanes() + 1),
                        kept_.camera.projection(), kept_.camera.picture(), kept_.pattern, batch_, counted_.edges,
                        extra_capacity_, inputs_.first_float, inputs_.vertices, kept_.rays,
                        kept_.camera.setup().records(), kept_.camera.setup().bounds(), kept_.camera.bins().ranges(),
                        kept_.camera.bins().entries(), view_.points.receivers(), kept_.edges, kept_.sought,
                        kept_.extra_pixels, kept_.receivers, kept_.masks, kept_.lit, kept_.counters);
    }

    void seek_by_groups() {
        if (counted_.sought == 0) return;
        cl::StageTimer timer(session_, total_, "samples_seek");
        session_.launch("samples/samples.cl", "samples_pieces", pieces_range(counted_.sought),
                        kept_.camera.projection(), kept_.camera.picture(), kept_.pattern, batch_, counted_.sought,
                        extra_capacity_, inputs_.first_float, inputs_.vertices, kept_.rays,
                        kept_.camera.setup().records(), kept_.camera.setup().bounds(), kept_.camera.bins().ranges(),
                        kept_.camera.bins().entries(), view_.points.receivers(), kept_.sought, kept_.extra_pixels,
                        kept_.receivers, kept_.masks, kept_.lit, kept_.counters);
    }

    void seek_in_parts() {
        const std::size_t part = points_at_once_ / pattern_.count;
        // For all edges: in how many receivers are sought depends on threads, and the memory of a run must not.
        kept_.seen.reserve(
            session_, std::min<std::size_t>(part, counted_.edges + unused_places()) * pattern_.count * sizeof(cl_uint));
        for (std::size_t first = 0; first < counted_.sought; first += part)
            seek(static_cast<cl_uint>(first), static_cast<cl_uint>(std::min(part, counted_.sought - first)));
    }

    void seek(cl_uint first, cl_uint count) {
        cl::StageTimer timer(session_, total_, "samples_seek");
        session_.launch("samples/samples.cl", "samples_seek", cl::Range::items(std::size_t(count) * pattern_.count),
                        kept_.camera.projection(), kept_.camera.picture(), kept_.pattern, batch_, first, count,
                        inputs_.first_float, inputs_.vertices, kept_.rays, kept_.camera.setup().records(),
                        kept_.camera.setup().bounds(), kept_.camera.bins().ranges(), kept_.camera.bins().entries(),
                        view_.points.receivers(), kept_.sought, kept_.seen);
        session_.launch("samples/samples.cl", "samples_group", cl::Range::items(count), kept_.pattern, batch_, first,
                        count, extra_capacity_, view_.points.receivers(), kept_.sought, kept_.seen, kept_.extra_pixels,
                        kept_.receivers, kept_.masks, kept_.lit, kept_.counters);
    }

    void bound() {
        const std::size_t count = std::size_t(counted_.edges) + counted_.extra;
        cl::StageTimer timer(session_, total_, "samples_bound");
        session_.launch("samples/samples.cl", "samples_bound", cl::Range::items(count / session_.lanes() + 1),
                        kept_.camera.picture(), kept_.pattern, batch_, counted_.edges, counted_.extra, eye_,
                        inputs_.first_float, inputs_.vertices, kept_.edges, kept_.extra_pixels, kept_.receivers,
                        kept_.masks, kept_.centres, kept_.footprints);
    }

    std::size_t piece_count() const { return std::size_t(batch_.count) + counted_.extra; }

    void settle() {
        const std::size_t count = piece_count();
        // For all that there may be: in how many places the pieces lie depends on threads (see seek_in_parts()).
        kept_.answers.reserve(session_, batch_.places * sizeof(float));
        Points centres =
            Points::wrap(device_, kept_.centres.get(), {0, 1, batch_.places}, count, kept_.receivers.get());
        centres.set_eye(camera_.eye);
        const Visibility answers(device_, kept_.answers.get(), count);
        add_run([&] { return settling_.settle(triangles_, centres, kept_.footprints, light_, answers); });
    }

    void sort() {
        const std::size_t count = piece_count();
        kept_.mixed.reserve(session_, (batch_.places + unused_places()) * sizeof(cl_uint));
        {
            cl::StageTimer timer(session_, total_, "samples_sort");
            session_.launch("samples/samples.cl", "samples_sort", cl::Range::items(count), batch_, cl_uint(count),
                            kept_.extra_pixels, kept_.masks, kept_.answers, kept_.lit, kept_.mixed, kept_.counters);
        }
        read_counters();
        sum_.edges += batch_.count - counted_.whole;
        sum_.whole += counted_.whole;
        sum_.pieces += counted_.pieces;
        sum_.mixed_pieces += counted_.mixed_pieces;
        sum_.mixed_samples += counted_.mixed_samples;
        sum_.in_shadow += counted_.in_shadow;
        sum_.lit += counted_.lit;
    }

    void trace_mixed() {
        // All at once where that is known to fit, else pieces of as many samples as there may be.
        const std::size_t part =
            counted_.mixed_samples <= points_at_once_ ? counted_.mixed : points_at_once_ / pattern_.count;
        for (std::size_t first = 0; first < counted_.mixed; first += part)
            trace_part(static_cast<cl_uint>(first), static_cast<cl_uint>(std::min(part, counted_.mixed - first)));
    }

    void trace_part(cl_uint first, cl_uint count) {
        const std::size_t most = std::min<std::size_t>(counted_.mixed_samples, points_at_once_);
        const std::size_t points = make_points(first, count, most);
        if (points == 0) return;
        Points samples =
            Points::wrap(device_, kept_.positions.get(), {0, 1, most}, points, kept_.sample_receivers.get());
        samples.set_eye(camera_.eye);
        const Visibility visibility(device_, kept_.visibility.get(), points);
        add_run([&] { return settling_.trace_mixed(triangles_, samples, light_, visibility); });
        cl::StageTimer timer(session_, total_, "samples_mean");
        session_.launch("samples/samples.cl", "samples_count", cl::Range::items(points), cl_uint(points), kept_.places,
                        kept_.visibility, kept_.lit);
    }

    /// Of the samples of mixed pieces, with room for `most`. Returns how many there are.
    std::size_t make_points(cl_uint first, cl_uint count, std::size_t most) {
        kept_.places.reserve(session_, most * 2 * sizeof(cl_uint));
        kept_.sample_receivers.reserve(session_, most * sizeof(cl_uint));
        kept_.positions.reserve(session_, 3 * most * sizeof(float));
        kept_.visibility.reserve(session_, most * sizeof(float));
        const std::size_t items = session_.is_cpu() ? count : std::size_t(count) * PARTS_OF_PIECES;
        cl::StageTimer timer(session_, total_, "samples_points");
        session_.fill(kept_.counters, 0, sizeof(SampleCounters));
        session_.launch("samples/samples.cl", "samples_points", cl::Range::items(items), batch_, pattern_.count, first,
                        count, cl_uint(most), eye_, inputs_.first_float, inputs_.vertices, kept_.rays,
                        kept_.extra_pixels, kept_.receivers, kept_.masks, kept_.mixed, kept_.places,
                        kept_.sample_receivers, kept_.positions, kept_.visibility, kept_.counters);
        if (count == counted_.mixed) return counted_.mixed_samples;
        return session_.read_value<SampleCounters>(kept_.counters).placed;
    }

    void write_mean() {
        cl::StageTimer timer(session_, total_, "samples_mean");
        session_.launch("samples/samples.cl", "samples_mean_of_sums", cl::Range::items(batch_.count), batch_,
                        1.0f / static_cast<float>(pattern_.count), kept_.lit, mean_.buffer());
    }

    template <typename Run>
    void add_run(Run&& run_technique) {
        const cl::RunMemory memory(session_, kept_.bytes_of_technique);
        const Statistics run = run_technique();
        add_stages(total_, run);
        technique_memory_bytes_ = std::max(technique_memory_bytes_, run.device_memory_bytes);
    }

    void add_counts() {
        total_.counts = {{"points", view_.points.count() * pattern_.count},
                         {"pixels_on_one_receiver", sum_.whole},
                         {"pixels_on_several", sum_.edges},
                         {"pieces", sum_.pieces},
                         {"pieces_mixed", sum_.mixed_pieces},
                         {"samples_settled_in_shadow", sum_.in_shadow},
                         {"samples_settled_lit", sum_.lit},
                         {"samples_traced", sum_.mixed_samples}};
    }

    SettlesFootprints& settling_;
    const Device& device_;
    cl::Session& session_;
    const Triangles& triangles_;
    TriangleInputs inputs_;
    const View& view_;
    const Light& light_;
    const Visibility& mean_;
    std::size_t points_at_once_;
    Camera camera_;
    Float4 eye_;
    SamplePattern pattern_;
    SampleBuffers& kept_;
    const cl::RunMemory memory_;
    PixelBatch batch_{};
    SampleCounters counted_{};
    struct {
        std::uint64_t edges, whole, pieces, mixed_pieces, mixed_samples, in_shadow, lit;
    } sum_{};
    Statistics total_;
    std::uint64_t technique_memory_bytes_ = 0;
    cl_uint extra_capacity_ = 0;
};

}  // namespace

SettlesFootprints::SettlesFootprints() = default;
SettlesFootprints::~SettlesFootprints() = default;

SamplePattern pattern_of(std::span<const SampleOffset> offsets) {
    SamplePattern pattern{};
    pattern.count = static_cast<cl_uint>(offsets.size());
    pattern.all = pattern.count == MOST_SAMPLES ? 0xFFFFFFFFu : (1u << pattern.count) - 1;
    for (int c = 0; c < 2; ++c) {
        pattern.low[c] = 1.0f;
        pattern.high[c] = 0.0f;
    }
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const float place[2] = {0.5f + static_cast<float>(offsets[i].x) / SAMPLE_UNITS,
                                0.5f + static_cast<float>(offsets[i].y) / SAMPLE_UNITS};
        for (std::size_t c = 0; c < 2; ++c) {
            (c == 0 ? pattern.place_x : pattern.place_y)[i] = place[c];
            pattern.low[c] = std::min(pattern.low[c], place[c]);
            pattern.high[c] = std::max(pattern.high[c], place[c]);
        }
    }
    return pattern;
}

Statistics run_settled_samples(SettlesFootprints& settling, const Device& device, const Triangles& triangles,
                               const View& view, const Light& light, std::span<const SampleOffset> offsets,
                               const Visibility& mean, std::size_t points_at_once) {
    SettledSamples samples(settling, device, triangles, view, light, offsets, mean, points_at_once);
    Statistics total = samples.run();
    total.device_memory_bytes = samples.device_memory_bytes();
    return total;
}

}  // namespace gnomon
