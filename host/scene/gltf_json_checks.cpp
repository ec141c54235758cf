// SPDX-License-Identifier: MIT
// One small vocabulary (index, size, number, one_of ...) and, below it, the part of the glTF 2.0 schema that gnomon
// needs, in the order of the file. Only the text of a property's path ("accessors[3].sparse.count") needs memory, and
// it is made only for an error.
#include "gltf.hpp"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace gnomon::scene {
namespace {

using nlohmann::json;

constexpr int deepest_nesting = 256;

/// The path of a checked object: "nodes[3]", "meshes[1].primitives[0]", each with an optional ".member".
struct Path {
    std::string_view array{};
    std::size_t index = 0;
    std::string_view inner_array{};
    std::size_t inner_index = 0;
    std::string_view member{};

    std::string text(std::string_view property) const {
        std::string out;
        if (!array.empty()) out += fmt::format("{}[{}]", array, index);
        if (!inner_array.empty()) out += fmt::format(".{}[{}]", inner_array, inner_index);
        if (!member.empty()) out += (out.empty() ? "" : ".") + std::string(member);
        if (!property.empty()) out += (out.empty() ? "" : ".") + std::string(property);
        return out;
    }
    Path in(std::string_view name) const { return {array, index, inner_array, inner_index, name}; }
};

enum class Need { optional, required };

class Checks {
public:
    Checks(const std::filesystem::path& file, const json& root) : file_(file), root_(root) {
        asset();  // first: an older version has objects where 2.0 has arrays
        for (const std::string name : {"accessors", "animations", "buffers", "bufferViews", "cameras", "materials",
                                       "meshes", "nodes", "scenes", "skins"})
            counts_[name] = count(name);
        const json* lights = light_array();
        counts_["lights"] = lights ? lights->size() : 0;
    }

    void run() {
        extensions();
        each("buffers", [this](const json& o, const Path& at) { buffer(o, at); });
        each("bufferViews", [this](const json& o, const Path& at) { buffer_view(o, at); });
        each("accessors", [this](const json& o, const Path& at) { accessor(o, at); });
        each("meshes", [this](const json& o, const Path& at) { mesh(o, at); });
        each("materials", [this](const json& o, const Path& at) { material(o, at); });
        each("cameras", [this](const json& o, const Path& at) { camera(o, at); });
        if (const json* lights = light_array())
            for (std::size_t i = 0; i < lights->size(); ++i) light((*lights)[i], {"lights", i});
        each("nodes", [this](const json& o, const Path& at) { node(o, at); });
        each("skins", [this](const json& o, const Path& at) { skin(o, at); });
        each("animations", [this](const json& o, const Path& at) { animation(o, at); });
        each("scenes", [this](const json& o, const Path& at) { indices(o, at, "nodes", "nodes"); });
        index(root_, {}, "scene", "scenes", Need::optional);
    }

private:
    // ---- vocabulary ----

    [[noreturn]] void reject(const Path& at, std::string_view property, const std::string& what) const {
        fail(file_, at.text(property) + " " + what);
    }

    using IsType = bool (json::*)() const noexcept;

    /// The property, or null if it is absent and optional. `type` names what `is_type` (null: any) requires.
    const json* find(const json& object, const Path& at, std::string_view property, Need need, IsType is_type = nullptr,
                     const char* type = "") const {
        const auto it = object.find(property);
        if (it == object.end() && need == Need::required) reject(at, property, "is missing");
        if (it == object.end()) return nullptr;
        if (is_type && !((*it).*is_type)()) reject(at, property, std::string("must be ") + type);
        return &*it;
    }

    const json* object(const json& parent, const Path& at, std::string_view property, Need need) const {
        return find(parent, at, property, need, &json::is_object, "an object");
    }

    const json* array(const json& parent, const Path& at, std::string_view property, Need need) const {
        return find(parent, at, property, need, &json::is_array, "an array");
    }

    const std::string* string(const json& parent, const Path& at, std::string_view property, Need need) const {
        const json* value = find(parent, at, property, need, &json::is_string, "a string");
        return value ? value->get_ptr<const std::string*>() : nullptr;
    }

