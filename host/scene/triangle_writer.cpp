// SPDX-License-Identifier: MIT
// Writes planned parts as triangles: p = world_from_node * p_node in double, rounded to float32 once.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "parts.hpp"

namespace gnomon::scene {
namespace {

/// Colour of a primitive without a material: a light grey, so that light and shade differ from white.
constexpr Float3 default_base_color{0.8f, 0.8f, 0.8f};

/// Where the instances of EXT_mesh_gpu_instancing stand in their node; each may be absent.
struct InstanceTransforms {
    const Elements *translation = nullptr, *rotation = nullptr, *scale = nullptr;
};

class TriangleWriter {
public:
    TriangleWriter(const TriangleSources& from, Scene& scene) : from_(from), scene_(scene) {}

    WrittenTriangles write() {
        make_materials();
        write_triangles();
        return std::move(found_);
    }

    /// The triangles once more.
    void write_doubles() {
        scene_.doubles.resize(scene_.triangles.size());
        double* out = scene_.doubles.data();
        for (const Instance& instance : from_.instances)
            for_each_part(instance, [&](const Part& part, const Shape& shape, const Affine& world) {
                const std::uint32_t* index = indices_of(part, model_.nodes[std::size_t(instance.node)].mesh);
                with_places(part, shape, world, [&](const auto& place) {
                    for (std::size_t i = 0; i < part.triangle_count; ++i)
                        for (const glm::dvec3& p : places_of(part, index, place, i))
                            for (int k = 0; k < 3; ++k) *out++ = p[k];
                });
            });
    }

private:
    void make_materials() {
        for (const tinygltf::Material& material : model_.materials) {
            Float3 color;
            for (int i = 0; i < 3; ++i)
                color[i] = float(std::clamp(material.pbrMetallicRoughness.baseColorFactor[i], 0.0, 1.0));
            scene_.materials.base_color.push_back(color);
        }
        if (plan_.uses_default_material) scene_.materials.base_color.push_back(default_base_color);
    }

    void write_triangles() {
        std::size_t count = 0;
        for (const Instance& instance : from_.instances)
            for (const Part& part : plan_.parts.at(model_.nodes[instance.node].mesh))
                count += part.triangle_count * instance.count;
        scene_.triangles.resize(count * 9);
        scene_.materials.triangle_material.resize(count);
        if (!plan_.cut_outs.materials.empty()) {
            scene_.cut_outs = plan_.cut_outs;
            scene_.cut_outs.material_of_triangle.assign(count, no_cut_out);
            scene_.cut_outs.corner_alphas.assign(plan_.has_corner_alphas ? 3 * count : 0, 1.0f);
        }
        if (plan_.has_coordinates()) scene_.texture_coordinates.resize(6 * count);
        make_colors(count);
        for (int mesh = 0; mesh < int(model_.meshes.size()); ++mesh) scene_.mesh_names.push_back(names_.mesh(mesh));
        float* out = scene_.triangles.data();
        auto material = scene_.materials.triangle_material.begin();
        for (const Instance& instance : from_.instances) {
            scene_.mesh_uses.push_back(
                {std::size_t(out - scene_.triangles.data()) / 9, model_.nodes[instance.node].mesh});
            const std::size_t not_finite = write_instances(instance, out, material);
            if (not_finite == 0) continue;
            found_.not_finite_count += not_finite;
            found_.not_finite.push_back(fmt::format("{} in {} under {}", not_finite,
                                                    names_.mesh(model_.nodes[instance.node].mesh),
                                                    names_.node(instance.node)));
        }
    }

    void make_colors(std::size_t triangle_count) {
        SceneColors& out = scene_.colors;
        out.corner_colors.assign(plan_.has_corner_colors ? 9 * triangle_count : 0, 1.0f);
        out.corner_normals.resize(plan_.has_corner_normals ? 3 * triangle_count : 0);
        if (plan_.texture_uses.empty()) return;
        out.images = from_.file.images.all();
        out.texture_uses.resize(scene_.materials.base_color.size());
        for (const auto& [material, use] : plan_.texture_uses) out.texture_uses[std::size_t(material)] = use;
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
        return composed(t, r, s, file_, fmt::format("instance {} of {}", i, names_.node(node)));
    }

