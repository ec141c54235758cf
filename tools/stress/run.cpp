// SPDX-License-Identifier: MIT
// See run.hpp.
#include "run.hpp"

#include <fmt/core.h>

namespace stress {

CaseResult run_case(const Case& a_case, const gnomon::Device& device, Judge& judge, const RunOptions& options) {
    CaseResult result{a_case.name, a_case.idea, {}};
    Tally& tally = result.tally;
    const std::uint64_t min_variants = options.all_variants ? a_case.variants : 1;
    const double wanted = options.points * a_case.share;
    // A view may see nothing but the sky: there is an end to trying.
    for (std::uint64_t variant = 0;
         variant < min_variants || (double(tally.points) < wanted && variant < 100 * min_variants); ++variant) {
        if (a_case.share == 0 && variant == min_variants) break;
        const Subject subject = a_case.make_subject(variant);
        const std::size_t rounds = subject.lights.size() * a_case.make_points.size();
        const auto count = static_cast<std::size_t>(wanted / double(min_variants * rounds));
        for (std::size_t round = 0; round < rounds; ++round) {
            Random random(options.seed * 1'000'003 + variant * 1009 + round);
            const std::size_t light = round % subject.lights.size(), maker = round / subject.lights.size();
            Question question{subject.triangles, {}, {}, subject.lights[light]};
            question.cut_outs = subject.cut_outs;
            a_case.make_points[maker](
                {device, subject, std::clamp<std::size_t>(count, 24, a_case.largest_question), variant, random},
                question);
            // Small questions draw no map of themselves.
            std::vector<std::pair<std::string, std::string>> settings;
            if (random.below(2) == 0) settings.emplace_back("conservative-map", "on");
            judge.ask(question, settings,
                      fmt::format("{}, variant {}, light {}, points {}, seed {}", a_case.name, variant, light, maker,
                                  options.seed),
                      tally);
        }
    }
    return result;
}

}  // namespace stress
