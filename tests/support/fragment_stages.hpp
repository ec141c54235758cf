// SPDX-License-Identifier: MIT
// Runs the samples of a view and keeps what passes between their stages: the fragments with their masks and footprints,
// as a technique is asked to classify them, and its answers.
#pragma once

#include <gnomon.hpp>

#include "camera_scenes.hpp"
#include "kernels/receivers/footprint.h"
#include "samples/samples.hpp"

namespace support {

/// Fragments as they were classified. The first `pixels` slots are those on the pixels' own receivers, the others'
/// pixels are in `extra_pixels` (kernels/samples/samples.h).
struct ClassifiedFragments {
    std::size_t pixels, slots, used;  ///< slots: the stride of the arrays; used: of all slots
    std::vector<std::uint32_t> receivers, masks, extra_pixels, lit;
    Floats centres, footprints;  ///< coordinate by coordinate, `slots` each
    std::vector<float> classes;

    Float3 centre(std::size_t slot) const { return {centres[slot], centres[slots + slot], centres[2 * slots + slot]}; }
    float shape(std::size_t i, std::size_t slot) const { return footprints[i * slots + slot]; }
};

/// The samples of a view, sample by sample, each pixel by pixel; and the fragments that they are in, once for each time
/// that fragments are classified.
struct RecordedSamples {
    std::uint32_t width, height, samples;
    bool has_squares;  ///< pixels of a batch are numbered square by square, as on a CPU
    Floats positions;
    std::vector<std::uint32_t> receivers, pixel_receivers;
    std::vector<ClassifiedFragments> classified;
    gnomon::Statistics statistics;

    std::size_t pixels() const { return std::size_t(width) * height; }
    /// The number in the view of a pixel of a batch of the whole picture; nothing if it lies outside.
    std::optional<std::size_t> place_of(std::uint32_t pixel) const;
    /// Calls visit(place, sample) for each sample of a fragment.
    template <typename Visit>
    void for_samples(const ClassifiedFragments& of, std::size_t slot, Visit&& visit) const;
};

inline std::optional<std::size_t> RecordedSamples::place_of(std::uint32_t pixel) const {
    const std::uint32_t tiles_x = (width + 15) / 16, tile = pixel >> 8;
    std::uint32_t x = pixel & 15, y = pixel >> 4 & 15;
    if (has_squares) {
        const std::uint32_t square = y, in_square = x;
        x = square % 4 * 4 + in_square % 4;
        y = square / 4 * 4 + in_square / 4;
    }
    x += tile % tiles_x * 16;
    y += tile / tiles_x * 16;
    if (x >= width || y >= height) return {};
    return std::size_t(y) * width + x;
}

template <typename Visit>
void RecordedSamples::for_samples(const ClassifiedFragments& of, std::size_t slot, Visit&& visit) const {
    const std::uint32_t word = slot < of.pixels ? std::uint32_t(slot) : of.extra_pixels[slot - of.pixels];
    const std::uint32_t first = word & ~IS_SQUARE, count = (word & IS_SQUARE) != 0 ? SQUARE_PIXELS : 1;
    for (std::uint32_t pixel = first; of.masks[slot] != 0 && pixel < first + count; ++pixel)
        for (std::uint32_t sample = 0; sample < samples; ++sample)
            if ((of.masks[slot] >> sample & 1) != 0) visit(place_of(pixel).value(), sample);
}

/// Classifies as frustum-traced does, or calls all footprints mixed.
class FragmentRecorder final : private gnomon::FootprintSession {
public:
    FragmentRecorder(const gnomon::Device& device, bool classifies, std::uint32_t map_size, RecordedSamples& to)
        : device_(device), tracer_(device), classifies_(classifies), to_(to) {
        gnomon::TracerSettings settings{};
        settings.map_mode = gnomon::MapMode::on;  // `auto` takes none for so few points
        settings.map_size = map_size;
        tracer_.set(settings);
    }
    gnomon::Statistics run(const gnomon::SampledView& in) {
        gnomon::TracedFootprints inner(tracer_, prepared_, in.triangles, in.light);
        inner_ = &inner;
        std::shared_ptr<void> kept;
        return run_fragments(*this, kept, in);
    }
    void prepare(const gnomon::Triangles& triangles, const gnomon::Light& light) {
        prepared_.prepare(triangles, light);
    }

private:
    gnomon::Statistics classify(const gnomon::Footprints& footprints) override {
        return classify_and_record(&FootprintSession::classify, footprints);
    }
    gnomon::Statistics classify_parts(const gnomon::Footprints& footprints) override {
        return classify_and_record(&FootprintSession::classify_parts, footprints);
    }
    /// Nobody asks for the mean.
    gnomon::Statistics trace(const gnomon::Points&, const gnomon::Visibility&) override { return {}; }

