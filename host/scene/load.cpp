// SPDX-License-Identifier: MIT
// From a checked glTF document to world triangles: walk the nodes (in the file's order, which is the triangles' order),
// count all elements, refuse a scene that cannot fit into memory, then decode each accessor once and write the
// triangles. A position is p = world_from_node * p_node in double, rounded to float32 once.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "affine.hpp"
#include "gltf.hpp"
#include "scene.hpp"

namespace gnomon::scene {
namespace {

/// Colour of a primitive without a material: a light grey, so that light and shade differ from white.
constexpr Float3 default_base_color{0.8f, 0.8f, 0.8f};

/// An accessor without a bufferView is all zeros and costs a file nothing, whatever its count. The drawn accessors
/// without a bufferView may have this many elements in all (a real one is a base for sparse values).
constexpr std::uint64_t most_elements_without_data = std::uint64_t(1) << 24;

enum class Topology { triangles, strip, fan };

/// A drawn primitive, before its data are read.
struct Part {
    int primitive = 0;
    int position_accessor = -1;
    int index_accessor = -1;  ///< -1: vertices in order
    Topology topology = Topology::triangles;
    std::uint64_t triangle_count = 0;
    std::uint32_t material = 0;
};

/// A mesh under a node.
struct Instance {
    int node = 0;
    Affine world_from_node;
};

/// Positions of an accessor: in their buffer, or, if it is sparse, in a copy of their own.
struct Positions {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
    std::vector<float> own;

    Float3 operator[](std::size_t vertex) const {
        Float3 p;
        std::memcpy(p.data(), first + vertex * stride, sizeof p);
        return p;
    }
};

struct Indices {
    std::vector<std::uint32_t> value;
    std::uint32_t largest = 0;
};

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
    return std::string(kind) + " " + std::to_string(number);
}

std::uint64_t machine_memory_bytes() {
    return std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE));
}

class Loader {
public:
    Loader(const std::filesystem::path& file, std::uint64_t memory_bytes)
        : file_(file),
          memory_bytes_(memory_bytes != 0 ? memory_bytes : machine_memory_bytes()),
          document_(read_document(file)),
          model_(document_.model) {}

    Scene run() {
        walk();
        plan_parts();
        check_amount();
        make_materials();
        write_triangles();
        warn();
        return std::move(scene_);
    }

private:
    // ---- names ----

    static std::string text_of(const char* kind, const std::string& name, int index) {
        return kind + (name.empty() ? std::to_string(index) : in_quotes(name));
    }
    std::string mesh_text(int mesh) const { return text_of("mesh ", model_.meshes[mesh].name, mesh); }
    std::string node_text(int node) const { return text_of("node ", model_.nodes[node].name, node); }
    std::string part_text(int mesh, int primitive) const {
        return "primitive " + std::to_string(primitive) + " of " + mesh_text(mesh);
    }
    static std::string accessor_text(int accessor) { return "accessors[" + std::to_string(accessor) + "]"; }

    // ---- nodes ----

    Affine local_transform(int index) const {
        const tinygltf::Node& node = model_.nodes[index];
        Affine out;
        if (!node.matrix.empty()) {
            for (int column = 0; column < 3; ++column)
                for (int row = 0; row < 3; ++row) out.linear[row][column] = node.matrix[column * 4 + row];
            for (int row = 0; row < 3; ++row) out.translation[row] = node.matrix[12 + row];
            return out;
        }
        if (!node.rotation.empty()) out.linear = rotation(index);
        if (!node.scale.empty())
            for (Double3& row : out.linear)
                for (int column = 0; column < 3; ++column) row[column] *= node.scale[column];
        if (!node.translation.empty()) std::copy_n(node.translation.begin(), 3, out.translation.begin());
        return out;
    }

    /// glTF requires unit quaternions, but decimals are rarely exact: 2/|q|^2 instead of 2 gives a pure rotation for
    /// every q.
    std::array<Double3, 3> rotation(int index) const {
        const std::vector<double>& q = model_.nodes[index].rotation;
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        const double length_squared = x * x + y * y + z * z + w * w;
        if (!(length_squared > 1e-12 && length_squared < 1e12))
            fail(file_, "the rotation of " + node_text(index) + " is no unit quaternion");
        const double s = 2 / length_squared;
        return {{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
                 {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
                 {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}}};
    }

    /// Depth first, children in order, with a stack of our own: a hierarchy may be a million nodes deep.
    void walk() {
        std::vector<Instance> open;
        const auto push_reversed = [&](const std::vector<int>& nodes, const Affine& world_from_parent) {
            for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) open.push_back({*it, world_from_parent});
        };
        push_reversed(document_.root_nodes, Affine{});
        while (!open.empty()) {
            const Instance visit{open.back().node, open.back().world_from_node * local_transform(open.back().node)};
            open.pop_back();
            const tinygltf::Node& node = model_.nodes[visit.node];
            if (node.mesh >= 0) add_mesh(visit);
            if (node.camera >= 0) add_camera(visit);
            if (node.extensions.contains("KHR_lights_punctual")) add_light(visit);
            push_reversed(node.children, visit.world_from_node);
        }
    }

