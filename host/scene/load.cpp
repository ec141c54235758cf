// SPDX-License-Identifier: MIT
// From a checked glTF document to world triangles: walk the nodes (in the file's order, which is the triangles' order),
// count all elements, refuse a scene that cannot fit into memory, then decode each accessor once and write the
// triangles. A position is p = world_from_node * p_node in double, rounded to float32 once; so is a morphed, skinned or
// quantized one. Where this moves vertices visibly, the doubles are written, too, for a caller who wants them. The
// document and its decoded accessors serve every time of an animation.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "accessors.hpp"
#include "affine.hpp"
#include "animation.hpp"
#include "extent.hpp"
#include "gltf.hpp"
#include "images.hpp"
#include "pose.hpp"
#include "scene.hpp"
#include "shape.hpp"

namespace gnomon::scene {
namespace {

/// Colour of a primitive without a material: a light grey, so that light and shade differ from white.
constexpr Float3 default_base_color{0.8f, 0.8f, 0.8f};

/// An accessor without a bufferView is all zeros and costs a file nothing, whatever its count. The drawn accessors
/// without a bufferView may have this many elements in all (a real one is a base for sparse values).
constexpr std::uint64_t max_elements_without_data = std::uint64_t(1) << 24;

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

/// Where the instances of EXT_mesh_gpu_instancing stand in their node; each may be absent.
struct InstanceTransforms {
    const Elements *translation = nullptr, *rotation = nullptr, *scale = nullptr;
};

constexpr std::array position_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                                    TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT,
                                    TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
constexpr std::array joint_types{TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
constexpr std::array weight_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                  TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
constexpr std::array rotation_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                                    TINYGLTF_COMPONENT_TYPE_SHORT};
constexpr std::array float_types{TINYGLTF_COMPONENT_TYPE_FLOAT};
constexpr std::array animated_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                                    TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT,
                                    TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// Saturating: a count that does not fit is "too many", never small again.
std::uint64_t plus(std::uint64_t a, std::uint64_t b) {
    return b > std::numeric_limits<std::uint64_t>::max() - a ? std::numeric_limits<std::uint64_t>::max() : a + b;
}

std::uint64_t times(std::uint64_t a, std::uint64_t b) {
    return a != 0 && b > std::numeric_limits<std::uint64_t>::max() / a ? std::numeric_limits<std::uint64_t>::max()
                                                                       : a * b;
}

std::string name_or(const std::string& first, const std::string& second, std::string_view kind, std::size_t number) {
    if (!first.empty()) return first;
    if (!second.empty()) return second;
    return fmt::format("{} {}", kind, number);
}

std::uint64_t machine_memory_bytes() {
    return std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE));
}

/// What one scene is made of; the Loader makes a new one for every time.
struct Work {
    Scene scene;
    std::vector<Instance> instances;
    std::set<std::string> not_supported;
    std::size_t not_finite_count = 0;
    std::size_t unusable_coordinates = 0;
    std::vector<std::string> orthographic, unusable, not_finite, moved;
};

class Loader {
public:
    Loader(const std::filesystem::path& file, const LoadOptions& options)
        : file_(file),
          memory_bytes_(options.memory_bytes != 0 ? options.memory_bytes : machine_memory_bytes()),
          document_(read_document(file_, options.scene, memory_bytes_)),
          model_(document_.model),
          accessors_(file_, model_),
          blend_(options.blend),
          keeps_doubles_(options.keeps_doubles),
          images_(file_, model_, document_.materials.images, options, memory_bytes_) {
        if (options.animation) animation_ = int(chosen_animation(*options.animation));
    }

    Scene at(std::optional<double> time_s) {
        work_ = {};
        work_.not_supported = document_.not_supported;
        describe_animations(time_s);
        Pose pose(file_, model_, document_.parents, animated_nodes(time_s));
        walk(pose);
        plan_parts();
        const std::uint64_t needed_bytes = check_amount();
        make_materials();
        write_triangles(pose);
        if (keeps_doubles_ && !work_.moved.empty()) write_doubles(pose, needed_bytes);
        if (!keeps_doubles_) check_places();
        warn();
        return std::move(work_.scene);
    }

private:
    // ---- animations ----

    std::vector<std::string> animation_names() const {
        std::vector<std::string> names;
        for (const tinygltf::Animation& animation : model_.animations) names.push_back(animation.name);
        return names;
    }

    /// The largest time that the accessors of the animation's keyframes declare.
    double end_of(const tinygltf::Animation& animation) const {
        double end_s = 0;
        for (const tinygltf::AnimationSampler& sampler : animation.samplers) {
            if (sampler.input < 0 || std::size_t(sampler.input) >= model_.accessors.size()) continue;
            for (const double most : model_.accessors[std::size_t(sampler.input)].maxValues)
                if (std::isfinite(most)) end_s = std::max(end_s, most);
        }
        return end_s;
    }

    std::size_t chosen_animation(const std::string& name) const {
        return find_named(file_, animation_names(), name, "animation");
    }

    /// The accessors of an animation have the types that the reader expects, and few enough elements.
    void check_animation(int index) {
        const tinygltf::Animation& animation = model_.animations[std::size_t(index)];
        for (std::size_t i = 0; i < animation.samplers.size(); ++i) {
            const auto& [input, output] = std::pair(animation.samplers[i].input, animation.samplers[i].output);
            const std::string what = fmt::format("animations[{}].samplers[{}]", index, i);
            accessors_.require(input, TINYGLTF_TYPE_SCALAR, float_types, "the times of " + what, "SCALAR of float");
            accessors_.require(output, model_.accessors[std::size_t(output)].type, animated_types,
                               "the values of " + what, "floats or normalized integers");
            animation_accessors_.insert({input, output});
        }
    }

