// SPDX-License-Identifier: MIT
// Plans the primitives of a mesh from their descriptions: which accessors each takes, checked, and what decides its
// alpha and its colours. No data but images are read.
#include <algorithm>
#include <optional>

#include "parts.hpp"

namespace gnomon::scene {
namespace {

constexpr std::array joint_types{TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
constexpr std::array weight_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                  TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

class PartPlanner {
public:
    PartPlanner(const OpenFile& from, PartPlan& plan) : from_(from), plan_(plan) {}

    std::optional<Part> plan_part(int mesh, int index) {
        const tinygltf::Primitive& primitive = model_.meshes[mesh].primitives[index];
        const std::string what = names_.part(mesh, index);
        if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
            plan_.points_and_lines.push_back(what +
                                             (primitive.mode == TINYGLTF_MODE_POINTS ? " (points)" : " (lines)"));
            return std::nullopt;
        }
        const auto attribute = primitive.attributes.find("POSITION");
        const bool is_draco = primitive.extensions.contains("KHR_draco_mesh_compression");
        if (attribute == primitive.attributes.end()) {
            if (is_draco) fail_draco(what);
            plan_.without_positions.push_back(what);
            return std::nullopt;
        }
        Part part;
        part.primitive = index;
        part.index_accessor = primitive.indices;
        const tinygltf::Accessor& positions = model_.accessors[std::size_t(attribute->second)];
        if (is_draco && !has_draco) {
            const bool has_indices = primitive.indices < 0 || model_.accessors[primitive.indices].bufferView >= 0;
            if (positions.bufferView < 0 || !has_indices) fail_draco(what);
            plan_.phrases.insert("KHR_draco_mesh_compression (the uncompressed data is read)");
        }
        part.vertices = vertex_accessors(primitive, attribute->second, what);
        std::uint64_t corners = positions.count;
        if (part.index_accessor >= 0) {
            check_index_accessor(part.index_accessor, what);
            corners = model_.accessors[part.index_accessor].count;
        }
        part.topology = primitive.mode == TINYGLTF_MODE_TRIANGLES        ? Topology::triangles
                        : primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ? Topology::strip
                                                                         : Topology::fan;
        const bool is_list = part.topology == Topology::triangles;
        part.triangle_count = is_list ? corners / 3 : corners - std::min<std::uint64_t>(corners, 2);
        if (is_list ? corners % 3 != 0 : corners < 3) plan_.incomplete.push_back(what);
        part.material = use_material(primitive.material);
        plan_cut_out(primitive, what, part);
        if (images_.has_colors()) plan_colors(primitive, what, part);
        return part;
    }

private:
    [[noreturn]] void fail_draco(const std::string& what) const {
        fail(file_, what +
                        " is compressed with KHR_draco_mesh_compression and has no uncompressed data; export without "
                        "compression");
    }

    VertexAccessors vertex_accessors(const tinygltf::Primitive& primitive, int positions, const std::string& what) {
        VertexAccessors out;
        const auto checked = [&](int accessor, int type, std::span<const int> types, const std::string& thing,
                                 const char* wanted) {
            accessors_.require(accessor, type, types, thing + what, wanted);
            if (accessors_.count(accessor) < accessors_.count(positions))
                fail(file_, "{}{} ({}) are {} for {}", thing, what, Accessors::text(accessor),
                     accessors_.count(accessor), counted(accessors_.count(positions), "position"));
            return accessor;
        };
        out.positions = checked(positions, TINYGLTF_TYPE_VEC3, position_types, "the positions of ", "VEC3");
        for (std::size_t i = 0; i < primitive.targets.size(); ++i) {
            const auto target = primitive.targets[i].find("POSITION");
            out.targets.push_back(target == primitive.targets[i].end()
                                      ? -1
                                      : checked(target->second, TINYGLTF_TYPE_VEC3, position_types,
                                                fmt::format("the positions of morph target {} of ", i), "VEC3"));
        }
        for (int set = 0;; ++set) {
            const auto joints = primitive.attributes.find(fmt::format("JOINTS_{}", set));
            const auto weights = primitive.attributes.find(fmt::format("WEIGHTS_{}", set));
            if (joints == primitive.attributes.end() || weights == primitive.attributes.end()) return out;
            out.joints.push_back(checked(joints->second, TINYGLTF_TYPE_VEC4, joint_types, "the joints of ",
                                         "VEC4 of unsigned bytes or shorts"));
            out.weights.push_back(checked(weights->second, TINYGLTF_TYPE_VEC4, weight_types, "the weights of ",
                                          "VEC4 of float or of normalized unsigned bytes or shorts"));
        }
    }

    void check_index_accessor(int index, const std::string& what) const {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const bool is_unsigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                 accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                 accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned)
            fail(file_,
                 "the indices of " + what + " (" + Accessors::text(index) + ") are not unsigned bytes, shorts or ints");
        accessors_.require(index, accessor.type, std::array{accessor.componentType}, "", "");
        if (accessor.bufferView < 0) return;
        const std::size_t stride = model_.bufferViews[accessor.bufferView].byteStride;
        if (stride != 0 && stride != element_bytes(accessor))
            fail(file_, "the indices of {} ({}) have a byteStride of {}; indices must be packed", what,
                 Accessors::text(index), stride);
    }

