// SPDX-License-Identifier: MIT
// Figures of others that stand beside ours: tools/bench/published.json, each table with its source and machine.
#pragma once

#include <nlohmann/json.hpp>

namespace gnomon::bench {

/// [{"experiment", "title", "source", "machine", "columns": [...], "rows": [[...], ...]}, ...]
const nlohmann::ordered_json& published();

}  // namespace gnomon::bench
