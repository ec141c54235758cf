// SPDX-License-Identifier: MIT
// KHR_draco_mesh_compression by libdraco. A stream of a few bytes can promise 2^32 faces or attributes of any width,
// and libdraco reserves memory for them; so its decoders are derived here and charge the budget once the counts are
// known.
#include "gltf.hpp"

#ifdef GNOMON_HAS_DRACO
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstring>
#include <memory>
#endif

namespace gnomon::scene {

#ifdef GNOMON_HAS_DRACO
namespace {

constexpr const char* extension_name = "KHR_draco_mesh_compression";

/// libdraco's tables while it decodes, at most: corners, opposite corners, vertices and a traversal's marks.
constexpr std::uint64_t bytes_per_face = 256, bytes_per_point = 64;

/// Draco's entropy coder takes next to nothing for a regular mesh, but no real one takes less than 1/64 bit per face.
std::uint64_t max_elements(std::uint64_t stream_bytes) { return (std::uint64_t(1) << 22) + 512 * stream_bytes; }

template <class Decoder>
class Bounded final : public Decoder {
public:
    Bounded(DecodingBudget& budget, const std::string& what) : budget_(budget), what_(what) {}

protected:
    /// The connectivity begins with two counts: of vertices and faces, or, without Edgebreaker, of faces and points.
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        std::uint32_t first = 0, second = 0;
        if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
        const auto left = std::uint64_t(ahead.remaining_size());
        if (std::max(first, second) > max_elements(left))
            fail(budget_.file, "{} promises {} elements in a Draco stream of {}; export it again", what_,
                 std::max(first, second), counted(left, "byte"));
        constexpr bool is_edgebreaker = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;
        budget_.charge(what_, is_edgebreaker ? second : first, bytes_per_face);
        budget_.charge(what_, is_edgebreaker ? first : second, bytes_per_point);
        return Decoder::DecodeConnectivity();
    }
    bool DecodeAllAttributes() override {
        const draco::PointCloud& cloud = *this->point_cloud();
        for (int i = 0; i < cloud.num_attributes(); ++i) {
            // Attributes are decoded to 32-bit integers first.
            const auto components = std::uint64_t(std::max<int>(1, cloud.attribute(i)->num_components()));
            const auto bytes = std::uint64_t(std::max<std::int64_t>(0, cloud.attribute(i)->byte_stride()));
            budget_.charge(what_, cloud.num_points(), bytes + components * 2 * sizeof(std::int32_t));
        }
        return Decoder::DecodeAllAttributes();
    }

private:
    DecodingBudget& budget_;
    const std::string& what_;
};

std::unique_ptr<draco::MeshDecoder> make_decoder(const draco::DracoHeader& header, DecodingBudget& budget,
                                                 const std::string& what) {
    if (header.encoder_type != draco::TRIANGULAR_MESH || header.version_major != 2 || header.version_minor != 2)
        fail(budget.file, "{} holds a Draco stream of version {}.{}; {} needs a mesh of version 2.2", what,
             header.version_major, header.version_minor, extension_name);
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
        return std::make_unique<Bounded<draco::MeshEdgebreakerDecoder>>(budget, what);
    return std::make_unique<Bounded<draco::MeshSequentialDecoder>>(budget, what);
}

std::unique_ptr<draco::Mesh> decode(const tinygltf::Model& model, int view, DecodingBudget& budget,
                                    const std::string& what) {
    const tinygltf::BufferView& v = model.bufferViews[std::size_t(view)];
    const char* bytes = reinterpret_cast<const char*>(model.buffers[std::size_t(v.buffer)].data.data()) + v.byteOffset;
    const auto cannot = [&](const std::string& why) {
        fail(budget.file, what + " holds no Draco stream that can be decoded (" + why + "); export it again");
    };
    draco::DecoderBuffer head, stream;
    head.Init(bytes, v.byteLength);
    stream.Init(bytes, v.byteLength);
    draco::DracoHeader header;
    if (const draco::Status status = draco::PointCloudDecoder::DecodeHeader(&head, &header); !status.ok())
        cannot(status.error_msg_string());
    const std::unique_ptr<draco::MeshDecoder> decoder = make_decoder(header, budget, what);
    auto mesh = std::make_unique<draco::Mesh>();
    if (const draco::Status status = decoder->Decode(draco::DecoderOptions(), &stream, mesh.get()); !status.ok())
        cannot(status.error_msg_string());
    return mesh;
}

/// Appends an accessor with its own buffer and view; returns its index.
int add_accessor(tinygltf::Model& model, tinygltf::Accessor accessor, std::vector<unsigned char> bytes) {
    tinygltf::BufferView view;
    view.buffer = int(model.buffers.size());
    view.byteLength = bytes.size();
    model.buffers.emplace_back().data = std::move(bytes);
    accessor.bufferView = int(model.bufferViews.size());
    accessor.byteOffset = 0;
    accessor.sparse.isSparse = false;
    model.bufferViews.push_back(std::move(view));
    model.accessors.push_back(std::move(accessor));
    return int(model.accessors.size()) - 1;
}

template <class T>
bool copy_values(const draco::Mesh& mesh, const draco::PointAttribute& from, std::size_t components,
                 std::vector<unsigned char>& to) {
    to.resize(mesh.num_points() * components * sizeof(T));
    std::vector<T> value(components);
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex index = from.mapped_index(draco::PointIndex(i));
        if (index.value() >= from.size() || !from.ConvertValue<T>(index, std::int8_t(components), value.data()))
            return false;
        std::memcpy(&to[i * components * sizeof(T)], value.data(), components * sizeof(T));
    }
    return true;
}

