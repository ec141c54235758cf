// SPDX-License-Identifier: MIT
// From filtered quantities to visibility: each store's estimate on distributions of a few depths whose true share
// beyond t is a sum of weights. Chebyshev's and Hamburger's estimates are bounds, and exact where theory says so.
#include <gtest/gtest.h>

#include "kernels/rivals/shadow_map/moments.h"
#include "support/map_scenes.hpp"

namespace {

using namespace support;
using gnomon::StorePlan;

/// Weights and depths, and where they are asked for visibility.
struct Question {
    std::vector<std::pair<double, double>> depths;  ///< weight, depth
    double t;
    double share_beyond() const {
        double share = 0;
        for (const auto& [weight, depth] : depths) share += depth >= t ? weight : 0;
        return share;
    }
};

StorePlan plan_of(std::uint32_t store, std::uint32_t planes) {
    StorePlan plan{};
    plan.store = store;
    plan.planes = planes;
    plan.layers = 1;
    plan.terms = planes / 2;
    plan.exponent = 10;
    plan.negative_exponent = 5;
    plan.moment_bias = store == STORE_MOMENTS ? 3e-7f : 0;  // the default of 128-bit texels
    return plan;
}

/// The planes' means over the question's depths, each plane written down from its definition.
std::vector<double> means_of(const StorePlan& plan, const Question& question) {
    std::vector<double> means(plan.planes);
    for (const auto& [weight, z] : question.depths) {
        std::vector<double> value(plan.planes);
        const double x = 2 * z - 1, w = std::exp(plan.exponent * x), n = -std::exp(-plan.negative_exponent * x);
        switch (plan.store) {
            case STORE_VARIANCE:
                value = {z, z * z};
                break;
            case STORE_LAYERED:
                for (std::uint32_t l = 0; l < plan.layers; ++l) {
                    const double low = (l - (l > 0 ? 0.5 : 0)) / plan.layers, high = (l + 1.0) / plan.layers;
                    const double inside = std::clamp((z - low) / (high - low), 0.0, 1.0);
                    value[2 * l] = inside;
                    value[2 * l + 1] = inside * inside;
                }
                break;
            case STORE_CONVOLUTION:
                for (std::uint32_t k = 0; k < plan.terms; ++k) {
                    value[2 * k] = std::sin(std::numbers::pi * (2 * k + 1) * z);
                    value[2 * k + 1] = std::cos(std::numbers::pi * (2 * k + 1) * z);
                }
                break;
            case STORE_EXPONENTIAL:
                value = {std::exp(plan.exponent * z)};
                break;
            case STORE_EVSM2:
            case STORE_EWGF:
                value = {w, w * w};
                break;
            case STORE_EVSM4:
                value = {w, w * w, n, n * n};
                break;
            case STORE_MOMENTS:
                value = {x, x * x, x * x * x, x * x * x * x};
                break;
        }
        for (std::size_t p = 0; p < value.size(); ++p) means[p] += weight * value[p];
    }
    return means;
}

constexpr const char* kernel = R"(
#include "rivals/shadow_map/visibility_bounds.clh"
__kernel void estimates(StorePlan plan, uint count, __global const float* means, __global const float* t,
                        __global float* lit) {
    GN_FOR_EACH(i, count) {
        float own[32];
        for (uint p = 0; p < plan.planes; ++p) own[p] = means[i * plan.planes + p];
        lit[i] = visibility_estimate(&plan, own, t[i]);
    }
}
)";

