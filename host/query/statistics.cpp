// SPDX-License-Identifier: MIT
#include "query/statistics.hpp"

#include <algorithm>

namespace gnomon {

std::uint64_t Statistics::count(std::string_view name) const {
    for (const auto& [key, value] : counts)
        if (key == name) return value;
    return 0;
}

Statistics MeasuredRun::finish(decltype(Statistics::counts) counts) {
    if (!counts.empty()) stages.counts = std::move(counts);
    stages.device_memory_bytes = peak_bytes();
    stages.total_wall_ms = wall_ms();
    return std::move(stages);
}

void add_stages(Statistics& total, const Statistics& run) {
    for (const StageStatistics& stage : run.stages) {
        const auto found =
            std::find_if(total.stages.begin(), total.stages.end(), [&](const auto& s) { return s.name == stage.name; });
        if (found == total.stages.end()) {
            total.stages.push_back(stage);
            continue;
        }
        found->device_ms += stage.device_ms;
        found->wall_ms += stage.wall_ms;
        if (stage.skipped.empty()) found->skipped.clear();
    }
}

void merge_stages(Statistics& statistics) {
    Statistics merged;
    add_stages(merged, statistics);
    statistics.stages = std::move(merged.stages);
}

}  // namespace gnomon
