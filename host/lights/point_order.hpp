// SPDX-License-Identifier: MIT
// Stage point_order: a copy of points, sorted along a space-filling curve (kernels/lights/point_order.h).
#pragma once

#include "kernels/lights/point_order.h"
#include "query/inputs.hpp"

namespace gnomon {

class SortedPoints {
public:
    SortedPoints() = default;
    /// `normals`: one per point as `normals_at` describes, or null. `earlier`: points of which only the memory is used.
    SortedPoints(const Device& device, const Triangles& triangles, const Points& points, cl_mem normals,
                 const PointLayout& normals_at, SortedPoints earlier);
    /// Every share-th sequence of POINTS_OF_RUN neighbouring points, at least one sequence. The other arguments are the
    /// constructor's.
    SortedPoints sample(std::size_t share, const Device& device, const Triangles& triangles, const Points& points,
                        cl_mem normals, const PointLayout& normals_at) const;

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
    void sort(cl::Session& session, const PointOrderParams& params, const PointInputs& in, cl_mem vertices,
              cl_mem normals);
    void gather(cl::Session& session, PointOrderParams params, const PointInputs& in, cl_mem vertices, cl_mem normals);

    PointsLayout layout_{};
    cl::Buffer positions_, receivers_, normals_, surface_normals_, order_;
    float largest_coordinate_ = 0;
};

}  // namespace gnomon
