// SPDX-License-Identifier: MIT
// The steps of reading a glTF file, in their order: the container, the JSON and its checks, the document. Their errors
// are one sentence that begins with the file and names the wrong part of it.
#pragma once

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <gnomon.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::scene {

// ---- Messages -------------------------------------------------------------------------------------------------------

/// Throws SceneError "FILE: what".
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what);
template <typename First, typename... Rest>
[[noreturn]] void fail(const std::filesystem::path& file, fmt::format_string<First, Rest...> what, First&& first,
                       Rest&&... rest) {
    fail(file, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
}

/// A text of the file in quotes, fit for one line of a terminal: control characters replaced, cut after 60 bytes.
std::string in_quotes(std::string_view text);

/// A name of the file inside a path: unchanged if it is a plain word (POSITION), else in quotes.
std::string word_or_quotes(std::string_view name);

/// "3 triangles", "1 triangle".
std::string counted(std::size_t count, std::string_view thing);

/// "a, b, c and 4 more": at most `most` entries, so that a scene with a thousand entries still gives one readable line.
std::string listed(const std::vector<std::string>& entries, std::size_t most = 8);

// ---- The container --------------------------------------------------------------------------------------------------
// The JSON text, and the range of the binary chunk in a .glb, which is later read directly into its buffer. A file that
// begins with "glTF" is a .glb, whatever its name.

struct ByteRange {
    std::uint64_t offset = 0, size = 0;
};

struct GltfContainer {
    std::string json;
    std::optional<ByteRange> binary_chunk;  ///< of a .glb, if it has one; lies within the file
    bool is_glb = false;
};

/// Throws SceneError if the file is missing, no regular file, empty, cut off, or plainly no glTF.
GltfContainer read_container(const std::filesystem::path& file);

/// Size of a regular file. Throws SceneError (its text names `scene_file`) if `file` is missing or something else.
std::uint64_t file_size(const std::filesystem::path& file, const std::filesystem::path& scene_file);

/// Reads bytes [offset, offset + size) of `file`, which must have them. Throws SceneError.
std::vector<unsigned char> read_bytes(const std::filesystem::path& file, const ByteRange& range,
                                      const std::filesystem::path& scene_file);

// ---- The JSON -------------------------------------------------------------------------------------------------------
// Checked before tinygltf reads it. tinygltf 2.7 ignores a property of the wrong type or sign (a negative byteOffset
// becomes 0, a mesh "3" no mesh), truncates integers to 32 bits and leaves most indices unchecked; so types, ranges and
// indices are checked here, on the exact numbers of the file.

/// Parses the text. Throws SceneError with the byte of the first error, or if the text nests too deep (the recursive
/// code of tinygltf and nlohmann would run out of stack).
nlohmann::json parse_json(const std::filesystem::path& file, const std::string& text);

/// Throws SceneError, naming the property, unless every property that gnomon or tinygltf reads has its type and range,
/// every index is within its array, the version is 2.x and no required extension is unknown.
void check_json(const std::filesystem::path& file, const nlohmann::json& root);

/// True for extensions that change a surface's colour but not its position: safe to ignore without a warning.
bool concerns_shading_only(std::string_view extension);

// ---- Compressed meshes ----------------------------------------------------------------------------------------------
// Both decoders add plain buffers, bufferViews and accessors to the model, so that the code after them knows nothing of
// compression. libdraco may be missing when gnomon is built.

#ifdef GNOMON_HAS_DRACO
inline constexpr bool has_draco = true;
#else
inline constexpr bool has_draco = false;
#endif

/// A bufferView with EXT_meshopt_compression. The sums of its numbers may overflow.
struct MeshoptView {
    std::size_t view = 0, buffer = 0;
    std::uint64_t byte_offset = 0, byte_length = 0, byte_stride = 0, count = 0;
    std::string mode, filter;
};

/// What decoding may take. Crafted streams of a few bytes promise gigabytes, so that each decoder charges its output
/// before it begins.
struct DecodingBudget {
    const std::filesystem::path& file;
    std::uint64_t bytes = 0, max_bytes = 0;

    /// Throws SceneError if `what` does not fit into the rest.
    void charge(const std::string& what, std::uint64_t count, std::uint64_t bytes_each);
};

/// Throws SceneError that names the bufferView.
void unpack_meshopt(tinygltf::Model& model, const std::vector<MeshoptView>& views, DecodingBudget& budget);

/// Replaces the accessors of every primitive with KHR_draco_mesh_compression. Throws SceneError that names the
/// primitive. Adds a sentence to `warnings` where the file declares other counts than the stream holds.
void unpack_draco(tinygltf::Model& model, DecodingBudget& budget, std::vector<std::string>& warnings);

// ---- Materials ------------------------------------------------------------------------------------------------------

/// A material's alpha and base colour texture, before its image is read.
struct MaterialSource {
    bool is_mask = false, is_blend = false;
    bool transmits = false;  ///< KHR_materials_transmission
    float cutoff = 0.5f, alpha_factor = 1;
    bool has_texture = false;
    int coordinates = 0;  ///< TEXCOORD_n
    /// KHR_texture_transform: u = offset[0] + rows[0][0] u + rows[0][1] v, and so on, in double.
    std::array<double, 2> offset{0, 0};
    std::array<std::array<double, 2>, 2> rows{{{1, 0}, {0, 1}}};
    bool has_transform = false;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    TextureFilter filter = TextureFilter::linear;
    TextureMinification minification = TextureMinification::mean;
    int image = -1;          ///< of `images`; -1: there is none that can be read
    std::string unreadable;  ///< why
};

struct ImageSource {
    std::string uri;  ///< a file beside the scene, or a data URI; else the bufferView
    int buffer_view = -1;
};

/// What the file says of alpha and textures.
struct MaterialSources {
    std::map<int, MaterialSource> materials;
    std::map<int, ImageSource> images;  ///< those that materials use, by their index in the file
};

// ---- The document ---------------------------------------------------------------------------------------------------

/// The file in memory, through tinygltf, with checked references: indices, extents, strides, the node hierarchy. The
/// code that uses it may read its accessors without a further check, except for the values in them (vertex indices,
/// sparse indices).
struct GltfDocument {
    tinygltf::Model model;
    std::vector<int> parents;             ///< of each node; -1: a root
    std::vector<int> root_nodes;          ///< of the scene that is shown
    std::set<std::string> not_supported;  ///< phrases for the one warning, from the document alone
    std::vector<std::string> warnings, notes;
    std::uint64_t decoded_bytes = 0;  ///< of compressed meshes
    MaterialSources materials;
};

/// The bytes of a data URI, or of a file beside the scene. Throws SceneError.
std::vector<unsigned char> bytes_of_uri(const std::filesystem::path& file, const std::string& uri);

/// Throws SceneError. `scene`: a name or an index; none: the file's own choice.
GltfDocument read_document(const std::filesystem::path& file, const std::optional<std::string>& scene,
                           std::uint64_t memory_bytes);

/// The entry of this name, or, if no entry has it, of this index. Throws SceneError with the list of the `kind`s.
std::size_t find_named(const std::filesystem::path& file, const std::vector<std::string>& names,
                       const std::string& name, const std::string& kind);

/// Bytes of one element, without padding.
std::size_t element_bytes(const tinygltf::Accessor& accessor);

}  // namespace gnomon::scene
