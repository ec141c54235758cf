// SPDX-License-Identifier: MIT
// Rays for Embree: how they are made, handed over in packets or streams, and what is kept of their answers.
//
// A picture is cut into tiles of 1024 rays: 32 x 32 pixels, or fewer pixels with several samples each. A tile's rays
// stand in blocks of 4 x 4 neighbouring pixels (of one sample), or pixel by pixel (of several), so that 16 rays that
// follow each other are close to each other.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <gnomon.hpp>
#include "embree_scene.hpp"

namespace gnomon::bench::embree {

constexpr std::size_t tile_rays = 1024, ray_width = 16, stream_length = 256;

/// How rays are handed to Embree. All are marked as coherent.
enum class Shape { packets_of_8, packets_of_16, streams_of_256 };
constexpr Shape shapes[] = {Shape::packets_of_8, Shape::packets_of_16, Shape::streams_of_256};
const char* name_of(Shape shape);

/// Calls work(i) for each i in [0, count) on so many threads, with denormals as zeros, as Embree's manual advises.
void for_each_tile(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& work);

/// Points with a shadow ray: structure of arrays, filled up to whole packets with the last point.
struct RayPoints {
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> index;  ///< not filled up

    std::size_t count() const { return index.size(); }
    void clear();
    void append(float px, float py, float pz, std::size_t at);
    void fill_up();
};

/// Shadow rays towards a light, which start `offset` along their way.
struct ShadowRays {
    std::array<float, 4> light{};  ///< homogeneous
    float offset = 0;              ///< in the scene's unit

    /// lit[points.index[i]] = 1 or 0 for i in [first, first + count), first a multiple of ray_width.
    void trace(Shape shape, RTCScene scene, const RayPoints& points, std::size_t first, std::size_t count,
               std::uint8_t* lit) const;
};

/// What primary rays found, in the order of a tile's rays.
struct Hits {
    std::vector<float> x, y, z;  ///< shading points: sky has none
    std::vector<std::uint32_t> triangle;
    std::vector<std::uint8_t> faces_light;

    explicit Hits(std::size_t count) : x(count), y(count), z(count), triangle(count), faces_light(count) {}
};

/// A picture's primary rays.
class CameraRays {
public:
    /// `lift`: how far along the normal a hit's shading point stands off its triangle.
    CameraRays(const Camera& camera, std::uint32_t width, std::uint32_t height, std::uint32_t samples,
               const Light& light, const Mesh& mesh, float lift);

    std::size_t tiles() const { return tiles_per_row_ * tiles_per_column_; }
    static constexpr std::size_t no_pixel = ~std::size_t{0};
    /// The function of a tile's ray that returns its pixel, or `no_pixel` beyond the picture's edge.
    auto pixels_of(std::size_t tile) const {
        return [this, left = tile % tiles_per_row_ * tile_width_,
                top = tile / tiles_per_row_ * tile_height_](std::size_t ray) {
            const std::size_t x = left + column_[ray], y = top + row_[ray];
            return x < width_ && y < height_ ? y * width_ + x : no_pixel;
        };
    }

    /// Writes the hits of a tile at [first, first + tile_rays).
    void trace(Shape shape, RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const;

private:
    template <typename Traits>
    void trace_packets(RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const;
    void trace_streams(RTCScene scene, std::size_t tile, Hits& hits, std::size_t first) const;
    Float3 corner_of(std::size_t tile) const;
    void keep(Hits& hits, std::size_t at, const float direction[3], float t, const float normal[3],
              std::uint32_t geometry, std::uint32_t triangle) const;

    const Mesh& mesh_;
    std::uint32_t width_, height_, samples_;
    std::uint32_t tile_width_, tile_height_;  ///< in pixels
    std::size_t tiles_per_row_, tiles_per_column_;
    Float3 eye_, corner_, right_, down_;  ///< a ray's direction: corner + x right + y down, in pixels
    std::array<float, 4> light_;
    float lift_;
    // Of each ray in a tile: its pixel, and where in the tile it passes, both in pixels.
    std::array<std::uint8_t, tile_rays> column_{}, row_{};
    std::array<float, tile_rays> at_x_{}, at_y_{};
};

}  // namespace gnomon::bench::embree
