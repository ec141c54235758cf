// SPDX-License-Identifier: MIT
// Stage light_sums: adds the masks of bundles to the outputs of a run over many lights.
#include "kernels/lights/light_sums.h"

#include <algorithm>
#include <cmath>

#include "api/vectors.hpp"
#include "lights/many_lights.hpp"

namespace gnomon {
namespace {

constexpr std::size_t tables_per_bundle = 4;

std::vector<LightSlot> slots_of(const Lights& lights, std::span<const std::uint32_t> ids) {
    std::vector<LightSlot> slots(ids.size());
    for (std::size_t s = 0; s < ids.size(); ++s) {
        slots[s].light = ids[s];
        if (ids[s] == no_light) continue;
        const std::array<float, 4>& d = lights.lights()[ids[s]].xyzw;
        Double3 unit{d[0], d[1], d[2]};
        normalize(unit);
        store(slots[s].direction, unit);
        slots[s].weight = lights.weights()[ids[s]];
    }
    return slots;
}

std::vector<std::int64_t> tables_of(const Lights& lights, std::span<const std::uint32_t> ids) {
    std::vector<std::int64_t> tables(ids.size() / 8 * WEIGHT_TABLE);
    for (std::size_t byte = 0; byte < ids.size() / 8; ++byte) {
        std::int64_t* table = tables.data() + byte * WEIGHT_TABLE;
        for (std::size_t bit = 0; bit < 8; ++bit) {
            const std::uint32_t id = ids[8 * byte + bit];
            const std::int64_t weight = id == no_light ? 0 : lights.whole_weights()[id];
            for (std::size_t m = 0; m < (std::size_t(1) << bit); ++m)
                table[m | std::size_t(1) << bit] = table[m] + weight;
        }
    }
    return tables;
}

template <typename T>
void upload(cl::Session& session, cl::Buffer& buffer, const std::vector<T>& values) {
    buffer.reserve(session, values.size() * sizeof(T));
    if (!values.empty()) session.write(buffer.get(), values.data(), values.size() * sizeof(T));
}

}  // namespace

LightSums::LightSums(cl::Session& session, const Lights& lights, std::span<const std::uint32_t> slots,
                     const LightsOutputs& outputs, const LightsOptions& options, std::size_t point_count)
    : session_(session), outputs_(outputs), point_count_(point_count), none_(session, 16) {
    const auto want = [&](cl_mem buffer, std::uint32_t flag) {
        if (buffer != nullptr) params_.wants |= flag;
    };
    want(outputs.bits, WANTS_BITS);
    want(outputs.counts, WANTS_COUNTS);
    want(outputs.sums, WANTS_SUMS);
    want(outputs.first_lit, WANTS_FIRST);
    want(outputs.last_lit, WANTS_LAST);
    if (options.cosines && outputs.sums != nullptr) params_.wants |= WANTS_COSINES;
    params_.words = static_cast<cl_uint>((lights.count() + 31) / 32);
    params_.exponent = lights.exponent();
    upload(session, slots_, slots_of(lights, slots));
    upload(session, tables_, tables_of(lights, slots));
    const auto clear = [&](cl_mem buffer, cl_uint word, std::size_t words) {
        if (buffer != nullptr && words != 0) session_.fill(buffer, word, words * sizeof(cl_uint));
    };
    clear(outputs.bits, 0, point_count * params_.words);
    clear(outputs.counts, 0, point_count);
    clear(outputs.sums, 0, 2 * point_count);
    clear(outputs.first_lit, no_light, point_count);
    clear(outputs.last_lit, no_light, point_count);
}

void LightSums::add(const cl::Buffer& masks, std::size_t mask_stride, std::size_t first_point, std::size_t point_count,
                    std::uint32_t first_bundle, std::uint32_t bundle_count, const cl::Buffer* order, cl_mem normals,
                    const PointLayout& normals_at) {
    LightSumsParams params = params_;
    params.first_point = static_cast<cl_uint>(first_point);
    params.point_count = static_cast<cl_uint>(point_count);
    params.first_bundle = first_bundle;
    params.bundle_count = bundle_count;
    params.mask_stride = static_cast<cl_uint>(mask_stride);
    params.is_sorted = order != nullptr;
    params.normals.first = static_cast<cl_uint>(normals_at.first);
    params.normals.point_stride = static_cast<cl_uint>(normals_at.point_stride);
    params.normals.coordinate_stride = static_cast<cl_uint>(normals_at.coordinate_stride);
    const auto given = [&](cl_mem buffer) { return buffer != nullptr ? buffer : none_.get(); };
    session_.launch("lights/light_sums.cl", "light_sums", cl::Range::items(point_count), params, masks, slots_, tables_,
                    order != nullptr ? order->get() : none_.get(), given(normals), given(outputs_.bits),
                    given(outputs_.counts), given(outputs_.sums), given(outputs_.first_lit), given(outputs_.last_lit));
}

void LightSums::finish() {
    if (outputs_.sums == nullptr || point_count_ == 0) return;
    LightSumsParams params = params_;
    params.point_count = static_cast<cl_uint>(point_count_);
    session_.launch("lights/light_sums.cl", "light_sums_finish", cl::Range::items(point_count_), params, outputs_.sums);
}

}  // namespace gnomon