    std::map<int, AnimatedNode> animated_nodes(std::optional<double> time_s) {
        if (!time_s && animation_ < 0) return {};
        if (time_s && std::isnan(*time_s)) fail(file_, "cannot be shown at a time that is no number");
        if (model_.animations.empty()) fail(file_, "has no animations, so that it cannot be shown at a time");
        const int index = std::max(animation_, 0);
        if (animation_accessors_.empty()) check_animation(index);
        check_amount();
        return AnimationReader(file_, model_, accessors_).at(index, time_s.value_or(0), work_.not_supported);
    }

    void describe_animations(std::optional<double> time_s) {
        const std::vector<std::string> names = animation_names();
        for (std::size_t i = 0; i < names.size(); ++i)
            work_.scene.animations.push_back(names[i].empty() ? fmt::format("animation {}", i) : names[i]);
        for (const tinygltf::Animation& animation : model_.animations)
            work_.scene.animation_ends_s.push_back(end_of(animation));
        if (!names.empty() && (time_s || animation_ >= 0))
            work_.scene.animation = work_.scene.animations[std::size_t(std::max(animation_, 0))];
    }

    // ---- names ----

    static std::string text_of(const char* kind, const std::string& name, int index) {
        return kind + (name.empty() ? std::to_string(index) : in_quotes(name));
    }
    std::string mesh_text(int mesh) const { return text_of("mesh ", model_.meshes[mesh].name, mesh); }
    std::string node_text(int node) const { return text_of("node ", model_.nodes[node].name, node); }
    std::string part_text(int mesh, int primitive) const {
        return fmt::format("primitive {} of {}", primitive, mesh_text(mesh));
    }
    static std::string accessor_text(int accessor) { return Accessors::text(accessor); }

    // ---- nodes ----

