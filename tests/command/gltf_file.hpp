// SPDX-License-Identifier: MIT
// glTF files of a few triangles, written byte by byte, and a fixture with a folder for them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene.hpp"
#include "support/temporary_folder.hpp"

namespace gltf_file {

using gnomon::Float3;
using gnomon::scene::Scene;
using gnomon::scene::SceneError;
using nlohmann::json;
using Bytes = std::vector<unsigned char>;

constexpr int u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126;

// ---- Writing files --------------------------------------------------------------------------------------------------

template <class T>
void append(Bytes& bytes, T value) {
    bytes.resize(bytes.size() + sizeof value);
    std::memcpy(&bytes[bytes.size() - sizeof value], &value, sizeof value);
}

inline std::string base64(const Bytes& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        unsigned group = unsigned(bytes[i]) << 16;
        if (left > 1) group |= unsigned(bytes[i + 1]) << 8;
        if (left > 2) group |= unsigned(bytes[i + 2]);
        for (std::size_t k = 0; k < 4; ++k) out += k <= left ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

/// A glTF under construction: one buffer, and functions that append to it and describe what they appended. JSON comes
/// as text: what a test says is what the file says (and nlohmann's initializer lists take minutes to compile).
struct Gltf {
    json root = json::parse(R"({"asset": {"version": "2.0"}})");
    Bytes buffer;

    /// Puts a value at a JSON pointer ("/nodes/0/mesh"), or takes it away if the text is empty.
    Gltf& set(const std::string& pointer, const std::string& text) {
        const json::json_pointer place(pointer);
        if (!text.empty())
            root[place] = json::parse(text);
        else
            root[place.parent_pointer()].erase(place.back());
        return *this;
    }
    int add(const char* array, const std::string& text) {
        root[array].push_back(json::parse(text));
        return int(root[array].size()) - 1;
    }
    int view(const Bytes& bytes, int stride = 0) {
        while (buffer.size() % 4 != 0) buffer.push_back(0);
        const std::size_t offset = buffer.size();
        buffer.insert(buffer.end(), bytes.begin(), bytes.end());
        return add("bufferViews", R"({"buffer": 0, "byteOffset": )" + std::to_string(offset) + R"(, "byteLength": )" +
                                      std::to_string(bytes.size()) +
                                      (stride ? R"(, "byteStride": )" + std::to_string(stride) : "") + "}");
    }
    template <class T>
    int view_of(const std::vector<T>& values) {
        Bytes bytes;
        for (const T value : values) append(bytes, value);
        return view(bytes);
    }
    int accessor(int view, int component_type, std::size_t count, const std::string& type) {
        return add("accessors", R"({"bufferView": )" + std::to_string(view) + R"(, "componentType": )" +
                                    std::to_string(component_type) + R"(, "count": )" + std::to_string(count) +
                                    R"(, "type": ")" + type + "\"}");
    }
    int positions(const std::vector<float>& xyz) { return accessor(view_of(xyz), f32, xyz.size() / 3, "VEC3"); }
    template <class T>
    int indices(const std::vector<T>& values) {
        return accessor(view_of(values), sizeof(T) == 1 ? u8 : sizeof(T) == 2 ? u16 : u32, values.size(), "SCALAR");
    }
    int mesh(const std::string& primitive, const std::string& name = "thing") {
        return add("meshes", R"({"name": ")" + name + R"(", "primitives": [)" + primitive + "]}");
    }
    int node(const std::string& text) { return add("nodes", text); }
    /// Makes an accessor sparse; indices and values are bufferViews.
    void make_sparse(int accessor, int count, int indices, int width, int values) {
        set("/accessors/" + std::to_string(accessor) + "/sparse",
            R"({"count": )" + std::to_string(count) + R"(, "indices": {"bufferView": )" + std::to_string(indices) +
                R"(, "componentType": )" + std::to_string(width) + R"(}, "values": {"bufferView": )" +
                std::to_string(values) + "}}");
    }
    std::string data_uri(const std::string& media_type = "application/octet-stream") const {
        return "data:" + media_type + ";base64," + base64(buffer);
    }
    /// One buffer of that length; without a uri if it is empty.
    void set_buffer(const std::string& byte_length, const std::string& uri) {
        set("/buffers", R"([{"byteLength": )" + byte_length + (uri.empty() ? "" : R"(, "uri": ")" + uri + "\"") + "}]");
    }

