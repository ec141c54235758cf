// SPDX-License-Identifier: MIT
// The order of the loading: container -> JSON -> gnomon's checks -> tinygltf -> gnomon's checks of the references.
// tinygltf gets a JSON without images and textures (gnomon uses none of them; image files need not exist and are never
// decoded). Compressed meshes are unpacked before the references are checked. tinygltf reads every buffer through a
// callback, under a name that gnomon chose: a .glb's chunk is read from the file directly into its buffer, a buffer
// file may be longer than byteLength (as glTF allows and tinygltf does not), and each failure gets a sentence.
#include "gltf.hpp"

#include "materials.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

namespace gnomon::scene {
namespace {

using nlohmann::json;

// ---- Buffers --------------------------------------------------------------------------------------------------------

constexpr std::string_view buffer_name_prefix = "gnomon-buffer-";

struct BufferSource {
    std::string uri;  ///< empty: the .glb's binary chunk
    std::uint64_t byte_length = 0;
    bool is_fallback = false;  ///< only for readers that cannot unpack EXT_meshopt_compression: not read, 1 byte long
};

struct BufferReader {
    const std::filesystem::path& file;
    const GltfContainer& container;
    std::vector<BufferSource> sources;

    std::vector<unsigned char> read(std::size_t index) const;

private:
    std::vector<unsigned char> decode(std::size_t index) const;
    void require(std::uint64_t available, std::size_t index, const std::string& what, const char* why = "") const;
};

std::string buffer_text(std::size_t index) { return fmt::format("buffers[{}]", index); }

/// %41 becomes A (RFC 3986); all other text stays unchanged.
std::string percent_decoded(std::string_view uri) {
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned value = 0;
        const char* const digits = uri.data() + i + 1;
        const bool is_escape =
            uri[i] == '%' && i + 2 < uri.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
        out += is_escape ? static_cast<char>(value) : uri[i];
        if (is_escape) i += 2;
    }
    return out;
}

void BufferReader::require(std::uint64_t available, std::size_t index, const std::string& what, const char* why) const {
    if (available < sources[index].byte_length)
        fail(file, "{} needs {}, but {}{}{}", buffer_text(index), counted(sources[index].byte_length, "byte"), what,
             available, why);
}

std::vector<unsigned char> BufferReader::decode(std::size_t index) const {
    const std::string& uri = sources[index].uri;
    constexpr std::string_view marker = ";base64,";
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || !std::string_view(uri).substr(0, comma + 1).ends_with(marker))
        fail(file, buffer_text(index) + " has a data URI that is not base64");
    // tinygltf counts characters in an int.
    if (uri.size() > std::size_t(std::numeric_limits<int>::max()))
        fail(file, buffer_text(index) + " has a data URI over 2 GiB; put the buffer into a file of its own");
    std::vector<unsigned char> bytes;
    std::string mime_type;
    // tinygltf accepts a few media types only; the type does not matter here.
    tinygltf::DecodeDataURI(&bytes, mime_type, "data:application/octet-stream;base64," + uri.substr(comma + 1), 0,
                            false);
    require(bytes.size(), index, "its data URI holds only ", " (broken or cut off)");
    bytes.resize(sources[index].byte_length);
    return bytes;
}

std::vector<unsigned char> BufferReader::read(std::size_t index) const {
    const BufferSource& source = sources[index];
    if (source.is_fallback) return {0};
    if (source.uri.empty()) {
        require(container.binary_chunk->size, index, "the .glb's binary chunk has only ");
        return read_bytes(file, {container.binary_chunk->offset, source.byte_length}, file);
    }
    if (source.uri.starts_with("data:")) return decode(index);
    if (source.uri.find("://") != std::string::npos)
        fail(file,
             buffer_text(index) + " lies at " + in_quotes(source.uri) + "; only files beside the scene can be read");
    const std::string name = percent_decoded(source.uri);
    if (name.find('\0') != std::string::npos) fail(file, buffer_text(index) + ".uri contains a zero byte");
    const std::filesystem::path path = file.parent_path() / std::filesystem::path(name);
    require(file_size(path, file), index, "its file " + in_quotes(name) + " has only ");
    return read_bytes(path, {0, source.byte_length}, file);
}

}  // namespace