    void add_mesh(const Instance& visit) {
        const tinygltf::Node& node = model_.nodes[visit.node];
        if (node.skin >= 0) document_.not_supported.insert("skins (drawn unskinned)");
        if (node.extensions.contains("EXT_mesh_gpu_instancing"))
            document_.not_supported.insert("EXT_mesh_gpu_instancing (one instance is drawn)");
        instances_.push_back(visit);
    }

    void add_camera(const Instance& visit) {
        const tinygltf::Node& node = model_.nodes[visit.node];
        const tinygltf::Camera& source = model_.cameras[node.camera];
        NamedCamera named{name_or(node.name, source.name, "camera", scene_.cameras.size()), {}};
        if (source.type == "orthographic") {
            orthographic_.push_back(in_quotes(named.name));
            return;
        }
        // A camera looks along its node's -Z with +Y up; scaling has no meaning for it.
        Double3 forward = scaled(visit.world_from_node.axis(2), -1);
        Double3 up = visit.world_from_node.axis(1);
        Double3 right{};
        const bool is_usable = normalize(forward) && normalize(up) && normalize(right = cross(forward, up));
        named.camera.eye = rounded(visit.world_from_node.translation);
        if (!is_usable || !is_finite(named.camera.eye)) {
            unusable_.push_back("camera " + in_quotes(named.name));
            return;
        }
        named.camera.right = right;
        named.camera.forward = forward;
        named.camera.up = cross(right, forward);
        named.camera.fov_y_radians = source.perspective.yfov;
        scene_.cameras.push_back(std::move(named));
    }

    void add_light(const Instance& visit) {
        const tinygltf::Node& node = model_.nodes[visit.node];
        const int index = node.extensions.at("KHR_lights_punctual").Get("light").GetNumberAsInt();
        const tinygltf::Light& source = model_.lights[index];
        NamedLight named{name_or(node.name, source.name, "light", scene_.lights.size()), source.type, {}};
        const bool is_directional = source.type == "directional";
        // Light travels along the node's -Z.
        const Float3 v =
            rounded(is_directional ? scaled(visit.world_from_node.axis(2), -1) : visit.world_from_node.translation);
        if (!is_finite(v) || (is_directional && v == Float3{0, 0, 0})) {
            unusable_.push_back("light " + in_quotes(named.name));
            return;
        }
        named.light = is_directional ? Light::directional(v) : Light::positional(v);
        scene_.lights.push_back(std::move(named));
    }

    // ---- primitives: what will be drawn, from their descriptions alone ----

