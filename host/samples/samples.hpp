// SPDX-License-Identifier: MIT
// Several samples per pixel (kernels/samples/samples.cl; the camera stage makes rays and points): run_samples() of
// gnomon.hpp, the same with the size of its batches for tests, and its two ways.
#pragma once

#include "camera/camera.hpp"
#include "cl/embedded_files.hpp"
#include "kernels/samples/samples.h"
#include "samples/classify_footprints.hpp"

namespace gnomon {

/// A program that has samples has their kernels before it makes its first program for a device.
[[maybe_unused]] inline const bool samples_are_embedded = add_embedded_kernels(embedded_kernels_of_samples());

/// As run_samples(), with at most `points_at_once` points on the device, but one sample of every pixel at least.
Statistics run_samples_in_batches(Technique& technique, const Triangles& triangles, const View& view,
                                  const Light& light, std::uint32_t samples, const Visibility& mean,
                                  const SampleSink& sink, std::size_t points_at_once);

/// The inputs of a run of samples. There are about `points_at_once` points or fragments on the device.
struct SampledView {
    const Device& device;
    const Triangles& triangles;
    const View& view;
    const Light& light;
    std::span<const SampleOffset> pattern;
    const Visibility& mean;
    std::size_t points_at_once;
};

SamplePattern pattern_of(std::span<const SampleOffset> offsets);

/// Most samples are decided together: the footprints of pixel fragments are classified as in shadow or lit, and the
/// samples of mixed fragments become points. A row of camera tiles at least is on the device at once. `footprints`: of
/// the view's triangles and light. `kept`: the buffers, from run to run; null before the first.
Statistics run_fragments(FootprintSession& footprints, std::shared_ptr<void>& kept, const SampledView& in);

}  // namespace gnomon
