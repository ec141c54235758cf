// SPDX-License-Identifier: MIT
// Stages moments and prefilter: depths to stored quantities, filtered (kernels/rivals/shadow_map/moments.h,
// prefilter.cl).
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/rivals/shadow_map/moments.h"
#include "rivals/shadow_map/depth_pass.hpp"

namespace gnomon {

enum class Prefilter { none, gaussian, summed_area, mip };

class StoredMap {
public:
    /// Fills planes() from the depths.
    void fill(cl::Session& session, const MapViews& map_views, const DepthMap& depths, const StorePlan& plan) {
        planes_.reserve(session, bytes_of(map_views, plan));
        session.launch("rivals/shadow_map/moments.cl", "moments_fill", cl::Range::items(map_views.set.texels), plan,
                       map_views.set, depths.keys(), depths.slopes(), planes_);
    }

    /// Sets `plan.summed`, or `plan.mips`, and the members that belong to it.
    void prefilter(cl::Session& session, const MapViews& map_views, Prefilter prefilter, std::uint32_t width,
                   StorePlan& plan) {
        const MapSet& set = map_views.set;
        const std::size_t numbers = std::size_t(set.texels) * plan.planes;
        plan.summed = prefilter == Prefilter::summed_area;
        if (prefilter == Prefilter::none) return;
        if (prefilter == Prefilter::mip) {
            scratch_.reserve(session, bytes_of(map_views, plan));
            // No view's shorter side is longer than this root.
            plan.mips = static_cast<cl_uint>(std::log2(std::sqrt(std::max(set.texels_per_view, 1u))));
            for (cl_uint level = 1; level <= plan.mips; ++level)
                session.launch(prefilter_file, "prefilter_mip", cl::Range::items((numbers >> (2 * level)) + 1), plan,
                               set, level, map_views.views, level == 1 ? planes_ : scratch_, scratch_);
            return;
        }
        if (prefilter == Prefilter::gaussian) {
            scratch_.reserve(session, bytes_of(map_views, plan));
            const std::vector<float> weights = gaussian_weights(width);
            weights_.reserve(session, weights.size() * sizeof(float));
            session.write(weights_.get(), weights.data(), weights.size() * sizeof(float));
            session.launch(prefilter_file, "prefilter_gaussian", cl::Range::items(numbers), plan, set,
                           GaussianPass{width, 0}, weights_, map_views.views, planes_, scratch_);
            session.launch(prefilter_file, "prefilter_gaussian", cl::Range::items(numbers), plan, set,
                           GaussianPass{width, 1}, weights_, map_views.views, scratch_, planes_);
            return;
        }
        // Sums of a box stay below 2^32: as many bits as its number of texels leaves.
        plan.width = static_cast<float>(width);
        plan.summed_scale = std::ldexp(1.0f, 31 - static_cast<int>(std::ceil(2 * std::log2(width))));
        scratch_.reserve(session, numbers * sizeof(cl_uint));
        for (const cl_uint axis : {0u, 1u})
            session.launch(prefilter_file, "prefilter_sum", cl::Range::items(numbers), plan, set, axis, map_views.views,
                           planes_, scratch_);
        std::swap(planes_, scratch_);
    }

    const cl::Buffer& planes() const { return planes_; }
    const cl::Buffer& mips() const { return scratch_; }  ///< levels beside the first, if plan.mips is not 0

private:
    // Weights of `taps` texels: a Gaussian of sigma taps / 4.5, which leaves 2 % beyond the ends.
    static std::vector<float> gaussian_weights(std::uint32_t taps) {
        std::vector<double> weights(taps);
        for (std::uint32_t i = 0; i < taps; ++i) {
            const double from_middle = (i - 0.5 * (taps - 1)) / (taps / 4.5);
            weights[i] = std::exp(-0.5 * from_middle * from_middle);
        }
        const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
        std::vector<float> scaled;
        for (const double weight : weights) scaled.push_back(static_cast<float>(weight / sum));
        return scaled;
    }

    static std::size_t bytes_of(const MapViews& map_views, const StorePlan& plan) {
        return std::size_t(map_views.set.texels) * plan.planes *
               (plan.half_bits ? sizeof(cl_ushort) : sizeof(cl_float));
    }

    static constexpr const char* prefilter_file = "rivals/shadow_map/prefilter.cl";
    cl::Buffer planes_, scratch_, weights_;
};

}  // namespace gnomon
