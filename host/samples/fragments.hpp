// SPDX-License-Identifier: MIT
// Samples, most of them decided together: pixel fragments whose footprints a technique classifies as in shadow or lit,
// and points for the samples of mixed fragments (kernels/samples/samples.h, kernels/samples/samples.cl).
#pragma once

#include "camera/camera.hpp"
#include "kernels/samples/samples.h"
#include "samples/classify_footprints.hpp"

namespace gnomon {

/// The pattern as the kernels take it.
SamplePattern pattern_of(std::span<const SampleOffset> offsets);

/// As run_samples(), with about `points_at_once` points or fragments on the device, but a row of camera tiles at least.
Statistics run_samples_by_fragments(ClassifiesFootprints& technique, const Device& device, const Triangles& triangles,
                                    const View& view, const Light& light, std::span<const SampleOffset> offsets,
                                    const Visibility& mean, std::size_t points_at_once);

}  // namespace gnomon
