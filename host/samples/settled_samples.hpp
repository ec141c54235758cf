// SPDX-License-Identifier: MIT
// Samples, most of them settled together: pieces of pixels whose footprints a technique proves to be in shadow or lit,
// and points for the samples of the others (kernels/samples/samples.h, kernels/samples/samples.cl).
#pragma once

#include "camera/camera.hpp"
#include "kernels/samples/samples.h"
#include "samples/settle.hpp"

namespace gnomon {

/// As the kernels take it.
SamplePattern pattern_of(std::span<const SampleOffset> offsets);

/// As run_samples(), with about `points_at_once` points or pieces on the device, but a row of pixels at least.
Statistics run_settled_samples(SettlesFootprints& settling, const Device& device, const Triangles& triangles,
                               const View& view, const Light& light, std::span<const SampleOffset> offsets,
                               const Visibility& mean, std::size_t points_at_once);

}  // namespace gnomon
