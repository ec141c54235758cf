// SPDX-License-Identifier: MIT
// Stage point_order: a copy of points, sorted along a space-filling curve (kernels/lights/point_order.h).
#pragma once

#include "kernels/lights/point_order.h"
#include "query/inputs.hpp"

namespace gnomon {

struct LightsRun;

class SortedPoints {
public:
    SortedPoints() = default;
    /// Sorts the run's points. `earlier`: points of which only the memory is used.
    SortedPoints(const LightsRun& run, SortedPoints earlier);
    explicit SortedPoints(const LightsRun& run) : SortedPoints(run, SortedPoints()) {}
    /// Every share-th sequence of POINTS_OF_RUN neighbouring points of the same run, at least one sequence.
    SortedPoints sample(std::size_t share, const LightsRun& run) const;

    /// The sorted points, with the receivers and the eye of the given points.
    Points as_points(const Device& device, const Points& given) const;
    /// Points [first, first + count) as packed triples.
    PointsLayout part(std::size_t first, std::size_t count) const;
    const cl::Buffer& positions() const { return positions_; }
    const cl::Buffer& receivers() const { return receivers_; }
    const cl::Buffer& normals() const { return normals_; }
    /// The normal of each point's surface, coordinates at most 1, or zero. It affects speed alone.
    const cl::Buffer& surface_normals() const { return surface_normals_; }
    /// The number of each sorted point.
    const cl::Buffer& order() const { return order_; }
    float largest_coordinate() const { return largest_coordinate_; }

private:
    struct Inputs;
    void sort(const Inputs& in);
    void gather(Inputs& in);

    PointsLayout layout_{};
    cl::Buffer positions_, receivers_, normals_, surface_normals_, order_;
    float largest_coordinate_ = 0;
};

}  // namespace gnomon
