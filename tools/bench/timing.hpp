// SPDX-License-Identifier: MIT
// How often something is run: the same rule for gnomon and for its rivals.
#pragma once

#include <chrono>
#include <ctime>
#include <vector>

namespace gnomon::bench {

/// Wall clock in milliseconds.
class Clock {
public:
    double elapsed_ms() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What one run took: wall clock, and the processor time of all threads of this process, which says more than the wall
/// clock where other programs want the cores too.
struct RunTimes {
    double wall_ms = 0, processor_ms = 0;
};

/// What one run took, part by part: what a user waits for is the sum. Parts that did not run took 0.
struct FrameTimes {
    RunTimes build;   ///< a rival's tree, where each run builds it anew
    RunTimes camera;  ///< from resident triangles to shading points
    RunTimes shadow;  ///< from resident points to their visibility
    RunTimes shade;   ///< to a picture on the host
};

/// What times are compared: each part needs the tree, so it contains the build.
enum class Part { build, camera, shadow, shade, frame };

/// The frame is the sum of all parts, with one build.
inline double part_ms(const FrameTimes& times, Part part, double RunTimes::*clock = &RunTimes::wall_ms) {
    switch (part) {
        case Part::build:
            return times.build.*clock;
        case Part::camera:
            return times.build.*clock + times.camera.*clock;
        case Part::shadow:
            return times.build.*clock + times.shadow.*clock;
        case Part::shade:
            return times.shade.*clock;
        case Part::frame:
            break;
    }
    return times.build.*clock + times.camera.*clock + times.shadow.*clock + times.shade.*clock;
}

template <typename Work>
RunTimes time_run(Work&& work) {
    const std::clock_t before = std::clock();
    const Clock clock;
    work();
    return {clock.elapsed_ms(), double(std::clock() - before) * 1e3 / CLOCKS_PER_SEC};
}

template <typename Work>
double time_ms(Work&& work) {
    const Clock clock;
    work();
    return clock.elapsed_ms();
}

/// `most` timed runs, or fewer once `seconds` are spent: then at least 3 within three times that, and always 1.
struct RunRule {
    int most = 15;
    double seconds = 4;

    bool goes_on(int runs, double spent_ms) const {
        const double share = spent_ms / (seconds * 1e3);
        return runs == 0 || (runs < most && (share < 1 || (runs < 3 && share < 3)));
    }
};

/// Times of `work`, after `warm_ups` runs that are not counted.
template <typename Work>
std::vector<double> timed_runs(const RunRule& rule, int warm_ups, Work&& work) {
    for (int i = 0; i < warm_ups; ++i) work();
    std::vector<double> ms;
    for (const Clock clock; rule.goes_on(static_cast<int>(ms.size()), clock.elapsed_ms());) ms.push_back(time_ms(work));
    return ms;
}

}  // namespace gnomon::bench
