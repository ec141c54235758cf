// SPDX-License-Identifier: MIT
// Frames as JPEG files, in memory.
#pragma once

#include <string>

#include "session.hpp"

namespace gnomon::app {

/// `is_draft`: smaller and sooner, for a camera that moves; else colours keep the picture's full resolution.
std::string jpeg_of(const Frame& frame, bool is_draft);

}  // namespace gnomon::app