bool copy_values(int component_type, const draco::Mesh& mesh, const draco::PointAttribute& from, std::size_t components,
                 std::vector<unsigned char>& to) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return copy_values<std::int8_t>(mesh, from, components, to);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return copy_values<std::uint8_t>(mesh, from, components, to);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return copy_values<std::int16_t>(mesh, from, components, to);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return copy_values<std::uint16_t>(mesh, from, components, to);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return copy_values<std::uint32_t>(mesh, from, components, to);
        default:
            return copy_values<float>(mesh, from, components, to);
    }
}

std::vector<unsigned char> indices_of(const draco::Mesh& mesh) {
    std::vector<unsigned char> bytes(std::size_t(mesh.num_faces()) * 3 * sizeof(std::uint32_t));
    for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t point = mesh.face(draco::FaceIndex(i))[k].value();
            std::memcpy(&bytes[(3 * i + k) * sizeof point], &point, sizeof point);
        }
    return bytes;
}

/// The primitive reads new accessors from here on. Its triangles are a list, whatever the mode of the file.
void unpack(tinygltf::Model& model, tinygltf::Primitive& primitive, DecodingBudget& budget, const std::string& what,
            std::vector<std::string>& warnings) {
    const tinygltf::Value& extension = primitive.extensions.at(extension_name);
    const std::uint64_t kept_before = budget.bytes;
    std::uint64_t kept = 0;
    const std::unique_ptr<draco::Mesh> mesh = decode(model, extension.Get("bufferView").GetNumberAsInt(), budget, what);
    std::vector<std::string> other_counts;
    const auto compare = [&](const std::string& name, std::size_t declared, std::size_t decoded) {
        if (declared == decoded) return;
        other_counts.push_back(fmt::format("{} {} for {}", name, decoded, declared));
    };
    const tinygltf::Value& ids = extension.Get("attributes");
    for (auto& [name, accessor] : primitive.attributes) {
        if (!ids.Has(name)) continue;
        // tinygltf keeps an id from 2^31 on as a negative int.
        const draco::PointAttribute* const from =
            mesh->GetAttributeByUniqueId(std::uint32_t(ids.Get(name).GetNumberAsInt()));
        tinygltf::Accessor unpacked = model.accessors[std::size_t(accessor)];
        const auto components = std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(unpacked.type)));
        budget.charge(what, mesh->num_points(), element_bytes(unpacked));
        kept += mesh->num_points() * element_bytes(unpacked);
        std::vector<unsigned char> bytes;
        if (!from || !copy_values(unpacked.componentType, *mesh, *from, components, bytes))
            fail(budget.file, what + " has no attribute " + word_or_quotes(name) + " in its Draco stream");
        compare(word_or_quotes(name), unpacked.count, mesh->num_points());
        unpacked.count = mesh->num_points();
        accessor = add_accessor(model, std::move(unpacked), std::move(bytes));
    }
    tinygltf::Accessor indices;
    indices.type = TINYGLTF_TYPE_SCALAR;
    indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    indices.count = std::size_t(mesh->num_faces()) * 3;
    const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    if (is_list && primitive.indices >= 0)
        compare("indices", model.accessors[std::size_t(primitive.indices)].count, indices.count);
    budget.charge(what, indices.count, sizeof(std::uint32_t));
    primitive.indices = add_accessor(model, std::move(indices), indices_of(*mesh));
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    budget.bytes = kept_before + kept + model.accessors.back().count * sizeof(std::uint32_t);  // the decoder's are free
    if (!other_counts.empty())
        warnings.push_back(what +
                           " has other counts in its Draco stream than the file declares, and the stream's are " +
                           "taken: " + listed(other_counts));
}

}  // namespace

void unpack_draco(tinygltf::Model& model, DecodingBudget& budget, std::vector<std::string>& warnings) {
    for (std::size_t mesh = 0; mesh < model.meshes.size(); ++mesh)
        for (std::size_t i = 0; i < model.meshes[mesh].primitives.size(); ++i) {
            tinygltf::Primitive& primitive = model.meshes[mesh].primitives[i];
            if (!primitive.extensions.contains(extension_name) || primitive.mode < TINYGLTF_MODE_TRIANGLES) continue;
            const std::string& name = model.meshes[mesh].name;
            const std::string what =
                fmt::format("primitive {} of mesh {}", i, name.empty() ? std::to_string(mesh) : in_quotes(name));
            unpack(model, primitive, budget, what, warnings);
        }
}

#else

void unpack_draco(tinygltf::Model&, DecodingBudget&, std::vector<std::string>&) {}

#endif

}  // namespace gnomon::scene
