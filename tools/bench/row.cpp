// SPDX-License-Identifier: MIT
#include "row.hpp"

#include <fmt/core.h>
#include <algorithm>

namespace gnomon::bench {

std::string text_of(const Settings& settings) {
    std::string text;
    for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
    return text;
}

Times times_of(std::vector<double> ms) {
    std::sort(ms.begin(), ms.end());
    const auto quartile = [&](int which) {
        const double place = which * double(ms.size() - 1) / 4;
        const auto before = static_cast<std::size_t>(place);
        const std::size_t after = std::min(before + 1, ms.size() - 1);
        return ms[before] + (place - double(before)) * (ms[after] - ms[before]);
    };
    return {quartile(2), ms.front(), ms.back(), quartile(3) - quartile(1), ms.size()};
}

std::uint64_t Row::count(std::string_view name) const {
    for (const auto& [key, value] : counts)
        if (key == name) return value;
    return 0;
}

void Row::set_runs(std::vector<FrameTimes> made, bool are_frames) {
    runs = std::move(made);
    const auto times = [&](Part part) {
        std::vector<double> ms;
        for (const FrameTimes& run : runs) ms.push_back(part_ms(run, part));
        return times_of(std::move(ms));
    };
    total = times(Part::shadow);
    if (runs.front().build.wall_ms != 0) build = times(Part::build);
    if (!are_frames) return;
    camera = times(Part::camera);
    shade = times(Part::shade);
    frame = times(Part::frame);
}

std::string Row::name() const { return settings.empty() ? technique : technique + " " + text_of(settings); }

std::string Row::view_name() const { return fmt::format("{} {}.{} {}x{}", scene, view, light, width, height); }

}  // namespace gnomon::bench