    void plan_parts() {
        for (const Instance& instance : instances_) {
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
        part.position_accessor = attribute->second;
        part.index_accessor = primitive.indices;
        const tinygltf::Accessor& positions = model_.accessors[part.position_accessor];
        if (is_draco) {
            const bool has_indices = primitive.indices < 0 || model_.accessors[primitive.indices].bufferView >= 0;
            if (positions.bufferView < 0 || !has_indices) fail_draco(what);
            document_.not_supported.insert("KHR_draco_mesh_compression (the uncompressed data is read)");
        }
        if (positions.type != TINYGLTF_TYPE_VEC3)
            fail(file_, "the positions of " + what + " (" + accessor_text(part.position_accessor) + ") are not VEC3");
        if (positions.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
            quantized_.push_back(what);
            return std::nullopt;
        }
        check_alignment(part.position_accessor);
        if (!primitive.targets.empty()) document_.not_supported.insert("morph targets (the base shape is drawn)");
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
        return part;
    }

    [[noreturn]] void fail_draco(const std::string& what) const {
        fail(file_, what +
                        " is compressed with KHR_draco_mesh_compression and has no uncompressed data; export without "
                        "compression");
    }

    void check_alignment(int index) const {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        if (accessor.bufferView < 0) return;
        const tinygltf::BufferView& view = model_.bufferViews[accessor.bufferView];
        const auto bytes = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType)));
        // A stride is a multiple of 4 anyway. Remainders are added, for the offsets' sum could overflow.
        if ((accessor.byteOffset % bytes + view.byteOffset % bytes) % bytes != 0)
            fail(file_, accessor_text(index) + " is misaligned: its offset must be a multiple of its " +
                            std::to_string(bytes) + "-byte components");
    }

    void check_index_accessor(int index, const std::string& what) const {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const bool is_unsigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                 accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                 accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned)
            fail(file_,
                 "the indices of " + what + " (" + accessor_text(index) + ") are not unsigned bytes, shorts or ints");
        check_alignment(index);
        if (accessor.bufferView < 0) return;
        const std::size_t stride = model_.bufferViews[accessor.bufferView].byteStride;
        if (stride != 0 && stride != element_bytes(accessor))
            fail(file_, "the indices of " + what + " (" + accessor_text(index) + ") have a byteStride of " +
                            std::to_string(stride) + "; indices must be packed");
    }

    std::uint32_t use_material(int material) {
        if (material < 0) {
            uses_default_material_ = true;
            return std::uint32_t(model_.materials.size());
        }
        const std::string& mode = model_.materials[material].alphaMode;
        if (mode == "MASK" || mode == "BLEND") document_.not_supported.insert("alphaMode " + mode + " (drawn opaque)");
        return std::uint32_t(material);
    }

    // ---- amount ----

    /// A few hundred bytes of JSON can describe terabytes (instances of instances). So all elements are counted before
    /// the first allocation.
    void check_amount() const {
        std::set<int> accessors;
        std::uint64_t triangles = 0, bytes = 0;
        std::map<int, std::uint64_t> triangles_of_mesh;
        for (const auto& [mesh, parts] : parts_)
            for (const Part& part : parts) {
                triangles_of_mesh[mesh] = plus(triangles_of_mesh[mesh], part.triangle_count);
                accessors.insert(part.position_accessor);
                if (part.index_accessor >= 0) accessors.insert(part.index_accessor);
            }
        for (const Instance& instance : instances_)
            if (const auto it = triangles_of_mesh.find(model_.nodes[instance.node].mesh); it != triangles_of_mesh.end())
                triangles = plus(triangles, it->second);
        std::uint64_t without_data = 0;
        for (const int index : accessors) {
            const tinygltf::Accessor& accessor = model_.accessors[index];
            const bool is_index = accessor.type == TINYGLTF_TYPE_SCALAR;
            const bool is_copied = is_index || accessor.sparse.isSparse || accessor.bufferView < 0;
            if (is_copied) bytes = plus(bytes, times(accessor.count, is_index ? 4 : 12));
            if (accessor.bufferView >= 0) continue;
            without_data = plus(without_data, accessor.count);
            if (without_data > most_elements_without_data)
                fail(file_, accessor_text(index) + " has a count of " + std::to_string(accessor.count) +
                                " but no bufferView; accessors without data may have " +
                                std::to_string(most_elements_without_data) + " elements in all");
        }
        bytes = plus(bytes, times(triangles, 9 * sizeof(float) + sizeof(std::uint32_t)));
        if (triangles >= no_receiver)
            fail(file_, "has " + std::to_string(triangles) +
                            " triangles with its instances, more than the 4294967294 "
                            "that 32-bit triangle ids can name");
        if (bytes > memory_bytes_)
            fail(file_, "has " + std::to_string(triangles) + " triangles with its instances, which need " +
                            std::to_string(bytes >> 20) + " MiB, more than the " + std::to_string(memory_bytes_ >> 20) +
                            " MiB of memory that it may take");
    }

    // ---- reading ----

    const unsigned char* bytes_at(int view, std::size_t offset) const {
        const tinygltf::BufferView& v = model_.bufferViews[view];
        return model_.buffers[v.buffer].data.data() + v.byteOffset + offset;
    }

    static std::uint32_t read_index(const unsigned char* from, int component_type) {
        if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *from;
        if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
            std::uint16_t value;
            std::memcpy(&value, from, sizeof value);
            return value;
        }
        std::uint32_t value;
        std::memcpy(&value, from, sizeof value);
        return value;
    }

    /// Calls put(element, bytes of its new value) for each sparse element, once its index is known to be in range.
    template <class Put>
    void for_each_sparse(int index, const Put& put) const {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        if (!accessor.sparse.isSparse) return;
        const auto& sparse = accessor.sparse;
        const int index_bytes = tinygltf::GetComponentSizeInBytes(std::uint32_t(sparse.indices.componentType));
        const auto packed_or = [&](int view, std::size_t bytes) {
            const std::size_t stride = model_.bufferViews[view].byteStride;
            return stride == 0 ? bytes : stride;
        };
        const std::size_t index_stride = packed_or(sparse.indices.bufferView, std::size_t(index_bytes));
        const std::size_t value_stride = packed_or(sparse.values.bufferView, element_bytes(accessor));
        const unsigned char* indices = bytes_at(sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset));
        const unsigned char* values = bytes_at(sparse.values.bufferView, std::size_t(sparse.values.byteOffset));
        for (std::size_t i = 0; i < std::size_t(sparse.count); ++i) {
            const std::uint32_t element = read_index(indices + i * index_stride, sparse.indices.componentType);
            if (element >= accessor.count)
                fail(file_, accessor_text(index) + ".sparse names element " + std::to_string(element) +
                                ", but the accessor has a count of " + std::to_string(accessor.count));
            put(element, values + i * value_stride);
        }
    }

    const Positions& positions(int index) {
        if (const auto it = positions_.find(index); it != positions_.end()) return it->second;
        const tinygltf::Accessor& accessor = model_.accessors[index];
        Positions out;
        if (accessor.bufferView >= 0) {
            const std::size_t stride = model_.bufferViews[accessor.bufferView].byteStride;
            out.first = bytes_at(accessor.bufferView, accessor.byteOffset);
            out.stride = stride == 0 ? sizeof(Float3) : stride;
        }
        if (accessor.sparse.isSparse || accessor.bufferView < 0) {
            out.own.resize(accessor.count * 3);
            for (std::size_t i = 0; out.first && i < accessor.count; ++i)
                std::memcpy(&out.own[i * 3], out.first + i * out.stride, sizeof(Float3));
            for_each_sparse(index, [&](std::size_t element, const unsigned char* value) {
                std::memcpy(&out.own[element * 3], value, sizeof(Float3));
            });
            out.first = reinterpret_cast<const unsigned char*>(out.own.data());
            out.stride = sizeof(Float3);
        }
        return positions_.emplace(index, std::move(out)).first->second;
    }

    const Indices& indices(int index) {
        if (const auto it = indices_.find(index); it != indices_.end()) return it->second;
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const auto bytes = element_bytes(accessor);
        Indices out;
        out.value.resize(accessor.count);
        if (accessor.bufferView >= 0) {
            const unsigned char* from = bytes_at(accessor.bufferView, accessor.byteOffset);
            for (std::size_t i = 0; i < accessor.count; ++i)
                out.value[i] = read_index(from + i * bytes, accessor.componentType);
        }
        for_each_sparse(index, [&](std::size_t element, const unsigned char* value) {
            out.value[element] = read_index(value, accessor.componentType);
        });
        for (const std::uint32_t value : out.value) out.largest = std::max(out.largest, value);
        return indices_.emplace(index, std::move(out)).first->second;
    }

    /// The largest value of the type restarts a strip in graphics APIs. glTF forbids this value, and a guess of its
    /// meaning would be wrong in half of the cases.
    void check_indices(const Indices& indices, const Part& part, const std::string& what) const {
        const tinygltf::Accessor& accessor = model_.accessors[part.index_accessor];
        const std::size_t count = model_.accessors[part.position_accessor].count;
        if (indices.value.empty()) return;
        const std::uint32_t restart = std::uint32_t((std::uint64_t(1) << (8 * element_bytes(accessor))) - 1);
        if (indices.largest == restart)
            fail(file_, what + " has the vertex index " + std::to_string(restart) +
                            ", the primitive-restart value, which glTF does not allow");
        if (indices.largest >= count)
            fail(file_, what + " has the vertex index " + std::to_string(indices.largest) + ", but only " +
                            (count == 1 ? "1 vertex" : std::to_string(count) + " vertices"));
    }

    // ---- triangles ----

    void make_materials() {
        for (const tinygltf::Material& material : model_.materials) {
            Float3 color;
            for (int i = 0; i < 3; ++i)
                color[i] = float(std::clamp(material.pbrMetallicRoughness.baseColorFactor[i], 0.0, 1.0));
            scene_.materials.base_color.push_back(color);
        }
        if (uses_default_material_) scene_.materials.base_color.push_back(default_base_color);
    }

    void write_triangles() {
        std::size_t count = 0;
        for (const Instance& instance : instances_)
            for (const Part& part : parts_[model_.nodes[instance.node].mesh]) count += part.triangle_count;
        scene_.triangles.resize(count * 9);
        scene_.materials.triangle_material.resize(count);
        float* out = scene_.triangles.data();
        auto material = scene_.materials.triangle_material.begin();
        for (const Instance& instance : instances_) {
            const int mesh = model_.nodes[instance.node].mesh;
            std::size_t not_finite = 0;
            for (const Part& part : parts_[mesh]) {
                not_finite += write_part(part, mesh, instance.world_from_node, out);
                out += part.triangle_count * 9;
                material = std::fill_n(material, part.triangle_count, part.material);
            }
            if (not_finite == 0) continue;
            not_finite_count_ += not_finite;
            not_finite_.push_back(std::to_string(not_finite) + " in " + mesh_text(mesh) + " under " +
                                  node_text(instance.node));
        }
    }

    /// Returns how many triangles are not finite.
    std::size_t write_part(const Part& part, int mesh, const Affine& world_from_node, float* out) {
        const Positions& from = positions(part.position_accessor);
        const std::uint32_t* index = nullptr;
        if (part.index_accessor >= 0) {
            const Indices& all = indices(part.index_accessor);
            check_indices(all, part, part_text(mesh, part.primitive));
            index = all.value.data();
        }
        const bool is_identity = world_from_node.is_identity();
        const auto write_corner = [&](std::size_t corner, float* to) {
            const Float3 p = from[index ? index[corner] : corner];
            // The product with the identity would turn -0 into +0.
            const Float3 p_world = is_identity ? p : rounded(world_from_node({p[0], p[1], p[2]}));
            std::memcpy(to, p_world.data(), sizeof p_world);
        };
        std::size_t not_finite = 0;
        for (std::size_t i = 0; i < part.triangle_count; ++i, out += 9) {
            // The vertex orders that glTF defines for its topologies; all keep the winding.
            std::array<std::size_t, 3> corner{3 * i, 3 * i + 1, 3 * i + 2};
            if (part.topology == Topology::strip) corner = {i, i + 1 + i % 2, i + 2 - i % 2};
            if (part.topology == Topology::fan) corner = {i + 1, i + 2, 0};
            for (int k = 0; k < 3; ++k) write_corner(corner[k], out + 3 * k);
            if (!std::all_of(out, out + 9, [](float c) { return std::isfinite(c); })) ++not_finite;
        }
        return not_finite;
    }

    // ---- warnings ----

    void warn(const std::string& what) { scene_.warnings.push_back(file_.string() + ": " + what); }

    void warn() {
        if (!quantized_.empty())
            document_.not_supported.insert("KHR_mesh_quantization (left out: " + listed(quantized_) + ")");
        if (!document_.not_supported.empty()) {
            const std::vector<std::string> phrases(document_.not_supported.begin(), document_.not_supported.end());
            warn("has what gnomon does not support: " + listed(phrases, phrases.size()));
        }
        if (not_finite_count_ > 0)
            warn(counted(not_finite_count_, "triangle") +
                 (not_finite_count_ == 1 ? " has a NaN or infinite vertex and casts no shadow: "
                                         : " have a NaN or infinite vertex and cast no shadow: ") +
                 listed(not_finite_));
        if (!points_and_lines_.empty()) warn("points and lines are left out: " + listed(points_and_lines_));
        if (!without_positions_.empty()) warn("left out for want of positions: " + listed(without_positions_));
        if (!incomplete_.empty()) warn("the last triangle is incomplete and left out: " + listed(incomplete_));
        if (!orthographic_.empty()) warn("orthographic cameras are left out: " + listed(orthographic_));
        if (!unusable_.empty()) warn("left out, for the node's transform is degenerate: " + listed(unusable_));
        if (scene_.triangle_count() == 0) warn("has no triangles");
    }

    const std::filesystem::path& file_;
    const std::uint64_t memory_bytes_;
    GltfDocument document_;
    const tinygltf::Model& model_;
    std::vector<Instance> instances_;
    std::map<int, std::vector<Part>> parts_;
    std::map<int, Positions> positions_;
    std::map<int, Indices> indices_;
    bool uses_default_material_ = false;
    std::size_t not_finite_count_ = 0;
    std::vector<std::string> quantized_, points_and_lines_, without_positions_, incomplete_, orthographic_, unusable_,
        not_finite_;
    Scene scene_;
};

}  // namespace

Scene load(const std::filesystem::path& file, std::uint64_t memory_bytes) {
    try {
        return Loader(file, memory_bytes).run();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail(file, "does not fit into this machine's memory");
    } catch (const std::exception& error) {
        fail(file, std::string("cannot be read as glTF: ") + error.what());
    }
}

}  // namespace gnomon::scene
