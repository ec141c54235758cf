// SPDX-License-Identifier: MIT
// Runs a loop on all hardware threads, in chunks handed out by a counter. Results must not depend on who runs what.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace reference {

/// Calls body(first, last) for consecutive ranges that cover [0, count) once. body must not throw.
template <typename Body>
void for_chunks(std::size_t count, std::size_t chunk, Body body) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t first = next.fetch_add(chunk); first < count; first = next.fetch_add(chunk))
            body(first, std::min(first + chunk, count));
    };
    const std::size_t chunks = (count + chunk - 1) / chunk;
    const std::size_t workers = std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), chunks);
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < workers; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

}  // namespace reference
