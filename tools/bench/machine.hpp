// SPDX-License-Identifier: MIT
// Where and when the figures were taken: nothing is compared without it.
#pragma once

#include <nlohmann/json.hpp>

namespace gnomon::bench {

/// Processor, memory, system, compiler, date, load, gnomon's version and commit, every OpenCL device, Embree.
/// `threads`: what --threads asked for, 0 for all.
nlohmann::ordered_json machine_json(unsigned threads);

}  // namespace gnomon::bench