    const std::string* one_of(const json& parent, const Path& at, std::string_view property, Need need,
                              std::initializer_list<std::string_view> choices) const {
        const std::string* value = string(parent, at, property, need);
        if (!value || std::find(choices.begin(), choices.end(), *value) != choices.end()) return value;
        std::vector<std::string> names(choices.begin(), choices.end());
        reject(at, property, "is " + in_quotes(*value) + ", but must be one of " + listed(names, names.size()));
    }

    /// A whole number from `least` to `most`.
    const json* size(const json& parent, const Path& at, std::string_view property, Need need, std::uint64_t least = 0,
                     std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const {
        const json* value = find(parent, at, property, need);
        if (!value) return nullptr;
        if (!value->is_number_integer()) reject(at, property, "must be a whole number");
        if (!value->is_number_unsigned()) reject(at, property, "is " + value->dump() + ", but must not be negative");
        if (const auto n = value->get<std::uint64_t>(); n < least || n > most)
            reject(at, property,
                   "is " + value->dump() + ", but must be " +
                       (n < least ? fmt::format("at least {}", least) : fmt::format("at most {}", most)));
        return value;
    }

    /// An index in the file's array `target`.
    void check_index(const json& value, const Path& at, std::string_view property, std::string_view target) const {
        if (!value.is_number_integer()) reject(at, property, "must be a whole number: an index into " + str(target));
        const std::size_t entries = counts_.at(str(target));
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= entries)
            reject(at, property,
                   "is " + value.dump() + ", but " + str(target) + " has " +
                       (entries == 1 ? "1 entry" : fmt::format("{} entries", entries)));
    }

    void index(const json& parent, const Path& at, std::string_view property, std::string_view target,
               Need need) const {
        if (const json* value = find(parent, at, property, need)) check_index(*value, at, property, target);
    }

    void indices(const json& parent, const Path& at, std::string_view property, std::string_view target) const {
        if (const json* values = array(parent, at, property, Need::optional))
            for (const json& value : *values) check_index(value, at, property, target);
    }

    const json* number(const json& parent, const Path& at, std::string_view property, Need need) const {
        return find(parent, at, property, need, &json::is_number, "a number");
    }

    const json* numbers(const json& parent, const Path& at, std::string_view property, std::size_t length) const {
        const json* value = find(parent, at, property, Need::optional);
        if (!value) return nullptr;
        if (!value->is_array() || value->size() != length ||
            !std::all_of(value->begin(), value->end(), [](const json& n) { return n.is_number(); }))
            reject(at, property, fmt::format("must be {} numbers", length));
        return value;
    }

    std::size_t count(std::string_view name) const {
        const json* entries = array(root_, {}, name, Need::optional);
        return entries ? entries->size() : 0;
    }

    template <class Check>
    void each(std::string_view name, const Check& check) const {
        const auto it = root_.find(name);
        if (it == root_.end()) return;
        for (std::size_t i = 0; i < it->size(); ++i) {
            const Path at{name, i};
            if (!(*it)[i].is_object()) reject(at, "", "must be an object");
            check((*it)[i], at);
        }
    }

    const json* light_array() const {
        const json* all = object(root_, {}, "extensions", Need::optional);
        const json* punctual = all ? object(*all, {}, "KHR_lights_punctual", Need::optional) : nullptr;
        return punctual ? array(*punctual, {}, "lights", Need::optional) : nullptr;
    }

    static std::string str(std::string_view view) { return std::string(view); }

    // ---- the schema ----

    void asset() const {
        const auto is_object = [this](const char* list) { return root_.contains(list) && root_[list].is_object(); };
        if (is_object("accessors") && is_object("meshes"))  // some such files have no version
            fail(file_, "is glTF 1; only glTF 2.0 can be read: export it as that");
        const json* asset = object(root_, {}, "asset", Need::required);
        const Path at{.member = "asset"};
        const json& version = *find(*asset, at, "version", Need::required);
        const std::string text = version.is_string() ? version.get<std::string>() : version.dump();
        if (!version.is_string() || !text.starts_with("2."))
            reject(at, "version", "is " + in_quotes(text) + " and must be the text '2.0': export it as glTF 2.0");
        if (const std::string* least = string(*asset, at, "minVersion", Need::optional); least && *least != "2.0")
            reject(at, "minVersion", "is " + in_quotes(*least) + "; only glTF 2.0 can be read");
    }