    std::uint32_t use_material(int material) {
        if (material < 0) {
            plan_.uses_default_material = true;
            return std::uint32_t(model_.materials.size());
        }
        return std::uint32_t(material);
    }

    /// The alpha of an image, which is loaded once. Nothing if it cannot be read.
    std::optional<std::uint32_t> alpha_of(int material, const MaterialSource& mask) {
        const auto refuse = [&](const std::string& why) {
            say_of(names_.material(material), "alphaMode " + std::string(mask.is_blend ? "BLEND" : "MASK"),
                   "drawn opaque: " + why);
            return std::nullopt;
        };
        if (mask.image < 0) return refuse(mask.unreadable);
        if (const auto found = plan_.alpha_of_image.find(mask.image); found != plan_.alpha_of_image.end())
            return found->second;
        try {
            plan_.cut_outs.textures.push_back(images_.alpha(mask.image));
        } catch (const std::exception& error) {
            return refuse(why_unreadable(error));
        }
        return plan_.alpha_of_image[mask.image] = std::uint32_t(plan_.cut_outs.textures.size() - 1);
    }

    std::string why_unreadable(const std::exception& error) const {
        const std::string what = error.what(), prefix = file_.string() + ": ";
        return "its image cannot be read: " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what);
    }

    std::uint32_t add_cut_out(const CutOutMaterial& material) {
        plan_.cut_outs.materials.push_back(material);
        return std::uint32_t(plan_.cut_outs.materials.size() - 1);
    }

    /// Which accessors a part's alpha takes, and what decides it.
    void plan_cut_out(const tinygltf::Primitive& primitive, const std::string& what, Part& part) {
        const auto found = materials_.find(primitive.material);
        if (found == materials_.end()) return;
        const MaterialSource& mask = found->second;
        if (mask.transmits && !mask.is_blend) plan_.phrases.insert("KHR_materials_transmission (drawn opaque)");
        if (!mask.is_mask && !mask.is_blend) return;
        if (!images_.has_alpha()) {  // the caller takes no cut-outs
            plan_.phrases.insert("alphaMode " + std::string(mask.is_blend ? "BLEND" : "MASK") + " (drawn opaque)");
            return;
        }
        if (mask.is_blend && from_.blend == BlendCasters::opaque) {
            plan_.phrases.insert("alphaMode BLEND (drawn opaque; --blend clear or mask)");
            return;
        }
        CutOutMaterial material{.wrap_u = mask.wrap_u,
                                .wrap_v = mask.wrap_v,
                                .filter = mask.filter,
                                .cutoff = mask.cutoff,
                                .alpha_factor = mask.alpha_factor};
        if (mask.is_blend && from_.blend == BlendCasters::clear) material.cutoff = 2;
        const std::size_t vertices = accessors_.count(part.vertices.positions);
        if (mask.has_texture && material.cutoff <= 1) {
            const auto accessor = primitive.attributes.find(fmt::format("TEXCOORD_{}", mask.coordinates));
            if (accessor != primitive.attributes.end()) {
                const auto texture = alpha_of(primitive.material, mask);
                if (!texture) return;
                material.texture = *texture;
                part.coordinates = accessor->second;
                accessors_.require(part.coordinates, TINYGLTF_TYPE_VEC2, position_types,
                                   "the texture coordinates of " + what, "VEC2");
            }
        }
        if (const auto colors = primitive.attributes.find("COLOR_0");
            colors != primitive.attributes.end() &&
            model_.accessors[std::size_t(colors->second)].type == TINYGLTF_TYPE_VEC4) {
            part.alphas = colors->second;
            accessors_.require(part.alphas, TINYGLTF_TYPE_VEC4, weight_types, "the colours of " + what,
                               "VEC4 of float or of normalized unsigned bytes or shorts");
        }
        for (const int accessor : {part.coordinates, part.alphas})
            if (accessor >= 0 && accessors_.count(accessor) < vertices)
                fail(file_, "{} of {} has {} for {}", Accessors::text(accessor), what, accessors_.count(accessor),
                     counted(vertices, "position"));
        part.cut_out = add_cut_out(material);
        part.transform = &mask;
        plan_.has_corner_alphas = plan_.has_corner_alphas || part.alphas >= 0;
    }

