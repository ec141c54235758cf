// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace support {

/// Linear light of an 8-bit sRGB value, by sRGB's formula (IEC 61966-2-1).
inline double linear_of_srgb(double byte) {
    const double encoded = byte / 255;
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace support
