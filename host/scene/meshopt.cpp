// SPDX-License-Identifier: MIT
// EXT_meshopt_compression by libmeshoptimizer. Its decoders are safe on any bytes, but assert what the extension
// promises about strides and counts; so these are checked first.
#include <meshoptimizer.h>

#include "gltf.hpp"

namespace gnomon::scene {
namespace {

/// What the extension requires of a view, in words; null if it is met.
const char* broken_rule(const MeshoptView& v) {
    if (v.mode == "ATTRIBUTES") {
        if (v.byte_stride % 4 != 0) return "a byteStride that is a multiple of 4";
        if (v.filter == "OCTAHEDRAL" && v.byte_stride != 4 && v.byte_stride != 8) return "a byteStride of 4 or 8";
        if (v.filter == "QUATERNION" && v.byte_stride != 8) return "a byteStride of 8";
        return nullptr;
    }
    if (v.byte_stride != 2 && v.byte_stride != 4) return "a byteStride of 2 or 4";
    if (v.filter != "NONE") return "no filter";
    if (v.mode == "TRIANGLES" && v.count % 3 != 0) return "a count that is a multiple of 3";
    return nullptr;
}

/// Every group of 16 bytes takes 2 bits at least, every triangle or index a byte. Checked before the output is
/// reserved.
bool is_too_short(const MeshoptView& v) {
    if (v.mode == "ATTRIBUTES") return v.count * v.byte_stride / 64 > v.byte_length;
    return (v.mode == "TRIANGLES" ? v.count / 3 : v.count) > v.byte_length;
}

bool decode(const MeshoptView& v, const unsigned char* from, unsigned char* to) {
    if (v.mode == "TRIANGLES") return meshopt_decodeIndexBuffer(to, v.count, v.byte_stride, from, v.byte_length) == 0;
    if (v.mode == "INDICES") return meshopt_decodeIndexSequence(to, v.count, v.byte_stride, from, v.byte_length) == 0;
    if (meshopt_decodeVertexBuffer(to, v.count, v.byte_stride, from, v.byte_length) != 0) return false;
    if (v.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to, v.count, v.byte_stride);
    if (v.filter == "QUATERNION") meshopt_decodeFilterQuat(to, v.count, v.byte_stride);
    if (v.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to, v.count, v.byte_stride);
    return true;
}

}  // namespace

void unpack_meshopt(tinygltf::Model& model, const std::vector<MeshoptView>& views, DecodingBudget& budget) {
    for (const MeshoptView& v : views) {
        const std::string what = fmt::format("bufferViews[{}]", v.view);
        if (const char* rule = broken_rule(v))
            fail(budget.file, what + ".extensions.EXT_meshopt_compression in mode " + v.mode + " needs " + rule);
        const std::vector<unsigned char>& packed = model.buffers[v.buffer].data;
        if (v.byte_offset > packed.size() || v.byte_length > packed.size() - v.byte_offset)
            fail(budget.file, "{}.extensions.EXT_meshopt_compression reads beyond buffers[{}], which has {}", what,
                 v.buffer, counted(packed.size(), "byte"));
        budget.charge(what, v.count, v.byte_stride);
        if (v.count * v.byte_stride != model.bufferViews[v.view].byteLength)
            fail(budget.file, "{} has {}, but its EXT_meshopt_compression {} times {}", what,
                 counted(model.bufferViews[v.view].byteLength, "byte"), v.count, v.byte_stride);
        tinygltf::Buffer unpacked;
        const bool is_short = is_too_short(v);
        if (!is_short) unpacked.data.resize(v.count * v.byte_stride);
        if (is_short || (v.count > 0 && !decode(v, packed.data() + v.byte_offset, unpacked.data.data())))
            fail(budget.file, what + " holds no stream of EXT_meshopt_compression in mode " + v.mode +
                                  " that can be decoded; export it again");
        tinygltf::BufferView& view = model.bufferViews[v.view];
        view.buffer = int(model.buffers.size());
        view.byteOffset = 0;
        view.byteLength = unpacked.data.size();
        view.byteStride = v.mode == "ATTRIBUTES" ? v.byte_stride : 0;
        model.buffers.push_back(std::move(unpacked));
    }
}

}  // namespace gnomon::scene
