// SPDX-License-Identifier: MIT
// From a checked glTF document to world triangles: walk the nodes (in the file's order, which is the triangles' order),
// plan the primitives, count all elements, refuse a scene that cannot fit into memory, then decode each accessor once
// and write the triangles. Where float32 moves vertices visibly, the doubles are written, too, for a caller who wants
// them. The document, the plan and the decoded accessors serve every time of an animation.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "animation.hpp"
#include "extent.hpp"
#include "parts.hpp"

namespace gnomon::scene {
namespace {

/// An accessor without a bufferView is all zeros and costs a file nothing, whatever its count. The drawn accessors
/// without a bufferView may have this many elements in all (a real one is a base for sparse values).
constexpr std::uint64_t max_elements_without_data = std::uint64_t(1) << 24;

constexpr std::array rotation_types{TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
                                    TINYGLTF_COMPONENT_TYPE_SHORT};
constexpr std::array float_types{TINYGLTF_COMPONENT_TYPE_FLOAT};
constexpr std::array animated_types = position_types;

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
    WrittenTriangles written;
    std::set<std::string> not_supported;
    std::vector<std::string> orthographic, unusable;
};

class Loader {
public:
    Loader(const std::filesystem::path& file, const LoadOptions& options)
        : file_(file),
          memory_bytes_(options.memory_bytes != 0 ? options.memory_bytes : machine_memory_bytes()),
          document_(read_document(file_, options.scene, memory_bytes_)),
          model_(document_.model),
          accessors_(file_, model_),
          keeps_doubles_(options.keeps_doubles),
          images_(file_, model_, document_.materials.images, options, memory_bytes_),
          open_{file_, document_, accessors_, images_, options.blend} {
        if (options.animation) animation_ = int(chosen_animation(*options.animation));
    }

    Scene at(std::optional<double> time_s) {
        work_ = {};
        work_.not_supported = document_.not_supported;
        describe_animations(time_s);
        Pose pose(file_, model_, document_.parents, animated_nodes(time_s));
        walk(pose);
        for (const Instance& instance : work_.instances) plan_mesh(open_, model_.nodes[instance.node].mesh, plan_);
        const std::uint64_t needed_bytes = check_amount();
        const TriangleSources sources{open_, plan_, work_.instances, pose};
        work_.written = write_triangles(sources, work_.scene);
        require_places();
        if (keeps_doubles_) keep_doubles(sources, needed_bytes);
        if (!keeps_doubles_) check_places();
        warn();
        return std::move(work_.scene);
    }

private:
    /// Writes doubles where float32 moved vertices visibly, unless they do not fit into memory.
    void keep_doubles(const TriangleSources& sources, std::uint64_t needed_bytes) {
        const std::uint64_t more = times(work_.scene.triangles.size(), sizeof(double));
        if (work_.written.moved.empty() || plus(needed_bytes, more) > memory_bytes_) return;
        write_doubles(sources, work_.scene);
        work_.written.moved.clear();
    }

    /// Throws NoDataError for a vertex that stands for no data by the file's own float32 positions, or an instance by
    /// its translation; asks each once.
    void require_places() {
        const auto require = [&](int places, int indices, const auto& name, const char* moved) {
            if (!asked_places_.insert({places, indices}).second) return;
            if (const auto row = accessors_.first_absent_place(places, indices))
                throw NoDataError(fmt::format(
                    "{}: {} is at {}, of which one number stands for no data: leave it out where the file is made, or, "
                    "if it is a place, move {} by its node",
                    file_.string(), name(*row), accessors_.place_text(places, *row), moved));
        };
        for (const auto& [mesh, parts] : plan_.parts)
            for (const Part& part : parts) {
                const auto name = [this, mesh = mesh, &part](std::size_t row) {
                    return fmt::format("vertex {} of {}", row, names_.part(mesh, part.primitive));
                };
                if (part.triangle_count != 0) require(part.vertices.positions, part.index_accessor, name, "the mesh");
            }
        for (const Instance& instance : work_.instances) {
            const tinygltf::Node& node = model_.nodes[std::size_t(instance.node)];
            const auto found = node.extensions.find(instancing);
            if (found == node.extensions.end() || !found->second.Get("attributes").Has("TRANSLATION")) continue;
            const auto name = [&](std::size_t row) {
                return fmt::format("instance {} of {}", row, names_.node(instance.node));
            };
            require(found->second.Get("attributes").Get("TRANSLATION").GetNumberAsInt(), -1, name, "each instance");
        }
    }

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
            const std::string what = "the instances' " + word_or_quotes(name) + " of " + names_.node(node);
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

    // ---- amount ----