std::vector<float> estimates(const StorePlan& plan, const std::vector<Question>& questions) {
    static const gnomon::Device device;
    gnomon::cl::Session& session = session_of(device);
    session.add_source("visibility_bounds_test.cl", kernel);
    std::vector<float> means, at;
    for (const Question& question : questions) {
        for (const double mean : means_of(plan, question)) means.push_back(static_cast<float>(mean));
        at.push_back(static_cast<float>(question.t));
    }
    const auto count = static_cast<cl_uint>(questions.size());
    const gnomon::cl::Buffer means_buffer = uploaded(session, means), at_buffer = uploaded(session, at),
                             lit(session, questions.size() * sizeof(float));
    session.launch("visibility_bounds_test.cl", "estimates", gnomon::cl::Range::items(count), plan, count, means_buffer,
                   at_buffer, lit);
    return downloaded<float>(session, lit.get(), questions.size());
}

/// `depths` depths at least 0.15 apart (nearer ones are beyond what four float moments tell apart) with random weights;
/// t anywhere, or one of them.
std::vector<Question> questions(std::size_t depths, bool at_a_depth) {
    Random random(17 + depths);
    std::vector<Question> all;
    while (all.size() < 2000) {
        Question question;
        double sum = 0, nearest_gap = 1;
        for (std::size_t i = 0; i < depths; ++i) {
            const double z = random.between(0, 1);
            for (const auto& [weight, other] : question.depths)
                nearest_gap = std::min(nearest_gap, std::fabs(z - other));
            question.depths.emplace_back(random.between(0.1f, 1), z);
            sum += question.depths.back().first;
        }
        for (auto& [weight, depth] : question.depths) weight /= sum;
        question.t = at_a_depth ? question.depths[random.below(static_cast<std::uint32_t>(depths))].second
                                : random.between(0, 1);
        if (nearest_gap > 0.15) all.push_back(question);
    }
    return all;
}

// The estimate is the largest share that the means allow, so never below the truth.
TEST(VisibilityBounds, UpperBoundsHold) {
    for (StorePlan plan : {plan_of(STORE_VARIANCE, 2), plan_of(STORE_EVSM2, 2), plan_of(STORE_EVSM4, 4),
                           plan_of(STORE_LAYERED, 8), plan_of(STORE_MOMENTS, 4)}) {
        if (plan.store == STORE_LAYERED) plan.layers = 4;
        for (const std::size_t depths : {2, 3, 4}) {
            const auto asked = questions(depths, false);
            const std::vector<float> lit = estimates(plan, asked);
            double slack = 0;
            for (std::size_t i = 0; i < lit.size(); ++i) {
                // Means are floats: their rounding moves a share by up to 0.005 where depths lie close.
                ASSERT_GE(lit[i], asked[i].share_beyond() - 5e-3) << "store " << plan.store << ", question " << i;
                slack += lit[i] - asked[i].share_beyond();
            }
            // Half of what is asked for is nearer than t on average: always saying 1 would have a slack of 0.5.
            EXPECT_LT(slack / double(lit.size()), 0.42) << "store " << plan.store << ": says nothing";
        }
    }
}

// With two depths, one of them t, Chebyshev's bound is attained (Donnelly and Lauritzen 2006: a planar occluder over a
// planar receiver). With three, t among them, the distribution itself attains Hamburger's.
TEST(VisibilityBounds, ExactForAsManyDepthsAsTheMomentsTellApart) {
    for (const auto& [plan, depths] : {std::pair{plan_of(STORE_VARIANCE, 2), 2}, {plan_of(STORE_MOMENTS, 4), 3}}) {
        const auto asked = questions(static_cast<std::size_t>(depths), true);
        const std::vector<float> lit = estimates(plan, asked);
        for (std::size_t i = 0; i < lit.size(); ++i)
            EXPECT_NEAR(lit[i], asked[i].share_beyond(), 5e-3) << "store " << plan.store << ", question " << i;
    }
}

