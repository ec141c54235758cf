// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace gnomon {

/// 1234567 as "1,234,567".
inline std::string grouped(std::uint64_t number) {
    std::string digits = std::to_string(number);
    for (std::size_t left = digits.size(); left > 3;) digits.insert(left -= 3, 1, ',');
    return digits;
}

}  // namespace gnomon
