// SPDX-License-Identifier: MIT
// What of a glTF file is drawn: its primitives, planned from their descriptions alone (part_planner.cpp) and then
// written as triangles (triangle_writer.cpp). Both read the open file, and share the plan.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "accessors.hpp"
#include "affine.hpp"
#include "gltf.hpp"
#include "images.hpp"
#include "pose.hpp"
#include "scene.hpp"
#include "shape.hpp"

namespace gnomon::scene {

/// How sentences name the parts of a file.
struct PartNames {
    const tinygltf::Model& model;

    static std::string text_of(const char* kind, const std::string& name, int index) {
        return kind + (name.empty() ? std::to_string(index) : in_quotes(name));
    }
    std::string mesh(int mesh) const { return text_of("mesh ", model.meshes[std::size_t(mesh)].name, mesh); }
    std::string node(int node) const { return text_of("node ", model.nodes[std::size_t(node)].name, node); }
    std::string material(int material) const {
        return text_of("material ", model.materials[std::size_t(material)].name, material);
    }
    std::string part(int mesh, int primitive) const {
        return fmt::format("primitive {} of {}", primitive, this->mesh(mesh));
    }
};

/// A file that is being read. It outlives whoever takes it.
struct OpenFile {
    const std::filesystem::path& path;
    const GltfDocument& document;
    Accessors& accessors;  ///< each decoded once
    Images& images;
    BlendCasters blend;
};

enum class Topology { triangles, strip, fan };

/// A drawn primitive, before its data are read.
struct Part {
    int primitive = 0;
    VertexAccessors vertices;
    int index_accessor = -1;  ///< -1: vertices in order
    Topology topology = Topology::triangles;
    std::uint64_t triangle_count = 0;
    std::uint32_t material = 0;
    std::uint32_t cut_out = no_cut_out;  ///< of the scene's cut-outs
    int coordinates = -1;                ///< accessor of the texture coordinates
    int alphas = -1, colors = -1;        ///< accessor of the vertices' colours, where their alpha or colour is taken
    const MaterialSource* transform = nullptr;  ///< of the texture coordinates
};

/// A mesh under a node, drawn `count` times (EXT_mesh_gpu_instancing; else once).
struct Instance {
    int node = 0;
    Affine world_from_node;
    std::size_t count = 1;
};

inline constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// The types that glTF allows for coordinates, quantized ones included.
inline constexpr std::array position_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT,
                                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

/// The parts of all meshes that were drawn so far, and what they share. Every time of an animation has the same.
struct PartPlan {
    std::map<int, std::vector<Part>> parts;  ///< of meshes
    bool uses_default_material = false;
    SceneCutOuts cut_outs;  ///< materials and textures
    std::map<int, std::uint32_t> alpha_of_image;
    std::map<int, ColorTextureUse> texture_uses;  ///< of materials
    bool has_corner_alphas = false, has_corner_colors = false, has_corner_normals = false;
    std::set<std::string> phrases;
    std::map<std::pair<std::string, std::string>, std::set<std::string>> parts_of_phrase;  ///< what and why: of what
    std::vector<std::string> points_and_lines, without_positions, incomplete;

    bool has_coordinates() const { return !cut_outs.materials.empty() || !texture_uses.empty(); }
};

/// Adds the parts of a mesh, unless the plan has it. Throws SceneError.
void plan_mesh(const OpenFile& from, int mesh, PartPlan& plan);

/// What triangles are written from. The plan has the meshes of all instances.
struct TriangleSources {
    const OpenFile& file;
    const PartPlan& plan;
    const std::vector<Instance>& instances;
    Pose& pose;
};
/// What became of triangles that were written.
struct WrittenTriangles {
    std::size_t not_finite_count = 0, unusable_coordinates = 0;
    std::vector<std::string> not_finite, moved;  ///< of which meshes
    std::set<std::string> not_supported;
};
/// Writes the scene's triangles, and what belongs to each. Throws SceneError.
WrittenTriangles write_triangles(const TriangleSources& from, Scene& scene);
/// Writes the scene's triangles once more, in double.
void write_doubles(const TriangleSources& from, Scene& scene);

}  // namespace gnomon::scene