std::vector<unsigned char> bytes_of_uri(const std::filesystem::path& file, const std::string& uri) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        std::vector<unsigned char> bytes;
        std::string mime_type;
        if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64") ||
            uri.size() > std::size_t(std::numeric_limits<int>::max()) ||
            !tinygltf::DecodeDataURI(&bytes, mime_type, "data:application/octet-stream;base64," + uri.substr(comma + 1),
                                     0, false))
            fail(file, "an image has a data URI that is broken");
        return bytes;
    }
    if (uri.find("://") != std::string::npos)
        fail(file, "an image lies at " + in_quotes(uri) + "; only files beside the scene can be read");
    const std::string name = percent_decoded(uri);
    if (name.find('\0') != std::string::npos) fail(file, "an image's uri contains a zero byte");
    const std::filesystem::path path = file.parent_path() / std::filesystem::path(name);
    return read_bytes(path, {0, file_size(path, file)}, file);
}

namespace {

/// Replaces the buffers' addresses in the JSON by gnomon's own names.
std::vector<BufferSource> take_buffer_sources(const std::filesystem::path& file, const GltfContainer& container,
                                              json& root) {
    std::vector<BufferSource> sources;
    if (!root.contains("buffers")) return sources;
    for (json& buffer : root["buffers"]) {
        const std::size_t index = sources.size();
        BufferSource source;
        source.byte_length = buffer["byteLength"].get<std::uint64_t>();
        if (buffer.contains("uri")) source.uri = std::move(buffer["uri"].get_ref<std::string&>());
        const bool is_chunk = index == 0 && container.binary_chunk && !buffer.contains("uri");
        source.is_fallback = buffer.contains("extensions") && buffer["extensions"].contains("EXT_meshopt_compression");
        if (source.is_fallback) {
            source.byte_length = 1;
            buffer["byteLength"] = 1;
        } else if (source.uri.empty() && !is_chunk) {
            fail(file, buffer_text(index) + " has no data: neither a uri nor a binary chunk");
        }
        buffer["uri"] = fmt::format("{}{}", buffer_name_prefix, index);
        sources.push_back(std::move(source));
    }
    return sources;
}

tinygltf::FsCallbacks callbacks(BufferReader& reader) {
    tinygltf::FsCallbacks fs{};
    fs.FileExists = [](const std::string&, void*) { return true; };
    fs.ExpandFilePath = [](const std::string& name, void*) { return name; };
    fs.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& name, void* user) {
        const std::size_t prefix = name.find(buffer_name_prefix);
        *out = static_cast<BufferReader*>(user)->read(std::stoul(name.substr(prefix + buffer_name_prefix.size())));
        return true;
    };
    fs.user_data = &reader;
    return fs;
}

// ---- tinygltf -------------------------------------------------------------------------------------------------------

std::vector<MeshoptView> meshopt_views(const json& root) {
    std::vector<MeshoptView> views;
    if (!root.contains("bufferViews")) return views;
    for (std::size_t i = 0; i < root["bufferViews"].size(); ++i) {
        const json& view = root["bufferViews"][i];
        if (!view.contains("extensions") || !view["extensions"].contains("EXT_meshopt_compression")) continue;
        const json& packed = view["extensions"]["EXT_meshopt_compression"];
        views.push_back({i, packed["buffer"].get<std::size_t>(), packed.value("byteOffset", std::uint64_t(0)),
                         packed["byteLength"].get<std::uint64_t>(), packed["byteStride"].get<std::uint64_t>(),
                         packed["count"].get<std::uint64_t>(), packed["mode"].get<std::string>(),
                         packed.value("filter", std::string("NONE"))});
    }
    return views;
}

