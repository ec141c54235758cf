// SPDX-License-Identifier: MIT
// One question of the stress suite: which of these points does this light reach?
#pragma once

#include <memory>
#include <optional>

#include "reference/camera.hpp"
#include "support/cut_out_scenes.hpp"
#include "support/scene_makers.hpp"

namespace stress {

using support::Float3;
using support::Floats;
using support::Light;
using support::Random;

struct Question {
    std::shared_ptr<const Floats> triangles;  ///< shared by consecutive questions, so that trees are built once
    Floats points;
    std::vector<std::uint32_t> receivers{};  ///< one per point, or none
    Light light{};
    std::optional<Float3> eye{};
    /// All points lie strictly inside a closed mesh and the light outside: a lit one is a leak.
    bool is_inside = false;
    /// The points are this camera's, row by row, and the triangles a closed mesh that is star-shaped around the origin:
    /// a point that sees the origin has slipped through a face.
    std::optional<reference::PinholeCamera> star_view{};
    std::shared_ptr<const support::CutOutData> cut_outs{};  ///< shared as the triangles are
};

/// With the question's cut-outs.
inline gnomon::Triangles upload_triangles(const gnomon::Device& device, const Question& question) {
    return question.cut_outs ? gnomon::Triangles::upload(device, *question.triangles, question.cut_outs->cut_outs())
                             : gnomon::Triangles::upload(device, *question.triangles);
}

}  // namespace stress
