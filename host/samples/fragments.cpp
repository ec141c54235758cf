// SPDX-License-Identifier: MIT
// FragmentRun::run() names the stages; their functions follow in its order.
#include "samples/samples.hpp"

#include <algorithm>

#include "kernels/lists/append.h"
#include "kernels/receivers/footprint.h"
#include "query/statistics.hpp"

namespace gnomon {
namespace {

struct FragmentBuffers {
    explicit FragmentBuffers(const Device& theirs) : device(theirs), camera(theirs) {}

    Device device;  ///< lives as long as the buffers
    CameraStage camera;
    cl::Buffer pattern, counters, rays;
    cl::Buffer edges;             ///< edge pixels of a batch, then the unproven ones (PixelBatch::edge_slots)
    cl::Buffer open;              ///< on a GPU: open pairs of samples, and their pixels (samples_filter.cl)
    cl::Buffer slots;             ///< of the triangles' records in the camera's lists
    cl::Buffer fragments, mixed;  ///< of a batch (fragments.clh), and the slots of its mixed fragments
    cl::Buffer squares;           ///< mixed squares of pixels
    cl::Buffer centres, footprints, classes;                           ///< of its fragments
    cl::Buffer point_samples, point_receivers, positions, visibility;  ///< of samples that are traced
    std::size_t extra_expected = 0;
    std::uint64_t bytes_of_runs = 0;       ///< on the device after the last run, here and in the technique
    std::uint64_t bytes_of_technique = 0;  ///< the technique's part of these
};

class FragmentRun {
public:
    FragmentRun(FootprintSession& session, FragmentBuffers& buffers, const SampledView& in)
        : footprint_session_(session),
          in_(in),
          view_(in.view),
          session_(session_of(in.device)),
          inputs_(triangle_inputs(in.triangles)),
          points_at_once_(std::max<std::size_t>(in.points_at_once, slots_of_bands(1) * in.pattern.size())),
          camera_(view_.points.camera()->camera),
          pattern_(pattern_of(in.pattern)),
          kept_(buffers),
          memory_(session_, kept_.bytes_of_runs) {
        kept_.camera.aim(in.triangles, camera_, view_.width, view_.height, in.pattern);
        kept_.pattern.reserve(session_, sizeof(SamplePattern));
        kept_.counters.reserve(session_, sizeof(SampleCounters));
        session_.write(kept_.pattern.get(), &pattern_, sizeof(pattern_));
        make_rays();
    }

