// SPDX-License-Identifier: MIT
// The grids of light frames: all rules for the number of texels and the size of bins, by device and scene. (A camera's
// bins are its tiles of pixels: CAMERA_TILE_LOG2 in kernels/camera/camera.h.)
#pragma once

#include "cl/session.hpp"

namespace gnomon {

/// Texels of a frame, and how they are grouped into bins.
struct FrameGrid {
    std::uint32_t size;      ///< texels per side
    std::uint32_t bin_log2;  ///< texels per bin side, as a power of two
    std::uint32_t bins() const { return (size + (1u << bin_log2) - 1) >> bin_log2; }
    std::uint32_t bin_count() const { return bins() * bins(); }
};

/// Texels per side that a setting may give.
constexpr std::uint32_t smallest_map_size = 16, largest_map_size = 8192;

/// The grid with this many texels and the finest useful bins: at most 128 x 128 on a CPU, 1024 x 1024 on a GPU.
FrameGrid map_grid(const cl::Session& session, std::uint32_t size);
/// The grid with this many texels, each a bin of its own.
inline FrameGrid texel_grid(std::uint32_t size) { return {size, 0}; }
/// For lists that a run makes for its points. `map_size`: texels per side, 0: chosen by device and scene.
FrameGrid run_grid(const cl::Session& session, std::uint32_t map_size, std::size_t triangle_count,
                   std::size_t point_count);
/// For the lists that a prepared light keeps. `map_size` as above.
FrameGrid prepared_grid(const cl::Session& session, std::uint32_t map_size, std::size_t triangle_count,
                        bool is_point_light);

}  // namespace gnomon