/// tinygltf refuses index accessors without a bufferView, which glTF allows (zeros, or sparse): such references are
/// removed from the JSON and put into the model afterwards.
struct KeptIndices {
    std::size_t mesh, primitive;
    int accessor;
};

std::vector<KeptIndices> take_indices_without_view(json& root) {
    std::vector<KeptIndices> kept;
    if (!root.contains("meshes")) return kept;
    for (std::size_t mesh = 0; mesh < root["meshes"].size(); ++mesh) {
        json& primitives = root["meshes"][mesh]["primitives"];
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const auto indices = primitives[i].find("indices");
            if (indices == primitives[i].end()) continue;
            const int accessor = indices->get<int>();
            if (root["accessors"][accessor].contains("bufferView")) continue;
            kept.push_back({mesh, i, accessor});
            primitives[i].erase("indices");
        }
    }
    return kept;
}

/// tinygltf refuses skins without inverse bind matrices, which glTF allows (each is the identity): they get some
/// accessor for it to read, and lose it afterwards.
std::vector<std::size_t> fill_skins_without_matrices(json& root) {
    std::vector<std::size_t> filled;
    if (!root.contains("skins")) return filled;
    for (std::size_t i = 0; i < root["skins"].size(); ++i) {
        if (root["skins"][i].contains("inverseBindMatrices")) continue;
        root["skins"][i]["inverseBindMatrices"] = 0;
        filled.push_back(i);
    }
    return filled;
}

/// tinygltf refuses animation channels without a node, which glTF says to ignore: they get a node and no path.
void fill_channels_without_node(json& root) {
    if (!root.contains("animations")) return;
    for (json& animation : root["animations"])
        for (json& channel : animation["channels"])
            if (!channel["target"].contains("node")) channel["target"] = {{"node", 0}, {"path", ""}};
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

tinygltf::Model parse(const std::filesystem::path& file, const GltfContainer& container, json& root) {
    BufferReader reader{file, container, take_buffer_sources(file, container, root)};
    for (const char* unused : {"images", "textures", "samplers", "extras"}) root.erase(unused);
    const std::vector<KeptIndices> kept = take_indices_without_view(root);
    const std::vector<std::size_t> skins_without_matrices = fill_skins_without_matrices(root);
    fill_channels_without_node(root);
    const std::string text = root.dump();
    root = nullptr;
    if (text.size() > std::numeric_limits<unsigned>::max()) fail(file, "the JSON is larger than 4 GiB");

    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(callbacks(reader));
    tinygltf::Model model;
    std::string error, warning;
    const bool success = loader.LoadASCIIFromString(&model, &error, &warning, text.c_str(), unsigned(text.size()), "");
    // If tinygltf reports an error beside success, it left out a part of the file. The load then fails.
    if (!success || !error.empty()) fail(file, "tinygltf cannot read it: " + first_line(error));
    for (const KeptIndices& k : kept) model.meshes[k.mesh].primitives[k.primitive].indices = k.accessor;
    for (const std::size_t skin : skins_without_matrices) model.skins[skin].inverseBindMatrices = -1;
    return model;
}

// ---- References -----------------------------------------------------------------------------------------------------

std::string view_text(int index) { return fmt::format("bufferViews[{}]", index); }

/// `count` elements of `bytes` each, `stride` apart, from `offset` on, within `available` bytes. Written with
/// divisions: products and sums of the file's own numbers could overflow.
bool fits(std::uint64_t available, std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
          std::uint64_t bytes) {
    if (count == 0) return offset <= available;
    return offset <= available && bytes <= available - offset && count - 1 <= (available - offset - bytes) / stride;
}

void check_extent(const std::filesystem::path& file, const tinygltf::Model& model, const std::string& what, int view,
                  std::uint64_t offset, std::uint64_t count, std::uint64_t bytes) {
    const tinygltf::BufferView& v = model.bufferViews[view];
    const std::uint64_t stride = v.byteStride == 0 ? bytes : v.byteStride;
    if (stride < bytes)
        fail(file, "{} has elements of {}, but {}.byteStride is only {}", what, counted(bytes, "byte"), view_text(view),
             stride);
    if (!fits(v.byteLength, offset, count, stride, bytes))
        fail(file, "{} reads beyond its bufferView: {} elements of {}, {} apart, from byte {} on, but {} has {}", what,
             count, counted(bytes, "byte"), stride, offset, view_text(view), counted(v.byteLength, "byte"));
}

void check_views(const std::filesystem::path& file, const tinygltf::Model& model) {
    for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
        const tinygltf::BufferView& view = model.bufferViews[i];
        const std::size_t available = model.buffers[view.buffer].data.size();
        if (!fits(available, view.byteOffset, 1, 1, view.byteLength))
            fail(file, "{} reads beyond its buffer: {} from byte {} on, but {} has {}", view_text(int(i)),
                 counted(view.byteLength, "byte"), view.byteOffset, buffer_text(std::size_t(view.buffer)),
                 counted(available, "byte"));
    }
}

