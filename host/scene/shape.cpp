// SPDX-License-Identifier: MIT
#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <utility>

namespace gnomon::scene {

Shape::Shape(const std::filesystem::path& file, Accessors& accessors, const VertexAccessors& vertices,
             std::span<const double> weights, const std::vector<glm::dmat4>* joints, std::string what)
    : file_(file),
      base_(accessors.elements(vertices.positions)),
      is_float_(base_.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT),
      joints_(vertices.joints.empty() ? nullptr : joints),
      what_(std::move(what)) {
    for (std::size_t i = 0; i < vertices.targets.size() && i < weights.size(); ++i)
        if (weights[i] != 0 && vertices.targets[i] >= 0)
            targets_.push_back({&accessors.elements(vertices.targets[i]), weights[i]});
    if (vertices.normals >= 0) normals_ = &accessors.elements(vertices.normals);
    for (std::size_t i = 0; i < vertices.normal_targets.size() && i < weights.size(); ++i)
        if (normals_ && weights[i] != 0 && vertices.normal_targets[i] >= 0)
            normal_targets_.push_back({&accessors.elements(vertices.normal_targets[i]), weights[i]});
    for (std::size_t i = 0; joints_ && i < vertices.joints.size(); ++i)
        influences_.push_back({&accessors.elements(vertices.joints[i]), &accessors.elements(vertices.weights[i])});
}

glm::dvec3 Shape::operator()(std::size_t vertex) const {
    glm::dvec3 p = base_.double3(vertex);
    for (const auto& [displacement, weight] : targets_) p += weight * displacement->double3(vertex);
    return is_skinned() ? skinned(vertex, p) : p;
}

/// Normals are moved by the matrix of cofactors, the inverse's transpose times the determinant: a mirror turns them
/// around, and the eye's side counts.
Float3 Shape::normal(std::size_t vertex, const Affine& world) const {
    glm::dvec3 n = normals_->double3(vertex);
    for (const auto& [displacement, weight] : normal_targets_) n += weight * displacement->double3(vertex);
    if (!is_skinned() && world.linear == glm::dmat3(1)) return array_of(n);
    const glm::dmat3 m = is_skinned() ? glm::dmat3(blended(vertex)) : world.linear;
    const glm::dvec3 moved = cross(m[1], m[2]) * n.x + cross(m[2], m[0]) * n.y + cross(m[0], m[1]) * n.z;
    const double largest = largest_coordinate(moved);
    return array_of(largest > 0 ? moved / largest : moved);
}

glm::dmat4 Shape::blended(std::size_t vertex) const {
    glm::dmat4 sum(0);
    for (const auto& [joints, joint_weights] : influences_)
        for (int i = 0; i < 4; ++i) {
            const double weight = joint_weights->number(vertex, i);
            const std::uint32_t joint = weight == 0 ? 0 : joints->index(vertex, i);
            if (weight == 0 || joint >= joints_->size()) continue;
            sum += weight * (*joints_)[joint];
        }
    return sum;
}

/// The mean of the joints' images of p. Weights that do not quite add up to 1 are normalized, as the division by w
/// after a projection does it in a rasterizer.
glm::dvec3 Shape::skinned(std::size_t vertex, const glm::dvec3& p) const {
    glm::dvec4 sum(0);
    double weights = 0;
    for (const auto& [joints, joint_weights] : influences_)
        for (int i = 0; i < 4; ++i) {
            const double weight = joint_weights->number(vertex, i);
            if (weight == 0) continue;
            const std::uint32_t joint = joints->index(vertex, i);
            if (joint >= joints_->size())
                fail(file_, "{} names joint {}, but its skin has {}", what_, joint, counted(joints_->size(), "joint"));
            sum += weight * ((*joints_)[joint] * glm::dvec4(p, 1));
            weights += weight;
        }
    return glm::dvec3(sum) / weights;
}

}  // namespace gnomon::scene