    void extensions() const {
        for (const std::string_view list : {"extensionsUsed", "extensionsRequired"})
            if (const json* names = array(root_, {}, list, Need::optional))
                for (const json& name : *names)
                    if (!name.is_string()) reject({}, list, "must hold strings only");
        const auto required = root_.find("extensionsRequired");
        if (required == root_.end()) return;
        for (const json& entry : *required) {
            const auto& name = entry.get_ref<const std::string&>();
            if (name == "KHR_mesh_quantization" || name == "KHR_lights_punctual" || name == "EXT_mesh_gpu_instancing" ||
                name == "KHR_node_visibility" || name == "EXT_meshopt_compression" || concerns_shading_only(name))
                continue;
            const bool is_draco = name == "KHR_draco_mesh_compression";
            if (is_draco && has_draco) continue;
            fail(file_, "requires the extension " + in_quotes(name) + ", which gnomon does not support; export it " +
                            (is_draco ? "without compression" : "without this extension"));
        }
    }

    void buffer(const json& o, const Path& at) const {
        size(o, at, "byteLength", Need::required, 1);
        string(o, at, "uri", Need::optional);
    }

    void buffer_view(const json& o, const Path& at) const {
        index(o, at, "buffer", "buffers", Need::required);
        size(o, at, "byteOffset", Need::optional);
        size(o, at, "byteLength", Need::required, 1);
        if (const json* packed = extension(o, at, "EXT_meshopt_compression"))
            meshopt(*packed, at.in("extensions.EXT_meshopt_compression"));
        const json* stride = size(o, at, "byteStride", Need::optional);
        if (!stride) return;
        const auto bytes = stride->get<std::uint64_t>();
        if (bytes < 4 || bytes > 252 || bytes % 4 != 0)
            reject(at, "byteStride", "is " + stride->dump() + ", but must be a multiple of 4 between 4 and 252");
    }

    /// The object of an extension, or null.
    const json* extension(const json& o, const Path& at, std::string_view name) const {
        const json* all = object(o, at, "extensions", Need::optional);
        return all ? object(*all, at.in("extensions"), name, Need::optional) : nullptr;
    }