    /// As a .gltf with a data URI, unless the buffers were written by hand.
    std::string text() const {
        Gltf out = *this;
        if (!buffer.empty() && !root.contains("buffers")) out.set_buffer(std::to_string(buffer.size()), data_uri());
        return out.root.dump();
    }
    Bytes glb() {
        if (!buffer.empty() && !root.contains("buffers")) set_buffer(std::to_string(buffer.size()), "");
        std::string text = root.dump();
        while (text.size() % 4 != 0) text += ' ';
        Bytes chunk = buffer;
        while (chunk.size() % 4 != 0) chunk.push_back(0);
        Bytes out;
        append(out, std::uint32_t(0x46546C67));
        append(out, std::uint32_t(2));
        append(out, std::uint32_t(20 + text.size() + (chunk.empty() ? 0 : 8 + chunk.size())));
        append(out, std::uint32_t(text.size()));
        append(out, std::uint32_t(0x4E4F534A));
        out.insert(out.end(), text.begin(), text.end());
        if (chunk.empty()) return out;
        append(out, std::uint32_t(chunk.size()));
        append(out, std::uint32_t(0x004E4942));
        out.insert(out.end(), chunk.begin(), chunk.end());
        return out;
    }
};

inline const std::vector<float> one_triangle{0, 0, 0, 1, 0, 0, 0, 1, 0};
inline const std::vector<float> five_points{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};

/// One mesh of one triangle under one node; most tests change a line of it.
inline Gltf triangle_file(const std::vector<float>& xyz = one_triangle) {
    Gltf gltf;
    gltf.positions(xyz);
    gltf.mesh(R"({"attributes": {"POSITION": 0}})");
    gltf.node(R"({"name": "place", "mesh": 0})");
    return gltf;
}

/// Five points, indexed in order.
inline Gltf indexed_file(int mode, int count = 5) {
    Gltf gltf;
    gltf.positions(five_points);
    std::vector<std::uint16_t> order{0, 1, 2, 3, 4};
    order.resize(std::size_t(count));
    gltf.indices(order);
    gltf.mesh(R"({"attributes": {"POSITION": 0}, "indices": 1, "mode": )" + std::to_string(mode) + "}");
    gltf.node(R"({"mesh": 0})");
    return gltf;
}

class SceneFile : public testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        // A new file each time: ext4 writes a truncated one to the disk at once.
        std::filesystem::remove(folder / name);
        std::ofstream(folder / name, std::ios::binary) << text;
        return folder / name;
    }
    std::filesystem::path write(const std::string& name, const Bytes& bytes) const {
        return write(name, std::string(bytes.begin(), bytes.end()));
    }
    std::filesystem::path write(const Gltf& gltf) const { return write("scene.gltf", gltf.text()); }
    Scene load(const Gltf& gltf, const gnomon::scene::LoadOptions& options = {}) const {
        return gnomon::scene::load(write(gltf), options);
    }
    /// The scene at a time of its first animation.
    Scene load_at(const Gltf& gltf, double time_s) const { return load(gltf, {.time_s = time_s}); }

    /// The sentence that loading gives. It must be one line that begins with the file and holds all the words.
    void expect_error(const std::filesystem::path& file, const std::vector<std::string>& words,
                      std::uint64_t memory_bytes = 0, std::optional<double> time_s = {}) const {
        try {
            gnomon::scene::load(file, {.memory_bytes = memory_bytes, .time_s = time_s});
            ADD_FAILURE() << "no error; expected one about " << words.front();
        } catch (const SceneError& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with(file.string() + ": ")) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            for (const std::string& word : words) EXPECT_NE(what.find(word), std::string::npos) << word << "\n" << what;
        }
    }
    void expect_error(const Gltf& gltf, const std::vector<std::string>& words, std::uint64_t memory_bytes = 0,
                      std::optional<double> time_s = {}) const {
        expect_error(write(gltf), words, memory_bytes, time_s);
    }

    /// Exactly one warning has all the words.
    static void expect_warning(const Scene& scene, const std::vector<std::string>& words) {
        std::size_t matching = 0;
        for (const std::string& warning : scene.warnings)
            matching += std::all_of(words.begin(), words.end(),
                                    [&](const std::string& word) { return warning.find(word) != std::string::npos; });
        EXPECT_EQ(matching, 1u) << words.front() << " in " << testing::PrintToString(scene.warnings);
    }

    const support::TemporaryFolder made_;
    const std::filesystem::path folder = made_.path();
};

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace gltf_file
