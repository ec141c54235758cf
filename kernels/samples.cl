// SPDX-License-Identifier: MIT
// Samples: the mean of a pixel's samples, batch by batch. Sums of 0 and 1 are exact, and so is the mean, because the
// number of samples is a power of two; filtered techniques' values are added in the samples' order on every device.
#include "prelude.h"

// visibility: sample by sample, `pixels` each. The first batch starts the sum, the last one's scale makes it the mean.
__kernel void samples_mean(uint pixels, uint samples, uint is_first, float scale, __global const float* visibility,
                           __global float* mean) {
    GN_FOR_EACH(pixel, pixels) {
        float sum = is_first ? 0.0f : mean[pixel];
        for (uint sample = 0; sample < samples; ++sample) sum += visibility[(size_t)sample * pixels + pixel];
        mean[pixel] = sum * scale;
    }
}
