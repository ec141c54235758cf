// SPDX-License-Identifier: MIT
// Where a primitive's vertices are in one pose: the base positions, plus the morph targets' displacements, moved by the
// skin's joints. Everything is summed in double; the caller rounds once.
#pragma once

#include <glm/mat4x4.hpp>

#include "accessors.hpp"
#include "affine.hpp"

namespace gnomon::scene {

/// The accessors of a primitive's vertices.
struct VertexAccessors {
    int positions = -1;
    std::vector<int> targets;          ///< positions of the morph targets; -1: none
    std::vector<int> joints, weights;  ///< sets of four
    int normals = -1;                  ///< -1: none, or nobody wants them
    std::vector<int> normal_targets;   ///< of the morph targets
};

class Shape {
public:
    /// `weights`: of the morph targets. `joints`: world_from_vertex of each joint, null for an unskinned mesh.
    Shape(const std::filesystem::path& file, Accessors& accessors, const VertexAccessors& vertices,
          std::span<const double> weights, const std::vector<glm::dmat4>* joints, std::string what);

    /// The positions are the file's float32.
    bool has_file_bits() const { return targets_.empty() && !is_skinned() && is_float_; }
    /// Positions are in world space; else in the node's.
    bool is_skinned() const { return joints_ != nullptr; }
    const Elements& base() const { return base_; }
    glm::dvec3 operator()(std::size_t vertex) const;

    bool has_normals() const { return normals_ != nullptr; }
    /// The world's normal, of any length and of either sign. `world`: of an unskinned mesh.
    Float3 normal(std::size_t vertex, const Affine& world) const;

private:
    glm::dmat4 blended(std::size_t vertex) const;
    glm::dvec3 skinned(std::size_t vertex, const glm::dvec3& p) const;

    struct Target {
        const Elements* displacement;
        double weight;
    };
    struct Influences {
        const Elements *joints, *weights;
    };
    const std::filesystem::path& file_;
    const Elements& base_;
    bool is_float_;
    std::vector<Target> targets_, normal_targets_;
    const Elements* normals_ = nullptr;
    std::vector<Influences> influences_;
    const std::vector<glm::dmat4>* joints_;
    std::string what_;
};

}  // namespace gnomon::scene
