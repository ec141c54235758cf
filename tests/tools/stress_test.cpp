// SPDX-License-Identifier: MIT
// The stress suite (tools/stress) in small: every case, nothing wrong, and nothing vacuous: both kinds of light, both
// answers, every level of the decision, and questions that the plain float test gets wrong.
#include <gtest/gtest.h>

#include <vector>

#include "stress/report.hpp"

namespace {

std::vector<stress::Case> cases_to_run() {
    stress::CaseOptions options;
    options.slivers = 2000;
    options.longest_side = 256;
    return stress::all_cases(options);
}

const gnomon::Device& device() {
    static const gnomon::Device opened;
    return opened;
}

stress::Tally tally_of(const stress::Case& a_case) {
    stress::RunOptions options;
    options.points = 1000;
    options.all_variants = false;
    // Embree is the long run's business.
    stress::Judge judge(device(), false);
    return run_case(a_case, device(), judge, options).tally;
}

/// Cases about borders have nothing, or little, to decide.
bool is_border(const std::string& name) {
    return name == "no points" || name == "no triangles" || name == "inside closed meshes";
}

TEST(Stress, NothingIsWrongInAnyCaseExhaustive) {
    const std::vector<stress::Case> cases = cases_to_run();
    EXPECT_GE(cases.size(), 58u);
    stress::Tally sum;
    for (const stress::Case& a_case : cases) {
        SCOPED_TRACE(a_case.name);
        const stress::Tally tally = tally_of(a_case);
        EXPECT_EQ(tally.wrong, 0u) << tally.first_wrong;
        EXPECT_EQ(tally.leaks, 0u);
        EXPECT_EQ(tally.slipped_too_far, 0u);
        if (a_case.name != "no points") {
            EXPECT_GT(tally.directional, 0u);
            EXPECT_GT(tally.positional, 0u);
        }
        if (!is_border(a_case.name)) {
            EXPECT_GT(tally.shadowed, 0u);
            EXPECT_LT(tally.shadowed, tally.points);
        }
        sum += tally;
    }
    EXPECT_GT(sum.points, 50'000u);
    EXPECT_GT(sum.by_map, 1000u);
    EXPECT_GT(sum.by_float, 1000u);
    EXPECT_GT(sum.by_double, 1000u);
    EXPECT_GT(sum.by_integers, 1000u);
    EXPECT_GT(sum.plain_wrong, 1000u);
    EXPECT_GT(sum.star_points, 100u);
}

}  // namespace
