// SPDX-License-Identifier: MIT
// Where shading points come from: each maker adds about `count` points (and receivers, where they have one) to a
// question that has its triangles and its light.
#pragma once

#include <functional>

#include <gnomon.hpp>
#include "question.hpp"

namespace stress {

struct Viewpoint {
    Float3 eye{}, target{}, up{0, 1, 0};
    double fov_y_degrees = 50;
};

/// What a case is about.
struct Subject {
    std::shared_ptr<const Floats> triangles;
    std::vector<Light> lights;
    std::vector<Viewpoint> views{};
    double reach = 2;  ///< how far from a triangle its shadow is looked for
    double scale = 1;  ///< of what was made in the unit cube, and where it was put
    std::array<double, 3> offset{};
    std::shared_ptr<const support::CutOutData> cut_outs{};  ///< of the triangles; null: all are opaque
};

struct PointRequest {
    const gnomon::Device& device;
    const Subject& subject;
    std::size_t count = 0;
    std::uint64_t variant = 0;
    Random& random;
};

using MakePoints = std::function<void(const PointRequest&, Question&)>;

/// In the subject's cube [-1.2, 1.2]^3.
void points_in_the_cube(const PointRequest&, Question&);
/// Beside vertices, edges and insides of triangles, at all distances from nothing to the triangle's size; half of them
/// with that triangle as their receiver.
void points_near_triangles(const PointRequest&, Question&);
/// On the light's rays through vertices, edges and insides, to the last ulp and an ulp beside.
void points_on_rays(const PointRequest&, Question&);
/// On the middles and corners of a lattice whose cells are `scale` wide, in the subject's bounds and a cell around.
void points_on_lattice(const PointRequest&, Question&);
/// Exactly on the ray through a vertex or the middle of an edge, for whole numbers below 2^16.
void points_exactly_behind(const PointRequest&, Question&);
/// What a camera sees, with receivers and eye: the subject's views, then random ones.
void points_of_a_view(const PointRequest&, Question&);

/// A camera's points of that very size, row by row; the sky is absent.
void add_view(const gnomon::Device& device, const Viewpoint& from, std::uint32_t width, std::uint32_t height,
              Question& question);

}  // namespace stress