void check_accessors(const std::filesystem::path& file, const tinygltf::Model& model) {
    for (std::size_t i = 0; i < model.accessors.size(); ++i) {
        const tinygltf::Accessor& accessor = model.accessors[i];
        const std::string what = fmt::format("accessors[{}]", i);
        const std::size_t bytes = element_bytes(accessor);
        if (accessor.bufferView >= 0)
            check_extent(file, model, what, accessor.bufferView, accessor.byteOffset, accessor.count, bytes);
        if (!accessor.sparse.isSparse) continue;
        const auto& sparse = accessor.sparse;
        const std::size_t index_bytes = tinygltf::GetComponentSizeInBytes(std::uint32_t(sparse.indices.componentType));
        check_extent(file, model, what + ".sparse.indices", sparse.indices.bufferView,
                     std::uint64_t(sparse.indices.byteOffset), std::uint64_t(sparse.count), index_bytes);
        check_extent(file, model, what + ".sparse.values", sparse.values.bufferView,
                     std::uint64_t(sparse.values.byteOffset), std::uint64_t(sparse.count), bytes);
    }
}

std::string node_text(const tinygltf::Model& model, int index) {
    const std::string& name = model.nodes[index].name;
    return fmt::format("nodes[{}]{}", index, name.empty() ? "" : " " + in_quotes(name));
}

/// A node has one parent at most, so it is enough to walk up from each node until the walk meets a node of an earlier
/// walk (sound) or of its own (a cycle). Linear, no recursion.
std::vector<int> check_hierarchy(const std::filesystem::path& file, const tinygltf::Model& model) {
    const int none = -1;
    std::vector<int> parent(model.nodes.size(), none);
    for (int i = 0; i < int(model.nodes.size()); ++i)
        for (const int child : model.nodes[i].children) {
            if (parent[child] != none)
                fail(file, node_text(model, child) + " is a child twice: of " + node_text(model, parent[child]) +
                               " and of " + node_text(model, i) + "; a node may have one parent only");
            parent[child] = i;
        }
    std::vector<int> walk_of(model.nodes.size(), none);
    for (int walk = 0; walk < int(model.nodes.size()); ++walk)
        for (int node = walk; node != none && walk_of[node] != walk; node = parent[node]) {
            if (walk_of[node] != none) break;
            walk_of[node] = walk;
            if (parent[node] != none && walk_of[parent[node]] == walk)
                fail(file, node_text(model, node) + " is its own ancestor: the node hierarchy has a cycle");
        }
    return parent;
}

