// SPDX-License-Identifier: MIT
// Experimental: several samples per pixel. They are a library of their own: link gnomon::samples or gnomon::full.
#pragma once

#include <gnomon/view.hpp>

#pragma GCC visibility push(default)

namespace gnomon {

/// The pattern of 1, 4, 8, 16 or 32 samples per pixel. 1: the centre. 4, 8, 16: Direct3D's standard patterns. 32:
/// Hammersley's points in base 2, x = (i + 1/2) / 32 and y = (i's five bits in reverse + 1/2) / 32 from the pixel's
/// upper left corner, i = 0 .. 31: every row, column and elementary rectangle of 1/32 of a pixel holds one. Throws
/// InvalidArgument for another number.
std::span<const SampleOffset> sample_pattern(std::uint32_t samples);

/// Receives the points of some samples before their visibility is computed: sample by sample in the pattern's order,
/// each pixel by pixel. The points are valid during the call.
using SampleSink = std::function<void(const Points& points)>;

/// Anti-aliased shadows: writes to `mean` the mean visibility of each pixel's samples. Each sample is a point of its
/// own with its own visibility. If the sample's ray meets the pixel's receiver, the point lies on that receiver, else
/// on the first triangle that the ray meets (or creases would leak light); a sample without a triangle counts as lit.
/// If an exact technique proves that all samples of a pixel on one receiver are in shadow, or lit, it does not make
/// them one by one; same bits. Samples are processed in batches of bounded memory, which an exact technique frees at
/// its end; times are sums over the batches. Points face by the view's eye. `view` must come from look(). Throws
/// InvalidArgument like sample_pattern(), or if `mean` has fewer entries than the view has pixels.
Statistics run_samples(Technique& technique, const Triangles& triangles, const View& view, const Light& light,
                       std::uint32_t samples, const Visibility& mean, const SampleSink& sink = {});
/// The same for soft shadows: each sample's visibility is that of run_mean(). Every sample becomes a point.
Statistics run_samples_mean(Technique& technique, const Triangles& triangles, const View& view, const Lights& lights,
                            std::uint32_t samples, const Visibility& mean, const SampleSink& sink = {});

/// The points of run_samples() as views, a sample of every pixel at a time: for smooth pictures (PictureMean).
class SampleViews {
public:
    /// `view` must come from look(), of these triangles. Throws InvalidArgument like sample_pattern().
    SampleViews(const Device& device, const Triangles& triangles, const View& view, std::uint32_t samples);
    ~SampleViews();
    std::size_t count() const;  ///< samples per pixel
    /// The view of sample i, below count(). Its buffers are used again by the next call, and end with this object.
    View at(std::size_t i);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gnomon

#pragma GCC visibility pop