TEST(VisibilityBounds, MoreMomentsTellMore) {
    const auto asked = questions(3, false);
    const auto mean_of = [&](const StorePlan& plan) {
        double sum = 0;
        for (const float lit : estimates(plan, asked)) sum += lit;
        return sum / double(asked.size());
    };
    const double variance = mean_of(plan_of(STORE_VARIANCE, 2)), evsm2 = mean_of(plan_of(STORE_EVSM2, 2)),
                 evsm4 = mean_of(plan_of(STORE_EVSM4, 4)), moments = mean_of(plan_of(STORE_MOMENTS, 4));
    EXPECT_LT(evsm4, evsm2);
    EXPECT_LT(moments, variance);
    StorePlan layered = plan_of(STORE_LAYERED, 16);
    layered.layers = 8;
    EXPECT_LT(mean_of(layered), variance);
}

TEST(VisibilityBounds, OneLayerIsPlainVariance) {
    const auto asked = questions(3, false);
    EXPECT_EQ(estimates(plan_of(STORE_LAYERED, 2), asked), estimates(plan_of(STORE_VARIANCE, 2), asked));
}

// exp(c (z - t)) for a single depth; a single depth tells [z >= t] as c grows.
TEST(VisibilityBounds, ExponentialLimit) {
    std::vector<Question> asked;
    for (int i = 0; i <= 50; ++i) asked.push_back({{{1.0, 0.5}}, 0.25 + 0.01 * i});
    for (const float exponent : {5.0f, 40.0f, 80.0f}) {
        StorePlan plan = plan_of(STORE_EXPONENTIAL, 1);
        plan.exponent = exponent;
        const std::vector<float> lit = estimates(plan, asked);
        for (std::size_t i = 0; i < lit.size(); ++i)
            EXPECT_NEAR(lit[i], std::min(1.0, std::exp(exponent * (0.5 - asked[i].t))), 1e-4);
    }
}

// Survey 120: saturate(exp(-c t) E[exp(c (z + offset))] - threshold). The offset lets the product exceed 1 at the
// surface itself, so what is subtracted there is subtracted from more than 1.
TEST(VisibilityBounds, ExponentialThresholdIsSubtractedBeforeTheLimits) {
    constexpr float offset = 0.02f;
    StorePlan plan = plan_of(STORE_EXPONENTIAL, 1);
    std::vector<Question> asked;
    for (int i = 0; i <= 60; ++i) asked.push_back({{{0.7, 0.5}, {0.3, 0.1}}, 0.2 + 0.01 * i});
    for (const float threshold : {0.0f, 0.1f, 0.3f}) {
        plan.threshold = threshold;
        std::vector<Question> biased = asked;
        for (Question& question : biased) question.t -= offset;  // as lookups subtract constant-bias
        const std::vector<float> lit = estimates(plan, biased);
        for (std::size_t i = 0; i < lit.size(); ++i) {
            double mean = 0;
            for (const auto& [weight, z] : asked[i].depths) mean += weight * std::exp(plan.exponent * (z + offset));
            const double printed = std::exp(-plan.exponent * asked[i].t) * mean - threshold;
            EXPECT_NEAR(lit[i], std::clamp(printed, 0.0, 1.0), 1e-5) << threshold << " " << asked[i].t;
        }
    }
}

// The share of a Gaussian is below what any distribution may have, and 1 - Phi is known: doubled, 0.3173 at one sigma.
TEST(VisibilityBounds, GaussianShare) {
    const auto asked = questions(3, false);
    const auto gaussian = estimates(plan_of(STORE_EWGF, 2), asked), bound = estimates(plan_of(STORE_EVSM2, 2), asked);
    for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_LE(gaussian[i], bound[i] + 1e-5f);
    // Two warped depths with equal weights: the farther one lies one sigma beyond the mean.
    const auto at_one_sigma = estimates(plan_of(STORE_EWGF, 2), {{{{0.5, 0.3}, {0.5, 0.6}}, 0.6}});
    EXPECT_NEAR(at_one_sigma[0], 0.3173, 2e-3);
}

