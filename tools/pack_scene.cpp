// SPDX-License-Identifier: MIT
// pack_scene: packs the geometry of a .glb file with EXT_meshopt_compression and loses nothing. Attributes are packed
// in the mode ATTRIBUTES without a filter, indices in the mode INDICES: unlike TRIANGLES, it keeps the order of the
// triangles and of their corners. The rest of the JSON stays as it is, but for asset.copyright.
#include <fmt/core.h>
#include <meshoptimizer.h>

#include <CLI/CLI.hpp>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

static_assert(std::endian::native == std::endian::little,
              "a .glb file is little-endian, and arrays are used as they lie");

using Json = nlohmann::ordered_json;

constexpr const char* extension_name = "EXT_meshopt_compression";
constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
constexpr int float32 = 5126, uint32 = 5125, index_target = 34963;

/// Something that a person can put right; what() is one sentence.
struct PackError : std::runtime_error {
    using runtime_error::runtime_error;
};

/// A .glb file with one buffer, its binary chunk.
struct Glb {
    Json json;
    std::string binary;
};

/// `bytes` from a place on; throws PackError where there are fewer.
std::string part(const std::string& text, std::size_t from, std::size_t bytes) {
    if (from > text.size() || bytes > text.size() - from) throw PackError("the file is cut off");
    return text.substr(from, bytes);
}

std::uint32_t word(const std::string& text, std::size_t from) {
    std::uint32_t value;
    std::memcpy(&value, part(text, from, sizeof value).data(), sizeof value);
    return value;
}

Glb read_glb(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw PackError("cannot read '" + file + "'");
    if (word(bytes, 0) != magic || word(bytes, 4) != 2 || word(bytes, 16) != json_chunk)
        throw PackError("'" + file + "' is not a .glb file of glTF 2.0");
    const std::size_t json_bytes = word(bytes, 12), binary_at = 20 + json_bytes;
    Glb glb{Json::parse(part(bytes, 20, json_bytes)), {}};
    const Json& buffers = glb.json.value("buffers", Json::array());
    if (buffers.size() != 1 || buffers[0].contains("uri") || word(bytes, binary_at + 4) != binary_chunk)
        throw PackError("only a file with one buffer, its binary chunk, can be packed");
    glb.binary = part(bytes, binary_at + 8, word(bytes, binary_at));
    return glb;
}

void write_glb(const Glb& glb, const std::string& file) {
    std::string json = glb.json.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string binary = glb.binary;
    binary.resize((binary.size() + 3) / 4 * 4);
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    const auto write_words = [&](std::initializer_list<std::size_t> words) {
        for (const std::size_t value : words) {
            const auto bits = std::uint32_t(value);
            stream.write(reinterpret_cast<const char*>(&bits), sizeof bits);
        }
    };
    write_words({magic, 2, 12 + 8 + json.size() + 8 + binary.size(), json.size(), json_chunk});
    stream << json;
    write_words({binary.size(), binary_chunk});
    stream << binary;
    if (!stream.flush()) throw PackError("cannot write '" + file + "'");
}

/// The accessor that reads a view. The others that read it have the same type.
const Json& accessor_of(const Json& root, std::size_t view) {
    for (const Json& accessor : root.at("accessors"))
        if (accessor.at("bufferView") == view) return accessor;
    throw PackError(fmt::format("no accessor reads bufferViews[{}]", view));
}

std::size_t components_of(const Json& accessor) {
    const std::string type = accessor.at("type");
    return type == "SCALAR" ? 1 : std::size_t(type.back() - '0');  // VEC2, VEC3, VEC4
}

std::string attribute_stream(const std::string& bytes, std::size_t count, std::size_t stride) {
    std::string stream(meshopt_encodeVertexBufferBound(count, stride), '\0');
    stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                             bytes.data(), count, stride));
    return stream;
}

std::string index_stream(const std::string& bytes) {
    std::vector<std::uint32_t> indices(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(indices.data(), bytes.data(), bytes.size());
    std::string stream(meshopt_encodeIndexSequenceBound(indices.size(), std::numeric_limits<std::uint32_t>::max()),
                       '\0');
    stream.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                              indices.data(), indices.size()));
    return stream;
}

/// Packs a view of `glb`: adds the stream of its bytes to `streams`, and the extension that describes it to the view.
void pack_view(Glb& glb, std::size_t index, std::string& streams) {
    Json& view = glb.json["bufferViews"][index];
    const Json& accessor = accessor_of(glb.json, index);
    const bool has_indices = view.value("target", 0) == index_target;
    if (accessor.at("componentType") != (has_indices ? uint32 : float32) || view.contains("byteStride"))
        throw PackError(
            fmt::format("bufferViews[{}] holds neither indices of 32 bits nor one attribute of float32", index));
    const std::string bytes = part(glb.binary, view.value("byteOffset", std::size_t(0)), view.at("byteLength"));
    const std::size_t stride = sizeof(float) * components_of(accessor), count = bytes.size() / stride;
    const std::string stream = has_indices ? index_stream(bytes) : attribute_stream(bytes, count, stride);
    view["buffer"] = 1;
    if (!has_indices) view["byteStride"] = stride;
    view["extensions"][extension_name] = {{"buffer", 0},
                                          {"byteOffset", streams.size()},
                                          {"byteLength", stream.size()},
                                          {"byteStride", stride},
                                          {"count", count},
                                          {"mode", has_indices ? "INDICES" : "ATTRIBUTES"}};
    streams += stream;
}

/// Buffer 0 becomes that of the streams; buffer 1 stands for the unpacked bytes, which the file does not hold.
void pack(Glb& glb, const std::string& copyright) {
    // The extension is defined for these versions of the streams.
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    std::string streams;
    for (std::size_t i = 0; i < glb.json.at("bufferViews").size(); ++i) pack_view(glb, i, streams);
    Json unpacked = glb.json["buffers"][0];
    unpacked["extensions"][extension_name] = {{"fallback", true}};
    glb.json["buffers"] = {{{"byteLength", streams.size()}}, std::move(unpacked)};
    glb.json["asset"]["copyright"] = copyright;
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) glb.json[list].push_back(extension_name);
    glb.binary = std::move(streams);
}

}  // namespace

int main(int argc, char** argv) {
    std::string input, output, copyright;
    CLI::App app{"Packs the geometry of a .glb file with EXT_meshopt_compression, without loss."};
    app.add_option("input", input, "the file to pack (.glb)")->required();
    app.add_option("-o,--output", output, "the file to write (.glb)")->required();
    app.add_option("--copyright", copyright, "asset.copyright: author, licence and changes")->required();
    try {
        app.parse(argc, argv);
        Glb glb = read_glb(input);
        pack(glb, copyright);
        write_glb(glb, output);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "pack_scene: %s\n", error.what());
        return 1;
    }
    return 0;
}