    void meshopt(const json& o, const Path& at) const {
        index(o, at, "buffer", "buffers", Need::required);
        size(o, at, "byteOffset", Need::optional);
        size(o, at, "byteLength", Need::required, 1);
        size(o, at, "byteStride", Need::required, 1, 256);
        size(o, at, "count", Need::required);
        one_of(o, at, "mode", Need::required, {"ATTRIBUTES", "TRIANGLES", "INDICES"});
        one_of(o, at, "filter", Need::optional, {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
    }

    /// An object whose values are indices of accessors: {"POSITION": 3}.
    void attributes(const json& o, const Path& at) const {
        for (const auto& [name, value] : o.items()) check_index(value, at, word_or_quotes(name), "accessors");
    }

    void component_type(const json& o, const Path& at, std::initializer_list<std::uint64_t> choices) const {
        const json* type = size(o, at, "componentType", Need::required);
        if (std::find(choices.begin(), choices.end(), type->get<std::uint64_t>()) == choices.end())
            reject(at, "componentType", "is " + type->dump() + ", which glTF does not allow there");
    }

    void accessor(const json& o, const Path& at) const {
        constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();  // tinygltf keeps these in an int
        index(o, at, "bufferView", "bufferViews", Need::optional);
        size(o, at, "byteOffset", Need::optional);
        component_type(o, at, {5120, 5121, 5122, 5123, 5125, 5126});
        const std::uint64_t count = size(o, at, "count", Need::required)->get<std::uint64_t>();
        one_of(o, at, "type", Need::required, {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"});
        const json* sparse = object(o, at, "sparse", Need::optional);
        if (!sparse) return;
        const Path in_sparse = at.in("sparse");
        size(*sparse, in_sparse, "count", Need::required, 1, std::min(count, most));
        const json* sparse_indices = object(*sparse, in_sparse, "indices", Need::required);
        const Path in_indices = at.in("sparse.indices");
        index(*sparse_indices, in_indices, "bufferView", "bufferViews", Need::required);
        size(*sparse_indices, in_indices, "byteOffset", Need::optional, 0, most);
        component_type(*sparse_indices, in_indices, {5121, 5123, 5125});
        const json* values = object(*sparse, in_sparse, "values", Need::required);
        const Path in_values = at.in("sparse.values");
        index(*values, in_values, "bufferView", "bufferViews", Need::required);
        size(*values, in_values, "byteOffset", Need::optional, 0, most);
    }

    void mesh(const json& o, const Path& at) const {
        const json* primitives = array(o, at, "primitives", Need::required);
        for (std::size_t i = 0; i < primitives->size(); ++i) {
            const Path part{at.array, at.index, "primitives", i};
            const json& primitive = (*primitives)[i];
            if (!primitive.is_object()) reject(part, "", "must be an object");
            const json* attributes = object(primitive, part, "attributes", Need::required);
            this->attributes(*attributes, part.in("attributes"));
            index(primitive, part, "indices", "accessors", Need::optional);
            index(primitive, part, "material", "materials", Need::optional);
            size(primitive, part, "mode", Need::optional, 0, 6);
            if (const json* targets = array(primitive, part, "targets", Need::optional))
                for (const json& target : *targets) {
                    if (!target.is_object()) reject(part, "targets", "must hold objects only");
                    this->attributes(target, part.in("targets"));
                }
            if (const json* packed = extension(primitive, part, "KHR_draco_mesh_compression"))
                draco(*packed, part.in("extensions.KHR_draco_mesh_compression"));
        }
        weights(o, at);
    }

    void draco(const json& o, const Path& at) const {
        index(o, at, "bufferView", "bufferViews", Need::required);
        const json* ids = object(o, at, "attributes", Need::optional);
        if (!ids) return;
        for (const auto& [name, value] : ids->items()) size(*ids, at, name, Need::required, 0, 0xFFFFFFFFu);
    }

    /// Of morph targets, at a mesh or a node.
    void weights(const json& o, const Path& at) const {
        const json* all = array(o, at, "weights", Need::optional);
        if (all && !std::all_of(all->begin(), all->end(), [](const json& n) { return n.is_number(); }))
            reject(at, "weights", "must be numbers");
    }

    void skin(const json& o, const Path& at) const {
        array(o, at, "joints", Need::required);
        indices(o, at, "joints", "nodes");
        index(o, at, "inverseBindMatrices", "accessors", Need::optional);
        index(o, at, "skeleton", "nodes", Need::optional);
    }

    void animation(const json& o, const Path& at) const {
        const json* samplers = array(o, at, "samplers", Need::required);
        for (std::size_t i = 0; i < samplers->size(); ++i) {
            const Path part{at.array, at.index, "samplers", i};
            const json& sampler = (*samplers)[i];
            if (!sampler.is_object()) reject(part, "", "must be an object");
            index(sampler, part, "input", "accessors", Need::required);
            index(sampler, part, "output", "accessors", Need::required);
            one_of(sampler, part, "interpolation", Need::optional, {"STEP", "LINEAR", "CUBICSPLINE"});
        }
        const json* channels = array(o, at, "channels", Need::required);
        for (std::size_t i = 0; i < channels->size(); ++i) {
            const Path part{at.array, at.index, "channels", i};
            const json& channel = (*channels)[i];
            if (!channel.is_object()) reject(part, "", "must be an object");
            const json* sampler = size(channel, part, "sampler", Need::required);
            if (sampler->get<std::uint64_t>() >= samplers->size())
                reject(part, "sampler",
                       "is " + sampler->dump() + ", but the animation has " + counted(samplers->size(), "sampler"));
            const json* target = object(channel, part, "target", Need::required);
            index(*target, part.in("target"), "node", "nodes", Need::optional);
            string(*target, part.in("target"), "path", Need::required);
        }
    }

    void material(const json& o, const Path& at) const {
        one_of(o, at, "alphaMode", Need::optional, {"OPAQUE", "MASK", "BLEND"});
        if (const json* pbr = object(o, at, "pbrMetallicRoughness", Need::optional))
            numbers(*pbr, at.in("pbrMetallicRoughness"), "baseColorFactor", 4);
    }

    void camera(const json& o, const Path& at) const {
        const std::string& type = *one_of(o, at, "type", Need::required, {"perspective", "orthographic"});
        const json* body = object(o, at, type, Need::required);
        if (type == "orthographic") {
            for (const std::string_view name : {"xmag", "ymag", "zfar", "znear"})
                number(*body, at.in("orthographic"), name, Need::required);
            return;
        }
        number(*body, at.in("perspective"), "znear", Need::required);
        const json* fov_y = number(*body, at.in("perspective"), "yfov", Need::required);
        if (const double radians = fov_y->get<double>(); !(radians > 0 && radians < 3.14159265358979))
            reject(at.in("perspective"), "yfov", "is " + fov_y->dump() + ", but must lie between 0 and pi (radians)");
    }

    void light(const json& o, const Path& at) const {
        if (!o.is_object()) reject(at, "", "must be an object");
        const std::string& type = *one_of(o, at, "type", Need::required, {"directional", "point", "spot"});
        if (type == "spot") object(o, at, "spot", Need::required);
    }

    void node(const json& o, const Path& at) const {
        index(o, at, "mesh", "meshes", Need::optional);
        index(o, at, "camera", "cameras", Need::optional);
        index(o, at, "skin", "skins", Need::optional);
        indices(o, at, "children", "nodes");
        const json* matrix = numbers(o, at, "matrix", 16);
        const json* rotation = numbers(o, at, "rotation", 4);
        const json* scale = numbers(o, at, "scale", 3);
        const json* translation = numbers(o, at, "translation", 3);
        if (matrix) {
            if (rotation || scale || translation)
                reject(at, "matrix", "stands beside translation, rotation or scale; only one form is allowed");
            if ((*matrix)[3] != 0 || (*matrix)[7] != 0 || (*matrix)[11] != 0 || (*matrix)[15] != 1)
                reject(at, "matrix", "is not affine: its last row must be 0, 0, 0, 1");
        }
        weights(o, at);
        if (const json* light = extension(o, at, "KHR_lights_punctual"))
            index(*light, at.in("extensions.KHR_lights_punctual"), "light", "lights", Need::required);
        if (const json* visibility = extension(o, at, "KHR_node_visibility"))
            find(*visibility, at.in("extensions.KHR_node_visibility"), "visible", Need::optional, &json::is_boolean,
                 "true or false");
        if (const json* instances = extension(o, at, "EXT_mesh_gpu_instancing")) {
            const Path in_instances = at.in("extensions.EXT_mesh_gpu_instancing");
            const json* all = object(*instances, in_instances, "attributes", Need::required);
            attributes(*all, in_instances);
            if (all->empty())
                reject(in_instances, "attributes", "is empty: it must name TRANSLATION, ROTATION or SCALE");
        }
    }

    const std::filesystem::path& file_;
    const json& root_;
    std::map<std::string, std::size_t, std::less<>> counts_;
};

/// Brackets open at once, outside strings.
int nesting(std::string_view text) {
    int depth = 0, deepest = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\') ++i;
        if (c == '"') in_string = !in_string;
        if (in_string) continue;
        if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
        if (c == ']' || c == '}') --depth;
    }
    return deepest;
}

}  // namespace

json parse_json(const std::filesystem::path& file, const std::string& text) {
    if (nesting(text) > deepest_nesting) fail(file, "the JSON nests deeper than {} levels", deepest_nesting);
    try {
        json root = json::parse(text);
        if (!root.is_object()) fail(file, "is not a glTF file: its JSON is no object");
        return root;
    } catch (const json::parse_error& error) {
        // The parser counts the end as a byte.
        const std::string size = counted(text.size(), "byte");
        fail(file, (error.byte > text.size() ? "the JSON is cut off after " + size
                                             : fmt::format("the JSON is broken at byte {} of {}", error.byte, size)) +
                       "; export or copy the file again");
    } catch (const json::out_of_range&) {
        fail(file, "the JSON holds a number beyond the range of double");
    }
}

void check_json(const std::filesystem::path& file, const json& root) { Checks(file, root).run(); }

bool concerns_shading_only(std::string_view extension) {
    for (const std::string_view prefix : {"KHR_materials_", "EXT_materials_", "KHR_texture_", "EXT_texture_",
                                          "MSFT_texture_", "MSFT_packing_", "KHR_xmp"})
        if (extension.starts_with(prefix)) return true;
    return extension == "EXT_lights_image_based" || extension == "KHR_techniques_webgl";
}

}  // namespace gnomon::scene
