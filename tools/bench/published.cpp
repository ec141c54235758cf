// SPDX-License-Identifier: MIT
#include "published.hpp"

#include "published_json.hpp"

namespace gnomon::bench {

const nlohmann::ordered_json& published() {
    static const nlohmann::ordered_json json = nlohmann::ordered_json::parse(published_json);
    return json;
}

}  // namespace gnomon::bench