    using Classification = gnomon::Statistics (gnomon::FootprintSession::*)(const gnomon::Footprints&);
    gnomon::Statistics classify_and_record(Classification classification, const gnomon::Footprints& footprints) {
        gnomon::Statistics statistics;
        if (classifies_)
            statistics = (inner_->*classification)(footprints);
        else
            call_all_mixed(footprints.classes);
        record(footprints);
        return statistics;
    }
    gnomon::cl::Session& session() const { return session_of(device_); }
    void call_all_mixed(const gnomon::Visibility& classes) {
        const std::vector<float> mixed(classes.count(), VISIBILITY_MIXED);
        session().write(classes.buffer(), mixed.data(), mixed.size() * sizeof(float));
    }

    /// The receivers of the footprints' centres are the first of the fragments' arrays (kernels/samples/fragments.clh).
    void record(const gnomon::Footprints& footprints) {
        const gnomon::Points& centres = footprints.centres;
        ClassifiedFragments found{};
        found.pixels = std::size_t((to_.width + 15) / 16) * ((to_.height + 15) / 16) * 256;
        found.slots = centres.layout().coordinate_stride;
        found.used = centres.count();
        const auto words = session().read_values<std::uint32_t>(centres.receivers(), 3 * found.slots);
        const auto part = [&](std::size_t first, std::size_t count) {
            const auto begin = words.begin() + std::ptrdiff_t(first);
            return std::vector<std::uint32_t>(begin, begin + std::ptrdiff_t(count));
        };
        found.receivers = part(0, found.slots);
        found.masks = part(found.slots, found.slots);
        found.extra_pixels = part(2 * found.slots, found.slots - found.pixels);
        found.lit = part(3 * found.slots - found.pixels, found.pixels);
        found.centres = session().read_values<float>(centres.positions(), 3 * found.slots);
        found.footprints = session().read_values<float>(footprints.buffer.get(), FOOTPRINT_FLOATS * found.slots);
        found.classes = session().read_values<float>(footprints.classes.buffer(), found.used);
        to_.classified.push_back(std::move(found));
    }

    gnomon::Device device_;
    gnomon::FrustumTracer tracer_;
    gnomon::PreparedRuns prepared_{tracer_};
    gnomon::FootprintSession* inner_ = nullptr;
    bool classifies_;
    RecordedSamples& to_;
};

enum class Classify { nothing, by_frustum_traced, prepared };

inline RecordedSamples record_samples(const gnomon::Device& device, const CameraScene& scene,
                                      const gnomon::Light& light, std::uint32_t samples, Classify classify,
                                      std::uint32_t map_size = 0) {
    gnomon::cl::Session& session = session_of(device);
    auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    if (classify == Classify::prepared) triangles.keep_clusters(device);
    const gnomon::View view = gnomon::look(device, triangles, scene.camera(), scene.width, scene.height);
    const gnomon::Visibility mean(device, view.points.count());
    RecordedSamples recorded{scene.width, scene.height, samples, session.is_cpu(), {}, {}, {}, {}, {}};
    gnomon::SampleViews views(device, triangles, view, samples);
    for (std::size_t sample = 0; sample < views.count(); ++sample) {
        const gnomon::Points points = views.at(sample).points;
        const std::size_t count = points.count();
        const auto planes = session.read_values<float>(points.positions(), 3 * count);
        for (std::size_t i = 0; i < count; ++i)
            add(recorded.positions, {planes[i], planes[count + i], planes[2 * count + i]});
        const auto ids = session.read_values<std::uint32_t>(points.receivers(), count);
        recorded.receivers.insert(recorded.receivers.end(), ids.begin(), ids.end());
    }
    FragmentRecorder recorder(device, classify != Classify::nothing, map_size, recorded);
    if (classify == Classify::prepared) recorder.prepare(triangles, light);
    recorded.statistics =
        recorder.run({device, triangles, view, light, gnomon::sample_pattern(samples), mean, std::size_t{1} << 23});
    recorded.pixel_receivers = session.read_values<std::uint32_t>(view.points.receivers(), view.points.count());
    return recorded;
}

/// Creases, silhouettes against the sky, ties, needles, a horizon, and what is smaller than a pixel.
inline std::vector<CameraScene> named_camera_scenes(std::initializer_list<const char*> names) {
    std::vector<CameraScene> chosen;
    for (const CameraScene& scene : camera_scenes())
        if (std::ranges::find(names, scene.name) != names.end()) chosen.push_back(scene);
    return chosen;
}

}  // namespace support
