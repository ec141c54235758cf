// SPDX-License-Identifier: MIT
// The nodes' transforms at one time: at rest, or as an animation moves them. World transforms are kept, so that a joint
// costs one product of matrices, wherever it stands in the file.
#pragma once

#include <glm/mat4x4.hpp>
#include <optional>

#include "affine.hpp"
#include "animation.hpp"

namespace gnomon::scene {

/// translation * rotation * scale; each empty one is the identity. `what` names the rotation in an error.
Affine composed(std::span<const double> translation, std::span<const double> rotation_xyzw,
                std::span<const double> scale, const std::filesystem::path& file, const std::string& what);

class Pose {
public:
    /// `parents`: of each node, -1 for a root. `animated` may be empty.
    Pose(const std::filesystem::path& file, const tinygltf::Model& model, const std::vector<int>& parents,
         std::map<int, AnimatedNode> animated)
        : file_(file), model_(model), parents_(parents), animated_(std::move(animated)), worlds_(model.nodes.size()) {}

    /// world_from_node.
    const Affine& world(int node);
    /// One per morph target of the node's mesh: the animation's, else the node's, else the mesh's, else 0.
    std::vector<double> morph_weights(int node) const;
    /// world_from_vertex of each joint of a skin. Throws SceneError.
    std::vector<glm::dmat4> joints(int skin, Accessors& accessors);

private:
    Affine local(int node) const;

    const std::filesystem::path& file_;
    const tinygltf::Model& model_;
    const std::vector<int>& parents_;
    std::map<int, AnimatedNode> animated_;
    std::vector<std::optional<Affine>> worlds_;
};

}  // namespace gnomon::scene
