// SPDX-License-Identifier: MIT
// Values of settings, read from text. Each throws InvalidArgument, naming the setting, its range and the text.
#pragma once

#include <gnomon.hpp>

namespace gnomon {

/// A number from low to high (both included).
float number_setting(std::string_view name, std::string_view text, double low, double high);
/// A whole number from low to high (both included).
std::uint32_t whole_setting(std::string_view name, std::string_view text, std::uint32_t low, std::uint32_t high);
/// The same, or 0 for "auto".
std::uint32_t whole_or_auto_setting(std::string_view name, std::string_view text, std::uint32_t low,
                                    std::uint32_t high);

/// Position of text among the names. Enumerations list theirs in order, from 0.
std::uint32_t choice_setting(std::string_view name, std::string_view text, std::span<const std::string_view> names);

}  // namespace gnomon
