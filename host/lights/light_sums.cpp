// SPDX-License-Identifier: MIT
// Stage light_sums: adds the masks of bundles to the outputs of a run over many lights.
#include "kernels/lights/light_sums.h"

#include <algorithm>
#include <cmath>

#include "lights/many_lights.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

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

void LightSums::want(cl_mem output, std::uint32_t flag, std::uint32_t cleared, std::size_t words) {
    if (output == nullptr) return;
    params_.wants |= flag;
    if (words != 0) session_.fill(output, cleared, words * sizeof(cl_uint));
}

LightSums::LightSums(const LightsRun& run, std::span<const std::uint32_t> slots, const SortedPoints* sorted)
    : session_(session_of(run.device)),
      outputs_(run.outputs),
      point_count_(run.points.count()),
      order_(sorted != nullptr ? sorted->order().get() : nullptr),
      normals_(sorted != nullptr ? sorted->normals().get() : run.options.normals),
      none_(session_, 16) {
    params_.words = static_cast<cl_uint>((run.lights.count() + 31) / 32);
    params_.exponent = run.lights.exponent();
    params_.is_sorted = sorted != nullptr;
    const PointLayout layout = sorted != nullptr ? PointLayout{} : run.options.normals_layout;
    params_.normals.first = static_cast<cl_uint>(layout.first);
    params_.normals.point_stride = static_cast<cl_uint>(layout.point_stride);
    params_.normals.coordinate_stride = static_cast<cl_uint>(layout.coordinate_stride);
    want(outputs_.bits, WANTS_BITS, 0, point_count_ * params_.words);
    want(outputs_.counts, WANTS_COUNTS, 0, point_count_);
    want(outputs_.sums, WANTS_SUMS, 0, 2 * point_count_);
    want(outputs_.first_lit, WANTS_FIRST, no_light, point_count_);
    want(outputs_.last_lit, WANTS_LAST, no_light, point_count_);
    if (run.options.cosines && outputs_.sums != nullptr) params_.wants |= WANTS_COSINES;
    upload(session_, slots_, slots_of(run.lights, slots));
    upload(session_, tables_, tables_of(run.lights, slots));
}

void LightSums::add(const cl::Buffer& masks, std::size_t mask_stride, std::size_t first_point, std::size_t point_count,
                    std::uint32_t first_bundle, std::uint32_t bundle_count) {
    LightSumsParams params = params_;
    params.first_point = static_cast<cl_uint>(first_point);
    params.point_count = static_cast<cl_uint>(point_count);
    params.first_bundle = first_bundle;
    params.bundle_count = bundle_count;
    params.mask_stride = static_cast<cl_uint>(mask_stride);
    const auto given = [&](cl_mem buffer) { return buffer != nullptr ? buffer : none_.get(); };
    session_.launch("lights/light_sums.cl", "light_sums", cl::Range::items(point_count), params, masks, slots_, tables_,
                    given(order_), given(normals_), given(outputs_.bits), given(outputs_.counts), given(outputs_.sums),
                    given(outputs_.first_lit), given(outputs_.last_lit));
}

void LightSums::finish() {
    if (outputs_.sums == nullptr || point_count_ == 0) return;
    LightSumsParams params = params_;
    params.point_count = static_cast<cl_uint>(point_count_);
    session_.launch("lights/light_sums.cl", "light_sums_finish", cl::Range::items(point_count_), params, outputs_.sums);
}

}  // namespace gnomon