    Statistics run() {
        Statistics camera;
        kept_.camera.fit_lists(camera);
        add_stages(total_, camera);
        list_slots();
        const std::uint32_t bands = kept_.camera.tiles_y();
        std::uint32_t at_once =
            static_cast<std::uint32_t>(std::clamp<std::size_t>(points_at_once_ / 2 / slots_of_bands(1), 1, bands));
        for (std::uint32_t first = 0; first < bands;) {
            set_batch(first, std::min(at_once, bands - first));
            if (!find_fragments()) {
                // Pixels have more receivers than expected: enlarge the buffers, or take fewer pixels at a time.
                kept_.extra_expected = counted_.extra + counted_.extra / 4;
                if (batch_.count + kept_.extra_expected > points_at_once_) at_once = std::max(batch_.bands / 2, 1u);
                continue;
            }
            bound();
            classify();
            resolve(used_slots(), 0);
            if (counted_.squares != 0) resolve_squares();
            add_sums();
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
        run_stage("samples_rays", cl::Range::items(entries), ray_axes(camera_, view_.width, view_.height),
                  kept_.pattern, kept_.rays);
    }

    template <typename... Arguments>
    void run_stage(const cl::Kernel& kernel, cl::Range range, const Arguments&... arguments) {
        cl::StageTimer timer(session_, total_, kernel.name);
        session_.launch(kernel, range, arguments...);
    }
    template <typename... Arguments>
    void run_stage(const char* kernel, cl::Range range, const Arguments&... arguments) {
        run_stage(inputs_.kernel("samples/samples.cl", kernel), range, arguments...);
    }

    /// Work-groups of samples_fragments; each may leave some of its reserved slots unused.
    cl::Range fragment_groups(std::size_t edges) const {
        cl::Range range = session_.small_groups();
        range.count = std::min(range.count, edges);
        return range;
    }

    /// Slots of a list that work-items may reserve and leave unused.
    std::size_t unused_slots() const {
        return session_.is_cpu() ? session_.many_groups() * session_.work_group_size() * APPEND_BLOCK_ON_CPU : 0;
    }

    std::size_t slots_of_bands(std::uint32_t bands) const {
        const std::size_t tiles_x = (view_.width + (1u << CAMERA_TILE_LOG2) - 1) >> CAMERA_TILE_LOG2;
        return bands * tiles_x << 2 * CAMERA_TILE_LOG2;
    }

    std::size_t pixels_of_batch() const {
        const std::uint32_t first_row = batch_.first_tile / batch_.tiles_x << CAMERA_TILE_LOG2;
        return std::size_t(view_.width) * std::min(batch_.bands << CAMERA_TILE_LOG2, view_.height - first_row);
    }

    void set_batch(std::uint32_t first_band, std::uint32_t bands) {
        const std::size_t count = slots_of_bands(bands);
        const std::size_t extra = std::min(std::max(kept_.extra_expected, count / 2 + 64), points_at_once_);
        const std::size_t unused =
            session_.is_cpu() ? 2 * unused_slots() : fragment_groups(count).count * SLOTS_OF_GROUP;
        const std::size_t slots = count + extra + unused;
        batch_ = {.first_tile = first_band * kept_.camera.tiles_x(),
                  .count = cl_uint(count),
                  .width = view_.width,
                  .height = view_.height,
                  .tiles_x = kept_.camera.tiles_x(),
                  .bands = bands,
                  .slots = cl_uint(slots),
                  .edge_slots = cl_uint(count + unused_slots())};
        kept_.edges.reserve(session_, (session_.is_cpu() ? 1 : 3) * std::size_t(batch_.edge_slots) * sizeof(cl_uint));
        kept_.fragments.reserve(session_, 3 * slots * sizeof(cl_uint));
        kept_.centres.reserve(session_, 3 * slots * sizeof(float));
        kept_.footprints.reserve(session_, FOOTPRINT_FLOATS * slots * sizeof(float));
        session_.fill(kept_.counters, 0, sizeof(SampleCounters));
        counted_ = {};
    }

    void read_counters() { counted_ = session_.read_value<SampleCounters>(kept_.counters); }

    /// The parameters for the elements [first, first + count) of a kernel's list.
    SamplesParams params_of(cl_uint first, cl_uint count) const {
        return {.triangles = inputs_,
                .picture = kept_.camera.picture(),
                .batch = batch_,
                .eye = {camera_.eye[0], camera_.eye[1], camera_.eye[2]},
                .first = first,
                .count = count,
                .extra_count = counted_.extra,
                .point_stride = 0,
                .samples = cl_ushort(pattern_.count),
                .squares = 0,
                .open = {}};
    }

    /// False if there are more fragments than slots.
    bool find_fragments() {
        SamplesParams whole = params_of(0, batch_.count);
        // The parts of a point light's squares would go through all stages once more.
        whole.squares = in_.light.is_directional();
        run_stage("samples_whole", session_.blocks(batch_.count), whole, kept_.pattern, kept_.camera.setup().records(),
                  kept_.camera.setup().bounds(), kept_.slots, view_.points.receivers(), kept_.camera.bins().ranges(),
                  kept_.fragments, kept_.edges, kept_.centres, kept_.footprints, kept_.counters);
        read_counters();
        session_.is_cpu() ? find_masks() : filter_edges();
        return counted_.extra <= batch_.slots - batch_.count;
    }

    void find_masks() {
        run_stage("samples_masks", session_.blocks(counted_.edges), params_of(0, counted_.edges), kept_.pattern,
                  inputs_.vertices, kept_.rays, kept_.camera.setup().records(), kept_.camera.setup().bounds(),
                  kept_.camera.bins().ranges(), kept_.camera.bins().entries(), view_.points.receivers(), kept_.slots,
                  kept_.edges, kept_.fragments, kept_.counters);
        read_counters();
    }

    /// Launches an item for each pixel, then an item for each sample that is left. Open pairs have a kernel of their
    /// own; if there are too many, samples_fragments decides them.
    void filter_edges() {
        const auto of_file = [&](const char* kernel) { return inputs_.kernel("samples/samples_filter.cl", kernel); };
        SamplesParams params = params_of(0, counted_.edges);
        OpenCapacities& room = params.open;
        room.pixels = counted_.edges / 2 + MIN_OPEN_ROOM;
        room.pairs = (inputs_.has_cut_outs ? 8 : 2) * counted_.edges + MIN_OPEN_ROOM;
        const std::size_t words = std::size_t(room.pixels) * (MAX_SAMPLES + 1) + 2 * std::size_t(room.pairs);
        kept_.open.reserve(session_, words * sizeof(cl_uint));
        constexpr std::size_t warp = 32;
        cl::Kernel masks = inputs_.kernel("samples/samples_masks_gpu.cl", "samples_masks_gpu");
        masks.flags.small_groups = session_.largest_group(masks) < warp;
        run_stage(masks, cl::Range::groups(counted_.edges / warp + 1, warp), params, kept_.pattern,
                  kept_.camera.setup().records(), kept_.camera.setup().bounds(), kept_.camera.bins().ranges(),
                  kept_.camera.bins().entries(), view_.points.receivers(), kept_.slots, kept_.edges, kept_.fragments,
                  kept_.open, kept_.counters);
        run_stage(of_file("samples_filter"), fragment_groups(counted_.edges), params, kept_.pattern,
                  kept_.camera.setup().records(), kept_.camera.setup().bounds(), kept_.camera.bins().ranges(),
                  kept_.camera.bins().entries(), view_.points.receivers(), kept_.slots, kept_.edges, kept_.fragments,
                  kept_.open, kept_.counters);
        run_stage(of_file("samples_open_pairs"), cl::Range::items(room.pairs), params, inputs_.vertices, kept_.rays,
                  kept_.camera.setup().bounds(), view_.points.receivers(), kept_.open, kept_.counters);
        run_stage(of_file("samples_open_fragments"), fragment_groups(room.pixels), params, kept_.pattern,
                  view_.points.receivers(), kept_.fragments, kept_.open, kept_.counters);
        read_counters();
        if (counted_.unproven != 0) {
            run_stage("samples_fragments", fragment_groups(counted_.unproven), params_of(0, counted_.unproven),
                      kept_.pattern, inputs_.vertices, kept_.rays, kept_.camera.setup().records(),
                      kept_.camera.setup().bounds(), kept_.camera.bins().ranges(), kept_.camera.bins().entries(),
                      view_.points.receivers(), kept_.edges, kept_.fragments, kept_.counters);
            read_counters();
        }
    }

    void list_slots() {
        kept_.slots.reserve(session_, (std::size_t(inputs_.count) + 1) * sizeof(cl_uint));
        run_stage("samples_slots", cl::Range::items(inputs_.count), params_of(0, 0), kept_.camera.counters(),
                  kept_.camera.setup().bounds(), kept_.slots);
    }

    void bound() {
        const std::size_t count = std::size_t(counted_.edges) + counted_.extra;
        run_stage("samples_bound", session_.blocks(count), params_of(0, counted_.edges), kept_.pattern,
                  inputs_.vertices, kept_.edges, kept_.fragments, kept_.centres, kept_.footprints);
    }

    cl_uint used_slots() const { return batch_.count + counted_.extra; }

    void classify() {
        // Room for all slots: the number of used slots depends on threads, and a run's memory must not.
        kept_.classes.reserve(session_, batch_.slots * sizeof(float));
        add_run([&] { return footprint_session_.classify({centres(), kept_.footprints, batch_.count, classes()}); });
    }

    /// The points of the fragments' footprints. The fragments' buffer begins with their receivers.
    Points centres() const {
        return Internals::seen_from(
            Points::wrap(in_.device, kept_.centres.get(), {0, 1, batch_.slots}, used_slots(), kept_.fragments.get()),
            camera_.eye);
    }
    Visibility classes() const { return Visibility::wrap(in_.device, kept_.classes.get(), used_slots()); }

    /// Adds up the decided samples of `count` fragments and lists the mixed ones; with `squares`, of the fragments of
    /// these squares' pixels.
    void resolve(cl_uint count, cl_uint squares) {
        kept_.mixed.reserve(session_, (batch_.slots + 2 * unused_slots()) * sizeof(cl_uint));
        kept_.squares.reserve(session_, (batch_.count / SQUARE_PIXELS + unused_slots()) * sizeof(cl_uint));
        SamplesParams params = params_of(0, count);
        params.extra_count = squares;
        run_stage("samples_resolve", cl::Range::items(count), params, kept_.fragments, kept_.classes, kept_.mixed,
                  kept_.squares, kept_.counters);
        read_counters();
    }

    /// Classifies the pixels of mixed squares one by one.
    void resolve_squares() {
        run_stage("samples_split", cl::Range::items(counted_.squares), params_of(0, counted_.squares), kept_.pattern,
                  kept_.camera.setup().records(), kept_.camera.setup().bounds(), kept_.slots, kept_.squares,
                  kept_.fragments, kept_.centres, kept_.footprints, kept_.classes);
        add_run([&] {
            return footprint_session_.classify_parts({centres(), kept_.footprints, batch_.count, classes()});
        });
        resolve(counted_.squares * SQUARE_PIXELS, counted_.squares);
    }

    void add_sums() {
        sum_.edges += pixels_of_batch() - counted_.whole;
        sum_.whole += counted_.whole;
        sum_.fragments += counted_.fragments;
        sum_.mixed_fragments += counted_.mixed_fragments;
        sum_.mixed_samples += counted_.mixed_samples;
        sum_.in_shadow += counted_.in_shadow;
        sum_.lit += counted_.lit;
    }

    void trace_mixed() {
        // Takes all fragments at once if they certainly fit, else as many fragments as fit with all samples each.
        const std::size_t part =
            counted_.mixed_samples <= points_at_once_ ? counted_.mixed : points_at_once_ / pattern_.count;
        for (std::size_t first = 0; first < counted_.mixed; first += part)
            trace_part(static_cast<cl_uint>(first), static_cast<cl_uint>(std::min(part, counted_.mixed - first)));
    }

    void trace_part(cl_uint first, cl_uint count) {
        const std::size_t most = std::min<std::size_t>(counted_.mixed_samples, points_at_once_);
        const std::size_t points = make_points(first, count, most);
        if (points == 0) return;
        const Points samples = Internals::seen_from(
            Points::wrap(in_.device, kept_.positions.get(), {0, 1, most}, points, kept_.point_receivers.get()),
            camera_.eye);
        const Visibility visibility = Visibility::wrap(in_.device, kept_.visibility.get(), points);
        add_run([&] { return footprint_session_.trace(samples, visibility); });
        run_stage("samples_count_lit", cl::Range::items(points), params_of(0, cl_uint(points)), kept_.point_samples,
                  kept_.visibility, kept_.fragments);
    }

    /// Makes points of the samples of mixed fragments, at most `most`. Returns their number.
    std::size_t make_points(cl_uint first, cl_uint count, std::size_t most) {
        kept_.point_samples.reserve(session_, most * 2 * sizeof(cl_uint));
        kept_.point_receivers.reserve(session_, most * sizeof(cl_uint));
        kept_.positions.reserve(session_, 3 * most * sizeof(float));
        kept_.visibility.reserve(session_, most * sizeof(float));
        SamplesParams params = params_of(first, count);
        params.point_stride = static_cast<cl_uint>(most);
        const std::size_t items = session_.is_cpu() ? count : std::size_t(count) * PARTS_OF_FRAGMENT;
        cl::StageTimer timer(session_, total_, "samples_points");
        session_.fill(kept_.counters, 0, sizeof(SampleCounters));
        session_.launch("samples/samples.cl", "samples_points", cl::Range::items(items), params, inputs_.vertices,
                        kept_.rays, kept_.fragments, kept_.mixed, kept_.point_samples, kept_.point_receivers,
                        kept_.positions, kept_.visibility, kept_.counters);
        if (count == counted_.mixed) return counted_.mixed_samples;
        return session_.read_value<SampleCounters>(kept_.counters).points;
    }

    void write_mean() {
        run_stage("samples_mean_of_sums", cl::Range::items(batch_.count), params_of(0, batch_.count), kept_.fragments,
                  in_.mean.buffer());
    }

    void add_run(const auto& run_technique) {
        const MeasuredRun memory(session_, kept_.bytes_of_technique);
        const Statistics run = run_technique();
        add_stages(total_, run);
        technique_memory_bytes_ = std::max(technique_memory_bytes_, run.device_memory_bytes);
        was_prepared_ |= run.count("prepared") != 0;
    }

    void add_counts() {
        total_.counts = {{"points", view_.points.count() * pattern_.count},
                         {"pixels_on_one_receiver", sum_.whole},
                         {"pixels_on_several", sum_.edges},
                         {"fragments", sum_.fragments},
                         {"fragments_mixed", sum_.mixed_fragments},
                         {"samples_decided_in_shadow", sum_.in_shadow},
                         {"samples_decided_lit", sum_.lit},
                         {"samples_traced", sum_.mixed_samples},
                         {"prepared", was_prepared_}};
    }

    FootprintSession& footprint_session_;
    const SampledView& in_;
    const View& view_;
    cl::Session& session_;
    TriangleInputs inputs_;
    std::size_t points_at_once_;
    Camera camera_;
    SamplePattern pattern_;
    FragmentBuffers& kept_;
    const MeasuredRun memory_;
    PixelBatch batch_{};
    SampleCounters counted_{};
    struct {
        std::uint64_t edges, whole, fragments, mixed_fragments, mixed_samples, in_shadow, lit;
    } sum_{};
    Statistics total_;
    std::uint64_t technique_memory_bytes_ = 0;
    bool was_prepared_ = false;
};

}  // namespace

SamplePattern pattern_of(std::span<const SampleOffset> offsets) {
    SamplePattern pattern{};
    pattern.count = static_cast<cl_uint>(offsets.size());
    pattern.all = pattern.count == MAX_SAMPLES ? 0xFFFFFFFFu : (1u << pattern.count) - 1;
    for (int c = 0; c < 2; ++c) {
        pattern.low[c] = 1.0f;
        pattern.high[c] = 0.0f;
    }
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const float position[2] = {0.5f + static_cast<float>(offsets[i].x) / SAMPLE_UNITS,
                                   0.5f + static_cast<float>(offsets[i].y) / SAMPLE_UNITS};
        for (std::size_t c = 0; c < 2; ++c) {
            (c == 0 ? pattern.position_x : pattern.position_y)[i] = position[c];
            pattern.low[c] = std::min(pattern.low[c], position[c]);
            pattern.high[c] = std::max(pattern.high[c], position[c]);
        }
    }
    return pattern;
}

Statistics run_fragments(FootprintSession& footprints, std::shared_ptr<void>& kept, const SampledView& in) {
    if (kept == nullptr) kept = std::make_shared<FragmentBuffers>(in.device);
    FragmentRun samples(footprints, *std::static_pointer_cast<FragmentBuffers>(kept), in);
    Statistics total = samples.run();
    total.device_memory_bytes = samples.device_memory_bytes();
    return total;
}

}  // namespace gnomon
