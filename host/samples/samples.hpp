// SPDX-License-Identifier: MIT
// Several samples per pixel (kernels/samples/samples.cl; the camera stage makes rays and points): run_samples() of
// gnomon.hpp, and the same with the size of its batches for tests.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

/// As run_samples(), with at most `points_at_once` points on the device, but one sample of every pixel at least.
Statistics run_samples_in_batches(Technique& technique, const Device& device, const Triangles& triangles,
                                  const View& view, const Light& light, std::uint32_t samples, const Visibility& mean,
                                  const SampleSink& sink, std::size_t points_at_once);

}  // namespace gnomon
