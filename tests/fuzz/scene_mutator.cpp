// SPDX-License-Identifier: MIT
// Keeps the fuzzer's scenes sound enough to get past the parser: mutates the JSON as a tree, and packs it again with a
// .glb's lengths set right. A third of the time bytes are mutated as libFuzzer does it, for the parser's own sake.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

namespace {

using nlohmann::json;

/// A file taken apart. `binary` is what follows the JSON chunk of a .glb.
struct File {
    std::string text, binary;
    bool is_glb = false;
};

File taken_apart(const std::string& bytes) {
    std::uint32_t length = 0;
    if (bytes.size() < 20 || bytes.compare(0, 4, "glTF") != 0) return {bytes, "", false};
    std::memcpy(&length, &bytes[12], 4);
    length = std::uint32_t(std::min<std::size_t>(length, bytes.size() - 20));
    return {bytes.substr(20, length), bytes.substr(20 + length), true};
}

std::string packed(const File& file) {
    if (!file.is_glb) return file.text;
    std::string text = file.text;
    while (text.size() % 4 != 0) text += ' ';
    std::string bytes = "glTF";
    const auto add = [&](std::size_t number) {
        for (int i = 0; i < 4; ++i) bytes += char(number >> (8 * i) & 255);
    };
    add(2);
    add(20 + text.size() + file.binary.size());
    add(text.size());
    return bytes + "JSON" + text + file.binary;
}

class Mutation {
public:
    explicit Mutation(unsigned seed) : random_(seed) {}

    void operator()(json& root) {
        collect(root, 0);
        json& place = *any(nodes_);
        switch (below(6)) {
            case 0:
                place = json(*any(nodes_));
                break;  // a copy first: one may lie within the other
            case 1:
                place = number();
                break;
            case 2:
                place = text();
                break;
            case 3:
                remove_from(place);
                break;
            case 4:
                add_to(place);
                break;
            default:
                if (place.is_number_integer())
                    place = place.get<std::uint64_t>() + below(5) - 2;  // may wrap
                else
                    add_to(place);
        }
    }

private:
    std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }
    template <typename T>
    const T& any(const std::vector<T>& values) {
        return values[below(values.size())];
    }

    void collect(json& value, int depth) {
        nodes_.push_back(&value);
        if (value.is_structured() && depth < 100)
            for (json& inner : value) collect(inner, depth + 1);
    }

    json number() {
        static const std::vector<json> numbers = {0,
                                                  1,
                                                  2,
                                                  3,
                                                  4,
                                                  5,
                                                  6,
                                                  8,
                                                  12,
                                                  16,
                                                  20,
                                                  64,
                                                  100,
                                                  252,
                                                  255,
                                                  256,
                                                  65535,
                                                  65536,
                                                  5120,
                                                  5121,
                                                  5122,
                                                  5123,
                                                  5125,
                                                  5126,
                                                  9728,
                                                  10497,
                                                  33071,
                                                  33648,
                                                  -1,
                                                  2147483647,
                                                  2147483648u,
                                                  4294967295u,
                                                  4294967296u,
                                                  std::numeric_limits<std::int64_t>::max(),
                                                  std::numeric_limits<std::uint64_t>::max(),
                                                  std::numeric_limits<std::int64_t>::min(),
                                                  0.5,
                                                  -0.0,
                                                  1e-320,
                                                  1e-45,
                                                  1e38,
                                                  4e38,
                                                  1e308,
                                                  1e-6,
                                                  0.70710678};
        return any(numbers);
    }