std::vector<int> root_nodes(const std::filesystem::path& file, const tinygltf::Model& model,
                            const std::vector<int>& parent, const std::optional<std::string>& chosen) {
    std::vector<std::string> names;
    for (const tinygltf::Scene& scene : model.scenes) names.push_back(scene.name);
    const std::size_t wanted = chosen ? find_named(file, names, *chosen, "scene") : 0;
    std::vector<int> roots;
    if (model.scenes.empty()) {
        for (int i = 0; i < int(parent.size()); ++i)
            if (parent[i] < 0) roots.push_back(i);
        return roots;
    }
    const int shown = chosen ? int(wanted) : std::max(model.defaultScene, 0);
    std::vector<bool> seen(parent.size(), false);
    for (const int node : model.scenes[shown].nodes) {
        const std::string scene = fmt::format("scenes[{}]", shown);
        if (seen[node]) fail(file, scene + " lists " + node_text(model, node) + " twice");
        if (parent[node] >= 0)
            fail(file, scene + " lists " + node_text(model, node) + " as a root, but it is a child of " +
                           node_text(model, parent[node]));
        seen[node] = true;
        roots.push_back(node);
    }
    return roots;
}

/// Extensions that gnomon reads, or that have a phrase of their own at the node, mesh or buffer that uses them.
constexpr std::array<std::string_view, 7> named_elsewhere{
    "KHR_node_visibility",     "KHR_lights_punctual",     "KHR_draco_mesh_compression", "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "KHR_texture_transform"};

std::set<std::string> not_supported(const json& root) {
    std::set<std::string> phrases;
    if (!root.contains("extensionsUsed")) return phrases;
    for (const json& entry : root["extensionsUsed"]) {
        const auto& name = entry.get_ref<const std::string&>();
        if (std::ranges::find(named_elsewhere, name) == named_elsewhere.end() && !concerns_shading_only(name))
            phrases.insert("the extension " + in_quotes(name) + " (ignored)");
    }
    return phrases;
}

std::vector<std::string> notes(const json& root) {
    const bool has_variants = root.contains("extensions") && root["extensions"].contains("KHR_materials_variants");
    if (!has_variants) return {};
    return {"has material variants; the materials of its primitives are used"};
}

}  // namespace

std::size_t find_named(const std::filesystem::path& file, const std::vector<std::string>& names,
                       const std::string& name, const std::string& kind) {
    if (const auto found = std::ranges::find(names, name); found != names.end())
        return std::size_t(found - names.begin());
    std::size_t index = 0;
    const char* const end = name.data() + name.size();
    const auto [stopped, error] = std::from_chars(name.data(), end, index);
    if (error == std::errc{} && stopped == end && index < names.size()) return index;
    std::vector<std::string> all;
    for (std::size_t i = 0; i < names.size(); ++i) all.push_back(fmt::format("{} {}", i, in_quotes(names[i])));
    fail(file, "there is no " + kind + " " + in_quotes(name) + ": the file has " +
                   (all.empty() ? "no " + kind + "s" : "these: " + listed(all)));
}

void DecodingBudget::charge(const std::string& what, std::uint64_t count, std::uint64_t bytes_each) {
    if (bytes_each != 0 && count > (max_bytes - bytes) / bytes_each)
        fail(file, "{} unpacks to {} elements of {}, more than the {} MiB of memory that it may take", what, count,
             counted(bytes_each, "byte"), max_bytes >> 20);
    bytes += count * bytes_each;
}

std::size_t element_bytes(const tinygltf::Accessor& accessor) {
    return std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType))) *
           std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)));
}

GltfDocument read_document(const std::filesystem::path& file, const std::optional<std::string>& scene,
                           std::uint64_t memory_bytes) {
    GltfContainer container = read_container(file);
    json root = parse_json(file, container.json);
    container.json = {};
    check_json(file, root);
    GltfDocument document;
    document.not_supported = not_supported(root);
    document.notes = notes(root);
    document.materials = material_sources(root);
    const std::vector<MeshoptView> packed_views = meshopt_views(root);
    document.model = parse(file, container, root);
    DecodingBudget budget{file, 0, memory_bytes};
    unpack_meshopt(document.model, packed_views, budget);
    check_views(file, document.model);
    unpack_draco(document.model, budget, document.warnings);
    document.decoded_bytes = budget.bytes;
    check_accessors(file, document.model);
    document.parents = check_hierarchy(file, document.model);
    document.root_nodes = root_nodes(file, document.model, document.parents, scene);
    return document;
}

}  // namespace gnomon::scene
