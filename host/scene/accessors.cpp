// SPDX-License-Identifier: MIT
#include "accessors.hpp"

#include <algorithm>
#include <iterator>

#include "no_data.hpp"

namespace gnomon::scene {
namespace {

template <class T>
T value_at(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

std::uint32_t read_index(const unsigned char* from, int component_type) {
    if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *from;
    if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return value_at<std::uint16_t>(from);
    return value_at<std::uint32_t>(from);
}

std::size_t component_bytes(int component_type) {
    return std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(component_type)));
}

}  // namespace

double Elements::number(std::size_t element, int component) const {
    const unsigned char* from = first + element * stride + std::size_t(component) * component_bytes(component_type);
    // glTF 2.0, 3.11: a signed integer's least value stands for -1, as does the next one.
    const auto signed_part = [&](double value, double one) {
        return is_normalized ? std::max(value / one, -1.0) : value;
    };
    const auto unsigned_part = [&](double value, double one) { return is_normalized ? value / one : value; };
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return signed_part(value_at<std::int8_t>(from), 127);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return unsigned_part(*from, 255);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return signed_part(value_at<std::int16_t>(from), 32767);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return unsigned_part(value_at<std::uint16_t>(from), 65535);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return unsigned_part(value_at<std::uint32_t>(from), 4294967295.0);
        default:
            return value_at<float>(from);
    }
}

std::uint32_t Elements::index(std::size_t element, int component) const {
    return read_index(first + element * stride + std::size_t(component) * component_bytes(component_type),
                      component_type);
}

const unsigned char* Accessors::bytes_at(int view, std::size_t offset) const {
    const tinygltf::BufferView& v = model_.bufferViews[std::size_t(view)];
    return model_.buffers[std::size_t(v.buffer)].data.data() + v.byteOffset + offset;
}

/// Calls put(element, bytes of its new value) for each sparse element, once its index is known to be in range.
template <class Put>
void Accessors::for_each_sparse(int index, const Put& put) const {
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
    if (!accessor.sparse.isSparse) return;
    const auto& sparse = accessor.sparse;
    const auto packed_or = [&](int view, std::size_t bytes) {
        const std::size_t stride = model_.bufferViews[std::size_t(view)].byteStride;
        return stride == 0 ? bytes : stride;
    };
    const std::size_t index_stride =
        packed_or(sparse.indices.bufferView, component_bytes(sparse.indices.componentType));
    const std::size_t value_stride = packed_or(sparse.values.bufferView, element_bytes(accessor));
    const unsigned char* indices = bytes_at(sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset));
    const unsigned char* values = bytes_at(sparse.values.bufferView, std::size_t(sparse.values.byteOffset));
    for (std::size_t i = 0; i < std::size_t(sparse.count); ++i) {
        const std::uint32_t element = read_index(indices + i * index_stride, sparse.indices.componentType);
        if (element >= accessor.count)
            fail(file_, "{}.sparse names element {}, but the accessor has a count of {}", text(index), element,
                 accessor.count);
        put(element, values + i * value_stride);
    }
}

const Elements& Accessors::elements(int index) {
    if (const auto it = elements_.find(index); it != elements_.end()) return it->second;
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
    const std::size_t bytes = element_bytes(accessor);
    Elements out;
    out.count = accessor.count;
    out.component_type = accessor.componentType;
    out.components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    out.is_normalized = accessor.normalized;
    if (accessor.bufferView >= 0) {
        const std::size_t stride = model_.bufferViews[std::size_t(accessor.bufferView)].byteStride;
        out.first = bytes_at(accessor.bufferView, accessor.byteOffset);
        out.stride = stride == 0 ? bytes : stride;
    }
    if (accessor.sparse.isSparse || accessor.bufferView < 0) {
        out.own.resize(accessor.count * bytes);
        for (std::size_t i = 0; out.first && i < accessor.count; ++i)
            std::memcpy(&out.own[i * bytes], out.first + i * out.stride, bytes);
        for_each_sparse(index, [&](std::size_t element, const unsigned char* value) {
            std::memcpy(&out.own[element * bytes], value, bytes);
        });
        out.first = out.own.data();
        out.stride = bytes;
    }
    return elements_.emplace(index, std::move(out)).first->second;
}

const Indices& Accessors::indices(int index) {
    if (const auto it = indices_.find(index); it != indices_.end()) return it->second;
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
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

void Accessors::check_alignment(int index) const {
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
    if (accessor.bufferView < 0) return;
    const tinygltf::BufferView& view = model_.bufferViews[std::size_t(accessor.bufferView)];
    const std::size_t bytes = component_bytes(accessor.componentType);
    // A stride is a multiple of 4 anyway. Remainders are added, for the offsets' sum could overflow.
    if ((accessor.byteOffset % bytes + view.byteOffset % bytes) % bytes != 0)
        fail(file_, "{} is misaligned: its offset must be a multiple of its {}-byte components", text(index), bytes);
}

void Accessors::require(int index, int type, std::span<const int> component_types, const std::string& what,
                        const char* wanted) const {
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
    if (accessor.type != type || std::ranges::find(component_types, accessor.componentType) == component_types.end())
        fail(file_, what + " (" + text(index) + ") are not " + wanted);
    check_alignment(index);
}

std::optional<std::size_t> Accessors::first_absent_place(int index, int indices) {
    const Elements& all = elements(index);
    if (all.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT) return std::nullopt;
    const auto may_be = [&](std::size_t i) {
        const Float3 p = all.float3(i);
        return std::ranges::any_of(p, may_stand_for_no_data);
    };
    bool has_any = false;
    for (std::size_t i = 0; i < all.count && !has_any; ++i) has_any = may_be(i);
    if (!has_any) return std::nullopt;  // as in almost all files
    std::vector<float> places;
    const std::size_t used = indices < 0 ? all.count : this->indices(indices).value.size();
    const auto element = [&](std::size_t i) { return indices < 0 ? i : this->indices(indices).value[i]; };
    for (std::size_t i = 0; i < used; ++i) std::ranges::copy(all.float3(element(i)), std::back_inserter(places));
    const auto found = scene::first_absent_place<float>(places, 3);
    return found ? std::optional(element(found->row)) : std::nullopt;
}

std::string Accessors::place_text(int index, std::size_t element) {
    const Float3 p = elements(index).float3(element);
    return fmt::format("{}, {}, {}", p[0], p[1], p[2]);
}

}  // namespace gnomon::scene