    /// An attribute that only the picture needs: -1 where the primitive has none, or one that cannot be used.
    int picture_attribute(const tinygltf::Primitive& primitive, const std::string& name, std::span<const int> types,
                          std::span<const int> component_types, const std::string& what) {
        const auto found = primitive.attributes.find(name);
        if (found == primitive.attributes.end()) return -1;
        const int accessor = found->second, type = model_.accessors[std::size_t(accessor)].type;
        const bool has_type = std::ranges::find(types, type) != types.end();
        const bool is_long_enough = accessors_.count(accessor) >= accessors_.count(part_positions(primitive));
        try {
            if (has_type && is_long_enough) {
                accessors_.require(accessor, type, component_types, name + " of " + what, "of a type that glTF allows");
                return accessor;
            }
        } catch (const SceneError&) {  // the phrase says it
        }
        say_of(what, name, "ignored: of the wrong type or length");
        return -1;
    }

    static int part_positions(const tinygltf::Primitive& primitive) { return primitive.attributes.at("POSITION"); }

    /// What a part's picture takes: texture, vertex colours, normals.
    void plan_colors(const tinygltf::Primitive& primitive, const std::string& what, Part& part) {
        constexpr std::array color_types{TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};
        constexpr std::array pair{TINYGLTF_TYPE_VEC2};
        constexpr std::array vector{TINYGLTF_TYPE_VEC3};
        part.colors = picture_attribute(primitive, "COLOR_0", color_types, weight_types, what);
        part.vertices.normals = picture_attribute(primitive, "NORMAL", vector, position_types, what);
        for (const auto& target : primitive.targets) {
            const auto normal = target.find("NORMAL");
            const bool is_usable = part.vertices.normals >= 0 && normal != target.end() &&
                                   model_.accessors[std::size_t(normal->second)].type == TINYGLTF_TYPE_VEC3 &&
                                   accessors_.count(normal->second) >= accessors_.count(part.vertices.positions);
            part.vertices.normal_targets.push_back(is_usable ? normal->second : -1);
        }
        plan_.has_corner_colors = plan_.has_corner_colors || part.colors >= 0;
        plan_.has_corner_normals = plan_.has_corner_normals || part.vertices.normals >= 0;
        const auto found = materials_.find(primitive.material);
        if (found == materials_.end() || !found->second.has_texture) return;
        const MaterialSource& source = found->second;
        const std::string coordinates = fmt::format("TEXCOORD_{}", source.coordinates);
        if (part.coordinates < 0)
            part.coordinates = picture_attribute(primitive, coordinates, pair, position_types, what);
        if (part.coordinates < 0) return;
        part.transform = &source;
        use_texture(primitive.material, source);
    }

    void use_texture(int material, const MaterialSource& source) {
        const auto refuse = [&](const std::string& why) {
            say_of(names_.material(material), "the base colour texture", "left out: " + why);
        };
        if (plan_.texture_uses.contains(material)) return;
        ColorTextureUse& use = plan_.texture_uses[material];
        if (source.image < 0) return refuse(source.unreadable);
        try {
            use.texture = images_.colors(source.image);
        } catch (const std::exception& error) {
            return refuse(why_unreadable(error));
        }
        use.wrap_u = source.wrap_u;
        use.wrap_v = source.wrap_v;
        use.filter = source.filter;
        use.minification = source.minification;
        use.weigh_by_alpha = source.is_mask || source.is_blend;
    }

    /// A phrase on one of the file's parts; those that differ in the part alone become one with their number.
    void say_of(const std::string& part, const std::string& what, const std::string& why) {
        plan_.parts_of_phrase[{what, why}].insert(part);
    }

    const OpenFile& from_;
    PartPlan& plan_;
    const std::filesystem::path& file_ = from_.path;
    const tinygltf::Model& model_ = from_.document.model;
    const std::map<int, MaterialSource>& materials_ = from_.document.materials.materials;
    const Accessors& accessors_ = from_.accessors;
    Images& images_ = from_.images;
    const PartNames names_{model_};
};

}  // namespace

void plan_mesh(const OpenFile& from, int mesh, PartPlan& plan) {
    if (plan.parts.contains(mesh)) return;
    std::vector<Part>& parts = plan.parts[mesh];
    PartPlanner planner(from, plan);
    for (int i = 0; i < int(from.document.model.meshes[std::size_t(mesh)].primitives.size()); ++i)
        if (std::optional<Part> part = planner.plan_part(mesh, i)) parts.push_back(*part);
}

}  // namespace gnomon::scene