    /// Depth first, children in order, with a stack of our own: a hierarchy may be a million nodes deep.
    void walk(Pose& pose) {
        struct Open {
            int node;
            bool is_visible;
        };
        std::vector<Open> open;
        const auto add = [&open](const std::vector<int>& nodes, bool is_visible) {
            for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) open.push_back({*node, is_visible});
        };
        add(document_.root_nodes, true);
        while (!open.empty()) {
            const Instance visit{open.back().node, pose.world(open.back().node)};
            const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
            const bool is_visible = open.back().is_visible && shows(node);
            open.pop_back();
            if (node.mesh >= 0 && is_visible) add_mesh(visit);
            if (node.camera >= 0) add_camera(visit);
            if (node.extensions.contains("KHR_lights_punctual") && is_visible) add_light(visit);
            add(node.children, is_visible);
        }
    }

    /// KHR_node_visibility hides a node's mesh and light, and those of all nodes below it.
    static bool shows(const tinygltf::Node& node) {
        const auto found = node.extensions.find("KHR_node_visibility");
        return found == node.extensions.end() || !found->second.Has("visible") ||
               found->second.Get("visible").Get<bool>();
    }

    void add_mesh(Instance visit) {
        const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
        if (const auto it = node.extensions.find(instancing); it != node.extensions.end())
            visit.count = check_instances(visit.node, it->second.Get("attributes"));
        if (visit.count != 1 && node.skin >= 0)
            work_.not_supported.insert("instances of a skinned mesh (all stand where its joints are)");
        work_.instances.push_back(visit);
    }

    /// The number of instances. Their accessors are read later, once the triangles are known to fit into memory.
    std::size_t check_instances(int node, const tinygltf::Value& attributes) {
        std::optional<std::size_t> count;
        for (const std::string& name : attributes.Keys()) {
            const int accessor = attributes.Get(name).GetNumberAsInt();
            const std::string what = "the instances' " + word_or_quotes(name) + " of " + node_text(node);
            if (name == "ROTATION")
                accessors_.require(accessor, TINYGLTF_TYPE_VEC4, rotation_types, what,
                                   "VEC4 of float or of normalized bytes or shorts");
            else if (name == "TRANSLATION" || name == "SCALE")
                accessors_.require(accessor, TINYGLTF_TYPE_VEC3, float_types, what, "VEC3 of float");
            if (count && *count != accessors_.count(accessor))
                fail(file_, "{} are {}, but another attribute has {}", what, accessors_.count(accessor), *count);
            count = accessors_.count(accessor);
            if (name == "ROTATION" || name == "TRANSLATION" || name == "SCALE") other_accessors_.insert(accessor);
        }
        return count.value_or(1);
    }

    InstanceTransforms instance_transforms(int node) {
        const auto it = model_.nodes[std::size_t(node)].extensions.find(instancing);
        if (it == model_.nodes[std::size_t(node)].extensions.end()) return {};
        const tinygltf::Value& attributes = it->second.Get("attributes");
        const auto elements = [&](const char* name) {
            return attributes.Has(name) ? &accessors_.elements(attributes.Get(name).GetNumberAsInt()) : nullptr;
        };
        return {elements("TRANSLATION"), elements("ROTATION"), elements("SCALE")};
    }

    Affine instance_transform(const InstanceTransforms& from, std::size_t i, int node) const {
        std::vector<double> t, r, s;
        for (int k = 0; k < 3 && from.translation; ++k) t.push_back(from.translation->number(i, k));
        for (int k = 0; k < 4 && from.rotation; ++k) r.push_back(from.rotation->number(i, k));
        for (int k = 0; k < 3 && from.scale; ++k) s.push_back(from.scale->number(i, k));
        return composed(t, r, s, file_, fmt::format("instance {} of {}", i, node_text(node)));
    }

    void add_camera(const Instance& visit) {
        const tinygltf::Node& node = model_.nodes[visit.node];
        const tinygltf::Camera& source = model_.cameras[node.camera];
        NamedCamera named{name_or(node.name, source.name, "camera", std::size_t(node.camera)), {}, node.camera};
        if (source.type == "orthographic") {
            work_.orthographic.push_back(in_quotes(named.name));
            return;
        }
        // A camera looks along its node's -Z with +Y up; scaling has no meaning for it.
        glm::dvec3 forward = -visit.world_from_node.linear[2], up = visit.world_from_node.linear[1], right{};
        const bool is_usable = make_unit(forward) && make_unit(up) && make_unit(right = cross(forward, up));
        named.camera.eye = array_of(visit.world_from_node.translation);
        named.eye = array_of<double>(visit.world_from_node.translation);
        if (!is_usable || !is_finite(named.camera.eye)) {
            work_.unusable.push_back("camera " + in_quotes(named.name));
            return;
        }
        named.camera.right = array_of<double>(right);
        named.camera.forward = array_of<double>(forward);
        named.camera.up = array_of<double>(cross(right, forward));
        named.camera.fov_y_radians = source.perspective.yfov;
        work_.scene.cameras.push_back(std::move(named));
    }

    void add_light(const Instance& visit) {
        const tinygltf::Node& node = model_.nodes[visit.node];
        const int index = node.extensions.at("KHR_lights_punctual").Get("light").GetNumberAsInt();
        const tinygltf::Light& source = model_.lights[index];
        NamedLight named{name_or(node.name, source.name, "light", std::size_t(index)), source.type, {}, index};
        const bool is_directional = source.type == "directional";
        // Light travels along the node's -Z.
        const Affine& world = visit.world_from_node;
        const Float3 v = array_of(is_directional ? -world.linear[2] : world.translation);
        if (!is_finite(v) || (is_directional && v == Float3{0, 0, 0})) {
            work_.unusable.push_back("light " + in_quotes(named.name));
            return;
        }
        named.light = is_directional ? Light::directional(v) : Light::point(v);
        named.position = array_of<double>(world.translation);
        work_.scene.lights.push_back(std::move(named));
    }

    // ---- primitives: what will be drawn, from their descriptions alone ----

    void plan_parts() {
        for (const Instance& instance : work_.instances) {
            const int mesh = model_.nodes[instance.node].mesh;
            if (parts_.contains(mesh)) continue;
            std::vector<Part>& parts = parts_[mesh];
            for (int i = 0; i < int(model_.meshes[mesh].primitives.size()); ++i)
                if (std::optional<Part> part = plan_part(mesh, i)) parts.push_back(*part);
        }
    }

    std::optional<Part> plan_part(int mesh, int index) {
        const tinygltf::Primitive& primitive = model_.meshes[mesh].primitives[index];
        const std::string what = part_text(mesh, index);
        if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
            points_and_lines_.push_back(what + (primitive.mode == TINYGLTF_MODE_POINTS ? " (points)" : " (lines)"));
            return std::nullopt;
        }
        const auto attribute = primitive.attributes.find("POSITION");
        const bool is_draco = primitive.extensions.contains("KHR_draco_mesh_compression");
        if (attribute == primitive.attributes.end()) {
            if (is_draco) fail_draco(what);
            without_positions_.push_back(what);
            return std::nullopt;
        }
        Part part;
        part.primitive = index;
        part.index_accessor = primitive.indices;
        const tinygltf::Accessor& positions = model_.accessors[std::size_t(attribute->second)];
        if (is_draco && !has_draco) {
            const bool has_indices = primitive.indices < 0 || model_.accessors[primitive.indices].bufferView >= 0;
            if (positions.bufferView < 0 || !has_indices) fail_draco(what);
            plan_phrases_.insert("KHR_draco_mesh_compression (the uncompressed data is read)");
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
        if (is_list ? corners % 3 != 0 : corners < 3) incomplete_.push_back(what);
        part.material = use_material(primitive.material);
        plan_cut_out(primitive, what, part);
        if (images_.has_colors()) plan_colors(primitive, what, part);
        return part;
    }

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
                fail(file_, "{}{} ({}) are {} for {}", thing, what, accessor_text(accessor), accessors_.count(accessor),
                     counted(accessors_.count(positions), "position"));
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
                 "the indices of " + what + " (" + accessor_text(index) + ") are not unsigned bytes, shorts or ints");
        accessors_.require(index, accessor.type, std::array{accessor.componentType}, "", "");
        if (accessor.bufferView < 0) return;
        const std::size_t stride = model_.bufferViews[accessor.bufferView].byteStride;
        if (stride != 0 && stride != element_bytes(accessor))
            fail(file_, "the indices of {} ({}) have a byteStride of {}; indices must be packed", what,
                 accessor_text(index), stride);
    }

    std::uint32_t use_material(int material) {
        if (material < 0) {
            uses_default_material_ = true;
            return std::uint32_t(model_.materials.size());
        }
        return std::uint32_t(material);
    }

    // ---- cut-outs ----

    std::string material_text(int material) const {
        return text_of("material ", model_.materials[std::size_t(material)].name, material);
    }

    /// The alpha of an image, which is loaded once. Nothing if it cannot be read.
    std::optional<std::uint32_t> alpha_of(int material, const MaterialSource& mask) {
        const auto refuse = [&](const std::string& why) {
            say_of(material_text(material), "alphaMode " + std::string(mask.is_blend ? "BLEND" : "MASK"),
                   "drawn opaque: " + why);
            return std::nullopt;
        };
        if (mask.image < 0) return refuse(mask.unreadable);
        if (const auto found = alpha_of_image_.find(mask.image); found != alpha_of_image_.end()) return found->second;
        try {
            cut_outs_.textures.push_back(images_.alpha(mask.image));
        } catch (const std::exception& error) {
            return refuse(why_unreadable(error));
        }
        return alpha_of_image_[mask.image] = std::uint32_t(cut_outs_.textures.size() - 1);
    }

    std::string why_unreadable(const std::exception& error) const {
        const std::string what = error.what(), prefix = file_.string() + ": ";
        return "its image cannot be read: " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what);
    }

    std::uint32_t add_cut_out(const CutOutMaterial& material) {
        cut_outs_.materials.push_back(material);
        return std::uint32_t(cut_outs_.materials.size() - 1);
    }

    /// Which accessors a part's alpha takes, and what decides it.
    void plan_cut_out(const tinygltf::Primitive& primitive, const std::string& what, Part& part) {
        const auto found = document_.materials.materials.find(primitive.material);
        if (found == document_.materials.materials.end()) return;
        const MaterialSource& mask = found->second;
        if (mask.transmits && !mask.is_blend) plan_phrases_.insert("KHR_materials_transmission (drawn opaque)");
        if (!mask.is_mask && !mask.is_blend) return;
        if (!images_.has_alpha()) {  // the caller takes no cut-outs
            plan_phrases_.insert("alphaMode " + std::string(mask.is_blend ? "BLEND" : "MASK") + " (drawn opaque)");
            return;
        }
        if (mask.is_blend && blend_ == BlendCasters::opaque) {
            plan_phrases_.insert("alphaMode BLEND (drawn opaque; --blend clear or mask)");
            return;
        }
        CutOutMaterial material{.wrap_u = mask.wrap_u,
                                .wrap_v = mask.wrap_v,
                                .filter = mask.filter,
                                .cutoff = mask.cutoff,
                                .alpha_factor = mask.alpha_factor};
        if (mask.is_blend && blend_ == BlendCasters::clear) material.cutoff = 2;
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
                fail(file_, "{} of {} has {} for {}", accessor_text(accessor), what, accessors_.count(accessor),
                     counted(vertices, "position"));
        part.cut_out = add_cut_out(material);
        part.transform = &mask;
        has_corner_alphas_ = has_corner_alphas_ || part.alphas >= 0;
    }

    // ---- colours ----

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
        has_corner_colors_ = has_corner_colors_ || part.colors >= 0;
        has_corner_normals_ = has_corner_normals_ || part.vertices.normals >= 0;
        const auto found = document_.materials.materials.find(primitive.material);
        if (found == document_.materials.materials.end() || !found->second.has_texture) return;
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
            say_of(material_text(material), "the base colour texture", "left out: " + why);
        };
        if (texture_uses_.contains(material)) return;
        ColorTextureUse& use = texture_uses_[material];
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

    /// u and v of a vertex: in double, rounded once.
    std::array<float, 2> coordinates_of(const Part& part, std::size_t vertex) {
        const Elements& from = accessors_.elements(part.coordinates);
        const double u = from.number(vertex, 0), v = from.number(vertex, 1);
        const MaterialSource* transform = part.transform;
        if (transform == nullptr || !transform->has_transform) return {float(u), float(v)};
        std::array<float, 2> uv;
        for (std::size_t k = 0; k < 2; ++k)
            uv[k] = float(transform->offset[k] + transform->rows[k][0] * u + transform->rows[k][1] * v);
        return uv;
    }

    /// Calls write(corner, vertex) for all corners of a part, whose first triangle is `first` of the scene.
    template <class Write>
    void for_each_corner(const Part& part, std::size_t first, const Write& write) {
        const std::uint32_t* index =
            part.index_accessor < 0 ? nullptr : accessors_.indices(part.index_accessor).value.data();
        for (std::size_t i = 0; i < part.triangle_count; ++i) {
            const std::array<std::size_t, 3> corners = corners_of(part.topology, i);
            for (std::size_t k = 0; k < 3; ++k) write(3 * (first + i) + k, index ? index[corners[k]] : corners[k]);
        }
    }

    void write_coordinates(const Part& part, std::size_t first) {
        std::vector<float>& out = work_.scene.texture_coordinates;
        if (part.coordinates < 0 || out.empty()) return;
        for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
            std::ranges::copy(coordinates_of(part, vertex), out.begin() + std::ptrdiff_t(2 * corner));
        });
    }

    /// The triangles from `first` on. Their coordinates are written.
    void write_cut_outs(const Part& part, std::size_t first) {
        SceneCutOuts& out = work_.scene.cut_outs;
        if (part.cut_out == no_cut_out || out.empty()) return;
        const CutOutMaterial& material = out.materials[part.cut_out];
        std::fill_n(out.material_of_triangle.begin() + std::ptrdiff_t(first), part.triangle_count, part.cut_out);
        std::vector<char> is_unusable(part.triangle_count, 0);
        for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
            bool is_usable = true;
            if (material.texture != no_texture) {
                const auto& texture = out.textures[material.texture];
                const float* uv = &work_.scene.texture_coordinates[2 * corner];
                is_usable = std::abs(double(uv[0]) * texture.width) <= 0x1p30 &&
                            std::abs(double(uv[1]) * texture.height) <= 0x1p30;
            }
            if (part.alphas >= 0) {
                const double alpha = accessors_.elements(part.alphas).number(vertex, 3);
                is_usable = is_usable && !std::isnan(alpha);
                out.corner_alphas[corner] = std::isnan(alpha) ? float(alpha) : float(std::clamp(alpha, 0.0, 1.0));
            }
            if (!is_usable) is_unusable[corner / 3 - first] = 1;
        });
        if (const auto unusable = std::size_t(std::ranges::count(is_unusable, 1)); unusable != 0)
            work_.unusable_coordinates += unusable;
    }

    void write_colors(const Part& part, const Shape& shape, const Affine& world, std::size_t first) {
        SceneColors& out = work_.scene.colors;
        if (part.colors >= 0 && !out.corner_colors.empty()) {
            const Elements& colors = accessors_.elements(part.colors);
            for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
                for (int i = 0; i < 3; ++i) {
                    const double color = colors.number(vertex, i);
                    out.corner_colors[3 * corner + std::size_t(i)] = float(color >= 0 ? std::min(color, 1.0) : 0.0);
                }
            });
        }
        if (!shape.has_normals() || out.corner_normals.empty()) return;
        for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
            out.corner_normals[corner] = pack_normal(shape.normal(vertex, world));
        });
    }

    // ---- amount ----

    /// The accessors that drawing reads: those of the parts, of instances and of the animation.
    std::set<int> read_accessors() const {
        std::set<int> accessors = other_accessors_;
        accessors.insert(animation_accessors_.begin(), animation_accessors_.end());
        for (const auto& [mesh, parts] : parts_)
            for (const Part& part : parts) {
                const VertexAccessors& vertices = part.vertices;
                accessors.insert({vertices.positions, part.index_accessor});
                accessors.insert({part.coordinates, part.alphas, part.colors, vertices.normals});
                for (const auto* more :
                     {&vertices.targets, &vertices.joints, &vertices.weights, &vertices.normal_targets})
                    accessors.insert(more->begin(), more->end());
            }
        accessors.erase(-1);
        return accessors;
    }

    /// Bytes of the copies of sparse accessors and indices. Throws SceneError for accessors of zeros without end.
    std::uint64_t copied_bytes(const std::set<int>& accessors) const {
        std::uint64_t bytes = 0, without_data = 0;
        for (const int index : accessors) {
            const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
            const bool is_index = accessor.type == TINYGLTF_TYPE_SCALAR;
            const bool is_copied = is_index || accessor.sparse.isSparse || accessor.bufferView < 0;
            if (is_copied) bytes = plus(bytes, times(accessor.count, is_index ? 4 : element_bytes(accessor)));
            if (accessor.bufferView >= 0) continue;
            without_data = plus(without_data, accessor.count);
            if (without_data > max_elements_without_data)
                fail(file_,
                     "{} has a count of {} but no bufferView; accessors without data may have {} elements in all",
                     accessor_text(index), accessor.count, max_elements_without_data);
        }
        return bytes;
    }

    bool is_plain(const VertexAccessors& vertices) const {
        const int type = model_.accessors[std::size_t(vertices.positions)].componentType;
        return vertices.targets.empty() && vertices.joints.empty() && type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    }

    bool has_coordinates() const { return !cut_outs_.materials.empty() || !texture_uses_.empty(); }

    /// Of a triangle.
    std::uint64_t bytes_beside_positions() const {
        std::uint64_t words = has_coordinates() ? 6 : 0;
        if (!cut_outs_.materials.empty()) words += has_corner_alphas_ ? 4 : 1;
        return 4 * (words + (has_corner_colors_ ? 9 : 0) + (has_corner_normals_ ? 3 : 0));
    }

    /// A few hundred bytes of JSON can describe terabytes (instances of instances). So all elements are counted before
    /// the first allocation. Returns the bytes that they need.
    std::uint64_t check_amount() const {
        std::uint64_t triangles = 0, largest_shape = 0;
        std::map<int, std::uint64_t> triangles_of_mesh;
        for (const auto& [mesh, parts] : parts_)
            for (const Part& part : parts) {
                triangles_of_mesh[mesh] = plus(triangles_of_mesh[mesh], part.triangle_count);
                if (!is_plain(part.vertices))
                    largest_shape = std::max<std::uint64_t>(largest_shape, accessors_.count(part.vertices.positions));
            }
        for (const Instance& instance : work_.instances)
            if (const auto it = triangles_of_mesh.find(model_.nodes[instance.node].mesh); it != triangles_of_mesh.end())
                triangles = plus(triangles, times(it->second, instance.count));
        std::uint64_t bytes = plus(copied_bytes(read_accessors()), document_.decoded_bytes);
        bytes = plus(bytes, times(largest_shape, sizeof(glm::dvec3)));
        bytes = plus(bytes, times(triangles, 9 * sizeof(float) + sizeof(std::uint32_t)));
        bytes = plus(bytes, times(triangles, bytes_beside_positions()));
        if (triangles >= no_receiver)
            fail(file_,
                 "has {} triangles with its instances, more than the 4294967294 that 32-bit triangle ids can name",
                 triangles);
        if (bytes > memory_bytes_)
            fail(file_,
                 "has {} triangles with its instances, which need {} MiB, more than the {} MiB of memory that it may "
                 "take",
                 triangles, bytes >> 20, memory_bytes_ >> 20);
        return bytes;
    }

    /// The largest value of the type restarts a strip in graphics APIs. glTF forbids this value, and a guess of its
    /// meaning would be wrong in half of the cases.
    void check_indices(const Indices& indices, const Part& part, const std::string& what) const {
        const tinygltf::Accessor& accessor = model_.accessors[part.index_accessor];
        const std::size_t count = accessors_.count(part.vertices.positions);
        if (indices.value.empty()) return;
        const std::uint32_t restart = std::uint32_t((std::uint64_t(1) << (8 * element_bytes(accessor))) - 1);
        if (indices.largest == restart)
            fail(file_, "{} has the vertex index {}, the primitive-restart value, which glTF does not allow", what,
                 restart);
        if (indices.largest >= count)
            fail(file_, "{} has the vertex index {}, but only {}", what, indices.largest,
                 count == 1 ? "1 vertex" : fmt::format("{} vertices", count));
    }

    // ---- triangles ----

    void make_materials() {
        for (const tinygltf::Material& material : model_.materials) {
            Float3 color;
            for (int i = 0; i < 3; ++i)
                color[i] = float(std::clamp(material.pbrMetallicRoughness.baseColorFactor[i], 0.0, 1.0));
            work_.scene.materials.base_color.push_back(color);
        }
        if (uses_default_material_) work_.scene.materials.base_color.push_back(default_base_color);
    }

    void write_triangles(Pose& pose) {
        std::size_t count = 0;
        for (const Instance& instance : work_.instances)
            for (const Part& part : parts_[model_.nodes[instance.node].mesh])
                count += part.triangle_count * instance.count;
        work_.scene.triangles.resize(count * 9);
        work_.scene.materials.triangle_material.resize(count);
        if (!cut_outs_.materials.empty()) {
            work_.scene.cut_outs = cut_outs_;
            work_.scene.cut_outs.material_of_triangle.assign(count, no_cut_out);
            work_.scene.cut_outs.corner_alphas.assign(has_corner_alphas_ ? 3 * count : 0, 1.0f);
        }
        if (has_coordinates()) work_.scene.texture_coordinates.resize(6 * count);
        make_colors(count);
        for (int mesh = 0; mesh < int(model_.meshes.size()); ++mesh) work_.scene.mesh_names.push_back(mesh_text(mesh));
        float* out = work_.scene.triangles.data();
        auto material = work_.scene.materials.triangle_material.begin();
        for (const Instance& instance : work_.instances) {
            work_.scene.mesh_uses.push_back(
                {std::size_t(out - work_.scene.triangles.data()) / 9, model_.nodes[instance.node].mesh});
            const std::size_t not_finite = write_instances(instance, pose, out, material);
            if (not_finite == 0) continue;
            work_.not_finite_count += not_finite;
            work_.not_finite.push_back(fmt::format("{} in {} under {}", not_finite,
                                                   mesh_text(model_.nodes[instance.node].mesh),
                                                   node_text(instance.node)));
        }
    }

    void make_colors(std::size_t triangle_count) {
        SceneColors& out = work_.scene.colors;
        out.corner_colors.assign(has_corner_colors_ ? 9 * triangle_count : 0, 1.0f);
        out.corner_normals.resize(has_corner_normals_ ? 3 * triangle_count : 0);
        if (texture_uses_.empty()) return;
        out.images = images_.all();
        out.texture_uses.resize(work_.scene.materials.base_color.size());
        for (const auto& [material, use] : texture_uses_) out.texture_uses[std::size_t(material)] = use;
    }

    /// Calls write(part, shape, world) for each part of a mesh, as often as it is drawn, in the triangles' order.
    template <class Write>
    void for_each_part(const Instance& instance, Pose& pose, const Write& write) {
        const tinygltf::Node& node = model_.nodes[std::size_t(instance.node)];
        // A file can ask for 2^63 instances of nothing.
        if (std::ranges::all_of(parts_[node.mesh], [](const Part& part) { return part.triangle_count == 0; })) return;
        const std::vector<double> weights = pose.morph_weights(instance.node);
        std::vector<glm::dmat4> joints;
        if (node.skin >= 0) joints = pose.joints(node.skin, accessors_);
        const InstanceTransforms transforms = instance_transforms(instance.node);
        const bool is_instanced = node.extensions.contains(instancing);
        for (std::size_t i = 0; i < instance.count; ++i) {
            Affine world = instance.world_from_node;
            if (is_instanced) world = world * instance_transform(transforms, i, instance.node);
            for (const Part& part : parts_[node.mesh])
                write(part,
                      Shape(file_, accessors_, part.vertices, weights, node.skin >= 0 ? &joints : nullptr,
                            part_text(node.mesh, part.primitive)),
                      world);
        }
    }

    /// Moves both outputs on. Returns how many triangles are not finite.
    std::size_t write_instances(const Instance& instance, Pose& pose, float*& out,
                                std::vector<std::uint32_t>::iterator& material) {
        const tinygltf::Node& node = model_.nodes[std::size_t(instance.node)];
        std::size_t not_finite = 0;
        for_each_part(instance, pose, [&](const Part& part, const Shape& shape, const Affine& world) {
            if (node.skin >= 0 && !shape.is_skinned())
                work_.not_supported.insert("a skin without joints and weights (drawn unskinned)");
            not_finite += write_part(part, instance, world, shape, out);
            const std::size_t first = std::size_t(out - work_.scene.triangles.data()) / 9;
            write_coordinates(part, first);
            write_cut_outs(part, first);
            write_colors(part, shape, world, first);
            out += part.triangle_count * 9;
            material = std::fill_n(material, part.triangle_count, part.material);
        });
        return not_finite;
    }

    /// The triangles once more, unless they do not fit into memory.
    void write_doubles(Pose& pose, std::uint64_t needed_bytes) {
        const std::uint64_t more = times(work_.scene.triangles.size(), sizeof(double));
        if (plus(needed_bytes, more) > memory_bytes_) return;
        work_.scene.doubles.resize(work_.scene.triangles.size());
        double* out = work_.scene.doubles.data();
        for (const Instance& instance : work_.instances)
            for_each_part(instance, pose, [&](const Part& part, const Shape& shape, const Affine& world) {
                const std::uint32_t* index = indices_of(part, model_.nodes[std::size_t(instance.node)].mesh);
                with_places(part, shape, world, [&](const auto& place) {
                    for (std::size_t i = 0; i < part.triangle_count; ++i)
                        for (const glm::dvec3& p : places_of(part, index, place, i))
                            for (int k = 0; k < 3; ++k) *out++ = p[k];
                });
            });
        work_.moved.clear();
    }

    /// Calls write with a function that gives a vertex in the node's space, or a skinned one in the world's. Vertices
    /// are computed once each, unless the part uses only some of them.
    template <class Write>
    void with_vertices(const Part& part, const Shape& shape, const Write& write) {
        const std::size_t count = shape.base().count;
        if (shape.has_file_bits() || part.triangle_count * 3 < count) return write(shape);
        std::vector<glm::dvec3> vertices(count);
        for (std::size_t i = 0; i < count; ++i) vertices[i] = shape(i);
        write([&](std::size_t vertex) { return vertices[vertex]; });
    }

    const std::uint32_t* indices_of(const Part& part, int mesh) {
        if (part.index_accessor < 0) return nullptr;
        const Indices& all = accessors_.indices(part.index_accessor);
        check_indices(all, part, part_text(mesh, part.primitive));
        return all.value.data();
    }

    /// Calls write with a function that gives a vertex's place in the world. `world`: of an unskinned part.
    template <class Write>
    void with_places(const Part& part, const Shape& shape, const Affine& world, const Write& write) {
        const bool stays = shape.is_skinned() || world.is_identity();
        with_vertices(part, shape, [&](const auto& vertex) {
            write([&](std::size_t i) -> glm::dvec3 { return stays ? vertex(i) : world(vertex(i)); });
        });
    }

    /// Returns how many triangles are not finite.
    std::size_t write_part(const Part& part, const Instance& instance, const Affine& world, const Shape& shape,
                           float* out) {
        const std::uint32_t* index = indices_of(part, model_.nodes[std::size_t(instance.node)].mesh);
        if (part.triangle_count == 0) return 0;
        // The product with the identity would turn -0 into +0.
        if (world.is_identity() && shape.has_file_bits())
            return write_corners(
                part, index, [&](std::size_t i) { return shape.base().float3(i); }, out);
        std::size_t not_finite = 0;
        with_places(part, shape, world, [&](const auto& place) {
            not_finite = write_corners(
                part, index, [&](std::size_t i) { return array_of(place(i)); }, out);
            check_rounding(part, instance, index, place, out);
        });
        return not_finite;
    }

    /// The vertex orders that glTF defines for its topologies; all keep the winding.
    static std::array<std::size_t, 3> corners_of(Topology topology, std::size_t i) {
        if (topology == Topology::strip) return {i, i + 1 + i % 2, i + 2 - i % 2};
        if (topology == Topology::fan) return {i + 1, i + 2, 0};
        return {3 * i, 3 * i + 1, 3 * i + 2};
    }

    /// The corners of a triangle of the part.
    template <class Place>
    static std::array<glm::dvec3, 3> places_of(const Part& part, const std::uint32_t* index, const Place& place,
                                               std::size_t triangle) {
        const auto [a, b, c] = corners_of(part.topology, triangle);
        if (index == nullptr) return {place(a), place(b), place(c)};
        return {place(index[a]), place(index[b]), place(index[c])};
    }

    template <class Place>
    static std::size_t write_corners(const Part& part, const std::uint32_t* index, const Place& place, float* out) {
        std::size_t not_finite = 0;
        for (std::size_t i = 0; i < part.triangle_count; ++i, out += 9) {
            const std::array<std::size_t, 3> corner = corners_of(part.topology, i);
            for (std::size_t k = 0; k < 3; ++k) {
                const Float3 p = place(index ? index[corner[k]] : corner[k]);
                std::memcpy(out + 3 * k, p.data(), sizeof p);
            }
            if (!std::all_of(out, out + 9, [](float c) { return std::isfinite(c); })) ++not_finite;
        }
        return not_finite;
    }

    // ---- warnings ----

    /// A phrase on one of the file's parts; those that differ in the part alone become one with their number.
    void say_of(const std::string& part, const std::string& what, const std::string& why) {
        parts_of_phrase_[{what, why}].insert(part);
    }

    void add_phrases() {
        work_.not_supported.insert(plan_phrases_.begin(), plan_phrases_.end());
        for (const auto& [phrase, parts] : parts_of_phrase_) {
            const std::string some = listed({parts.begin(), parts.end()}, 3);
            work_.not_supported.insert(fmt::format("{} of {} ({})", phrase.first, some, phrase.second));
        }
        if (work_.unusable_coordinates != 0)
            work_.not_supported.insert("texture coordinates that are no numbers or more than 2^30 texels away (" +
                                       counted(work_.unusable_coordinates, "triangle") + " drawn opaque)");
    }

    /// Whether the alpha of these materials' triangles can be below their cutoff.
    std::vector<bool> materials_that_cut() const {
        const SceneCutOuts& cut_outs = work_.scene.cut_outs;
        std::vector<bool> cuts;
        for (const CutOutMaterial& material : cut_outs.materials) {
            float least = has_corner_alphas_ ? 0 : 1;
            if (material.texture != no_texture)
                least *= float(std::ranges::min(cut_outs.textures[material.texture].alpha)) / 255;
            cuts.push_back(least * material.alpha_factor < material.cutoff);
        }
        return cuts;
    }

    void note_cut_outs() {
        const auto& material_of = work_.scene.cut_outs.material_of_triangle;
        const std::vector<bool> cuts = materials_that_cut();
        const auto count = std::ranges::count_if(material_of, [&](auto m) { return m != no_cut_out && cuts[m]; });
        if (count != 0)
            work_.scene.notes.push_back(file_.string() +
                                        ": may be cut out by their alpha: " + counted(std::size_t(count), "triangle"));
    }

    /// Whether float32 may have moved these vertices by more than 1/256 of their triangles, for how far away they are.
    static bool may_have_moved(const float* first, const float* last) {
        double farthest = 0, sizes = 0;
        for (const float* t = first; t != last; t += 9)
            for (int c = 0; c < 3; ++c) {
                const auto [low, high] = std::minmax({t[c], t[c + 3], t[c + 6]});
                farthest = std::max({farthest, std::fabs(double(low)), std::fabs(double(high))});
                sizes += double(high) - double(low);
            }
        const double size = sizes / (double(last - first) / 9) / 2;
        return !(std::ldexp(farthest, -25) <= std::ldexp(size, -8));
    }

    /// Where a node's transform leads so far away that float32 moves vertices visibly. Whole numbers it may hold there.
    template <class Place>
    void check_rounding(const Part& part, const Instance& instance, const std::uint32_t* index, const Place& place,
                        const float* written) {
        if (!may_have_moved(written, written + 9 * part.triangle_count)) return;
        double move = 0, sizes = 0;
        std::size_t finite_count = 0;
        for (std::size_t i = 0; i < part.triangle_count; ++i) {
            const auto [a, b, c] = places_of(part, index, place, i);
            const glm::dvec3 size = glm::max(glm::max(a, b), c) - glm::min(glm::min(a, b), c);
            for (const glm::dvec3& p : {a, b, c})
                for (int k = 0; k < 3; ++k)
                    if (std::isfinite(float(p[k]))) move = std::max(move, std::fabs(double(float(p[k])) - p[k]));
            if (const double sum = size.x + size.y + size.z; std::isfinite(sum)) {
                sizes += sum;
                ++finite_count;
            }
        }
        const double size = sizes / double(std::max<std::size_t>(finite_count, 1)) / 2;
        if (size > 0 && move > std::ldexp(size, -16))
            work_.moved.push_back(fmt::format("{} under {} by up to {:.2g}, its triangles measure {:.2g}",
                                              mesh_text(model_.nodes[instance.node].mesh), node_text(instance.node),
                                              move, size));
    }

    /// Where float32 moves cameras and lights visibly.
    void check_places() {
        const Scene& scene = work_.scene;
        if (scene.cameras.empty() && scene.lights.empty()) return;
        const Extent extent(scene);
        const auto check = [&](const char* kind, const std::string& name, const std::array<double, 3>& place) {
            if (const double move = extent.visible_move(place); move > 0)
                work_.moved.push_back(fmt::format("{} {} by {:.2g}", kind, in_quotes(name), move));
        };
        for (const NamedCamera& camera : scene.cameras) check("camera", camera.name, camera.eye);
        for (const NamedLight& light : scene.lights)
            if (light.light.xyzw[3] != 0) check("light", light.name, light.position);
    }

    void warn(const std::string& what) { work_.scene.warnings.push_back(file_.string() + ": " + what); }

    void warn() {
        add_phrases();
        if (!work_.moved.empty())
            warn(
                "float32 moves what lies far from the origin (move it there, or take Python's Scene.from_gltf, which "
                "keeps doubles): " +
                listed(work_.moved, 3));
        if (!work_.not_supported.empty()) {
            const std::vector<std::string> phrases(work_.not_supported.begin(), work_.not_supported.end());
            warn("has what gnomon does not support: " + listed(phrases, phrases.size()));
        }
        for (const std::string& warning : document_.warnings) warn(warning);
        if (work_.not_finite_count > 0)
            warn(counted(work_.not_finite_count, "triangle") +
                 (work_.not_finite_count == 1 ? " has a NaN or infinite vertex and casts no shadow: "
                                              : " have a NaN or infinite vertex and cast no shadow: ") +
                 listed(work_.not_finite));
        if (!points_and_lines_.empty()) warn("points and lines are left out: " + listed(points_and_lines_));
        if (!without_positions_.empty()) warn("left out for want of positions: " + listed(without_positions_));
        if (!incomplete_.empty()) warn("the last triangle is incomplete and left out: " + listed(incomplete_));
        if (!work_.orthographic.empty()) warn("orthographic cameras are left out: " + listed(work_.orthographic));
        if (!work_.unusable.empty())
            warn("left out, for the node's transform is degenerate: " + listed(work_.unusable));
        if (work_.scene.triangle_count() == 0) warn("has no triangles");
        note_cut_outs();
        for (const std::string& note : document_.notes) work_.scene.notes.push_back(file_.string() + ": " + note);
    }

    const std::filesystem::path file_;
    const std::uint64_t memory_bytes_;
    const GltfDocument document_;
    const tinygltf::Model& model_;
    Accessors accessors_;
    int animation_ = -1;
    std::map<int, std::vector<Part>> parts_;  ///< of the meshes that were drawn so far
    std::set<int> animation_accessors_, other_accessors_;
    bool uses_default_material_ = false;
    const BlendCasters blend_;
    const bool keeps_doubles_;
    Images images_;
    SceneCutOuts cut_outs_;  ///< materials and textures
    std::map<int, std::uint32_t> alpha_of_image_;
    std::map<int, ColorTextureUse> texture_uses_;  ///< of materials
    bool has_corner_alphas_ = false, has_corner_colors_ = false, has_corner_normals_ = false;
    std::set<std::string> plan_phrases_;
    std::map<std::pair<std::string, std::string>, std::set<std::string>> parts_of_phrase_;  ///< what and why: of what
    std::vector<std::string> points_and_lines_, without_positions_, incomplete_;
    Work work_;
};

/// Runs `work`, whose other errors become a SceneError.
template <class Work>
auto with_sentences(const std::filesystem::path& file, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail(file, "does not fit into this machine's memory");
    } catch (const std::exception& error) {
        fail(file, std::string("cannot be read as glTF: ") + error.what());
    }
}

}  // namespace

struct SceneFile::Inside {
    std::filesystem::path file;
    Loader loader;
};

SceneFile::SceneFile(const std::filesystem::path& file, const LoadOptions& options)
    : inside_(with_sentences(file, [&] {
          return new Inside{file, Loader(file, options)};
      })) {}
SceneFile::~SceneFile() = default;

Scene SceneFile::at(std::optional<double> time_s) {
    return with_sentences(inside_->file, [&] { return inside_->loader.at(time_s); });
}

Scene load(const std::filesystem::path& file, const LoadOptions& options) {
    return SceneFile(file, options).at(options.time_s);
}

}  // namespace gnomon::scene
