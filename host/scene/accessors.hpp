// SPDX-License-Identifier: MIT
// The elements of accessors, read from a document whose references are checked. Each accessor is decoded once, when it
// is first read: sparse elements are put in place, and normalized integers become the doubles that glTF defines.
#pragma once

#include <cstring>
#include <map>
#include <optional>
#include <span>

#include <gnomon.hpp>
#include "gltf.hpp"
#include "query/vectors.hpp"

namespace gnomon::scene {

/// The elements of an accessor: in their buffer, or, if it is sparse, in a copy of their own.
struct Elements {
    const unsigned char* first = nullptr;
    std::size_t stride = 0, count = 0;
    int component_type = 0, components = 0;
    bool is_normalized = false;
    std::vector<unsigned char> own;

    /// The bits of a VEC3 of float32.
    Float3 float3(std::size_t element) const {
        Float3 p;
        std::memcpy(p.data(), first + element * stride, sizeof p);
        return p;
    }
    /// A component as a double; every component type has an exact one, but for the quotient of a normalized integer.
    double number(std::size_t element, int component) const;
    glm::dvec3 double3(std::size_t element) const {
        return {number(element, 0), number(element, 1), number(element, 2)};
    }
    /// A component of an unsigned integer type.
    std::uint32_t index(std::size_t element, int component) const;
};

struct Indices {
    std::vector<std::uint32_t> value;
    std::uint32_t largest = 0;
};

class Accessors {
public:
    Accessors(const std::filesystem::path& file, const tinygltf::Model& model) : file_(file), model_(model) {}

    const Elements& elements(int accessor);
    const Indices& indices(int accessor);
    /// Throws SceneError unless the accessor has this type (TINYGLTF_TYPE_...), one of these component types and an
    /// offset that is a multiple of its components' bytes. `what` is "the positions of primitive 0 of mesh 3".
    void require(int accessor, int type, std::span<const int> component_types, const std::string& what,
                 const char* wanted) const;
    /// Of a VEC3 of float32: the first of the elements that these indices name (-1: of all) with a coordinate that
    /// stands for no data (no_data.hpp). Of other types nothing.
    std::optional<std::size_t> first_absent_place(int accessor, int indices);
    std::string place_text(int accessor, std::size_t element);
    std::size_t count(int accessor) const { return model_.accessors[std::size_t(accessor)].count; }

    static std::string text(int accessor) { return fmt::format("accessors[{}]", accessor); }

private:
    const unsigned char* bytes_at(int view, std::size_t offset) const;
    void check_alignment(int accessor) const;
    template <class Put>
    void for_each_sparse(int accessor, const Put& put) const;

    const std::filesystem::path& file_;
    const tinygltf::Model& model_;
    std::map<int, Elements> elements_;
    std::map<int, Indices> indices_;
};

}  // namespace gnomon::scene
