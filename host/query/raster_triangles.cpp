// SPDX-License-Identifier: MIT
#include "query/raster_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {
namespace {

// Whether the places of columns or rows fall. Throws InvalidArgument unless they rise or fall from each to the next.
bool falls(std::span<const float> places, const char* name) {
    const bool is_falling = places.size() > 1 && places[1] < places[0];
    for (std::size_t i = 0; i < places.size(); ++i) {
        const bool is_apart = i == 0 || (is_falling ? places[i] < places[i - 1] : places[i] > places[i - 1]);
        if (!std::isfinite(places[i]) || !is_apart)
            throw InvalidArgument("the raster's " + std::string(name) + "[" + std::to_string(i) + "] is " +
                                  std::to_string(places[i]) +
                                  ": give finite numbers that rise, or fall, from each to the next");
    }
    return is_falling;
}

void require_sizes(const Raster& raster) {
    constexpr std::size_t most = std::numeric_limits<cl_uint>::max();
    const std::size_t columns = raster.x.size(), rows = raster.y.size();
    if (columns < 2 || rows < 2)
        throw InvalidArgument("the raster has " + std::to_string(rows) + " rows and " + std::to_string(columns) +
                              " columns of vertices: give at least two of each");
    if (raster.heights.size() / columns != rows || raster.heights.size() % columns != 0)
        throw InvalidArgument("the raster has " + std::to_string(rows) + " x " + std::to_string(columns) +
                              " vertices and " + std::to_string(raster.heights.size()) + " heights: give one for each");
    if ((rows - 1) > (most - 1) / 2 / (columns - 1))
        throw InvalidArgument("the raster has 2^32 - 1 triangles or more: divide it");
}

}  // namespace

ImplicitRaster::ImplicitRaster(const Device& device, const Raster& raster) : device_(device) {
    require_sizes(raster);
    x_falls_ = falls(raster.x, "x");
    y_falls_ = falls(raster.y, "y");
    head_ = {.columns = static_cast<cl_uint>(raster.x.size()),
             .rows = static_cast<cl_uint>(raster.y.size()),
             .joins_first_corner = raster.joins_first_corner ? 1u : 0u,
             .is_mirrored = x_falls_ == y_falls_ ? 1u : 0u};
    constexpr float infinite = std::numeric_limits<float>::infinity();
    low_ = {std::min(raster.x.front(), raster.x.back()), std::min(raster.y.front(), raster.y.back()), infinite};
    high_ = {std::max(raster.x.front(), raster.x.back()), std::max(raster.y.front(), raster.y.back()), -infinite};
    for (const float height : raster.heights) {
        const bool is_there = std::isfinite(height);
        has_holes_ |= !is_there;
        low_[2] = std::min(low_[2], is_there ? height : infinite);
        high_[2] = std::max(high_[2], is_there ? height : -infinite);
    }
    cl::Session& session = session_of(device);
    std::size_t at = 0;
    const auto add = [&](const auto& values) {
        const auto bytes = std::as_bytes(std::span(values));
        session.write(memory(), bytes.data(), bytes.size(), at);
        at += bytes.size();
    };
    const std::size_t floats = RASTER_HEAD_FLOATS + raster.x.size() + raster.y.size() + raster.heights.size();
    memory_ = shared_buffer(device, cl::Buffer(session, floats * sizeof(float)));
    add(std::array{head_});
    add(raster.x);
    add(raster.y);
    add(raster.heights);
}

float ImplicitRaster::largest_coordinate() const {
    float largest = 0;
    for (int axis = 0; axis < (high_[2] < low_[2] ? 2 : 3); ++axis)
        largest = std::max({largest, std::abs(low_[axis]), std::abs(high_[axis])});
    return largest;
}

cl_mem ImplicitRaster::vertices() {
    if (vertices_ == nullptr) {
        cl::Session& session = session_of(device_);
        cl::Buffer written(session, 9 * triangle_count() * sizeof(float));
        session.launch("query/raster_triangles.cl", "raster_triangles", cl::Range::items(triangle_count()),
                       static_cast<cl_uint>(triangle_count()), memory(), written);
        vertices_ = shared_buffer(device_, std::move(written));
    }
    return static_cast<cl_mem>(vertices_.get());
}

Triangles Triangles::raster(const Device& device, const Raster& raster) {
    Triangles triangles;
    triangles.raster_ = std::make_shared<ImplicitRaster>(device, raster);
    triangles.count_ = triangles.raster_->triangle_count();
    return triangles;
}

TriangleInputs implicit_inputs(const Triangles& triangles) {
    ImplicitRaster* raster = Internals::raster(triangles);
    if (raster == nullptr) return triangle_inputs(triangles);
    return {{.first_float = 0, .count = static_cast<cl_uint>(triangles.count()), .padding = 0},
            raster->memory(),
            nullptr,
            false,
            true};
}

}  // namespace gnomon