    const std::string& text() {
        static const std::vector<std::string> texts = {
            "POSITION",
            "NORMAL",
            "attributes",
            "indices",
            "mode",
            "material",
            "targets",
            "primitives",
            "meshes",
            "mesh",
            "nodes",
            "children",
            "matrix",
            "rotation",
            "scale",
            "translation",
            "skin",
            "camera",
            "cameras",
            "lights",
            "light",
            "extensions",
            "extensionsUsed",
            "extensionsRequired",
            "KHR_lights_punctual",
            "KHR_mesh_quantization",
            "KHR_draco_mesh_compression",
            "EXT_meshopt_compression",
            "EXT_mesh_gpu_instancing",
            "KHR_materials_unlit",
            "accessors",
            "bufferView",
            "bufferViews",
            "buffer",
            "buffers",
            "byteOffset",
            "byteLength",
            "byteStride",
            "componentType",
            "count",
            "type",
            "normalized",
            "sparse",
            "values",
            "uri",
            "SCALAR",
            "VEC2",
            "VEC3",
            "VEC4",
            "MAT4",
            "perspective",
            "orthographic",
            "yfov",
            "znear",
            "aspectRatio",
            "directional",
            "point",
            "spot",
            "alphaMode",
            "MASK",
            "BLEND",
            "pbrMetallicRoughness",
            "baseColorTexture",
            "index",
            "texCoord",
            "TEXCOORD_0",
            "TEXCOORD_1",
            "COLOR_0",
            "alphaCutoff",
            "textures",
            "images",
            "source",
            "wrapS",
            "wrapT",
            "magFilter",
            "KHR_texture_transform",
            "offset",
            "EXT_texture_webp",
            "KHR_texture_basisu",
            "KHR_materials_transmission",
            "transmissionFactor",
            "data:image/png;base64,AAAA",
            "baseColorFactor",
            "scene",
            "scenes",
            "asset",
            "version",
            "minVersion",
            "2.0",
            "name",
            "animations",
            "skins",
            "joints",
            "inverseBindMatrices",
            "JOINTS_0",
            "WEIGHTS_0",
            "weights",
            "samplers",
            "channels",
            "sampler",
            "target",
            "path",
            "input",
            "output",
            "interpolation",
            "STEP",
            "LINEAR",
            "CUBICSPLINE",
            "TRANSLATION",
            "ROTATION",
            "SCALE",
            "filter",
            "ATTRIBUTES",
            "TRIANGLES",
            "INDICES",
            "OCTAHEDRAL",
            "QUATERNION",
            "EXPONENTIAL",
            "fallback",
            "data.bin",
            "data:application/octet-stream;base64,AAAAAAAAgD8AAIA/AAAAAAAAAAA=",
            "data:,x",
            "../data.bin",
            "%64ata.bin",
            "http://x/y",
            "a\nb\x1b",
            ""};
        return any(texts);
    }

    void remove_from(json& place) {
        if (place.empty() || !place.is_structured()) return;
        auto at = place.begin();
        std::advance(at, std::ptrdiff_t(below(place.size())));
        place.erase(at);
    }

    /// Copies are made before the place changes: what is copied may lie within it, or hold it.
    void add_to(json& place) {
        json added = below(2) != 0 ? json(*any(nodes_)) : below(2) != 0 ? json(text()) : number();
        if (place.is_array()) place.insert(place.begin() + std::ptrdiff_t(below(place.size() + 1)), std::move(added));
        if (place.is_object()) place[text()] = std::move(added);
    }

    std::mt19937 random_;
    std::vector<json*> nodes_;
};

/// Deeper texts than this are left to the mutation of bytes: walking the tree here takes the stack.
bool is_shallow(const std::string& text) {
    int depth = 0;
    return std::all_of(text.begin(), text.end(), [&](char c) {
        depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
        return depth < 200;
    });
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
    if (seed % 3 == 0) return LLVMFuzzerMutate(data, size, most);
    File file = taken_apart({reinterpret_cast<const char*>(data), size});
    json root = is_shallow(file.text) ? json::parse(file.text, nullptr, false) : json(json::value_t::discarded);
    if (root.is_discarded()) return LLVMFuzzerMutate(data, size, most);
    for (unsigned i = 0; i <= seed / 3 % 4; ++i) Mutation(seed + i)(root);
    if (seed / 12 % 4 == 0 && !file.binary.empty()) {
        const std::size_t before = file.binary.size();
        file.binary.resize(before + 16);
        file.binary.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(file.binary.data()), before, before + 16));
    }
    file.text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    const std::string bytes = packed(file);
    if (bytes.size() > most) return LLVMFuzzerMutate(data, size, most);
    std::copy(bytes.begin(), bytes.end(), data);
    return bytes.size();
}
