// SPDX-License-Identifier: MIT
#include "receivers/frame_grid.hpp"

#include <algorithm>

namespace gnomon {
namespace {

FrameGrid with_bins(std::uint32_t size, std::uint32_t max_bins) {
    FrameGrid grid{size, 0};
    while (grid.bins() > max_bins) ++grid.bin_log2;
    return grid;
}

// Texels per side of a frame that a GPU keeps, which are bins as well: the finer, the shorter the lists of all the
// scene's triangles (docs/notebook/experiments.md has times and memory). A point light has six frames.
std::uint32_t kept_size_on_gpu(std::size_t triangle_count, std::uint64_t device_bytes, bool is_point_light) {
    std::uint32_t size = 8192;
    if (triangle_count < 1u << 23 || device_bytes < 64ull << 30) size = 4096;
    if (triangle_count < 1u << 20 || device_bytes < 16ull << 30) size = 2048;
    if (triangle_count < 1u << 17) size = 1024;
    return is_point_light ? std::max(size / 2, 1024u) : size;
}

}  // namespace

FrameGrid map_grid(const cl::Session& session, std::uint32_t size) {
    return with_bins(size, session.is_cpu() ? 128 : 1024);
}

FrameGrid run_grid(const cl::Session& session, std::uint32_t map_size, std::size_t triangle_count,
                   std::size_t point_count) {
    if (map_size != 0) return map_grid(session, map_size);
    // A CPU pays for every texel drawn, a GPU hardly: the trace of millions of triangles gains more by 1024 than the
    // lists lose; with a million it is even, with fewer a loss.
    const std::uint32_t largest = session.is_cpu() ? 256 : triangle_count < 1u << 22 ? 512 : 1024;
    // Few points want few bins: a large triangle is tested against every bin it meets, also bins without a point.
    std::uint32_t size = 4;
    while (size < largest && std::size_t(size) * size * 4 < point_count) size *= 2;
    return map_grid(session, size);
}

// Finer than a run's own grid, since the lists are made only once, and since the frame contains all triangles of the
// scene instead of those of a view.
FrameGrid prepared_grid(const cl::Session& session, std::uint32_t map_size, std::size_t triangle_count,
                        bool is_point_light) {
    if (!session.is_cpu()) {
        const std::uint64_t device_bytes = session.description().global_memory_bytes;
        return with_bins(map_size != 0 ? map_size : kept_size_on_gpu(triangle_count, device_bytes, is_point_light),
                         largest_map_size);
    }
    // 1024 texels and 256 bins give a trace of Sponza the fewest tests but for 2048, whose map takes five times as
    // long. A list's entries are read 16 at a time, so that a bin with few entries is mostly empty; but scenes of
    // millions spend their time on reading long lists.
    std::uint32_t max_bins = 256;
    while (max_bins < 1024 && triangle_count > std::size_t(max_bins) * max_bins * 8) max_bins *= 2;
    return with_bins(map_size != 0 ? map_size : 1024, max_bins);
}

}  // namespace gnomon