    /// Calls write(part, shape, world) for each part of a mesh, as often as it is drawn, in the triangles' order.
    template <class Write>
    void for_each_part(const Instance& instance, const Write& write) {
        const tinygltf::Node& node = model_.nodes[std::size_t(instance.node)];
        // A file can ask for 2^63 instances of nothing.
        if (std::ranges::all_of(plan_.parts.at(node.mesh), [](const Part& part) { return part.triangle_count == 0; }))
            return;
        const std::vector<double> weights = from_.pose.morph_weights(instance.node);
        std::vector<glm::dmat4> joints;
        if (node.skin >= 0) joints = from_.pose.joints(node.skin, accessors_);
        const InstanceTransforms transforms = instance_transforms(instance.node);
        const bool is_instanced = node.extensions.contains(instancing);
        for (std::size_t i = 0; i < instance.count; ++i) {
            Affine world = instance.world_from_node;
            if (is_instanced) world = world * instance_transform(transforms, i, instance.node);
            for (const Part& part : plan_.parts.at(node.mesh))
                write(part,
                      Shape(file_, accessors_, part.vertices, weights, node.skin >= 0 ? &joints : nullptr,
                            names_.part(node.mesh, part.primitive)),
                      world);
        }
    }

    /// Moves both outputs on. Returns how many triangles are not finite.
    std::size_t write_instances(const Instance& instance, float*& out, std::vector<std::uint32_t>::iterator& material) {
        const tinygltf::Node& node = model_.nodes[std::size_t(instance.node)];
        std::size_t not_finite = 0;
        for_each_part(instance, [&](const Part& part, const Shape& shape, const Affine& world) {
            if (node.skin >= 0 && !shape.is_skinned())
                found_.not_supported.insert("a skin without joints and weights (drawn unskinned)");
            not_finite += write_part(part, instance, world, shape, out);
            const std::size_t first = std::size_t(out - scene_.triangles.data()) / 9;
            write_coordinates(part, first);
            write_cut_outs(part, first);
            write_colors(part, shape, world, first);
            out += part.triangle_count * 9;
            material = std::fill_n(material, part.triangle_count, part.material);
        });
        return not_finite;
    }

    // ---- positions ----

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
        check_indices(all, part, names_.part(mesh, part.primitive));
        return all.value.data();
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

    /// Calls write with a function that gives a vertex's place in the world. `world`: of an unskinned part.
    template <class Write>
    void with_places(const Part& part, const Shape& shape, const Affine& world, const Write& write) {
        const bool stays = shape.is_skinned() || world.is_identity();
        with_vertices(part, shape, [&](const auto& vertex) {
            write([&](std::size_t i) -> glm::dvec3 { return stays ? vertex(i) : world(vertex(i)); });
        });
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
            found_.moved.push_back(fmt::format("{} under {} by up to {:.2g}, its triangles measure {:.2g}",
                                               names_.mesh(model_.nodes[instance.node].mesh),
                                               names_.node(instance.node), move, size));
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

    // ---- what else a corner has ----

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
        std::vector<float>& out = scene_.texture_coordinates;
        if (part.coordinates < 0 || out.empty()) return;
        for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
            std::ranges::copy(coordinates_of(part, vertex), out.begin() + std::ptrdiff_t(2 * corner));
        });
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

    /// The triangles from `first` on. Their coordinates are written.
    void write_cut_outs(const Part& part, std::size_t first) {
        SceneCutOuts& out = scene_.cut_outs;
        if (part.cut_out == no_cut_out || out.empty()) return;
        const CutOutMaterial& material = out.materials[part.cut_out];
        std::fill_n(out.material_of_triangle.begin() + std::ptrdiff_t(first), part.triangle_count, part.cut_out);
        std::vector<char> is_unusable(part.triangle_count, 0);
        for_each_corner(part, first, [&](std::size_t corner, std::size_t vertex) {
            bool is_usable = true;
            if (material.texture != no_texture) {
                const auto& texture = out.textures[material.texture];
                const float* uv = &scene_.texture_coordinates[2 * corner];
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
            found_.unusable_coordinates += unusable;
    }

    void write_colors(const Part& part, const Shape& shape, const Affine& world, std::size_t first) {
        SceneColors& out = scene_.colors;
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

    const TriangleSources& from_;
    Scene& scene_;
    const std::filesystem::path& file_ = from_.file.path;
    const tinygltf::Model& model_ = from_.file.document.model;
    Accessors& accessors_ = from_.file.accessors;
    const PartPlan& plan_ = from_.plan;
    const PartNames names_{model_};
    WrittenTriangles found_;
};

}  // namespace

WrittenTriangles write_triangles(const TriangleSources& from, Scene& scene) {
    return TriangleWriter(from, scene).write();
}

void write_doubles(const TriangleSources& from, Scene& scene) { TriangleWriter(from, scene).write_doubles(); }

}  // namespace gnomon::scene
