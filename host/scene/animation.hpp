// SPDX-License-Identifier: MIT
// glTF animations at one time: keyframes in double, interpolated with GLM.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <optional>

#include "accessors.hpp"

namespace gnomon::scene {

/// What an animation sets in place of a node's own properties.
struct AnimatedNode {
    std::optional<glm::dvec3> translation, scale;
    std::optional<glm::dquat> rotation;
    std::optional<std::vector<double>> weights;  ///< of morph targets
};

/// Morph targets of the node's mesh: the largest count of its primitives.
std::size_t morph_target_count(const tinygltf::Model& model, int node);

class AnimationReader {
public:
    AnimationReader(const std::filesystem::path& file, const tinygltf::Model& model, Accessors& accessors)
        : file_(file), model_(model), accessors_(accessors) {}

    /// The nodes that this animation moves, at this time. Before the first keyframe the first one holds, after the last
    /// the last. Throws SceneError if keyframes are unusable. Adds to `not_supported` what a channel asks beyond
    /// glTF 2.0.
    std::map<int, AnimatedNode> at(int animation, double time_s, std::set<std::string>& not_supported);

private:
    /// The keyframes around a time: from `first` to the next one, at `fraction` of the way.
    struct Interval {
        std::size_t first = 0;
        double fraction = 0, seconds = 0;
        bool is_between = false;
    };
    Interval interval(int input, double time_s, const std::string& what);
    std::vector<double> sample(const tinygltf::AnimationSampler& sampler, double time_s, std::size_t components,
                               bool is_rotation, const std::string& what);

    const std::filesystem::path& file_;
    const tinygltf::Model& model_;
    Accessors& accessors_;
};

}  // namespace gnomon::scene
