// SPDX-License-Identifier: MIT
// Where and when the figures were taken: nothing is compared without it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gnomon::bench {

/// Processor, memory, system, compiler, date, load, gnomon's version and commit, every OpenCL device.
/// `threads`: what --threads asked for, 0 for all. `embree`: its version.
nlohmann::ordered_json machine_json(unsigned threads, const std::string& embree);

}  // namespace gnomon::bench