// More terms, steeper step; means of steps are steps of means.
TEST(VisibilityBounds, FourierSeriesApproachesTheStep) {
    for (const std::uint32_t terms : {4u, 16u}) {
        const StorePlan plan = plan_of(STORE_CONVOLUTION, 2 * terms);
        const double rise = 1.0 / terms;  // beyond this on both sides of the step it has settled
        std::vector<Question> asked = questions(2, false);
        std::erase_if(asked, [&](const Question& q) {
            for (const auto& [weight, depth] : q.depths)
                if (std::fabs(depth - q.t) < rise || std::fabs(depth - q.t) > 1 - rise) return true;
            return false;
        });
        ASSERT_GT(asked.size(), 100u);
        const std::vector<float> lit = estimates(plan, asked);
        for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_NEAR(lit[i], asked[i].share_beyond(), 0.11) << i;
    }
    // A surface is lit by itself.
    std::vector<Question> itself;
    for (int i = 0; i < 20; ++i) itself.push_back({{{1.0, 0.1 + 0.04 * i}}, 0.1 + 0.04 * i});
    for (const float lit : estimates(plan_of(STORE_CONVOLUTION, 32), itself)) EXPECT_GT(lit, 0.9f);
}

TEST(VisibilityBounds, OptimisedMomentsComeBack) {
    StorePlan plan = plan_of(STORE_MOMENTS, 4);
    const auto asked = questions(3, true);
    const std::vector<float> plain = estimates(plan, asked);
    // Through the transform and 16 bits, as kernel moments_fill stores them.
    static const gnomon::Device device;
    gnomon::cl::Session& session = session_of(device);
    std::vector<float> depths;
    for (const Question& question : asked)
        for (const auto& [weight, depth] : question.depths) depths.push_back(static_cast<float>(depth));
    gnomon::MapSet set{};
    set.texels = static_cast<cl_uint>(depths.size());
    plan.half_bits = 1;
    plan.moment_bias = 3e-5f;
    const gnomon::cl::Buffer in = uploaded(session, depths), planes(session, depths.size() * 8);
    session.launch("rivals/shadow_map/moments.cl", "moments_fill", gnomon::cl::Range::items(set.texels), plan, set, in,
                   in, planes);
    const auto stored = downloaded<std::uint16_t>(session, planes.get(), depths.size() * 4);
    std::vector<float> means, at;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        for (std::size_t p = 0; p < 4; ++p) {
            double mean = 0;
            for (std::size_t k = 0; k < 3; ++k)
                mean += asked[i].depths[k].first * stored[p * depths.size() + 3 * i + k] / 65535.0;
            means.push_back(static_cast<float>(mean));
        }
        at.push_back(static_cast<float>(asked[i].t));
    }
    session.add_source("visibility_bounds_test.cl", kernel);
    const auto count = static_cast<cl_uint>(asked.size());
    const gnomon::cl::Buffer means_buffer = uploaded(session, means), at_buffer = uploaded(session, at),
                             lit_buffer(session, asked.size() * sizeof(float));
    session.launch("visibility_bounds_test.cl", "estimates", gnomon::cl::Range::items(count), plan, count, means_buffer,
                   at_buffer, lit_buffer);
    const auto lit = downloaded<float>(session, lit_buffer.get(), asked.size());
    double error = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) error += std::fabs(lit[i] - plain[i]);
    EXPECT_LT(error / double(asked.size()), 0.05);
}

// Survey 113: [bleeding, 1] is stretched to [0, 1].
TEST(VisibilityBounds, BleedingIsCutOff) {
    const auto asked = questions(3, false);
    StorePlan plan = plan_of(STORE_VARIANCE, 2);
    const std::vector<float> before = estimates(plan, asked);
    plan.bleeding = 0.25f;
    const std::vector<float> after = estimates(plan, asked);
    for (std::size_t i = 0; i < asked.size(); ++i)
        EXPECT_NEAR(after[i], std::max(0.0, (before[i] - 0.25) / 0.75), 1e-5);
}

}  // namespace
