// SPDX-License-Identifier: MIT
// GLB 2.0: a 12-byte header (magic, version, length), then chunks (length, type, bytes); the first is JSON, the second,
// if there is one, BIN. All numbers are little-endian uint32. Every length is checked against the file before a read.
#include "gltf.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <system_error>

namespace gnomon::scene {
namespace {

constexpr std::uint64_t header_bytes = 12, chunk_header_bytes = 8;
constexpr std::uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;

std::uint32_t little_endian_u32(const unsigned char* bytes) {
    return std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8 | std::uint32_t(bytes[2]) << 16 |
           std::uint32_t(bytes[3]) << 24;
}

/// What a sentence about a file that belongs to a scene begins with: its name as the scene has it.
std::string subject_of(const std::filesystem::path& file, const std::filesystem::path& scene_file) {
    if (file == scene_file) return {};
    return "its file " + in_quotes(file.lexically_proximate(scene_file.parent_path()).string()) + " ";
}

std::string read_text(const std::filesystem::path& file, const ByteRange& range) {
    const std::vector<unsigned char> bytes = read_bytes(file, range, file);
    return {bytes.begin(), bytes.end()};
}

/// True if the text begins as JSON does; checked before a file of any size is read as text.
bool begins_like_json(std::string_view head) {
    if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
    const std::size_t first = head.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && head[first] == '{';
}

GltfContainer read_glb(const std::filesystem::path& file, std::uint64_t size) {
    const auto cut_off = [&](const std::string& what) {
        fail(file, "the .glb is cut off: " + what + "; copy or export it again");
    };
    if (size < header_bytes + chunk_header_bytes) cut_off("its header is incomplete");
    const std::vector<unsigned char> header = read_bytes(file, {0, header_bytes}, file);
    const std::uint32_t version = little_endian_u32(&header[4]);
    const std::uint64_t length = little_endian_u32(&header[8]);
    if (version != 2) fail(file, "is a .glb of version {}; only version 2 can be read: export it as glTF 2.0", version);
    if (length > size)
        cut_off(fmt::format("its header promises {}, but the file has only {}", counted(length, "byte"), size));

    GltfContainer container;
    container.is_glb = true;
    std::uint64_t offset = header_bytes;
    for (int index = 0; offset < length; ++index) {
        if (length - offset < chunk_header_bytes) cut_off(fmt::format("chunk {} has no complete header", index));
        const std::vector<unsigned char> chunk = read_bytes(file, {offset, chunk_header_bytes}, file);
        const ByteRange body{offset + chunk_header_bytes, little_endian_u32(&chunk[0])};
        const std::uint32_t type = little_endian_u32(&chunk[4]);
        if (body.size > length - body.offset)
            cut_off(fmt::format("chunk {} needs {}, but only {} are left", index, counted(body.size, "byte"),
                                length - body.offset));
        if ((index == 0) != (type == chunk_json)) fail(file, "the .glb's first chunk, and only that, must be JSON");
        if (index == 0) container.json = read_text(file, body);
        if (index == 1 && type == chunk_bin) container.binary_chunk = body;
        offset = body.offset + body.size;
    }
    if (offset == header_bytes) fail(file, "the .glb has no JSON chunk");
    return container;
}

}  // namespace

std::uint64_t file_size(const std::filesystem::path& file, const std::filesystem::path& scene_file) {
    const std::string subject = subject_of(file, scene_file);
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (status.type() == std::filesystem::file_type::not_found) fail(scene_file, subject + "does not exist");
    if (error) fail(scene_file, subject + "cannot be read: " + error.message());
    if (std::filesystem::is_directory(status)) fail(scene_file, subject + "is a directory, not a file");
    if (!std::filesystem::is_regular_file(status)) fail(scene_file, subject + "is not a regular file");
    const std::uint64_t size = std::filesystem::file_size(file, error);
    if (error) fail(scene_file, subject + "cannot be read: " + error.message());
    return size;
}

std::vector<unsigned char> read_bytes(const std::filesystem::path& file, const ByteRange& range,
                                      const std::filesystem::path& scene_file) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<unsigned char> bytes(range.size);
    stream.seekg(static_cast<std::streamoff>(range.offset));
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(range.size));
    if (!stream) fail(scene_file, subject_of(file, scene_file) + "cannot be read: check its permissions");
    return bytes;
}

GltfContainer read_container(const std::filesystem::path& file) {
    const std::uint64_t size = file_size(file, file);
    if (size == 0) fail(file, "the file is empty");
    const std::string head = read_text(file, {0, std::min<std::uint64_t>(size, 4096)});
    if (head.size() >= 4 && little_endian_u32(reinterpret_cast<const unsigned char*>(head.data())) == magic_gltf)
        return read_glb(file, size);
    if (!begins_like_json(head))
        fail(file,
             "is not a glTF file: it begins neither with 'glTF' (.glb) nor with '{' (.gltf): export it as glTF 2.0");
    return {read_text(file, {0, size}), std::nullopt, false};
}

}  // namespace gnomon::scene