    /// The accessors that drawing reads: those of the parts, of instances and of the animation.
    std::set<int> read_accessors() const {
        std::set<int> accessors = other_accessors_;
        accessors.insert(animation_accessors_.begin(), animation_accessors_.end());
        for (const auto& [mesh, parts] : plan_.parts)
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
                     Accessors::text(index), accessor.count, max_elements_without_data);
        }
        return bytes;
    }

    bool is_plain(const VertexAccessors& vertices) const {
        const int type = model_.accessors[std::size_t(vertices.positions)].componentType;
        return vertices.targets.empty() && vertices.joints.empty() && type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    }

    /// Of a triangle.
    std::uint64_t bytes_beside_positions() const {
        std::uint64_t words = plan_.has_coordinates() ? 6 : 0;
        if (!plan_.cut_outs.materials.empty()) words += plan_.has_corner_alphas ? 4 : 1;
        return 4 * (words + (plan_.has_corner_colors ? 9 : 0) + (plan_.has_corner_normals ? 3 : 0));
    }

    /// A few hundred bytes of JSON can describe terabytes (instances of instances). So all elements are counted before
    /// the first allocation. Returns the bytes that they need.
    std::uint64_t check_amount() const {
        std::uint64_t triangles = 0, largest_shape = 0;
        std::map<int, std::uint64_t> triangles_of_mesh;
        for (const auto& [mesh, parts] : plan_.parts)
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

    // ---- warnings ----

    void add_phrases() {
        work_.not_supported.merge(work_.written.not_supported);
        work_.not_supported.insert(plan_.phrases.begin(), plan_.phrases.end());
        for (const auto& [phrase, parts] : plan_.parts_of_phrase) {
            const std::string some = listed({parts.begin(), parts.end()}, 3);
            work_.not_supported.insert(fmt::format("{} of {} ({})", phrase.first, some, phrase.second));
        }
        if (work_.written.unusable_coordinates != 0)
            work_.not_supported.insert("texture coordinates that are no numbers or more than 2^30 texels away (" +
                                       counted(work_.written.unusable_coordinates, "triangle") + " drawn opaque)");
    }

    /// Whether the alpha of these materials' triangles can be below their cutoff.
    std::vector<bool> materials_that_cut() const {
        const SceneCutOuts& cut_outs = work_.scene.cut_outs;
        std::vector<bool> cuts;
        for (const CutOutMaterial& material : cut_outs.materials) {
            float least = plan_.has_corner_alphas ? 0 : 1;
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

    /// Where float32 moves cameras and lights visibly.
    void check_places() {
        const Scene& scene = work_.scene;
        if (scene.cameras.empty() && scene.lights.empty()) return;
        const Extent extent(scene);
        const auto check = [&](const char* kind, const std::string& name, const std::array<double, 3>& place) {
            if (const double move = extent.visible_move(place); move > 0)
                work_.written.moved.push_back(fmt::format("{} {} by {:.2g}", kind, in_quotes(name), move));
        };
        for (const NamedCamera& camera : scene.cameras) check("camera", camera.name, camera.eye);
        for (const NamedLight& light : scene.lights)
            if (light.light.xyzw[3] != 0) check("light", light.name, light.position);
    }

    void warn(const std::string& what) { work_.scene.warnings.push_back(file_.string() + ": " + what); }

    void warn() {
        add_phrases();
        if (!work_.written.moved.empty())
            warn(
                "float32 moves what lies far from the origin (move it there, or take Python's Scene.from_gltf, which "
                "keeps doubles): " +
                listed(work_.written.moved, 3));
        if (!work_.not_supported.empty()) {
            const std::vector<std::string> phrases(work_.not_supported.begin(), work_.not_supported.end());
            warn("has what gnomon does not support: " + listed(phrases, phrases.size()));
        }
        for (const std::string& warning : document_.warnings) warn(warning);
        if (work_.written.not_finite_count > 0)
            warn(counted(work_.written.not_finite_count, "triangle") +
                 (work_.written.not_finite_count == 1 ? " has a NaN or infinite vertex and casts no shadow: "
                                                      : " have a NaN or infinite vertex and cast no shadow: ") +
                 listed(work_.written.not_finite));
        if (!plan_.points_and_lines.empty()) warn("points and lines are left out: " + listed(plan_.points_and_lines));
        if (!plan_.without_positions.empty())
            warn("left out for want of positions: " + listed(plan_.without_positions));
        if (!plan_.incomplete.empty())
            warn("the last triangle is incomplete and left out: " + listed(plan_.incomplete));
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
    const PartNames names_{model_};
    Accessors accessors_;
    int animation_ = -1;
    std::set<int> animation_accessors_, other_accessors_;
    std::set<std::pair<int, int>> asked_places_;  ///< by require_places(): accessors, and of their indices
    const bool keeps_doubles_;
    Images images_;
    const OpenFile open_;
    PartPlan plan_;
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
