// SPDX-License-Identifier: MIT
#include "pose.hpp"

#include <algorithm>

namespace gnomon::scene {
namespace {

/// glTF requires unit quaternions, but decimals are rarely exact: 2/|q|^2 instead of 2 gives a pure rotation for
/// every q.
glm::dmat3 rotation_matrix(std::span<const double> q, const std::filesystem::path& file, const std::string& what) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double length_squared = x * x + y * y + z * z + w * w;
    if (!(length_squared > 1e-12 && length_squared < 1e12))
        fail(file, "the rotation of " + what + " is no unit quaternion");
    const double s = 2 / length_squared;
    return {{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
            {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
            {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}};
}

glm::dmat4 matrix_of(const Affine& a) {
    glm::dmat4 m(a.linear);
    m[3] = glm::dvec4(a.translation, 1);
    return m;
}

}  // namespace

Affine composed(std::span<const double> translation, std::span<const double> rotation_xyzw,
                std::span<const double> scale, const std::filesystem::path& file, const std::string& what) {
    Affine out;
    if (!rotation_xyzw.empty()) out.linear = rotation_matrix(rotation_xyzw, file, what);
    for (int column = 0; column < 3 && !scale.empty(); ++column) out.linear[column] *= scale[std::size_t(column)];
    if (!translation.empty()) out.translation = loaded(translation.data());
    return out;
}

Affine Pose::local(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    const std::string what = "node " + (node.name.empty() ? std::to_string(index) : in_quotes(node.name));
    if (!node.matrix.empty()) {
        const double* m = node.matrix.data();
        return {{loaded(m), loaded(m + 4), loaded(m + 8)}, loaded(m + 12)};
    }
    const auto moved = animated_.find(index);
    if (moved == animated_.end()) return composed(node.translation, node.rotation, node.scale, file_, what);
    const auto& [translation, scale, rotation, weights] = moved->second;
    std::vector<double> t = node.translation, r = node.rotation, s = node.scale;
    if (translation) t = {translation->x, translation->y, translation->z};
    if (rotation) r = {rotation->x, rotation->y, rotation->z, rotation->w};
    if (scale) s = {scale->x, scale->y, scale->z};
    return composed(t, r, s, file_, what);
}

/// With a stack of its own: a hierarchy may be a million nodes deep.
const Affine& Pose::world(int node) {
    std::vector<int> open;
    for (int n = node; n >= 0 && !worlds_[std::size_t(n)]; n = parents_[std::size_t(n)]) open.push_back(n);
    for (; !open.empty(); open.pop_back()) {
        const int n = open.back(), parent = parents_[std::size_t(n)];
        worlds_[std::size_t(n)] = (parent < 0 ? Affine{} : *worlds_[std::size_t(parent)]) * local(n);
    }
    return *worlds_[std::size_t(node)];
}

std::vector<double> Pose::morph_weights(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    std::vector<double> weights = model_.meshes[std::size_t(node.mesh)].weights;
    if (!node.weights.empty()) weights = node.weights;
    if (const auto moved = animated_.find(index); moved != animated_.end() && moved->second.weights)
        weights = *moved->second.weights;
    weights.resize(morph_target_count(model_, index));
    return weights;
}

std::vector<glm::dmat4> Pose::joints(int index, Accessors& accessors) {
    const tinygltf::Skin& skin = model_.skins[std::size_t(index)];
    const std::string what = fmt::format("skins[{}]", index);
    const Elements* inverse_bind = nullptr;
    if (const int matrices = skin.inverseBindMatrices; matrices >= 0) {
        accessors.require(matrices, TINYGLTF_TYPE_MAT4, std::array{TINYGLTF_COMPONENT_TYPE_FLOAT},
                          "the inverse bind matrices of " + what, "MAT4 of float");
        inverse_bind = &accessors.elements(matrices);
        if (inverse_bind->count < skin.joints.size())
            fail(file_, "{} has {}, but only {} inverse bind matrices", what, counted(skin.joints.size(), "joint"),
                 inverse_bind->count);
    }
    std::vector<glm::dmat4> out;
    for (std::size_t joint = 0; joint < skin.joints.size(); ++joint) {
        glm::dmat4 from_bind(1);
        for (int i = 0; inverse_bind && i < 16; ++i) from_bind[i / 4][i % 4] = inverse_bind->number(joint, i);
        out.push_back(matrix_of(world(skin.joints[joint])) * from_bind);
    }
    return out;
}

}  // namespace gnomon::scene
