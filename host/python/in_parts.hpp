// SPDX-License-Identifier: MIT
// Work on the parts of a range, side by side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace gnomon::python {

inline constexpr std::size_t most_parts = 16;

/// Calls work(first, end, part) for as many parts of a range as there are threads, at most `most_parts`, each of at
/// least `least`; returns the number of parts.
template <typename Work>
std::size_t in_parts(std::size_t count, std::size_t least, const Work& work) {
    const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, most_parts);
    const std::size_t parts = std::clamp<std::size_t>(count / least, 1, threads);
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < parts; ++i)
        others.emplace_back([&work, i, count, parts] { work(count * i / parts, count * (i + 1) / parts, i); });
    work(0, count / parts, 0);
    for (std::thread& thread : others) thread.join();
    return parts;
}

}  // namespace gnomon::python
